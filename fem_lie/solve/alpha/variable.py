"""Generalised-α with a step that changes.

What a step hands to the next belongs to its size: ``a`` stands for ``v̇`` at ``(α_f − α_m) h``
before its end, and velocities carry what is of the order h² across the joints
(:func:`fem_lie.solve.alpha.start.velocity_defect`). When h becomes ``r h``::

    a ← v̇ + r (a − v̇)          v ← v − (1 − r²) N B v

with ``N B v`` the part of the velocities across the joints. Without the first the scheme is of
first order with variable steps (O. Brüls & M. Arnold, J. Comput. Nonlinear Dyn. 3 (2008) 041007).

After a step that did not resolve fast waves ``v̇`` has their part of it, which means nothing. A
much smaller step would feel it, have a large error, and be rejected for ever: when two steps in
sequence are rejected, accelerations are made consistent anew, as at the start.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress

import numpy as np

from fem_lie._arrays import Array
from fem_lie._state import arrays_of, attributes
from fem_lie.lie.kinds import all_to_group
from fem_lie.linear.equilibrated import SingularMatrixError
from fem_lie.linear.levels import KeptFactors
from fem_lie.solve.alpha.options import Options
from fem_lie.solve.alpha.run import Run
from fem_lie.solve.alpha.start import set_start
from fem_lie.solve.alpha.step.records import INCREMENT, MOTION, STEP
from fem_lie.solve.alpha.time_error import TimeError
from fem_lie.solve.convergence import ROTATION
from fem_lie.solve.motion.consistent import check_velocities
from fem_lie.solve.motion.growing import GrowingRecorder
from fem_lie.solve.motion.step_error import StepError
from fem_lie.solve.motion.variable_steps import side
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.plan import ChosenSteps
from fem_lie.solve.step_control import Control
from fem_lie.system.equations import Equations

ITERATION = 0.01
"""Part of the tolerance that the iteration of a step may leave."""

SWEEPS = 3
"""Iterations for the part of velocities across the joints."""


_MOTION = ("s.H", "s.H1", "s.motion", "weights", "books")
"""What a step changes, by its names in the state of a run."""


class AlphaSteps(Run):
    """State of one integration with steps that change; see :class:`~.variable_steps.Stepper`."""

    STATE = attributes("_speed", "h", "_starter.factorisations")

    # factors are kept whole
    _refreshes = _sets_apart = False

    def __init__(self, options: Options, equations: Equations, control: Control) -> None:
        """Nothing is computed yet; ``control`` says on which level steps are."""
        super().__init__(options, equations, control.size)
        self.control = control
        self.factors = KeptFactors(self._starter, rigid=equations.unknowns.rigid)
        self.solver = self.factors
        self.r, self.dx = self.solver.right_hand_side, self.solver.solution
        self._speed, self._scales = 0.0, dict[int, tuple[Array, Array]]()
        self._error, self._warm = TimeError(equations), False
        self._moved = arrays_of(self, _MOTION)

    @property
    def increment(self) -> float:
        """Of the last iteration, as convergence is measured."""
        return float(self.numbers[INCREMENT])

    @property
    def factorisations(self) -> int:
        """How many there were in all."""
        return self.factors.factorisations + self._starter.factorisations

    # --- the size of the step ---

    def begin(self, h: float) -> None:
        """Start at time 0 with steps of size ``h``, with consistent accelerations."""
        s = self.s
        equations, frames = self.equations, self.equations.start.frames
        check_velocities(equations, h)
        s.H[:], s.H1[:], s.motion[:] = frames, frames, 0.0
        self._set_size(h)
        self.weights[:] = set_start(equations, self._starter, self.p, s)
        self.factors.levels.use(self.p.mass)
        self._starter.factorisations = 0
        equations.prescribed(0.0).act()
        self.books.open(0.0, s.H, s.twist1, s.rate1, self.weights)
        if not self._warm:
            self._warm_up()
            self._warm = True

    def _set_size(self, h: float) -> None:
        self.h = h
        super()._set_size(h)

    def set_step(self, time: float, h: float) -> None:
        """Make the state at ``time`` that of the start of a step of size ``h``."""
        s, r, levels = self.s, h / self.h, self.factors.levels
        if abs(r - 1.0) > 1e-12:
            s.a[:] = s.vdot + r * (s.a - s.vdot)
            if len(self.weights) and self.factors.usable:
                s.v[:] -= self._across(time, 1.0 - r * r)
            self._set_size(h)
        levels.use(self.p.mass)
        if self.factors.usable:
            self.scale[:] = levels.scale()

    def _across(self, time: float, share: float) -> Array:
        """``share`` of the velocities of the groups that is across the joints, shape (n, 6).

        With the kept matrix, whose Jacobian is old: by iteration.
        """
        equations, s, n = self.equations, self.s, self._moving
        driven, v = equations.prescribed(time, self.h), equations.start.velocities.copy()
        v[:n], v[n + 1 :] = s.twist1, driven.velocities
        constraints, across = equations.constraints(s.H), np.zeros_like(v)
        wanted = constraints.rates(v)[0] - driven.target_rates[0]
        self.r[: 6 * n] = 0.0
        for _ in range(SWEEPS):
            found, _ = constraints.rates(across)
            # the rows of the kept matrix are scaled as they were when it was made
            scale = self.factors.levels.scale() * self.factors.levels.factor
            self.r[6 * n :] = scale * (share * wanted - found)
            super()._solve()
            across[:n] += self.dx[: 6 * n].reshape(n, 6)
        all_to_group(s.kinds, s.H, across[:n])
        return across[:n]

    def pass_event(self, time: float) -> None:
        """Make accelerations and velocities at ``time`` consistent."""
        s = self.s
        self._make_consistent(time)
        self.books.jump(time, s.H, s.twist1, s.rate1, self.weights)

    def calm(self, time: float, h: float) -> None:
        """Find accelerations anew."""
        s = self.s
        self.set_step(time, h)
        self._make_consistent(time)
        self.books.look(time, s.H, s.twist1, s.rate1, self.weights)

    # --- steps ---

    def step_to(self, start: float, end: float, index: int, lands: bool) -> int:
        """Make step ``index``; its iterations, 0 if it failed."""
        self.counters[STEP], self._end = index - 1, end
        seen = end - side(end, self.h) if lands else end
        self._go_to_time(seen)
        self.numbers[MOTION] = self._speed * self.h
        iterations = self._take_step()
        if iterations:
            self._turn()
            self._speed = max(self._speed, float(self.numbers[MOTION]) / self.h)
            self.books.add(self.h, seen, *self._accepted)
        return iterations

    def saved(self) -> dict[str, Array]:
        """A copy of what a step changes."""
        return {name: array.copy() for name, array in self._moved.items()}

    def take_back(self, state: Mapping[str, Array]) -> None:
        """Be as when the state was saved."""
        for name, array in self._moved.items():
            array[...] = state[name]

    def follow(self, other: AlphaSteps, state: Mapping[str, Array]) -> None:
        """Be as another one was when it saved ``state``."""
        self.take_back(state)
        self.h, self._speed, self.counters[STEP] = other.h, other._speed, other.index

    def estimate(self, before: Mapping[str, Array], start: float, end: float) -> StepError:
        """The error of the step that was made from the state ``before``."""
        s, m = self.s, self.factors.levels.mass
        self._error.load(self.h, before["s.motion"], s.H, s.d, s.vdot, m, self.r)
        super()._solve()
        return self._error.of(self.dx)

    def recorder(
        self, plan: ChosenSteps, progress: bool | None, store: Checkpoints | None
    ) -> GrowingRecorder:
        """See the protocol."""
        return GrowingRecorder(self.equations, plan, progress, store)

    def leave_books(self) -> None:
        """See the protocol."""
        self.books.rest()

    def restore(self, kept: Mapping[str, Array]) -> None:
        """See the protocol."""
        super().restore(kept)
        if not self._warm:
            self._warm_up()
            self._warm = True

    def renew_matrix(self, time: float) -> None:
        """See the protocol."""
        self._set_size(self.h)
        self.factors.forget()
        self._scales.clear()
        self.factors.levels.use(self.p.mass)
        self._go_to_time(time)
        self._find(self._end_instant)
        # a step from a singular configuration makes its own matrix
        with suppress(SingularMatrixError):
            self._factorise(self.s.H1)

    def record(self, recorder: GrowingRecorder, index: int, iterations: int) -> None:
        """Keep the present state in the next row."""
        recorder.fill(0.0, *self._accepted, self.books.total)

    # --- what changes in a step ---

    @property
    def _finest(self) -> float:
        control = self.control
        length = self.equations.unknowns.length
        allowed = min(control.tolerance / length, ROTATION * control.rotation_tolerance)
        return ITERATION * self.h * allowed

    @property
    def _factor(self) -> float:
        return self.factors.levels.factor

    @property
    def _missing(self) -> bool:
        return not self.factors.usable

    def _solve(self) -> None:
        super()._solve()
        if self._factor != 1.0:
            self.dx *= self._factor

    def _refresh(self) -> None:
        """The matrix may belong to another level: it is made whole."""
        self._factorise(self.s.H1)

    def _factorise(self, stressed: Array | None) -> None:
        level, m = self.control.level, len(self.weights)
        if level not in self._scales:
            found = self._fill(stressed, self.s.H1, None, turned=False)
            self._scales[level] = found, self.spread.copy()
        scale, self.spread[:] = self._scales[level]
        if m:
            self.r[-m:] *= scale / self.scale
        self.scale[:] = scale
        self._fill(stressed, self._ahead_of_this(), scale, turned=self._turned)
        self.factors.keep(scale)
