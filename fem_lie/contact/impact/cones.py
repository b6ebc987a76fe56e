"""Coulomb's cones: ``u = q + B M⁻¹ B̄ᵀ r`` with ``K* ∋ u + μ|u_t| e_n ⊥ r ∈ K_μ`` at each contact.

That is De Saxcé's form of the exact law: what slides does not lift. Sweeps over the contacts take
the exact solution of each, the others as they are (Jean & Moreau 1992); between them Newton's
method on the function of Alart & Curnier, CMAME 92 (1991) 353, for few contacts. Components are
along the normal, then along two tangents.

Velocities of bodies change by ``W = M⁻¹ B̄ᵀ r``; nothing but that is summed up, so that a sweep
costs the same per contact however many there are.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined, linked
from fem_lie.contact.impact.one_contact import projected, single

MOST_NEWTON = 60
"""Contacts for which there is a dense matrix."""

_FIRST, _LATER, _ROUNDS, _ITERATIONS = 3, 10, 4, 10
"""Sweeps at first, sweeps of the first round after that, rounds, and Newton's iterations in one."""

_MANY = 1e-6
"""Residual with which more contacts than those are content."""

_GROWTH = 1e2
"""Newton's forces over those of the sweeps: wedged bodies have internal forces of any size."""


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
    """

    bodies: Indices
    rows: Array
    pushes: Array
    own: Array
    q: Array
    friction: Array
    r: Array
    W: Array


@inlined
def along(rows: Array, bodies: Indices, v: Array, k: int) -> float:
    """``B v`` of a component of one contact, shapes (2, 3, 6), (2,)."""
    total = 0.0
    for side in range(2):
        body = bodies[side]
        if body >= 0:
            for at in range(6):
                total += rows[side, k, at] * v[body, at]
    return total


@inlined
def push(pushes: Array, bodies: Indices, k: int, impulse: float, v: Array) -> None:
    """Add what an impulse along a component does to velocities."""
    for side in range(2):
        body = bodies[side]
        if body >= 0:
            for at in range(6):
                v[body, at] += impulse * pushes[side, k, at]


@compiled
def begin(problem: Cones, k: int) -> None:
    """Find the products at single contacts, and what the impulses do that it starts with."""
    bodies, rows, pushes, own, r, W = (
        problem.bodies,
        problem.rows,
        problem.pushes,
        problem.own,
        problem.r,
        problem.W,
    )
    W[:] = 0.0
    for c in range(k):
        for i in range(3):
            for j in range(3):
                total = 0.0
                for side in range(2):
                    if bodies[c, side] >= 0:
                        for at in range(6):
                            total += rows[c, side, i, at] * pushes[c, side, j, at]
                own[c, i, j] = total
            push(pushes[c], bodies[c], i, r[c, i], W)


@compiled
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


@compiled
def residual(problem: Cones, k: int) -> float:
    """``|r − P_K(r − ρ û)|`` over the largest impulse, with ``ρ`` by the trace of each contact."""
    worst, size = 0.0, np.finfo(np.float64).tiny
    q, r = problem.q, problem.r
    for c in range(k):
        A, mu = problem.own[c], problem.friction[c]
        rho = 3.0 / (A[0, 0] + A[1, 1] + A[2, 2])
        u0 = q[c, 0] + along(problem.rows[c], problem.bodies[c], problem.W, 0)
        u1 = q[c, 1] + along(problem.rows[c], problem.bodies[c], problem.W, 1)
        u2 = q[c, 2] + along(problem.rows[c], problem.bodies[c], problem.W, 2)
        lifted = u0 + mu * np.sqrt(u1 * u1 + u2 * u2)
        p = projected((r[c, 0] - rho * lifted, r[c, 1] - rho * u1, r[c, 2] - rho * u2), mu)
        for i in range(3):
            off = abs(r[c, i] - p[i])
            if not off <= worst:
                worst = off if off == off else np.inf
        size = max(size, abs(r[c, 0]), rho * abs(q[c, 0]))
    return float(worst / size)


@compiled
def _dense(problem: Cones, k: int) -> Array:
    """``B M⁻¹ B̄ᵀ``, shape (3 k, 3 k)."""
    found = np.zeros((3 * k, 3 * k))
    for c in range(k):
        for d in range(k):
            for s in range(2):
                for t in range(2):
                    body = problem.bodies[c, s]
                    if body < 0 or body != problem.bodies[d, t]:
                        continue
                    for i in range(3):
                        for j in range(3):
                            total = 0.0
                            for at in range(6):
                                total += problem.rows[c, s, i, at] * problem.pushes[d, t, j, at]
                            found[3 * c + i, 3 * d + j] += total
    return found


@compiled
def _alart_curnier(
    A: Array, q: Array, friction: Array, r: Array, F: Array, J: Array, derive: bool
) -> float:
    """The function ``F``, whose zeros are solutions, and its derivative; returns ``F·F``."""
    u = A @ r + q
    for c in range(len(r) // 3):
        a = 3 * c
        rn, rt = 1.0 / A[a, a], 2.0 / (A[a + 1, a + 1] + A[a + 2, a + 2])
        z = r[a] - rn * u[a]
        z1, z2 = r[a + 1] - rt * u[a + 1], r[a + 2] - rt * u[a + 2]
        if derive:
            J[a : a + 3] = 0.0
        if z <= 0.0:
            F[a], F[a + 1], F[a + 2] = r[a], r[a + 1], r[a + 2]
            if derive:
                J[a, a], J[a + 1, a + 1], J[a + 2, a + 2] = 1.0, 1.0, 1.0
            continue
        F[a] = rn * u[a]
        radius, t = friction[c] * z, np.sqrt(z1 * z1 + z2 * z2)
        if derive:
            J[a] = rn * A[a]
        if t <= radius:
            F[a + 1], F[a + 2] = rt * u[a + 1], rt * u[a + 2]
            if derive:
                J[a + 1], J[a + 2] = rt * A[a + 1], rt * A[a + 2]
            continue
        x, y, part = z1 / t, z2 / t, radius / t
        F[a + 1], F[a + 2] = r[a + 1] - radius * x, r[a + 2] - radius * y
        if derive:
            # δ(radius e) = μ e δz + part (I − e eᵀ) δz_t
            m11, m12, m22 = part * (1 - x * x), -part * x * y, part * (1 - y * y)
            for j in range(len(r)):
                dz, d1, d2 = -rn * A[a, j], -rt * A[a + 1, j], -rt * A[a + 2, j]
                dz += 1.0 if j == a else 0.0
                d1 += 1.0 if j == a + 1 else 0.0
                d2 += 1.0 if j == a + 2 else 0.0
                J[a + 1, j] = -(friction[c] * x * dz + m11 * d1 + m12 * d2)
                J[a + 2, j] = -(friction[c] * y * dz + m12 * d1 + m22 * d2)
            J[a + 1, a + 1] += 1.0
            J[a + 2, a + 2] += 1.0
    return float(F @ F)


@compiled
def _newton(problem: Cones, k: int, tolerance: float) -> int:
    """Newton's method with steps that are halved; returns the iterations."""
    A, q, r = _dense(problem, k), problem.q[:k].copy().ravel(), problem.r[:k].copy().ravel()
    F, tried, J = np.empty(3 * k), np.empty(3 * k), np.empty((3 * k, 3 * k))
    friction = problem.friction[:k]
    for iteration in range(1, _ITERATIONS + 1):
        square = _alart_curnier(A, q, friction, r, F, J, True)
        for i in range(3 * k):
            J[i, i] += 1e-8  # of redundant contacts
        d = np.linalg.solve(J, F)
        size, best, least = 1.0, 1.0, np.inf
        for _ in range(12):
            now = _alart_curnier(A, q, friction, r - size * d, tried, J, False)
            if now < least:
                least, best = now, size
            if now < (1.0 - 1e-4 * size) * square:
                break
            size *= 0.5
        r -= best * d
        problem.r[:k] = r.reshape(k, 3)
        begin(problem, k)
        if residual(problem, k) <= tolerance:
            return iteration
    return _ITERATIONS


@linked
def _with_newton(problem: Cones, k: int, tolerance: float, reached: float) -> tuple[int, float]:
    """Iterations and residual; impulses stay as they are if Newton's are no better."""
    kept, size = problem.r[:k].copy(), np.abs(problem.r[:k]).max()
    iterations = _newton(problem, k, tolerance)
    found = residual(problem, k)
    if not found < reached or np.abs(problem.r[:k]).max() > _GROWTH * size:
        problem.r[:k] = kept
        begin(problem, k)
        found = reached
    return iterations, found


@linked
def solve(problem: Cones, k: int, tolerance: float) -> tuple[int, int, float]:
    """Solve for the impulses of the first ``k`` contacts, from those that are there.

    Args:
        problem: Updated.
        k: How many contacts.
        tolerance: Of :func:`residual`.

    Returns:
        Sweeps, iterations of Newton's method, and what :func:`residual` is left.
    """
    begin(problem, k)
    tolerance = tolerance if k <= MOST_NEWTON else max(tolerance, _MANY)
    sweeps, iterations, reached, limit = 0, 0, np.inf, _FIRST
    for rounds in range(_ROUNDS + 1):
        for _ in range(limit):
            sweep(problem, k)
            sweeps += 1
            reached = residual(problem, k)
            if reached <= tolerance:
                return sweeps, iterations, reached
        if rounds < _ROUNDS and k <= MOST_NEWTON:
            more, reached = _with_newton(problem, k, tolerance, reached)
            iterations += more
            if reached <= tolerance:
                break
        limit = _LATER * 3**rounds
    return sweeps, iterations, reached
