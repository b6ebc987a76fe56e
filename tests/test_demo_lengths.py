"""Demos are short: at most 80 lines of code each, docstrings, comments and blanks not counted."""

import ast
import io
import tokenize
from pathlib import Path

import pytest

from tools.records import HELPERS

ROOT = Path(__file__).parents[1]
DEMOS = sorted(file.stem for file in (ROOT / "demos").glob("*.py") if file.stem not in HELPERS)
MOST = 80
STILL_LONGER = {
    "catenary": 102,
    "compressed_cylinder": 96,
    "double_four_bar": 87,
    "euler_column": 86,
    "flapping_plate": 103,
    "governor": 84,
    "heavy_top": 81,
    "own_energy": 189,
    "rod_in_box": 84,
    "slider_crank": 87,
    "truss_deployment": 204,
    "tumbling_body": 82,
}
"""Lines that are not to become more; nothing is added to this list."""

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


@pytest.mark.parametrize("demo", DEMOS)
def test_demos_are_short(demo):
    source = (ROOT / "demos" / f"{demo}.py").read_text(encoding="utf-8")
    assert lines_of_code(source) <= STILL_LONGER.get(demo, MOST)


def test_what_is_code():
    head = '"""Of a\nmodule."""\n\n# why\nx = [\n    1,\n]\n\n\n'
    assert lines_of_code(head + 'def f():\n    """Docs."""\n    return x\n') == 5
