"""Types of arrays, and checks of what is given: numbers, names, kinds of arguments."""

from __future__ import annotations

import logging
import operator
from collections.abc import Callable, Mapping, Sequence
from enum import Enum
from typing import Any, TypeAlias, TypeVar

import numpy as np
import numpy.typing as npt
from scipy.spatial import KDTree

Array: TypeAlias = npt.NDArray[np.float64]
"""Numbers."""

Indices: TypeAlias = npt.NDArray[np.int64]
"""Numbers of nodes, cells and so on."""

Flags: TypeAlias = npt.NDArray[np.bool_]
"""Yes or no."""


_log = logging.getLogger(__name__)

_SAME_PLACE = 1e-9  # of the size of what the points are of


def log_coincident(what: str, points: Array) -> None:
    """Say in the log where several points of a body are at one place: nothing joins them there."""
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    pairs = KDTree(points).query_pairs(_SAME_PLACE * size, output_type="ndarray")
    if len(pairs):
        a, b = min(pairs.tolist())
        _log.warning(
            "%s has %d pairs of points at the same place, the first are %d and %d at %s: cells "
            "that do not share a point are not joined",
            *(what, len(pairs), a, b, points[a]),
        )


def diameter(points: Array) -> float:
    """The largest distance of two points, however they lie; shape (n, 3).

    Found from point to farthest point, which may miss a little of it in clouds without corners.
    """
    start, found = points.mean(axis=0), -1.0
    while True:
        away = np.linalg.norm(points - start, axis=1)
        if not away.max() > found * (1.0 + 1e-12):
            return float(away.max())
        found, start = float(away.max()), points[away.argmax()]


MOST = 2**31 - 1
"""Largest count: DOLFINx and PETSc have indices of 32 bits."""


def whole_number(cells: int) -> int:
    """``cells`` as a number from 1 to :data:`MOST`, or ``ValueError``."""
    try:
        number = 0 if isinstance(cells, bool) else operator.index(cells)
    except TypeError:
        number = 0
    if number < 1:
        raise ValueError(f"cells must be a whole number of at least 1, got {cells!r}")
    if number > MOST:
        raise ValueError(f"cells must be at most {MOST}, got {cells!r}")
    return number


def points_of(value: npt.ArrayLike | Sequence[npt.ArrayLike]) -> Array:
    """Finite coordinates, shape (n, 3), or ``ValueError``."""
    try:
        points = numbers(value, "points")
    except TypeError:
        raise ValueError(f"points must be numbers of shape (n, 3), got {shown(value)}") from None
    if points.ndim != 2 or points.shape[1] != 3 or not len(points):
        raise ValueError(f"points must have shape (n, 3), got {points.shape}")
    bad = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(bad):
        raise ValueError(f"points must be finite; point {bad[0]} is {points[bad[0]]}")
    far = np.flatnonzero(~(np.abs(points) < LARGEST).all(axis=1))
    if len(far):
        raise ValueError(f"points must be below {LARGEST:g}; point {far[0]} is {points[far[0]]}")
    return points


def indices_of(value: npt.ArrayLike, size: int, what: str) -> Indices:
    """Whole numbers below ``size``, or ``ValueError``."""
    index = np.asarray(value)
    if index.size and index.dtype.kind not in "iu":
        raise ValueError(f"{what} must be whole numbers, got {index.dtype}")
    if index.size and not (0 <= index.min() and index.max() < size):
        raise ValueError(f"{what} must be in 0 … {size - 1}, got {index.min()} … {index.max()}")
    return index.astype(np.int64)


def members_of(groups: Mapping[str, npt.ArrayLike], size: int, what: str) -> dict[str, Indices]:
    """Sorted numbers of the members of each group, or ``ValueError``."""
    members = {
        name: np.unique(indices_of(index, size, f"{what} of {name!r}"))
        for name, index in groups.items()
    }
    for name, index in members.items():
        if not len(index):
            raise ValueError(f"{what} of {name!r} are none; leave the name out")
    return members


def find_name(groups: Mapping[str, Indices], name: str, what: str) -> Indices:
    """The group of this name, or ``ValueError`` with those that exist."""
    text(name, f"the name of a {what}")
    if name not in groups:
        known = ", ".join(sorted(groups)) or "none"
        raise ValueError(f"the mesh has no {what} {name!r}; it has: {known}")
    return groups[name]


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


def positive_or_zero(value: object, what: str) -> float:
    """Zero, or ``value`` as :func:`positive` has it, whose errors it raises."""
    return 0.0 if number(value, what) == 0.0 else positive(value, what)


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
    """``value`` as a whole number from ``least`` to :data:`MOST`.

    Raises:
        ValueError: It is less or more.
        TypeError: It is no whole number.
    """
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        raise TypeError(f"{what} must be a whole number, got {shown(value)}")
    if value < least:
        raise ValueError(f"{what} must be at least {least}, got {value}")
    if value > MOST:
        raise ValueError(f"{what} must be at most {MOST}, got {value}")
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


def vector(value: npt.ArrayLike, size: int, what: str) -> Array:
    """``value`` as finite numbers of shape ``(size,)``.

    Raises:
        ValueError: It is something else; the message says what was given for what.
    """
    try:
        array = numbers(value, what)
    except TypeError:
        raise ValueError(f"{what} must be {size} numbers, got {value!r}") from None
    if array.shape != (size,) or not np.isfinite(array).all():
        raise ValueError(f"{what} must be {size} finite numbers, got {value!r}")
    if not (np.abs(array) < LARGEST).all():
        raise ValueError(f"{what} must be {size} numbers below {LARGEST:g}, got {value!r}")
    return array


def direction(value: npt.ArrayLike, what: str) -> Array:
    """A unit vector along ``value``, shape (3,), however long that is.

    Raises:
        ValueError: It is zero, or not three finite numbers.
    """
    given = vector(value, 3, what)
    largest = np.abs(given).max()
    if largest == 0.0:
        raise ValueError(f"{what} must not be zero, got {value!r}")
    # squares of very small or large numbers are none
    scaled = given / largest
    return np.asarray(scaled / np.linalg.norm(scaled))
