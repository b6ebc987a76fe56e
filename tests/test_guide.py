"""Pages for users do what they say: blocks of Python run, and print what stands below them."""

import contextlib
import io
import re
from itertools import pairwise
from operator import attrgetter
from pathlib import Path
from typing import NamedTuple

import pytest

import fem_lie

DOCS = Path(__file__).parents[1] / "docs"
PAGES = [
    pytest.param(page, id=page.relative_to(DOCS).with_suffix("").as_posix())
    for page in [
        DOCS / "start.md",
        *sorted(DOCS.glob("guide/*.md")),
        *sorted(DOCS.glob("coming_from/*.md")),
    ]
    if page.stem != "index"
]
FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
WORDS, FIRST_EXAMPLE = 1200, 20
SCRIPTS, LONGEST_SCRIPT = DOCS / "guide" / "six_tasks.md", 25


class Block(NamedTuple):
    """A fenced block of a page: its language, its text and the number of its first line."""

    language: str
    text: str
    line: int


def blocks(page: Path) -> list[Block]:
    """All fenced blocks of a page, in order."""
    text = page.read_text("utf-8")
    return [
        Block(found[1], found[2], text[: found.start(2)].count("\n"))
        for found in FENCE.finditer(text)
    ]


def agree(printed: str, stated: str) -> bool:
    """Same words and, within two units of their last digit, the same numbers."""
    if NUMBER.sub("#", printed).split() != NUMBER.sub("#", stated).split():
        return False
    pairs = zip(NUMBER.findall(printed), NUMBER.findall(stated), strict=True)
    return all(abs(float(a) - float(b)) <= 2.01 * last_digit(b) for a, b in pairs)


def last_digit(number: str) -> float:
    """Unit of the last digit of a number in decimal notation."""
    mantissa, _, exponent = number.lower().partition("e")
    return 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))


@pytest.mark.parametrize("page", PAGES)
def test_blocks_of_a_page_run_in_order(page, tmp_path, monkeypatch):
    """In one namespace; a block of text below a block of Python is what that prints.

    Complete scripts have a namespace each.
    """
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {"__name__": page.stem}
    for block, below in pairwise([*blocks(page), Block("", "", 0)]):
        if block.language != "python":
            continue
        if page == SCRIPTS:
            names = {"__name__": page.stem}
        output = io.StringIO()
        with contextlib.redirect_stdout(output):
            exec(compile("\n" * block.line + block.text, str(page), "exec"), names)
        if below.language == "text":
            message = f"{page.name}:{block.line} prints\n{output.getvalue()}"
            assert agree(output.getvalue(), below.text), message


@pytest.mark.parametrize("page", PAGES)
def test_a_page_is_short_and_leads_on(page):
    text = page.read_text("utf-8")
    python = [block for block in blocks(page) if block.language == "python"]
    assert len(text.split()) <= WORDS
    assert sum(line.strip() != "" for line in python[0].text.splitlines()) <= FIRST_EXAMPLE
    *_, last = re.findall(r"^## (.*)$", text, re.MULTILINE)
    assert last == "What to do next"
    assert "](" in text.rpartition(f"## {last}")[2]


def test_the_six_tasks_are_short():
    """A cantilever, a pendulum, a shell from gmsh, buckling, contact, an element."""
    scripts = [block.text for block in blocks(SCRIPTS) if block.language == "python"]
    assert len(scripts) == 6
    for text in scripts:
        lines = [line for line in text.splitlines() if line.strip()]
        assert len(lines) <= LONGEST_SCRIPT and max(map(len, lines)) <= 88


@pytest.mark.parametrize("page", PAGES)
def test_names_on_a_page_exist(page):
    """In prose and tables, too: ``fl.Scene``, ``fl.joints.Revolute``, ``fl.Beam.straight``."""
    for name in set(re.findall(r"\bfl((?:\.\w+)+)", page.read_text("utf-8"))):
        attrgetter(name[1:])(fem_lie)


@pytest.mark.parametrize("page", PAGES)
def test_links_between_pages_of_the_sources_lead_somewhere(page):
    """Links to generated pages (gallery, lessons, reference) are checked on the built site."""
    for target, heading in re.findall(r"\]\(([^)#:]+\.md)#?([^)]*)", page.read_text("utf-8")):
        if {"gallery", "lessons", "reference"} & set(Path(target).parts):
            continue
        assert (page.parent / target).exists(), f"{page.name}: {target}"
        if heading:
            assert heading in anchors(page.parent / target), f"{page.name}: {target}#{heading}"


def anchors(page: Path) -> list[str]:
    """Names by which the headings of a page are linked to."""
    headings = re.findall(r"^#+ (.*)$", page.read_text("utf-8"), re.MULTILINE)
    return [re.sub(r"[^\w -]", "", heading).lower().replace(" ", "-") for heading in headings]
