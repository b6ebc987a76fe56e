"""The separating axis of two convex polyhedra, and closest points of segments: compiled.

The distance of two convex polyhedra along an axis is largest along the normal of a face of one of
them or along the common normal of an edge of each (S. Gottschalk, M. Lin & D. Manocha, SIGGRAPH
(1996) 171). Only pairs of edges whose arcs on the Gauss map cross need be checked (D. Gregorius,
GDC 2013).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined_uncounted, uncounted
from fem_lie.lie.tuples import Vector, cross, dot, load_row, minus, plus, scaled

_PARALLEL = 1e-3
"""Sine of the angle below which edges have no common normal."""


class FaceAxis(NamedTuple):
    """Separating axis along the normal of a face.

    Attributes:
        separation: Distance of the other polyhedron from the plane of the face, negative inside.
        face: Number of the face.
        corner: The closest corner of the other polyhedron.
    """

    separation: float
    face: int
    corner: int


class EdgeAxis(NamedTuple):
    """Separating axis along the common normal of two edges.

    Attributes:
        separation: Distance of the edges, negative where the polyhedra overlap.
        first: Edge of the first polyhedron, −1: there is none.
        second: Edge of the second polyhedron.
    """

    separation: float
    first: int
    second: int


@uncounted
def face_axis(
    X: Array, N: Array, at: Indices, faces: tuple[int, int], corners: tuple[int, int]
) -> FaceAxis:
    """The best axis among faces of one polyhedron, against the corners of another.

    Args:
        X: Corners, shape (V, 3).
        N: Normals of faces, shape (F, 3).
        at: A corner of each face, shape (F,).
        faces: First face of the one polyhedron, and the one after the last.
        corners: First corner of the other polyhedron, and the one after the last.
    """
    best = FaceAxis(-np.inf, faces[0], corners[0])
    for face in range(faces[0], faces[1]):
        n = load_row(N, face)
        height, nearest = np.inf, corners[0]
        for corner in range(corners[0], corners[1]):
            here = dot(n, load_row(X, corner))
            if here < height:
                height, nearest = here, corner
        separation = height - dot(n, load_row(X, at[face]))
        if separation > best.separation:
            best = FaceAxis(separation, face, nearest)
    return best


@inlined_uncounted
def _arcs_cross(a: Vector, b: Vector, c: Vector, d: Vector) -> bool:
    """Whether the arcs ``a b`` and ``c d`` of the unit sphere cross."""
    ba, dc = cross(b, a), cross(d, c)
    cba, dba, adc, bdc = dot(c, ba), dot(d, ba), dot(a, dc), dot(b, dc)
    return cba * dba < 0.0 and adc * bdc < 0.0 and cba * bdc > 0.0


@uncounted
def edge_axis(
    X: Array,
    N: Array,
    edges: Indices,
    first: tuple[int, int],
    second: tuple[int, int],
    centre: Vector,
) -> EdgeAxis:
    """The best axis among pairs of edges of two polyhedra.

    Args:
        X: Corners, shape (V, 3).
        N: Normals of faces, shape (F, 3).
        edges: Both corners and both faces of each, shape (E, 4).
        first: First edge of one polyhedron, and the one after the last.
        second: First edge of the other, and the one after the last.
        centre: Any point inside the first polyhedron.
    """
    best = EdgeAxis(-np.inf, -1, -1)
    for e in range(first[0], first[1]):
        a, b = load_row(N, edges[e, 2]), load_row(N, edges[e, 3])
        p = load_row(X, edges[e, 0])
        along = minus(load_row(X, edges[e, 1]), p)
        for f in range(second[0], second[1]):
            c, d = load_row(N, edges[f, 2]), load_row(N, edges[f, 3])
            if not _arcs_cross(a, b, scaled(-1.0, c), scaled(-1.0, d)):
                continue
            q = load_row(X, edges[f, 0])
            other = minus(load_row(X, edges[f, 1]), q)
            n = cross(along, other)
            size = np.sqrt(dot(n, n))
            sine = size / np.sqrt(dot(along, along) * dot(other, other))
            if sine < _PARALLEL:
                continue
            n = scaled(1.0 / size if dot(n, minus(p, centre)) > 0.0 else -1.0 / size, n)
            separation = dot(n, minus(q, p))
            if separation > best.separation:
                best = EdgeAxis(separation, e, f)
    return best


@inlined_uncounted
def nearest_on_segment(p: Vector, q: Vector, x: Vector) -> float:
    """Parameter, from 0 to 1, of the point of a segment ``p q`` that is closest to ``x``."""
    along = minus(q, p)
    return min(1.0, max(0.0, dot(along, minus(x, p)) / dot(along, along)))


@inlined_uncounted
def point_between(p: Vector, q: Vector, s: float) -> Vector:
    """``p + s (q − p)``."""
    return plus(p, scaled(s, minus(q, p)))
