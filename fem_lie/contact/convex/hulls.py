"""A convex polyhedron from its corners: faces, edges, and which faces meet at an edge."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from fem_lie._arrays import Array, Indices

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
        ValueError: They lie in a plane.
    """
    try:
        hull = ConvexHull(points)
    except QhullError as error:
        raise ValueError(
            f"the corners of a polyhedron must not lie in a plane, got {len(points)} points"
        ) from error
    # triangles of one face in turn, each corner by its number among those of the hull
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
    """Corners of a face in their order about its normal, without those within its edges."""
    X = corners[members]
    first = X[0] - X.mean(axis=0)
    first = first - (first @ normal) * normal
    second = np.cross(normal, first)
    apart = X - X.mean(axis=0)
    order = np.argsort(np.arctan2(apart @ second, apart @ first))
    return np.array(members)[order]


def _edges(loops: list[Indices]) -> Indices:
    """Each edge once, along the loop of the first of its faces."""
    faces = {
        (int(a), int(b)): k
        for k, loop in enumerate(loops)
        for a, b in zip(loop, np.roll(loop, -1), strict=True)
    }
    found = [(a, b, k, faces[b, a]) for (a, b), k in faces.items() if a < b]
    return np.array(found, dtype=np.int64)
