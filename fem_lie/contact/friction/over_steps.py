"""Friction of penalties over a step: what springs do not store is lost, never less than nothing.

Both anchors push at one place of the mean configuration, that of the first side's: the second lever
is moved there, ``c ← c + w R̄⁻¹ ū``. So a traction has no moment, and does the work ``τ·s`` on the
slip ``s = Σ w Δx + ΔR c`` of these two material places. With the spring ``e`` of the start::

    τ = k T (e + s) of the gap and the normal at the end, limited by μ p;  e₁ = τ/k
    lost = τ·s − ½ k (e₁² − e²) ≥ ½ k |e₁ − e|²

for ``τ·(e + s) ≥ k e₁²``, whatever is cut off.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined_uncounted
from fem_lie.contact.friction.anchors import Anchors, CoulombLaw, stretch_of, traction
from fem_lie.contact.sides.gauss_points import Meeting
from fem_lie.contact.sides.kinematics import SLOTS, gap
from fem_lie.contact.sides.surfaces import MOST_NODES
from fem_lie.contact.sides.table import GROUND
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

GAP, NORMAL, APART, SPRING = 0, slice(1, 4), slice(4, 7), slice(7, 10)
"""Columns of what :func:`set_over_step` finds of each pair; then the slip."""
COLUMNS = 13


@inlined_uncounted
def _in_frame(H: Array, a: Vector) -> Vector:
    """Components of ``a`` along the rows of a frame that need be neither long nor square."""
    d, e, f = load_row(H, 1), load_row(H, 2), load_row(H, 3)
    volume = dot(d, cross(e, f))
    along = dot(cross(e, f), a), dot(cross(f, d), a), dot(cross(d, e), a)
    return scaled(1.0 / volume, along)


@compiled
def set_over_step(
    ends: Ends,
    at: Meeting,
    anchors: Anchors,
    which: Indices,
    law: CoulombLaw,
    levers: Anchors,
    found: Array,
    τ: Array,
) -> None:
    """Anchors in one place, what a traction depends on, and the traction, of each pair.

    Args:
        ends: Of the step.
        at: Where sides meet.
        anchors: Of the start.
        which: Of these each pair has, −1: none.
        law: Numbers.
        levers: Overwritten where there is an anchor; one for each pair.
        found: Overwritten, shape (m, 13).
        τ: Tractions on the second side, overwritten, shape (m, 3).
    """
    for e in range(at.pairs.shape[0]):
        found[e], τ[e], q = 0.0, 0.0, which[e]
        if q < 0:
            continue
        mean, spring, slip = stretch_of(ends.mean, anchors, q), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        i, j = at.pairs[e]
        # what is apart holds no spring: round-off of its anchors would count as a push
        if gap(ends.start, at.a, at.b, i, j, at.flat)[0] < 0.0:
            spring = stretch_of(ends.start, anchors, q)
        for s in range(SLOTS):
            node, w = anchors.nodes[q, s], anchors.weights[q, s]
            levers.nodes[e, s], levers.weights[e, s] = node, w
            if node < 0:
                continue
            c = load_row(anchors.levers[q], s)
            if s >= MOST_NODES:
                c = combined(1.0, c, w, _in_frame(ends.mean[node], mean))
            store_row(levers.levers[e], s, c)
            slip = plus(slip, scaled(w, load_row(ends.delta[node], 0)))
            slip = plus(slip, global_components(ends.delta[node], c))
        g, n, _ = gap(ends.end, at.a, at.b, i, j, at.flat)
        u = plus(spring, slip)
        found[e, 0] = g
        for k in range(3):
            found[e, 1 + k], found[e, 4 + k] = n[k], u[k]
            found[e, 7 + k], found[e, 10 + k] = spring[k], slip[k]
        if g < 0.0:
            store_row(τ, e, traction(law, g, n, u).τ)


@compiled
def add_over_step(
    ends: Ends, at: Meeting, levers: Anchors, τ: Array, out: Array, ground: Array
) -> None:
    """Add tractions as :func:`~.over_steps.add_secants` adds forces."""
    for e in range(at.pairs.shape[0]):
        t = scaled(at.weight[e], load_row(τ, e))
        if dot(t, t) == 0.0:
            continue
        force, moment = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        for s in range(SLOTS):
            node = levers.nodes[e, s]
            if node < 0:
                continue
            f = scaled(levers.weights[e, s], t)
            turning = cross(global_components(ends.mean[node], load_row(levers.levers[e], s)), t)
            store(out[node], 0, plus(load(out[node], 0), f))
            store(out[node], 3, plus(load(out[node], 3), turning))
            force = plus(force, f)
            moment = plus(moment, plus(turning, cross(load_row(ends.mean[node], 0), f)))
        i, j = at.pairs[e]
        if at.a.owners[i] == GROUND or at.b.owners[j] == GROUND:
            store(ground, 0, minus(load(ground, 0), force))
            store(ground, 3, minus(load(ground, 3), moment))


def energies(law: CoulombLaw, at: Meeting, found: Array, τ: Array) -> tuple[float, float, float]:
    """Stored at the end, work done, and what of it is lost."""
    weight = at.weight[: len(τ)]
    stored = 0.5 / law.holding * float((τ * τ).sum(axis=1) @ weight)
    before = 0.5 * law.holding * float((found[:, SPRING] ** 2).sum(axis=1) @ weight)
    work = float((τ * found[:, 10:]).sum(axis=1) @ weight)
    return stored, work, max(0.0, work - (stored - before))


def room(m: int) -> tuple[Array, Array]:
    """For what is found and for tractions of ``m`` pairs."""
    return np.empty((m, COLUMNS)), np.empty((m, 3))
