"""When to build and factorise the iteration matrix anew: the gift of local frames is that it keeps.

A policy is a frozen record; what decides in a run is made by it, sees the iterations of every step
and has the memory. Decisions depend on iteration counts and sizes of corrections only, never on
measured time, so that a run repeats bit for bit.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from math import inf, log
from typing import ClassVar, final

import numpy as np

from fem_lie._arrays import Array
from fem_lie._state import put_back, saved
from fem_lie.solve.renewal import BASE, LOST, SIZE, Rule, Update, due, learn

NEVER = 2**31
"""More iterations than any step is given."""

MOST_SECANTS = 20
"""More take longer than what they save."""

GAIN = 1.0
"""Iterations per step, of which new mass and stiffness must be expected to save more."""


class Decisions(ABC):
    """Those of a policy in one run: what it has learned there is here, and nowhere else.

    The numbers and arrays among the attributes are its memory, which goes into checkpoints.

    Attributes:
        rule: By which they are made, with ``known``, if it is one: compiled loops decide by it.
            Otherwise each has to be asked for.
        known: What was learned, see :mod:`fem_lie.solve.renewal`.
    """

    rule: Rule | None = None
    known: Array

    @abstractmethod
    def before_iteration(self, iteration: int) -> Update | bool:
        """What to make anew before the given iteration (counted from 1) of a step.

        ``True`` stands for all, ``False`` for nothing.
        """

    def after_step(self, iterations: int) -> None:  # noqa: B027 - most have no memory
        """Learn how many iterations the step took."""

    @property
    def asks(self) -> bool:
        """Whether it wants to know what old mass and stiffness cost before it makes all anew."""
        return False

    def answer(  # noqa: B027 - most do not ask
        self, iterations: int, rate: float, staleness: float
    ) -> None:
        """Learn it, at the end of a step after :meth:`after_step`.

        Args:
            iterations: Of the step.
            rate: At which the iteration has converged.
            staleness: At which it would converge if only mass and stiffness were old, see
                :mod:`fem_lie.solve.alpha.staleness`.
        """

    def memory(self) -> dict[str, Array]:
        """Copies of all numbers and arrays among the attributes, by their names."""
        kinds = bool, int, float, np.ndarray
        return saved(self, [name for name, x in vars(self).items() if isinstance(x, kinds)])

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Be as when :meth:`memory` was called."""
        put_back(self, self.memory(), kept)


class Policy(ABC):
    """What decides on factorisations: a record of options without any memory.

    Attributes:
        rescue: Whether a step that fails may be done again with full iteration.
        secants: How many of its last corrections a step learns from, see
            :mod:`fem_lie.solve.secants`.
    """

    rescue: ClassVar[bool] = True
    secants: int = 0

    @abstractmethod
    def begin(self, bound: bool) -> Decisions:
        """Those of one run; ``bound``: whether there are constraints to refresh by themselves."""

    def rule(self) -> tuple[int, float] | None:
        """Patience and cost as of :class:`Automatic` that decide likewise, for compiled loops.

        ``None``: there are none, this policy must be asked.
        """
        return None


@final
class Ruled(Decisions):
    """Those of a rule, see :mod:`fem_lie.solve.renewal`."""

    def __init__(self, rule: Rule) -> None:
        """Nothing was learned yet."""
        self.rule, self.known = rule, np.zeros(SIZE)
        self._plain, self._asks = rule.plain, False

    def before_iteration(self, iteration: int) -> Update:
        """What the rule says."""
        return Update(due(self._plain, self.known, iteration))

    def after_step(self, iterations: int) -> None:
        """Add up what the kept matrix costs."""
        self._asks = learn(self._plain, self.known, iterations)

    @property
    def asks(self) -> bool:
        """When it would make all anew at the next step, and might do with the constraints."""
        return self._asks

    def answer(self, iterations: int, rate: float, staleness: float) -> None:
        """Keep all, and be content with the iterations of late, if age is not to blame.

        Iterations of linear convergence are as the inverse of the logarithm of its rate; without
        what is old that falls by ``staleness``, and Newton's is not taken for better than squared.
        """
        fresh = max(rate - staleness, rate**2)
        saved = (iterations - 1) * (1.0 - log(rate) / log(fresh)) if 0.0 < rate < 1.0 else 0.0
        if saved <= GAIN:
            self.known[BASE] = self.known[LOST] = 0.0


@dataclass(frozen=True)
class EveryIteration(Policy):
    """Full Newton."""

    def begin(self, bound: bool) -> Decisions:
        """Always all."""
        return Ruled(Rule(1, 0.0, inf, Update.ALL, bound=False, asks=False))

    def rule(self) -> tuple[int, float]:
        """Always due."""
        return 1, 0.0


@dataclass(frozen=True)
class Limit(Policy):
    """When a step reaches ``iterations``: the paper's NNI ≥ k.

    The constraints are refreshed first, and the rest only if that does not help in this step; all
    again each time that as many more iterations were needed.

    Attributes:
        iterations: The limit, at least 2.
    """

    iterations: int = 4

    def __post_init__(self) -> None:
        """Check the limit."""
        if self.iterations < 2:
            raise ValueError(f"the limit must be at least 2 iterations, got {self.iterations}")

    def begin(self, bound: bool) -> Decisions:
        """New matrices after so many iterations of a step."""
        return Ruled(Rule(self.iterations, inf, inf, Update.ALL, bound, asks=False))

    def rule(self) -> tuple[int, float]:
        """Only within a step."""
        return self.iterations, inf


@dataclass(frozen=True)
class ConstraintsOnly(Limit):
    """As :class:`Limit`, but mass and stiffness are factorised once for the whole run."""

    rescue: ClassVar[bool] = False

    def begin(self, bound: bool) -> Decisions:
        """Never more than the constraints."""
        return Ruled(Rule(self.iterations, inf, inf, Update.CONSTRAINTS, bound, asks=False))

    def rule(self) -> tuple[int, float]:
        """At the start of the run only: loops that ask have no constraints."""
        return NEVER, inf


@dataclass(frozen=True)
class Never(Policy):
    """One factorisation for the whole run; a step that fails with it is an error."""

    rescue: ClassVar[bool] = False

    def begin(self, bound: bool) -> Decisions:
        """Always nothing."""
        return Ruled(Rule(NEVER, inf, inf, Update.NONE, bound, asks=False))

    def rule(self) -> tuple[int, float]:
        """At the start of the run only."""
        return NEVER, inf


@dataclass(frozen=True)
class Automatic(Policy):
    """When keeping the matrix has cost as much as a new one.

    The iterations that steps take beyond those of the first steps with fresh constraints add up;
    when they reach the cost of a refreshment, that is made at the start of the next step. What is
    lost in spite of fresh constraints adds up likewise, until it is asked what new mass and
    stiffness would bring: they are made anew if they are to blame, see
    :meth:`Ruled.answer`. Within a step that converges badly the constraints are
    refreshed, and if that does not help all is made anew.

    Attributes:
        cost: Time of building and factorising the matrix, in iterations.
        patience: Iterations of one step after which the matrix is renewed at once.
        refresh: Time of building and factorising the border of constraints, in iterations.
        secants: How many of the last corrections of a step make the next one better. They save
            matrices where stiffness changes faster than these are made, as in nets that slacken,
            and are of little use where steps take three iterations. ``GeneralisedAlpha`` and
            conserving schemes of scenes with nodes that are no frames have them; other schemes
            refuse them, and free rigid bodies have no matrix to ask for them.
    """

    cost: float = 40.0
    patience: int = 8
    refresh: float = 40.0
    secants: int = 0

    def __post_init__(self) -> None:
        """Check the costs."""
        if not min(self.cost, self.refresh) > 0 or self.patience < 1:
            raise ValueError(
                "cost and refresh must be positive and patience at least 1, got "
                f"{self.cost}, {self.refresh}, {self.patience}"
            )
        if not 0 <= self.secants <= MOST_SECANTS:
            raise ValueError(f"secants must be 0 … {MOST_SECANTS}, got {self.secants}")

    def begin(self, bound: bool) -> Decisions:
        """New matrices when they are worth their cost."""
        cost, refresh = float(self.cost), float(self.refresh)
        return Ruled(Rule(self.patience, cost, refresh, Update.ALL, bound, asks=True))

    def rule(self) -> tuple[int, float]:
        """Its own."""
        return self.patience, self.cost
