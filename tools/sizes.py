"""Sizes of modules and functions, and counts of types without information.

Prints files, lines and lines of code (without docstrings, comments and blank lines) of the package
and of its folders. Then what ``docs/measured/packages.md`` bounds: modules with over 300 lines;
functions with over eight positional arguments, or over eight of any kind; ``tuple[Any, ...]``;
``type: ignore``; and the package with the most files.

    python3 tools/sizes.py [--names]
"""

from __future__ import annotations

import argparse
import ast
import io
import re
import tokenize
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

PACKAGE = Path(__file__).parents[1] / "fem_lie"
LINES, ARGUMENTS = 300, 8


class Size(NamedTuple):
    """Of a file, or of many."""

    files: int
    lines: int
    code: int

    def __add__(self, other: object) -> Size:
        """Of both."""
        assert isinstance(other, Size)
        return Size(*(a + b for a, b in zip(self, other, strict=True)))


_NO_CODE = {
    *(tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT),
    *(tokenize.ENCODING, tokenize.ENDMARKER),
}


def size_of(text: str) -> Size:
    """Size of one file: a line of code has a token that is neither a comment nor in a docstring."""
    nodes = ast.walk(ast.parse(text))
    # those of attributes stand alone, too
    alone = [node.value for node in nodes if isinstance(node, ast.Expr)]
    strings = [n for n in alone if isinstance(n, ast.Constant) and isinstance(n.value, str)]
    docstrings = {k for n in strings for k in range(n.lineno, (n.end_lineno or n.lineno) + 1)}
    code = set[int]()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type not in _NO_CODE:
            code.update(range(token.start[0], token.end[0] + 1))
    return Size(1, text.count("\n"), len(code - docstrings))


def print_sizes() -> None:
    """Print the sizes of the package and of its folders."""
    sizes = defaultdict[str, Size](lambda: Size(0, 0, 0))
    for file in PACKAGE.rglob("*.py"):
        own = size_of(file.read_text(encoding="utf-8"))
        folders = file.relative_to(PACKAGE).parts[:-1]
        for name in ["all", *("/".join(folders[: k + 1]) for k in range(min(2, len(folders))))]:
            sizes[name] += own
    print(f"{'files':>6}{'lines':>8}{'code':>8}")
    for name in sorted(sizes, key=lambda name: (name != "all", name)):
        size = sizes[name]
        print(f"{size.files:6}{size.lines:8}{size.code:8}  {name}")


def functions(tree: ast.Module) -> Iterator[tuple[str, ast.FunctionDef, bool]]:
    """Those at the top and in classes: name, definition, whether both are public."""
    for node in tree.body:
        if isinstance(node, ast.FunctionDef):
            yield node.name, node, not node.name.startswith("_")
        elif isinstance(node, ast.ClassDef):
            for inner in node.body:
                if isinstance(inner, ast.FunctionDef):
                    own = not inner.name.startswith("_") or inner.name == "__init__"
                    public = own and not node.name.startswith("_")
                    yield f"{node.name}.{inner.name}", inner, public


def arguments(function: ast.FunctionDef) -> tuple[int, int]:
    """Those by place, without ``self`` and ``cls``, and all with those by name."""
    names = [a.arg for a in function.args.posonlyargs + function.args.args]
    by_place = len(names) - (names[:1] in (["self"], ["cls"]))
    return by_place, by_place + len(function.args.kwonlyargs)


def exported() -> set[str]:
    """Names at the door of the package."""
    tree = ast.parse((PACKAGE / "__init__.py").read_text(encoding="utf-8"))
    return {a.asname or a.name for n in tree.body if isinstance(n, ast.ImportFrom) for a in n.names}


def main() -> None:
    """Count."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--names", action="store_true", help="which they are")
    named = parser.parse_args().names
    print_sizes()
    door, found = exported(), dict[str, list[str]]()
    keys = [
        f"modules over {LINES} lines",
        f"public functions with over {ARGUMENTS} arguments by place",
        f"other functions with over {ARGUMENTS} arguments by place",
        f"public functions with over {ARGUMENTS} arguments, those by name included",
        "tuple[Any, ...]",
        "type: ignore",
    ]
    modules, public, within, by_name, vague, ignored = (found.setdefault(key, []) for key in keys)
    for file in sorted(PACKAGE.rglob("*.py")):
        text = file.read_text(encoding="utf-8")
        place, lines = str(file.relative_to(PACKAGE)), text.count("\n")
        if lines > LINES:
            modules.append(f"{place} {lines}")
        vague += [place] * len(re.findall(r"tuple\[Any, \.\.\.\]", text, re.IGNORECASE))
        ignored += [place] * text.count("type: ignore")
        for name, function, own in functions(ast.parse(text)):
            by_place, every = arguments(function)
            seen = own and name.partition(".")[0] in door
            if by_place > ARGUMENTS:
                (public if seen else within).append(f"{place} {name} {by_place}")
            if seen and every > ARGUMENTS:
                by_name.append(f"{place} {name} {every}")
    for key, which in found.items():
        print(f"{key}: {len(which)}")
        if named:
            for each in which:
                print(f"    {each}")
    packages = {file.parent for file in PACKAGE.rglob("*.py")}
    files = {
        package: len([f for f in package.glob("*.py") if f.stem != "__init__"])
        for package in packages
    }
    largest = max(files, key=lambda package: files[package])
    print(f"files in a package, at most: {files[largest]} ({largest.relative_to(PACKAGE.parent)})")


if __name__ == "__main__":
    main()
