"""Every scheme with every kind of body, joint and load does what the table of the docs says."""

import re

import pytest

from benchmarks import what_works
from benchmarks.progress import Progress
from benchmarks.what_works import (
    HEADING,
    PAGE,
    SCHEMES,
    Combination,
    Outcome,
    combinations,
    general,
    outcome,
    outcomes_of,
    tables,
)
from tests.combinations import BODIES, JOINTS
from tests.combined_loads import LOADS, variants

ROLLING = ("KnifeEdge", "RollingDisc")


def published():
    """Cells of the tables by row and scheme, and the notes by their numbers."""
    section = PAGE.read_text(encoding="utf-8").partition(HEADING)[2].partition("\n## ")[0]
    rows = [
        [cell.strip() for cell in line.strip("|").split("|")]
        for line in section.splitlines()
        if line.startswith("| ")
    ]
    cells = {
        (row[0], scheme): cell.split()
        for row in rows
        for scheme, cell in zip(SCHEMES, row[1:], strict=True)
    }
    return cells, dict(re.findall(r"^(\d+)\. (.*)$", section, re.MULTILINE))


CELLS, NOTES = published()


def check(group, body, what="", variant=""):
    """No scheme fails, and each does what its cell says."""
    failed, other = {}, {}
    for scheme in SCHEMES:
        found = outcome(Combination(group, body, what, variant, scheme))
        if found.verdict == "failed":
            failed[scheme] = found.words
        cell = CELLS[what or body, scheme]
        words = "✓" if found.verdict == "works" else general(found.words)
        said = {number for number in cell if NOTES.get(number, number) == words}
        # of joints and loads a cell knows bodies that the scheme supports
        if cell and (group == "body" or "✓" in CELLS[body, scheme]) and not said:
            other[scheme] = f"{found.verdict}: {found.words}; in the docs: {cell}"
    assert not failed
    assert not other


@pytest.mark.parametrize("body", BODIES)
def test_bodies(body):
    check("body", body)


@pytest.mark.parametrize("joint", JOINTS)
def test_joints(joint):
    check("joint", "rigid body" if joint in ROLLING else "beam, geodesic", joint)


@pytest.mark.parametrize("load", LOADS)
def test_loads(load):
    body = next(name for name in BODIES if variants(name, load))
    check("load", body, load, variants(body, load)[-1])


@pytest.mark.parametrize(
    ("bound", "said"),
    [("VIOLATED", "joints are violated by"), ("ROUND_OFF", "the balance of energy has an error")],
)
def test_runs_that_break_a_law_fail(monkeypatch, bound, said):
    monkeypatch.setattr(what_works, bound, -1.0)
    found = outcome(Combination("body", "rigid body", "", "", "EnergyMomentum"))
    assert found.verdict == "failed"
    assert said in found.words


def test_the_short_list_has_every_scheme_with_every_body_and_joint():
    short = [c for c in combinations() if c.short]
    assert len(short) < 2000
    assert {(c.scheme, c.body) for c in short} == {(s, b) for s in SCHEMES for b in BODIES}
    joined = {(c.scheme, c.what) for c in short if c.group == "joint"}
    assert joined == {(s, j) for s in SCHEMES for j in JOINTS}


def test_a_run_that_was_interrupted_is_continued(tmp_path):
    wanted = [c for c in combinations() if c.group == "body" and c.body == "rigid body"]
    file = tmp_path / "found.jsonl"
    first = outcomes_of(wanted[:2], Progress(file))
    assert [first[c].verdict for c in wanted[:2]] == ["works", "works"]
    # what is there is taken as it is
    lines = file.read_text(encoding="utf-8").replace('"works"', '"refused"', 1)
    file.write_text(lines, encoding="utf-8")
    again = outcomes_of(wanted[:3], Progress(file))
    assert [again[c].verdict for c in wanted[:3]] == ["refused", "works", "works"]
    assert len(file.read_text(encoding="utf-8").splitlines()) == 3


def test_tables_say_what_was_found():
    of = Combination("body", "rigid body", "", "", "Hamel")
    found = {c: Outcome("works") for c in combinations() if c.body == "rigid body"}
    found[of] = Outcome("failed", "ZeroDivisionError: division")
    text = tables(found)
    assert text.startswith(HEADING)
    (row,) = (line for line in text.splitlines() if line.startswith("| rigid body |"))
    assert row.count("✓") == len(SCHEMES) - 1
    assert "\n1. **failed**: ZeroDivisionError: division\n" in text
