"""Newton's method on ``0 ≤ ν ⊥ g ≥ 0`` of many contacts, with sparse factors."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined_uncounted, uncounted
from fem_lie.contact.cones.factors import (
    DEAR,
    add_block,
    empty_factors,
    factorise,
    neighbours_of,
    pattern_of,
    products_of,
    set_identity,
    solve_nodes,
)
from fem_lie.contact.cones.jacobian import BlockRows, add_response, along
from fem_lie.contact.cones.sparse_newton import HALVES, YIELD


class Gaps(NamedTuple):
    """Linearised gaps ``g = separation + B d`` of k contacts.

    Attributes:
        rows: ``B``, along normals.
        responses: Rows of ``M⁻¹ Bᵀ``.
        own: Products of both at the same contact, shape (k,).
        pairs: Pair of each contact, shape (k,).
        separation: Gaps of the pairs without displacements.
        nu: Position impulses of the pairs, updated.
        closed: Gaps of closed pairs, which are the unit of errors.
        moved: Displacements ``d`` of the nodes due to changes of ``nu``, shape (n, 6), updated.
    """

    rows: BlockRows
    responses: BlockRows
    own: Array
    pairs: Indices
    separation: Array
    nu: Array
    closed: Array
    moved: Array


@inlined_uncounted
def _function(of: Gaps, i: int) -> tuple[float, bool]:
    """Function of a contact, which vanishes at a solution, and whether the contact is closed."""
    nu = of.nu[of.pairs[i]]
    g = (of.separation[of.pairs[i]] + along(of.rows, i, of.moved, 0)) / of.own[i]
    return (g, True) if nu > g else (nu, False)


@uncounted
def _errors(of: Gaps, k: int) -> tuple[float, float]:
    """Largest error, in gaps of closed contacts, and the square of the function."""
    worst, square = 0.0, 0.0
    for i in range(k):
        F = _function(of, i)[0]
        worst = max(worst, abs(F) * of.own[i] / of.closed[of.pairs[i]])
        square += F * F
    return worst, square


@uncounted
def _search(of: Gaps, k: int, step: Array, square: float) -> None:
    """Add the largest of a step and its halves that decreases the function."""
    size, more = 1.0, 1.0
    for _ in range(HALVES):
        for i in range(k):
            of.nu[of.pairs[i]] += more * step[i]
            add_response(of.responses, i, 0, more * step[i], of.moved)
        if _errors(of, k)[1] < (1.0 - 1e-4 * size) * square:
            return
        size *= 0.5
        more = -size


@compiled
def separate(of: Gaps, k: int, enough: float, most: int) -> None:
    """Newton's method, if factors are not dearer than sweeps; the iterate of the least error.

    Args:
        of: Contacts.
        k: Number of contacts.
        enough: Largest error that is sufficient, in gaps of closed contacts.
        most: Largest number of iterations.
    """
    n = of.moved.shape[0]
    pattern = pattern_of(*neighbours_of(of.rows, of.responses, k, n))
    if products_of(pattern) > DEAR * k:
        return
    factors, scaled, step = empty_factors(n, len(pattern.later)), np.empty((1, 6)), np.empty(k)
    where, w, workspace = np.zeros(n, np.int64), np.zeros((n, 6)), np.zeros((6, 12))
    W, rows, responses = np.zeros((n, 6)), of.rows, of.responses
    least, kept, moved = np.inf, np.empty(k), np.empty((n, 6))
    for iteration in range(most + 1):
        worst, square = _errors(of, k)
        if worst < least:
            least = worst
            moved[:] = of.moved
            for i in range(k):
                kept[i] = of.nu[of.pairs[i]]
        if worst <= enough or iteration == most:
            break
        set_identity(factors)
        W[:] = 0.0
        for i in range(k):
            F, closed = _function(of, i)
            step[i] = -F / YIELD if closed else -F
            add_response(responses, i, 0, step[i], W)
            if not closed:
                continue
            for s in range(rows.first[i], rows.first[i + 1]):
                for a in range(6):
                    scaled[0, a] = rows.values[s, 0, a] / (YIELD * of.own[i])
                column = pattern.position[rows.nodes[s]]
                for t in range(responses.first[i], responses.first[i + 1]):
                    row = pattern.position[responses.nodes[t]]
                    add_block(pattern, factors, row, column, responses.values[t], scaled)
        factorise(pattern, factors, where, workspace)
        solve_nodes(pattern, factors, W, w, workspace)
        for i in range(k):
            if _function(of, i)[1]:
                step[i] -= along(rows, i, W, 0) / (YIELD * of.own[i])
        _search(of, k, step, square)
    of.moved[:] = moved
    for i in range(k):
        of.nu[of.pairs[i]] = max(0.0, kept[i])
        add_response(responses, i, 0, max(0.0, -kept[i]), of.moved)
