"""Coulomb's cones: ``u = q + B M⁻¹ B̄ᵀ r`` with ``K* ∋ u + μ|u_t| e_n ⊥ r ∈ K_μ`` at each contact.

That is De Saxcé's form of the exact law: what slides does not lift. Sweeps over the contacts take
the exact solution of each, the others as they are (Jean & Moreau 1992); between them Newton's
method on the function of Alart & Curnier, CMAME 92 (1991) 353, for few contacts. Many contacts,
of which each need not be solved exactly, are swept by projections; every fifth time impulses go on
to where the last ten sweeps tell by least squares that the next would do least (Anderson's mixing,
in turns as by Pratapa, Suryanarayana & Pask, J. Comput. Phys. 306 (2016) 43). Where that does not
end, they go on as in Nesterov's method, until sweeps turn back (O'Donoghue & Candès, Found. Comput.
Math. 15 (2015) 715). Components are along the normal, then along two tangents.

Velocities of nodes change by ``W = M⁻¹ B̄ᵀ r``; nothing but that is summed up, so that a sweep
costs as much per contact as its rows and those of ``M⁻¹ B̄ᵀ`` have blocks, however many contacts
there are. What ``M`` is, :mod:`.jacobian` says; nothing here depends on it.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import inlined_uncounted, uncounted
from fem_lie.contact.impact.jacobian import push_all
from fem_lie.contact.impact.newton import eliminate, newton, proximal
from fem_lie.contact.impact.sweeps import (
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
"""Sweeps before Newton's method, and before its proximal steps."""

_MANY = 1e-6
"""Residual with which more contacts than those are content, if there is friction."""

_ENOUGH = 1e-9
"""Residual with which all are content that was not less after the first sweeps."""

_LONGEST, _TURN, _LOOK, _EVERY, _WORSE, _LESS = 9_000, 200, 5, 5, 4.0, 0.9
"""Sweeps of these, about, at most; in the first turn; after how many of them the residual is looked
at, and impulses go on; by how much more than at best a sweep may do, squared, until what is known
of sweeps is dropped; by which part they go on at most where nothing else has ended."""

_RIDGE = 1e-12
"""Added to the diagonal of the least squares, over its largest."""

_PROXIMAL = 5
"""Proximal steps at most."""

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
def _improve(problem: Cones, c: int) -> tuple[float, float, float]:
    """Impulses of a contact by projections, the others as they are; returns how they change."""
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
        push_all(problem.pushes, c, (d0, d1, d2), problem.W)
    return d0, d1, d2


@inlined_uncounted
def _note(problem: Cones, k: int, at: int, known: int) -> None:
    """Keep by what the last sweep differs from that before, at one place of those there are."""
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
    """Impulses from where the last sweep ended to where the next is to do least."""
    past, most = problem.past, 0.0
    for i in range(known):
        total = 0.0
        for c in range(k):
            for j in range(3):
                total += past.changes[i, c, j] * past.did[c, j]
        past.parts[i] = total
        most = max(most, past.products[i, i])
        for j in range(known):
            past.room[i, j] = past.products[i, j]
    if most == 0.0:  # the last sweeps did all the same
        return
    for i in range(known):
        past.room[i, i] += _RIDGE * most
    eliminate(past.room, past.parts, known)
    for i in range(known):
        part = past.parts[i]
        for c in range(k):
            for j in range(3):
                problem.r[c, j] -= part * past.steps[i, c, j]
        for body in range(past.turned.shape[0]):
            for j in range(6):
                problem.W[body, j] -= part * past.turns[i, body, j]


@inlined_uncounted
def _keep(problem: Cones, k: int) -> None:
    """What the last sweep did, and where it ended."""
    past = problem.past
    for c in range(k):
        for j in range(3):
            past.did[c, j] = problem.r[c, j] - past.start[c, j]
            past.end[c, j] = problem.r[c, j]
    for body in range(past.turned.shape[0]):
        for j in range(6):
            past.turned[body, j] = problem.W[body, j]


@uncounted
def _mixed(problem: Cones, k: int, tolerance: float, most: int) -> tuple[int, float]:
    """Sweeps between which impulses go on by least squares; how many, and the residual."""
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
            _note(problem, k, at, known)
            at = (at + 1) % PAST
        best = min(best, square)
        _keep(problem, k)
        if known > 0 and sweeps % _EVERY == 0 and sweeps < most:
            _go_on(problem, k, known)
    return most, reached


@inlined_uncounted
def _swing(x: Array, before: Array, part: float) -> None:
    """``x ← x + part (x − before)``, shapes (k, ·); keeps ``x`` as what is before the next."""
    for i in range(before.shape[0]):
        for j in range(before.shape[1]):
            here = x[i, j]
            x[i, j] += part * (here - before[i, j])
            before[i, j] = here


@uncounted
def _swung(
    problem: Cones, k: int, tolerance: float, most: int, largest: float
) -> tuple[int, float]:
    """Sweeps that go on by a part of what the last one did; how many, and the residual."""
    r, before, turned = problem.r, problem.past.end[:k], problem.past.turned
    _swing(r, before, 0.0)
    _swing(problem.W, turned, 0.0)
    reached, weight = np.inf, 1.0
    for sweeps in range(1, most + 1):
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
        weight = 1.0 if forward < 0.0 else weight
        later = 0.5 * (1.0 + np.sqrt(1.0 + 4.0 * weight * weight))
        part, weight = min(largest, (weight - 1.0) / later), later
        if sweeps < most:
            _swing(r, before, part)
            _swing(problem.W, turned, part)
    return most, reached


@uncounted
def _in_turns(problem: Cones, k: int, tolerance: float) -> tuple[int, float]:
    """All: friction has no potential, and each turns in circles in some problems."""
    sweeps, most = 0, _TURN
    while True:
        more, reached = _mixed(problem, k, tolerance, most)
        sweeps += more
        if reached > tolerance:
            more, reached = _swung(problem, k, tolerance, 2 * most, 1.0)
            sweeps += more
        if reached > tolerance:
            more, reached = _swung(problem, k, tolerance, 4 * most, _LESS)
            sweeps += more
        most *= 2
        if reached <= tolerance or sweeps >= _LONGEST:
            return sweeps, reached


@inlined_uncounted
def _has_friction(problem: Cones, k: int) -> bool:
    """Whether there is friction; without it the problem is convex, and sweeps end."""
    for c in range(k):
        if problem.friction[c] > 0.0:
            return True
    return False


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
        enough = max(tolerance, _MANY if _has_friction(problem, k) else _ENOUGH)
        sweeps, reached = _in_turns(problem, k, enough)
        return sweeps, 0, reached
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
            more, reached = proximal(problem, k, enough)
        iterations += more
        if reached <= enough:
            return sweeps, iterations, reached
    if reached > _MANY:
        more, reached = _in_turns(problem, k, _MANY)
        sweeps += more
    return sweeps, iterations, reached


@uncounted
def solve_exactly(
    problem: Cones, k: int, tolerance: float, before: tuple[Array, Array]
) -> tuple[int, float]:
    """:func:`solve` with contacts that do not yield: :attr:`Cones.soft` becomes proximal steps.

    Args:
        problem: Updated.
        k: How many contacts.
        tolerance: Of :func:`residual`.
        before: Memory, twice (k, 3).

    Returns:
        Sweeps, and what :func:`residual` is left.
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
