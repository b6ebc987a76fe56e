"""Contact points: gap, normal, points of both sides, and their Jacobian; compiled.

With ``P`` and ``Q`` the points of the two sides, ``Δ = P − Q``, and ``Dᵢ = [wᵢ Rᵢ, −Rᵢ ĉᵢ]``::

    ROUND   g = |Δ| − r_A − r_B,  n = Δ/|Δ|             two balls
            g = |r_B| − r_A − |Δ|,  n = −Δ/|Δ|          a ball in a hollow sphere
    PLANE   g = n·Δ − r_A,  n = R_B m                   a ball and a plane
    LEVEL   g = φ(X) − r_A,  n = R_B ∂φ/∂X,  X = R_Bᵀ Δ a ball and a gap function
    EDGES   g = n·Δ,  n = ± t_A × t_B / |t_A × t_B|     closest points of two edges
    LINE    g = |Δ| − r_A,  Q the foot of P             a ball and the line of an edge
    row     ġ = Σ bᵢ·vᵢ,  bᵢ = ± Dᵢᵀ n

The gap varies by ``n·(δP − δQ)`` only. The second side of a ball and of another ball is its centre;
all others have the force at a foot, which is the material point there. Slots are the nodes of the
first side, then those of the second. An edge is stored as its midpoint, with half of the edge as
second vector and a vector out of its polyhedron as third.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined_uncounted, uncounted
from fem_lie.contact.sides.gap_functions import local_gap, position_in, turned
from fem_lie.contact.sides.surfaces import MOST_NODES
from fem_lie.contact.sides.table import (
    EDGES,
    GROUND,
    INACTIVE,
    LEVEL,
    LINE,
    PLANE,
    ROUND,
    UNUSED,
    Side,
)
from fem_lie.lie.motions import global_components, local_components
from fem_lie.lie.node_types import POSITION_GRADIENT, axes
from fem_lie.lie.tuples import (
    Vector,
    cross,
    dot,
    load_row,
    minus,
    plus,
    rotate_back,
    scaled,
)

SLOTS = 2 * MOST_NODES

MIDDLE, HALF, OUTWARDS = range(3)
"""Vectors of an edge: its midpoint, half of the edge, and a vector out of the polyhedron."""


class ContactPoint(NamedTuple):
    """A contact point.

    Attributes:
        gap: Gap, negative where the sides overlap.
        normal: Unit normal out of the second side.
        first: Point ``P`` of the first side; the centre of a ball.
        second: Point of the second side: the centre of a ball, or a foot.
    """

    gap: float
    normal: Vector
    first: Vector
    second: Vector


@inlined_uncounted
def _sum(H: Array, side: Side, i: int, fixed: float) -> Vector:
    """``Σ (wᵢ xᵢ + Rᵢ cᵢ)`` of a point, with a factor of the part that is on ground."""
    x = (0.0, 0.0, 0.0)
    for k in range(MOST_NODES):
        node = side.nodes[i, k]
        if node == UNUSED:
            break
        c = load_row(side.arms[i], k)
        if node == GROUND:
            x = plus(x, scaled(fixed, c))
        else:
            x = plus(x, scaled(side.weights[i, k], load_row(H[node], 0)))
            x = plus(x, global_components(H[node], c))
    return x


@inlined_uncounted
def position(H: Array, side: Side, i: int) -> Vector:
    """Position of point ``i`` of a side."""
    return _sum(H, side, i, 1.0)


@inlined_uncounted
def displacement(delta: Array, side: Side, i: int) -> Vector:
    """Displacement of point ``i`` of a side for increments of the nodal coordinates."""
    return _sum(delta, side, i, 0.0)


@uncounted
def positions(H: Array, side: Side, out: Array) -> None:
    """Positions of all points of a side, shape (n, 3)."""
    for i in range(out.shape[0]):
        out[i, 0], out[i, 1], out[i, 2] = position(H, side, i)


@inlined_uncounted
def normal_of(H: Array, side: Side, j: int) -> Vector:
    """Normal of a plane."""
    return turned(H, side, j, load_row(side.normals, j))


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


@inlined_uncounted
def _edge_vector(H: Array, side: Side, i: int, k: int) -> Vector:
    """A vector of an edge, in global components."""
    return turned(H, side, i, load_row(side.arms[i], k))


@uncounted
def _at_foot(H: Array, a: Side, b: Side, i: int, j: int, kind: int) -> ContactPoint:
    """:func:`contact_point` of rarer kinds; not inlined, as that would slow loops over pairs."""
    P, Q = position(H, a, i), position(H, b, j)
    if kind == LEVEL:
        g, m, _, _ = local_gap(b, j, position_in(H, b, j, minus(P, Q)))
        return ContactPoint(g - a.radii[i], turned(H, b, j, m), P, P)
    if kind == INACTIVE:
        return ContactPoint(np.inf, (0.0, 0.0, 1.0), P, Q)
    t = _edge_vector(H, b, j, HALF)
    if kind == LINE:
        foot = plus(Q, scaled(dot(t, minus(P, Q)) / dot(t, t), t))
        separation = minus(P, foot)
        distance = np.sqrt(dot(separation, separation))
        return ContactPoint(distance - a.radii[i], scaled(1.0 / distance, separation), P, foot)
    s = _edge_vector(H, a, i, HALF)
    n = cross(s, t)
    size = np.sqrt(dot(n, n))
    n = scaled(1.0 / size if dot(n, _edge_vector(H, b, j, OUTWARDS)) > 0.0 else -1.0 / size, n)
    P, Q = nearest_of_lines(P, s, Q, t)
    return ContactPoint(dot(n, minus(P, Q)), n, P, P)


@inlined_uncounted
def contact_point(H: Array, a: Side, b: Side, i: int, j: int, kind: int) -> ContactPoint:
    """Contact point of a pair of points.

    Args:
        H: Nodal coordinates.
        a: First side.
        b: Second side.
        i: Point of the first side.
        j: Point of the second side.
        kind: Kind of the pair, :data:`ROUND` or another one.
    """
    if kind > PLANE:
        return _at_foot(H, a, b, i, j, kind)
    P, Q = position(H, a, i), position(H, b, j)
    separation = minus(P, Q)
    if kind == PLANE:
        n = normal_of(H, b, j)
        return ContactPoint(dot(n, separation) - a.radii[i], n, P, P)
    distance = np.sqrt(dot(separation, separation))
    sign = sign_of(b, j)
    n = scaled(sign / distance, separation) if distance > 0.0 else (0.0, 0.0, sign)
    return ContactPoint(sign * distance - a.radii[i] - b.radii[j], n, P, Q)


@inlined_uncounted
def sign_of(b: Side, j: int) -> float:
    """Sign of the distance in the gap to a ball: negative for a hollow sphere."""
    return 1.0 if b.radii[j] >= 0.0 else -1.0


@inlined_uncounted
def touched(a: Side, i: int, point: ContactPoint) -> Vector:
    """The point on the surface of the first side."""
    return minus(point.first, scaled(a.radii[i], point.normal))


@inlined_uncounted
def _fixed(H: Array, node: int, sign: float, x: Vector) -> tuple[int, float, float, Vector]:
    """The material point of a node at ``x``."""
    if node < 0:
        return node, sign, 1.0, x
    return node, sign, 1.0, local_components(H[node], minus(x, load_row(H[node], 0)))


@inlined_uncounted
def slot(
    H: Array, a: Side, b: Side, i: int, j: int, kind: int, point: ContactPoint, s: int
) -> tuple[int, float, float, Vector]:
    """Node of a slot, negative if there is none, sign of its side, weight and moment arm."""
    if s < MOST_NODES:
        if kind == EDGES:
            return _fixed(H, a.nodes[i, s], 1.0, point.first)
        return a.nodes[i, s], 1.0, a.weights[i, s], load_row(a.arms[i], s)
    k = s - MOST_NODES
    if kind == ROUND:
        return b.nodes[j, k], -1.0, b.weights[j, k], load_row(b.arms[j], k)
    return _fixed(H, b.nodes[j, k], -1.0, point.second)


@uncounted
def set_gaps(
    H: Array, a: Side, b: Side, pairs: Indices, kinds: Indices, first: int, out: Array
) -> None:
    """Gaps of all pairs of points from ``first`` on, shape (m,); kinds (m,)."""
    for c in range(first, pairs.shape[0]):
        out[c] = contact_point(H, a, b, pairs[c, 0], pairs[c, 1], kinds[c]).gap


@uncounted
def _gaps(H: Array, a: Side, b: Side, pairs: Indices, kind: int, g: Array, X: Array) -> None:
    for e in range(pairs.shape[0]):
        point = contact_point(H, a, b, pairs[e, 0], pairs[e, 1], kind)
        g[e] = point.gap
        X[e, 0], X[e, 1], X[e, 2] = touched(a, pairs[e, 0], point)


def gaps(H: Array, a: Side, b: Side, pairs: Indices, kind: int) -> tuple[Array, Array]:
    """Gaps (m,) of pairs of points (m, 2), and the closest points of the first side."""
    g, X = np.empty(len(pairs)), np.empty((len(pairs), 3))
    _gaps(H, a, b, pairs, kind, g, X)
    return g, X


@inlined_uncounted
def pulled_back(node_type: int, H: Array, w: float, c: Vector, f: Vector) -> tuple[Vector, Vector]:
    """Generalised force ``Dᵀ f`` on a node, along its axes, of a force on a point.

    Args:
        node_type: Type of the node. A node with vector coordinates has no moment, but may have a
            weight ``c₁`` of its second vector.
        H: Nodal coordinates.
        w: Weight of the node's position in that of the point.
        c: Moment arm, or weights of the directors, in the node's frame.
        f: Force, global components.
    """
    if node_type < POSITION_GRADIENT:
        local = local_components(H, f)
        return scaled(w, local), cross(c, local)
    d1, d2, d3 = axes(node_type, H)
    local = rotate_back(d1, d2, d3, f)
    return scaled(w, local), scaled(c[0], local)


@inlined_uncounted
def add_pulled_back(node_type: int, H: Array, w: float, c: Vector, f: Vector, out: Array) -> None:
    """Add :func:`pulled_back` to the forces on a node, shape (6,)."""
    force, moment = pulled_back(node_type, H, w, c, f)
    for k in range(3):
        out[k] += force[k]
        out[3 + k] += moment[k]


@inlined_uncounted
def add_to_nodes(H: Array, types: Indices, side: Side, i: int, f: Vector, out: Array) -> None:
    """Add a force on point ``i`` of a side to the forces on its nodes, shape (n, 6)."""
    for k in range(MOST_NODES):
        node = side.nodes[i, k]
        if node == UNUSED:
            break
        if node != GROUND:
            c = load_row(side.arms[i], k)
            add_pulled_back(types[node], H[node], side.weights[i, k], c, f, out[node])


@compiled
def count_blocks(a: Side, b: Side, pairs: Indices, rows: Indices, columns: Indices) -> int:
    """Number of pairs of nodes that pairs of points couple; stored as far as there is space."""
    found, nodes = 0, np.empty(SLOTS, dtype=np.int64)
    for e in range(pairs.shape[0]):
        for k in range(MOST_NODES):
            nodes[k], nodes[MOST_NODES + k] = a.nodes[pairs[e, 0], k], b.nodes[pairs[e, 1], k]
        for s in range(SLOTS):
            for t in range(SLOTS):
                if nodes[s] >= 0 and nodes[t] >= 0:
                    if found < rows.shape[0]:
                        rows[found], columns[found] = nodes[s], nodes[t]
                    found += 1
    return found
