"""Coulomb's cones: ``u = q + B M⁻¹ B̄ᵀ r`` with ``K* ∋ u + μ|u_t| e_n ⊥ r ∈ K_μ`` at each contact.

That is De Saxcé's form of the exact law: what slides does not lift. Sweeps over the contacts take
the exact solution of each, the others as they are (Jean & Moreau 1992); between them Newton's
method on the function of Alart & Curnier, CMAME 92 (1991) 353, for few contacts. Components are
along the normal, then along two tangents.

Velocities of bodies change by ``W = M⁻¹ B̄ᵀ r``; nothing but that is summed up, so that a sweep
costs the same per contact however many there are.
"""

from __future__ import annotations

import numpy as np

from fem_lie._jit import uncounted
from fem_lie.contact.impact.newton import newton
from fem_lie.contact.impact.sweeps import MOST_NEWTON, Cones, begin, change, residual, sweep

_FIRST, _LATER, _ROUNDS = 3, 10, 4
"""Sweeps at first, sweeps of the first round after that, and rounds."""

_MANY = 1e-6
"""Residual with which more contacts than those are content."""

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
