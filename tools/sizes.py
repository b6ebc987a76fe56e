"""How large the pieces of the code are: modules, functions, and types that say nothing.

Printed is what the plan of the rooms bounds: modules with over 300 lines; functions that take over
eight arguments by place, or any by name, too; ``tuple[Any, ...]``; ``type: ignore``; and the room
with the most files.

    python3 tools/sizes.py [--names]
"""

from __future__ import annotations

import argparse
import ast
import re
from collections.abc import Iterator
from pathlib import Path

PACKAGE = Path(__file__).parents[1] / "fem_lie"
LINES, ARGUMENTS = 300, 8


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
    rooms = {file.parent for file in PACKAGE.rglob("*.py")}
    files = {room: len([f for f in room.glob("*.py") if f.stem != "__init__"]) for room in rooms}
    largest = max(files, key=lambda room: files[room])
    print(f"files in a room, at most: {files[largest]} ({largest.relative_to(PACKAGE.parent)})")


if __name__ == "__main__":
    main()
