"""Coulomb's cones: ``u = q + B M⁻¹ B̄ᵀ r`` with ``K* ∋ u + μ|u_t| e_n ⊥ r ∈ K_μ`` at each contact.

This is De Saxcé's form of the exact law: a sliding contact does not separate. For few contacts,
nonlinear Gauss-Seidel sweeps solve one contact after the other exactly (Jean & Moreau 1992), and
alternate with Newton's method on the function of Alart & Curnier, CMAME 92 (1991) 353. For many
contacts, the sweeps project impulses on the cones. Every fifth sweep is followed by Anderson
mixing: a least-squares extrapolation from the last ten sweeps (in alternation as by Pratapa,
Suryanarayana & Pask, J. Comput. Phys. 306 (2016) 43). Where that does not converge, the sweeps use
Nesterov's acceleration with restarts (O'Donoghue & Candès, Found. Comput. Math. 15 (2015) 715).
Contacts that neither slide nor open are then solved to round-off by Newton's method with sparse
factors; others need not be solved as accurately. Components are along the normal, then along two
tangents.

Velocities of nodes change by ``W = M⁻¹ B̄ᵀ r``. Only ``W`` is summed, so the cost of a sweep per
contact is proportional to the number of blocks in its rows and in those of ``M⁻¹ B̄ᵀ``, independent
of the number of contacts. :mod:`.jacobian` defines ``M``; nothing here depends on it.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import inlined_uncounted, uncounted
from fem_lie.contact.cones.jacobian import add_responses
from fem_lie.contact.cones.newton import eliminate, newton, proximal
from fem_lie.contact.cones.sparse_newton import newton as sparse_newton
from fem_lie.contact.cones.sweeps import (
    MOST_NEWTON,
    PAST,
    Cones,
    begin,
    change,
    residual,
    sweep,
    velocity,
)

_FIRST, _LATER = 3, 10
"""Number of sweeps before Newton's method, and before its proximal steps."""

_MANY = 1e-6
"""Residual that is sufficient for more contacts than Newton's method takes, if there is
friction."""

_ENOUGH = 1e-9
"""Residual that is sufficient if it did not decrease in the first sweeps."""

_LONGEST, _TURN, _LOOK, _EVERY, _WORSE = 30_000, 100, 5, 5, 4.0
"""Approximate largest number of sweeps for many contacts; sweeps in the first round; sweeps between
evaluations of the residual; sweeps between extrapolations; ratio of the squared change of a sweep
to the least one above which stored sweeps are discarded."""

_GROWS, _LOWER, _RECOVER = 3.0, 1.5, 0.99
"""Nesterov's extrapolation: ratio of the squared change of a sweep to the least one since the last
restart above which it restarts; factor by which the bound of the momentum is then farther from one,
and by which it approaches one in each other sweep."""

_MOMENTUM, _LEAST_MOMENTUM = 0.93, 0.8
"""Bound of the momentum at the start, and its least value."""

_RIDGE = 1e-12
"""Regularisation of the least-squares problem, relative to the largest diagonal entry."""

_AT_REST, _EXACT, _ROUNDS, _PATIENCE = 1e-2, 1e-12, 50, 25
"""Velocity below which contacts are at rest, relative to that due to the largest impulse; residual
that suffices for them; largest number of iterations of Newton's method to reach it, and of those
without success."""

_PROXIMAL = 5
"""Largest number of proximal steps."""

_GROWTH = 1e2
"""Largest ratio of Newton's impulses to those of the sweeps: wedged bodies have arbitrary internal
forces. With friction they may have no solution, and impulses that grow without limit then have a
small residual, which is relative to them."""


@uncounted
def _with_newton(problem: Cones, k: int, tolerance: float, reached: float) -> tuple[int, float]:
    """Iterations and residual; impulses are unchanged if those of Newton's method are no better."""
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
def _improve(problem: Cones, c: int) -> tuple[float, float, float]:
    """Change of the impulses of a contact by projection, with all other impulses fixed."""
    r, own = problem.r, problem.own
    u0, u1, u2 = velocity(problem, c)
    normal = max(0.0, r[c, 0] - u0 / own[c, 0, 0])
    d0, d1, d2 = normal - r[c, 0], -r[c, 1], -r[c, 2]
    radius = problem.friction[c] * normal
    if radius > 0.0:
        size = 2.0 / (own[c, 1, 1] + own[c, 2, 2])
        x = r[c, 1] - size * (u1 + own[c, 1, 0] * d0)
        y = r[c, 2] - size * (u2 + own[c, 2, 0] * d0)
        t = np.sqrt(x * x + y * y)
        part = radius / t if t > radius else 1.0
        d1, d2 = part * x - r[c, 1], part * y - r[c, 2]
    if d0 != 0.0 or d1 != 0.0 or d2 != 0.0:
        add_responses(problem.responses, c, (d0, d1, d2), problem.W)
    return d0, d1, d2


@inlined_uncounted
def _store_difference(problem: Cones, k: int, at: int, known: int) -> None:
    """Store the difference of the last two sweeps in row ``at`` of the history."""
    past, r = problem.past, problem.r
    for c in range(k):
        for j in range(3):
            past.steps[at, c, j] = r[c, j] - past.end[c, j]
            past.changes[at, c, j] = r[c, j] - past.start[c, j] - past.did[c, j]
    for i in range(known):
        total = 0.0
        for c in range(k):
            for j in range(3):
                total += past.changes[at, c, j] * past.changes[i, c, j]
        past.products[at, i] = past.products[i, at] = total
    for body in range(past.turned.shape[0]):
        for j in range(6):
            past.turns[at, body, j] = problem.W[body, j] - past.turned[body, j]


@inlined_uncounted
def _go_on(problem: Cones, k: int, known: int) -> None:
    """Extrapolate the impulses so that the predicted change of the next sweep is least."""
    past, most = problem.past, 0.0
    for i in range(known):
        total = 0.0
        for c in range(k):
            for j in range(3):
                total += past.changes[i, c, j] * past.did[c, j]
        past.parts[i] = total
        most = max(most, past.products[i, i])
        for j in range(known):
            past.workspace[i, j] = past.products[i, j]
    if most == 0.0:  # all stored sweeps made the same change
        return
    for i in range(known):
        past.workspace[i, i] += _RIDGE * most
    eliminate(past.workspace, past.parts, known)
    for i in range(known):
        part = past.parts[i]
        for c in range(k):
            for j in range(3):
                problem.r[c, j] -= part * past.steps[i, c, j]
        for body in range(past.turned.shape[0]):
            for j in range(6):
                problem.W[body, j] -= part * past.turns[i, body, j]


@inlined_uncounted
def _store_sweep(problem: Cones, k: int) -> None:
    """Store the change that the last sweep made, and its result."""
    past = problem.past
    for c in range(k):
        for j in range(3):
            past.did[c, j] = problem.r[c, j] - past.start[c, j]
            past.end[c, j] = problem.r[c, j]
    for body in range(past.turned.shape[0]):
        for j in range(6):
            past.turned[body, j] = problem.W[body, j]


@uncounted
def _anderson(problem: Cones, k: int, tolerance: float, most: int) -> tuple[int, float]:
    """Sweeps with Anderson mixing; number of sweeps and the residual."""
    r, start = problem.r, problem.past.start
    reached, best, known, at = np.inf, np.inf, 0, 0
    for sweeps in range(1, most + 1):
        square = 0.0
        for c in range(k):
            d = _improve(problem, c)
            for j in range(3):
                start[c, j] = r[c, j]
                r[c, j] += d[j]
                square += d[j] * d[j]
        if sweeps % _LOOK == 0:
            reached = residual(problem, k)
            if reached <= tolerance:
                return sweeps, reached
        if square > _WORSE * best:
            known, at, best = 0, 0, square
        elif sweeps > 1:
            known = min(known + 1, PAST)
            _store_difference(problem, k, at, known)
            at = (at + 1) % PAST
        best = min(best, square)
        _store_sweep(problem, k)
        if known > 0 and sweeps % _EVERY == 0 and sweeps < most:
            _go_on(problem, k, known)
    return most, reached


@inlined_uncounted
def _extrapolate_by(x: Array, before: Array, part: float) -> None:
    """``x ← x + part (x − before)``, shapes (k, ·); ``before`` becomes the old ``x``."""
    for i in range(before.shape[0]):
        for j in range(before.shape[1]):
            here = x[i, j]
            x[i, j] += part * (here - before[i, j])
            before[i, j] = here


@uncounted
def _nesterov(problem: Cones, k: int, tolerance: float, most: int) -> tuple[int, float]:
    """Sweeps with Nesterov's acceleration; number of sweeps and the residual.

    Where contacts cannot all stick, impulses drift by nearly constant changes until one of them
    slides; momenta near one pass through that in the square root of the number of sweeps. With
    friction they also amplify oscillations. The momentum restarts where that happens, and its bound
    is lowered, to approach one again in quiet sweeps.
    """
    r, before, turned = problem.r, problem.past.end[:k], problem.past.turned
    _extrapolate_by(r, before, 0.0)
    _extrapolate_by(problem.W, turned, 0.0)
    reached, weight, part, bound, least = np.inf, 1.0, 0.0, _MOMENTUM, np.inf
    for sweeps in range(1, most + 1):
        forward, square = 0.0, 0.0
        for c in range(k):
            d = _improve(problem, c)
            for j in range(3):
                r[c, j] += d[j]
                forward += d[j] * (r[c, j] - before[c, j])
                square += d[j] * d[j]
        if sweeps % _LOOK == 0:
            reached = residual(problem, k)
            if reached <= tolerance:
                return sweeps, reached
        least = min(least, square)
        if square > _GROWS * least:
            bound = max(_LEAST_MOMENTUM, 1.0 - _LOWER * (1.0 - part))
        else:
            bound = 1.0 - _RECOVER * (1.0 - bound)
        if square > _GROWS * least or forward < 0.0:
            weight, least = 1.0, np.inf
        later = 0.5 * (1.0 + np.sqrt(1.0 + 4.0 * weight * weight))
        part, weight = min(bound, (weight - 1.0) / later), later
        if sweeps < most:
            _extrapolate_by(r, before, part)
            _extrapolate_by(problem.W, turned, part)
    return most, reached


@uncounted
def _alternate(problem: Cones, k: int, tolerance: float) -> tuple[int, float]:
    """Alternate between both methods: with friction, each of them cycles in some problems."""
    sweeps, most, reached = 0, _TURN, np.inf
    while reached > tolerance and sweeps < _LONGEST:
        more, reached = _nesterov(problem, k, tolerance, 4 * most)
        sweeps += more
        if reached > tolerance:
            more, reached = _anderson(problem, k, tolerance, most)
            sweeps += more
        most *= 2
    return sweeps, reached


@uncounted
def _rests(problem: Cones, k: int) -> bool:
    """Whether no contact slides or opens."""
    fastest, largest = 0.0, 0.0
    for c in range(k):
        u, own = velocity(problem, c), problem.own[c]
        response = (own[0, 0] + own[1, 1] + own[2, 2]) / 3.0
        size = abs(u[0]) + abs(u[1]) + abs(u[2])
        fastest = max(fastest, size / response)
        largest = max(largest, problem.r[c, 0])
    return fastest <= _AT_REST * largest


@uncounted
def _many(problem: Cones, k: int, tolerance: float) -> tuple[int, int, float]:
    """Sweeps over many contacts, and Newton's method for those at rest; see :func:`solve`."""
    enough, iterations = max(tolerance, _MANY if _has_friction(problem, k) else _ENOUGH), 0
    sweeps, reached = _anderson(problem, k, enough, _TURN)
    if _rests(problem, k):
        exact = max(tolerance, _EXACT)
        iterations, reached = sparse_newton(problem, k, exact, _ROUNDS, _PATIENCE)
    if reached > enough:
        more, reached = _alternate(problem, k, enough)
        sweeps += more
    return sweeps, iterations, reached


@inlined_uncounted
def _has_friction(problem: Cones, k: int) -> bool:
    """Whether there is friction; without it the problem is convex, and sweeps converge."""
    for c in range(k):
        if problem.friction[c] > 0.0:
            return True
    return False


@uncounted
def solve(problem: Cones, k: int, tolerance: float) -> tuple[int, int, float]:
    """Solve for the impulses of the first ``k`` contacts; present impulses are the initial guess.

    Args:
        problem: Updated.
        k: Number of contacts.
        tolerance: Tolerance of :func:`residual`.

    Returns:
        Number of sweeps, number of iterations of Newton's method, and the final :func:`residual`.
    """
    begin(problem, k)
    if k > MOST_NEWTON:
        return _many(problem, k, tolerance)
    sweeps, iterations, reached = 0, 0, np.inf
    enough = max(tolerance, _ENOUGH)
    for first in (True, False):
        for _ in range(_FIRST if first else _LATER):
            sweep(problem, k)
            sweeps += 1
            reached = residual(problem, k)
            if reached <= (tolerance if first else enough):
                return sweeps, iterations, reached
        if first:
            more, reached = _with_newton(problem, k, enough, reached)
        else:
            most = _GROWTH if _has_friction(problem, k) else np.inf
            more, reached = proximal(problem, k, enough, most)
        iterations += more
        if reached <= enough:
            return sweeps, iterations, reached
    if reached > _MANY:
        more, reached = _alternate(problem, k, _MANY)
        sweeps += more
    return sweeps, iterations, reached


@uncounted
def solve_exactly(
    problem: Cones, k: int, tolerance: float, before: tuple[Array, Array]
) -> tuple[int, float]:
    """As :func:`solve` without the compliance :attr:`Cones.soft`, by proximal steps.

    Args:
        problem: Updated.
        k: Number of contacts.
        tolerance: Tolerance of :func:`residual`.
        before: Workspace, two arrays (k, 3).

    Returns:
        Number of sweeps, and the final :func:`residual`.
    """
    (q, r), sweeps, reached = before, 0, np.inf
    for c in range(k):
        for i in range(3):
            q[c, i] = problem.q[c, i]
    for _ in range(_PROXIMAL):
        for c in range(k):
            for i in range(3):
                r[c, i] = problem.r[c, i]
                problem.q[c, i] = q[c, i] - problem.soft[c] * r[c, i]
        more, _, reached = solve(problem, k, tolerance)
        sweeps += more
        changed, largest = 0.0, 0.0
        for c in range(k):
            for i in range(3):
                changed = max(changed, abs(problem.r[c, i] - r[c, i]))
                largest = max(largest, abs(problem.r[c, i]))
        if changed <= 1e-15 * largest or reached > tolerance:
            break
    return sweeps, reached
