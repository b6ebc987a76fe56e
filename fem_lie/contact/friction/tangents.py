"""Derivatives of forces of friction, compiled."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined_uncounted
from fem_lie.contact.friction.anchors import Anchors, Traction, stretch_of, traction
from fem_lie.contact.friction.coulomb import CoulombLaw, limit
from fem_lie.contact.sides.gauss_points import Meeting, set_slide, slides
from fem_lie.contact.sides.kinematics import SLOTS, add_turning, bends, gap, place
from fem_lie.lie.motions import global_components, local_components
from fem_lie.lie.tuples import Vector, combined, cross, dot, load, load_row, minus, scaled


@inlined_uncounted
def _motion(H: Array, w: float, c: Vector, D: Array) -> None:
    """``[w R, −R ĉ]`` of an anchor, shape (3, 6)."""
    for k in range(3):
        e = (1.0 if k == 0 else 0.0, 1.0 if k == 1 else 0.0, 1.0 if k == 2 else 0.0)
        moved, turned = global_components(H, e), global_components(H, cross(e, c))
        for r in range(3):
            D[r, k], D[r, 3 + k] = w * moved[r], turned[r]


@inlined_uncounted
def _change(
    law: CoulombLaw, t: Traction, n: Vector, u: Vector, δu: Vector, δn: Vector, δg: float
) -> Vector:
    """How a traction changes."""
    δacross = combined(1.0, δu, -dot(n, δu) - dot(δn, u), n)
    δacross = combined(1.0, δacross, -dot(n, u), δn)
    if not t.slips:
        return scaled(law.holding, δacross)
    turned = combined(1.0, δacross, -dot(t.along, δacross), t.along)
    return combined(dot(t.τ, t.along) / t.size, turned, limit(law, -δg), t.along)


@compiled
def add_traction_tangents(
    H: Array,
    at: Meeting,
    anchors: Anchors,
    which: Indices,
    law: CoulombLaw,
    given: Array,
    blocks: Array,
) -> None:
    """Add derivatives of the forces in twists of frames, where anchors have the nodes of places.

    ``given`` are gaps, normals and ``u`` at the end of a step, (m, ≥ 7), of which tractions depend
    twice as much as all else in the middle; or nothing, (0, 7).
    """
    over_step = given.shape[0] > 0
    nodes, rows = np.empty(SLOTS, dtype=np.int64), np.zeros((SLOTS, 6))
    D, G = np.zeros((SLOTS, 2, 3, 6)), np.zeros((SLOTS, SLOTS, 6, 6))
    A, T = np.zeros((SLOTS, 3, 6)), np.zeros((SLOTS, 3, 6))
    row = np.empty(6)
    for e in range(at.pairs.shape[0]):
        i, j = at.pairs[e]
        q, weight = which[e], at.weight[e]
        g, n, _ = gap(H, at.a, at.b, i, j, at.flat)
        if over_step and q >= 0:
            g, n = given[e, 0], load(given[e], 1)
        if g >= 0.0 or q < 0:
            continue
        bends(H, at.a, at.b, i, j, at.flat, nodes, rows, D, G)
        if _others(nodes, anchors.nodes[q]):
            continue
        if not at.flat and not over_step:
            _follow(H, at, e, n, nodes, D, row)
        u = load(given[e], 4) if over_step else stretch_of(H, anchors, q)
        t, share = traction(law, g, n, u), 2.0 * weight if over_step else weight
        for s in range(SLOTS):
            if nodes[s] >= 0:
                c = load_row(anchors.levers[q], s)
                _motion(H[nodes[s]], anchors.weights[q, s], c, A[s])
                for p in range(6):
                    δu, δn = _column(A[s], p), _column(D[s, 1], p)
                    δτ = _change(law, t, n, u, δu, δn, rows[s, p])
                    T[s, 0, p], T[s, 1, p], T[s, 2, p] = δτ
        block = at.first[e]
        for s in range(SLOTS):
            for o in range(SLOTS):
                if nodes[s] < 0 or nodes[o] < 0:
                    continue
                for p in range(6):
                    for r in range(6):
                        total = dot(_column(A[s], p), _column(T[o], r))
                        blocks[block, p, r] += share * total
                if s == o:
                    f = local_components(H[nodes[s]], scaled(weight, t.τ))
                    c = load_row(anchors.levers[q], s)
                    add_turning(f, anchors.weights[q, s], c, blocks[block])
                block += 1


@inlined_uncounted
def _follow(H: Array, at: Meeting, e: int, n: Vector, nodes: Indices, D: Array, row: Array) -> None:
    """How normals turn as second places follow the first ones: ``δn −= Q' δσ/|Δ|``."""
    i, j = at.pairs[e]
    apart = minus(place(H, at.a, i), place(H, at.b, j))
    distance = np.sqrt(dot(apart, apart))
    for k in range(2):
        if not slides(at.sliding, e, k):
            continue
        t = at.sliding.slopes[e, k]
        for s in range(SLOTS):
            if nodes[s] >= 0:
                set_slide(H, at.sliding, e, k, s, nodes[s], n, distance, D[s, 0], row)
                for r in range(3):
                    for p in range(6):
                        D[s, 1, r, p] -= t[r] * row[p] / at.sliding.bends[e, k]


@inlined_uncounted
def _column(D: Array, p: int) -> Vector:
    return D[0, p], D[1, p], D[2, p]


@inlined_uncounted
def _others(nodes: Indices, own: Indices) -> bool:
    """Whether nodes are others than those of an anchor, which slid on to other elements."""
    for s in range(SLOTS):
        if nodes[s] != own[s] and (nodes[s] >= 0 or own[s] >= 0):
            return True
    return False
