"""Next guesses of a fixed point from the last ones (Anderson, J. ACM 12 (1965) 547)."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array


class Mixed:
    """Guesses of ``x = F(x)``, and what ``F`` made of them."""

    def __init__(self, depth: int) -> None:
        """Nothing is known yet.

        Args:
            depth: How many of the last guesses count.
        """
        self._depth = depth
        self._given: list[Array] = []
        self._found: list[Array] = []

    def next(self, given: Array, found: Array) -> Array:
        """The guess after ``given``, of which ``found`` was made, both (k,).

        It is that at which the changes from guess to guess, taken as linear, leave the least over.
        """
        self._given, self._found = (
            [*kept, new][-self._depth - 1 :]
            for kept, new in ((self._given, given), (self._found, found))
        )
        if len(self._given) < 2:
            return found
        left = found - given
        made = np.diff(np.array(self._found), axis=0).T
        change = made - np.diff(np.array(self._given), axis=0).T
        share = np.linalg.lstsq(change, left, rcond=1e-12)[0]
        return np.asarray(found - made @ share)
