"""Patches of bicubic splines: exactly what a thin shell interpolates, whatever their knots.

Between its knots a bicubic spline is a bicubic; one whose inner knots are single or doubled has
continuous slopes. So it is the surface that a thin shell has with the spline's places, slopes and
mixed derivatives at the knots: with doubled knots unknowns are as many as control points. More
knots do not change the surface.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.interpolate import BSpline, make_interp_spline

from fem_lie._arrays import Array, numbers, whole
from fem_lie.bodies.thin_shells.patch import SmoothPatch, Surface, derivatives_of, from_rows, grid

_DEGREE = 3
_SMOOTH = 2
"""Times that an inner knot may be there so that slopes are continuous."""


def bspline_patch(
    knots_a: npt.ArrayLike,
    knots_b: npt.ArrayLike,
    controls: npt.ArrayLike,
    *,
    pieces: tuple[int, int] = (1, 1),
) -> SmoothPatch:
    """A patch that is a bicubic spline surface, exactly.

    Args:
        knots_a: Of the first parameter, increasing, four times at either end, shape (k,).
        knots_b: Of the second, shape (l,).
        controls: Control points, shape (k − 4, l − 4, 3).
        pieces: Equal cells into which each span between two knots is cut, along a and along b.

    Raises:
        ValueError: Knots do not increase, ends are not four times there, an inner knot is three
            times there, which is a kink, there are not as many control points as knots ask for, or
            slopes are zero or along each other.
    """
    points = numbers(controls, "bspline_patch: controls")
    knots, cuts = [], []
    for name, given, count in zip("ab", (knots_a, knots_b), pieces, strict=True):
        knots.append(numbers(given, f"bspline_patch: knots_{name}"))
        cuts.append(whole(count, f"bspline_patch: pieces along {name}"))
        _check_knots(knots[-1], name)
    wanted = tuple(len(each) - _DEGREE - 1 for each in knots)
    if points.shape != (*wanted, 3):
        raise ValueError(
            f"a bicubic spline of {len(knots[0])} and {len(knots[1])} knots has control points of "
            f"shape {(*wanted, 3)}, got {points.shape}"
        )
    at = [_cut(np.unique(each), count) for each, count in zip(knots, cuts, strict=True)]
    rows = [_evaluated(knots, points, at, orders) for orders in ((0, 0), (1, 0), (0, 1), (1, 1))]
    return from_rows(np.stack(rows, axis=2), (np.diff(at[0]), np.diff(at[1])))


def spline_patch(function: Surface, cells: tuple[int, int]) -> SmoothPatch:
    """The bicubic spline through places of a surface, with its slopes at the edges.

    Curvatures are continuous, as of a surface from a drawing; :func:`~fem_lie.smooth_patch` takes
    slopes everywhere.

    Args:
        function: ``function(a, b)``, shape (3,), a and b from 0 to 1.
        cells: Along a and along b.

    Raises:
        ValueError: As :func:`~fem_lie.smooth_patch`.
        TypeError: Likewise.
    """
    place, (a, b) = grid(function, cells, "spline_patch")
    given = np.empty((len(a) + 2, len(b) + 2, 3))
    inner = np.array([[place(s, t) for t in b] for s in a])
    given[1:-1, 1:-1] = inner
    for i, s in ((0, a[0]), (-1, a[-1])):
        found = np.array([derivatives_of(place, s, t) for t in b])
        given[i, 1:-1], given[i, [0, -1]] = found[:, 1], found[[0, -1], 3]
    for j, t in ((0, b[0]), (-1, b[-1])):
        given[1:-1, j] = [derivatives_of(place, s, t)[2] for s in a]
    along = _through(a, given)
    both = _through(b, along.c.swapaxes(0, 1))
    return bspline_patch(along.t, both.t, both.c.swapaxes(0, 1))


def _through(at: Array, given: Array) -> Any:
    """Spline along the first axis: its slope at the first place, all places, that at the last."""
    ends = [(1, given[0])], [(1, given[-1])]
    return make_interp_spline(at, given[1:-1], k=_DEGREE, bc_type=ends)


def _evaluated(
    knots: list[Array], points: Array, at: list[Array], orders: tuple[int, int]
) -> Array:
    """A derivative at a grid, shape (i, j, 3)."""
    first = BSpline(knots[0], points, _DEGREE)(at[0], nu=orders[0])
    second = BSpline(knots[1], first.swapaxes(0, 1), _DEGREE)(at[1], nu=orders[1])
    return np.asarray(second.swapaxes(0, 1))


def _cut(knots: Array, count: int) -> Array:
    """Each span in equal parts."""
    inner = knots[:-1, np.newaxis] + np.diff(knots)[:, np.newaxis] * np.arange(count) / count
    return np.append(inner.ravel(), knots[-1])


def _check_knots(knots: Array, name: str) -> None:
    if knots.ndim != 1 or len(knots) < 2 * (_DEGREE + 1) or (np.diff(knots) < 0).any():
        raise ValueError(
            f"knots of a cubic spline are eight or more that do not decrease, got {knots} along "
            f"{name}"
        )
    found, times = np.unique(knots, return_counts=True)
    if len(found) < 2 or times[0] != _DEGREE + 1 or times[-1] != _DEGREE + 1:
        raise ValueError(f"the first and last knot along {name} are there four times, got {knots}")
    kinks = found[1:-1][times[1:-1] > _SMOOTH]
    if len(kinks):
        raise ValueError(
            f"a thin shell has continuous slopes: inner knots along {name} are there once or "
            f"twice, but three times and more at {kinks}, where the surface may have a kink; cut "
            "it there"
        )
