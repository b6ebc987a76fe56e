"""Gaps of pairs of contact points, including vertices and edges of polyhedra: compiled.

In addition to balls and planes (:mod:`fem_lie.contact.sides.kinematics`), with ``t`` along an
edge::

    edges    g = n·(P − Q),  n = ± t_A × t_B / |t_A × t_B|,  P and Q the closest points of the lines
    line     g = |P − Q| − r_A,  Q the foot of the ball on the line of an edge

Both gaps vary by ``n·(δP − δQ)`` only, for the distance is stationary in the closest points. An
edge is stored as its midpoint, with half of the edge as second vector and a vector out of its
polyhedron as third.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined_uncounted, uncounted
from fem_lie.contact.sides.kinematics import gap, position, slot
from fem_lie.contact.sides.surfaces import MOST_NODES
from fem_lie.contact.sides.table import GROUND, Side
from fem_lie.lie.motions import global_components, local_components
from fem_lie.lie.tuples import Vector, cross, dot, load_row, minus, plus, scaled

ROUND, PLANE, EDGES, LINE, INACTIVE = range(5)
"""Kinds of pairs: two balls; a ball or point and a plane; two edges; a ball and an edge; none."""

MIDDLE, HALF, OUTWARDS = range(3)
"""Vectors of an edge: its midpoint, half of the edge, and a vector out of the polyhedron."""


@inlined_uncounted
def _edge_vector(H: Array, side: Side, i: int, k: int) -> Vector:
    """A vector of an edge, in global components."""
    node, c = side.nodes[i, 0], load_row(side.arms[i], k)
    return c if node == GROUND else global_components(H[node], c)


@inlined_uncounted
def nearest_of_lines(P: Vector, s: Vector, Q: Vector, t: Vector) -> tuple[Vector, Vector]:
    """Closest points of two lines, through ``P`` along ``s`` and through ``Q`` along ``t``."""
    separation = minus(P, Q)
    ss, tt, st = dot(s, s), dot(t, t), dot(s, t)
    a, b = dot(s, separation), dot(t, separation)
    det = ss * tt - st * st
    u = (st * b - tt * a) / det
    w = (ss * b - st * a) / det
    return plus(P, scaled(u, s)), plus(Q, scaled(w, t))


@uncounted
def _gap_of_edges(
    H: Array, a: Side, b: Side, i: int, j: int, kind: int
) -> tuple[float, Vector, Vector]:
    """:func:`gap_of` for edges; not inlined, because that would slow loops over all pairs."""
    P = position(H, a, i)
    if kind == INACTIVE:
        return np.inf, (0.0, 0.0, 1.0), P
    Q, t = position(H, b, j), _edge_vector(H, b, j, HALF)
    if kind == LINE:
        separation = minus(P, Q)
        separation = minus(separation, scaled(dot(t, separation) / dot(t, t), t))
        distance = np.sqrt(dot(separation, separation))
        return distance - a.radii[i], scaled(1.0 / distance, separation), P
    s = _edge_vector(H, a, i, HALF)
    n = cross(s, t)
    size = np.sqrt(dot(n, n))
    n = scaled(1.0 / size if dot(n, _edge_vector(H, b, j, OUTWARDS)) > 0.0 else -1.0 / size, n)
    P, Q = nearest_of_lines(P, s, Q, t)
    return dot(n, minus(P, Q)), n, P


@inlined_uncounted
def gap_of(H: Array, a: Side, b: Side, i: int, j: int, kind: int) -> tuple[float, Vector, Vector]:
    """Gap, normal out of the second side, and point of the first side."""
    if kind <= PLANE:
        return gap(H, a, b, i, j, kind == PLANE)
    return _gap_of_edges(H, a, b, i, j, kind)


@uncounted
def _slot_of_edges(
    H: Array, a: Side, b: Side, i: int, j: int, kind: int, P: Vector, s: int
) -> tuple[int, float, float, Vector]:
    """:func:`slot_of` for edges; not inlined either."""
    first = s < MOST_NODES
    node = a.nodes[i, s] if first else b.nodes[j, s - MOST_NODES]
    sign = 1.0 if first else -1.0
    foot = P
    if kind == LINE and not first:
        Q, t = position(H, b, j), _edge_vector(H, b, j, HALF)
        foot = plus(Q, scaled(dot(t, minus(P, Q)) / dot(t, t), t))
    if node < 0:
        return node, sign, 1.0, foot
    return node, sign, 1.0, local_components(H[node], minus(foot, load_row(H[node], 0)))


@inlined_uncounted
def slot_of(
    H: Array, a: Side, b: Side, i: int, j: int, kind: int, P: Vector, s: int
) -> tuple[int, float, float, Vector]:
    """Node of a slot, sign, weight and moment arm; of planes and edges, at the foot."""
    if kind <= PLANE:
        return slot(H, a, b, i, j, kind == PLANE, P, s)
    return _slot_of_edges(H, a, b, i, j, kind, P, s)


@uncounted
def set_gaps_of(
    H: Array, a: Side, b: Side, pairs: Indices, kinds: Indices, first: int, out: Array
) -> None:
    """Gaps of all pairs of contact points from ``first`` on, shape (m,)."""
    for c in range(first, pairs.shape[0]):
        out[c], _, _ = gap_of(H, a, b, pairs[c, 0], pairs[c, 1], kinds[c])
