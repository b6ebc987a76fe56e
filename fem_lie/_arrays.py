"""Checks of the arrays and names that make a mesh."""

from __future__ import annotations

import operator
from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from fem_lie._lines import Array, Indices


def whole_number(cells: int) -> int:
    """``cells`` as a number of at least 1, or ``ValueError``."""
    try:
        number = operator.index(cells)
    except TypeError:
        number = 0
    if number < 1:
        raise ValueError(f"cells must be a whole number of at least 1, got {cells!r}")
    return number


def points_of(value: npt.ArrayLike | Sequence[npt.ArrayLike]) -> Array:
    """Finite coordinates, shape (n, 3), or ``ValueError``."""
    points: Array = np.array(value, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3 or not len(points):
        raise ValueError(f"points must have shape (n, 3), got {points.shape}")
    bad = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(bad):
        raise ValueError(f"points must be finite; point {bad[0]} is {points[bad[0]]}")
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
    return {
        name: np.unique(indices_of(index, size, f"{what} of {name!r}"))
        for name, index in groups.items()
    }


def find_name(groups: Mapping[str, Indices], name: str, what: str) -> Indices:
    """The group of this name, or ``ValueError`` with those that exist."""
    if name not in groups:
        known = ", ".join(sorted(groups)) or "none"
        raise ValueError(f"the mesh has no {what} {name!r}; it has: {known}")
    return groups[name]
