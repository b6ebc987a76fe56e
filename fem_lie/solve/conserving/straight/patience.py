"""Whether the iteration of a step goes on, has met round-off, or leads to no solution."""

from __future__ import annotations

from itertools import pairwise
from math import log

import numpy as np

from fem_lie.solve.motion.policies import Decisions

STAGNANT, _FALLS, PATIENCE = 1e3 * float(np.finfo(np.float64).eps), 0.5, 3
"""Increments below the first, over lengths of the model, are noise if they have not fallen by the
second in so many iterations."""
ASTRAY, _LOST = 1.0, 25
"""Increments of that many lengths of the model lead to no solution that follows from the start of
the step, and larger ones than noise that have not fallen in so many iterations to none at all."""
_SHARE = 0.25
"""Of the cost of a matrix, what a step that converges may go on for instead."""
_GROWN = 8
"""Increments one after the other, each larger than the last, that lead to no solution either."""


def lags(decisions: Decisions, increment: float, ratio: float) -> bool:
    """Whether at its rate the step goes on for longer than a matrix takes, where that counts."""
    if decisions.rule is None or not decisions.rule.asks or ratio >= 1.0:
        return True
    return log(STAGNANT / increment) < _SHARE * decisions.rule.cost * log(ratio)


def stalls(seen: list[float], patience: int) -> bool:
    """Whether increments, the last one at the end, have not fallen for so many iterations."""
    return len(seen) > patience and seen[-1] > _FALLS * seen[-1 - patience]


def is_lost(seen: list[float]) -> bool:
    """Whether increments have not fallen for long, or grown for a while."""
    grown = len(seen) > _GROWN and all(a < b for a, b in pairwise(seen[-_GROWN:]))
    return grown or stalls(seen, _LOST)
