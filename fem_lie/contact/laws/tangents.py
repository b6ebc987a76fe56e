"""Derivatives of the contact forces of penalties along the normal, compiled."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined_uncounted, uncounted
from fem_lie.contact.laws.derivatives import Derivatives, derivatives, set_derivatives
from fem_lie.contact.laws.energy import PenaltyConstants, damping
from fem_lie.contact.laws.over_steps import Secants
from fem_lie.contact.sides.kinematics import SLOTS, ContactPoint, contact_point, pulled_back, slot
from fem_lie.contact.sides.table import ContactPoints
from fem_lie.lie.node_types import POSITION_GRADIENT
from fem_lie.lie.tuples import dot, load, scaled, store


@inlined_uncounted
def speed_of(
    H: Array, v: Array, types: Indices, at: ContactPoints, e: int, point: ContactPoint
) -> float:
    """Rate ``ġ`` of the gap of a pair."""
    (i, j), found = at.pairs[e], 0.0
    for s in range(SLOTS):
        node, sign, w, c = slot(H, at.a, at.b, i, j, at.kind, point, s)
        if node >= 0:
            force, moment = pulled_back(types[node], H[node], w, c, scaled(sign, point.normal))
            found += dot(force, load(v[node], 0)) + dot(moment, load(v[node], 3))
    return found


@compiled
def tangents(
    H: Array,
    v: Array,
    types: Indices,
    at: ContactPoints,
    law: PenaltyConstants,
    viscous: bool,
    given: Secants,
    by_frames: Array,
    by_twists: Array,
) -> None:
    """Add the derivatives of contact forces, or of their damping, in frames and in twists.

    ``given`` are the secants of a step, or those of no pair.
    """
    over_step, by = given.σ.shape[0] > 0, derivatives()
    nodes, rows, changes = by.nodes, by.rows, np.zeros((SLOTS, 6))
    for e in range(at.pairs.shape[0]):
        point = contact_point(H, at.a, at.b, at.pairs[e, 0], at.pairs[e, 1], at.kind)
        if over_step:
            if given.σ[e] == 0.0:
                continue
        elif point.gap >= 0.0:
            continue
        scale = set_derivatives(H, types, at, e, point, by)
        f, by_gap, by_speed = law.k * point.gap, law.k, 0.0
        if viscous:
            speed = speed_of(H, v, types, at, e, point)
            f, by_gap, by_speed = damping(law, point.gap, speed)
            set_changes_of_speed(v, types, by, scale, changes)
        elif over_step:
            f, by_gap = law.k * given.σ[e], law.k * given.by_gap[e]
        block, weight, bent = at.first[e], at.weight[e], f / scale
        for s in range(SLOTS):
            for t in range(SLOTS):
                if nodes[s] < 0 or nodes[t] < 0:
                    continue
                for p in range(6):
                    for q in range(6):
                        to_frame = by_gap * rows[t, q] + by_speed * changes[t, q]
                        change = bent * by.G[s, t, p, q] + rows[s, p] * to_frame
                        if s == t:
                            change += bent * by.turning[s, p, q]
                        by_frames[block, p, q] += weight * change
                        if viscous:
                            by_twists[block, p, q] += weight * by_speed * rows[s, p] * rows[t, q]
                block += 1


@uncounted
def normal_rows(
    H: Array,
    types: Indices,
    at: ContactPoints,
    k: float,
    nodes: Indices,
    rows: Array,
    stiffness: Array,
) -> int:
    """Rows and number of the pairs that overlap; see :class:`~.term.StiffRows`."""
    found = 0
    for e in range(at.pairs.shape[0]):
        i, j = at.pairs[e]
        point = contact_point(H, at.a, at.b, i, j, at.kind)
        if point.gap >= 0.0:
            continue
        for s in range(SLOTS):
            node, sign, w, c = slot(H, at.a, at.b, i, j, at.kind, point, s)
            nodes[found, s] = max(node, -1)
            if node >= 0:
                force, moment = pulled_back(types[node], H[node], w, c, scaled(sign, point.normal))
                store(rows[found, s], 0, force)
                store(rows[found, s], 3, moment)
        stiffness[found] = k * at.weight[e]
        found += 1
    return found


@inlined_uncounted
def set_changes_of_speed(
    v: Array, types: Indices, by: Derivatives, scale: float, changes: Array
) -> None:
    """Derivative ``∂ġ/∂h`` of each slot at constant twists.

    Twists of frames are constant along the axes of these; the velocities of other nodes are
    constant in space.
    """
    changes[:] = 0.0
    for s in range(SLOTS):
        for t in range(SLOTS):
            if by.nodes[s] < 0 or by.nodes[t] < 0:
                continue
            turns = s == t and types[by.nodes[s]] < POSITION_GRADIENT
            for p in range(6):
                for q in range(6):
                    more = by.turning[s, p, q] if turns else 0.0
                    changes[t, q] += v[by.nodes[s], p] * (by.G[s, t, p, q] + more) / scale
