"""Short representations of objects that hold arrays: a few lines, and a table in notebooks."""

from __future__ import annotations

import reprlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields
from difflib import get_close_matches
from html import escape
from typing import Any, cast

import numpy as np

from fem_lie._renamed import ATTRIBUTES

WIDTH, MOST_LINES = 100, 10
_FEW = 6  # numbers of an array that are printed
_SHORT = reprlib.Repr()
_SHORT.maxstring = _SHORT.maxother = 60


class Summarised:
    """Base of classes whose ``repr`` has one to ten lines, and which notebooks show as a table."""

    def _summary(self) -> Iterator[tuple[str, object]]:
        """Names and values that the representation shows; default: the fields of a dataclass.

        A name is what follows the object and a dot in an expression for the value, as "times[-1]".
        Lists may be shown by their names or lengths.
        """
        for field in fields(cast(Any, self)):
            if field.repr and not field.name.startswith("_"):
                value = getattr(self, field.name, None)  # a quantity may not have been recorded
                if value is not None:
                    yield field.name, value

    def __repr__(self) -> str:
        """Name of the class and its values: on one line where that is short enough."""
        name = type(self).__name__
        entries = [f"{key}={brief(value)}" for key, value in self._summary()]
        line = f"{name}({', '.join(entries)})"
        if len(line) <= WIDTH:
            return line
        lines: list[str] = []
        rows = MOST_LINES - 2
        for entry in entries:
            if lines and len(lines[-1]) + len(entry) + 2 < WIDTH - 4:
                lines[-1] += f", {entry}"
            else:
                lines.append(entry)
        if len(lines) > rows:
            lines = [*lines[: rows - 1], "…"]
        return "\n".join([f"{name}(", *(f"    {each},"[:WIDTH] for each in lines), ")"])

    def __getattr__(self, name: str) -> Any:
        """Raise ``AttributeError`` with a hint; called for what the object does not have."""
        if name.startswith("_") or hasattr(type(self), name):
            return object.__getattribute__(self, name)  # its own error
        message = f"{type(self).__name__} has no attribute {name!r}"
        if name in ATTRIBUTES:
            message += f"; expected {ATTRIBUTES[name]} (fl is fem_lie)"
        elif near := get_close_matches(name, [each for each in dir(self) if each[0] != "_"], 3):
            message += f"; expected {' or '.join(near)}"
        raise AttributeError(message, name=name, obj=self)

    def _repr_html_(self) -> str:
        """The same as a table, for notebooks."""
        rows = "".join(
            f'<tr><th style="text-align:left">{escape(key)}</th>'
            f'<td style="text-align:left">{escape(brief(value))}</td></tr>'
            for key, value in self._summary()
        )
        return f"<table><caption>{escape(type(self).__name__)}</caption>{rows}</table>"


def brief(value: object) -> str:
    """A value in a few words: arrays and long sequences by their shape or length.

    Args:
        value: Any object.
    """
    if isinstance(value, np.ndarray):
        if value.size <= _FEW:
            return np.array2string(value, separator=", ", precision=6).replace("\n", "")
        return f"array of shape {value.shape}"
    if isinstance(value, float):
        return f"{value:.8g}"
    if isinstance(value, Summarised):
        return " ".join(repr(value).split()) if len(repr(value)) <= WIDTH else type(value).__name__
    if isinstance(value, Mapping | Sequence) and not isinstance(value, str | bytes):
        text = _SHORT.repr(value)
        held = f"{len(value)} of {type(value[0]).__name__}" if _alike(value) else None
        return held or (text if len(text) <= WIDTH - 30 else f"{len(value)} entries")
    return type(value).__name__ if type(value).__repr__ is object.__repr__ else _SHORT.repr(value)


def _alike(value: Mapping[object, object] | Sequence[object]) -> bool:
    """Whether a sequence holds objects of the package, to be counted rather than printed."""
    return isinstance(value, Sequence) and len(value) > 0 and isinstance(value[0], Summarised)
