"""A run of the conserving scheme on nodes that are no frames: its steps, results, checkpoints."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from math import log
from typing import Any

import numpy as np

from fem_lie._arrays import Array
from fem_lie.bodies.balances import TOTAL
from fem_lie.lie.kinds import push_all
from fem_lie.linear.direct import DirectSolver
from fem_lie.linear.equilibrated import SingularMatrixError
from fem_lie.linear.factors import Factors, factorise, solve
from fem_lie.results import Result
from fem_lie.solve.conserving.straight import step as steps
from fem_lie.solve.conserving.straight.cells import energies_at
from fem_lie.solve.conserving.straight.joints import Joints
from fem_lie.solve.conserving.straight.records import State, Step
from fem_lie.solve.conserving.straight.rows import gathered
from fem_lie.solve.conserving.straight.scene import model_of, viscous_terms
from fem_lie.solve.motion.consistent import accelerations, check_velocities
from fem_lie.solve.motion.convergence import DIVERGED, ROTATION, ROUND_OFF, estimate, failure
from fem_lie.solve.motion.integration import Integration
from fem_lie.solve.motion.policies import Decisions, EveryIteration, Policy
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.recorder import Recorder
from fem_lie.solve.recording.saving import Saving
from fem_lie.system.equations import Equations, Instant, Plan

_log = logging.getLogger(__name__)

_PREFIX = "fem_lie_dynamics_"
_STAGNANT, _FALLS = 1e3 * float(np.finfo(np.float64).eps), 0.5
"""Increments below the first, over those of the model, that do not fall by the second are noise."""
_SHARE = 0.25
"""Of the cost of a matrix, what a step that converges may go on for instead."""


def _lags(decisions: Decisions, increment: float, ratio: float) -> bool:
    """Whether at its rate the step goes on for longer than a matrix takes, where that counts."""
    if decisions.rule is None or not decisions.rule.asks or ratio >= 1.0:
        return True
    return log(_STAGNANT / increment) < _SHARE * decisions.rule.cost * log(ratio)


class StraightRun(Integration[Recorder]):
    """One integration."""

    def __init__(
        self, policy: Policy, equations: Equations, step: float, told: tuple[float, int]
    ) -> None:
        """Allocate everything; nothing is computed yet.

        Args:
            policy: When to factorise.
            equations: Of the scene.
            step: Step size.
            told: Tolerance, and most iterations, of
                :class:`~fem_lie.solve.conserving.energy_momentum.EnergyMomentum`.
        """
        super().__init__(policy, equations, step)
        self._tolerance, self._limit = told
        self._rescues = policy.rescue
        unknowns, z = equations.unknowns, np.zeros
        n, m = unknowns.moving, unknowns.m
        self._changing, self._n = unknowns.time_dependent, n
        self.model, self.joints = model_of(equations), Joints(equations)
        cells = len(self.model.cells.calls)
        self.s = State(
            H=equations.start.frames.copy(),
            rest=z((n, 4, 3)),
            V=z((n, 6)),
            trend=z((n, 6)),
            carry=z((n, 6)),
            W=z(cells),
            account=z(cells),
            books=z(TOTAL),
            told=z(4),
            weights=z(m),
            earlier=z((2, m)),
            gap=z(m),
            scale=np.ones(m),
        )
        self.this = Step(
            step=z((n, 6)),
            mean=self.s.H[:n].copy(),
            end=self.s.H[:n].copy(),
            V1=z((n, 6)),
            W1=z(cells),
            work=z(cells),
            forces=z((n, 6)),
            losses=z(TOTAL),
            told=z(2),
            r=z(6 * n + m),
            q=z((2, n, 4, 3)),
            outer=z((n, 6)),
            change=z(m),
        )
        # mean accelerations of the last two steps, twice their trends
        self._rates = z((2, n, 6))
        self._measure = np.tile(np.repeat([1.0 / unknowns.length, ROTATION], 3), n)
        self._x, self._y = z((2, 6 * n + m))
        self._still, self._work = z((n, 6)), z(unknowns.size)
        at_rest = Instant(*equations.start, self._still, self.s.weights)
        self._found = equations.residual(at_rest, self.s.scale, self._work)
        self._viscous = viscous_terms(equations)
        self._twists, self._viscous_forces = z((2, n, 6))
        self._factors: Factors | None = None
        self._made = self._factorisations = self._iterations = 0
        self._increment, self._before = np.inf, z(m)

    def history(
        self, steps: int, saving: Saving, progress: bool | None, store: Checkpoints | None
    ) -> Recorder:
        """See the base class."""
        return Recorder(self.equations, steps, self.h, saving, progress, store)

    @property
    def frames(self) -> Array:
        """See the base class."""
        return self.s.H

    @property
    def index(self) -> int:
        """See the base class."""
        return self._made

    # --- start ---

    def start(self) -> None:
        """See the base class."""
        equations, s, n, kinds = self.equations, self.s, self._n, self.model.kinds
        frames, v = equations.start
        check_velocities(equations, self.h)
        rows, rate = np.empty((n, 4, 3)), np.empty((n, 6))
        push_all(kinds, frames[:n], np.ascontiguousarray(v[:n]), rows)
        gathered(kinds, rows, s.V)
        solver = DirectSolver(equations.matrix, _PREFIX)
        rates, s.weights[:] = accelerations(equations, solver, s.H, v, 0.0, self.h)
        steps.spatial_rates(self.model, s, rates, rate)
        s.trend[:], self._rates[:] = 0.5 * rate, rate
        self._set_time(0.0)
        energies_at(self.model.cells, s.H, s.rest, s.W)
        s.account[:] = s.W

    def _set_time(self, time: float) -> None:
        """Let loads and targets of a time act."""
        self.equations.prescribed(time).act()
        loads = self.equations.tables.loads
        self.model.dead[:], self.model.following[:] = loads.dead, loads.following

    # --- steps ---

    def _advance(self, history: Recorder) -> bool:
        if self._changing:
            self._set_step()
        before = self._iterations
        self._before[:] = self.s.weights
        made = self._step()
        history.count += self._iterations - before
        if made:
            s = self.s
            steps.accept(self.model, s, self.this, self.h)
            s.earlier[1], s.earlier[0] = s.earlier[0].copy(), self._before
            s.H[self._n + 1 :] = self.joints.moved[1]
            self._rates[1], self._rates[0] = self._rates[0], 2.0 * s.trend
            self.equations.memory.accept(s.H)
            self.joints.accept(s.H)
            self.equations.memory.turn_axes(s.H)
            self._made += 1
        return made

    def _set_step(self) -> None:
        """Loads in the middle of the next step, targets and prescribed motions at both its ends."""
        equations, ends = self.equations, (self.index * self.h, (self.index + 1) * self.h)
        self._set_time((self.index + 0.5) * self.h)
        before, after = (equations.prescribed(time) for time in ends)
        if equations.unknowns.driven:
            self.joints.driven[:] = after.targets - before.targets
        self.joints.moved[0], self.joints.moved[1] = self.s.H[self._n + 1 :], after.frames

    def _step(self) -> bool:
        """Make the step from its start; whether it converges."""
        if self._made_with(self.decisions, still=False):
            return True
        if not self._rescues:
            return False
        _log.info("step %d: kept matrix diverges, new matrices", self.index + 1)
        return any(
            self._made_with(EveryIteration().begin(bound=False), still=still)
            for still in (False, True)
        )

    def _made_with(self, decisions: Decisions, *, still: bool) -> bool:
        """The same with matrices as they say; ``still``: without a prediction."""
        s, this, model = self.s, self.this, self.model
        steps.predict(model, s, self.h, this.step)
        if still:
            this.step[:] = 0.0
        s.weights[:] = self._before
        self.joints.begin(s.H)
        motion = float(np.abs(this.step.ravel() * self._measure).max(initial=0.0))
        previous, ratio, needed = np.inf, 1.0, 1
        for iteration in range(1, self._limit + 1):
            self._iterations += 1
            self._evaluate()
            # at the last digits no matrix helps: they are told neither of late nor of many of these
            fine = previous <= _STAGNANT
            asked = iteration == 1 or (not fine and _lags(decisions, previous, ratio))
            due = asked and decisions.before_iteration(iteration)
            if self._factors is None or due:
                try:
                    self._factorise()
                except SingularMatrixError:
                    return False
            self._solve()
            needed = needed if fine else iteration
            # multipliers are linear, and follow
            moved = self._x[: 6 * self._n] * self._measure
            increment = float(np.abs(moved).max(initial=0.0))
            ratio, remaining = estimate(increment, previous, ratio)
            self._increment, motion = increment, max(motion, increment)
            if not increment < DIVERGED:
                return False
            noise = increment <= _STAGNANT and increment > _FALLS * previous
            if noise or increment <= ROUND_OFF or remaining <= self._tolerance * motion:
                if not noise:
                    steps.correct(model, s, this, self._x)
                    self._evaluate()
                decisions.after_step(needed)
                return True
            steps.correct(model, s, this, self._x)
            previous = increment
        return False

    def _evaluate(self) -> None:
        """Balance and constraints of the present step."""
        s, this, model = self.s, self.this, self.model
        steps.move(model, s, this, self.h)
        if self.joints.any:
            self.joints.add_forces(s, this, self.h)
        for term in self._viscous:
            steps.mean_rates(model, this, self.h, self._twists)
            self._viscous_forces[:] = 0.0
            term.add_viscous_forces(this.mean, self._twists, self._viscous_forces)
            steps.add_viscous(model, this, self.h, self._twists, self._viscous_forces)
        steps.residual(model, s, this, self.h)

    def _solve(self) -> None:
        """The correction, into ``_x``."""
        assert self._factors is not None
        solve(self._factors.plain, self.this.r, self._y, self._x)

    def _factorise(self) -> None:
        """With the matrix in the middle of the step."""
        equations, h, n = self.equations, self.h, self._n
        H, v = self.s.H.copy(), np.zeros_like(equations.start.velocities)
        H[:n], s = self.this.mean, self.s
        now = Instant(H, v, self._still, s.weights)
        equations.residual(now, s.scale, self._work, self._found)
        plan = Plan(self._still, None, 4.0 / h**2, 2.0 / h, stressed=H, choices=self.choices)
        s.scale[:] = equations.fill(now, self._found, plan)
        self.this.r[6 * n :] = s.scale * (s.gap + self.this.change)
        self._factors = factorise(equations.matrix)
        self._factorisations += 1

    def _failure(self, steps: int) -> str:
        left = float(np.abs(self.this.r).max(initial=0.0))
        numbers = self._limit, self._increment, left, self._tolerance
        return failure(self.index + 1, steps, self.h, *numbers, self._rescues)

    # --- results ---

    def _record(self, history: Recorder) -> bool:
        history.show_progress(self.index)
        wanted = history.wants(self.index)
        if wanted:
            time = self.index * self.h
            v, rates = np.empty((2, self._n, 6))
            # along the line through the middles of the last two steps
            last = 1.5 * self._rates[0] - 0.5 * self._rates[1]
            steps.twists(self.model, self.s, last, v, rates)
            if self._changing:
                self._set_time(time)
            history.fill(time, self.s.H, v, rates, self._end_weights(), self.s.books)
        return wanted

    def _end_weights(self) -> Array:
        """Multipliers at the end of the last step; in the first two those over it."""
        s = self.s
        if self.index < 3:
            return s.weights
        # see fem_lie.solve.conserving.end_forces, for constant steps
        return s.weights + 0.5 * (s.earlier[0] - s.earlier[1])

    def _result(self, history: Recorder) -> Result:
        return history.result(self._factorisations, history.seconds)

    # --- checkpoints ---

    def memory(self) -> dict[str, Array]:
        """All that the next steps depend on."""
        kept: dict[str, Any] = {f"s.{name}": value for name, value in self.s._asdict().items()}
        kept |= {"mean": self.this.mean, "rates": self._rates, "turned": self.joints.turned.copy()}
        kept["counts"] = np.array([self._made, self._factorisations, self._iterations])
        kept |= super().memory()
        return kept if self._factors is None else kept | self._factors.arrays()

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Be as when :meth:`memory` was called."""
        for name, array in self.s._asdict().items():
            array[:] = kept[f"s.{name}"]
        self.this.mean[:], self._rates[:] = kept["mean"], kept["rates"]
        self.joints.turned[:] = kept["turned"]
        self._made, self._factorisations, self._iterations = (int(x) for x in kept["counts"])
        super().restore(kept)
        self._factors = Factors.of(kept)
