"""Outlines of sections: closed loops of straight edges and arcs, and their checks."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array

_ARC_PIECES = 8  # chords of an arc when loops are checked and walls measured

TOUCH = 1e-9  # of the size of the outline


@dataclass(frozen=True, eq=False)
class Loop:
    """Closed line of straight edges and circular arcs; edge i runs from vertex i to i + 1.

    Attributes:
        vertices: Vertices, shape (n, 2).
        centres: Centre of each edge's circle, nan for a straight edge, shape (n, 2). Arcs are
            shorter than half a circle.
    """

    vertices: Array
    centres: Array

    @classmethod
    def polygon(cls, points: npt.ArrayLike, what: str = "points") -> Loop:
        """Loop of straight edges.

        Raises:
            ValueError: There are less than three points, a point is not finite, or two neighbours
                coincide.
        """
        vertices = np.array(points, dtype=np.float64)
        if vertices.ndim != 2 or vertices.shape[1] != 2 or len(vertices) < 3:
            raise ValueError(f"{what} must be at least 3 points (y, z), got {points!r}")
        if not np.isfinite(vertices).all():
            raise ValueError(f"{what} must be finite, got {points!r}")
        edges = np.linalg.norm(np.roll(vertices, -1, axis=0) - vertices, axis=1)
        if edges.min() <= TOUCH * np.ptp(vertices, axis=0).max():
            i = int(edges.argmin())
            raise ValueError(f"{what} must differ from their neighbours, got {vertices[i]} twice")
        return cls(vertices, np.full_like(vertices, np.nan))

    @classmethod
    def circle(cls, radius: float) -> Loop:
        """Circle about the origin, of four arcs."""
        vertices = radius * np.array([(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)])
        return cls(vertices, np.zeros_like(vertices))

    def edges(self) -> Iterator[tuple[Array, Array, Array]]:
        """Start, end and centre of each edge."""
        for i, end in enumerate(np.roll(np.arange(len(self.vertices)), -1)):
            yield self.vertices[i], self.vertices[end], self.centres[i]

    def rounded(self, corners: Sequence[int], radius: float) -> Loop:
        """Loop with corners between straight edges replaced by arcs."""
        if radius == 0.0:
            return self
        vertices: list[Array] = []
        centres: list[Array] = []
        for i, (point, _, centre) in enumerate(self.edges()):
            if i in corners:
                start, middle, end = _fillet(self.vertices, i, radius)
                vertices += [start, end]
                centres += [middle, centre]
            else:
                vertices.append(point)
                centres.append(centre)
        return Loop(np.array(vertices), np.array(centres))

    def moved(self, shift: Array, scale: float = 1.0) -> Loop:
        """Loop with all points ``scale * (x + shift)``."""
        return Loop(scale * (self.vertices + shift), scale * (self.centres + shift))

    def chords(self) -> Array:
        """Points of a polygon with the vertices and points on the arcs, shape (m, 2)."""
        pieces = []
        for start, end, centre in self.edges():
            if np.isnan(centre[0]):
                pieces.append(start[np.newaxis])
            else:
                turn = _angle(start - centre, end - centre)
                angles = turn * np.arange(_ARC_PIECES) / _ARC_PIECES
                c, s = np.cos(angles), np.sin(angles)
                (y, z) = start - centre
                pieces.append(centre + np.column_stack([c * y - s * z, s * y + c * z]))
        return np.concatenate(pieces)


@dataclass(frozen=True, eq=False)
class Part:
    """Region of a section: the inside of a loop without its holes."""

    outer: Loop
    holes: tuple[Loop, ...] = ()

    @property
    def loops(self) -> tuple[Loop, ...]:
        """The outer loop and the holes."""
        return (self.outer, *self.holes)

    def moved(self, shift: Array, scale: float = 1.0) -> Part:
        """Part with all points ``scale * (x + shift)``."""
        return Part(
            self.outer.moved(shift, scale), tuple(hole.moved(shift, scale) for hole in self.holes)
        )

    def check(self) -> None:
        """Check that the loops bound a region.

        Raises:
            ValueError: A loop crosses or touches itself or another one, a hole is not inside the
                outline or inside another hole.
        """
        names = ["the outline", *(f"hole {i}" for i in range(len(self.holes)))]
        chords = [loop.chords() for loop in self.loops]
        for name, points in zip(names, chords, strict=True):
            if _crossings(points, points, same=True):
                raise ValueError(f"{name} crosses or touches itself: {points.tolist()}")
        for i, name in enumerate(names):
            for j in range(i):
                if _crossings(chords[i], chords[j], same=False):
                    raise ValueError(f"{name} crosses or touches {names[j]}")
        for i in range(1, len(names)):
            if not _inside(chords[i][0], chords[0]):
                raise ValueError(f"{names[i]} lies outside the outline")
            for j in range(1, len(names)):
                if i != j and _inside(chords[i][0], chords[j]):
                    raise ValueError(f"{names[i]} lies inside {names[j]}")


def cross(a: Array, b: Array) -> Array:
    """``a₂ b₃ − a₃ b₂`` of vectors in the plane, shape (..., 2)."""
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def _angle(a: Array, b: Array) -> float:
    """Angle from a to b, in (-π, π]."""
    return float(np.arctan2(cross(a, b), a @ b))


def _fillet(vertices: Array, i: int, radius: float) -> tuple[Array, Array, Array]:
    """Start, centre and end of the arc that touches both edges at vertex i."""
    before, after = (vertices[j % len(vertices)] - vertices[i] for j in (i - 1, i + 1))
    s, t = before / np.linalg.norm(before), after / np.linalg.norm(after)
    half = 0.5 * abs(_angle(s, t))
    reach = radius / np.tan(half)
    bisector = (s + t) / np.linalg.norm(s + t)
    corner = vertices[i]
    return corner + reach * s, corner + radius / np.sin(half) * bisector, corner + reach * t


def _crossings(a: Array, b: Array, same: bool) -> bool:
    """Whether any edges of two closed polygons meet; neighbours in one polygon may."""
    da, db = np.roll(a, -1, axis=0) - a, np.roll(b, -1, axis=0) - b
    r = b[np.newaxis] - a[:, np.newaxis]
    u, v = np.broadcast_arrays(da[:, np.newaxis], db[np.newaxis])
    det = cross(u, v)
    scale = np.linalg.norm(u, axis=-1) * np.linalg.norm(v, axis=-1)
    parallel = np.abs(det) <= 1e-12 * scale
    safe = np.where(parallel, 1.0, det)
    s, t = cross(r, v) / safe, cross(r, u) / safe
    meet = ~parallel & (np.abs(s - 0.5) <= 0.5 + TOUCH) & (np.abs(t - 0.5) <= 0.5 + TOUCH)
    # on one line: overlap of projections
    length2 = (u * u).sum(axis=-1)
    start, end = (r * u).sum(axis=-1) / length2, ((r + v) * u).sum(axis=-1) / length2
    aligned = parallel & (np.abs(cross(r, u)) <= TOUCH * length2)
    meet |= aligned & (np.maximum(start, end) > -TOUCH) & (np.minimum(start, end) < 1.0 + TOUCH)
    if not same:
        return bool(meet.any())
    n = len(a)
    i = np.arange(n)
    # neighbours share a point, but must not run back onto each other
    folded = (aligned & ((u * v).sum(axis=-1) < 0))[i, (i + 1) % n]
    meet[i, i] = meet[i, (i + 1) % n] = meet[(i + 1) % n, i] = False
    return bool(meet.any() or folded.any())


def _inside(point: Array, polygon: Array) -> bool:
    """Whether a point is inside, by the number of edges that a ray along +y crosses."""
    (y, z), ends = point, np.roll(polygon, -1, axis=0)
    spans = (polygon[:, 1] > z) != (ends[:, 1] > z)
    p, q = polygon[spans], ends[spans]
    return bool(np.sum(p[:, 0] + (z - p[:, 1]) / (q[:, 1] - p[:, 1]) * (q - p)[:, 0] > y) % 2)
