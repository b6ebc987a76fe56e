"""Corrections of a step with a frozen matrix, by a series for its changes.

The first part of a frozen matrix that becomes outdated is the constraint Jacobian, because bodies
rotate against each other; and the rotations of dissipation were never in it. These changes ``ΔS``
enter by products only, without factors::

    x = S⁻¹ r − S⁻¹ ΔS (S⁻¹ r) + …

The constraint block of ``ΔS`` has rows at the end of the step and columns at its midpoint. The
series is truncated when the remainder is as small as other changes of the matrix.

Constraints involve the unknowns of few nodes, and in these ``S⁻¹ ΔS`` is a small dense matrix: all
terms together cost less than one solution, and one solution is made for their sum.
"""

from __future__ import annotations

from fem_lie._arrays import Array
from fem_lie._jit import compiled, inlined, uncounted
from fem_lie._jit.call_back import call_back
from fem_lie._jit.copies import copy_vector
from fem_lie._jit.stack import matrix_at, stack, vector_at
from fem_lie.linear.factors import PlainFactors, solve
from fem_lie.solve.conserving.step.corrections import size
from fem_lie.solve.conserving.step.ranks import Ranks, add_up, largest, solves
from fem_lie.solve.conserving.step.records import (
    SOLVE,
    IncidencePositions,
    Incidences,
    solution_of,
)

MOST, MOST_DENSE = 4, 12
"""Largest number of terms, and the same with a dense matrix."""
DENSE = 60
"""Largest number of unknowns in constraints for which the dense matrix is faster than solutions."""
WHOLE = 50_000
"""Largest number of entries of complete columns of the inverse that are faster than a solution."""
CLOSE, NEARLY = 1e-6, 1e-4
"""Terms that are left out, relative to the first one: in the first correction of a step, and
later."""
FALLS = 0.5
"""Ratio of successive terms above which the series does not converge."""


@uncounted
def correction(
    measure: Array,
    scale: Array,
    r: Array,
    solver: tuple[PlainFactors, Ranks],
    incidences: Incidences,
    ends: IncidencePositions,
    aside: tuple[Array, Array],
    enough: tuple[float, float, float],
) -> tuple[float, int, float]:
    """Solve for the correction.

    Args:
        measure: Norm weight of each unknown and scaled multiplier.
        scale: Scale of each constraint.
        r: :class:`~fem_lie.solve.conserving.step.records.Solution` of the equations.
        solver: Factors of the matrix, and ranks that solve together instead, which have no
            incidences.
        incidences: Constraint-node incidences.
        ends: Their positions in the dense inverse, if there is one.
        aside: Changes of the matrix: of its constraint block, (2, incidences, 6), and those of
            :func:`~fem_lie.solve.conserving.step.dissipation.set_turnings`.
        enough: Size of terms that may be left out, over the first term, and in lengths, and the
            previous reduction per term.

    Returns:
        The size of the largest part, the number of terms, and the reduction per term.
    """
    (residual, x, work, rest, term), (factors, ranks) = solution_of(r), solver
    _solve(solver, residual, work, x)
    first = largest(ranks, size(measure, x))
    (change, turnings), (close, fine, falls) = aside, enough
    if change.shape[1] == 0 and turnings.shape[1] == 0:
        return first, 0, falls
    if first * falls <= fine:
        return first, 0, falls
    allowed = max(close * first, fine)
    if ends.inverse.shape[0] > 0 and turnings.shape[1] == 0:
        terms, falls = _all_terms(measure, scale, r, incidences, ends, change, (first, allowed))
        if ends.columns.shape[0] > 0:
            _add_columns(ends, rest, x)
        else:
            solve(factors, rest, work, term)
            for i in range(x.shape[0]):
                x[i] += term[i]
        return size(measure, x), terms, falls
    before, put = first, x
    for k in range(MOST):
        _multiply(incidences, scale, change, put, rest)
        _turn(turnings, put, ranks, rest)
        _solve(solver, rest, work, term)
        now = largest(ranks, size(measure, term))
        if not now < FALLS * before:
            return largest(ranks, size(measure, x)), k + 1, 1.0
        for i in range(x.shape[0]):
            x[i] += term[i]
        falls = now / before
        if now * falls <= allowed:
            return largest(ranks, size(measure, x)), k + 1, falls
        before, put = now, term
    return largest(ranks, size(measure, x)), MOST, falls


@inlined
def _solve(solver: tuple[PlainFactors, Ranks], b: Array, work: Array, x: Array) -> None:
    """``x = S⁻¹ b``, by the factors of this rank or by all ranks together."""
    factors, ranks = solver
    if not solves(ranks):
        solve(factors, b, work, x)
        return
    copy_vector(b, work)
    call_back(ranks.addresses[SOLVE])
    copy_vector(work, x)


@uncounted
def _turn(turnings: Array, x: Array, ranks: Ranks, out: Array) -> None:
    """``out −= Y Zᵀ x``, with ``Z`` and ``Y`` of all ranks in ``turnings`` (2, 3, 6 n)."""
    if turnings.shape[1] == 0:
        return
    along = vector_at(stack(3), 3)
    for c in range(3):
        along[c] = 0.0
        for i in range(turnings.shape[2]):
            along[c] += ranks.owned[i // 6] * turnings[0, c, i] * x[i]
    add_up(ranks, along)
    for c in range(3):
        for i in range(turnings.shape[2]):
            out[i] -= along[c] * turnings[1, c, i]


@uncounted
def _all_terms(
    measure: Array,
    scale: Array,
    r: Array,
    incidences: Incidences,
    ends: IncidencePositions,
    change: Array,
    enough: tuple[float, float],
) -> tuple[int, float]:
    """Right-hand side of the sum of all terms, into ``rest``; returns their number and reduction.

    Args:
        measure: See :func:`correction`.
        scale: See :func:`correction`.
        r: Solution with the first term.
        incidences: Constraint-node incidences.
        ends: Their positions in the dense inverse.
        change: Change of the constraint block, (2, incidences, 6).
        enough: Size of the first term, and size of terms that may be left out.
    """
    _, x, _, rest, _ = solution_of(r)
    (before, allowed), count = enough, ends.inverse.shape[0]
    workspace = matrix_at(stack(4 * DENSE), 4, DENSE)
    sizes, y, d, total = (
        workspace[0, :count],
        workspace[1, :count],
        workspace[2, :count],
        workspace[3, :count],
    )
    for a in range(count):
        sizes[a], y[a], total[a] = measure[ends.unknowns[a]], x[ends.unknowns[a]], 0.0
    terms, falls = 0, 1.0
    while terms < MOST_DENSE:
        terms += 1
        _push(incidences, ends, scale, change, y, d)
        _answer(ends.inverse, d, y)
        now = size(sizes, y)
        if not now < FALLS * before:
            falls = 1.0
            break
        for a in range(count):
            total[a] += d[a]
        falls = now / before
        if now * falls <= allowed:
            break
        before = now
    for i in range(rest.shape[0]):
        rest[i] = 0.0
    for a in range(count):
        rest[ends.unknowns[a]] = total[a]
    return terms, falls


@uncounted
def _add_columns(ends: IncidencePositions, rest: Array, x: Array) -> None:
    """``x += S⁻¹ rest``, with ``rest`` nonzero in the unknowns of ``ends`` only; four at a time."""
    columns, unknowns = ends.columns, ends.unknowns
    count = columns.shape[0]
    for a in range(0, count - 3, 4):
        c0, c1, c2, c3 = columns[a], columns[a + 1], columns[a + 2], columns[a + 3]
        f0, f1 = rest[unknowns[a]], rest[unknowns[a + 1]]
        f2, f3 = rest[unknowns[a + 2]], rest[unknowns[a + 3]]
        for i in range(x.shape[0]):
            x[i] += (f0 * c0[i] + f1 * c1[i]) + (f2 * c2[i] + f3 * c3[i])
    for a in range(count - count % 4, count):
        factor, column = rest[unknowns[a]], columns[a]
        for i in range(x.shape[0]):
            x[i] += factor * column[i]


@uncounted
def growth(
    measure: Array,
    scale: Array,
    r: Array,
    factors: PlainFactors,
    incidences: Incidences,
    ends: IncidencePositions,
    change: Array,
    probe: Array,
) -> float:
    """Ratio of successive series terms in the direction in which they decrease least.

    An error of the iteration in other directions than its residual appears only after round-off has
    grown there. If the ratio is 1 or more near a configuration in which constraints lose rank, the
    step converges to another branch.

    Args:
        measure: Norm weight of each unknown and scaled multiplier.
        scale: Scale of each constraint.
        r: :class:`~fem_lie.solve.conserving.step.records.Solution` of the equations, used as
            workspace.
        factors: Factors of the matrix.
        incidences: Constraint-node incidences.
        ends: Their positions in the dense inverse: if there is one, only these unknowns are
            examined.
        change: Change of the constraint block, (2, incidences, 6).
        probe: That direction, (6 n + m,), updated by one step of the power method.
    """
    _, _, work, rest, term = solution_of(r)
    count = ends.inverse.shape[0]
    if count > 0:
        workspace = matrix_at(stack(3 * DENSE), 3, DENSE)
        sizes, given, d = workspace[0, :count], workspace[1, :count], workspace[2, :count]
        for a in range(count):
            sizes[a], given[a] = measure[ends.unknowns[a]], probe[ends.unknowns[a]]
        _push(incidences, ends, scale, change, given, d)
        _answer(ends.inverse, d, given)
        grown = size(sizes, given)
        if grown > 0.0:
            for a in range(count):
                probe[ends.unknowns[a]] = given[a] / grown
        return grown
    _multiply(incidences, scale, change, probe, rest)
    solve(factors, rest, work, term)
    grown = size(measure, term)
    if grown > 0.0:
        for k in range(probe.shape[0]):
            probe[k] = term[k] / grown
    return grown


@compiled
def set_inverse(factors: PlainFactors, ends: IncidencePositions, r: Array) -> None:
    """Set the inverse in the unknowns of ``ends``; ``r`` is workspace."""
    _, _, work, rest, term = solution_of(r)
    unknowns, whole = ends.unknowns, ends.columns.shape[0] > 0
    rest[:] = 0.0
    for b in range(unknowns.shape[0]):
        rest[unknowns[b]] = 1.0
        solve(factors, rest, work, term)
        rest[unknowns[b]] = 0.0
        for a in range(unknowns.shape[0]):
            ends.inverse[b, a] = term[unknowns[a]]
        if whole:
            copy_vector(term, ends.columns[b])


@inlined
def _push(
    incidences: Incidences,
    ends: IncidencePositions,
    scale: Array,
    change: Array,
    y: Array,
    out: Array,
) -> None:
    """``out = −ΔS y`` among the unknowns of ``ends``, (k,)."""
    for a in range(out.shape[0]):
        out[a] = 0.0
    for incidence in range(incidences.nodes.shape[0]):
        i, at = ends.at[0, incidence], ends.at[1, incidence]
        factor, total = scale[incidences.constraints[incidence]], 0.0
        weight = factor * y[at]
        for k in range(6):
            total += change[0, incidence, k] * y[i + k]
            out[i + k] -= change[1, incidence, k] * weight
        out[at] -= factor * total


@inlined
def _answer(inverse: Array, d: Array, out: Array) -> None:
    """``out = S⁻¹ d`` among the same unknowns; rows of ``inverse`` are columns of ``S⁻¹``."""
    for a in range(out.shape[0]):
        out[a] = 0.0
    for b in range(d.shape[0]):
        column, factor = inverse[b], d[b]
        for a in range(out.shape[0]):
            out[a] += factor * column[a]


@inlined
def _multiply(incidences: Incidences, scale: Array, change: Array, x: Array, out: Array) -> None:
    """``out = −ΔS x``."""
    out[:] = 0.0
    n6 = x.shape[0] - scale.shape[0]
    for incidence in range(incidences.nodes.shape[0]):
        i, c = 6 * incidences.nodes[incidence], incidences.constraints[incidence]
        total, weight = 0.0, scale[c] * x[n6 + c]
        for k in range(6):
            total += change[0, incidence, k] * x[i + k]
            out[i + k] -= change[1, incidence, k] * weight
        out[n6 + c] -= scale[c] * total
