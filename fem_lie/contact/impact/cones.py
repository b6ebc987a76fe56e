"""Coulomb's cones: ``u = q + B M⁻¹ B̄ᵀ r`` with ``K* ∋ u + μ|u_t| e_n ⊥ r ∈ K_μ`` at each contact.

That is De Saxcé's form of the exact law: what slides does not lift. Sweeps over the contacts take
the exact solution of each, the others as they are (Jean & Moreau 1992); between them Newton's
method on the function of Alart & Curnier, CMAME 92 (1991) 353, for few contacts. Many contacts,
of which each need not be solved exactly, are swept by projections; between sweeps impulses go on as
Nesterov's method does, until sweeps turn back (O'Donoghue & Candès, Found. Comput. Math. 15 (2015)
715). Components are along the normal, then along two tangents.

Velocities of bodies change by ``W = M⁻¹ B̄ᵀ r``; nothing but that is summed up, so that a sweep
costs the same per contact however many there are.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import inlined_uncounted, uncounted
from fem_lie.contact.impact.newton import newton
from fem_lie.contact.impact.sweeps import (
    MOST_NEWTON,
    Cones,
    along,
    begin,
    change,
    push,
    residual,
    sweep,
)

_FIRST, _LATER, _ROUNDS = 3, 10, 4
"""Sweeps at first, sweeps of the first round after that, and rounds."""

_MANY = 1e-6
"""Residual with which more contacts than those are content."""

_LONGEST, _LOOK, _JUDGE, _LESS = 10_000, 10, 100, 0.9
"""Sweeps of these at most; after how many of them the residual is looked at; after how many it is
to have halved, and by which part they go on at most from then on where it has not."""

_GROWTH = 1e2
"""Newton's forces over those of the sweeps: wedged bodies have internal forces of any size."""


@uncounted
def _with_newton(problem: Cones, k: int, tolerance: float, reached: float) -> tuple[int, float]:
    """Iterations and residual; impulses stay as they are if Newton's are no better."""
    iterations = newton(problem, k, tolerance)
    found, size, before = residual(problem, k), 0.0, 0.0
    kept = problem.dense.kept
    for i in range(3 * k):
        size, before = max(size, abs(problem.r[i // 3, i % 3])), max(before, abs(kept[i]))
    if not found < reached or size > _GROWTH * before:
        for i in range(3 * k):
            problem.r[i // 3, i % 3] = kept[i]
        change(problem, k)
        found = reached
    return iterations, found


@inlined_uncounted
def _go_on(x: Array, before: Array, part: float) -> None:
    """``x ← x + part (x − before)``, shapes (k, ·); keeps ``x`` as what is before the next."""
    for i in range(before.shape[0]):
        for j in range(before.shape[1]):
            here = x[i, j]
            x[i, j] += part * (here - before[i, j])
            before[i, j] = here


@inlined_uncounted
def _improve(problem: Cones, c: int) -> tuple[float, float, float]:
    """Impulses of a contact by projections, the others as they are; returns how they change."""
    rows, bodies, r, own = problem.rows[c], problem.bodies[c], problem.r, problem.own
    u = problem.q[c, 0] + along(rows, bodies, problem.W, 0)
    normal = max(0.0, r[c, 0] - u / own[c, 0, 0])
    d0, d1, d2 = normal - r[c, 0], -r[c, 1], -r[c, 2]
    push(problem.pushes[c], bodies, 0, d0, problem.W)
    radius = problem.friction[c] * normal
    if radius > 0.0:
        size = 2.0 / (own[c, 1, 1] + own[c, 2, 2])
        x = r[c, 1] - size * (problem.q[c, 1] + along(rows, bodies, problem.W, 1))
        y = r[c, 2] - size * (problem.q[c, 2] + along(rows, bodies, problem.W, 2))
        t = np.sqrt(x * x + y * y)
        part = radius / t if t > radius else 1.0
        d1, d2 = part * x - r[c, 1], part * y - r[c, 2]
    if d1 != 0.0 or d2 != 0.0:
        push(problem.pushes[c], bodies, 1, d1, problem.W)
        push(problem.pushes[c], bodies, 2, d2, problem.W)
    return d0, d1, d2


@uncounted
def _accelerated(problem: Cones, k: int, tolerance: float) -> tuple[int, float]:
    """Sweeps that go on by a part of what the last one did; how many, and the residual."""
    r, before, turned = problem.r, problem.before[:k], problem.turned
    _go_on(r, before, 0.0)
    _go_on(problem.W, turned, 0.0)
    reached, weight, most, mark = np.inf, 1.0, 1.0, np.inf
    for sweeps in range(1, _LONGEST + 1):
        forward = 0.0
        for c in range(k):
            d = _improve(problem, c)
            for j in range(3):
                r[c, j] += d[j]
                forward += d[j] * (r[c, j] - before[c, j])
        if sweeps % _LOOK == 0:
            reached = residual(problem, k)
            if reached <= tolerance:
                return sweeps, reached
        if sweeps % _JUDGE == 0:  # friction has no potential: going on may turn in a circle
            if reached > 0.5 * mark:
                most, weight = _LESS, 1.0
            mark = reached
        weight = 1.0 if forward < 0.0 else weight
        later = 0.5 * (1.0 + np.sqrt(1.0 + 4.0 * weight * weight))
        part, weight = min(most, (weight - 1.0) / later), later
        _go_on(r, before, part)
        _go_on(problem.W, turned, part)
    return _LONGEST, reached


@uncounted
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
    if k > MOST_NEWTON:
        sweeps, reached = _accelerated(problem, k, max(tolerance, _MANY))
        return sweeps, 0, reached
    sweeps, iterations, reached, limit = 0, 0, np.inf, _FIRST
    for rounds in range(_ROUNDS + 1):
        for _ in range(limit):
            sweep(problem, k)
            sweeps += 1
            reached = residual(problem, k)
            if reached <= tolerance:
                return sweeps, iterations, reached
        if rounds < _ROUNDS:
            more, reached = _with_newton(problem, k, tolerance, reached)
            iterations += more
            if reached <= tolerance:
                break
        limit = _LATER * 3**rounds
    return sweeps, iterations, reached
