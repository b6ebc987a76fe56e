"""Generalised-α steps iterated from Python, by the same compiled functions as in the loop.

For cases that :mod:`fem_lie.solve.alpha.step.loop` does not support: linearised stress updates from
iterate to iterate, policies without a rule, projected velocities, inertial components.
"""

from __future__ import annotations

from functools import partial

from fem_lie.solve.alpha.run_state import RunState
from fem_lie.solve.alpha.step.loop import allowed, starting_ratio
from fem_lie.solve.alpha.step.nodes import accept, change_velocities, correct, predict
from fem_lie.solve.convergence import Verdict
from fem_lie.solve.impacts.impulses import project
from fem_lie.solve.impacts.step_end import StepEnd
from fem_lie.solve.iteration import Iterated, LinearRate, iterate
from fem_lie.solve.motion.policies import PolicyState
from fem_lie.solve.refactorisation import Refactorisation

_STAGNATION = 1e-6  # full Newton that no longer contracts below this value has reached round-off


class Newton(RunState, Iterated):
    """Run of generalised-α whose steps are iterated from Python."""

    _linearised = False
    """Whether the current iteration updates stress linearly from iterate to iterate."""

    _rate: LinearRate

    def _iterate(self, decisions: PolicyState, *, linearised: bool) -> int:
        """Predict, and correct until convergence; return the number of iterations, 0 on failure."""
        progress, self._linearised = self.progress, linearised
        motion = self.equations.shared.largest(predict(*self._plain))
        progress.motion = max(motion, progress.motion)
        tolerance, round_off_level = self._tolerance(), _STAGNATION if linearised else 0.0
        self._rate = LinearRate(lambda _: tolerance, float(progress.ratio), round_off_level)
        ended = iterate(self, self.options.max_iterations, decisions)
        progress.increment = ended.size
        if not ended.converged:
            return 0
        self._accept(decisions, ended.iterations)
        return ended.iterations

    # --- one iteration, see :class:`~fem_lie.solve.iteration.Iterated` ---

    def evaluate(self, iteration: int) -> bool:
        """Evaluate the residual, which alone does not end the iteration."""
        self.progress.iteration = iteration
        self._find(self._end_instant, linearised=self._linearised)
        return False

    @property
    def missing(self) -> bool:
        """Whether there is no usable iteration matrix."""
        return self._missing

    def refactorise(self, update: Refactorisation) -> None:
        """Assemble and factorise the matrix, or its constraint Jacobian."""
        self._refactorise(update, None if self._linearised else self.s.H1)

    def correct(self) -> float:
        """Solve for a correction and apply it; return its size."""
        s = self.s
        self._solve(self.solver.correct)
        if self._linearised:
            self.equations.history_variables.update_stress(s.H1, -self.dx[: s.d.size])
        self._refer_to(s.d, self._elastic)
        scale, spread, joined = self._sizes
        size = correct(*self._plain, self.dx, scale, spread, joined, self.multipliers)
        return self.equations.shared.largest(size)

    def judge(self, size: float) -> Verdict:
        """Verdict by the linear convergence rate."""
        verdict = self._rate.judge(size)
        self.progress.increment, self.progress.now = size, self._rate.ratio
        return verdict

    def admits(self, verdict: Verdict) -> bool:
        """Whether the constraints are consistent."""
        given = self._tolerance(), verdict == Verdict.STAGNANT
        return not (self.equations.matrix.redundant and self._contradicts(*given))

    def _accept(self, decisions: PolicyState, iterations: int) -> None:
        """Make the end of the converged step the start of the next one."""
        equations, ratio = self.equations, float(self.progress.now)
        self.progress.ratio = starting_ratio(ratio, iterations)
        if decisions.asks and not self._turned:
            decisions.answer(iterations, ratio, self._staleness())
        if self._projects:
            end = StepEnd(self.s.H1, self.s.twist1, self._end)
            change = partial(change_velocities, self.s.plain)
            # the rows of the frozen matrix keep the scale of its factorisation
            scale, before = self.scale * self._factor, self.s.twist1.copy()
            moved = project(equations, self.solver, end, scale, self.p.h, change)
            self.impulses[:] = moved / (self._factor * self.p.mass)
            self.balance.project(self.s.H1, before, self.s.twist1)
        accept(*self._plain)

    def _tolerance(self) -> float:
        """Allowed iteration error of a step, see :data:`~.convergence.ROTATION`."""
        motion = float(self.progress.motion)
        return allowed(motion, self.options.tolerance, self._finest)
