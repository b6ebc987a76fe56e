"""Line meshes from points and from functions of a parameter."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from math import radians
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.interpolate import BSpline, CubicSpline

from fem_lie._arrays import (
    Array,
    Indices,
    direction,
    instance,
    numbers,
    points_of,
    positive,
    vector,
    whole_number,
)
from fem_lie.mesh.lines import LineMesh

_SHARP = radians(2.0)  # a turn of this size within 1e-4 of a cell is a kink
_SAME = 1e-9  # relative, of the two ends of a closed curve


class Spline(NamedTuple):
    """Cubic spline with double inner knots, by positions and derivatives at the knots.

    :class:`~fem_lie.SplineCable` takes all three, and :class:`~fem_lie.Rod` its :meth:`mesh`.

    Attributes:
        knots: Parameter ``u`` of the knots, increasing, shape (n,).
        positions: Positions at the knots, shape (n, 3).
        slopes: Derivatives ``dr/du`` at the knots, shape (n, 3).

    Example:
        >>> ring = fl.mesh.Spline.circle((0, 0, 0), 1.0, (0, 0, 1), cells=8)
        >>> ring.mesh().cells.shape
        (8, 2)
    """

    knots: Array
    positions: Array
    slopes: Array

    @classmethod
    def checked(
        cls, knots: npt.ArrayLike, positions: npt.ArrayLike, slopes: npt.ArrayLike
    ) -> Spline:
        """Spline from array-like arguments, checked.

        Args:
            knots: Parameters of the knots, shape (n,).
            positions: Positions, shape (n, 3).
            slopes: Derivatives with respect to the parameter, shape (n, 3).

        Raises:
            ValueError: Shapes do not agree, knots do not increase, or a derivative is zero.
        """
        x, u = points_of(positions), numbers(knots, "knots of a spline")
        rates = numbers(slopes, "slopes of a spline")
        if u.shape != (len(x),) or rates.shape != x.shape or len(x) < 2:
            raise ValueError(
                "a spline has two knots or more, with a position and a slope at each, got shapes "
                f"{u.shape}, {x.shape} and {rates.shape}"
            )
        if not (np.diff(u) > 0).all():
            raise ValueError(f"the knots of a spline increase, got {u}")
        speed = np.linalg.norm(rates, axis=1)
        if not speed.min() > _SAME * speed.max():
            k = int(speed.argmin())
            raise ValueError(f"slopes of a spline are not zero, but at knot {k} it is {rates[k]}")
        return cls(u, x, rates)

    @classmethod
    def of(cls, spline: BSpline, cells: int = 1) -> Spline:
        """Exact representation of a cubic spline of SciPy with double inner knots.

        Args:
            spline: Spline of degree 3, with control points of shape (n, 3).
            cells: Cells between two knots; the curve does not depend on it.

        Raises:
            ValueError: It has another degree or dimension, or an inner knot that is not double:
                with a simple knot, derivatives are not independent; a triple knot is a corner.
        """
        instance(spline, BSpline, "Spline.of: spline", "a scipy.interpolate.BSpline")
        if spline.k != 3 or np.shape(spline.c)[1:] != (3,):
            raise ValueError(
                "expected a cubic spline of control points of shape (n, 3), got one of degree "
                f"{spline.k} of shape {np.shape(spline.c)}"
            )
        begin, end = float(spline.t[3]), float(spline.t[len(spline.c)])
        knots, count = np.unique(spline.t, return_counts=True)
        inner = (knots > begin) & (knots < end)
        if not (count[inner] == 2).all():
            k = np.flatnonzero(inner & (count != 2))[0]
            raise ValueError(
                "inner knots of a spline are doubled here, for continuous slopes, but "
                f"{knots[k]:g} is there {count[k]} times: insert it again, or use Spline.through"
            )
        u = _divided(np.array([begin, *knots[inner], end]), whole_number(cells))
        return cls.checked(u, spline(u), spline.derivative()(u))

    @classmethod
    def through(cls, points: npt.ArrayLike, cells: int = 1) -> Spline:
        """Smooth cubic spline through points, with their distances as knots.

        It is closed if the last point equals the first.

        Args:
            points: Shape (n, 3).
            cells: Cells between two points.

        Raises:
            ValueError: Successive points coincide, or there are less than two.
        """
        x = points_of(points)
        steps = np.linalg.norm(np.diff(x, axis=0), axis=1)
        if len(x) < 2 or not steps.min() > 0:
            raise ValueError(f"expected two distinct points or more, got\n{x}")
        closed = len(x) > 3 and np.array_equal(x[0], x[-1])
        knots = np.concatenate([[0.0], np.cumsum(steps)])
        curve = CubicSpline(knots, x, bc_type="periodic" if closed else "not-a-knot")
        u = _divided(knots, whole_number(cells))
        positions = curve(u)
        if closed:
            positions[-1] = positions[0]
        return cls.checked(u, positions, curve(u, 1))

    @classmethod
    def circle(
        cls, centre: npt.ArrayLike, radius: float, normal: npt.ArrayLike, cells: int
    ) -> Spline:
        """Circle, approximated to sixth order by the best cubics for arcs.

        Args:
            centre: Centre, shape (3,).
            radius: Radius of the circle.
            normal: Normal of the plane, about which it is oriented, shape (3,).
            cells: Number of cubic pieces, 3 or more.

        Raises:
            ValueError: The radius is not positive, the normal is zero, or there are too few cells.
        """
        middle, r = vector(centre, 3, "centre of a circle"), positive(radius, "radius")
        e3 = direction(normal, "normal of a circle")
        if whole_number(cells) < 3:
            raise ValueError(f"a circle has 3 cells or more, got {cells}")
        e1 = np.cross(e3, np.eye(3)[np.abs(e3).argmin()])
        e1 /= np.linalg.norm(e1)
        e2, angle = np.cross(e3, e1), 2 * np.pi * np.arange(cells + 1) / cells
        angle[-1] = 0.0
        c, s = np.cos(angle[:, np.newaxis]), np.sin(angle[:, np.newaxis])
        speed = 4 * r * np.tan(np.pi / (2 * cells))
        positions, slopes = middle + r * (c * e1 + s * e2), speed * (c * e2 - s * e1)
        return cls.checked(range(cells + 1), positions, slopes)

    def mesh(self) -> LineMesh:
        """Line mesh with a cell between two knots and points "start" and "end".

        It is closed if the end has the position and derivative of the start.
        """
        u, positions, rates = self
        speeds = np.linalg.norm(rates, axis=1, keepdims=True)
        closed = _closed(positions, rates / speeds.max())
        slopes = np.diff(u)[:, np.newaxis] * np.column_stack([speeds[:-1], speeds[1:]])
        return _chain(positions, rates / speeds, closed=closed, slopes=slopes)


def _divided(knots: Array, cells: int) -> Array:
    """Knots with each interval divided into equal parts."""
    ξ = np.arange(cells) / cells
    inner = knots[:-1, np.newaxis] + ξ * np.diff(knots)[:, np.newaxis]
    return np.append(inner.ravel(), knots[-1])


def straight_line(start: npt.ArrayLike, end: npt.ArrayLike, cells: int) -> LineMesh:
    """Straight line of equal cells, with points "start" and "end".

    Args:
        start: First point, shape (3,).
        end: Last point, shape (3,).
        cells: Number of cells.
    """
    a, b = points_of([start, end])
    if np.array_equal(a, b):
        raise ValueError(f"a line must have a length, but start and end are both {a}")
    s = np.linspace(0.0, 1.0, whole_number(cells) + 1)[:, np.newaxis]
    unit = (b - a) / np.linalg.norm(b - a)
    return _chain((1.0 - s) * a + s * b, np.tile(unit, (len(s), 1)))


def polyline(
    points: Sequence[npt.ArrayLike] | npt.ArrayLike, cells: int | Sequence[int]
) -> LineMesh:
    """Straight segments of equal cells, with corners at any angle between them.

    Its ends are named "start" and "end", the corners "corner 1", "corner 2" and so on; its segments
    are the groups "piece 1", "piece 2" and so on. If the last point equals the first, the line is
    closed: "start" is a corner, too, and there is no "end".

    Args:
        points: Ends and corners, shape (n, 3).
        cells: Number of cells of each segment, one for all or one each.

    Raises:
        ValueError: There are less than two points, successive ones coincide, a segment reverses the
            one before it, or the number of entries of ``cells`` is not that of segments.
    """
    x = points_of(points)
    if len(x) < 2:
        raise ValueError(f"a polyline needs two points or more, got {len(x)}")
    counts = _cells_of_pieces(cells, len(x) - 1)
    pieces = [straight_line(a, b, count) for (a, b), count in zip(pairwise(x), counts, strict=True)]
    closed = len(x) > 3 and bool(np.array_equal(x[0], x[-1]))
    last = x[:0] if closed else x[-1:]
    positions = np.concatenate([*(piece.points[:-1] for piece in pieces), last])
    number = np.arange(sum(counts) + 1) % len(positions)
    first = np.cumsum([0, *counts])
    names = {f"corner {k}": number[first[k : k + 1]] for k in range(1, len(counts))}
    ends = {"start": number[:1]} | ({} if closed else {"end": number[-1:]})
    groups: dict[str, Indices] = {
        f"piece {k}": np.arange(a, b) for k, (a, b) in enumerate(pairwise(first.tolist()), start=1)
    }
    tangents = np.concatenate([piece.tangents for piece in pieces])
    ends_of_cells = np.column_stack([number[:-1], number[1:]])
    return LineMesh(positions, ends_of_cells, tangents, groups, ends | names)


def _cells_of_pieces(cells: int | Sequence[int], pieces: int) -> list[int]:
    given = [cells] * pieces if np.ndim(cells) == 0 else list(cells)  # type: ignore[arg-type]
    if len(given) != pieces:
        raise ValueError(
            f"polyline: expected numbers of cells of {pieces} pieces, got {len(given)}"
        )
    return [whole_number(count) for count in given]  # type: ignore[arg-type]


def curve(
    function: Callable[[float], npt.ArrayLike],
    cells: int,
    *,
    derivative: Callable[[float], npt.ArrayLike] | None = None,
) -> LineMesh:
    """Smooth curve, divided at equal steps of its parameter, with points "start" and "end".

    It is closed, without "end", if the end has the position and tangent of the start.

    Args:
        function: Point at ``s``, shape (3,); s from 0 to 1.
        cells: Number of cells.
        derivative: Any vector along the tangent at ``s``, shape (3,). Default: finite differences
            of sixth order of ``function``, within [0, 1], accurate to about 1e-12.

    Raises:
        ValueError: The derivative vanishes somewhere, the curve has a kink or is not finite, or
            there is no cell.
    """
    instance(function, Callable, "a curve", "a function of s from 0 to 1")
    s = np.linspace(0.0, 1.0, whole_number(cells) + 1)
    points = points_of([function(float(si)) for si in s])
    along = points_of([derivative(float(si)) if derivative else _slope(function, si) for si in s])
    speed = np.linalg.norm(along, axis=1, keepdims=True)
    if not speed.min() > 1e-10 * speed.max():
        raise ValueError(f"the curve has no tangent at s = {s[speed.argmin()]:g}")
    _refuse_kinks(function, np.asarray(s, dtype=np.float64))
    tangents = along / speed
    return _chain(points, tangents, closed=_closed(points, tangents))


def _refuse_kinks(function: Callable[[float], npt.ArrayLike], s: Array) -> None:
    """Bisect towards the largest rotation of the tangent: on a smooth curve it decreases."""
    for a, b in pairwise(float(si) for si in s):
        # half a cell further on each side, or a kink at a node is not seen
        low, high = max(0.0, 1.5 * a - 0.5 * b), min(1.0, 1.5 * b - 0.5 * a)
        turn = _turn(function, low, high)
        while turn > _SHARP and high - low > 1e-4 * (b - a):
            quarter = (high - low) / 4
            parts = [(low + k * quarter, low + (k + 2) * quarter) for k in range(3)]
            turn, (low, high) = max((_turn(function, *part), part) for part in parts)
        if turn > _SHARP:
            made = "make a LineMesh of its corners, or one beam of each smooth part"
            raise ValueError(f"the curve has a kink at s = {low:.4g}; {made}")


def _turn(function: Callable[[float], npt.ArrayLike], a: float, b: float) -> float:
    """Angle between the chords of the two halves of an interval, rad."""
    x = np.array([function(float(si)) for si in (a, 0.5 * (a + b), b)], dtype=np.float64)
    first, second = x[1] - x[0], x[2] - x[1]
    sine = np.linalg.norm(np.cross(first, second))
    return float(np.arctan2(sine, first @ second))


def _closed(points: Array, tangents: Array) -> bool:
    """Whether a smooth line of three cells or more ends where, and as, it begins."""
    gap, turn = np.abs(points[-1] - points[0]).max(), np.abs(tangents[-1] - tangents[0]).max()
    return len(points) > 3 and bool(gap <= _SAME * np.ptp(points, axis=0).max() and turn <= _SAME)


def _chain(
    points: Array, tangents: Array, *, closed: bool = False, slopes: Array | None = None
) -> LineMesh:
    """Cells between successive points; the last point of a closed line is the first."""
    kept = len(points) - closed
    number = np.arange(len(points)) % kept
    along = np.stack([tangents[:-1], tangents[1:]], axis=1)
    names = {"start": number[:1]} | ({} if closed else {"end": number[-1:]})
    cells = np.column_stack([number[:-1], number[1:]])
    return LineMesh(points[:kept], cells, along, {}, names, slopes=slopes)


def _slope(function: Callable[[float], npt.ArrayLike], s: float) -> Array:
    """Derivative from seven points around ``s``, one-sided at the ends."""
    step, offsets = 2.0**-10, np.arange(-3.0, 4.0)
    centre = min(max(s, 3 * step), 1.0 - 3 * step)
    offsets += (centre - s) / step
    # weights that are exact for polynomials up to degree six
    weights = np.linalg.solve(np.vander(offsets, increasing=True).T, np.eye(7)[1])
    values = np.array([function(float(s + offset * step)) for offset in offsets], dtype=np.float64)
    return np.asarray(weights @ values / step, dtype=np.float64)
