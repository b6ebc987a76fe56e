"""A run of the variational scheme: its steps, results and checkpoints."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fem_lie._arrays import Array
from fem_lie.forms.frames import push
from fem_lie.joints.equations.table import joint_table
from fem_lie.linear.equilibrated import SingularMatrixError
from fem_lie.linear.factors import Factors, factorise, solve
from fem_lie.results import Result
from fem_lie.solve.conserving.step.cayley import advance
from fem_lie.solve.motion.consistent import check_velocities
from fem_lie.solve.motion.convergence import DIVERGED, ROTATION, ROUND_OFF, estimate, failure
from fem_lie.solve.motion.integration import Integration
from fem_lie.solve.motion.policies import Decisions, EveryIteration, Policy
from fem_lie.solve.motion.step_error import add_inertia_forces
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.recorder import Recorder
from fem_lie.solve.recording.saving import Saving
from fem_lie.solve.variational import momenta
from fem_lie.solve.variational.ends import Ends
from fem_lie.solve.variational.prescribed import prescribe
from fem_lie.system.equations import Equations, Instant, Plan
from fem_lie.system.nodes import inertia

_log = logging.getLogger(__name__)

_STAGNANT, _FALLS = 1e3 * float(np.finfo(np.float64).eps), 0.5
"""Increments below the first, over those of the model, that do not fall by the second are noise."""


@dataclass(frozen=True)
class Options:
    """What the scheme is told, see :class:`~fem_lie.solve.variational.variational.Variational`."""

    tolerance: float
    policy: Policy
    max_iterations: int


class VariationalRun(Integration[Recorder]):
    """One integration.

    Between two steps there are frames and momenta; velocities are found from these where they are
    wanted.
    """

    def __init__(self, options: Options, equations: Equations, step: float) -> None:
        """Allocate everything; nothing is computed yet.

        Args:
            options: Of the scheme.
            equations: Of the scene.
            step: Step size.
        """
        super().__init__(options.policy, equations, step)
        unknowns, known = equations.unknowns, equations.tables
        n, m, z = unknowns.moving, unknowns.m, np.zeros
        self.options, self._n = options, n
        self._changing, self._mass = unknowns.time_dependent, known.inertia
        self._viscous = _dissipates(equations)
        self.H, self.rest = equations.start.frames.copy(), z((n, 4, 3))
        # the last step and the one before
        self.steps, self.step = z((2, n, 6)), z((n, 6))
        self.before, self.after = z((n, 6)), z((n, 6))
        self.weights, self.earlier, self.gap = z(m), z(m), z(m)
        self.rows = z(self.H.shape), self.H.copy(), self.H.copy(), self.H.copy()
        self.twists, self._still = equations.start.velocities.copy(), z((n, 6))
        self._none, self._driven, self._change = z(m), z(m), z(m)
        self._forces, self._constraints = z((n, 6)), z((n, 6))
        self._r, self._x, self._y = z((3, unknowns.size))
        self._work, self._q = z(unknowns.size), z((n, 4, 3))
        self.scale: Array = np.ones(m)
        lengths = np.tile(np.repeat([1.0 / unknowns.length, ROTATION], 3), n)
        self._measure = np.concatenate(
            [lengths, np.where(unknowns.angular, ROTATION, 1.0 / unknowns.length)]
        )
        now = Instant(self.H, self.twists[:n], self._still, self._none)
        self._found = equations.residual(now, self.scale, self._work)
        self.books = equations.books()
        self._factors: Factors | None = None
        self._made, self._factorisations, self._iterations = 0, 0, 0
        self._increment, self._born = np.inf, 0
        self._ends = Ends(equations, step)

    def history(
        self, steps: int, saving: Saving, progress: bool | None, store: Checkpoints | None
    ) -> Recorder:
        """See the base class."""
        return Recorder(self.equations, steps, self.h, saving, progress, store)

    @property
    def frames(self) -> Array:
        """See the base class."""
        return self.H

    @property
    def index(self) -> int:
        """See the base class."""
        return self._made

    # --- start ---

    def start(self) -> None:
        """See the base class."""
        equations, n = self.equations, self._n
        check_velocities(equations, self.h)
        V = np.empty((n, 4, 3))
        v = equations.start.velocities
        push(self.H[:n], v[:n], V)
        momenta.of_rates(self.H, V, self._mass, self.before)
        self.steps[:, :, :3] = self.h * V[:, 0]
        self.steps[:, :, 3:] = self.h * np.einsum("nij,ni->nj", self.H[:n, 1:], v[:n, 3:])
        rates, self.weights[:] = self._ends.accelerations(self.H, v, 0.0)
        self.earlier[:] = self.weights
        now = Instant(self.H, v[:n], rates, self.weights)
        equations.residual(now, np.ones(len(self.weights)), self._work)
        self.gap[:] = self._work[6 * n :]
        self.books.open(0.0, *now)
        self._take_rows()
        self.scale[:] = self._fill(None)

    # --- steps ---

    def _advance(self, history: Recorder) -> bool:
        if self._changing:
            given = self._driven, self.twists
            prescribe(self.equations, self.H, self.index * self.h, self.h, self.rows, given)
        before = self._iterations
        made = self._made_with(self.decisions)
        if not made and self.options.policy.rescue:
            _log.info("step %d: kept matrix diverges, new matrices", self.index + 1)
            made = self._made_with(EveryIteration().begin(bound=False))
        history.count += self._iterations - before
        if made:
            self._accept()
        return made

    def _made_with(self, decisions: Decisions) -> bool:
        """Make the step from its start; whether it converges."""
        held = self.equations.unknowns.held
        self.step[:] = 2.0 * self.steps[0] - self.steps[1]
        momenta.hold(self.H, held, self.step)
        self.weights[:] = self.earlier if self.index < 2 else self.weights
        motion = float(np.abs(self.step.ravel() * self._measure[: self.step.size]).max(initial=0.0))
        previous, ratio = np.inf, 1.0
        for iteration in range(1, self.options.max_iterations + 1):
            self._iterations += 1
            self._residual()
            if self._factors is None or decisions.before_iteration(iteration):
                try:
                    self._factorise()
                except SingularMatrixError:
                    return False
            assert self._factors is not None
            solve(self._factors.plain, self._r, self._y, self._x)
            increment = float(np.abs(self._x * self._measure).max(initial=0.0))
            ratio, remaining = estimate(increment, previous, ratio)
            self._increment, motion = increment, max(motion, increment)
            noise = increment <= _STAGNANT and increment > _FALLS * previous
            if noise or increment <= ROUND_OFF or remaining <= self.options.tolerance * motion:
                if not noise:
                    self._correct()
                    self._residual()
                decisions.after_step(iteration)
                return True
            if not increment < DIVERGED:
                return False
            self._correct()
            previous = increment
        return False

    def _correct(self) -> None:
        size = 6 * self._n
        momenta.correct(self.H, self.equations.unknowns.held, self._x, self.step)
        # the residual has 4 times the forces of constraints
        self.weights -= 0.25 * self.scale * self._x[size:]

    def _residual(self) -> None:
        """Of the momenta at the start, and of the constraints at the end."""
        equations, n, rows, h = self.equations, self._n, self.rows, self.h
        momenta.between(self.H, self.step, rows, h, self.twists)
        middle = rows[3]
        v = self.twists if self._viscous else np.zeros_like(self.twists)
        equations.residual(
            Instant(middle, v, self._still, self._none), self.scale, self._work, self._found
        )
        self._forces[:] = self._work[: 6 * n].reshape(n, 6)
        if self._viscous:
            kinds = equations.unknowns.kinds
            inertia.accelerations(kinds, middle, v[:n], self._still, self._q)
            add_inertia_forces(equations, middle, self._q, -1.0, self._forces)
        constraints = self._change, self._constraints
        joints = equations.tables.joints
        momenta.constrain(self.H, rows, joints, self.weights, self._driven, constraints)
        acting = self.before, self._forces, self._constraints
        r = self._r[: 6 * n].reshape(n, 6)
        held = equations.unknowns.held
        momenta.balance(self.H, self.step, rows, self._mass, h, acting, held, (r, self.after))
        self._r[6 * n :] = self.scale * (self.gap + self._change)

    def _factorise(self) -> None:
        self._fill(self.scale)
        self._factors = factorise(self.equations.matrix)
        self._factorisations, self._born = self._factorisations + 1, self.index

    def _fill(self, scale: Array | None) -> Array:
        """The matrix in the middle of the step; returns the scale of its constraints."""
        equations, h, n = self.equations, self.h, self._n
        _, _, end, middle = self.rows
        v, H = self.twists.copy(), middle.copy()
        now = Instant(H, v, np.zeros((n, 6)), self.weights)
        ones = np.ones(len(self.weights)) if scale is None else scale
        equations.residual(now, ones, self._work, self._found)
        plan = Plan(self._still, scale, 4.0 / h**2, 2.0 / h, end.copy(), self.H)
        plan = plan._replace(stressed=H, choices=self.choices)
        return equations.fill(now, self._found, plan)

    def _accept(self) -> None:
        delta, _, end, _ = self.rows
        n = self._n
        advance(self.H[:n], self.rest, delta[:n])
        self.H[n:] = end[n:]
        self.gap += self._change
        self.before[:] = self.after
        self.steps[1], self.steps[0] = self.steps[0], self.step
        ahead = 2.0 * self.weights - self.earlier if self.index else self.weights.copy()
        self.earlier[:] = self.weights
        self._made += 1
        self.equations.accept(self.H)
        if not self.books.empty:
            self._book(ahead)

    def _book(self, weights: Array) -> None:
        """By the trapezoidal rule, with velocities along a line through the last two steps."""
        time = self.index * self.h
        if self._changing:
            self.equations.set_time(time)
        twists, rates = self._ends.through(self.H, self.steps, time, self._changing)
        self.books.add(self.h, time, self.H, twists[: self._n], rates, weights)

    def _take_rows(self) -> None:
        for row in self.rows[1:]:
            row[:] = self.H

    def _failure(self, steps: int) -> str:
        options = self.options
        left = float(np.abs(self._r).max(initial=0.0))
        numbers = options.max_iterations, self._increment, left, options.tolerance
        return failure(self.index + 1, steps, self.h, *numbers, options.policy.rescue)

    # --- results ---

    def _record(self, history: Recorder) -> bool:
        history.show_progress(self.index)
        wanted = history.wants(self.index)
        if wanted:
            time, n = self.index * self.h, self._n
            v = self.equations.start.velocities
            if self.index:
                v = self._ends.velocities(self.H, self.before, time)
            rates, weights = self._ends.accelerations(self.H, v, time)
            history.fill(time, self.H, v[:n], rates, weights, self.books.total)
        return wanted

    def _result(self, history: Recorder) -> Result:
        return history.result(self._factorisations, history.seconds)

    # --- checkpoints ---

    _STATE = ("H", "rest", "steps", "before", "weights", "earlier", "gap", "scale", "twists")

    def memory(self) -> dict[str, Array]:
        """All that the next steps depend on."""
        kept: dict[str, Any] = {name: getattr(self, name) for name in self._STATE}
        counts = self._made, self._factorisations, self._iterations, self._born
        kept |= {"counts": np.array(counts), "rows": np.stack(self.rows)}
        kept |= super().memory() | self.books.memory()
        return kept if self._factors is None else kept | self._factors.arrays()

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Be as when :meth:`memory` was called."""
        for name in self._STATE:
            getattr(self, name)[:] = kept[name]
        counts = (int(count) for count in kept["counts"])
        self._made, self._factorisations, self._iterations, self._born = counts
        for row, value in zip(self.rows, kept["rows"], strict=True):
            row[:] = value
        self.books.restore(kept)
        super().restore(kept)
        self._factors = Factors.of(kept)


def _dissipates(equations: Equations) -> bool:
    """Whether forces depend on velocities."""
    known = equations.tables
    dampers = joint_table(known.joints).springs[:, 1].any()
    return bool(dampers) or len(known.damping.indptr) > 0 or any(t.viscous for t in known.terms)
