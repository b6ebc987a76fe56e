"""What messages advise exists: functions, classes, methods and arguments by their public names."""

import ast
import inspect
import re
from inspect import ismodule
from pathlib import Path

import fem_lie as fl

PACKAGE = Path(fl.__file__).parent
SAID_BY = {"warn", "warning", "info", "error", "debug"}
NAMES = re.compile(
    r"\bfl\.(?:[a-z]+\.)?(\w+)"  # with the package, and perhaps a namespace
    r"|\b([A-Za-z_]\w*)(?=\()"  # like a call
    r"|\b([a-z]+(?:_[a-z]+)+)\b"  # like a function or an argument
    r"|\b([A-Z][a-z]+[A-Z]\w+)\b"  # like a class
)
OF_OTHERS = {"Constant", "DefineConstant", "Measure", "SuperLU", "as_vector", "function_space"} | {
    "divided_from"
}
"""Names of DOLFINx, gmsh, UFL and SciPy; an option for PETSc's database."""


def messages(tree):
    """Texts of errors, warnings and the log."""
    for node in ast.walk(tree):
        said = isinstance(node, ast.Raise) and node.exc is not None
        if isinstance(node, ast.Call):
            called = getattr(node.func, "attr", getattr(node.func, "id", ""))
            said = called in SAID_BY
        if said:
            inside = [each for each in ast.walk(node) if isinstance(each, ast.Constant)]
            yield " ".join(each.value for each in inside if isinstance(each.value, str))


def arguments_of(callable_):
    try:
        return set(inspect.signature(callable_).parameters)
    except (TypeError, ValueError):  # of exceptions and others without a signature
        return set()


def public_names():
    """Names of the package, members of its classes, arguments of all of them."""
    namespaces = [fl, *(space for name in fl.__all__ if ismodule(space := getattr(fl, name)))]
    found = {"fem_lie"} | set(fl.extend.__all__)
    for name, thing in (
        (name, getattr(space, name)) for space in namespaces for name in space.__all__
    ):
        found |= {name} | arguments_of(thing)
        if inspect.isclass(thing):
            members = inspect.getmembers(thing)
            found |= {name for name, _ in members} | set(inspect.get_annotations(thing))
            found |= set().union(*(arguments_of(each) for _, each in members if callable(each)))
    return found


def test_names_in_messages_exist():
    known, unknown, count = public_names() | OF_OTHERS, set(), 0
    for path in sorted(PACKAGE.rglob("*.py")):
        for message in messages(ast.parse(path.read_text(encoding="utf-8"))):
            for match in NAMES.finditer(message):
                name = next(filter(None, match.groups()))
                count += 1
                if name not in known:
                    unknown.add(f"{name} ({path.relative_to(PACKAGE)})")
    assert count > 50
    assert not unknown
