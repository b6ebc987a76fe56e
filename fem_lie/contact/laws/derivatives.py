"""First and second derivatives of gaps in motions of nodes: compiled.

With ``D = ∂Δ/∂h`` of the nodes, ``e = ½ Δ·Δ`` and the parameters ``σ`` of a closest point ``Q(σ)``
on a line or patch, ``e_σ = 0``, in directions with ``∂²e/∂σ∂τ = 0``::

    m = −∂²e/∂σ∂h = Dᵀ Q' + (∂Q'/∂h)ᵀ Δ,   s = ∂²e/∂σ² = Q'·Q' − Δ·Q'',   ∂σ/∂h = m/s
    ∂²e/∂h² = Dᵀ D + ∂(Dᵀ)/∂h Δ − Σ m mᵀ/s
    two balls   |Δ| ∂²g/∂h² = ± (∂²e/∂h² − b bᵀ),   |Δ| ∂n/∂h = ± (D − Σ Q' mᵀ/s − n bᵀ)

with ``b = ∂g/∂h``. Derivatives are multiplied by ``|Δ|``, the *scale*, so that they exist where
both points coincide, as those of a ring on its rope. All others have the scale one.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined, inlined_uncounted, uncounted
from fem_lie.contact.sides.gap_functions import bent, local_gap, position_in, turned
from fem_lie.contact.sides.kinematics import (
    SLOTS,
    ContactPoint,
    position,
    pulled_back,
    sign_of,
    slot,
)
from fem_lie.contact.sides.surfaces import MOST_NODES
from fem_lie.contact.sides.table import LEVEL, ROUND, ContactPoints
from fem_lie.lie.motions import global_components, local_components
from fem_lie.lie.node_types.node_type import POSITION_GRADIENT, axes, axes_spin
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


class Derivatives(NamedTuple):
    """Derivatives of the gap of a pair in the motions of the nodes in its slots.

    Attributes:
        nodes: Node of each slot, negative if there is none, shape (8,).
        rows: ``b``, shape (8, 6).
        D: ``∂Δ/∂h``, shape (8, 3, 6).
        N: Scale times ``∂n/∂h``, shape (8, 3, 6).
        G: Scale times ``∂b/∂h``, without ``turning``, shape (8, 8, 6, 6).
        turning: Scale times the derivative of ``b`` as the axes rotate along which it is
            written, shape (8, 6, 6).
        slides: ``m`` of the directions in which the closest point moves, shape (2, 8, 6).
    """

    nodes: Indices
    rows: Array
    D: Array
    N: Array
    G: Array
    turning: Array
    slides: Array


@inlined
def derivatives() -> Derivatives:
    """Workspace for the derivatives of a pair."""
    return Derivatives(
        np.empty(SLOTS, dtype=np.int64),
        np.zeros((SLOTS, 6)),
        np.zeros((SLOTS, 3, 6)),
        np.zeros((SLOTS, 3, 6)),
        np.zeros((SLOTS, SLOTS, 6, 6)),
        np.zeros((SLOTS, 6, 6)),
        np.zeros((2, SLOTS, 6)),
    )


@inlined_uncounted
def unit(k: int) -> Vector:
    """Unit vector along an axis."""
    return (1.0 if k == 0 else 0.0), (1.0 if k == 1 else 0.0), (1.0 if k == 2 else 0.0)


@inlined_uncounted
def column(D: Array, p: int) -> Vector:
    """Column of a matrix (3, n)."""
    return D[0, p], D[1, p], D[2, p]


@uncounted
def _store_motion_of_vectors(
    node_type: int, H: Array, sign: float, w: float, c: float, D: Array
) -> None:
    d1, d2, d3 = axes(node_type, H)
    for r in range(3):
        D[r, 0], D[r, 1], D[r, 2] = sign * w * d1[r], sign * w * d2[r], sign * w * d3[r]
        D[r, 3], D[r, 4], D[r, 5] = sign * c * d1[r], sign * c * d2[r], sign * c * d3[r]


@inlined_uncounted
def store_motion(node_type: int, H: Array, sign: float, w: float, c: Vector, D: Array) -> None:
    """Motion of a point per motion of its node, ``± [w R, −R ĉ]`` for frames, shape (3, 6)."""
    if node_type >= POSITION_GRADIENT:
        _store_motion_of_vectors(node_type, H, sign, w, c[0], D)
        return
    for k in range(3):
        d = load_row(H, 1 + k)
        # column k of R, and of −R ĉ = R (e_k × c)
        rotated = global_components(H, cross(unit(k), c))
        for r in range(3):
            D[r, k] = sign * w * d[r]
            D[r, 3 + k] = sign * rotated[r]


@uncounted
def _add_turning_of_vectors(
    node_type: int, H: Array, f: Vector, w: float, c: float, block: Array
) -> None:
    d1, d2, d3 = axes(node_type, H)
    local = rotate_back(d1, d2, d3, f)
    for k in range(3):
        # components of a constant force along axes that rotate by ψ
        turned_ = cross(local, axes_spin(node_type, H, unit(k)))
        for r in range(3):
            block[r, 3 + k] += w * turned_[r]
            block[3 + r, 3 + k] += c * turned_[r]


@inlined_uncounted
def add_turning(node_type: int, H: Array, f: Vector, w: float, c: Vector, block: Array) -> None:
    """Add the derivative of a generalised force ``Dᵀ f`` as the axes of its node rotate.

    Args:
        node_type: Type of the node.
        H: Nodal coordinates.
        f: Force on a point, global components.
        w: See :func:`~fem_lie.contact.sides.kinematics.pulled_back`.
        c: The same.
        block: Updated, shape (6, 6).
    """
    if node_type >= POSITION_GRADIENT:
        _add_turning_of_vectors(node_type, H, f, w, c[0], block)
        return
    local = local_components(H, f)
    for k in range(3):
        rotated = cross(local, unit(k))
        moment = cross(c, rotated)
        for r in range(3):
            block[r, 3 + k] += w * rotated[r]
            block[3 + r, 3 + k] += moment[r]


@inlined_uncounted
def _set_slides(
    H: Array,
    types: Indices,
    at: ContactPoints,
    e: int,
    direction: int,
    separation: Vector,
    out: Derivatives,
) -> None:
    """Set ``m`` along one direction."""
    t, sliding = load_row(at.sliding.slopes[e], direction), at.sliding
    for s in range(SLOTS):
        node = out.nodes[s]
        if node < 0:
            continue
        m = out.slides[direction, s]
        for p in range(6):
            m[p] = dot(t, column(out.D[s], p))
        if s >= MOST_NODES:
            k = s - MOST_NODES
            w, c = sliding.weights[e, direction, k], load_row(sliding.arms[e, direction], k)
            force, moment = pulled_back(types[node], H[node], w, c, separation)
            for p in range(3):
                m[p] += force[p]
                m[3 + p] += moment[p]


@uncounted
def _set_second_of_balls(
    H: Array, types: Indices, at: ContactPoints, e: int, point: ContactPoint, out: Derivatives
) -> float:
    """Second derivatives of the gap of two balls, and of the normal; their scale."""
    separation = minus(point.first, point.second)
    distance, sign = np.sqrt(dot(separation, separation)), sign_of(at.b, at.pairs[e, 1])
    nodes, rows, D, N = out.nodes, out.rows, out.D, out.N
    for s in range(SLOTS):
        if nodes[s] >= 0:
            for r in range(3):
                for p in range(6):
                    N[s, r, p] = sign * (D[s, r, p] - point.normal[r] * rows[s, p])
    for s in range(SLOTS):
        for t in range(SLOTS):
            if nodes[s] >= 0 and nodes[t] >= 0:
                for p in range(6):
                    for q in range(6):
                        total = dot(column(D[s], p), column(D[t], q))
                        out.G[s, t, p, q] = sign * (total - rows[s, p] * rows[t, q])
    for direction in range(2):
        slope = load_row(at.sliding.slopes[e], direction)
        # it is zero where the closest point stays at an end
        if dot(slope, slope) == 0.0:
            continue
        _set_slides(H, types, at, e, direction, separation, out)
        bend, m = at.sliding.bends[e, direction], out.slides[direction]
        for s in range(SLOTS):
            if nodes[s] < 0:
                continue
            for p in range(6):
                part = sign * m[s, p] / bend
                for r in range(3):
                    N[s, r, p] -= slope[r] * part
                for t in range(SLOTS):
                    if nodes[t] >= 0:
                        for q in range(6):
                            out.G[s, t, p, q] -= part * m[t, q]
    return distance


@uncounted
def _set_second_of_planes(
    H: Array, at: ContactPoints, e: int, point: ContactPoint, out: Derivatives
) -> None:
    """Second derivatives of the gap to a plane or a gap function, and of the normal."""
    b, j = at.b, at.pairs[e, 1]
    nodes, m = out.nodes, load_row(b.normals, j)
    diagonal, others = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    if at.kind == LEVEL:
        separation = minus(point.first, position(H, b, j))
        _, m, diagonal, others = local_gap(b, j, position_in(H, b, j, separation))
    for s in range(SLOTS):
        if nodes[s] < 0:
            continue
        for p in range(6):
            n = (0.0, 0.0, 0.0)
            if at.kind == LEVEL:
                moved = position_in(H, b, j, column(out.D[s], p))
                n = turned(H, b, j, bent(diagonal, others, moved))
            if s == MOST_NODES and p >= 3:
                n = plus(n, global_components(H[nodes[s]], cross(unit(p - 3), m)))
            out.N[s, 0, p], out.N[s, 1, p], out.N[s, 2, p] = n
    for s in range(SLOTS):
        for t in range(SLOTS):
            if nodes[s] >= 0 and nodes[t] >= 0:
                for p in range(6):
                    for q in range(6):
                        out.G[s, t, p, q] = dot(column(out.D[s], p), column(out.N[t], q))
    # the foot moves in the frame of the surface: m × Rᵀ δΔ
    own = nodes[MOST_NODES]
    if own >= 0:
        normal = local_components(H[own], point.normal)
        for t in range(SLOTS):
            for q in range(6 if nodes[t] >= 0 else 0):
                moved = cross(normal, local_components(H[own], column(out.D[t], q)))
                for r in range(3):
                    out.G[MOST_NODES, t, 3 + r, q] += moved[r]


@uncounted
def set_derivatives(
    H: Array, types: Indices, at: ContactPoints, e: int, point: ContactPoint, out: Derivatives
) -> float:
    """Set the derivatives of the gap of a pair; return their scale.

    Args:
        H: Nodal coordinates.
        types: Types of all nodes, shape (n,).
        at: Contact points, without edges of polyhedra.
        e: Number of the pair.
        point: Its contact point.
        out: Overwritten for nodes that move.
    """
    (i, j), n = at.pairs[e], point.normal
    for s in range(SLOTS):
        node, sign, w, c = slot(H, at.a, at.b, i, j, at.kind, point, s)
        out.nodes[s] = node
        if node < 0:
            continue
        store_motion(types[node], H[node], sign, w, c, out.D[s])
        for p in range(6):
            out.rows[s, p] = dot(n, column(out.D[s], p))
    scale = 1.0
    if at.kind == ROUND:
        scale = _set_second_of_balls(H, types, at, e, point, out)
    else:
        _set_second_of_planes(H, at, e, point, out)
    for s in range(SLOTS):
        node, sign, w, c = slot(H, at.a, at.b, i, j, at.kind, point, s)
        if node >= 0:
            out.turning[s] = 0.0
            force = scaled(sign * scale, n)
            add_turning(types[node], H[node], force, w, c, out.turning[s])
    return scale
