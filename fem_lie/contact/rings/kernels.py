"""Contact forces between a rope and its rings, and their derivatives; compiled.

With the coordinates ``q`` of nodes of any type, ``Δ = W q``, ``m = W'ᵀ Δ + Wᵀ P'`` and
``s = P'·P' + Δ·P''``, the position on the rope varies by ``δσ = −m·δq/s``, and ::

    force k Wᵀ Δ,   stiffness k (Wᵀ W − m mᵀ/s),   friction −τ m/s

Friction has neither resultant nor moment, since ``σ`` is constant in rigid motions.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined_uncounted, uncounted
from fem_lie.contact.laws.anchors import CoulombLaw, limit, returned
from fem_lie.contact.rings.curves import (
    Ropes,
    foot,
    position_between,
    ring,
    set_pair,
    store_position,
)
from fem_lie.forms.abilities import Ends
from fem_lie.lie.node_types.forces import (
    add_along_increments,
    pull_back,
    pull_back_derivative,
    push_forward,
)
from fem_lie.lie.tuples import (
    cross,
    dot,
    load,
    load_row,
    minus,
    plus,
    scaled,
    store,
)

PLACE, DISTANCE, TRACTION, SLIP, END = range(5)
"""Columns of what is found of each ring: where the force acts, ``|Δ|`` there, friction, by how much
the rope has slid over a step, and where it is at the end."""
COLUMNS = 5


@inlined_uncounted
def _traction(law: CoulombLaw, stretch: float, distance: float, s: float) -> float:
    """Friction force along the rope, of a spring with an elongation ``stretch``."""
    τ, _ = returned(law, abs(stretch), _most(law, distance, s))
    return τ if stretch >= 0.0 else -τ


@inlined_uncounted
def _most(law: CoulombLaw, distance: float, s: float) -> float:
    """Largest friction force."""
    return limit(law, distance) * np.sqrt(max(s, 0.0))


@compiled
def set_feet(H: Array, ropes: Ropes, kept: Array, out: Array) -> None:
    """Set the positions on the rope that are closest to rings, searched from ``kept``."""
    C = np.empty((4, 3))
    for k in range(out.shape[0]):
        out[k] = foot(H, ropes, kept[k], ring(H, ropes, k), C)


@compiled
def add_forces(
    H: Array,
    ropes: Ropes,
    law: CoulombLaw,
    kept: Array,
    springs: Array,
    grounded: bool,
    found: Array,
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
        found: Overwritten, shape (r, 5).
        out: Forces along the axes of nodes, updated.
    """
    C, _ = workspace = np.empty((4, 3)), np.empty((3, 3))
    G = np.empty(5, dtype=np.int64), np.empty((5, 4)), np.empty((5, 4))
    f, m = np.empty((4, 3)), np.zeros((5, 4, 3))
    for k in range(found.shape[0]):
        σ = foot(H, ropes, kept[k], ring(H, ropes, k), C)
        separation, s = set_pair(H, ropes, k, σ, G, workspace, m)
        distance = np.sqrt(dot(separation, separation))
        τ = _traction(law, springs[k] + σ - kept[k], distance, s)
        found[k, PLACE], found[k, DISTANCE], found[k, TRACTION] = σ, distance, τ
        found[k, SLIP], found[k, END] = σ - kept[k], σ
        if grounded and ropes.rings[k] >= 0:
            continue
        for a in range(5):
            node = G[0][a]
            if node < 0:
                continue
            for row in range(4):
                for j in range(3):
                    f[row, j] = law.k * G[1][a, row] * separation[j] - τ / s * m[a, row, j]
            pull_back(ropes.kinds[node], H[node], f, 1.0, out[node])


@compiled
def add_over_step(
    ends: Ends,
    ropes: Ropes,
    law: CoulombLaw,
    kept: Array,
    springs: Array,
    found: Array,
    out: Array,
    ground: Array,
) -> tuple[float, float]:
    """Add the forces of a step, as :meth:`~fem_lie.forms.term.Term.add_over_step` does.

    Arguments as for :func:`add_forces`; returns the energy at the end without that of friction, and
    the work by which it has changed.
    """
    C, at = workspace = np.empty((4, 3)), np.empty((3, 3))
    G = np.empty(5, dtype=np.int64), np.empty((5, 4)), np.empty((5, 4))
    f, m = np.empty((4, 3)), np.zeros((5, 4, 3))
    stored = work = 0.0
    for k in range(found.shape[0]):
        X0, X1 = ring(ends.start, ropes, k), ring(ends.end, ropes, k)
        σ0 = foot(ends.start, ropes, kept[k], X0, C)
        σ1 = foot(ends.end, ropes, σ0, X1, C)
        store_position(ends.start, ropes, σ0, C, at)
        before = minus(load_row(at, 0), X0)
        store_position(ends.end, ropes, σ1, C, at)
        after = minus(load_row(at, 0), X1)
        σ = position_between(ends.start, ends.end, ropes, (σ0, σ1, 0.0), (before, after), C)
        (separation, s), slip = set_pair(ends.mean, ropes, k, σ, G, workspace, m), 0.0
        for a in range(5):
            for row in range(4 if G[0][a] >= 0 else 0):
                slip -= dot(load_row(m[a], row), load_row(ends.delta[G[0][a]], row)) / s
        distance = np.sqrt(dot(separation, separation))
        τ = _traction(law, springs[k] + slip, distance, s)
        found[k, PLACE], found[k, DISTANCE], found[k, TRACTION] = σ, distance, τ
        found[k, SLIP], found[k, END] = slip, σ1
        stored += 0.5 * law.k * dot(after, after)
        work += 0.5 * law.k * (dot(after, after) - dot(before, before))
        force, moment = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        for a in range(5):
            node = G[0][a]
            if node < 0:
                continue
            for row in range(4):
                for j in range(3):
                    f[row, j] = law.k * G[1][a, row] * separation[j] - τ / s * m[a, row, j]
                force = plus(force, load_row(f, row) if row == 0 else (0.0, 0.0, 0.0))
                moment = plus(moment, cross(load_row(ends.mean[node], row), load_row(f, row)))
            add_along_increments(ropes.kinds[node], ends.mean[node], f, out[node])
        if ropes.rings[k] < 0:
            for j in range(3):
                ground[j] -= force[j]
                ground[3 + j] -= moment[j]
    return stored, work


@compiled
def tangents(
    H: Array,
    ropes: Ropes,
    law: CoulombLaw,
    found: Array,
    factor: float,
    windows: Indices,
    blocks: Array,
) -> None:
    """Add derivatives of the forces in twists to blocks.

    Args:
        H: Frames.
        ropes: The rope.
        law: Constants of the contact law.
        found: Variables of the forces, shape (r, 5).
        factor: Factor of friction that sticks: 1 at frames, 2 over a step.
        windows: First node along the rope of each ring's blocks, their number, and the index along
            the rope of each node; see :class:`~.forces.Window`.
        blocks: Updated, (r c², 6, 6) with ``c`` nodes of the rope and the ring.
    """
    workspace = np.empty((4, 3)), np.empty((3, 3))
    G = np.empty(5, dtype=np.int64), np.empty((5, 4)), np.empty((5, 4))
    m, F, rates = np.zeros((5, 4, 3)), np.empty((5, 4, 3)), np.empty((4, 3))
    A, g, unit, where = np.empty((5, 6, 3)), np.empty((5, 6)), np.empty(6), np.empty(5, np.int64)
    count = windows.shape[1]
    for k in range(found.shape[0]):
        σ, τ = found[k, PLACE], found[k, TRACTION]
        separation, s = set_pair(H, ropes, k, σ, G, workspace, m)
        slides = 0.0 if σ <= ropes.starts[0] or σ >= ropes.starts[-1] else 1.0
        distance = np.sqrt(dot(separation, separation))
        sticks = law.μ > 0.0 and abs(τ) < _most(law, distance, s)
        n = scaled(1.0 / distance if distance > 0.0 else 0.0, separation)
        rises = 0.0
        if law.μ > 0.0 and not sticks:
            rises = (1.0 if τ > 0.0 else -1.0) * _most(law, 1.0, s)
        for a in range(5):
            node = G[0][a]
            if node < 0:
                continue
            where[a] = _index_in(windows[k], node)
            for i in range(6):
                unit[:] = 0.0
                unit[i] = 1.0
                push_forward(ropes.kinds[node], H[node], unit, rates)
                total, along = (0.0, 0.0, 0.0), 0.0
                for row in range(4):
                    total = plus(total, scaled(G[1][a, row], load_row(rates, row)))
                    along += dot(load_row(m[a], row), load_row(rates, row))
                store(A[a, i], 0, total)
                g[a, i] = along
            for row in range(4):
                for j in range(3):
                    F[a, row, j] = law.k * G[1][a, row] * separation[j] - τ / s * m[a, row, j]
        for a in range(5):
            for b in range(5):
                if G[0][a] < 0 or G[0][b] < 0:
                    continue
                block = blocks[(k * count + where[a]) * count + where[b]]
                for i in range(6):
                    for j in range(6):
                        own = dot(load(A[a, i], 0), load(A[b, j], 0))
                        both = g[a, i] * g[b, j]
                        block[i, j] += law.k * (own - slides * both / s)
                        if sticks:
                            block[i, j] += factor * law.holding * both / (s * s)
                        elif rises != 0.0:
                            block[i, j] -= rises * g[a, i] / s * dot(n, load(A[b, j], 0))
            if G[0][a] >= 0:
                node = G[0][a]
                block = blocks[(k * count + where[a]) * count + where[a]]
                pull_back_derivative(ropes.kinds[node], H[node], F[a], 1.0, block)


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
    C, at = np.empty((4, 3)), np.empty((3, 3))
    for k in range(feet.shape[0]):
        store(X[k], 0, ring(H, ropes, k))
        store_position(H, ropes, feet[k], C, at)
        out[k] = at[0]
