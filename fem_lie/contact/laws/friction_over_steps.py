"""Friction forces of a step: their work is stored in springs or dissipated, never created.

Both anchors act at one point of the mean configuration, that of the first side: the moment arm of
the second is moved there, ``c ← c + w R̄⁻¹ ū``. Hence a traction has no moment, and does the work
``τ·s`` on the slip ``s = Σ w Δx + ΔR c`` of these two material points. With the spring elongation
``e`` at the start::

    τ = k T (e + s) of the gap and the normal at the end, limited by μ p;  e₁ = τ/k
    dissipation = τ·s − ½ k (e₁² − e²) ≥ ½ k |e₁ − e|²

because ``τ·(e + s) ≥ k e₁²`` whether or not the traction is limited.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined_uncounted
from fem_lie.contact.laws.anchors import Anchors, CoulombLaw, stretch_of, traction
from fem_lie.contact.sides.kinematics import SLOTS, contact_point
from fem_lie.contact.sides.surfaces import MOST_NODES
from fem_lie.contact.sides.table import GROUND, ContactPoints
from fem_lie.forms.abilities import Ends
from fem_lie.lie.motions import global_components
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

GAP, NORMAL, INACTIVE, SPRING = 0, slice(1, 4), slice(4, 7), slice(7, 10)
"""Columns of the values that :func:`set_over_step` sets for each pair; the last three are the
slip."""
COLUMNS = 13


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
    at: ContactPoints,
    anchors: Anchors,
    which: Indices,
    law: CoulombLaw,
    arms: Anchors,
    found: Array,
    τ: Array,
) -> None:
    """Moment arms at one point, variables of the traction, and the traction, for each pair.

    Args:
        ends: Both ends of the step.
        at: Contact points.
        anchors: Anchors at the start of the step.
        which: Index of the anchors of each pair, −1: none.
        law: Constants.
        arms: Overwritten for pairs with anchors; one for each pair.
        found: Overwritten, shape (m, 13).
        τ: Tractions on the second side, overwritten, shape (m, 3).
    """
    for e in range(at.pairs.shape[0]):
        found[e], τ[e], q = 0.0, 0.0, which[e]
        if q < 0:
            continue
        mean, spring, slip = stretch_of(ends.mean, anchors, q), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        i, j = at.pairs[e]
        # an open contact has no spring: round-off of its anchors would act as a force
        if contact_point(ends.start, at.a, at.b, i, j, at.kind).gap < 0.0:
            spring = stretch_of(ends.start, anchors, q)
        for s in range(SLOTS):
            node, w = anchors.nodes[q, s], anchors.weights[q, s]
            arms.nodes[e, s], arms.weights[e, s] = node, w
            if node < 0:
                continue
            c = load_row(anchors.arms[q], s)
            if s >= MOST_NODES:
                c = combined(1.0, c, w, _in_frame(ends.mean[node], mean))
            store_row(arms.arms[e], s, c)
            slip = plus(slip, scaled(w, load_row(ends.delta[node], 0)))
            slip = plus(slip, global_components(ends.delta[node], c))
        g, n, _, _ = contact_point(ends.end, at.a, at.b, i, j, at.kind)
        u = plus(spring, slip)
        found[e, 0] = g
        for k in range(3):
            found[e, 1 + k], found[e, 4 + k] = n[k], u[k]
            found[e, 7 + k], found[e, 10 + k] = spring[k], slip[k]
        if g < 0.0:
            store_row(τ, e, traction(law, g, n, u).τ)


@compiled
def add_over_step(
    ends: Ends, at: ContactPoints, arms: Anchors, τ: Array, out: Array, ground: Array
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
            store(out[node], 0, plus(load(out[node], 0), f))
            store(out[node], 3, plus(load(out[node], 3), turning))
            force = plus(force, f)
            moment = plus(moment, plus(turning, cross(load_row(ends.mean[node], 0), f)))
        i, j = at.pairs[e]
        if at.a.owners[i] == GROUND or at.b.owners[j] == GROUND:
            store(ground, 0, minus(load(ground, 0), force))
            store(ground, 3, minus(load(ground, 3), moment))


def energies(
    law: CoulombLaw, at: ContactPoints, found: Array, τ: Array
) -> tuple[float, float, float]:
    """Energy stored at the end, work done, and the dissipated part of it."""
    weight = at.weight[: len(τ)]
    stored = 0.5 / law.holding * float((τ * τ).sum(axis=1) @ weight)
    before = 0.5 * law.holding * float((found[:, SPRING] ** 2).sum(axis=1) @ weight)
    work = float((τ * found[:, 10:]).sum(axis=1) @ weight)
    return stored, work, max(0.0, work - (stored - before))


def workspace(m: int) -> tuple[Array, Array]:
    """Arrays for the variables and the tractions of ``m`` pairs."""
    return np.empty((m, COLUMNS)), np.empty((m, 3))
