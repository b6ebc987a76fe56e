"""When a step of a conserving scheme is at its end: nothing but round-off changes any more.

Increments fall until they are noise, and where that begins depends on the scene. What was reached
before is reached again; what does not fall any more, and is as small as an increment can be, is
noise; and what does not fall and is larger may be, which the loop then asks for.
"""

from __future__ import annotations

from math import log

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined

STEPS, ITERATION, TOTAL, BEST, ASKED, STALLS, LAST = 0, 1, 2, 3, 4, 5, 6
"""Counters: steps made, iterations of the present one and of all, fewest, iteration agreed on,
iterations since the increment fell to its least, and iterations of the last step."""
PREVIOUS, RATIO, MOTION, EXCESS, INCREMENT, LEAST, FLOOR, MARK, FELT = 0, 1, 2, 3, 4, 5, 6, 7, 8
"""Numbers: last increment, ratio, largest motion, iterations beyond the fewest, increment, the
least of the present step, the least that round-off lets one expect, that of ``patience``
iterations before, and what round-off was seen to make of it in this step."""
UNKNOWN, NEW = 0, -1
"""Instead of the fewest iterations: none was counted with this matrix, none of a whole step."""
ULPS = 1e3 * float(np.finfo(np.float64).eps)
"""Increments, in lengths of the model, that may be round-off."""
FINE = 1e-2 * ULPS
"""Increments that are."""
_STAGNANT = 6
"""Iterations of a step without progress."""
STALLED = 0.8
"""Ratio of increments that is no progress any more."""


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
def converged(numbers: Array, tolerance: float, iteration: int) -> bool:
    """Whether what would follow is below the tolerance, or nothing would."""
    increment = numbers[INCREMENT]
    if tolerance > 0.0 and iteration > 1:
        ratio = max(increment / numbers[PREVIOUS], 0.7 * numbers[RATIO])
        numbers[RATIO] = ratio
        if ratio < 1.0 and increment * ratio / (1.0 - ratio) <= tolerance * numbers[MOTION]:
            return True
    return increment == 0.0
