"""Friction forces of a step: their work is stored in springs or dissipated, never created.

Both anchors act at one point of the mean configuration, that of the first side: the moment arm of
the second is moved there, ``c ← c + w R̄⁻¹ ū``; if the nodes of the second have no rotations, that
of the first is moved to the point of the second. Hence a traction has no moment, and does the work
``τ·s`` on the slip ``s = Σ w Δx + ΔR c`` of these two material points. With the spring elongation
``e`` at the start::

    τ = k T (e + s) across the normal at the end, limited by μ p;  e₁ = τ/k
    dissipation = τ·s − ½ k (e₁² − e²) ≥ ½ k |e₁ − e|²

because ``τ·(e + s) ≥ k e₁²`` whether or not the traction is limited. The pressure ``p`` is that of
the secant of the potential, the mean over the step also where the pair meets or separates in it.
Springs are kept within the limit of the end, zero for pairs that are separate then, where a smaller
``e₁`` dissipates more: at least ``τ·s + ½ k e² ≥ ¼ k e²``.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined_uncounted, uncounted
from fem_lie.contact.laws.anchors import Anchors, CoulombLaw, limit, stretch_of, traction
from fem_lie.contact.laws.over_steps import secant
from fem_lie.contact.sides.kinematics import SLOTS, contact_point
from fem_lie.contact.sides.surfaces import MOST_NODES
from fem_lie.contact.sides.table import GROUND, ContactPoints
from fem_lie.forms.abilities import Ends
from fem_lie.lie.motions import global_components
from fem_lie.lie.node_types import POSITION_GRADIENT
from fem_lie.lie.tuples import (
    Vector,
    combined,
    cross,
    dot,
    load,
    load_row,
    minus,
    plus,
    scaled,
    store,
    store_row,
)


class Slips(NamedTuple):
    """Variables of the tractions of all pairs over a step, in global components.

    Attributes:
        gaps: Gaps of the mean pressure over the step, shape (m,).
        by_gap: Their derivatives in the gaps at the end, shape (m,).
        normals: Normals at the end, shape (m, 3).
        stretches: Elongations ``e + s`` at the end without slip, shape (m, 3).
        springs: Elongations ``e`` at the start, shape (m, 3).
        slips: ``s``, shape (m, 3).
        τ: Tractions on the second side, shape (m, 3).
        held: Tractions of the springs at the end, within the limit there, shape (m, 3).
    """

    gaps: Array
    by_gap: Array
    normals: Array
    stretches: Array
    springs: Array
    slips: Array
    τ: Array
    held: Array


@compiled
def empty_slips(m: int) -> Slips:
    """Zero variables of ``m`` pairs."""
    n, v = np.zeros((2, m)), np.zeros((6, m, 3))
    return Slips(n[0], n[1], v[0], v[1], v[2], v[3], v[4], v[5])


@inlined_uncounted
def _in_frame(H: Array, a: Vector) -> Vector:
    """Components of ``a`` along the rows of a frame that need not be orthonormal."""
    d, e, f = load_row(H, 1), load_row(H, 2), load_row(H, 3)
    volume = dot(d, cross(e, f))
    along = dot(cross(e, f), a), dot(cross(f, d), a), dot(cross(d, e), a)
    return scaled(1.0 / volume, along)


@compiled
def set_over_step(
    ends: Ends,
    types: Indices,
    at: ContactPoints,
    anchors: Anchors,
    which: Indices,
    law: CoulombLaw,
    arms: Anchors,
    out: Slips,
) -> None:
    """Moment arms at one point, and variables of the traction, for each pair with anchors.

    Args:
        ends: Both ends of the step.
        types: Types of all nodes, shape (n,).
        at: Contact points.
        anchors: Anchors at the start of the step.
        which: Index of the anchors of each pair, −1: none.
        law: Constants.
        arms: Overwritten for pairs with anchors; one for each pair.
        out: Set for pairs with anchors, zero before.
    """
    for e in range(at.pairs.shape[0]):
        q = which[e]
        if q < 0:
            continue
        mean, spring, slip = stretch_of(ends.mean, anchors, q), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        # an open contact has no spring: round-off of its anchors would act as a force
        held = load_row(anchors.forces, q)
        if dot(held, held) > 0.0:
            spring = stretch_of(ends.start, anchors, q)
        other = anchors.nodes[q, MOST_NODES]
        moves_first = other >= 0 and types[other] >= POSITION_GRADIENT
        for s in range(SLOTS):
            node, w = anchors.nodes[q, s], anchors.weights[q, s]
            arms.nodes[e, s], arms.weights[e, s] = node, w
            if node < 0:
                continue
            c = load_row(anchors.arms[q], s)
            if (s < MOST_NODES) == moves_first and types[node] < POSITION_GRADIENT:
                sign = -1.0 if moves_first else 1.0
                c = combined(1.0, c, sign * w, _in_frame(ends.mean[node], mean))
            store_row(arms.arms[e], s, c)
            slip = plus(slip, scaled(w, load_row(ends.delta[node], 0)))
            slip = plus(slip, global_components(ends.delta[node], c))
        i, j = at.pairs[e]
        g, n, _, _ = contact_point(ends.end, at.a, at.b, i, j, at.kind)
        u, normal = plus(spring, slip), secant(anchors.gaps[q], g, g - anchors.gaps[q])
        out.gaps[e], out.by_gap[e] = normal.σ, 0.5 * normal.by_gap
        store_row(out.normals, e, n)
        store_row(out.stretches, e, u)
        store_row(out.springs, e, spring)
        store_row(out.slips, e, slip)
        if normal.σ < 0.0:
            τ = traction(law, normal.σ, n, u).τ
            store_row(out.τ, e, τ)
            size, most = np.sqrt(dot(τ, τ)), limit(law, max(-g, 0.0))
            store_row(out.held, e, τ if size <= most else scaled(most / size, τ))


@compiled
def add_over_step(
    ends: Ends,
    types: Indices,
    at: ContactPoints,
    arms: Anchors,
    τ: Array,
    out: Array,
    ground: Array,
) -> None:
    """Add tractions to nodal forces, as :func:`~.over_steps.add_secants` adds normal forces."""
    for e in range(at.pairs.shape[0]):
        t = scaled(at.weight[e], load_row(τ, e))
        if dot(t, t) == 0.0:
            continue
        force, moment = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        for s in range(SLOTS):
            node = arms.nodes[e, s]
            if node < 0:
                continue
            f = scaled(arms.weights[e, s], t)
            turning = cross(global_components(ends.mean[node], load_row(arms.arms[e], s)), t)
            vectors = types[node] >= POSITION_GRADIENT
            second = scaled(arms.arms[e, s, 0], t) if vectors else turning
            store(out[node], 0, plus(load(out[node], 0), f))
            store(out[node], 3, plus(load(out[node], 3), second))
            force = plus(force, f)
            moment = plus(moment, plus(turning, cross(load_row(ends.mean[node], 0), f)))
        i, j = at.pairs[e]
        if at.a.owners[i] == GROUND or at.b.owners[j] == GROUND:
            store(ground, 0, minus(load(ground, 0), force))
            store(ground, 3, minus(load(ground, 3), moment))


@uncounted
def energies(law: CoulombLaw, at: ContactPoints, over: Slips) -> tuple[float, float, float]:
    """Energy stored at the end, work done, and the dissipated part of it."""
    stored, before, work = 0.0, 0.0, 0.0
    for e in range(over.τ.shape[0]):
        held, spring, weight = load_row(over.held, e), load_row(over.springs, e), at.weight[e]
        stored += dot(held, held) * weight
        before += dot(spring, spring) * weight
        work += dot(load_row(over.τ, e), load_row(over.slips, e)) * weight
    stored, before = 0.5 / law.holding * stored, 0.5 * law.holding * before
    return stored, work, max(0.0, work - (stored - before))
