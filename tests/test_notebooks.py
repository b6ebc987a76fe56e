"""Lessons run as they are, exercises and solutions included."""

import runpy
from pathlib import Path

import pytest

LESSONS = sorted((Path(__file__).parents[1] / "notebooks").glob("[0-9]_*.py"))


@pytest.mark.parametrize("lesson", [pytest.param(file, id=file.stem) for file in LESSONS])
def test_lesson(lesson):
    text = lesson.read_text(encoding="utf-8")
    assert "**Exercise" in text and "## Solution" in text
    runpy.run_path(str(lesson))


def test_there_are_six():
    assert len(LESSONS) == 6
