"""Features written into slots of contact manifolds, and the test for a foot on a face: compiled."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import inlined_uncounted
from fem_lie.contact.convex.separation import point_between
from fem_lie.contact.convex.table import Polyhedra
from fem_lie.contact.sides.kinematics import HALF, MIDDLE, OUTWARDS
from fem_lie.contact.sides.table import GROUND, Side
from fem_lie.lie.motions import local_components
from fem_lie.lie.tuples import Vector, cross, dot, load_row, minus, scaled, store_row


@inlined_uncounted
def _put(H: Array, side: Side, i: int, node: int, k: int, x: Vector) -> None:
    """Fix a point, or a vector where ``k`` is not the first, to a node or to ground."""
    if node == GROUND:
        store_row(side.arms[i], k, x)
        return
    origin = load_row(H[node], 0) if k == MIDDLE else (0.0, 0.0, 0.0)
    store_row(side.arms[i], k, local_components(H[node], minus(x, origin)))


@inlined_uncounted
def _fix(side: Side, i: int, of: Side, j: int) -> None:
    """Fix a slot to the node that a point is fixed to."""
    side.nodes[i, 0] = of.nodes[j, 0]
    side.owners[i], side.weights[i, 0] = of.owners[j], 1.0
    store_row(side.normals, i, (0.0, 0.0, 0.0))


@inlined_uncounted
def set_corner(shapes: Polyhedra, corner: int, side: Side, i: int) -> None:
    """Write a corner into a slot."""
    _fix(side, i, shapes.corners, corner)
    store_row(side.arms[i], MIDDLE, load_row(shapes.corners.arms[corner], 0))


@inlined_uncounted
def set_point(
    H: Array, shapes: Polyhedra, corner: int, mark: int, x: Vector, side: Side, i: int
) -> None:
    """Write a point of a polyhedron into a slot; a vertex if its mark says so."""
    if mark > 0:
        set_corner(shapes, mark - 1, side, i)
    else:
        _fix(side, i, shapes.corners, corner)
        _put(H, side, i, side.nodes[i, 0], MIDDLE, x)


@inlined_uncounted
def set_plane(shapes: Polyhedra, face: int, side: Side, j: int) -> None:
    """Write the plane of a face into a slot."""
    _fix(side, j, shapes.faces, face)
    store_row(side.arms[j], MIDDLE, load_row(shapes.faces.arms[face], 0))
    store_row(side.normals, j, load_row(shapes.faces.normals, face))


@inlined_uncounted
def set_edge(H: Array, shapes: Polyhedra, edge: int, centre: Vector, side: Side, i: int) -> None:
    """Write an edge into a slot; ``centre`` is a point inside the polyhedron."""
    start, end = shapes.edges[edge, 0], shapes.edges[edge, 1]
    _fix(side, i, shapes.corners, start)
    p, q, node = load_row(shapes.X, start), load_row(shapes.X, end), side.nodes[i, 0]
    middle = point_between(p, q, 0.5)
    _put(H, side, i, node, MIDDLE, middle)
    _put(H, side, i, node, HALF, scaled(0.5, minus(q, p)))
    _put(H, side, i, node, OUTWARDS, minus(middle, centre))


@inlined_uncounted
def within(shapes: Polyhedra, n: Vector, face: int, x: Vector, slack: float) -> bool:
    """Whether the foot of a point is on a face."""
    begin, end = shapes.begins[face], shapes.begins[face + 1]
    for side in range(begin, end):
        p = load_row(shapes.X, shapes.loops[side])
        q = load_row(shapes.X, shapes.loops[side + 1 if side + 1 < end else begin])
        out = cross(minus(q, p), n)
        if dot(out, minus(x, p)) > slack * np.sqrt(dot(out, out)):
            return False
    return True
