"""Types of arrays, and validation of arguments: numbers, arrays, names, classes."""

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
"""Array of floating point numbers."""

Indices: TypeAlias = npt.NDArray[np.int64]
"""Array of integers: numbers of nodes, cells and so on."""

Flags: TypeAlias = npt.NDArray[np.bool_]
"""Array of booleans."""

Scalar = TypeVar("Scalar", np.float64, np.complex128)
"""Type of the numbers in an array that may be complex."""


_log = logging.getLogger(__name__)

_SAME_POINT = 1e-9  # distance of coincident points over the size of the body


def log_coincident(what: str, points: Array) -> None:
    """Log a warning if points of a body coincide: cells without a common point are not joined."""
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    pairs = KDTree(points).query_pairs(_SAME_POINT * size, output_type="ndarray")
    if len(pairs):
        a, b = min(pairs.tolist())
        _log.warning(
            "%s has %d pairs of points at the same position, the first are %d and %d at %s: cells "
            "that do not share a point are not joined",
            *(what, len(pairs), a, b, points[a]),
        )


def diameter(points: Array) -> float:
    """Largest distance of two points, shape (n, 3), independent of the axes.

    It is found by going from point to farthest point, which may underestimate it a little for
    clouds without corners.
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
    """Validate a number of cells: an integer from 1 to :data:`MOST`, or ``ValueError``."""
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
    """Validate finite coordinates of shape (n, 3), or ``ValueError``."""
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
    """Validate integers from 0 to ``size − 1``, or ``ValueError``."""
    if callable(value):
        raise ValueError(
            f"{what} must be whole numbers, got a function: parts of a mesh by their positions are "
            "named by mesh.named(…)"
        )
    index = np.asarray(value)
    if index.size and index.dtype.kind not in "iu":
        raise ValueError(f"{what} must be whole numbers, got {index.dtype}")
    if index.size and not (0 <= index.min() and index.max() < size):
        raise ValueError(f"{what} must be in 0 … {size - 1}, got {index.min()} … {index.max()}")
    return index.astype(np.int64)


def members_of(groups: Mapping[str, npt.ArrayLike], size: int, what: str) -> dict[str, Indices]:
    """Sorted member numbers of each group, or ``ValueError``."""
    members = {
        name: np.unique(indices_of(index, size, f"{what} of {name!r}"))
        for name, index in groups.items()
    }
    for name, index in members.items():
        if not len(index):
            raise ValueError(f"{what} of {name!r} are none; leave the name out")
    return members


def find_name(groups: Mapping[str, Indices], name: str, what: str) -> Indices:
    """The group of this name; ``ValueError`` with the existing names if there is none."""
    text(name, f"the name of a {what}")
    if name not in groups:
        known = ", ".join(sorted(groups)) or "none"
        raise ValueError(f"the mesh has no {what} {name!r}; it has: {known}")
    return groups[name]


Where: TypeAlias = Callable[[Array], npt.ArrayLike]
"""Function of positions, shape (3, n), that returns n truth values."""


def entities_where(where: Where, x: Array, entities: Indices, what: str) -> Indices:
    """Rows of ``entities`` (e, k) whose nodes are all where a function of positions says.

    Args:
        where: Function of positions, shape (3, n), that returns n truth values, as the markers of
            ``dolfinx.mesh.locate_entities``.
        x: Positions of all nodes, shape (n, 3).
        entities: Nodes of each entity, shape (e, k).
        what: Name of what is chosen, for messages.

    Raises:
        ValueError: The function returns anything else, or no entity is there.
    """
    inside = np.asarray(where(np.ascontiguousarray(x.T)))
    if inside.shape != (len(x),) or inside.dtype != np.bool_:
        raise ValueError(
            f"{what}: expected a function of positions, shape (3, n), that returns n truth values; "
            f"got shape {inside.shape} of {inside.dtype} for {len(x)} positions"
        )
    rows = np.flatnonzero(inside[entities].all(axis=1))
    if not len(rows):
        spot = x[np.unique(entities)]
        raise ValueError(
            f"{what}: nothing is there; {int(inside.sum())} nodes are, but no part has all of its "
            f"corners among them; x is in {spot.min(axis=0).tolist()} … {spot.max(axis=0).tolist()}"
        )
    return rows


LARGEST = 1e75
"""Largest admissible magnitude: the fourth power of a larger length overflows."""

Chosen = TypeVar("Chosen", bound=Enum)


def shown(value: object) -> str:
    """Text of a value for messages: numbers and words as they are, objects by class and label."""
    label = "" if isinstance(value, type) else getattr(value, "label", "")
    if isinstance(label, str) and label:
        return f"the {type(value).__name__} {label!r}"
    text = repr(value)
    return text if len(text) <= 100 else f"{text[:100]} … of {type(value).__name__}"


def instance(value: object, kind: Any, what: str, expected: str) -> None:
    """Raise ``TypeError`` unless a value is an instance of a class.

    Args:
        value: The value.
        kind: Class or classes, as for ``isinstance``.
        what: Name of the argument, as "PointLoad: point".
        expected: Description of the classes.

    Raises:
        TypeError: The value has another type.
    """
    if not isinstance(value, kind):
        raise TypeError(f"{what} must be {expected}, got {shown(value)}")


def number(value: object, what: str) -> float:
    """``value`` as a finite real number.

    Raises:
        ValueError: It is not finite, or its magnitude exceeds :data:`LARGEST`.
        TypeError: It is not a number.
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
    """Copy of ``value`` as an array of real numbers of any shape, finite or not.

    Raises:
        TypeError: It is not an array of numbers.
    """
    try:
        array = np.array(value)
    except ValueError:
        raise TypeError(f"{what} must be an array of numbers, got {shown(value)}") from None
    if array.dtype.kind not in "iufb":
        raise TypeError(f"{what} must be an array of numbers, got {shown(value)}")
    return array.astype(np.float64)


def positive(value: object, what: str) -> float:
    """``value`` as a finite positive number; errors as for :func:`number`."""
    found = number(value, what)
    if not found > 0.0:
        raise ValueError(f"{what} must be a positive finite number, got {value!r}")
    if not found > 1.0 / LARGEST:
        raise ValueError(f"{what} must be a number above {1.0 / LARGEST:g}, got {value!r}")
    return found


def positive_or_zero(value: object, what: str) -> float:
    """Zero, or ``value`` as a positive number; errors as for :func:`positive`."""
    return 0.0 if number(value, what) == 0.0 else positive(value, what)


def choice(value: object, kind: type[Chosen], what: str) -> Chosen:
    """Member of an enumeration, from the member or its value.

    Raises:
        ValueError: There is no such member.
    """
    try:
        return kind(value)
    except ValueError:
        known = ", ".join(str(member) for member in kind)
        raise ValueError(f"{what} must be one of {known}, got {shown(value)}") from None


def whole(value: object, what: str, least: int = 1) -> int:
    """``value`` as an integer from ``least`` to :data:`MOST`.

    Raises:
        ValueError: It is out of range.
        TypeError: It is not an integer.
    """
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        raise TypeError(f"{what} must be a whole number, got {shown(value)}")
    if value < least:
        raise ValueError(f"{what} must be at least {least}, got {value}")
    if value > MOST:
        raise ValueError(f"{what} must be at most {MOST}, got {value}")
    return int(value)


def history(value: object, what: str) -> None:
    """Raise ``TypeError`` unless ``value`` is a function of time or ``None``.

    Raises:
        TypeError: It is neither.
    """
    if value is not None and not callable(value):
        raise TypeError(f"{what} must be a function of time or None, got {shown(value)}")


def at_time(function: Callable[[float], Any], time: float, what: str) -> float:
    """Value of a function of time, finite or not.

    Args:
        function: The function.
        time: The time.
        what: Name of the function in messages.

    Raises:
        TypeError: The value is not a number.
    """
    found = function(time)
    if isinstance(found, float):
        return found
    array = np.asarray(found)
    if array.ndim or array.dtype.kind not in "iufb":
        raise TypeError(f"{what} must give a number; at time {time:g} it gave {shown(found)}")
    return float(array)


def flag(value: object, what: str) -> None:
    """Raise ``TypeError`` unless ``value`` is a boolean.

    Raises:
        TypeError: It is not a boolean.
    """
    instance(value, bool | np.bool_, what, "True or False")


def text(value: object, what: str) -> None:
    """Raise ``TypeError`` unless ``value`` is a string.

    Raises:
        TypeError: It is not a string.
    """
    instance(value, str, what, "a word")


def vector(value: npt.ArrayLike, size: int, what: str) -> Array:
    """``value`` as finite numbers of shape ``(size,)``.

    Raises:
        ValueError: It is not; the message names the argument.
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


def vectors_at(
    function: Callable[[Array], npt.ArrayLike], points: Array, size: int, what: str
) -> Array:
    """Values of a user's function at points, (n, 3), as finite numbers of shape (n, size).

    Raises:
        ValueError: A value is not; the message names the argument and the point.
    """
    found = np.empty((len(points), size))
    for k in range(len(points)):
        x = points[k]
        value = function(x)
        try:
            found[k] = vector(value, size, what)
        except ValueError:  # the text of a point takes longer to make than its value
            found[k] = vector(value, size, f"{what} at {x}")
    return found


def direction(value: npt.ArrayLike, what: str) -> Array:
    """Unit vector along ``value``, shape (3,), for any length of ``value``.

    Raises:
        ValueError: It is zero, or not three finite numbers.
    """
    given = vector(value, 3, what)
    largest = np.abs(given).max()
    if largest == 0.0:
        raise ValueError(f"{what} must not be zero, got {value!r}")
    # squares of very small or large numbers under- or overflow
    scaled = given / largest
    return np.asarray(scaled / np.linalg.norm(scaled))


_ORTHOGONAL = 1e-8


def rotation_matrix(value: npt.ArrayLike, what: str) -> Array:
    """``value`` as a rotation matrix, shape (3, 3).

    Raises:
        ValueError: It is none; the message names the argument.
    """
    R = numbers(value, what)
    orthogonal = R.shape == (3, 3) and np.abs(R.T @ R - np.eye(3)).max() <= _ORTHOGONAL
    if not orthogonal or np.linalg.det(R) < 0:
        raise ValueError(f"{what} must be a proper orthogonal 3×3 matrix, got {value!r}")
    return R


def members_within(groups: Mapping[str, Indices], chosen: Indices) -> dict[str, Indices]:
    """Members of each group among the chosen ones, numbered as in ``chosen``, which ascends."""
    return {name: np.flatnonzero(np.isin(chosen, members)) for name, members in groups.items()}
