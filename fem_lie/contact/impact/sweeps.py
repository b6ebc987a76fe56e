"""Sweeps over the contacts of a problem, and how far from Coulomb's law it is."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined_uncounted, uncounted
from fem_lie.contact.impact.one_contact import projected, single
from fem_lie.lie.tuples import Vector

MOST_NEWTON = 60
"""Contacts for which there is room for a dense matrix."""


class Dense(NamedTuple):
    """Room of Newton's method, N = 3 MOST_NEWTON or less.

    Attributes:
        A: ``B M⁻¹ B̄ᵀ``, shape (N, N).
        J: Of the derivative, likewise.
        r: Impulses, shape (N,).
        kept: Those before, likewise.
        tried: Those of a part of a step, likewise.
        u: Velocities, likewise.
        F: Of which zeros are wanted, likewise.
        d: A step, likewise.
    """

    A: Array
    J: Array
    r: Array
    kept: Array
    tried: Array
    u: Array
    F: Array
    d: Array


def dense_of(m: int) -> Dense:
    """For at most ``m`` contacts."""
    n = 3 * min(m, MOST_NEWTON)
    return Dense(np.zeros((n, n)), np.zeros((n, n)), *(np.zeros(n) for _ in range(6)))


_TINY = 1e-6
"""Part of speeds: round-off of these is 1e-10 of what changes them so."""

PAST = 10
"""Sweeps that are known of many contacts."""


class Past(NamedTuple):
    """What sweeps of more contacts than those did, M of them, or room for none.

    Attributes:
        start: Impulses before the last one, shape (M, 3).
        end: And after it, likewise.
        did: What it did, likewise.
        turned: Changes of velocities after it, shape (n, 6).
        steps: By what the ends of sweeps differ, shape (:data:`PAST`, M, 3).
        changes: By what differs what they did, likewise.
        turns: By what velocities differ, shape (:data:`PAST`, n, 6).
        products: Of ``changes``, shape (:data:`PAST`, :data:`PAST`).
        room: Likewise.
        parts: Shape (:data:`PAST`,).
    """

    start: Array
    end: Array
    did: Array
    turned: Array
    steps: Array
    changes: Array
    turns: Array
    products: Array
    room: Array
    parts: Array


def past_of(m: int, n: int) -> Past:
    """For at most ``m`` contacts of ``n`` bodies."""
    M, z = m if m > MOST_NEWTON else 0, np.zeros
    return Past(
        start=z((M, 3)),
        end=z((M, 3)),
        did=z((M, 3)),
        turned=z((n, 6)),
        steps=z((PAST, M, 3)),
        changes=z((PAST, M, 3)),
        turns=z((PAST, n, 6)),
        products=z((PAST, PAST)),
        room=z((PAST, PAST)),
        parts=z(PAST),
    )


class Cones(NamedTuple):
    """The first k of these are a problem.

    Attributes:
        bodies: On both sides, negative for ground, shape (·, 2).
        rows: ``B`` of both bodies, shape (·, 2, 3, 6).
        pushes: Rows of ``M⁻¹ B̄ᵀ``: what unit impulses do, likewise.
        own: Their products at one contact, shape (·, 3, 3).
        q: Shape (·, 3).
        friction: μ, shape (·,).
        r: Impulses; start and solution, shape (·, 3).
        W: Change of the bodies' velocities, shape (n, 6).
        dense: Room.
        past: Room of many.
        speed: The largest of any place without impulses, shape (1,).
    """

    bodies: Indices
    rows: Array
    pushes: Array
    own: Array
    q: Array
    friction: Array
    r: Array
    W: Array
    dense: Dense
    past: Past
    speed: Array


@inlined_uncounted
def along(rows: Array, bodies: Indices, v: Array, k: int) -> float:
    """``B v`` of a component of one contact, shapes (2, 3, 6), (2,)."""
    total = 0.0
    for side in range(2):
        body = bodies[side]
        if body >= 0:
            for at in range(6):
                total += rows[side, k, at] * v[body, at]
    return total


@inlined_uncounted
def push(pushes: Array, bodies: Indices, k: int, impulse: float, v: Array) -> None:
    """Add what an impulse along a component does to velocities."""
    for side in range(2):
        body = bodies[side]
        if body >= 0:
            for at in range(6):
                v[body, at] += impulse * pushes[side, k, at]


@uncounted
def begin(problem: Cones, k: int) -> None:
    """Find the products at single contacts, and what the impulses do that it starts with."""
    bodies, rows, pushes, own = problem.bodies, problem.rows, problem.pushes, problem.own
    for c in range(k):
        for i in range(3):
            for j in range(3):
                total = 0.0
                for side in range(2):
                    if bodies[c, side] >= 0:
                        for at in range(6):
                            total += rows[c, side, i, at] * pushes[c, side, j, at]
                own[c, i, j] = total
    change(problem, k)


@uncounted
def change(problem: Cones, k: int) -> None:
    """Find what the impulses do to the velocities."""
    problem.W[:] = 0.0
    for c in range(k):
        for i in range(3):
            push(problem.pushes[c], problem.bodies[c], i, problem.r[c, i], problem.W)


@uncounted
def sweep(problem: Cones, k: int) -> None:
    """Solve one contact after the other."""
    bodies, rows, pushes, own = problem.bodies, problem.rows, problem.pushes, problem.own
    q, r, W = problem.q, problem.r, problem.W
    for c in range(k):
        r0, r1, r2, A = r[c, 0], r[c, 1], r[c, 2], own[c]
        b = (
            q[c, 0] + along(rows[c], bodies[c], W, 0) - A[0, 0] * r0 - A[0, 1] * r1 - A[0, 2] * r2,
            q[c, 1] + along(rows[c], bodies[c], W, 1) - A[1, 0] * r0 - A[1, 1] * r1 - A[1, 2] * r2,
            q[c, 2] + along(rows[c], bodies[c], W, 2) - A[2, 0] * r0 - A[2, 1] * r1 - A[2, 2] * r2,
        )
        x = single(A, b, problem.friction[c], (r0, r1, r2))
        for i in range(3):
            if x[i] != r[c, i]:
                push(pushes[c], bodies[c], i, x[i] - r[c, i], W)
                r[c, i] = x[i]


@inlined_uncounted
def off_cone(u: Vector, own: Array, mu: float, r: Array) -> tuple[float, float]:
    """The largest part of ``|r − P_K(r − ρ û)|`` of one contact, and its ``ρ`` by the trace.

    Args:
        u: Velocity with all impulses.
        own: Product of its rows, shape (3, 3).
        mu: Coefficient of friction.
        r: Its impulse, shape (3,).
    """
    rho = 3.0 / (own[0, 0] + own[1, 1] + own[2, 2])
    lifted = u[0] + mu * np.sqrt(u[1] * u[1] + u[2] * u[2])
    p = projected((r[0] - rho * lifted, r[1] - rho * u[1], r[2] - rho * u[2]), mu)
    worst = 0.0
    for i in range(3):
        off = abs(r[i] - p[i])
        if not off <= worst:
            worst = off if off == off else np.inf
    return worst, rho


@uncounted
def residual(problem: Cones, k: int) -> float:
    """What :func:`off_cone` has over the largest impulse.

    What changes speeds by a part of :data:`_TINY` is known no better than to round-off.
    """
    worst, size, least = 0.0, np.finfo(np.float64).tiny, _TINY * problem.speed[0]
    q, r = problem.q, problem.r
    for c in range(k):
        u = (
            q[c, 0] + along(problem.rows[c], problem.bodies[c], problem.W, 0),
            q[c, 1] + along(problem.rows[c], problem.bodies[c], problem.W, 1),
            q[c, 2] + along(problem.rows[c], problem.bodies[c], problem.W, 2),
        )
        off, rho = off_cone(u, problem.own[c], problem.friction[c], r[c])
        worst = max(worst, off)
        size = max(size, abs(r[c, 0]), rho * max(abs(q[c, 0]), least))
    return float(worst / size)
