"""Contact forces between a rope and its rings, and their derivatives; compiled.

The energy of a ring is ``½ k Δ·Δ`` with ``Δ = X − P(σ)`` at the closest point of the rope. With the
derivatives of :mod:`fem_lie.contact.laws.derivatives` in the motions of nodes, ``D = ∂Δ/∂h`` and
``∂σ/∂h = m/s``::

    force k Dᵀ Δ + τ m/s,  stiffness k ∂²(½ Δ·Δ)/∂h²,  m = Dᵀ P' + (∂P'/∂h)ᵀ Δ

Friction ``τ`` has neither resultant nor moment, since ``σ`` is constant in rigid motions. It is
constant in ``m/s`` where forces are differentiated.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined_uncounted, uncounted
from fem_lie.contact.laws.anchors import CoulombLaw, limit, returned
from fem_lie.contact.laws.derivatives import add_turning, derivatives, set_derivatives
from fem_lie.contact.laws.over_steps import add_force
from fem_lie.contact.rings.curves import (
    RingPoint,
    Ropes,
    foot,
    position_at,
    position_between,
    ring_point,
    set_position,
    set_ring,
)
from fem_lie.contact.sides.kinematics import (
    SLOTS,
    add_to_nodes,
    contact_point,
    displacement,
    position,
    slot,
)
from fem_lie.contact.sides.surfaces import MOST_NODES
from fem_lie.contact.sides.table import UNUSED
from fem_lie.forms.abilities import Ends
from fem_lie.lie.tuples import Vector, combined, dot, load_row, minus, scaled, store_row


class Held(NamedTuple):
    """How rings hold the rope, at frames or over a step; each of shape (r,).

    Attributes:
        positions: Position on the rope at which the force acts.
        distances: ``|Δ|`` there.
        tractions: Friction ``τ``.
        slips: How far the rope has slid since the last accepted frames.
        ends: Position on the rope of the closest point; at the end of a step.
    """

    positions: Array
    distances: Array
    tractions: Array
    slips: Array
    ends: Array


def held(count: int) -> Held:
    """Space for some rings."""
    return Held(*np.zeros((len(Held._fields), count)))


@inlined_uncounted
def _largest(law: CoulombLaw, distance: float, s: float) -> float:
    """Largest friction force."""
    return limit(law, distance) * np.sqrt(max(s, 0.0))


@inlined_uncounted
def _traction(law: CoulombLaw, stretch: float, distance: float, s: float) -> float:
    """Friction force along the rope, of a spring with an elongation ``stretch``."""
    τ, _ = returned(law, abs(stretch), _largest(law, distance, s))
    return τ if stretch >= 0.0 else -τ


@compiled
def set_feet(H: Array, ropes: Ropes, kept: Array, out: Array) -> None:
    """Set the positions on the rope that are closest to rings, searched from ``kept``."""
    points = ring_point()
    for k in range(out.shape[0]):
        set_ring(ropes, k, points)
        out[k] = foot(H, ropes, kept[k], position(H, points.at.a, 0), points.C)


@compiled
def set_friction(H: Array, ropes: Ropes, feet: Array, tractions: Array, out: Array) -> None:
    """Set the friction forces ``τ P'/s`` on the rope at positions ``feet``, shape (r, 3)."""
    points = ring_point()
    for k in range(feet.shape[0]):
        set_ring(ropes, k, points)
        s = set_position(H, ropes, feet[k], points)
        t = load_row(points.at.sliding.slopes[0], 0)
        store_row(out, k, scaled(tractions[k] / s, t))


@inlined_uncounted
def _forces_of(
    law: CoulombLaw, points: RingPoint, separation: Vector, s: float, τ: float
) -> tuple[Vector, Vector]:
    """Forces on the ring and on ``P'``: ``k Δ + τ P'/s`` and ``τ Δ/s``; the rope has the first."""
    t = load_row(points.at.sliding.slopes[0], 0)
    return combined(law.normal.k, separation, τ / s, t), scaled(τ / s, separation)


@compiled
def add_forces(
    H: Array,
    ropes: Ropes,
    law: CoulombLaw,
    kept: Array,
    springs: Array,
    grounded: bool,
    found: Held,
    out: Array,
) -> None:
    """Add the forces at frames, of all rings or of those on ground.

    Args:
        H: Frames.
        ropes: The rope.
        law: Constants of the contact law.
        kept: Positions at the last accepted frames, shape (r,).
        springs: Elongations of the friction springs at these frames, shape (r,).
        grounded: Whether only rings on ground count.
        found: Overwritten.
        out: Forces along the axes of nodes, updated.
    """
    points, types = ring_point(), ropes.types
    at = points.at
    for k in range(kept.shape[0]):
        set_ring(ropes, k, points)
        X = position(H, at.a, 0)
        σ = foot(H, ropes, kept[k], X, points.C)
        s = set_position(H, ropes, σ, points)
        separation = minus(X, position(H, at.b, 0))
        distance, slip = np.sqrt(dot(separation, separation)), σ - kept[k]
        τ = _traction(law, springs[k] + slip, distance, s)
        found.positions[k], found.distances[k], found.tractions[k] = σ, distance, τ
        found.slips[k], found.ends[k] = slip, σ
        if grounded and ropes.rings[k] >= 0:
            continue
        F, along = _forces_of(law, points, separation, s, τ)
        add_to_nodes(H, types, at.a, 0, F, out)
        add_to_nodes(H, types, at.b, 0, scaled(-1.0, F), out)
        add_to_nodes(H, types, points.along, 0, along, out)


@compiled
def add_over_step(
    ends: Ends,
    ropes: Ropes,
    law: CoulombLaw,
    kept: Array,
    springs: Array,
    found: Held,
    out: Array,
    ground: Array,
) -> tuple[float, float]:
    """Add the forces of a step; return the energy of the rings at its end, and its change.

    Args:
        ends: Both ends of the step.
        ropes: The rope.
        law: Constants of the contact law.
        kept: Positions at the start, shape (r,).
        springs: Elongations of the friction springs there, shape (r,).
        found: Overwritten.
        out: Generalised forces along increments of the mean coordinates, updated.
        ground: Force and moment about the origin on ground, updated.
    """
    points, types, stored, work = ring_point(), ropes.types, 0.0, 0.0
    at, C = points.at, points.C
    for k in range(kept.shape[0]):
        set_ring(ropes, k, points)
        X0, X1 = position(ends.start, at.a, 0), position(ends.end, at.a, 0)
        σ0 = foot(ends.start, ropes, kept[k], X0, C)
        before = minus(position_at(ends.start, ropes, σ0, C), X0)
        σ1 = foot(ends.end, ropes, σ0, X1, C)
        after = minus(position_at(ends.end, ropes, σ1, C), X1)
        σ = position_between(ends.start, ends.end, ropes, (σ0, σ1, 0.0), (before, after), C)
        s = set_position(ends.mean, ropes, σ, points)
        separation = minus(position(ends.mean, at.a, 0), position(ends.mean, at.b, 0))
        moved = minus(displacement(ends.delta, at.a, 0), displacement(ends.delta, at.b, 0))
        bent = dot(separation, displacement(ends.delta, points.along, 0))
        slip = (dot(load_row(at.sliding.slopes[0], 0), moved) + bent) / s
        distance = np.sqrt(dot(separation, separation))
        τ = _traction(law, springs[k] + slip, distance, s)
        found.positions[k], found.distances[k], found.tractions[k] = σ, distance, τ
        found.slips[k], found.ends[k] = slip, σ1
        stored += 0.5 * law.normal.k * dot(after, after)
        work += 0.5 * law.normal.k * (dot(after, after) - dot(before, before))
        F, along = _forces_of(law, points, separation, s, τ)
        at_point = False, F
        add_force(ends.mean, types, at.a, 0, at_point, F, out, ground)
        add_force(ends.mean, types, at.b, 0, at_point, scaled(-1.0, F), out, ground)
        add_force(ends.mean, types, points.along, 0, at_point, along, out, ground)
    return stored, work


@compiled
def tangents(
    H: Array,
    ropes: Ropes,
    law: CoulombLaw,
    found: Held,
    factor: float,
    windows: Indices,
    blocks: Array,
) -> None:
    """Add derivatives of the forces in twists to blocks.

    Args:
        H: Frames.
        ropes: The rope.
        law: Constants of the contact law.
        found: Variables of the forces.
        factor: Factor of friction that sticks: 1 at frames, 2 over a step.
        windows: Nodes of the blocks of each ring, shape (r, c).
        blocks: Updated, (r c², 6, 6).
    """
    points, by, types = ring_point(), derivatives(), ropes.types
    at, where = points.at, np.empty(SLOTS, dtype=np.int64)
    for k in range(windows.shape[0]):
        set_ring(ropes, k, points)
        s, τ = set_position(H, ropes, found.positions[k], points), found.tractions[k]
        point = contact_point(H, at.a, at.b, 0, 0, at.kind)
        distance = set_derivatives(H, types, at, 0, point, by)
        m, rows = by.slides[0], by.rows
        sticks = law.μ > 0.0 and abs(τ) < _largest(law, distance, s)
        rises = 0.0
        if law.μ > 0.0 and not sticks and distance > 0.0:
            rises = (1.0 if τ > 0.0 else -1.0) * _largest(law, 1.0, s)
        for a in range(SLOTS):
            where[a] = _index_in(windows[k], by.nodes[a])
        count = windows.shape[1]
        for a in range(SLOTS):
            for b in range(SLOTS):
                if by.nodes[a] < 0 or by.nodes[b] < 0:
                    continue
                block = blocks[(k * count + where[a]) * count + where[b]]
                for i in range(6):
                    for j in range(6):
                        # that of ½ Δ·Δ, which exists where both points coincide
                        bent = by.G[a, b, i, j] + rows[a, i] * rows[b, j]
                        block[i, j] += law.normal.k * bent
                        if sticks:
                            block[i, j] += factor * law.holding * m[a, i] * m[b, j] / (s * s)
                        elif rises != 0.0:
                            block[i, j] += rises * m[a, i] / s * rows[b, j]
        F, along = _forces_of(law, points, minus(point.first, point.second), s, τ)
        for a in range(SLOTS):
            node, sign, w, c = slot(H, at.a, at.b, 0, 0, at.kind, point, a)
            if node >= 0:
                block = blocks[(k * count + where[a]) * count + where[a]]
                add_turning(types[node], H[node], scaled(sign, F), w, c, block)
        for a in range(MOST_NODES):
            node = points.along.nodes[0, a]
            if node == UNUSED:
                break
            at_node = where[MOST_NODES + a]
            block = blocks[(k * count + at_node) * count + at_node]
            w, c = points.along.weights[0, a], load_row(points.along.arms[0], a)
            add_turning(types[node], H[node], along, w, c, block)


@uncounted
def _index_in(window: Indices, node: int) -> int:
    """Index of a node in a window."""
    for c in range(window.shape[0]):
        if window[c] == node:
            return c
    return 0


@compiled
def set_positions(H: Array, ropes: Ropes, feet: Array, X: Array, out: Array) -> None:
    """Positions of rings, and of the rope there, (r, 3) each; overwritten."""
    points = ring_point()
    for k in range(feet.shape[0]):
        set_ring(ropes, k, points)
        store_row(X, k, position(H, points.at.a, 0))
        store_row(out, k, position_at(H, ropes, feet[k], points.C))
