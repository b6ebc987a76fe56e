"""Polyhedra that passed through each other or through balls within a step: compiled."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined_uncounted, uncounted
from fem_lie.contact.convex.separation import edge_axis, face_axis
from fem_lie.contact.convex.table import Polyhedra
from fem_lie.contact.sides.kinematics import normal_of, position, positions
from fem_lie.contact.sides.table import Side
from fem_lie.lie.tuples import Vector, dot, load_row, minus, plus, scaled, store_row

_MOST = 1000
"""Largest number of positions on the path that are checked."""

_TOUCHING, _DEEP = 1e-6, 0.25
"""Overlaps relative to the thickness of both: at an end of a step, and of more than a graze."""


@inlined_uncounted
def _shift(X: Array, corners: tuple[int, int], by: Vector) -> None:
    for corner in range(corners[0], corners[1]):
        store_row(X, corner, plus(load_row(X, corner), by))


@uncounted
def _separation(shapes: Polyhedra, one: int, two: int, centre: Vector) -> float:
    """Separation of two polyhedra at present positions of their corners; overlap is negative."""
    X, N, first, at = shapes.X, shapes.N, shapes.first, shapes.at
    corners = (first[one, 0], first[one + 1, 0]), (first[two, 0], first[two + 1, 0])
    faces = (first[one, 1], first[one + 1, 1]), (first[two, 1], first[two + 1, 1])
    edges = (first[one, 2], first[one + 1, 2]), (first[two, 2], first[two + 1, 2])
    found = face_axis(X, N, at, faces[0], corners[1]).separation
    found = max(found, face_axis(X, N, at, faces[1], corners[0]).separation)
    return max(found, edge_axis(X, N, shapes.edges, edges[0], edges[1], centre).separation)


@inlined_uncounted
def _height(shapes: Polyhedra, two: int, x: Vector) -> float:
    """Height of a point above the faces of a polyhedron, negative inside."""
    found = -np.inf
    for face in range(shapes.first[two, 1], shapes.first[two + 1, 1]):
        separation = minus(x, load_row(shapes.X, shapes.at[face]))
        found = max(found, dot(load_row(shapes.N, face), separation))
    return found


@uncounted
def first_passed(before: Array, H: Array, shapes: Polyhedra, pairs: Indices, a: Side) -> int:
    """The first slot of a pair that is separate at both ends of a step but overlaps within, or −1.

    The second body moves straight to its final position, with its orientation at the end.

    Args:
        before: Frames at the start of the step.
        H: Frames at the end of the step.
        shapes: Polyhedra and pairs of them.
        pairs: All pairs of contact points.
        a: First points.
    """
    positions(H, shapes.corners, shapes.X)
    for face in range(shapes.N.shape[0]):
        store_row(shapes.N, face, normal_of(H, shapes.faces, face))
    for m in range(shapes.pairs.shape[0]):
        (one, two), slot = shapes.pairs[m], shapes.slots[m]
        side, i = (a, pairs[slot, 0]) if one < 0 else (shapes.centres, one)
        x = position(H, side, i)
        separation = minus(x, position(H, shapes.centres, two))
        way = minus(
            separation, minus(position(before, side, i), position(before, shapes.centres, two))
        )
        moved, thin = np.sqrt(dot(way, way)), shapes.thin[m]
        if moved <= 0.5 * thin:
            continue
        count = min(_MOST, int(4.0 * moved / thin) + 1)
        corners = shapes.first[two, 0], shapes.first[two + 1, 0]
        step, worst = scaled(1.0 / count, way), np.inf
        ends = np.inf
        for k in range(count + 1):
            if one < 0:
                here = _height(shapes, two, x) - 0.5 * thin
            else:
                here = _separation(shapes, one, two, x)
            if k == 0 or k == count:
                ends = min(ends, here)
            worst = min(worst, here)
            _shift(shapes.X, corners, step)
        _shift(shapes.X, corners, scaled(-(count + 1.0), step))
        if ends > -_TOUCHING * thin and worst < -_DEEP * thin:
            return slot
    return -1
