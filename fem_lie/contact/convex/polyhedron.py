"""A convex polyhedron as a contact surface: faces and edges of the convex hull of its corners."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.spatial import ConvexHull, QhullError

from fem_lie._arrays import Array, Indices, numbers
from fem_lie._summary import Summarised
from fem_lie.bodies.body import Point
from fem_lie.bodies.points import require_point
from fem_lie.contact.sides.surfaces import (
    Ball,
    PolyhedralSurface,
    Polyhedron,
    fixed_ball,
    polyhedron_at,
)

_FLAT = 1e-9
"""Difference of unit normals of triangles that lie in one face."""


class Hull(NamedTuple):
    """A convex polyhedron.

    Attributes:
        corners: Shape (n, 3).
        loops: Corners of each face, counter-clockwise seen from outside.
        normals: Unit normals of the faces, outwards, shape (f, 3).
        edges: First and last corner, and the faces on both sides, shape (e, 4).
    """

    corners: Array
    loops: list[Indices]
    normals: Array
    edges: Indices


def hull_of(points: Array) -> Hull:
    """The convex hull of points (n, 3), in which each face is one polygon.

    Raises:
        ValueError: The points lie in a plane.
    """
    try:
        hull = ConvexHull(points)
    except QhullError as error:
        raise ValueError(
            f"the corners of a polyhedron must not lie in a plane, got {len(points)} points"
        ) from error
    # for each face: its triangles, with corners numbered as in the hull
    number = np.full(len(points), -1)
    used = np.unique(hull.simplices)
    number[used] = np.arange(len(used))
    corners = points[used]
    normals: list[Array] = []
    members: list[set[int]] = []
    for triangle, plane in zip(hull.simplices, hull.equations, strict=True):
        near = [k for k, n in enumerate(normals) if np.abs(n - plane[:3]).max() < _FLAT]
        if not near:
            normals.append(plane[:3])
            members.append(set())
        members[near[0] if near else -1].update(int(number[k]) for k in triangle)
    loops = [_around(corners, n, sorted(of)) for n, of in zip(normals, members, strict=True)]
    return Hull(corners, loops, np.array(normals), _edges(loops))


def _around(corners: Array, normal: Array, members: list[int]) -> Indices:
    """Corners of a face in counter-clockwise order, without those inside its edges."""
    X = corners[members]
    first = X[0] - X.mean(axis=0)
    first = first - (first @ normal) * normal
    second = np.cross(normal, first)
    separation = X - X.mean(axis=0)
    order = np.argsort(np.arctan2(separation @ second, separation @ first))
    return np.array(members)[order]


def _edges(loops: list[Indices]) -> Indices:
    """Each edge once, directed as in the loop of the first of its faces."""
    faces = {
        (int(a), int(b)): k
        for k, loop in enumerate(loops)
        for a, b in zip(loop, np.roll(loop, -1), strict=True)
    }
    found = [(a, b, k, faces[b, a]) for (a, b), k in faces.items() if a < b]
    return np.array(found, dtype=np.int64)


@dataclass(frozen=True, eq=False, repr=False)
class ConvexPolyhedron(Summarised, PolyhedralSurface):
    """Contact surface: a convex polyhedron, the convex hull of its corners, fixed to a point.

    Attributes:
        point: The point that it is fixed to.
        corners: Corners relative to the point, in the axes of its frame, shape (n, 3), n ≥ 4.
            Corners inside the hull of the others are ignored.

    Example:
        >>> wedge = fl.RigidBody(1.0, (0.1, 0.1, 0.1), position=(0, 0, 1))
        >>> corners = [(x, y, 0) for x in (0, 1) for y in (0, 1)] + [(0, 0, 1), (0, 1, 1)]
        >>> fl.contact.ConvexPolyhedron(wedge.point("centre"), corners).label
        'ConvexPolyhedron on RigidBody'
    """

    point: Point
    corners: npt.ArrayLike

    def __post_init__(self) -> None:
        """Raise ``TypeError`` or ``ValueError`` if an argument has a wrong type or value."""
        require_point(self.point, "ConvexPolyhedron: point")
        given = numbers(self.corners, "ConvexPolyhedron: corners")
        if given.ndim != 2 or given.shape[1] != 3 or len(given) < 4 or not np.isfinite(given).all():
            raise ValueError(
                "ConvexPolyhedron: corners must be at least four finite points, shape (n, 3), got "
                f"shape {given.shape}"
            )
        try:
            hull_of(given)
        except ValueError as error:
            raise ValueError(f"ConvexPolyhedron: {error}") from error

    @property
    def points(self) -> Sequence[Point]:
        """The point that it is fixed to."""
        return [self.point]

    @cached_property
    def _offsets(self) -> Array:
        return hull_of(numbers(self.corners, "ConvexPolyhedron: corners")).corners

    def balls(self) -> list[Ball]:
        """The corners, which touch planes."""
        return [fixed_ball(self.point, 0.0, offset) for offset in self._offsets]

    def polyhedron(self) -> Polyhedron:
        """The polyhedron."""
        return polyhedron_at(self.point, [ball.position for ball in self.balls()])
