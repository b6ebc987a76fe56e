"""Docstrings of classes as the reference shows them: parameters first, examples last."""

from __future__ import annotations

import inspect
import re
from collections.abc import Sequence
from dataclasses import is_dataclass
from typing import Any

ORDER = "", "Args", "Attributes", "Returns", "Raises", "Note", "Example", "Examples"
"""Sections in the order of the reference; text without a heading comes first."""

SECTION = re.compile(rf"^({'|'.join(ORDER[1:])}):\s*$")
ENTRY = re.compile(r"^ {4}(\*{0,2}\w+(?:, \*{0,2}\w+)*)(?: \([^)]*\))?:")


def sections(lines: Sequence[str]) -> list[list[str]]:
    """Divide a docstring of Google style: each part begins with its heading.

    Args:
        lines: Lines of the docstring without common indentation.

    Returns:
        The parts in their order; text that belongs to no section has no heading.
    """
    parts: list[list[str]] = [[]]
    inside = False
    for line in lines:
        begins = SECTION.match(line) is not None
        ends = inside and line != "" and not line.startswith(" ")
        if begins or ends:
            parts.append([])
        inside = begins or (inside and not ends)
        parts[-1].append(line)
    return [part for part in parts if part]


def entries(lines: Sequence[str]) -> set[str]:
    """Names that an ``Args`` or ``Attributes`` section documents."""
    found: set[str] = set()
    for line in lines:
        if match := ENTRY.match(line):
            found.update(name.lstrip("*") for name in match.group(1).split(", "))
    return found


def documented(docstring: str | None) -> set[str]:
    """Names of all parameters and attributes that a docstring documents.

    Args:
        docstring: A docstring of Google style, or ``None``.
    """
    parts = sections(inspect.cleandoc(docstring or "").splitlines())
    fitting = [part for part in parts if part[0].rstrip() in ("Args:", "Attributes:")]
    return {name for part in fitting for name in entries(part)}


def merged(obj: type, lines: Sequence[str]) -> list[str]:
    """Docstring of a class with that of its constructor: text, parameters, attributes, examples.

    Fields of a data class are the parameters of its constructor, so they are shown as such.

    Args:
        obj: The class.
        lines: Its docstring.
    """
    parts = sections(lines)
    if is_dataclass(obj):
        arguments = set(inspect.signature(obj).parameters)
        for part in parts:
            if part[0].startswith("Attributes:") and entries(part) <= arguments:
                part[0] = "Args:"
    elif inspect.isfunction(obj.__init__):
        parts += sections(inspect.cleandoc(obj.__init__.__doc__ or "").splitlines())
    found: dict[str, list[list[str]]] = {heading: [] for heading in ORDER}
    for part in parts:
        match = SECTION.match(part[0])
        found[match.group(1) if match else ""].append(part)
    return [line for group in found.values() for part in group for line in [*part, ""]]


def process(app: Any, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Rearrange docstrings of classes, and keep those of properties whole.

    For Sphinx's event ``autodoc-process-docstring``.

    Args:
        app: The Sphinx application.
        what: Kind of the object, such as ``"class"``.
        name: Full name of the object.
        obj: The object.
        options: Options of the directive.
        lines: Lines of the docstring, changed in place.
    """
    del app, name, options
    if what == "class":
        lines[:] = merged(obj, lines)
    elif what in ("property", "attribute", "data"):
        # napoleon takes what is before a colon in the first line as a type
        lines.insert(0, "")
