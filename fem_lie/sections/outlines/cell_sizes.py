"""Sizes of a section's cells, from its outlines."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array
from fem_lie.sections.outlines.outline import TOUCH, Part, cross

_WALL_CELL = 0.5  # size of cells in a wall over its thickness
_CORNER_CELL = 0.01  # the same at a re-entrant corner
_LARGEST_CELL = 0.125  # size of cells over the diameter of the outline
_MOST_CELLS = 100_000
_SHARP = 0.3  # angle; more than chords of an arc turn by
_CLOSE = 1e-6  # of the length of a chord
_SIZE_STEP = 0.1  # sizes that differ by less are the same
GROWTH = 0.35  # of the cell's size per distance


@dataclass(frozen=True, eq=False)
class CellSizes:
    """Size of cells: given at segments, growing with the distance from them.

    Attributes:
        start: Ends of the segments, shape (n, 2).
        along: Vectors from there to their other ends, shape (n, 2).
        size: Shape (n,).
    """

    start: Array
    along: Array
    size: Array

    @classmethod
    def of(cls, parts: Sequence[Part], refinement: float) -> CellSizes:
        """Some cells across each wall, and small ones where strains peak.

        Raises:
            ValueError: Walls are so thin that this would be far too many.
        """
        walls = [_Walls.of(part) for part in parts]
        starts, alongs, sizes = [], [], []
        for wall in walls:
            peak = wall.reentrant()
            for other in walls:
                if other is not wall:
                    peak |= wall.ends_on(other)
            starts += [wall.start, wall.start[peak]]
            alongs += [wall.along, np.zeros_like(wall.start[peak])]
            sizes += [_WALL_CELL * wall.thickness, _CORNER_CELL * wall.at_corners()[peak]]
        largest = _LARGEST_CELL * np.linalg.norm(np.ptp(np.concatenate(starts), axis=0))
        size = np.minimum(np.concatenate(sizes), largest) / refinement
        along = np.concatenate(alongs)
        count = 2.0 * (np.linalg.norm(along, axis=1) / size).sum()
        if count > _MOST_CELLS:
            raise ValueError(
                f"walls are too thin to be meshed: about {count:.0f} cells, at most {_MOST_CELLS}; "
                "give less refinement, or a section of known stiffness"
            )
        return cls(np.concatenate(starts), along, size)

    def samples(self) -> Iterator[tuple[float, Array]]:
        """Sizes, rounded down to steps of a geometric series, and points along their segments."""
        steps = np.floor(np.log(self.size) / _SIZE_STEP)
        for step in np.unique(steps):
            size = float(np.exp(step * _SIZE_STEP))
            points = [
                start + np.linspace(0.0, 1.0, count)[:, np.newaxis] * along
                for start, along, count in zip(*self._like(steps == step, size), strict=True)
            ]
            yield size, np.concatenate(points)

    def _like(self, chosen: npt.NDArray[np.bool_], size: float) -> tuple[Array, Array, Any]:
        along = self.along[chosen]
        counts = np.ceil(np.linalg.norm(along, axis=1) / size).astype(int) + 1
        return self.start[chosen], along, counts


@dataclass(frozen=True, eq=False)
class _Walls:
    """Chords of a part's loops with the material on their left, one loop after the other.

    Attributes:
        start: Shape (n, 2).
        along: To the next chord's start, shape (n, 2).
        before: Number of the chord before each, shape (n,).
        thickness: Of the wall behind each, shape (n,).
    """

    start: Array
    along: Array
    before: npt.NDArray[np.int64]
    thickness: Array

    @classmethod
    def of(cls, part: Part) -> _Walls:
        """All walls of a part."""
        loops = [_oriented(loop.chords(), i == 0) for i, loop in enumerate(part.loops)]
        start = np.concatenate(loops)
        along = np.concatenate([np.roll(points, -1, axis=0) - points for points in loops])
        firsts = np.cumsum([0, *map(len, loops)])
        before = [
            first + np.roll(np.arange(len(points)), 1)
            for first, points in zip(firsts, loops, strict=False)
        ]
        return cls(start, along, np.concatenate(before), _thickness(start, along))

    def at_corners(self) -> Array:
        """The thinner of the walls that meet at each chord's start."""
        return np.minimum(self.thickness, self.thickness[self.before])

    def reentrant(self) -> npt.NDArray[np.bool_]:
        """Starts with more than a straight angle of material; those within an arc are none."""
        before = self.along[self.before]
        turn = np.arctan2(cross(before, self.along), (before * self.along).sum(axis=1))
        return np.asarray(turn < -_SHARP)

    def ends_on(self, other: _Walls) -> npt.NDArray[np.bool_]:
        """Starts that lie within a chord of another part: it goes on where this one ends."""
        r = self.start[:, np.newaxis] - other.start
        length = np.linalg.norm(other.along, axis=1)
        unit = other.along / length[:, np.newaxis]
        beside, along = np.abs(cross(unit, r)), (r * unit).sum(axis=-1)
        margin = _CLOSE * length
        return np.asarray(
            ((beside < margin) & (along > margin) & (along < length - margin)).any(axis=1)
        )


def _oriented(points: Array, counter_clockwise: bool) -> Array:
    """With the material on the left."""
    area = cross(points, np.roll(points, -1, axis=0)).sum()
    return points if (area > 0) == counter_clockwise else points[::-1]


def _thickness(a: Array, d: Array) -> Array:
    """Of the wall behind each edge: the least of three rays from it into the material."""
    normal = np.column_stack([-d[:, 1], d[:, 0]]) / np.linalg.norm(d, axis=1, keepdims=True)
    thickness = np.full(len(a), np.inf)
    for part in (0.25, 0.5, 0.75):
        origin = (a + part * d)[:, np.newaxis]
        ray = np.broadcast_to(normal[:, np.newaxis], (len(a), *d.shape))
        edge = np.broadcast_to(d, ray.shape)
        det = cross(ray, edge)
        safe = np.where(np.abs(det) > 1e-12 * np.linalg.norm(edge, axis=-1), det, np.inf)
        r = a - origin
        distance, along = cross(r, edge) / safe, cross(r, ray) / safe
        hit = np.isfinite(safe) & (np.abs(along - 0.5) <= 0.5 + TOUCH)
        np.fill_diagonal(hit, False)
        hit &= distance > 0
        thickness = np.minimum(thickness, np.where(hit, distance, np.inf).min(axis=1))
    return thickness
