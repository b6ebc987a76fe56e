"""Generalised-α with a step that changes, and with the local error of every step.

What a step hands to the next belongs to its size: ``a`` stands for ``v̇`` at ``(α_f − α_m) h``
before its end, and velocities carry what is of the order h² across the joints
(:mod:`fem_lie.solve.start`). When h becomes ``r h``::

    a ← v̇ + r (a − v̇)          v ← v − (1 − r²) N B v

with ``N B v`` the part of the velocities across the joints. Without the first the scheme is of
first order with variable steps (O. Brüls & M. Arnold, J. Comput. Nonlinear Dyn. 3 (2008) 041007).

After a step that did not resolve fast waves ``v̇`` has their part of it, which means nothing. A much
smaller step would feel it, have a large error, and be rejected for ever: when two steps in sequence
are rejected, accelerations are made consistent anew, as at the start.
"""

from __future__ import annotations

import time as clock
from typing import TYPE_CHECKING

import numpy as np

from fem_lie import lie
from fem_lie._jit import Array
from fem_lie.results import Result
from fem_lie.solve.alpha_run import Run
from fem_lie.solve.growing_recorder import GrowingRecorder, StepLog
from fem_lie.solve.kept_factors import KeptFactors, OrMissing
from fem_lie.solve.linear import ConvergenceError
from fem_lie.solve.scheme import ROTATION, ROUND_OFF, parameters
from fem_lie.solve.start import (
    allowed_velocities,
    check_velocities,
    constraint_rates,
    set_start,
    with_driven,
)
from fem_lie.solve.step_control import Control, StepChoice
from fem_lie.solve.time_error import StepError, TimeError, largest_gaps
from fem_lie.system import System

if TYPE_CHECKING:
    from fem_lie.solve.generalised_alpha import GeneralisedAlpha

ORDER = 2

ITERATION = 0.01
"""Part of the tolerance that the iteration of a step may leave."""

SIDE = 1e-9
"""How far from an event its two sides are, in steps."""

SWEEPS = 3
"""Iterations for the part of velocities across the joints."""

REJECTIONS = 2
"""Steps rejected one after the other after which accelerations are found anew."""


def run(
    options: GeneralisedAlpha,
    system: System,
    duration: float,
    choice: StepChoice,
    save_every: int,
    progress: bool | None,
) -> Result:
    """Integrate with the steps of ``choice``; see :meth:`GeneralisedAlpha.run`."""
    control = choice.control(duration, system.length, ORDER)
    recorder = GrowingRecorder(system, duration, save_every, progress)
    return _VariableRun(options, system, control, choice.refinement).integrate_all(recorder)


class _VariableRun(Run):
    """State of one integration with steps that change."""

    def __init__(
        self, options: GeneralisedAlpha, system: System, control: Control, refinement: int = 1
    ) -> None:
        super().__init__(options, system, control.size)
        self.control = control
        self._starter = self.solver
        self.factors = KeptFactors(self._starter, rigid=not system.numbering.assemblies)
        self.solver = self.factors
        self.r, self.dx = self.solver.right_hand_side, self.solver.solution
        self.policy = OrMissing(self.policy, self.factors)
        self._speed, self._scales = 0.0, dict[int, Array]()
        self._rejections = 0
        self._last: tuple[float, StepError | None, float] = self.h, None, np.inf
        self._error, self._log = TimeError(system), StepLog(system)
        self._finer: _VariableRun | None = None
        if refinement > 1:
            self._finer = _VariableRun(options, system, control)
            self._parts = refinement

    # --- the size of the step ---

    def _begin(self, h: float) -> None:
        """Start at time 0 with steps of size h."""
        s = self.s
        s.H[:], s.H1[:], s.motion[:] = self.system.frames, self.system.frames, 0.0
        self._set_parameters(h)
        self.weights[:] = set_start(self.system, self._starter, self.p, s)
        self.factors.use(self.p.mass)
        self._starter.factorisations = 0

    def _set_parameters(self, h: float) -> None:
        self.h, self.p = h, parameters(self.options.radius, h, self.system.length)
        self._plain = tuple(self.p), tuple(self.s)
        self.system.velocity_factor = 1.0 / self.p.damping

    def _set_step(self, time: float, h: float) -> None:
        """Make the state at ``time`` that of the start of a step of size h."""
        s, r = self.s, h / self.h
        if abs(r - 1.0) > 1e-12:
            s.a[:] = s.vdot + r * (s.a - s.vdot)
            if self.system.m and self.factors.usable:
                s.v[:] -= self._across(time, 1.0 - r * r)
            self._set_parameters(h)
        self.factors.use(self.p.mass)
        if self.factors.usable:
            self.scale[:] = self.factors.scale()

    def _across(self, time: float, share: float) -> Array:
        """``share`` of the velocities of the groups that is across the joints, shape (n, 6).

        With the kept matrix, whose Jacobian is old: by iteration.
        """
        system, s, n = self.system, self.s, self.system.count
        v = system.velocities.copy()
        v[:n] = s.twist1
        v, _ = with_driven(system, v, time, self.h)
        wanted = constraint_rates(system, s.H, v)
        wanted -= system.connections.target_rates(time, self.h)[0]
        across = np.zeros_like(v)
        self.r[: 6 * n] = 0.0
        for _ in range(SWEEPS):
            found = constraint_rates(system, s.H, across)
            # the rows of the kept matrix are scaled as they were when it was made
            scale = self.factors.scale() * self.factors.factor
            self.r[6 * n :] = scale * (share * wanted - found)
            super()._solve()
            across[:n] += self.dx[: 6 * n].reshape(n, 6)
        flat = (s.kinds & 1) == 1
        R = lie.rotation(s.H[:n])[flat]
        across[:n][flat, :3] = np.einsum("nij,nj->ni", R, across[:n][flat, :3])
        return across[:n]

    def _restart(self, time: float) -> None:
        """Make accelerations and velocities at ``time`` consistent."""
        system, s = self.system, self.s
        s.H[system.count + 1 :] = system.prescribed_frames(time)
        v = system.velocities.copy()
        v[: system.count] = s.twist1
        v = allowed_velocities(system, self._starter, s.H, v, time, self.h)
        self.weights[:] = set_start(system, self._starter, self.p, s, v, time)

    def _side(self, time: float) -> float:
        return max(SIDE * self.h, 8.0 * np.spacing(time))

    # --- steps ---

    def integrate_all(self, recorder: GrowingRecorder) -> Result:
        """All steps to the end."""
        check_velocities(self.system, self.h)
        self._begin(self.control.size)
        self._warm_up()
        system, s, control = self.system, self.s, self.control
        recorder.record_at(0.0, 0, s.H, system.velocities, self.weights, 0, True)
        begin, index, time = clock.perf_counter(), 0, 0.0
        with recorder:
            while not control.finished:
                ended, iterations = self._attempt(time, index)
                if control.size < control.smallest * (1.0 - 1e-9):
                    result = self._completed(recorder, clock.perf_counter() - begin)
                    raise ConvergenceError(self._log.underflow(control, time, *self._last), result)
                if not iterations:
                    continue
                index, time = index + 1, ended
                self.system.connections.accept(s.H)
                lands = time == control.next_event
                recorder.record_at(time, index, s.H, s.twist1, self.weights, iterations, lands)
                if lands:
                    control.pass_event()
                if lands and not control.finished:
                    self._restart(time + self._side(time))
                    recorder.record_at(time, index, s.H, s.twist1, self.weights, 0, lands)
        return self._completed(recorder, clock.perf_counter() - begin)

    def _completed(self, recorder: GrowingRecorder, seconds: float) -> Result:
        made = self.factors.factorisations + self._starter.factorisations
        return self._log.complete(recorder.result(made, seconds))

    def _attempt(self, time: float, index: int) -> tuple[float, int]:
        """Try one step; its end and its iterations, 0 if it was rejected."""
        control = self.control
        h, event = control.fitted(time), control.next_event
        lands = abs(time + h - event) <= 1e-6 * h
        end = event if lands else time + h
        self._set_step(time, h)
        before = self._saved()
        self._index = index + 1
        iterations = self._step_to(end, lands)
        error = self._estimate(before) if iterations else None
        e = np.inf if error is None else control.ratio(error.translation, error.rotation, h)
        if error is None or e > 1.0:
            self._last = h, error, self._increment
            self._log.rejected.append(end)
            self._restore(before)
            control.reject(e)
            self._try_again(time, index)
            return time, 0
        self._rejections = 0
        self._log.add(end, h, error, self._measure(before, time, end, lands))
        control.accept(e)
        return end, iterations

    def _try_again(self, time: float, index: int) -> None:
        """After a rejected step."""
        self._rejections += 1
        h = self.control.size
        if h < self.control.smallest:
            return
        if index == 0:
            self._begin(h)
        elif self._rejections >= REJECTIONS:
            self._set_step(time, h)
            self._restart(time)

    def _step_to(self, end: float, lands: bool) -> int:
        """The iterations of a step that ends there, 0 if it failed."""
        system, s, self._end = self.system, self.s, end
        if system.time_dependent:
            seen = end - self._side(end) if lands else end
            system.set_time(seen)
            s.H1[system.count + 1 :] = system.prescribed_frames(seen)
        self._motion = self._speed * self.h
        iterations = self._step()
        if iterations:
            self._speed = max(self._speed, self._motion / self.h)
        return iterations

    def _saved(self) -> tuple[Array, ...]:
        s = self.s
        return s.H.copy(), s.H1.copy(), s.motion.copy(), self.weights.copy()

    def _restore(self, state: tuple[Array, ...]) -> None:
        s = self.s
        for own, saved in zip((s.H, s.H1, s.motion, self.weights), state, strict=True):
            own[:] = saved

    def _estimate(self, before: tuple[Array, ...]) -> StepError:
        s, m = self.s, self.factors.mass
        self._error.load(self.h, before[2], s.H, s.d, s.vdot, m, self.r)
        super()._solve()
        return self._error.of(self.dx)

    def _measure(
        self, before: tuple[Array, ...], time: float, end: float, lands: bool
    ) -> tuple[float, float]:
        """Errors of positions and rotations against the same step in many parts."""
        finer = self._finer
        if finer is None:
            return np.nan, np.nan
        finer._restore(before)
        finer.h, finer._index, finer._speed = self.h, self._index, self._speed
        h = (end - time) / self._parts
        finer._set_step(time, h)
        for k in range(1, self._parts + 1):
            last = k == self._parts
            if not finer._step_to(end if last else time + k * h, lands and last):
                return np.nan, np.nan
        return largest_gaps(self.s.H, finer.s.H)

    # --- what changes in a step ---

    def _tolerance(self) -> float:
        control = self.control
        allowed = min(control.tolerance / self.system.length, ROTATION * control.rotation_tolerance)
        return max(min(super()._tolerance(), ITERATION * self.h * allowed), ROUND_OFF)

    def _solve(self) -> None:
        super()._solve()
        if self.factors.factor != 1.0:
            self.dx *= self.factors.factor

    def _refresh(self) -> None:
        """The matrix may belong to another level: it is made whole."""
        self._factorise(self.s.H1)

    def _factorise(self, stressed: Array | None) -> None:
        level, m = self.control.level, self.system.m
        if level not in self._scales:
            self._fill(stressed, self.s.H1, turned=False)
            self._scales[level] = self.system.tangent.constraint_scale(self.s.H1)
        scale = self._scales[level]
        if m:
            self.r[-m:] *= scale / self.scale
        self.scale[:] = scale
        self._fill(stressed, self._ahead(), turned=self._turned)
        self.factors.keep(scale)
