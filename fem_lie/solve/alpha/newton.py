"""The iteration of one step from Python, from the same compiled pieces as the loop's.

For what :mod:`fem_lie.solve.alpha.step.loop` does not know: steps that carry stress from iterate
to iterate, policies without a rule, velocities that are projected, inertial components.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from fem_lie.lie.kinds import twists
from fem_lie.linear.equilibrated import SingularMatrixError
from fem_lie.solve.alpha.run_state import RunState
from fem_lie.solve.alpha.step.loop import allowed, settled_ratio
from fem_lie.solve.alpha.step.nodes import accept, change_velocities, correct, predict
from fem_lie.solve.alpha.step.records import INCREMENT, ITERATION, MOTION, NOW, RATIO
from fem_lie.solve.impacts.projection import project
from fem_lie.solve.impacts.step_end import StepEnd
from fem_lie.solve.motion.convergence import DIVERGED, ROUND_OFF, estimate
from fem_lie.solve.motion.policies import Decisions
from fem_lie.solve.renewal import Update

_STAGNATION = 1e-6  # full Newton that no longer contracts below this has met round-off


class Newton(RunState):
    """One integration, and how a step of it is iterated."""

    def _iterate(self, decisions: Decisions, *, carried: bool) -> int:
        """Predict, and correct until it converges; returns the iterations, 0 on failure."""
        try:
            return self._newton(decisions, carried)
        except SingularMatrixError:
            self.numbers[INCREMENT] = np.inf
            return 0

    def _newton(self, decisions: Decisions, carried: bool) -> int:
        equations, s, numbers = self.equations, self.s, self.numbers
        numbers[MOTION] = max(predict(*self._plain), numbers[MOTION])
        tolerance = self._tolerance()
        previous, ratio = np.inf, float(numbers[RATIO])
        for iteration in range(1, self.options.max_iterations + 1):
            self.counters[ITERATION] = iteration
            self._find(self._end_instant, carried=carried)
            update = decisions.before_iteration(iteration)
            update = Update.ALL if update is True or self._missing else Update(update)
            if update:
                self._renew(update, None if carried else s.H1)
            self._solve()
            if carried:
                h = np.empty_like(s.d)
                twists(s.kinds, s.d, -self.dx[: s.d.size].reshape(-1, 6), h)
                equations.memory.carry(s.H1, h.ravel())
            scale, spread, joined = self._sizes
            increment = correct(*self._plain, self.dx, scale, spread, joined, self.weights)
            ratio, remaining = estimate(increment, previous, ratio)
            numbers[INCREMENT], numbers[NOW] = increment, ratio
            stagnant = carried and 0.5 * previous < increment < _STAGNATION
            if remaining <= tolerance or increment <= ROUND_OFF or stagnant:
                made = self._accepts(decisions, iteration, tolerance, stagnant)
                return iteration if made else 0
            if not increment < DIVERGED:
                return 0
            previous = increment
        return 0

    def _accepts(
        self, decisions: Decisions, iteration: int, tolerance: float, stagnant: bool
    ) -> bool:
        """Accept the step that has converged, unless constraints contradict each other."""
        equations, ratio = self.equations, float(self.numbers[NOW])
        if equations.matrix.redundant and self._contradicts(tolerance, stagnant):
            return False
        self.numbers[RATIO] = settled_ratio(ratio, iteration)
        decisions.after_step(iteration)
        if decisions.asks and not self._turned:
            decisions.answer(iteration, ratio, self._staleness())
        if self._projects:
            end = StepEnd(self.s.H1, self.s.twist1, self._end)
            change = partial(change_velocities, self.s.plain)
            project(equations, self.solver, end, self.scale, self.p.h, change)
        accept(*self._plain)
        return True

    def _tolerance(self) -> float:
        """Error that the iteration of a step may leave, see :data:`~.convergence.ROTATION`."""
        motion = float(self.numbers[MOTION])
        return allowed(motion, self.options.tolerance, self._finest)
