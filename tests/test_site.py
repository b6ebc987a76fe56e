"""What the site shows as worked examples does what it says."""

import runpy
from pathlib import Path

import pytest

import fem_lie
from tools.site import reference

DOCS = Path(__file__).parents[1] / "docs"
SCENES = sorted((DOCS / "scenes").glob("*.py"))


def test_an_element_of_ones_own():
    found = runpy.run_path(str(DOCS / "how_to" / "element.py"))
    assert found["errors"][1] <= 5e-3
    assert 1.9 <= found["order"] <= 2.2


def test_a_scheme_of_ones_own():
    found = runpy.run_path(str(DOCS / "how_to" / "scheme.py"))
    assert 3.9 <= found["order"] <= 4.1


def test_a_joint_of_ones_own():
    assert runpy.run_path(str(DOCS / "how_to" / "joint.py"))["error"] <= 1e-9


@pytest.mark.parametrize("scene", [pytest.param(file, id=file.stem) for file in SCENES])
def test_scenes_of_the_first_page(scene, tmp_path, monkeypatch):
    """Each makes its picture and its page in a few lines."""
    monkeypatch.chdir(tmp_path)
    lines = scene.read_text(encoding="utf-8").splitlines()
    runpy.run_path(str(scene))
    assert sum(line != "" for line in lines[1:]) <= 20
    assert (tmp_path / f"{scene.stem}.png").stat().st_size > 10_000
    assert 500_000 < (tmp_path / f"{scene.stem}.html").stat().st_size < 5_000_000


def test_there_are_eight_scenes():
    assert len(SCENES) == 8


@pytest.mark.parametrize("name", fem_lie.__all__)
def test_every_public_name_stands_in_a_chapter(name):
    assert reference.chapter(getattr(fem_lie, name)) in reference.CHAPTERS
