"""Corrections of a step by a matrix that is kept, and when the step is at its end.

What ages of a kept matrix first are the constraints, for bodies turn against each other; and the
rotations of dissipation were never in it. Of what is not in it products are needed, no factors::

    x = S⁻¹ r − S⁻¹ ΔS (S⁻¹ r) + …

The border of ``ΔS`` has rows at the end of the step and columns in its middle. The series is cut
off where the rest is as small as what else is not in the matrix.

A step is at its end when nothing but round-off changes any more. Increments fall until they are
noise, and where that begins depends on the scene. What was reached before is reached again; what
does not fall any more, and is as small as an increment can be, is noise; and what does not fall and
is larger may be, which the loop then asks for.
"""

from __future__ import annotations

from math import log, sqrt

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined
from fem_lie.linear.factors import PlainFactors, solve
from fem_lie.solve.conserving.step.records import Legs, solution_of

MOST = 4
"""Terms of the series, at most."""
CLOSE, NEARLY = 1e-6, 1e-4
"""Terms that are left out, over the first one: in the first correction of a step, and later."""
_ALIKE, _SHARE = 0.2, 0.5
"""How much corrections in one direction differ, and the most that one may leave over."""
FALLS = 0.5
"""Where terms do not fall by this factor the series says nothing."""
STEPS, ITERATION, TOTAL, BEST, ASKED, STALLS, LAST = 0, 1, 2, 3, 4, 5, 6
"""Counters: steps made, iterations of the present one and of all, fewest, iteration agreed on,
iterations since the increment fell to its least, and iterations of the last step."""
PREVIOUS, RATIO, MOTION, EXCESS, INCREMENT, LEAST, FLOOR, MARK, FELT = 0, 1, 2, 3, 4, 5, 6, 7, 8
ASIDE = 9
"""Numbers: last increment, ratio, largest motion, iterations beyond the fewest, increment, the
least of the present step, the least that round-off lets one expect, that of ``patience``
iterations before, what round-off was seen to make of it in this step, and by how much terms fell of
what is beside the matrix."""
UNKNOWN, NEW = 0, -1
"""Instead of the fewest iterations: none was counted with this matrix, none of a whole step."""
ULPS = 1e3 * float(np.finfo(np.float64).eps)
"""Increments, in lengths of the model, that may be round-off."""
FINE = 1e-2 * ULPS
"""Increments that are."""
SURE = 1e-3
"""Ratio of increments that is not asked for again at the last digits."""
_STAGNANT = 6
"""Iterations of a step without progress."""
STALLED = 0.8
"""Ratio of increments that is no progress any more."""


@compiled
def correction(
    measure: Array,
    scale: Array,
    r: Array,
    factors: PlainFactors,
    legs: Legs,
    aside: tuple[Array, Array],
    enough: tuple[float, float, float],
) -> tuple[float, int, float]:
    """Solve for the correction.

    Args:
        measure: Size of each unknown and scaled multiplier.
        scale: Factor of each constraint.
        r: :class:`~fem_lie.solve.conserving.step.records.Solution` of the equations.
        factors: Of the matrix.
        legs: Which nodes the constraints touch.
        aside: What is not in the matrix: change of the border since it was made, (2, legs, 6), and
            that of :func:`~fem_lie.solve.conserving.step.dissipation.set_turnings`.
        enough: What may be left out, over the first term, and in lengths, and by how much terms
            fell before.

    Returns:
        The size of its largest part, how many terms of the series were taken, and by how much they
        fell.
    """
    residual, x, work, rest, term = solution_of(r)
    solve(factors, residual, work, x)
    first = size(measure, x)
    (change, turnings), (close, fine, falls) = aside, enough
    if change.shape[1] == 0 and turnings.shape[1] == 0:
        return first, 0, falls
    if first * falls <= fine:
        return first, 0, falls
    before, put, allowed = first, x, max(close * first, fine)
    for k in range(MOST):
        _multiply(legs, scale, change, put, rest)
        for c in range(turnings.shape[1]):
            along = 0.0
            for i in range(turnings.shape[2]):
                along += turnings[0, c, i] * put[i]
            for i in range(turnings.shape[2]):
                rest[i] -= along * turnings[1, c, i]
        solve(factors, rest, work, term)
        now = size(measure, term)
        if not now < FALLS * before:
            return size(measure, x), k + 1, 1.0
        for i in range(x.shape[0]):
            x[i] += term[i]
        falls = now / before
        if now * falls <= allowed:
            return size(measure, x), k + 1, falls
        before, put = now, term
    return size(measure, x), MOST, falls


@compiled
def growth(
    measure: Array,
    scale: Array,
    r: Array,
    factors: PlainFactors,
    legs: Legs,
    change: Array,
    probe: Array,
) -> float:
    """Ratio of the terms for old constraints in the direction in which they fall the least.

    What an iteration does in other directions than that of its residual is not seen in it before
    round-off has grown there. Where it is 1 or more next to a posture in which constraints lose
    rank, the step ends in another branch.

    Args:
        measure: Size of each unknown and scaled multiplier.
        scale: Factor of each constraint.
        r: :class:`~fem_lie.solve.conserving.step.records.Solution` of the equations, of which
            nothing but memory is used.
        factors: Of the matrix.
        legs: Which nodes the constraints touch.
        change: Of the border since the matrix was made, (2, legs, 6).
        probe: That direction, by one step of the power method more each time, (6 n + m,), updated.
    """
    _, _, work, rest, term = solution_of(r)
    _multiply(legs, scale, change, probe, rest)
    solve(factors, rest, work, term)
    grown = size(measure, term)
    if grown > 0.0:
        for k in range(probe.shape[0]):
            probe[k] = term[k] / grown
    return grown


@compiled
def hasten(
    measure: Array, x: Array, slow: Array, known: Array, flags: tuple[bool, bool], fine: float
) -> None:
    """Add to a correction what those would add that go on in one direction.

    The factor β of dissipation makes one direction of the matrix wrong, by a few per cent: of what
    is wrong there the same share is left by each correction, and that is a geometric series.

    Args:
        measure: Size of each unknown and scaled multiplier.
        x: Correction, updated.
        slow: That direction, of unit length, and the correction before, (2, size), updated.
        known: The share, and how much was added before along the direction, (2,), updated.
        flags: Whether β is less than one, and whether the correction is the first one of a step.
        fine: What of it is round-off.
    """
    (direction, before), (cut, first) = (slow[0], slow[1]), flags
    if cut and not first and size(measure, x) > fine:
        # what the correction before has left over, of all that was made
        left = x + known[1] * direction
        square = _dot(measure, before, before)
        share = _dot(measure, left, before) / square
        aside = left - share * before
        alike = _dot(measure, aside, aside) <= _ALIKE**2 * _dot(measure, left, left)
        if alike and abs(share) < _SHARE:
            known[0] = share
            for k in range(x.shape[0]):
                direction[k] = before[k] / sqrt(square)
        elif _dot(measure, before, direction) ** 2 > 0.5 * square:
            known[0] = 0.0
    along, known[1] = _dot(measure, x, direction), 0.0
    if cut and along * along > 0.5 * _dot(measure, x, x):
        known[1] = known[0] / (1.0 - known[0]) * along
    for k in range(x.shape[0]):
        x[k] += known[1] * direction[k]
        before[k] = x[k]


@inlined
def _dot(measure: Array, x: Array, y: Array) -> float:
    total = 0.0
    for k in range(x.shape[0]):
        total += (measure[k] * x[k]) * (measure[k] * y[k])
    return total


@inlined
def size(measure: Array, x: Array) -> float:
    """Of the largest part; not a number, if any is."""
    largest = 0.0
    for k in range(x.shape[0]):
        part = abs(x[k]) * measure[k]
        if part > largest or part != part:
            largest = part
    return largest


@inlined
def _multiply(legs: Legs, scale: Array, change: Array, x: Array, out: Array) -> None:
    """``out = −ΔS x``."""
    out[:] = 0.0
    n6 = x.shape[0] - scale.shape[0]
    for leg in range(legs.nodes.shape[0]):
        i, c = 6 * legs.nodes[leg], legs.constraints[leg]
        total, weight = 0.0, scale[c] * x[n6 + c]
        for k in range(6):
            total += change[0, leg, k] * x[i + k]
            out[i + k] -= change[1, leg, k] * weight
        out[n6 + c] -= scale[c] * total


@inlined
def lags(numbers: Array, tolerance: float, patience: int, spare: float) -> bool:
    """Whether at its present rate the iteration would go on for more than ``spare`` iterations."""
    increment, before = numbers[INCREMENT], numbers[MARK]
    numbers[MARK] = increment
    target = max(tolerance * numbers[MOTION], numbers[FLOOR], FINE)
    if increment <= ULPS or increment <= target:
        return False
    rate = log(increment / before) / patience
    return rate >= 0.0 or log(target / increment) < spare * rate


@inlined
def count(counters: Indices, numbers: Array) -> None:
    """Note what the step that ends took beyond the fewest iterations with the present matrix.

    One that was made within this step is not known yet.
    """
    counted = max(counters[ITERATION], 2)
    counters[LAST] = counters[ITERATION]
    if counters[BEST] == NEW:
        counters[BEST] = UNKNOWN
        return
    if counters[BEST] == UNKNOWN or counted < counters[BEST]:
        counters[BEST] = counted
    numbers[EXCESS] += counted - counters[BEST]


@inlined
def settled(counters: Indices, numbers: Array) -> bool:
    """Whether only round-off is left: it falls no more, or is as small as where it fell no more."""
    increment, least = numbers[INCREMENT], numbers[LEAST]
    if increment > STALLED * least:
        counters[STALLS] += 1
    else:
        counters[STALLS] = 0
    numbers[LEAST] = min(increment, least)
    if increment <= 2.0 * numbers[FLOOR]:
        # a lucky zero must not make the next steps wait for another
        numbers[FLOOR] = max(min(increment, numbers[FLOOR]), 0.9 * numbers[FLOOR])
        return True
    if increment > ULPS or counters[STALLS] < (2 if increment < FINE else _STAGNANT):
        return False
    numbers[FLOOR] = numbers[LEAST]
    return True


@inlined
def stagnates(counters: Indices, numbers: Array) -> bool:
    """Whether increments have ceased to fall where it is not known to be round-off."""
    increment = numbers[INCREMENT]
    return counters[STALLS] >= _STAGNANT and increment > ULPS


@inlined
def converged(numbers: Array, tolerance: float, iteration: int, known: bool) -> bool:
    """Whether what would follow is below the tolerance, or round-off, or nothing would.

    Round-off is told by the rate where the matrix is ``known`` to be good. Next to postures in
    which constraints lose rank it is not: increments are small there, and what is missing is not.
    """
    increment = numbers[INCREMENT]
    if iteration > 1 and (tolerance > 0.0 or (known and numbers[FLOOR] > 0.0)):
        ratio = max(increment / numbers[PREVIOUS], 0.7 * numbers[RATIO])
        numbers[RATIO] = ratio
        if tolerance == 0.0:
            # the last digits come the slowest
            ratio = max(ratio, SURE)
        allowed = max(tolerance * numbers[MOTION], 2.0 * numbers[FLOOR])
        if ratio < 1.0 and increment * ratio / (1.0 - ratio) <= allowed:
            return True
    return increment == 0.0
