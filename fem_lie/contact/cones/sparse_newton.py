"""Newton's method on the function of Alart & Curnier, for many contacts, with sparse factors.

Impulses are eliminated contact by contact, so that the unknowns of the linear system are the
velocities of the nodes; a small compliance makes the impulses of redundant contacts unique.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled, inlined_uncounted, uncounted
from fem_lie.contact.cones.factors import (
    DEAR,
    Factors,
    Pattern,
    add_block,
    empty_factors,
    factorise,
    neighbours_of,
    pattern_of,
    products_of,
    set_identity,
    solve_nodes,
)
from fem_lie.contact.cones.jacobian import add_responses, along_all
from fem_lie.contact.cones.sweeps import Cones, change, residual, velocity
from fem_lie.lie.tuples import Vector

YIELD = 1e-6
"""Compliance of contacts to changes of impulses, relative to their own response."""

HALVES = 6
"""Largest number of halvings of a step."""

_SMALL, _LAST = 1e-9, 8
"""Residual at which contacts no longer change their state; patience from there on."""


@inlined_uncounted
def _scales(own: Array) -> tuple[float, float]:
    """Impulse per velocity, along the normal and along tangents."""
    return 1.0 / own[0, 0], 2.0 / (own[1, 1] + own[2, 2])


@inlined_uncounted
def _function(own: Array, mu: float, r: Array, u: Vector) -> Vector:
    """Function of one contact, which vanishes at a solution; an impulse."""
    rn, rt = _scales(own)
    z, x, y = r[0] - rn * u[0], r[1] - rt * u[1], r[2] - rt * u[2]
    if z <= 0.0:
        return r[0], r[1], r[2]
    t = np.sqrt(x * x + y * y)
    if t <= mu * z:
        return rn * u[0], rt * u[1], rt * u[2]
    part = mu * z / t
    return rn * u[0], r[1] - part * x, r[2] - part * y


@inlined_uncounted
def _linearise(
    own: Array, mu: float, soft: float, r: Array, u: Vector, G: Array, f: Array
) -> float:
    """Set ``G`` and ``f`` of Newton's step ``δr = −f − G δu``; return the function's square.

    Args:
        own: Response of the contact to its own impulse, shape (3, 3).
        mu: Coefficient of friction.
        soft: Compliance of the contact.
        r: Impulse of the contact, shape (3,).
        u: Velocity with all impulses.
        G: Impulse per velocity, shape (3, 3).
        f: Impulse, shape (3,).
    """
    rn, rt = _scales(own)
    F = _function(own, mu, r, u)
    z, x, y = r[0] - rn * u[0], r[1] - rt * u[1], r[2] - rt * u[2]
    t = np.sqrt(x * x + y * y)
    G[:] = 0.0
    f[0], f[1], f[2] = F
    if z > 0.0:
        normal, along = YIELD + rn * soft, YIELD + rt * soft
        f[0], G[0, 0] = F[0] / normal, rn / normal
        if t <= mu * z:
            f[1], f[2], G[1, 1], G[2, 2] = F[1] / along, F[2] / along, rt / along, rt / along
        else:
            c, s, part = x / t, y / t, mu * z / t
            across = 1.0 + along - part  # changes of the direction of sliding
            forward, turned = c * F[1] + s * F[2] + mu * f[0], (c * F[2] - s * F[1]) / across
            f[1], f[2] = c * forward - s * turned, s * forward + c * turned
            turns = part * rt / across
            G[1, 0], G[2, 0] = mu * c * G[0, 0], mu * s * G[0, 0]
            G[1, 1], G[2, 2] = turns * s * s, turns * c * c
            G[1, 2] = G[2, 1] = -turns * c * s
    return F[0] * F[0] + F[1] * F[1] + F[2] * F[2]


@uncounted
def _set_matrix(problem: Cones, k: int, G: Array, pattern: Pattern, into: Factors) -> None:
    """``1 + M⁻¹ B̄ᵀ G B``, by nodes."""
    rows, responses, position = problem.rows, problem.responses, pattern.position
    set_identity(into)
    for c in range(k):
        for s in range(rows.first[c], rows.first[c + 1]):
            j, values = position[rows.nodes[s]], rows.values[s]
            for a in range(3):
                for b in range(6):
                    G[k, a, b] = (
                        G[c, a, 0] * values[0, b]
                        + G[c, a, 1] * values[1, b]
                        + G[c, a, 2] * values[2, b]
                    )
            for t in range(responses.first[c], responses.first[c + 1]):
                i = position[responses.nodes[t]]
                add_block(pattern, into, i, j, responses.values[t], G[k])


@uncounted
def _set_step(
    problem: Cones,
    k: int,
    G: Array,
    f: Array,
    pattern: Pattern,
    of: Factors,
    w: Array,
    workspace: Array,
) -> None:
    """Newton's step of the impulses, in ``f``, from its part without changes of velocities.

    Args:
        problem: The problem; its ``W`` becomes the change of velocities.
        k: Number of contacts.
        G: Impulse per velocity of each contact, in the first columns, shape (k + 1, 3, 6).
        f: Impulses, shape (k, 3), updated.
        pattern: Pattern of the factors.
        of: Factors.
        w: Workspace, shape (n, 6).
        workspace: Workspace, shape (6, 12).
    """
    W = problem.W
    W[:] = 0.0
    for c in range(k):
        add_responses(problem.responses, c, (-f[c, 0], -f[c, 1], -f[c, 2]), W)
    solve_nodes(pattern, of, W, w, workspace)
    for c in range(k):
        u = along_all(problem.rows, c, W)
        for a in range(3):
            f[c, a] = -f[c, a] - G[c, a, 0] * u[0] - G[c, a, 1] * u[1] - G[c, a, 2] * u[2]


@uncounted
def _square(problem: Cones, k: int) -> float:
    """Square of the function."""
    total = 0.0
    for c in range(k):
        F = _function(problem.own[c], problem.friction[c], problem.r[c], velocity(problem, c))
        total += F[0] * F[0] + F[1] * F[1] + F[2] * F[2]
    return total


@uncounted
def _search(problem: Cones, k: int, step: Array, square: float) -> None:
    """Add the largest of a step and its halves that decreases the function."""
    size, more = 1.0, 1.0
    for _ in range(HALVES):
        for c in range(k):
            for j in range(3):
                problem.r[c, j] += more * step[c, j]
        change(problem, k)
        if _square(problem, k) < (1.0 - 1e-4 * size) * square:
            return
        size *= 0.5
        more = -size


@compiled
def newton(problem: Cones, k: int, tolerance: float, most: int, patience: int) -> tuple[int, float]:
    """Newton's method, as long as the residual decreases; iterations and residual.

    The residual may grow while contacts change between sticking, sliding and opening.

    Args:
        problem: Impulses and velocities are updated to those of the least residual.
        k: Number of contacts.
        tolerance: Tolerance of the residual.
        most: Largest number of iterations.
        patience: Number of iterations in which the least residual has to be halved.
    """
    reached, halved, since = residual(problem, k), residual(problem, k), 0
    n = problem.W.shape[0]
    pattern = pattern_of(*neighbours_of(problem.rows, problem.responses, k, n))
    if reached <= tolerance or products_of(pattern) > DEAR * k:
        return 0, reached
    factors = empty_factors(n, len(pattern.later))
    G, f, kept = np.zeros((k + 1, 3, 6)), np.zeros((k, 3)), problem.r[:k].copy()
    where, w, workspace = np.zeros(n, np.int64), np.zeros((n, 6)), np.zeros((6, 12))
    for iteration in range(1, most + 1):
        square = 0.0
        for c in range(k):
            law = problem.own[c], problem.friction[c], problem.soft[c]
            square += _linearise(*law, problem.r[c], velocity(problem, c), G[c], f[c])
        _set_matrix(problem, k, G, pattern, factors)
        factorise(pattern, factors, where, workspace)
        _set_step(problem, k, G, f, pattern, factors, w, workspace)
        _search(problem, k, f, square)
        now = residual(problem, k)
        if now < reached:
            reached = now
            kept[:] = problem.r[:k]
        if reached <= 0.5 * halved:
            halved, since = reached, iteration
        if reached <= tolerance or iteration - since >= (patience if reached > _SMALL else _LAST):
            break
    problem.r[:k] = kept
    change(problem, k)
    return iteration, residual(problem, k)
