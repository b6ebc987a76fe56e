"""When a step of a conserving scheme is at its end: nothing but round-off changes any more.

Increments fall until they are noise, and where that begins depends on the scene. What was reached
before is reached again; what does not fall any more, and is as small as an increment can be, is
noise; and what does not fall and is larger may be, which the loop then asks for.
"""

from __future__ import annotations

import numpy as np

from fem_lie._jit import Array, Indices, inlined
from fem_lie.solve.filtered import ACTIVE, FREE, MEMORY, WORKS

STEPS, ITERATION, TOTAL, BEST, ASKED, STALLS, LAST = 0, 1, 2, 3, 4, 5, 6
"""Counters: steps made, iterations of the present one and of all, fewest, iteration agreed on,
iterations of the present step that did not halve the increment, and iterations of the last step."""
PREVIOUS, RATIO, MOTION, EXCESS, INCREMENT, LEAST, FLOOR = 0, 1, 2, 3, 4, 5, 6
"""Numbers: last increment, ratio, largest motion, iterations beyond the fewest, increment, the
least of the present step, and the least that round-off lets one expect."""
ULPS = 1e3 * float(np.finfo(np.float64).eps)
"""Increments, in lengths of the model, that may be round-off."""
FINE = 1e-2 * ULPS
"""Increments that are."""
_SETTLE_MEMORY, _LATEST_MEMORY = 1e-6, 20
"""Increment over the largest motion, and iteration, from which the factor of the memory stays."""
_AGAIN = 6
"""How often that factor is found once more, in a step that has gained."""
_STAGNANT = 6
"""Iterations of a step without progress."""
STALLED = 0.8
"""Ratio of increments that is no progress any more."""


@inlined
def settle_memory(lag: Array, numbers: Array, iteration: int) -> None:
    """Let its factor be where it hardly changes any more: the iteration must come to an end."""
    if lag[FREE] > 1.0:
        lag[FREE] = 1.0 - lag[FREE]
    elif lag[FREE] == 1.0 and (
        iteration >= _LATEST_MEMORY or numbers[INCREMENT] < _SETTLE_MEMORY * numbers[MOTION]
    ):
        lag[FREE] = 0.0


@inlined
def loses(lag: Array, losses: Array) -> bool:
    """Whether the step has no numerical gain.

    If it has, it goes on with the memory that fits what was found, then with less, then with none.
    """
    if lag[ACTIVE] == 0.0 or losses[2] >= -1e-12 * abs(lag[WORKS]):
        return True
    if lag[FREE] > -_AGAIN:
        lag[FREE] = 2.0 - min(lag[FREE], 0.0)
        return False
    if lag[MEMORY] > 0.0:
        lag[MEMORY] = 0.0
    else:
        lag[ACTIVE] = 0.0
    return False


@inlined
def settled(counters: Indices, numbers: Array, finding: bool) -> bool:
    """Whether only round-off is left: it falls no more, or is as small as where it fell no more.

    Not while the factor of the memory is still being found (``finding``).
    """
    if finding:
        counters[STALLS], numbers[LEAST] = 0, np.inf
        return False
    increment, least = numbers[INCREMENT], numbers[LEAST]
    if increment > STALLED * least:
        counters[STALLS] += 1
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
    increment, least = numbers[INCREMENT], numbers[LEAST]
    return counters[STALLS] >= _STAGNANT and ULPS < increment <= 4.0 * least


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
