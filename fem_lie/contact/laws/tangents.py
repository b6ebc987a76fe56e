"""Contact forces of penalties along the normal, and their derivatives, compiled."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined_uncounted, uncounted
from fem_lie.contact.laws.energy import PenaltyConstants, damping
from fem_lie.contact.laws.over_steps import BY_GAP, SLOPE
from fem_lie.contact.sides.gauss_points import ContactPoints, set_slide, slides
from fem_lie.contact.sides.kinematics import SLOTS, bends, gap, position, rate, slot
from fem_lie.contact.sides.table import Side
from fem_lie.lie.motions import local_components
from fem_lie.lie.tuples import Vector, cross, dot, minus, scaled


@inlined_uncounted
def speed_of(
    H: Array, v: Array, a: Side, b: Side, i: int, j: int, flat: bool, P: Vector, n: Vector
) -> float:
    """Rate ``ġ`` of the gap of a pair."""
    found = 0.0
    for s in range(SLOTS):
        node, sign, w, c = slot(H, a, b, i, j, flat, P, s)
        if node >= 0:
            found += sign * rate(H, v, node, w, c, n)
    return found


@compiled
def tangents(
    H: Array,
    v: Array,
    at: ContactPoints,
    law: PenaltyConstants,
    viscous: bool,
    given: Array,
    by_frames: Array,
    by_twists: Array,
) -> None:
    """Add the derivatives of contact forces, or of their damping, in frames and in twists.

    ``given`` are the secants of a step, shape (≥ 2, m), or empty, shape (0, 0).
    """
    over_step = given.shape[0] > 0
    nodes, rows, changes = (
        np.empty(SLOTS, dtype=np.int64),
        np.zeros((SLOTS, 6)),
        np.zeros((SLOTS, 6)),
    )
    D, G = np.zeros((SLOTS, 2, 3, 6)), np.zeros((SLOTS, SLOTS, 6, 6))
    for e in range(at.pairs.shape[0]):
        i, j = at.pairs[e]
        g, n, P = gap(H, at.a, at.b, i, j, at.flat)
        if over_step:
            if given[SLOPE, e] == 0.0:
                continue
        elif g >= 0.0:
            continue
        bends(H, at.a, at.b, i, j, at.flat, nodes, rows, D, G)
        if not at.flat:
            for direction in range(2):
                _slide(H, at, e, direction, n, nodes, D, G)
        f, by_gap, by_speed = law.k * g, law.k, 0.0
        if viscous:
            speed = speed_of(H, v, at.a, at.b, i, j, at.flat, P, n)
            f, by_gap, by_speed = damping(law, g, speed)
            _changes_of_speed(v, nodes, G, changes)
        elif over_step:
            f, by_gap = law.k * given[SLOPE, e], law.k * given[BY_GAP, e]
        block, weight = at.first[e], at.weight[e]
        for s in range(SLOTS):
            for t in range(SLOTS):
                if nodes[s] < 0 or nodes[t] < 0:
                    continue
                for p in range(6):
                    for q in range(6):
                        to_frame = by_gap * rows[t, q] + by_speed * changes[t, q]
                        change = f * G[s, t, p, q] + rows[s, p] * to_frame
                        by_frames[block, p, q] += weight * change
                        if viscous:
                            by_twists[block, p, q] += weight * by_speed * rows[s, p] * rows[t, q]
                block += 1


@uncounted
def normal_rows(
    H: Array, at: ContactPoints, k: float, nodes: Indices, rows: Array, stiffness: Array
) -> int:
    """Rows and number of the pairs that overlap; see :class:`~.term.StiffRows`."""
    found = 0
    for e in range(at.pairs.shape[0]):
        i, j = at.pairs[e]
        g, n, P = gap(H, at.a, at.b, i, j, at.flat)
        if g >= 0.0:
            continue
        for s in range(SLOTS):
            node, sign, w, c = slot(H, at.a, at.b, i, j, at.flat, P, s)
            nodes[found, s] = max(node, -1)
            if node >= 0:
                f = local_components(H[node], scaled(sign, n))
                moment = cross(c, f)
                for p in range(3):
                    rows[found, s, p], rows[found, s, 3 + p] = w * f[p], moment[p]
        stiffness[found] = k * at.weight[e]
        found += 1
    return found


@inlined_uncounted
def _slide(
    H: Array, at: ContactPoints, e: int, k: int, n: Vector, nodes: Indices, D: Array, G: Array
) -> None:
    """Add ``−m mᵀ/s``: the closest point on the second side moves along; see :class:`.Sliding`."""
    i, j = at.pairs[e]
    if not slides(at.sliding, e, k):
        return
    separation = minus(position(H, at.a, i), position(H, at.b, j))
    distance = np.sqrt(dot(separation, separation))
    for s in range(SLOTS):
        if nodes[s] >= 0:
            # D is reused as workspace
            set_slide(H, at.sliding, e, k, s, nodes[s], n, distance, D[s, 0], D[s, 1, 0])
    for a in range(SLOTS):
        for b in range(SLOTS):
            if nodes[a] >= 0 and nodes[b] >= 0:
                for p in range(6):
                    for q in range(6):
                        product = D[a, 1, 0, p] * D[b, 1, 0, q]
                        G[a, b, p, q] -= product * distance / at.sliding.bends[e, k]


@inlined_uncounted
def _changes_of_speed(v: Array, nodes: Indices, G: Array, changes: Array) -> None:
    """Derivative ``∂ġ/∂h`` of each slot at constant twists."""
    changes[:] = 0.0
    for s in range(SLOTS):
        for t in range(SLOTS):
            if nodes[s] < 0 or nodes[t] < 0:
                continue
            for p in range(6):
                for q in range(6):
                    changes[t, q] += v[nodes[s], p] * G[s, t, p, q]
