"""When to build and factorise the iteration matrix anew: the gift of local frames is that it keeps.

A policy sees the iterations of every step and decides. Decisions depend on iteration counts only,
never on measured time, so that a run repeats bit for bit.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from math import inf
from typing import ClassVar

NEVER = 2**31
"""More iterations than any step is given."""


class Policy(ABC):
    """Decides on factorisations; one object per run is made by :meth:`fresh`.

    Attributes:
        rescue: Whether a step that fails may be done again with full iteration.
    """

    rescue: ClassVar[bool] = True

    @abstractmethod
    def fresh(self) -> Policy:
        """The same policy without memory."""

    @abstractmethod
    def before_iteration(self, iteration: int) -> bool:
        """Whether to factorise before the given iteration (counted from 1) of a step."""

    def rule(self) -> tuple[int, float] | None:
        """Patience and cost as of :class:`Automatic` that decide likewise, for compiled loops.

        ``None``: there are none, this policy must be asked.
        """
        return None

    def after_step(self, iterations: int) -> None:  # noqa: B027 - most policies have no memory
        """Learn how many iterations the step took."""


class EveryIteration(Policy):
    """Full Newton."""

    def fresh(self) -> Policy:
        """The same policy without memory."""
        return EveryIteration()

    def rule(self) -> tuple[int, float]:
        """Always due."""
        return 1, 0.0

    def before_iteration(self, iteration: int) -> bool:
        """Always."""
        return True


class Limit(Policy):
    """When a step reaches ``iterations``: the paper's NNI ≥ k."""

    def __init__(self, iterations: int = 4) -> None:
        """Set the limit.

        Raises:
            ValueError: It is below 2.
        """
        if iterations < 2:
            raise ValueError(f"the limit must be at least 2 iterations, got {iterations}")
        self.iterations = iterations

    def fresh(self) -> Policy:
        """The same policy without memory."""
        return Limit(self.iterations)

    def rule(self) -> tuple[int, float]:
        """Only within a step."""
        return self.iterations, inf

    def before_iteration(self, iteration: int) -> bool:
        """When the limit is exceeded; again each time that as many more iterations were needed."""
        return iteration > 1 and (iteration - 1) % self.iterations == 0


class Never(Policy):
    """One factorisation for the whole run; a step that fails with it is an error."""

    rescue = False

    def fresh(self) -> Policy:
        """The same policy without memory."""
        return self

    def rule(self) -> tuple[int, float]:
        """At the start of the run only."""
        return NEVER, inf

    def before_iteration(self, iteration: int) -> bool:
        """Never."""
        return False


class Automatic(Policy):
    """When keeping the matrix has cost as much as a new one.

    The iterations that steps take beyond those of the first steps with a fresh matrix add up; when
    they reach the cost of a factorisation, it is made at the start of the next step. Within a step
    a factorisation is made when the iteration converges badly.
    """

    def __init__(self, cost: float = 40.0, patience: int = 8) -> None:
        """Set the costs.

        Args:
            cost: Time of building and factorising the matrix, in iterations.
            patience: Iterations of one step after which the matrix is renewed at once.

        Raises:
            ValueError: One of them is not positive.
        """
        if not cost > 0 or patience < 1:
            raise ValueError(
                f"cost must be positive and patience at least 1, got {cost}, {patience}"
            )
        self.cost, self.patience = cost, patience
        self._best, self._excess = 0, 0.0

    def fresh(self) -> Policy:
        """The same policy without memory."""
        return Automatic(self.cost, self.patience)

    def rule(self) -> tuple[int, float]:
        """Its own."""
        return self.patience, self.cost

    def before_iteration(self, iteration: int) -> bool:
        """At the start of a step if it pays, or in the middle of a bad one."""
        if iteration == 1:
            due = self._excess >= self.cost
        else:
            due = (iteration - 1) % self.patience == 0
        if due:
            self._best, self._excess = 0, 0.0
        return due

    def after_step(self, iterations: int) -> None:
        """Add up what the kept matrix costs."""
        # one iteration is luck of the prediction, and says nothing of the matrix
        counted = max(iterations, 2)
        if self._best == 0 or counted < self._best:
            self._best = counted
        self._excess += counted - self._best
