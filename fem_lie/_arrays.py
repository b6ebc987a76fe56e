"""Checks of the arrays and names that make a mesh."""

from __future__ import annotations

import logging
import operator
from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt
from scipy.spatial import KDTree

from fem_lie._lines import Array, Indices
from fem_lie._wanted import LARGEST, numbers, shown, text

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


def whole_number(cells: int) -> int:
    """``cells`` as a number of at least 1, or ``ValueError``."""
    try:
        number = 0 if isinstance(cells, bool) else operator.index(cells)
    except TypeError:
        number = 0
    if number < 1:
        raise ValueError(f"cells must be a whole number of at least 1, got {cells!r}")
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
