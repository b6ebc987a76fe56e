"""Steps that do not converge are divided into sub-steps of equal size.

Sub-steps are the step size over a power of two. The next steps start with the last size that
converged; after a number of converged sub-steps in succession the size is doubled. Each failure of
a size doubles that number, so that an interval that needs small steps costs few failures.
"""

from __future__ import annotations

import logging
from abc import abstractmethod
from typing import Protocol

from fem_lie._state import Stateful, attributes

_log = logging.getLogger(__name__)

HALVINGS = 6
"""Largest number of halvings of a step."""

_FEWEST, _MOST = 64, 256
"""Converged sub-steps of one size after which the next ones are twice as large."""


class Divisible(Protocol):
    """A run that can make steps of any size."""

    @property
    def divides(self) -> bool:
        """Whether the failed step may be divided."""

    @abstractmethod
    def resize(self, time: float, size: float) -> None:
        """Set the state at ``time`` as the start of a step of this size."""

    @abstractmethod
    def attempt(self, start: float, end: float) -> bool:
        """Make a step; return whether it converged. Otherwise the state is that at its start."""


class Division(Stateful):
    """Division of the steps of one run into sub-steps.

    Attributes:
        level: Number of halvings of the current step.
        divided: Number of divided steps so far.
        most: Largest number of sub-steps of one step so far.
    """

    STATE = attributes("level", "_made", "_wanted", "divided", "most")

    def __init__(self) -> None:
        """Start with whole steps."""
        self.level, self._made, self._wanted = 0, 0, _FEWEST
        self.divided, self.most = 0, 1

    @property
    def parts(self) -> int:
        """Number of sub-steps of the current step."""
        return int(2**self.level)

    def cover(self, steps: Divisible, start: float, end: float, size: float) -> bool:
        """Make all sub-steps of a step; return whether all converged.

        Args:
            steps: The run.
            start: Time at the start of the step.
            end: Time at its end.
            size: Its size, without the round-off of ``end - start``, which a restarted run would
                not reproduce.
        """
        done, parts = 0, self.parts
        while done < self.parts:
            here = start + size * done / self.parts
            last = done + 1 == self.parts
            if steps.attempt(here, end if last else start + size * (done + 1) / self.parts):
                done = self._passed(steps, done + 1, start, size)
            elif self.level == HALVINGS or not steps.divides:
                return False
            else:
                done = 2 * done
                self.halve(steps, here, size)
            parts = max(parts, self.parts)
        self.divided += parts > 1
        self.most = max(self.most, parts)
        return True

    def halve(self, steps: Divisible, time: float, size: float) -> None:
        """Halve the sub-steps of steps of this size from ``time`` on: one of them has failed."""
        self.level, self._made = self.level + 1, 0
        self._wanted = min(2 * self._wanted, _MOST)
        steps.resize(time, size / self.parts)

    def _passed(self, steps: Divisible, done: int, start: float, size: float) -> int:
        """Number of completed sub-steps, in units of the next size."""
        self._made += 1
        if self.level == 0 or self._made < self._wanted or done % 2:
            return done
        time = start + size * done / self.parts
        self.level, self._made = self.level - 1, 0
        steps.resize(time, size / self.parts)
        return done // 2

    def report(self, steps: int, why: str = "whole ones did not converge") -> None:
        """Log a warning if some of the steps were divided.

        Args:
            steps: Number of steps made.
            why: Why steps are divided.
        """
        if self.divided:
            _log.warning(
                "%d of %d steps were divided into up to %d sub-steps: %s; smaller steps, or a "
                "scheme that damps such as GeneralisedAlpha, may need less",
                *(self.divided, steps, self.most, why),
            )
