"""Newton's method on ``0 ≤ ν ⊥ g ≥ 0`` of many contacts, with sparse factors."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
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
from fem_lie.contact.cones.jacobian import BlockRows, add_response, along

_BISECTIONS, _PATIENCE = 30, 8
"""Bisections in a line search; iterations without a smaller error, at the least compliance."""

_FIRST, _LESS, _LEAST, _PART = 1e-2, 0.1, 1e-8, 0.1
"""Compliance of gaps in the first proximal step, relative to their own response; ratio of that in
the next step; the least one; error of a proximal step relative to that of the gaps at its end."""


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


class _Elimination(NamedTuple):
    """Factors of Newton's matrix, and the workspace of a solution with them.

    Attributes:
        pattern: Blocks of the factors.
        factors: Matrix, then its factors.
        W: Right-hand side, then displacements of the nodes, shape (n, 6).
        w: The same by positions, shape (n, 6).
        scaled: A row over the compliance of its contact, shape (1, 6).
        where: Workspace, shape (n,).
        workspace: Workspace, shape (6, 12).
    """

    pattern: Pattern
    factors: Factors
    W: Array
    w: Array
    scaled: Array
    where: Indices
    workspace: Array


class _Proximal(NamedTuple):
    """A proximal step: gaps yield to changes of their impulses.

    Attributes:
        before: Impulses at its start, shape (k,).
        g: Gaps, shape (k,).
        step: Newton's step of the impulses, shape (k,).
        rates: Change of the gaps in it, shape (k,).
    """

    before: Array
    g: Array
    step: Array
    rates: Array


@inlined_uncounted
def _impulse(of: Gaps, at: _Proximal, soft: float, i: int, g: float) -> float:
    """Position impulse of a contact with gap ``g`` that yields to changes from ``before``."""
    return max(0.0, at.before[i] - g / (soft * of.own[i]))


@uncounted
def _set_gaps(of: Gaps, k: int, g: Array) -> float:
    """Set the gaps of all contacts; largest error of ``0 ≤ ν ⊥ g ≥ 0``, in closed gaps."""
    worst = 0.0
    for i in range(k):
        pair = of.pairs[i]
        g[i] = of.separation[pair] + along(of.rows, i, of.moved, 0)
        worst = max(worst, abs(min(g[i], of.nu[pair] * of.own[i])) / of.closed[pair])
    return worst


@uncounted
def _set_changes(of: Gaps, k: int, at: _Proximal, soft: float) -> float:
    """Set ``step`` to the changes of the impulses that the gaps cause; their error, as gaps."""
    worst = 0.0
    for i in range(k):
        pair = of.pairs[i]
        caused = _impulse(of, at, soft, i, at.g[i])
        at.step[i] = caused - of.nu[pair]
        gap = abs(at.step[i]) * of.own[i] * (soft if caused > 0.0 else 1.0)
        worst = max(worst, gap / of.closed[pair])
    return worst


@uncounted
def _set_step(of: Gaps, k: int, at: _Proximal, soft: float, work: _Elimination) -> None:
    """Replace the changes of the impulses by Newton's step."""
    pattern, factors, rows, responses = work.pattern, work.factors, of.rows, of.responses
    set_identity(factors)
    work.W[:] = 0.0
    for i in range(k):
        add_response(responses, i, 0, at.step[i], work.W)
        if _impulse(of, at, soft, i, at.g[i]) == 0.0:
            continue
        for s in range(rows.first[i], rows.first[i + 1]):
            for a in range(6):
                work.scaled[0, a] = rows.values[s, 0, a] / (soft * of.own[i])
            column = pattern.position[rows.nodes[s]]
            for t in range(responses.first[i], responses.first[i + 1]):
                row = pattern.position[responses.nodes[t]]
                add_block(pattern, factors, row, column, responses.values[t], work.scaled)
    factorise(pattern, factors, work.where, work.workspace)
    solve_nodes(pattern, factors, work.W, work.w, work.workspace)
    for i in range(k):
        at.rates[i] = along(rows, i, work.W, 0)
        if _impulse(of, at, soft, i, at.g[i]) > 0.0:
            at.step[i] -= at.rates[i] / (soft * of.own[i])


@uncounted
def _slope(of: Gaps, k: int, at: _Proximal, soft: float, part: float) -> float:
    """Derivative of the potential along the step, after ``part`` of it."""
    total = 0.0
    for i in range(k):
        caused = _impulse(of, at, soft, i, at.g[i] + part * at.rates[i])
        total += at.rates[i] * (of.nu[of.pairs[i]] + part * at.step[i] - caused)
    return total


@uncounted
def _make_step(of: Gaps, k: int, at: _Proximal, soft: float) -> None:
    """Make the part of the step at which the convex potential is least, at most all of it."""
    low, high = 0.0, 1.0
    if _slope(of, k, at, soft, 1.0) > 0.0:
        for _ in range(_BISECTIONS):
            middle = 0.5 * (low + high)
            if _slope(of, k, at, soft, middle) > 0.0:
                high = middle
            else:
                low = middle
    for i in range(k):
        of.nu[of.pairs[i]] += high * at.step[i]
        add_response(of.responses, i, 0, high * at.step[i], of.moved)


@compiled
def separate(of: Gaps, k: int, enough: float, most: int) -> None:
    """Proximal steps by Newton's method, if factors are not dearer than sweeps.

    In each step gaps yield to changes of their impulses, so that the displacements minimise a
    convex potential with continuous derivatives, and Newton's method with an exact line search
    converges, however redundant the contacts are. The next step starts from these impulses, with a
    smaller compliance (R. T. Rockafellar, Math. Oper. Res. 1 (1976) 97). The result is the iterate
    of the least error.

    Args:
        of: Contacts.
        k: Number of contacts.
        enough: Largest error that is sufficient, in gaps of closed contacts.
        most: Largest number of iterations of Newton's method.
    """
    n = of.moved.shape[0]
    pattern = pattern_of(*neighbours_of(of.rows, of.responses, k, n))
    if products_of(pattern) > DEAR * k:
        return
    W, w, scaled = np.empty((n, 6)), np.zeros((n, 6)), np.empty((1, 6))
    factors, where = empty_factors(n, len(pattern.later)), np.zeros(n, np.int64)
    work = _Elimination(pattern, factors, W, w, scaled, where, np.zeros((6, 12)))
    at = _Proximal(np.empty(k), np.empty(k), np.empty(k), np.empty(k))
    error, kept, moved = _set_gaps(of, k, at.g), np.empty(k), of.moved.copy()
    least, since, soft = error, 0, _FIRST
    for i in range(k):
        at.before[i] = kept[i] = of.nu[of.pairs[i]]
    for _ in range(most):
        if least <= enough or since == _PATIENCE:
            break
        if _set_changes(of, k, at, soft) <= _PART * error:
            soft = max(_LEAST, _LESS * soft)
            for i in range(k):
                at.before[i] = of.nu[of.pairs[i]]
            _set_changes(of, k, at, soft)
        _set_step(of, k, at, soft, work)
        _make_step(of, k, at, soft)
        error = _set_gaps(of, k, at.g)
        since += soft == _LEAST
        if error < least:
            least, since = error, 0
            moved[:] = of.moved
            for i in range(k):
                kept[i] = of.nu[of.pairs[i]]
    of.moved[:] = moved
    for i in range(k):
        of.nu[of.pairs[i]] = max(0.0, kept[i])
        add_response(of.responses, i, 0, max(0.0, -kept[i]), of.moved)
