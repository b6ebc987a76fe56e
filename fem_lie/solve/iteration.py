"""Newton iteration with a frozen matrix, for time steps, static equilibria and points on paths.

Each iteration evaluates the residual, asks the policy whether to refactorise the matrix, solves for
a correction, judges convergence by the size of the correction, and applies it. The equations define
these operations, see :class:`Iterated`; the order of the calls, the count and the end are defined
here. The compiled loops for small scenes follow the same order and share the compiled functions:
:func:`~.convergence.estimate` and :func:`~.convergence.judged` for convergence,
:func:`~.refactorisation.due` and :func:`~.refactorisation.learn` for matrices.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np

from fem_lie._jit import compiled
from fem_lie.linear.equilibrated import SingularMatrixError
from fem_lie.solve.convergence import Verdict, estimate, judged
from fem_lie.solve.refactorisation import Refactorisation


class Iterated(ABC):
    """Equations that :func:`iterate` solves."""

    @abstractmethod
    def evaluate(self, iteration: int) -> bool:
        """Evaluate the residual of the current iterate; return whether it alone ends the iteration.

        Iterations are counted from 1.

        Args:
            iteration: Number of the iteration in its step, from 1.
        """

    @property
    def missing(self) -> bool:
        """Whether there is no usable iteration matrix."""
        return False

    @abstractmethod
    def refactorise(self, update: Refactorisation) -> None:
        """Assemble the matrix, or its constraint block, at the current iterate, and factorise it.

        Args:
            update: What is refactorised.

        Raises:
            SingularMatrixError: The matrix is singular.
        """

    @abstractmethod
    def correct(self) -> float:
        """Solve for a correction; return its size, relative to the model."""

    @abstractmethod
    def judge(self, size: float) -> Verdict:
        """Verdict on the iteration from the size of a correction.

        Args:
            size: Size of the correction, relative to the model.
        """

    def apply(self, verdict: Verdict) -> None:  # noqa: B027 - not all have something to do
        """Apply the correction, unless :meth:`correct` has applied it.

        Args:
            verdict: Verdict on the iteration.
        """

    def admits(self, verdict: Verdict) -> bool:
        """Whether the converged iterate is a solution.

        Args:
            verdict: Verdict on the iteration.
        """
        return True


class Refactorisations(Protocol):
    """Decides when a matrix is refactorised, such as :class:`~.policies.PolicyState`."""

    def before_iteration(self, iteration: int) -> Refactorisation | bool:
        """What to refactorise before an iteration, counted from 1; ``True``: everything."""

    def after_step(self, iterations: int) -> None:
        """Record the number of iterations of a step."""


class Fixed:
    """The same decision in every iteration."""

    def __init__(self, update: Refactorisation) -> None:
        """Decide for ``update`` in every iteration."""
        self._update = update

    def before_iteration(self, iteration: int) -> Refactorisation:
        """The fixed decision."""
        return self._update

    def after_step(self, iterations: int) -> None:
        """No effect: the decision is fixed."""


class Criterion(Protocol):
    """Judges convergence by the sizes of successive corrections."""

    def judge(self, size: float) -> Verdict:
        """Verdict on the next correction, of this size."""


class Ended(NamedTuple):
    """Outcome of an iteration.

    Attributes:
        iterations: Number of corrections.
        size: Size of the last correction; infinite if the linear system could not be solved.
        verdict: The last verdict; :attr:`Verdict.GOES_ON` if the limit was reached.
    """

    iterations: int
    size: float
    verdict: Verdict

    @property
    def converged(self) -> bool:
        """Whether the iteration has converged."""
        return self.verdict in (Verdict.CONVERGED, Verdict.STAGNANT)


NEWTON, FROZEN = Fixed(Refactorisation.ALL), Fixed(Refactorisation.NONE)
"""Full Newton (a new matrix in every iteration), and a frozen matrix."""


def iterate(problem: Iterated, limit: int, refactorisations: Refactorisations = NEWTON) -> Ended:
    """Iterate until the corrections converge.

    Args:
        problem: Equations to solve.
        limit: Largest number of iterations.
        refactorisations: When to refactorise the matrix; default: in every iteration.
    """
    size = np.inf
    for iteration in range(1, limit + 1):
        try:
            if problem.evaluate(iteration):
                return Ended(iteration - 1, size, Verdict.CONVERGED)
            wanted = refactorisations.before_iteration(iteration)
            if wanted or problem.missing:
                everything = wanted is True or problem.missing
                problem.refactorise(Refactorisation.ALL if everything else Refactorisation(wanted))
            size = problem.correct()
        except SingularMatrixError:
            return Ended(iteration, np.inf, Verdict.SINGULAR)
        verdict = problem.judge(size)
        if verdict == Verdict.DIVERGED:
            return Ended(iteration, size, verdict)
        problem.apply(verdict)
        if verdict != Verdict.GOES_ON:
            if not problem.admits(verdict):
                return Ended(iteration, size, Verdict.REFUSED)
            refactorisations.after_step(iteration)
            return Ended(iteration, size, verdict)
    return Ended(limit, size, Verdict.GOES_ON)


class LinearRate:
    """Convergence test for linear rates: the estimated sum of further corrections is small enough.

    Attributes:
        ratio: Ratio of successive corrections.
    """

    def __init__(
        self, allowed: Callable[[float], float], ratio: float, round_off_level: float
    ) -> None:
        """Start before the first correction.

        Args:
            allowed: Largest allowed sum of all further corrections, as a function of the last one.
            ratio: Ratio of successive corrections in earlier steps; 1 if unknown.
            round_off_level: Corrections below this level that no longer decrease are round-off.
        """
        self.ratio, self._allowed, self._round_off_level, self._previous = (
            ratio,
            allowed,
            round_off_level,
            np.inf,
        )

    def judge(self, size: float) -> Verdict:
        """Verdict on the next correction.

        Args:
            size: Size of the correction, relative to the model.
        """
        how = self.ratio, self._allowed(size), self._round_off_level
        self.ratio, verdict = _by_rate(size, self._previous, *how)
        self._previous = size
        return _VERDICTS[verdict]


_VERDICTS = tuple(Verdict)


@compiled
def _by_rate(
    size: float, previous: float, ratio: float, allowed: float, round_off_level: float
) -> tuple[float, int]:
    """Updated ratio of corrections, and the verdict, in one compiled call."""
    ratio, remaining = estimate(size, previous, ratio)
    return ratio, judged(size, previous, remaining, allowed, round_off_level)


class QuadraticRate:
    """Convergence test for quadratic rates: the estimated next correction is below a tolerance."""

    def __init__(self, tolerance: float, farthest: float) -> None:
        """Start before the first correction.

        Args:
            tolerance: For the next correction.
            farthest: Larger corrections have diverged.
        """
        self._tolerance, self._farthest, self._previous = tolerance, farthest, 0.0

    def judge(self, size: float) -> Verdict:
        """Verdict on the next correction.

        Args:
            size: Size of the correction, relative to the model.
        """
        if not size <= self._farthest:
            return Verdict.DIVERGED
        ratio = min(1.0, size / self._previous) if self._previous > 0.0 else 1.0
        self._previous = size
        return Verdict.CONVERGED if size * ratio**2 <= self._tolerance else Verdict.GOES_ON


class Polishing:
    """No convergence test: a fixed number of iterations near a converged state."""

    def __init__(self, farthest: float) -> None:
        """Start at a converged state.

        Args:
            farthest: Larger corrections have diverged: the matrix is singular.
        """
        self._farthest = farthest

    def judge(self, size: float) -> Verdict:
        """Continue, unless the correction is too large for a converged state."""
        return Verdict.GOES_ON if size <= self._farthest else Verdict.DIVERGED
