"""The iteration with a frozen matrix of steps, equilibria and paths of these, in Python.

One iteration evaluates the residual, asks the policy whether the matrix is to be made again, solves
for a correction, decides by its size whether the iteration has converged, and applies it. What that
means is up to the equations, see :class:`Iterated`; the order, the count and the end are here.

Compiled loops over many small steps go through the same order, and make the same decisions by the
same compiled functions: :func:`~.convergence.estimate` and :func:`~.convergence.judged` on
convergence, :func:`~.renewal.due` and :func:`~.renewal.learn` on matrices.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np

from fem_lie._jit import compiled
from fem_lie.linear.equilibrated import SingularMatrixError
from fem_lie.solve.convergence import Verdict, estimate, judged
from fem_lie.solve.renewal import Update


class Iterated(ABC):
    """Equations that are solved by iteration."""

    @abstractmethod
    def evaluate(self, iteration: int) -> bool:
        """Evaluate the residual of the present iterate; whether it is small enough by itself.

        Iterations are counted from 1.
        """

    @property
    def missing(self) -> bool:
        """Whether there is no matrix yet, or none that will do."""
        return False

    @abstractmethod
    def renew(self, update: Update) -> None:
        """Make the matrix, or its constraints, at the present iterate, and factorise it.

        Raises:
            SingularMatrixError: It has no factors.
        """

    @abstractmethod
    def correct(self) -> float:
        """Solve for a correction; returns its size."""

    @abstractmethod
    def judge(self, size: float) -> Verdict:
        """What the size of a correction says of the iteration."""

    def apply(self, verdict: Verdict) -> None:  # noqa: B027 - not all have something to do
        """Apply the correction, where :meth:`correct` has not."""

    def admits(self, verdict: Verdict) -> bool:
        """Whether what the iteration has converged to is a solution."""
        return True


class Renewals(Protocol):
    """What decides when a matrix is made, such as :class:`~.policies.Decisions`."""

    def before_iteration(self, iteration: int) -> Update | bool:
        """What to make before an iteration, counted from 1; ``True``: all."""

    def after_step(self, iterations: int) -> None:
        """Learn how many iterations it took."""


class Fixed:
    """The same in every iteration."""

    def __init__(self, update: Update) -> None:
        """Keep what is made."""
        self._update = update

    def before_iteration(self, iteration: int) -> Update:
        """See :class:`Renewals`."""
        return self._update

    def after_step(self, iterations: int) -> None:
        """Nothing to learn."""


class Criterion(Protocol):
    """What decides by the sizes of successive corrections."""

    def judge(self, size: float) -> Verdict:
        """What the size of the next correction says."""


class Ended(NamedTuple):
    """How an iteration has ended.

    Attributes:
        iterations: Corrections that were solved for.
        size: Of the last one; infinite where there was no solution.
        verdict: :attr:`Verdict.GOES_ON`: the limit was reached.
    """

    iterations: int
    size: float
    verdict: Verdict

    @property
    def converged(self) -> bool:
        """Whether a solution was found."""
        return self.verdict in (Verdict.CONVERGED, Verdict.STAGNANT)


NEWTON, KEPT = Fixed(Update.ALL), Fixed(Update.NONE)
"""A matrix in every iteration, and only where there is none."""


def iterate(problem: Iterated, limit: int, renewals: Renewals = NEWTON) -> Ended:
    """Iterate until the corrections converge.

    Args:
        problem: What is solved.
        limit: Most iterations.
        renewals: When to make a matrix; default: in every iteration.
    """
    size = np.inf
    for iteration in range(1, limit + 1):
        try:
            if problem.evaluate(iteration):
                return Ended(iteration - 1, size, Verdict.CONVERGED)
            wanted = renewals.before_iteration(iteration)
            if wanted or problem.missing:
                everything = wanted is True or problem.missing
                problem.renew(Update.ALL if everything else Update(wanted))
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
            renewals.after_step(iteration)
            return Ended(iteration, size, verdict)
    return Ended(limit, size, Verdict.GOES_ON)


class LinearRate:
    """Ends where the corrections to come, estimated by the ratio of the last two, are allowed.

    Attributes:
        ratio: Of successive corrections.
    """

    def __init__(self, allowed: Callable[[float], float], ratio: float, noise: float) -> None:
        """Nothing is corrected yet.

        Args:
            allowed: Sum of all corrections to come that is allowed, by the size of the last one.
            ratio: Of successive corrections in earlier steps, 1 if it is not known.
            noise: Corrections below that do not fall are round-off.
        """
        self.ratio, self._allowed, self._noise, self._previous = ratio, allowed, noise, np.inf

    def judge(self, size: float) -> Verdict:
        """See :class:`Criterion`."""
        how = self.ratio, self._allowed(size), self._noise
        self.ratio, verdict = _by_rate(size, self._previous, *how)
        self._previous = size
        return _VERDICTS[verdict]


_VERDICTS = tuple(Verdict)


@compiled
def _by_rate(
    size: float, previous: float, ratio: float, allowed: float, noise: float
) -> tuple[float, int]:
    """Ratio of corrections, and the verdict; for Python, in one call."""
    ratio, remaining = estimate(size, previous, ratio)
    return ratio, judged(size, previous, remaining, allowed, noise)


class QuadraticRate:
    """Ends where the next correction is below a tolerance, as it is by quadratic convergence."""

    def __init__(self, tolerance: float, farthest: float) -> None:
        """Nothing is corrected yet.

        Args:
            tolerance: Of the next correction.
            farthest: Corrections above have diverged.
        """
        self._tolerance, self._farthest, self._previous = tolerance, farthest, 0.0

    def judge(self, size: float) -> Verdict:
        """See :class:`Criterion`."""
        if not size <= self._farthest:
            return Verdict.DIVERGED
        ratio = min(1.0, size / self._previous) if self._previous > 0.0 else 1.0
        self._previous = size
        return Verdict.CONVERGED if size * ratio**2 <= self._tolerance else Verdict.GOES_ON


class Polishing:
    """Never ends: for a given number of iterations."""

    def judge(self, size: float) -> Verdict:
        """See :class:`Criterion`."""
        return Verdict.GOES_ON
