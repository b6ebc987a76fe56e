"""Coulomb's cones of contacts that joints and elements couple: one dense matrix.

The law and the way to solve it are those of :mod:`fem_lie.contact.impact.cones`: sweeps with the
exact solution of each contact, and Newton's method on the function of Alart & Curnier between them.
There velocities of bodies are summed up; here all contacts see each other through joints and
elements, by a matrix ``A = B S⁻¹ B̄ᵀ``.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import uncounted
from fem_lie.contact.impact.newton import begin_newton, step_of_newton
from fem_lie.contact.impact.one_contact import single
from fem_lie.contact.impact.sweeps import Cones, Dense, off_cone, past_of

_FIRST, _LATER, _ROUNDS = 3, 20, 5
"""Sweeps at first, sweeps of the first round after that, and rounds."""

_ITERATIONS = 15
"""Of Newton's method, at most."""

_MOST_NEWTON = 100
"""Contacts with which Newton's method costs no more than sweeps."""

_YIELD = 1e-10
"""What contacts yield, of their own part of the matrix: some push along what joints hold."""


def cones_of(A: Array, friction: Array) -> Cones:
    """A problem with room; ``q`` and ``r`` are zero.

    Args:
        A: What impulses do along contacts, shape (3 k, 3 k); taken over.
        friction: μ, shape (k,).
    """
    k, n, z = len(friction), len(A), np.zeros
    own = np.stack([A[3 * c : 3 * c + 3, 3 * c : 3 * c + 3] for c in range(k)])
    traces = np.abs(np.trace(own, axis1=1, axis2=2))
    soft = np.repeat(_YIELD * np.maximum(traces, 1e-6 * traces.max(initial=0.0)), 3)
    A = A + np.diag(soft)
    own += soft.reshape(k, 3, 1) * np.eye(3)
    room = Dense(A, z((n, n)), z(n), z(n), z(n), z(n), z(n), z(n))
    nobody, nothing = np.full((k, 2), -1), z((0, 2, 3, 6))
    return Cones(
        nobody,
        nothing,
        nothing,
        own,
        z((k, 3)),
        friction,
        z((k, 3)),
        z((0, 6)),
        room,
        past_of(0, 0),
        z(1),
    )


@uncounted
def _sweep(problem: Cones) -> None:
    """Solve one contact after the other."""
    A, q, r, own = problem.dense.A, problem.q, problem.r, problem.own
    k = q.shape[0]
    for c in range(k):
        b0, b1, b2 = q[c, 0], q[c, 1], q[c, 2]
        for d in range(k):
            if d != c:
                for j in range(3):
                    b0 += A[3 * c, 3 * d + j] * r[d, j]
                    b1 += A[3 * c + 1, 3 * d + j] * r[d, j]
                    b2 += A[3 * c + 2, 3 * d + j] * r[d, j]
        x = single(own[c], (b0, b1, b2), problem.friction[c], (r[c, 0], r[c, 1], r[c, 2]))
        r[c, 0], r[c, 1], r[c, 2] = x


@uncounted
def residual(problem: Cones) -> float:
    """What :func:`off_cone` has over the largest impulse.

    What is small beside :attr:`~.Cones.speed` is known no better than to round-off.
    """
    worst, size, least = 0.0, np.finfo(np.float64).tiny, problem.speed[0]
    A, q, r, own = problem.dense.A, problem.q, problem.r, problem.own
    k = q.shape[0]
    for c in range(k):
        u0, u1, u2 = q[c, 0], q[c, 1], q[c, 2]
        for d in range(k):
            for j in range(3):
                u0 += A[3 * c, 3 * d + j] * r[d, j]
                u1 += A[3 * c + 1, 3 * d + j] * r[d, j]
                u2 += A[3 * c + 2, 3 * d + j] * r[d, j]
        off, rho = off_cone((u0, u1, u2), own[c], problem.friction[c], r[c])
        worst = max(worst, off)
        size = max(size, abs(r[c, 0]), rho * max(abs(q[c, 0]), least))
    return float(worst / size)


@uncounted
def _newton(problem: Cones, tolerance: float) -> int:
    """Newton's method with steps that are halved; returns the iterations."""
    k = problem.q.shape[0]
    begin_newton(problem, k)
    for iteration in range(1, _ITERATIONS + 1):
        step_of_newton(problem, k)
        if residual(problem) <= tolerance:
            return iteration
    return _ITERATIONS


@uncounted
def solve(problem: Cones, tolerance: float) -> tuple[int, float]:
    """Solve for the impulses, from those that are there; returns sweeps and what is left.

    Args:
        problem: Updated.
        tolerance: Of :func:`residual`.
    """
    sweeps, reached, limit, k = 0, np.inf, _FIRST, problem.q.shape[0]
    for rounds in range(_ROUNDS + 1):
        for _ in range(limit):
            _sweep(problem)
            sweeps += 1
            reached = residual(problem)
            if reached <= tolerance:
                return sweeps, reached
        if rounds < _ROUNDS and k <= _MOST_NEWTON:
            _newton(problem, tolerance)
            found = residual(problem)
            if not found < reached:
                for i in range(3 * k):
                    problem.r[i // 3, i % 3] = problem.dense.kept[i]
            else:
                reached = found
            if reached <= tolerance:
                break
        limit = _LATER * 3**rounds
    return sweeps, reached


def solve_exactly(problem: Cones, A: Array, tolerance: float) -> tuple[int, float]:
    """:func:`solve` until what contacts yield is nothing any more.

    Args:
        problem: Updated.
        A: Its matrix without :data:`_YIELD`.
        tolerance: As there.
    """
    q, sweeps, reached = problem.q.copy(), 0, np.inf
    for _ in range(_ROUNDS):
        problem.q[:] = q + ((A - problem.dense.A) @ problem.r.ravel()).reshape(-1, 3)
        before = problem.r.copy()
        more, reached = solve(problem, tolerance)
        sweeps += more
        change = np.abs(problem.r - before).max()
        if change <= 1e-15 * np.abs(problem.r).max(initial=0.0) or reached > tolerance:
            break
    return sweeps, reached
