"""Derivatives of friction by penalty in the motions of nodes, compiled."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined_uncounted
from fem_lie.contact.laws import friction_over_steps as over_steps
from fem_lie.contact.laws.anchors import (
    Anchors,
    CoulombLaw,
    Traction,
    limit,
    stretch_of,
    traction,
)
from fem_lie.contact.laws.derivatives import (
    add_turning,
    column,
    derivatives,
    set_derivatives,
    store_motion,
)
from fem_lie.contact.sides.kinematics import SLOTS, contact_point
from fem_lie.contact.sides.table import ContactPoints
from fem_lie.lie.tuples import Vector, combined, dot, load_row, scaled


@inlined_uncounted
def change_across(n: Vector, u: Vector, δu: Vector, δn: Vector) -> Vector:
    """Variation of the part of ``u`` across the normal."""
    δacross = combined(1.0, δu, -dot(n, δu) - dot(δn, u), n)
    return combined(1.0, δacross, -dot(n, u), δn)


@inlined_uncounted
def change_of(
    law: CoulombLaw, t: Traction, n: Vector, u: Vector, δu: Vector, δn: Vector, δg: float
) -> Vector:
    """Variation of a traction."""
    δacross = change_across(n, u, δu, δn)
    if not t.slips:
        return scaled(law.holding, δacross)
    turned = combined(1.0, δacross, -dot(t.along, δacross), t.along)
    return combined(dot(t.τ, t.along) / t.size, turned, limit(law, -δg), t.along)


@compiled
def add_traction_tangents(
    H: Array,
    types: Indices,
    at: ContactPoints,
    anchors: Anchors,
    which: Indices,
    law: CoulombLaw,
    given: over_steps.Slips,
    blocks: Array,
) -> None:
    """Add derivatives of the friction forces in twists, for anchors on the nodes of the pair.

    ``given`` are the variables of a step for forces of a step, where tractions depend on the end of
    the step and all else on its midpoint, so that their derivative has a factor of two; those of no
    pair for forces at frames.
    """
    over_step, by = given.gaps.shape[0] > 0, derivatives()
    A, T = np.zeros((SLOTS, 3, 6)), np.zeros((SLOTS, 3, 6))
    for e in range(at.pairs.shape[0]):
        q, weight = which[e], at.weight[e]
        point = contact_point(H, at.a, at.b, at.pairs[e, 0], at.pairs[e, 1], at.kind)
        g, n, part = point.gap, point.normal, 1.0
        if over_step and q >= 0:
            g, n, part = given.gaps[e], load_row(given.normals, e), given.by_gap[e]
        if g >= 0.0 or q < 0:
            continue
        scale, nodes = set_derivatives(H, types, at, e, point, by), by.nodes
        if on_other_nodes(nodes, anchors.nodes[q]):
            continue
        u = load_row(given.stretches, e) if over_step else stretch_of(H, anchors, q)
        t, fraction = traction(law, g, n, u), 2.0 * weight if over_step else weight
        for s in range(SLOTS):
            if nodes[s] >= 0:
                c, node = load_row(anchors.arms[q], s), nodes[s]
                store_motion(types[node], H[node], 1.0, anchors.weights[q, s], c, A[s])
                for p in range(6):
                    δu, δn = column(A[s], p), scaled(1.0 / scale, column(by.N[s], p))
                    δτ = change_of(law, t, n, u, δu, δn, part * by.rows[s, p])
                    T[s, 0, p], T[s, 1, p], T[s, 2, p] = δτ
        add_blocks(nodes, A, T, fraction, at.first[e], blocks)
        add_turnings(H, types, nodes, anchors, q, scaled(weight, t.τ), at.first[e], blocks)


@inlined_uncounted
def add_blocks(nodes: Indices, A: Array, T: Array, weight: float, block: int, out: Array) -> None:
    """Add ``weight Aᵀ T`` to the blocks of a pair from number ``block``; A, T are (8, 3, 6)."""
    for s in range(SLOTS):
        for o in range(SLOTS):
            if nodes[s] < 0 or nodes[o] < 0:
                continue
            for p in range(6):
                for r in range(6):
                    out[block, p, r] += weight * dot(column(A[s], p), column(T[o], r))
            block += 1


@inlined_uncounted
def add_turnings(
    H: Array,
    types: Indices,
    nodes: Indices,
    anchors: Anchors,
    q: int,
    f: Vector,
    block: int,
    out: Array,
) -> None:
    """Add the derivatives of the forces of ``f`` on anchors as the axes of nodes rotate."""
    for s in range(SLOTS):
        for o in range(SLOTS):
            if nodes[s] < 0 or nodes[o] < 0:
                continue
            if s == o:
                w, c, node = anchors.weights[q, s], load_row(anchors.arms[q], s), nodes[s]
                add_turning(types[node], H[node], f, w, c, out[block])
            block += 1


@inlined_uncounted
def on_other_nodes(nodes: Indices, own: Indices) -> bool:
    """Whether the anchor has moved on to other elements than those of the pair."""
    for s in range(SLOTS):
        if nodes[s] != own[s] and (nodes[s] >= 0 or own[s] >= 0):
            return True
    return False
