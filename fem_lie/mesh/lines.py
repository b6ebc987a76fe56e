"""Line meshes in space: points, cells with tangents at both ends, named groups and points.

A mesh comes from a helper (:func:`straight`, :func:`polyline`, :func:`curve`), from gmsh or DOLFINx
(:mod:`fem_lie.mesh.reading`), or from bare arrays (:meth:`LineMesh.from_cells`). A corner is a
corner, unless points are said to lie on a curve.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from math import pi, radians

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import (
    Array,
    Indices,
    find_name,
    indices_of,
    instance,
    members_of,
    number,
    numbers,
    points_of,
    whole_number,
)
from fem_lie.mesh.tangents import circle_tangents, flipped, join_tangents, valence

CORNER_ANGLE = radians(1.0)
"""What turns by less is straight: coordinates have so many digits."""

KINK_ANGLE = radians(40.0)
"""Of points on a curve: a circle of ten cells is still smooth, a corner of 45 degrees is not."""

_SHARP = radians(2.0)  # a turn of this size within 1e-4 of a cell is a kink


@dataclass(frozen=True, eq=False)
class LineMesh:
    """Straight or curved lines cut into cells; they may branch.

    Attributes:
        points: Coordinates, shape (n, 3); every point belongs to a cell.
        cells: Pairs of points, shape (m, 2).
        tangents: Unit tangents at the two ends of each cell, from its first to its second point,
            shape (m, 2, 3). The two sides of a point differ at a kink or branch.
        groups: Cells of each named group.
        named_points: Points of each name.

    Raises:
        ValueError: Something is not finite, has the wrong shape or is out of range; a cell has no
            length, stands there twice or lies on another; a point has no cell.
    """

    points: Array
    cells: Indices
    tangents: Array
    groups: Mapping[str, Indices] = field(default_factory=dict)
    named_points: Mapping[str, Indices] = field(default_factory=dict)

    def __post_init__(self) -> None:
        points, cells = points_of(self.points), _cells(self.cells, len(self.points))
        _check_cells(points, cells)
        tangents = _tangents(self.tangents, len(cells))
        # also refuses nan
        if not (np.abs(np.linalg.norm(tangents, axis=-1) - 1.0) < 1e-6).all():
            raise ValueError("tangents must be unit vectors")
        for name, value in (
            ("points", points),
            ("cells", cells),
            ("tangents", tangents),
            ("groups", members_of(self.groups, len(cells), "cells")),
            ("named_points", members_of(self.named_points, len(points), "points")),
        ):
            object.__setattr__(self, name, value)

    @classmethod
    def from_cells(
        cls,
        points: npt.ArrayLike,
        cells: npt.ArrayLike,
        *,
        tangents: npt.ArrayLike | None = None,
        groups: Mapping[str, npt.ArrayLike] | None = None,
        named_points: Mapping[str, npt.ArrayLike] | None = None,
        kink_angle: float = CORNER_ANGLE,
    ) -> LineMesh:
        """Mesh from bare arrays; straight cells with corners, or arcs where a curve is asked for.

        Cells are turned round where needed, so that along a line each follows the one before it;
        the one with the lowest number keeps its direction.

        Args:
            points: Coordinates, shape (n, 3).
            cells: Pairs of points, shape (m, 2).
            tangents: Those that are known, as in the class, nan elsewhere. Where the two sides of a
                point differ by less than a degree both get their mean.
            groups: Cells of each named group.
            named_points: Points of each name.
            kink_angle: Where successive chords turn by more than this angle, rad, the line has a
                corner, and the tangents on both sides are the chords. Where they turn by less they
                are those of the circle through three successive points: exact on circles, second
                order on other smooth lines. For points on a curve give more than the default of one
                degree: 40 degrees make a circle of ten cells smooth.

        Raises:
            ValueError: See the class.
        """
        check_kink_angle(kink_angle)
        x = points_of(points)
        given = _cells(cells, len(x))
        _check_cells(x, given)
        flip = flipped(given, len(x))
        directed = np.where(flip[:, np.newaxis], given[:, ::-1], given)
        found = circle_tangents(x, directed, kink_angle)
        if tangents is not None:
            known = _tangents(tangents, len(given))
            known = np.where(flip[:, np.newaxis, np.newaxis], -known[:, ::-1], known)
            found = join_tangents(directed, np.where(np.isfinite(known), known, found), len(x))
        return cls(
            x,
            directed,
            found,
            members_of(groups or {}, len(given), "cells"),
            members_of(named_points or {}, len(x), "points"),
        )

    @property
    def branching_points(self) -> Indices:
        """Points at which more than two cells meet."""
        return np.flatnonzero(valence(self.cells, len(self.points)) > 2)

    def group(self, name: str) -> Indices:
        """Cells of a group.

        Raises:
            ValueError: There is no such group; the message lists those that exist.
        """
        return find_name(self.groups, name, "group of cells")

    def named(self, name: str) -> Indices:
        """Points of a name.

        Raises:
            ValueError: There is no such name; the message lists those that exist.
        """
        return find_name(self.named_points, name, "named point")

    def part(self, group: str) -> LineMesh:
        """The mesh of one group, with the names that it contains.

        Raises:
            ValueError: There is no such group; the message lists those that exist.
        """
        index = self.group(group)
        used, local = np.unique(self.cells[index], return_inverse=True)
        groups = {
            name: np.flatnonzero(np.isin(index, cells)) for name, cells in self.groups.items()
        }
        names = {
            name: np.flatnonzero(np.isin(used, points))
            for name, points in self.named_points.items()
        }
        return LineMesh(
            self.points[used],
            local.reshape(-1, 2),
            self.tangents[index],
            {name: cells for name, cells in groups.items() if len(cells)},
            {name: points for name, points in names.items() if len(points)},
        )


def check_kink_angle(kink_angle: float) -> None:
    """Raise ``ValueError`` if it is no angle in rad."""
    number(kink_angle, "kink_angle")
    if not 0.0 <= kink_angle <= pi:
        raise ValueError(f"kink_angle must be between 0 and pi, got {kink_angle!r}")


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


def _cells(value: npt.ArrayLike, points: int) -> Indices:
    cells = np.asarray(value)
    if cells.ndim != 2 or cells.shape[1] != 2 or not len(cells):
        raise ValueError(f"cells must be pairs of points, shape (m, 2), got {cells.shape}")
    return indices_of(cells, points, "cells")


def _tangents(value: npt.ArrayLike, cells: int) -> Array:
    tangents = numbers(value, "tangents")
    if tangents.shape != (cells, 2, 3):
        raise ValueError(f"tangents must have shape ({cells}, 2, 3), got {tangents.shape}")
    return tangents


def _check_cells(points: Array, cells: Indices) -> None:
    length = np.linalg.norm(points[cells[:, 1]] - points[cells[:, 0]], axis=1)
    # two points of one place, up to the digits with which they are given
    short = np.flatnonzero(length <= 1e-14 * np.abs(points).max())
    if len(short):
        a, b = cells[short[0]]
        raise ValueError(
            f"cell {short[0]} has no length: its points {a} and {b} are both at {points[a]}"
        )
    _, first, count = np.unique(
        np.sort(cells, axis=1), axis=0, return_index=True, return_counts=True
    )
    if (count > 1).any():
        twice = first[count > 1][0]
        raise ValueError(f"cell {twice} (points {cells[twice]}) stands there twice")
    alone = np.flatnonzero(valence(cells, len(points)) == 0)
    if len(alone):
        raise ValueError(f"{len(alone)} points have no cell, the first is {alone[0]}")
    _refuse_overlaps(points, cells)


def _refuse_overlaps(points: Array, cells: Indices) -> None:
    """Raise ``ValueError`` if two cells leave a point in one direction."""
    point = cells.ravel()
    away = points[cells[:, ::-1].ravel()] - points[point]
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    order = np.argsort(point, kind="stable")
    for step in range(1, int(valence(cells, len(points)).max())):
        a, b = order[:-step], order[step:]
        same = point[a] == point[b]
        a, b = a[same], b[same]
        on_top = np.flatnonzero(np.linalg.norm(away[a] - away[b], axis=1) < CORNER_ANGLE)
        if len(on_top):
            first, second = sorted((a[on_top[0]] // 2, b[on_top[0]] // 2))
            place = points[point[a[on_top[0]]]]
            raise ValueError(
                f"cells {first} and {second} lie on top of each other at {place}: the line goes "
                "back on itself there"
            )
