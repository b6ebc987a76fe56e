"""What an installed package and a source distribution have."""

import re
from pathlib import Path

import fem_lie

ROOT = Path(__file__).parents[1]


def test_one_version():
    citation = (ROOT / "CITATION.cff").read_text("utf-8")
    assert re.search(r"^version: (.*)$", citation, re.MULTILINE)[1] == fem_lie.__version__
    assert re.fullmatch(r"\d+\.\d+\.\d+", fem_lie.__version__)
    # the build reads it from the sources, and must find it in one place
    project = (ROOT / "pyproject.toml").read_text("utf-8")
    assert 'version = { attr = "fem_lie.__version__" }' in project
    assert not re.search(r'^version = "', project, re.MULTILINE)


def test_types_reach_those_who_install():
    assert (Path(fem_lie.__file__).parent / "py.typed").exists()


def test_every_folder_of_the_sources_is_in_a_source_distribution():
    manifest = (ROOT / "MANIFEST.in").read_text("utf-8").split()
    folders = "benchmarks", "demos", "docs", "meshes", "notebooks", "recipe", "studies", "tests"
    for folder in folders:
        assert (ROOT / folder).is_dir() and folder in manifest


def test_the_recipe_has_the_version_and_the_requirements_of_the_project():
    recipe = (ROOT / "recipe" / "meta.yaml").read_text("utf-8")
    assert re.search(r'set version = "(.*)"', recipe)[1] == fem_lie.__version__
    run = recipe.partition("  run:")[2].partition("  run_constrained:")[0]
    found = [line.strip("- ").partition("  #")[0] for line in run.splitlines() if "- " in line]
    project = (ROOT / "pyproject.toml").read_text("utf-8")
    needed = re.findall(
        r'"(.*?)"', re.search(r"^dependencies = \[(.*)\]", project, re.MULTILINE)[1]
    )
    conda = {"matplotlib": "matplotlib-base"}
    assert {conda.get(name, name).replace(", <", ",<") for name in needed} <= {*found}
