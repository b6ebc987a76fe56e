"""Gaps between points, their first and their second derivatives: compiled.

With ``P`` and ``Q`` the points of the two sides, ``Δ = P − Q``, and ``Dᵢ = [wᵢ Rᵢ, −Rᵢ ĉᵢ]``::

    balls    g = |Δ| − r_A − r_B,  n = Δ/|Δ|
    hollow   g = |r_B| − r_A − |Δ|,  n = −Δ/|Δ|
    plane    g = n·Δ − r_A,        n = R_B m
    surface  g = φ(X) − r_A,       n = R_B ∂φ/∂X,  X = R_Bᵀ Δ   (a plane is φ = m·X)
    row      ġ = Σ bᵢ·vᵢ,          bᵢ = ± Dᵢᵀ n    (of a plane's frame at the foot of the ball)

Slots are the nodes of the first side, then those of the second.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined_uncounted, uncounted
from fem_lie.contact.sides.gap_functions import bent, local_gap, position_in, turned
from fem_lie.contact.sides.surfaces import MOST_NODES
from fem_lie.contact.sides.table import GROUND, UNUSED, Side
from fem_lie.lie.motions import global_components, local_components
from fem_lie.lie.tuples import Vector, cross, dot, load, load_row, minus, plus, scaled

SLOTS = 2 * MOST_NODES


@inlined_uncounted
def position(H: Array, side: Side, i: int) -> Vector:
    """Position of point ``i`` of a side."""
    x = (0.0, 0.0, 0.0)
    for k in range(MOST_NODES):
        node = side.nodes[i, k]
        if node == UNUSED:
            break
        c = load_row(side.arms[i], k)
        if node == GROUND:
            x = plus(x, c)
        else:
            x = plus(x, scaled(side.weights[i, k], load_row(H[node], 0)))
            x = plus(x, global_components(H[node], c))
    return x


@uncounted
def positions(H: Array, side: Side, out: Array) -> None:
    """Positions of all points of a side, shape (n, 3)."""
    for i in range(out.shape[0]):
        out[i, 0], out[i, 1], out[i, 2] = position(H, side, i)


@inlined_uncounted
def normal_of(H: Array, side: Side, j: int) -> Vector:
    """Normal of a plane."""
    node = side.nodes[j, 0]
    m = load_row(side.normals, j)
    return m if node == GROUND else global_components(H[node], m)


@inlined_uncounted
def gap(H: Array, a: Side, b: Side, i: int, j: int, flat: bool) -> tuple[float, Vector, Vector]:
    """Gap, normal, and point of the first side."""
    P = position(H, a, i)
    separation = minus(P, position(H, b, j))
    if flat:
        if b.level.address != 0:
            g, m, _, _ = local_gap(b, j, position_in(H, b, j, separation))
            return g - a.radii[i], turned(H, b, j, m), P
        n = normal_of(H, b, j)
        return dot(n, separation) - a.radii[i], n, P
    distance = np.sqrt(dot(separation, separation))
    sign = 1.0 if b.radii[j] >= 0.0 else -1.0
    n = scaled(sign / distance, separation) if distance > 0.0 else (0.0, 0.0, sign)
    return sign * distance - a.radii[i] - b.radii[j], n, P


@uncounted
def _gaps(H: Array, a: Side, b: Side, pairs: Indices, flat: bool, g: Array, X: Array) -> None:
    for e in range(pairs.shape[0]):
        g[e], n, P = gap(H, a, b, pairs[e, 0], pairs[e, 1], flat)
        X[e, 0], X[e, 1], X[e, 2] = minus(P, scaled(a.radii[pairs[e, 0]], n))


def gaps(H: Array, a: Side, b: Side, pairs: Indices, flat: bool) -> tuple[Array, Array]:
    """Gaps (m,) of pairs of points (m, 2), and the closest points of the first side."""
    g, X = np.empty(len(pairs)), np.empty((len(pairs), 3))
    _gaps(H, a, b, pairs, flat, g, X)
    return g, X


@inlined_uncounted
def slot(
    H: Array, a: Side, b: Side, i: int, j: int, flat: bool, P: Vector, s: int
) -> tuple[int, float, float, Vector]:
    """Node of a slot or :data:`UNUSED`, sign, weight and moment arm; of a plane, at the foot."""
    if s < MOST_NODES:
        return a.nodes[i, s], 1.0, a.weights[i, s], load_row(a.arms[i], s)
    k = s - MOST_NODES
    node = b.nodes[j, k]
    if flat and node >= 0:
        return node, -1.0, 1.0, local_components(H[node], minus(P, load_row(H[node], 0)))
    return node, -1.0, b.weights[j, k], load_row(b.arms[j], k)


@inlined_uncounted
def add_row(H: Array, node: int, factor: float, w: float, c: Vector, n: Vector, out: Array) -> None:
    """Add ``factor Dᵀ n`` of a node to forces (≥ nodes, 6)."""
    f = local_components(H[node], scaled(factor, n))
    moment = cross(c, f)
    for k in range(3):
        out[node, k] += w * f[k]
        out[node, 3 + k] += moment[k]


@inlined_uncounted
def rate(H: Array, v: Array, node: int, w: float, c: Vector, n: Vector) -> float:
    """``(Dᵀ n)·v`` of a node."""
    f = local_components(H[node], n)
    return w * dot(f, load(v[node], 0)) + dot(cross(c, f), load(v[node], 3))


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


@inlined_uncounted
def store_motion(H: Array, sign: float, w: float, c: Vector, D: Array) -> None:
    """Motion of a point per motion of its node, ``± [w R, −R ĉ]``, shape (3, 6)."""
    for k in range(3):
        d = load_row(H, 1 + k)
        # column k of R, and of −R ĉ = R (e_k × c)
        e = (1.0 if k == 0 else 0.0, 1.0 if k == 1 else 0.0, 1.0 if k == 2 else 0.0)
        rotated = global_components(H, cross(e, c))
        for r in range(3):
            D[r, k] = sign * w * d[r]
            D[r, 3 + k] = sign * rotated[r]


@inlined_uncounted
def _turns_of_normal(
    H: Array, b: Side, j: int, flat: bool, separation: Vector, n: Vector, D: Array, s: int, N: Array
) -> None:
    """Derivative of the normal in the motion of a slot, shape (3, 6)."""
    if not flat:
        distance = np.sqrt(dot(separation, separation))
        sign = 1.0 if b.radii[j] >= 0.0 else -1.0
        for k in range(6):
            along = n[0] * D[0, k] + n[1] * D[1, k] + n[2] * D[2, k]
            for r in range(3):
                N[r, k] = sign / distance * (D[r, k] - n[r] * along)
        return
    N[:] = 0.0
    m = load_row(b.normals, j)
    if b.level.address != 0:
        _, m, diagonal, others = local_gap(b, j, position_in(H, b, j, separation))
        for k in range(6):
            moved = position_in(H, b, j, (D[0, k], D[1, k], D[2, k]))
            N[0, k], N[1, k], N[2, k] = turned(H, b, j, bent(diagonal, others, moved))
    if s == MOST_NODES:
        node = b.nodes[j, 0]
        for k in range(3):
            e = (1.0 if k == 0 else 0.0, 1.0 if k == 1 else 0.0, 1.0 if k == 2 else 0.0)
            along = global_components(H[node], cross(e, m))
            for r in range(3):
                N[r, 3 + k] += along[r]


@inlined_uncounted
def add_turning(f: Vector, w: float, c: Vector, block: Array) -> None:
    """Add the derivative of ``(w f, c × f)`` in the rotation η of the node, ``δf = f × η``."""
    for k in range(3):
        e = (1.0 if k == 0 else 0.0, 1.0 if k == 1 else 0.0, 1.0 if k == 2 else 0.0)
        rotated = cross(f, e)
        moment = cross(c, rotated)
        for r in range(3):
            block[r, 3 + k] += w * rotated[r]
            block[3 + r, 3 + k] += moment[r]


@uncounted
def bends(
    H: Array,
    a: Side,
    b: Side,
    i: int,
    j: int,
    flat: bool,
    nodes: Indices,
    rows: Array,
    D: Array,
    G: Array,
) -> None:
    """Nodes of the slots of a pair, its rows ``b`` and their derivatives ``∂bₛ/∂hₜ``.

    Args:
        H: Frames.
        a: First side.
        b: Second side.
        i: Point of the first side.
        j: Point or plane of the second side.
        flat: Whether that is a plane.
        nodes: Overwritten, shape (8,).
        rows: Overwritten for nodes that move, shape (8, 6).
        D: Workspace, shape (8, 2, 3, 6).
        G: Overwritten for nodes that move, shape (8, 8, 6, 6).
    """
    _, n, P = gap(H, a, b, i, j, flat)
    separation = minus(P, position(H, b, j))
    for s in range(SLOTS):
        nodes[s], sign, w, c = slot(H, a, b, i, j, flat, P, s)
        if nodes[s] < 0:
            continue
        store_motion(H[nodes[s]], sign, w, c, D[s, 0])
        _turns_of_normal(H, b, j, flat, separation, n, D[s, 0], s, D[s, 1])
        for k in range(6):
            rows[s, k] = n[0] * D[s, 0, 0, k] + n[1] * D[s, 0, 1, k] + n[2] * D[s, 0, 2, k]
    for s in range(SLOTS):
        if nodes[s] < 0:
            continue
        node, sign, w, c = slot(H, a, b, i, j, flat, P, s)
        for t in range(SLOTS):
            if nodes[t] < 0:
                continue
            for k in range(6):
                for q in range(6):
                    total = 0.0
                    for r in range(3):
                        total += D[s, 0, r, k] * D[t, 1, r, q]
                    G[s, t, k, q] = total
            if flat and s == MOST_NODES:
                _add_sliding(H[node], local_components(H[node], n), D[t, 0], G[s, t])
        add_turning(scaled(sign, local_components(H[node], n)), w, c, G[s, s])


@inlined_uncounted
def _add_sliding(H: Array, m: Vector, D: Array, block: Array) -> None:
    """Add the motion of the foot on a plane in its frame: ``m × Rᵀ δΔ``."""
    for q in range(6):
        moved = cross(m, local_components(H, (D[0, q], D[1, q], D[2, q])))
        for r in range(3):
            block[3 + r, q] += moved[r]
