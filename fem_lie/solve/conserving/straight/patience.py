"""Whether the iteration of a step goes on, has met round-off, or leads to no solution."""

from __future__ import annotations

from itertools import pairwise
from math import log

import numpy as np

from fem_lie._arrays import Array
from fem_lie.solve.motion.policies import Decisions

_EPS = float(np.finfo(np.float64).eps)
_NEAR, _FAR = 1e3 * _EPS, 1e2 * _EPS
"""What round-off makes of increments at most, over the length of the model and over the distance
from the origin, where positions are known to less."""
_FALLS, PATIENCE = 0.5, 3
"""Increments below that are noise if they have not fallen by the first in so many iterations."""
ASTRAY, _LOST = 1.0, 25
"""Increments of that many lengths of the model lead to no solution that follows from the start of
the step, and larger ones than noise that have not fallen in so many iterations to none at all."""
_SHARE = 0.25
"""Of the cost of a matrix, what a step that converges may go on for instead."""
_GROWN = 8
"""Increments one after the other, each larger than the last, that lead to no solution either."""


def round_off(positions: Array, length: float) -> float:
    """Largest increment that may be nothing but round-off, over the length of the model.

    Args:
        positions: Of the nodes, shape (n, 3).
        length: Of the model.
    """
    return max(_NEAR, _FAR * float(np.abs(positions).max(initial=0.0)) / length)


def lags(decisions: Decisions, increment: float, ratio: float, noise: float) -> bool:
    """Whether at its rate the step goes on for longer than a matrix takes, where that counts."""
    if decisions.rule is None or not decisions.rule.asks or ratio >= 1.0:
        return True
    return log(noise / increment) < _SHARE * decisions.rule.cost * log(ratio)


def stalls(seen: list[float], patience: int) -> bool:
    """Whether increments, the last one at the end, have not fallen for so many iterations."""
    return len(seen) > patience and seen[-1] > _FALLS * seen[-1 - patience]


def is_lost(seen: list[float]) -> bool:
    """Whether increments have not fallen for long, or grown for a while."""
    grown = len(seen) > _GROWN and all(a < b for a, b in pairwise(seen[-_GROWN:]))
    return grown or stalls(seen, _LOST)
