"""When corrections of a step are at their end, and how those in one direction are hastened.

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
from fem_lie.lie.node_types.node_type import POSITION_GRADIENT
from fem_lie.solve.convergence import DIVERGED, contraction, to_come

_ALIKE, _SHARE = 0.2, 0.5
"""How much corrections in one direction differ, and the most that one may leave over."""
STEPS, ITERATION, TOTAL, BEST, ASKED, STALLS, LAST, NEEDED = 0, 1, 2, 3, 4, 5, 6, 7
GROWTHS, COUNTERS = 8, 9
"""Counters: steps made, iterations of the present one and of all, fewest, iteration agreed on,
iterations since the increment fell to its least, iterations of the last step, those of the
present one from whose outcome a better matrix would have had anything to gain, and the last
iterations, one after the other, each with a larger increment than the one before; shape (9,)."""
PREVIOUS, RATIO, MOTION, EXCESS, INCREMENT, LEAST, FLOOR, MARK, FELT = 0, 1, 2, 3, 4, 5, 6, 7, 8
ASIDE, RECENT, HISTORY = 9, 10, 18
"""Numbers: last increment, ratio, largest motion, iterations beyond the fewest, increment, the
least of the present step, the least that round-off lets one expect, that of ``patience``
iterations before, what round-off was seen to make of it in this step, by how much terms fell of
what is beside the matrix, the last :data:`LEARNING` increments of nodes that are no frames, the
newest first, and the last :data:`LOST` increments in a ring; shape (:data:`NUMBERS`,)."""
WINDOW, LEARNING, HALVED = 3, 8, 0.5
"""Small increments are round-off where so many iterations did not bring them below that part of
themselves; for nodes with vector coordinates. Corrections that learn from each other go up and down
and are given more of them."""
LOST = 25
"""Iterations that do not bring increments beyond round-off below half lead to no solution, where
there are such nodes."""
NUMBERS = HISTORY + LOST
_GROWING = 7
"""Increments in a row that grow lead to none either."""
UNKNOWN, NEW = 0, -1
"""Instead of the fewest iterations: none was counted with this matrix, none of a whole step."""
ULPS = 1e3 * float(np.finfo(np.float64).eps)
"""Increments, in lengths of the model, that may be round-off."""
FINE = 1e-2 * ULPS
"""Increments that are."""
SURE = 1e-3
"""Ratio of increments that is not asked for again at the last digits."""
_FLIPS, _SHORTER, _FARTHEST = 3, 0.5, 0.05
"""Increments with contacts that fell no more, after which corrections are shortened to this
fraction, and the largest increment of an iteration, in lengths of the model: beyond it, other
contacts act."""
_STAGNANT = 6
"""Iterations of a step without progress."""
STALLED = 0.8
"""Ratio of increments that is no progress any more."""


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


@compiled
def size_of(measure: Array, x: Array) -> float:
    """:func:`size`, from Python."""
    return size(measure, x)


@inlined
def lags(numbers: Array, tolerance: float, patience: int, spare: float, round_off: float) -> bool:
    """Whether at its present rate the iteration would go on for more than ``spare`` iterations.

    Increments below ``round_off`` are noise.
    """
    increment, before = numbers[INCREMENT], numbers[MARK]
    numbers[MARK] = increment
    target = max(tolerance * numbers[MOTION], numbers[FLOOR], round_off)
    if increment <= ULPS or increment <= target:
        return False
    rate = log(increment / before) / patience
    return rate >= 0.0 or log(target / increment) < spare * rate


@inlined
def count(counters: Indices, numbers: Array) -> None:
    """Note what the step that ends took beyond the fewest iterations with the present matrix.

    One that was made within this step is not known yet.
    """
    counted = max(counters[NEEDED], 2)
    counters[LAST] = counters[ITERATION]
    if counters[BEST] == NEW:
        counters[BEST] = UNKNOWN
        return
    if counters[BEST] == UNKNOWN or counted < counters[BEST]:
        counters[BEST] = counted
    numbers[EXCESS] += counted - counters[BEST]


@inlined
def settled(counters: Indices, numbers: Array, steadily: bool) -> bool:
    """Whether only round-off is left: it falls no more, or is as small as where it fell no more.

    With ``steadily`` increments are compared with the one that has last fallen: those that fall
    slowly, but steadily, are no round-off.
    """
    increment, least = numbers[INCREMENT], numbers[LEAST]
    if increment > STALLED * least:
        counters[STALLS] += 1
        if steadily:
            increment = least
    else:
        counters[STALLS] = 0
    numbers[LEAST] = min(increment, least)
    increment = numbers[INCREMENT]
    if increment <= 2.0 * numbers[FLOOR]:
        # a lucky zero must not make the next steps wait for another
        numbers[FLOOR] = max(min(increment, numbers[FLOOR]), 0.9 * numbers[FLOOR])
        return True
    if increment > ULPS or counters[STALLS] < (2 if increment < FINE else _STAGNANT):
        return False
    numbers[FLOOR] = numbers[LEAST]
    return True


@inlined
def shorten(x: Array, increment: float, stalls: int) -> None:
    """Shorten a correction ``x`` of a step in which contacts act, whose size is ``increment``.

    Contacts that stick and slip in turns are met between both.
    """
    factor = _SHORTER if stalls >= _FLIPS else 1.0
    if increment > _FARTHEST:
        factor = min(factor, _FARTHEST / increment)
    if factor < 1.0:
        for k in range(x.shape[0]):
            x[k] *= factor


@inlined
def larger(a: float, b: float) -> float:
    """The larger one of two numbers; not a number, if either is."""
    return b if b > a or b != b else a


@inlined
def size_of_vectors(kinds: Indices, measure: Array, x: Array) -> float:
    """Of the largest part of a correction ``x`` of nodes that are no frames; as :func:`size`."""
    largest = 0.0
    for i in range(kinds.shape[0]):
        if kinds[i] >= POSITION_GRADIENT:
            part = size(measure[6 * i : 6 * i + 6], x[6 * i : 6 * i + 6])
            if part > largest or part != part:
                largest = part
    return largest


@inlined
def stalls(numbers: Array, increment: float, window: int) -> bool:
    """Whether an increment is more than half of the one ``window`` iterations before; records it.

    Stiff cells feel increments that still fall, however small these are, as forces. So nodes with
    vector coordinates are corrected while they fall, and where an earlier step has ended is no
    measure of round-off in this one.
    """
    before = numbers[RECENT + window - 1]
    for k in range(LEARNING - 1, 0, -1):
        numbers[RECENT + k] = numbers[RECENT + k - 1]
    numbers[RECENT] = increment
    return increment > HALVED * before


@inlined
def is_lost(counters: Indices, numbers: Array, before: float) -> bool:
    """Whether the iteration leads to no solution, where nodes have vector coordinates.

    Its increments have not been halved for long, grow steadily, or leave the model.

    Args:
        counters: Updated.
        numbers: Updated.
        before: The increment before this one.
    """
    increment, at = numbers[INCREMENT], HISTORY + counters[ITERATION] % LOST
    counters[GROWTHS] = counters[GROWTHS] + 1 if increment > before else 0
    long_ago, numbers[at] = numbers[at], increment
    grows = counters[GROWTHS] >= _GROWING or not increment < DIVERGED
    return grows or increment > HALVED * long_ago


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
        ratio = contraction(increment, numbers[PREVIOUS], numbers[RATIO])
        numbers[RATIO] = ratio
        if tolerance == 0.0:
            # the last digits come the slowest
            ratio = max(ratio, SURE)
        allowed = max(tolerance * numbers[MOTION], 2.0 * numbers[FLOOR])
        if to_come(increment, ratio) <= allowed:
            return True
    return increment == 0.0
