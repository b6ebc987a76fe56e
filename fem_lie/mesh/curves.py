"""Line meshes from points and from functions of a parameter."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from math import radians

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import (
    Array,
    Indices,
    instance,
    points_of,
    whole_number,
)
from fem_lie.mesh.lines import LineMesh

_SHARP = radians(2.0)  # a turn of this size within 1e-4 of a cell is a kink


def straight(start: npt.ArrayLike, end: npt.ArrayLike, cells: int) -> LineMesh:
    """Straight line in equal cells; its ends are named "start" and "end".

    Raises:
        ValueError: The ends coincide or are not points, or there is no cell.
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
    """Straight pieces from corner to corner, each in equal cells; corners are corners at any angle.

    Its ends are named "start" and "end", the corners "corner 1", "corner 2" and so on; its pieces
    are the groups "piece 1", "piece 2" and so on. If the last point is the first one the line is
    closed: "start" is a corner, too, and there is no "end".

    Args:
        points: Ends and corners, shape (n, 3).
        cells: Of each piece, or of each piece its own number.

    Raises:
        ValueError: There are less than two points, successive ones coincide, a piece goes back on
            the one before it, or there are not as many numbers of cells as pieces.
    """
    x = points_of(points)
    if len(x) < 2:
        raise ValueError(f"a polyline needs two points or more, got {len(x)}")
    counts = _cells_of_pieces(cells, len(x) - 1)
    pieces = [straight(a, b, count) for (a, b), count in zip(pairwise(x), counts, strict=True)]
    closed = len(x) > 3 and bool(np.array_equal(x[0], x[-1]))
    last = x[:0] if closed else x[-1:]
    places = np.concatenate([*(piece.points[:-1] for piece in pieces), last])
    number = np.arange(sum(counts) + 1) % len(places)
    first = np.cumsum([0, *counts])
    names = {f"corner {k}": number[first[k : k + 1]] for k in range(1, len(counts))}
    ends = {"start": number[:1]} | ({} if closed else {"end": number[-1:]})
    groups: dict[str, Indices] = {
        f"piece {k}": np.arange(a, b) for k, (a, b) in enumerate(pairwise(first.tolist()), start=1)
    }
    tangents = np.concatenate([piece.tangents for piece in pieces])
    ends_of_cells = np.column_stack([number[:-1], number[1:]])
    return LineMesh(places, ends_of_cells, tangents, groups, ends | names)


def _cells_of_pieces(cells: int | Sequence[int], pieces: int) -> list[int]:
    given = [cells] * pieces if np.ndim(cells) == 0 else list(cells)  # type: ignore[arg-type]
    if len(given) != pieces:
        raise ValueError(f"wanted are numbers of cells of {pieces} pieces, got {len(given)}")
    return [whole_number(count) for count in given]  # type: ignore[arg-type]


def curve(
    function: Callable[[float], npt.ArrayLike],
    cells: int,
    *,
    derivative: Callable[[float], npt.ArrayLike] | None = None,
) -> LineMesh:
    """Smooth curve, cut at equal steps of its parameter; its ends are named "start" and "end".

    Args:
        function: Point at ``s``, shape (3,); s from 0 to 1.
        cells: Number of cells.
        derivative: Any vector along the tangent at ``s``, shape (3,). Default: differences of sixth
            order of ``function``, within [0, 1], good to about 1e-12.

    Raises:
        ValueError: The curve stands still somewhere, has a kink or is not finite, or there is no
            cell.
    """
    instance(function, Callable, "a curve", "a function of s from 0 to 1")
    s = np.linspace(0.0, 1.0, whole_number(cells) + 1)
    points = points_of([function(float(si)) for si in s])
    along = points_of([derivative(float(si)) if derivative else _slope(function, si) for si in s])
    speed = np.linalg.norm(along, axis=1, keepdims=True)
    if not speed.min() > 1e-10 * speed.max():
        raise ValueError(f"the curve has no tangent at s = {s[speed.argmin()]:g}")
    _refuse_kinks(function, np.asarray(s, dtype=np.float64))
    return _chain(points, along / speed)


def _refuse_kinks(function: Callable[[float], npt.ArrayLike], s: Array) -> None:
    """Narrow down where the curve turns most: on a smooth one the turn shrinks with the length."""
    for a, b in pairwise(float(si) for si in s):
        # half a cell further on each side, or a kink at a node is not seen
        low, high = max(0.0, 1.5 * a - 0.5 * b), min(1.0, 1.5 * b - 0.5 * a)
        turn = _turn(function, low, high)
        while turn > _SHARP and high - low > 1e-4 * (b - a):
            quarter = (high - low) / 4
            parts = [(low + k * quarter, low + (k + 2) * quarter) for k in range(3)]
            turn, (low, high) = max((_turn(function, *part), part) for part in parts)
        if turn > _SHARP:
            raise ValueError(
                f"the curve has a kink at s = {low:.4g}; make a "
                "LineMesh of its corners, or one beam of each smooth part"
            )


def _turn(function: Callable[[float], npt.ArrayLike], a: float, b: float) -> float:
    """Angle between the chords of the two halves of an interval, rad."""
    x = np.array([function(float(si)) for si in (a, 0.5 * (a + b), b)], dtype=np.float64)
    first, second = x[1] - x[0], x[2] - x[1]
    sine = np.linalg.norm(np.cross(first, second))
    return float(np.arctan2(sine, first @ second))


def _chain(points: Array, tangents: Array) -> LineMesh:
    number = np.arange(len(points) - 1)
    cells = np.column_stack([number, number + 1])
    ends = {"start": np.array([0]), "end": number[-1:] + 1}
    return LineMesh(points, cells, tangents[cells], {}, ends)


def _slope(function: Callable[[float], npt.ArrayLike], s: float) -> Array:
    """Derivative from seven points around ``s``, moved inward at the ends."""
    step, offsets = 2.0**-10, np.arange(-3.0, 4.0)
    centre = min(max(s, 3 * step), 1.0 - 3 * step)
    offsets += (centre - s) / step
    # weights that are exact for polynomials up to degree six
    weights = np.linalg.solve(np.vander(offsets, increasing=True).T, np.eye(7)[1])
    values = np.array([function(float(s + offset * step)) for offset in offsets], dtype=np.float64)
    return np.asarray(weights @ values / step, dtype=np.float64)
