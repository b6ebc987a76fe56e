"""Words that are never right: others in the field do not know them in these senses.

The list is that of the glossary. Sources, messages, identifiers and pages use the field's words:
reported, attachment frame, friction, goes slack, refactorised, midpoint, mass matrix, and so on.
"""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FOLDERS = "benchmarks", "demos", "docs", "fem_lie", "notebooks", "studies", "tests", "tools"
SUFFIXES = ".py", ".md", ".ipynb", ".bash"
WORDS = re.compile(
    r"(?<![A-Za-z])(?:told|tells|tellings|few shapes|legs?|gripp?(?:s|ed|ing)?|rub(?:s|bed|bing)?"
    r"|slacken(?:s|ed|ing)?|booked|made anew|goes on from|begins_at|stir(?:s|red|ring)?|half-way"
    r"|grams?|CROSSING|straight nodes?|kept (?:matrix|matrices)|turn_axes)(?![A-Za-z])"
)
MADE = "docs/lessons", "docs/reference", "docs/_pages", "docs/_mathjax"
"""Folders of pages that are made of sources when the site is."""

OLD_NAMES = "fem_lie/_renamed.py", "tests/test_words.py"
"""Files that have to name what is not to be said."""


def texts() -> list[Path]:
    """All files that a reader may open."""
    found = [ROOT / "README.md"]
    for folder in FOLDERS:
        for path in sorted((ROOT / folder).rglob("*")):
            name = path.relative_to(ROOT).as_posix()
            made = name.startswith(MADE) or re.match(r"docs/(gallery|scenes)/\w+\.md", name)
            if path.suffix in SUFFIXES and not made and name not in OLD_NAMES:
                found.append(path)
    return found


@pytest.mark.parametrize("file", [pytest.param(p, id=str(p.relative_to(ROOT))) for p in texts()])
def test_no_word_is_of_this_project_alone(file):
    lines = file.read_text(encoding="utf-8").splitlines()
    found = [f"line {i}: {m[0]}" for i, line in enumerate(lines, 1) if (m := WORDS.search(line))]
    assert found == []
