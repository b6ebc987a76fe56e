"""Steps of which no solution is found, made in parts of equal size, for as long as that is needed.

Parts are halves of halves. Those that follow have the size that the last ones needed, and become
twice as large when so many of them were made in succession; each size that fails doubles this
number, so that a stretch of a run that needs small steps costs few failures.
"""

from __future__ import annotations

import logging
from abc import abstractmethod
from typing import Protocol

from fem_lie._state import Stateful, attributes

_log = logging.getLogger(__name__)

HALVINGS = 6
"""Of a step, at most."""

_FEWEST, _MOST = 64, 256
"""Parts of one size, made in succession, after which the next ones are twice as large."""


class Divisible(Protocol):
    """What makes steps of any size."""

    @property
    def divides(self) -> bool:
        """Whether parts may be made where the last step has failed."""

    @abstractmethod
    def resize(self, time: float, size: float) -> None:
        """Make the state at ``time`` that of the start of a step of this size."""

    @abstractmethod
    def attempt(self, start: float, end: float) -> bool:
        """Make a step, or leave the state at its start; whether it was made."""


class Division(Stateful):
    """Into how many parts the steps of one run are divided.

    Attributes:
        level: Of how often steps are halved now.
        divided: Steps that were made in parts.
        most: Parts of one of these, at most.
    """

    STATE = attributes("level", "_made", "_wanted", "divided", "most")

    def __init__(self) -> None:
        """Steps are whole."""
        self.level, self._made, self._wanted = 0, 0, _FEWEST
        self.divided, self.most = 0, 1

    @property
    def parts(self) -> int:
        """Of the present step."""
        return int(2**self.level)

    def cover(self, steps: Divisible, start: float, end: float, size: float) -> bool:
        """Make all parts of a step; whether they were made.

        Args:
            steps: What makes them.
            start: Of the step.
            end: Of the step.
            size: Of the step, without the round-off of ``end - start``, which a run that is resumed
                does not know.
        """
        place, parts = 0, self.parts
        while place < self.parts:
            here = start + size * place / self.parts
            last = place + 1 == self.parts
            if steps.attempt(here, end if last else start + size * (place + 1) / self.parts):
                place = self._passed(steps, place + 1, start, size)
            elif self.level == HALVINGS or not steps.divides:
                return False
            else:
                place = 2 * place
                self.halve(steps, here, size)
            parts = max(parts, self.parts)
        self.divided += parts > 1
        self.most = max(self.most, parts)
        return True

    def halve(self, steps: Divisible, time: float, size: float) -> None:
        """Halve the parts of steps of a size, from ``time`` on: one of them has failed."""
        self.level, self._made = self.level + 1, 0
        self._wanted = min(2 * self._wanted, _MOST)
        steps.resize(time, size / self.parts)

    def _passed(self, steps: Divisible, place: int, start: float, size: float) -> int:
        """Parts that are made, of the size that the next ones have."""
        self._made += 1
        if self.level == 0 or self._made < self._wanted or place % 2:
            return place
        time = start + size * place / self.parts
        self.level, self._made = self.level - 1, 0
        steps.resize(time, size / self.parts)
        return place // 2

    def report(self, steps: int) -> None:
        """Warn of steps that were made in parts, of so many."""
        if self.divided:
            _log.warning(
                "%d of %d steps were made in up to %d parts, where no solution was found in full",
                *(self.divided, steps, self.most),
            )
