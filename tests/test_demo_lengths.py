"""Demos are short: at most 80 lines of code each, docstrings, comments and blanks not counted."""

import ast
import io
import tokenize
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FILES = sorted(file.stem for file in (ROOT / "demos").glob("*.py"))
HELPER = "command_line"
"""Options and printing of all of them."""
MOST = 80

BLANK = (
    tokenize.COMMENT,
    tokenize.NL,
    tokenize.NEWLINE,
    tokenize.INDENT,
    tokenize.DEDENT,
    tokenize.ENDMARKER,
)


def lines_of_code(source: str) -> int:
    """Lines with anything but docstrings and comments."""
    tokens = tokenize.generate_tokens(io.StringIO(source).readline)
    lines = {
        line
        for token in tokens
        if token.type not in BLANK
        for line in range(token.start[0], token.end[0] + 1)
    }
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Module | ast.FunctionDef | ast.ClassDef) and ast.get_docstring(
            node
        ):
            text = node.body[0]
            lines -= set(range(text.lineno, (text.end_lineno or text.lineno) + 1))
    return len(lines)


@pytest.mark.parametrize("demo", [name for name in FILES if name != HELPER])
def test_demos_are_short(demo):
    source = (ROOT / "demos" / f"{demo}.py").read_text(encoding="utf-8")
    assert lines_of_code(source) <= MOST


def test_what_is_code():
    head = '"""Of a\nmodule."""\n\n# why\nx = [\n    1,\n]\n\n\n'
    assert lines_of_code(head + 'def f():\n    """Docs."""\n    return x\n') == 5
