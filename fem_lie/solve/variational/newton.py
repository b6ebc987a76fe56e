"""Steps of the variational scheme that are iterated from Python."""

from __future__ import annotations

import numpy as np

from fem_lie.solve.convergence import Verdict
from fem_lie.solve.iteration import Iterated, LinearRate, iterate
from fem_lie.solve.motion.policies import Decisions
from fem_lie.solve.renewal import Update
from fem_lie.solve.variational import loop, momenta
from fem_lie.solve.variational.run_state import RunState


class Newton(RunState, Iterated):
    """One integration, and how a step of it is iterated.

    The compiled loop does not know loads and motions that change in time, viscous forces, axes that
    follow their surroundings, and the first step, which has no matrix yet.
    """

    _motion: float
    _rate: LinearRate

    def _made_with(self, decisions: Decisions) -> bool:
        """Make the step from its start; whether it converges."""
        held = self.equations.unknowns.held
        self.step[:] = 2.0 * self.steps[0] - self.steps[1]
        momenta.hold(self.equations.unknowns.kinds, self.H, held, self.step)
        self.weights[:] = self.earlier
        motion = float(np.abs(self.step.ravel() * self._measure[: self.step.size]).max(initial=0.0))
        tolerance, self._motion = self.options.tolerance, motion
        self._rate = LinearRate(lambda _: tolerance * self._motion, 1.0, loop.NOISE)
        ended = iterate(self, self.options.max_iterations, decisions)
        self._increment = ended.size
        return ended.converged

    # --- one iteration, see :class:`~fem_lie.solve.iteration.Iterated` ---

    def evaluate(self, iteration: int) -> bool:
        """See the base class; residuals alone do not end an iteration."""
        self._iterations += 1
        self._residual()
        return False

    @property
    def missing(self) -> bool:
        """See the base class."""
        return self._factors is None

    def renew(self, update: Update) -> None:
        """See the base class."""
        self._factorise()

    def correct(self) -> float:
        """See the base class."""
        self._solve()
        return float(np.abs(self._x * self._measure).max(initial=0.0))

    def judge(self, size: float) -> Verdict:
        """See the base class."""
        self._increment, self._motion = size, max(self._motion, size)
        return self._rate.judge(size)

    def apply(self, verdict: Verdict) -> None:
        """Apply the correction, unless it is round-off: what is accepted must be of one piece."""
        if verdict == Verdict.STAGNANT:
            return
        self._correct()
        if verdict == Verdict.CONVERGED:
            self._residual()
