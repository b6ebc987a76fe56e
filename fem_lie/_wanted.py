"""Whether an argument is of the kind that is wanted; the message says what was given instead."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

LARGEST = 1e75
"""Above, the fourth power of a length is no number any more."""

Chosen = TypeVar("Chosen", bound=Enum)


def shown(value: object) -> str:
    """What a message says of a value: a number or word as it is, other things by class and name."""
    label = "" if isinstance(value, type) else getattr(value, "label", "")
    if isinstance(label, str) and label:
        return f"the {type(value).__name__} {label!r}"
    text = repr(value)
    return text if len(text) <= 100 else f"{text[:100]} … of {type(value).__name__}"


def instance(value: object, kind: Any, what: str, wanted: str) -> None:
    """Refuse what is not of a class, or of one of several.

    Args:
        value: What was given.
        kind: As for ``isinstance``.
        what: For what, as "PointLoad: point".
        wanted: What it is to be, in words.

    Raises:
        TypeError: It is something else.
    """
    if not isinstance(value, kind):
        raise TypeError(f"{what} must be {wanted}, got {shown(value)}")


def number(value: object, what: str) -> float:
    """``value`` as a finite real number.

    Raises:
        ValueError: It is not finite, or so large that its powers are not.
        TypeError: It is no number.
    """
    array = np.asarray(value)
    if array.ndim or array.dtype.kind not in "iufb":
        raise TypeError(f"{what} must be a number, got {shown(value)}")
    if not np.isfinite(array):
        raise ValueError(f"{what} must be a finite number, got {value!r}")
    found = float(array)
    if not abs(found) < LARGEST:
        raise ValueError(f"{what} must be a number below {LARGEST:g}, got {value!r}")
    return found


def numbers(value: object, what: str) -> npt.NDArray[np.float64]:
    """A copy of ``value`` as an array of real numbers of any shape, finite or not.

    Raises:
        TypeError: It is no array of numbers.
    """
    try:
        array = np.array(value)
    except ValueError:
        raise TypeError(f"{what} must be an array of numbers, got {shown(value)}") from None
    if array.dtype.kind not in "iufb":
        raise TypeError(f"{what} must be an array of numbers, got {shown(value)}")
    return array.astype(np.float64)


def positive(value: object, what: str) -> float:
    """``value`` as a finite number above zero; errors as for :func:`number`."""
    found = number(value, what)
    if not found > 0.0:
        raise ValueError(f"{what} must be a positive finite number, got {value!r}")
    if not found > 1.0 / LARGEST:
        raise ValueError(f"{what} must be a number above {1.0 / LARGEST:g}, got {value!r}")
    return found


def choice(value: object, kind: type[Chosen], what: str) -> Chosen:
    """A member of an enumeration, given by itself or by its value.

    Raises:
        ValueError: It is none.
    """
    try:
        return kind(value)
    except ValueError:
        known = ", ".join(str(member) for member in kind)
        raise ValueError(f"{what} must be one of {known}, got {shown(value)}") from None


def whole(value: object, what: str, least: int = 1) -> int:
    """``value`` as a whole number of at least ``least``.

    Raises:
        ValueError: It is less.
        TypeError: It is no whole number.
    """
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        raise TypeError(f"{what} must be a whole number, got {shown(value)}")
    if value < least:
        raise ValueError(f"{what} must be at least {least}, got {value}")
    return int(value)


def history(value: object, what: str) -> None:
    """Refuse what is neither a function of time nor ``None``.

    Raises:
        TypeError: It is something else.
    """
    if value is not None and not callable(value):
        raise TypeError(f"{what} must be a function of time or None, got {shown(value)}")


def at_time(function: Callable[[float], Any], time: float, what: str) -> float:
    """What a function of time gives, finite or not.

    Args:
        function: The function.
        time: The time.
        what: Its name for messages.

    Raises:
        TypeError: It gives no number.
    """
    found = function(time)
    if isinstance(found, float):
        return found
    array = np.asarray(found)
    if array.ndim or array.dtype.kind not in "iufb":
        raise TypeError(f"{what} must give a number; at time {time:g} it gave {shown(found)}")
    return float(array)


def flag(value: object, what: str) -> None:
    """Refuse what is neither true nor false.

    Raises:
        TypeError: It is something else.
    """
    instance(value, bool | np.bool_, what, "True or False")


def text(value: object, what: str) -> None:
    """Refuse what is no word.

    Raises:
        TypeError: It is something else.
    """
    instance(value, str, what, "a word")
