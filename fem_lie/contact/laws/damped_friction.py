"""Friction with damping: dampers parallel to tangential springs, within the whole normal force.

With the traction ``τ_e`` of a spring, the normal force ``p`` with its damping, and the tangential
velocity ``v`` of the anchors::

    p = max(0, −k g − c ġ),  T = τ_e + c v,  τ = T while |T| ≤ μ p, else μ p T/|T|

The elongation of a spring depends on frames alone, as without damping; ``τ − τ_e`` is the viscous
part. Springs alone would return the energy of a contact that sticks, and let the body slide back;
their limit alone, ``μ k`` times the overlap, is not that of Coulomb while the damping acts.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined_uncounted
from fem_lie.contact.laws.anchors import Anchors, CoulombLaw, Traction, stretch_of, traction
from fem_lie.contact.laws.derivatives import (
    column,
    derivatives,
    set_derivatives,
    store_motion,
    unit,
)
from fem_lie.contact.laws.energy import damping
from fem_lie.contact.laws.friction_tangents import (
    add_blocks,
    add_turnings,
    change_across,
    change_of,
    on_other_nodes,
)
from fem_lie.contact.laws.tangents import set_changes_of_speed, speed_of
from fem_lie.contact.sides.kinematics import SLOTS, contact_point
from fem_lie.contact.sides.table import ContactPoints
from fem_lie.lie.motions import global_components
from fem_lie.lie.node_types import POSITION_GRADIENT, axes
from fem_lie.lie.tuples import (
    Vector,
    combined,
    cross,
    dot,
    load,
    load_row,
    minus,
    plus,
    rotate,
    scaled,
    store_row,
)


class _Damped(NamedTuple):
    """Traction with damping.

    Attributes:
        spring: That of the spring alone.
        τ: Traction.
        trial: ``T``.
        rate: Relative velocity of the anchors.
        most: ``μ p``.
        by_gap: ``∂(μ p)/∂g``.
        by_speed: ``∂(μ p)/∂ġ``.
    """

    spring: Traction
    τ: Vector
    trial: Vector
    rate: Vector
    most: float
    by_gap: float
    by_speed: float


@inlined_uncounted
def _velocity(node_type: int, H: Array, v: Array, w: float, c: Vector) -> Vector:
    """Velocity of a point of a node, global components."""
    if node_type < POSITION_GRADIENT:
        return global_components(H, combined(w, load(v, 0), 1.0, cross(load(v, 3), c)))
    d1, d2, d3 = axes(node_type, H)
    return rotate(d1, d2, d3, combined(w, load(v, 0), c[0], load(v, 3)))


@inlined_uncounted
def _turned_velocity(node_type: int, H: Array, v: Array, w: float, c: Vector, p: int) -> Vector:
    """Derivative of :func:`_velocity` as component ``p`` of a motion rotates the axes.

    Twists of frames are constant along the axes of these; the velocities of other nodes are
    constant in space.
    """
    if p < 3 or node_type >= POSITION_GRADIENT:
        return 0.0, 0.0, 0.0
    own = combined(w, load(v, 0), 1.0, cross(load(v, 3), c))
    return global_components(H, cross(unit(p - 3), own))


@inlined_uncounted
def _rate_of(H: Array, v: Array, types: Indices, anchors: Anchors, q: int) -> Vector:
    """Relative velocity of the anchors of a pair."""
    rate = (0.0, 0.0, 0.0)
    for s in range(SLOTS):
        node = anchors.nodes[q, s]
        if node >= 0:
            w, c = anchors.weights[q, s], load_row(anchors.arms[q], s)
            rate = plus(rate, _velocity(types[node], H[node], v[node], w, c))
    return rate


@inlined_uncounted
def _across(a: Vector, n: Vector) -> Vector:
    """Part of ``a`` across the normal."""
    return combined(1.0, a, -dot(n, a), n)


@inlined_uncounted
def _damped(
    law: CoulombLaw, g: float, speed: float, n: Vector, stretch: Vector, rate: Vector
) -> _Damped:
    """Traction of an overlapping pair."""
    spring = traction(law, g, n, stretch)
    f, by_gap, by_speed = damping(law.normal, g, speed)
    most = max(0.0, -law.μ * (law.normal.k * g + f))
    trial = combined(law.holding, _across(stretch, n), law.normal.c, _across(rate, n))
    size, τ = np.sqrt(dot(trial, trial)), trial
    if size > most:
        τ = scaled(most / size, trial)
    by_gap = -law.μ * (law.normal.k + by_gap)
    return _Damped(spring, τ, trial, rate, most, by_gap, -law.μ * by_speed)


@inlined_uncounted
def _change(of: _Damped, δtrial: Vector, δmost: float) -> Vector:
    """Variation of a traction."""
    size = np.sqrt(dot(of.trial, of.trial))
    if size <= of.most:
        return δtrial
    along = scaled(1.0 / size, of.trial)
    return combined(of.most / size, _across(δtrial, along), δmost, along)


@compiled
def damping_tractions(
    H: Array,
    v: Array,
    types: Indices,
    at: ContactPoints,
    anchors: Anchors,
    which: Indices,
    law: CoulombLaw,
    out: Array,
) -> None:
    """Viscous part of the tractions on the second side, overwritten, shape (m, 3)."""
    for e in range(at.pairs.shape[0]):
        store_row(out, e, (0.0, 0.0, 0.0))
        point, q = contact_point(H, at.a, at.b, at.pairs[e, 0], at.pairs[e, 1], at.kind), which[e]
        if point.gap < 0.0 and q >= 0:
            speed = speed_of(H, v, types, at, e, point)
            u, rate = stretch_of(H, anchors, q), _rate_of(H, v, types, anchors, q)
            found = _damped(law, point.gap, speed, point.normal, u, rate)
            store_row(out, e, minus(found.τ, found.spring.τ))


@compiled
def add_damping_tangents(
    H: Array,
    v: Array,
    types: Indices,
    at: ContactPoints,
    anchors: Anchors,
    which: Indices,
    law: CoulombLaw,
    by_frames: Array,
    by_twists: Array,
) -> None:
    """Add derivatives of the viscous part, for anchors on the nodes of the pair.

    Those in frames are at constant components of twists along the axes of the frames, and at
    velocities of other nodes that are constant in space.
    """
    by, changes, c = derivatives(), np.zeros((SLOTS, 6)), law.normal.c
    A, T, D = np.zeros((SLOTS, 3, 6)), np.zeros((SLOTS, 3, 6)), np.zeros((SLOTS, 3, 6))
    for e in range(at.pairs.shape[0]):
        q, weight = which[e], at.weight[e]
        point = contact_point(H, at.a, at.b, at.pairs[e, 0], at.pairs[e, 1], at.kind)
        g, n = point.gap, point.normal
        if g >= 0.0 or q < 0:
            continue
        scale, nodes = set_derivatives(H, types, at, e, point, by), by.nodes
        if on_other_nodes(nodes, anchors.nodes[q]):
            continue
        set_changes_of_speed(v, types, by, scale, changes)
        u, rate = stretch_of(H, anchors, q), _rate_of(H, v, types, anchors, q)
        found = _damped(law, g, speed_of(H, v, types, at, e, point), n, u, rate)
        for s in range(SLOTS):
            if nodes[s] < 0:
                continue
            w, arm, node = anchors.weights[q, s], load_row(anchors.arms[q], s), nodes[s]
            store_motion(types[node], H[node], 1.0, w, arm, A[s])
            for p in range(6):
                δu, δn = column(A[s], p), scaled(1.0 / scale, column(by.N[s], p))
                δrate = _turned_velocity(types[node], H[node], v[node], w, arm, p)
                δspring = change_of(law, found.spring, n, u, δu, δn, by.rows[s, p])
                δmost = found.by_gap * by.rows[s, p] + found.by_speed * changes[s, p]
                δu, δrate = change_across(n, u, δu, δn), change_across(n, rate, δrate, δn)
                δτ = _change(found, combined(law.holding, δu, c, δrate), δmost)
                T[s, 0, p], T[s, 1, p], T[s, 2, p] = minus(δτ, δspring)
                δmost = found.by_speed * by.rows[s, p]
                δτ = _change(found, scaled(c, _across(column(A[s], p), n)), δmost)
                D[s, 0, p], D[s, 1, p], D[s, 2, p] = δτ
        viscous = scaled(weight, minus(found.τ, found.spring.τ))
        add_blocks(nodes, A, T, weight, at.first[e], by_frames)
        add_blocks(nodes, A, D, weight, at.first[e], by_twists)
        add_turnings(H, types, nodes, anchors, q, viscous, at.first[e], by_frames)
