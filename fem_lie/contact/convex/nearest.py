"""The feature of a polyhedron that is closest to a ball: a face, an edge or a corner; compiled."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import uncounted
from fem_lie.contact.convex.separation import nearest_on_segment, point_between
from fem_lie.contact.convex.slots import set_corner, set_edge, set_plane, within
from fem_lie.contact.convex.table import BITS, Polyhedra
from fem_lie.contact.sides.kinematics import position
from fem_lie.contact.sides.table import LINE, PLANE, ROUND, Side
from fem_lie.lie.tuples import dot, load_row, minus


@uncounted
def set_of_ball(
    H: Array,
    shapes: Polyhedra,
    m: int,
    reach: float,
    pairs: Indices,
    kinds: Indices,
    a: Side,
    b: Side,
    ids: Indices,
) -> None:
    """Set the feature of a polyhedron that is closest to a ball, in its slot."""
    two, c = shapes.pairs[m, 1], shapes.slots[m]
    i, j = pairs[c, 0], pairs[c, 1]
    x, nearest, best = position(H, a, i), -1, -np.inf
    for face in range(shapes.first[two, 1], shapes.first[two + 1, 1]):
        n = load_row(shapes.N, face)
        height = dot(n, minus(x, load_row(shapes.X, shapes.at[face])))
        if height > best:
            best, nearest = height, face
    if best > a.radii[i] + reach:
        return
    for face in range(shapes.first[two, 1], shapes.first[two + 1, 1]):
        n = load_row(shapes.N, face)
        height = dot(n, minus(x, load_row(shapes.X, shapes.at[face])))
        if (height > 0.0 or (best <= 0.0 and face == nearest)) and within(shapes, n, face, x, 0.0):
            set_plane(shapes, face, b, j)
            kinds[c], ids[0] = PLANE, 1 + face
            return
    least, edge, part = np.inf, -1, 0.0
    for e in range(shapes.first[two, 2], shapes.first[two + 1, 2]):
        p, q = (
            load_row(shapes.X, shapes.edges[e, 0]),
            load_row(shapes.X, shapes.edges[e, 1]),
        )
        s = nearest_on_segment(p, q, x)
        separation = minus(x, point_between(p, q, s))
        if dot(separation, separation) < least:
            least, edge, part = dot(separation, separation), e, s
    if 0.0 < part < 1.0:
        set_edge(H, shapes, edge, position(H, shapes.centres, two), b, j)
        kinds[c], ids[0] = LINE, -1 - edge
        return
    corner = shapes.edges[edge, 0 if part == 0.0 else 1]
    set_corner(shapes, corner, b, j)
    kinds[c], ids[0] = ROUND, -BITS - corner
