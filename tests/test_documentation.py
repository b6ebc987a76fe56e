"""What holds for all pages: links of the README, size, alternative texts of pictures."""

import json
import re
import sys
from collections.abc import Callable
from inspect import ismodule, signature
from itertools import takewhile
from pathlib import Path

import pytest

import fem_lie as fl
from tools.site import gallery

if sys.version_info >= (3, 11):
    import tomllib

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
MOST_WORDS = 35_000
LINK = re.compile(r"!?\[([^\]]*)\]\(([^)\s]+)\)")
CALL = re.compile(r"`(([A-Za-z_.]+)\(([^`()]+)\))`")
PICTURE = re.compile(r"!\[([^\]]*)\]\([^)\s]+\)")
COMMAND = re.compile(r"(?:tests|benchmarks|demos|studies)/\w+\.py|-m (?:benchmarks|studies)\.\w+")
MADE = "gallery", "lessons", "reference", "scenes", "_pages"
"""Folders whose pages are made with the site."""

PAGES = sorted(
    page
    for page in [*DOCS.rglob("*.md"), ROOT / "README.md"]
    if page.relative_to(ROOT).parts[1:2] == () or page.relative_to(DOCS).parts[0] not in MADE
)


@pytest.mark.skipif(sys.version_info < (3, 11), reason="no tomllib")
def test_links_of_the_readme_work_outside_of_the_repository():
    """PyPI shows the README: all links are absolute, and lead to files that exist."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    address = project["urls"]["Repository"]
    raw = address.replace("https://github.com", "https://raw.githubusercontent.com")
    starts = re.compile(rf"(?:{re.escape(address)}/(?:blob|tree)|{re.escape(raw)})/main/([^#]*)")
    links = [link for _, link in LINK.findall((ROOT / "README.md").read_text(encoding="utf-8"))]
    assert links
    for link in links:
        match = starts.match(link)
        assert match, f"{link}: expected an absolute address of {address}"
        assert (ROOT / match.group(1)).exists(), f"{link}: no such file"


def test_pages_for_users_are_short():
    """The appendix of measurements does not count."""
    kept = [page for page in PAGES if DOCS in page.parents and "measured" not in page.parts]
    words = sum(len(page.read_text(encoding="utf-8").split()) for page in kept)
    assert words <= MOST_WORDS


@pytest.mark.parametrize("page", [pytest.param(p, id=str(p.relative_to(ROOT))) for p in PAGES])
def test_pictures_have_alternative_texts(page):
    texts = PICTURE.findall(page.read_text(encoding="utf-8"))
    assert all(len(text.split()) >= 3 for text in texts), texts


@pytest.mark.parametrize("page", [pytest.param(p, id=str(p.relative_to(ROOT))) for p in PAGES])
def test_commands_run_files_that_exist(page):
    commands = COMMAND.findall(page.read_text(encoding="utf-8"))
    named = {text.removeprefix("-m ").removesuffix(".py").replace(".", "/") for text in commands}
    assert [
        name
        for name in sorted(named - {"demos/x", "studies/NAME"})
        if not (ROOT / f"{name}.py").exists()
    ] == []


def callables() -> dict[str, Callable]:
    """Public classes and functions by name, with and without their module."""
    members = {name: getattr(fl, name) for name in fl.__all__}
    modules = {"fl": fl} | {f"fl.{name}": each for name, each in members.items() if ismodule(each)}
    found = {}
    for prefix, module in modules.items():
        for name in module.__all__:
            each = getattr(module, name)
            if callable(each):
                found |= {name: each, f"{prefix}.{name}": each}
    return found


def test_arguments_in_texts_have_the_order_of_the_signature():
    """``Name(a, b)`` of a text can be called as it stands: no two numbers change places."""
    known, wrong = callables(), []
    for page in PAGES:
        for text, name, arguments in CALL.findall(page.read_text(encoding="utf-8")):
            if name not in known:
                continue
            names = list(signature(known[name]).parameters)
            positional = takewhile(str.isidentifier, arguments.split(", "))
            order = [(names.index(each), k) for k, each in enumerate(positional) if each in names]
            if any(index != k for index, k in order):
                wrong.append(f"{page.name}: {text}, expected the order {names}")
    assert wrong == []


@pytest.mark.parametrize("record", sorted(gallery.KEPT.glob("*.json")), ids=lambda f: f.stem)
def test_a_page_of_the_gallery_shows_each_number_once(record):
    """A single number of a record stands in the output, or in the table below it, not in both."""
    printed = gallery.named(record.with_suffix(".txt").read_text(encoding="utf-8"))
    listed = set(re.findall(r"^\| `(\w.*?)` \|", gallery.table(record, printed), re.MULTILINE))
    found = json.loads(record.read_text(encoding="utf-8"))
    for key, value in found.items():
        if isinstance(value, int | float | str):
            assert (key in listed) != bool({key, key.replace("_", " ")} & printed), key
