"""Refactorisation policies: when to assemble and factorise the iteration matrix.

In local frames the matrix changes little, so that it can be frozen for many steps. A policy is an
immutable record of options; the object that it creates for a run sees the iterations of every step
and holds the state. Decisions depend on iteration counts and sizes of corrections only, never on
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
from fem_lie._jit.records import Fields, Record, block_of
from fem_lie._state import put_back, saved
from fem_lie.solve.refactorisation import KNOWN, Refactorisation, Rule, due, learn

NEVER = 2**31
"""More iterations than any step makes."""

MOST_SECANTS = 20
"""Largest number of secants; more cost more than they save."""

GAIN = 1.0
"""Iterations per step that new mass and stiffness must be expected to save."""


class PolicyState(ABC):
    """Decisions of a policy in one run, with their state.

    Numbers, arrays and records among the attributes are the state, which is written to checkpoints.

    Attributes:
        rule: Rule, with the state ``known``, by which compiled loops decide; ``None``: every
            decision is asked for in Python.
        known: Recorded numbers, see :mod:`fem_lie.solve.refactorisation`.
    """

    rule: Rule | None = None
    known: Record

    @abstractmethod
    def before_iteration(self, iteration: int) -> Refactorisation | bool:
        """What to refactorise before the given iteration (counted from 1) of a step.

        ``True`` means everything, ``False`` nothing.

        Args:
            iteration: Number of the iteration in its step, from 1.
        """

    def after_step(self, iterations: int) -> None:  # noqa: B027 - most have no state
        """Record the number of iterations of the step.

        Args:
            iterations: Number of iterations of the step.
        """

    @property
    def asks(self) -> bool:
        """Whether to measure the staleness of mass and stiffness before all is refactorised."""
        return False

    def answer(  # noqa: B027 - most do not ask
        self, iterations: int, rate: float, staleness: float
    ) -> None:
        """Receive that measurement, at the end of a step after :meth:`after_step`.

        Args:
            iterations: Number of iterations of the step.
            rate: Convergence rate of the iteration.
            staleness: Convergence rate if only mass and stiffness were old, see
                :mod:`fem_lie.solve.alpha.staleness`.
        """

    def saved_state(self) -> dict[str, Array]:
        """Copies of all numbers, arrays and records among the attributes, by name."""
        return saved(self, self._state)

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Restore the state that :meth:`saved_state` returned.

        Args:
            kept: State that was copied before.
        """
        put_back(self, self._state, kept)

    @property
    def _state(self) -> list[str]:
        """Names of the attributes that are numbers, arrays or records."""
        kinds = bool, int, float, np.ndarray, Fields
        return [name for name, x in vars(self).items() if isinstance(x, kinds)]


class RefactorisationPolicy(ABC):
    """Refactorisation policy: an immutable record of options.

    Attributes:
        full_newton_fallback: Whether a failed step may be repeated with full Newton iteration.
        secants: Number of earlier corrections of a step used as secants, see
            :mod:`fem_lie.solve.secants`.
    """

    full_newton_fallback: ClassVar[bool] = True
    secants: int = 0

    @abstractmethod
    def begin(self, bound: bool) -> PolicyState:
        """Decisions for one run.

        ``bound``: whether the constraint Jacobian may be updated separately.

        Args:
            bound: Whether the scene has constraints that can be refactorised by themselves.
        """

    def rule(self) -> tuple[int, float] | None:
        """Patience and cost, as of :class:`Automatic`, with the same decisions in compiled loops.

        ``None``: there are none, and this policy must be asked.
        """
        return None


@final
class Ruled(PolicyState):
    """Decisions by a rule, see :mod:`fem_lie.solve.refactorisation`."""

    def __init__(self, rule: Rule) -> None:
        """Start without recorded iterations."""
        self.rule, self.known = rule, KNOWN()
        self._plain, self._asks = rule.plain, False
        self._recorded = block_of(self.known)[0]

    def before_iteration(self, iteration: int) -> Refactorisation:
        """Decision by the rule."""
        return Refactorisation(due(self._plain, self._recorded, iteration))

    def after_step(self, iterations: int) -> None:
        """Add up the excess iterations of the frozen matrix."""
        self._asks = learn(self._plain, self._recorded, iterations)

    @property
    def asks(self) -> bool:
        """Whether all would be refactorised, and a new constraint Jacobian might suffice."""
        return self._asks

    def answer(self, iterations: int, rate: float, staleness: float) -> None:
        """Keep the matrix, and accept the recent number of iterations, if its age is not the cause.

        The number of iterations of a linearly converging iteration is inversely proportional to the
        logarithm of its rate. Without the error of old mass and stiffness the rate decreases by the
        factor ``staleness``; Newton's rate is not assumed to be better than squared.
        """
        fresh = max(rate - staleness, rate**2)
        saved = (iterations - 1) * (1.0 - log(rate) / log(fresh)) if 0.0 < rate < 1.0 else 0.0
        if saved <= GAIN:
            self.known.fewest_since_all = self.known.lost = 0.0


@dataclass(frozen=True)
class EveryIteration(RefactorisationPolicy):
    """Full Newton: refactorise in every iteration."""

    def begin(self, bound: bool) -> PolicyState:
        """Always refactorise everything.

        Args:
            bound: Whether the scene has constraints that can be refactorised by themselves.
        """
        return Ruled(Rule(1, 0.0, inf, Refactorisation.ALL, bound=False, asks=False))

    def rule(self) -> tuple[int, float]:
        """Due in every iteration."""
        return 1, 0.0


@dataclass(frozen=True)
class IterationLimit(RefactorisationPolicy):
    """Refactorise when a step reaches ``iterations``: NNI ≥ k.

    The constraint Jacobian is updated first, and the whole matrix only if that does not help in the
    same step; everything again after each further ``iterations``.

    Attributes:
        iterations: The limit, at least 2.
    """

    iterations: int = 4

    def __post_init__(self) -> None:
        """Check the limit."""
        if self.iterations < 2:
            raise ValueError(f"the limit must be at least 2 iterations, got {self.iterations}")

    def begin(self, bound: bool) -> PolicyState:
        """Refactorise after the given number of iterations in a step.

        Args:
            bound: Whether the scene has constraints that can be refactorised by themselves.
        """
        return Ruled(Rule(self.iterations, inf, inf, Refactorisation.ALL, bound, asks=False))

    def rule(self) -> tuple[int, float]:
        """Patience within a step; no cost, so that nothing is due at the start of a step."""
        return self.iterations, inf


@dataclass(frozen=True)
class ConstraintsOnly(IterationLimit):
    """As :class:`IterationLimit`, but mass and stiffness are factorised once for the whole run."""

    full_newton_fallback: ClassVar[bool] = False

    def begin(self, bound: bool) -> PolicyState:
        """Update the constraint Jacobian only.

        Args:
            bound: Whether the scene has constraints that can be refactorised by themselves.
        """
        return Ruled(
            Rule(self.iterations, inf, inf, Refactorisation.CONSTRAINTS, bound, asks=False)
        )

    def rule(self) -> tuple[int, float]:
        """Never due after the start: scenes whose loops ask for this have no constraints."""
        return NEVER, inf


@dataclass(frozen=True)
class FactoriseOnce(RefactorisationPolicy):
    """One factorisation for the whole run; a step that does not converge with it is an error."""

    full_newton_fallback: ClassVar[bool] = False

    def begin(self, bound: bool) -> PolicyState:
        """Never refactorise.

        Args:
            bound: Whether the scene has constraints that can be refactorised by themselves.
        """
        return Ruled(Rule(NEVER, inf, inf, Refactorisation.NONE, bound, asks=False))

    def rule(self) -> tuple[int, float]:
        """At the start of the run only."""
        return NEVER, inf


@dataclass(frozen=True)
class Automatic(RefactorisationPolicy):
    """Refactorise when the frozen matrix has cost as much as a new one.

    The iterations that steps take beyond those of the first steps with an updated constraint
    Jacobian are added up. When the sum reaches the cost of an update, the constraint Jacobian is
    updated at the start of the next step. Iterations that are lost in spite of an updated Jacobian
    are added up likewise. When their sum reaches the cost of a matrix, the staleness of mass and
    stiffness is measured, and everything is refactorised if they are the cause, see
    :meth:`Ruled.answer`. Within a step that converges badly the constraint Jacobian is updated
    first, and everything is refactorised if that does not help.

    Attributes:
        cost: Time of assembling and factorising the matrix, in iterations.
        patience: Iterations of one step after which the matrix is refactorised at once.
        refresh: Time of assembling and factorising the constraint block, in iterations.
        secants: Number of earlier corrections of a step that improve the next one. They save
            factorisations where the tangent stiffness changes faster than it is refactorised, as in
            tension-only nets, and are of little use where steps take three iterations.
            ``GeneralisedAlpha`` supports them, and so do conserving schemes in scenes with nodes
            other than frames; other schemes raise an error. Free rigid bodies have no matrix and
            ignore them.
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

    def begin(self, bound: bool) -> PolicyState:
        """Refactorise when it pays.

        Args:
            bound: Whether the scene has constraints that can be refactorised by themselves.
        """
        cost, refresh = float(self.cost), float(self.refresh)
        return Ruled(Rule(self.patience, cost, refresh, Refactorisation.ALL, bound, asks=True))

    def rule(self) -> tuple[int, float]:
        """The patience and cost of this policy."""
        return self.patience, self.cost
