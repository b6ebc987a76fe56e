"""Generalised-α with variable steps, and the local error of each step.

State that a step hands to the next depends on the step size: ``a`` approximates ``v̇`` at a time
``(α_f − α_m) h`` before its end, and velocities contain a part of order h² across the joints
(:func:`fem_lie.solve.alpha.start.velocity_defect`). When h becomes ``r h``::

    a ← v̇ + r (a − v̇)          v ← v − (1 − r²) N B v

with ``N B v`` the part of the velocities across the joints. Without the first transformation the
scheme is first order with variable steps (O. Brüls & M. Arnold, J. Comput. Nonlinear Dyn. 3 (2008)
041007).

After a step that did not resolve fast oscillations, ``v̇`` contains a meaningless part of them. A
much smaller step would resolve it, have a large error, and be rejected again and again. After two
successive rejections accelerations are therefore made consistent, as at the start.

The local error is computed from quantities of the step itself. The increment of the exact motion
from the same start is, with ``v̇₁`` at the end of the step::

    d(exact) = h v + ½ h² v̇ + (h²/6) (v̇₁ − v̇) + (h³/12) ad(v) v̇ + O(h⁴)

and :func:`defects` is this minus the scheme's ``d``: third order, ratio to the true error → 1 for a
free body. The bracket is that of the group: complete on SE(3), of the rotations only on R³×SO(3);
the Cayley map has a further ``−h³ v̂³/12``. (The series of the logarithm: Iserles, Munthe-Kaas,
Nørsett & Zanna, Acta Numerica 9 (2000) 215; its difference from a scheme: Arnold, Brüls & Cardona,
Numer. Math. 129 (2015) 149.)

In a constrained body the defect is not yet the error: positions satisfy the constraints, so the
part across the joints is none, and stiff bodies resist. With the iteration matrix ``S`` and its
factor ``m = ∂v̇₁/∂d`` of the mass matrix, subtracting the scheme's equations from the exact ones
leaves::

    S e + Bᵀ μ = m M d̃          B e = 0          (d̃: the defect)

so one solution with the frozen factors turns the defect into the error ``e``, for all schemes whose
end of a step satisfies the equations of motion. It filters oscillations that a step does not
resolve, as for stiff ordinary differential equations (Hairer & Wanner, Solving ODEs II, section
IV.8).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit.packed_arrays import PackedArrays
from fem_lie._state import ChangingArrays, attributes
from fem_lie.joints.equations.joint_arrays import views
from fem_lie.lie.node_types import all_from_group, all_to_group, push_all_forward
from fem_lie.linear.equilibrated import SingularMatrixError
from fem_lie.linear.factors import PlainSolution
from fem_lie.linear.levels import StoredFactors
from fem_lie.solve.alpha.options import Options
from fem_lie.solve.alpha.run import Run
from fem_lie.solve.alpha.start import set_start
from fem_lie.solve.alpha.step import uneventful
from fem_lie.solve.alpha.step.loop import PlainSteps
from fem_lie.solve.alpha.step.node import PlainScheme
from fem_lie.solve.alpha.step.uneventful import defects
from fem_lie.solve.convergence import ROTATION
from fem_lie.solve.motion.consistent import check_velocities
from fem_lie.solve.motion.growing import GrowingRecorder
from fem_lie.solve.motion.limits import PlainStops
from fem_lie.solve.motion.step_log import LargestError, StepError, add_inertia_forces
from fem_lie.solve.motion.variable_steps import MakeMany, side
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.plan import ChosenSteps
from fem_lie.solve.recording.whole_state import MovingState
from fem_lie.solve.refactorisation import PlainRule
from fem_lie.solve.step_control import SAME_SIZE, Control
from fem_lie.system.equations import Equations

if TYPE_CHECKING:
    from fem_lie.system.equations import Equations


class TimeError:
    """Local errors of the steps of a run.

    Attributes:
        defect: :func:`defects` of the last step.
    """

    def __init__(self, equations: Equations) -> None:
        """Set up for equations whose matrix is factorised elsewhere."""
        n, held = equations.unknowns.moving, equations.unknowns.held
        self._equations, self._kinds = equations, equations.unknowns.kinds
        self._q, self._largest = np.zeros((n, 4, 3)), LargestError(equations)
        self._held = held if held.any() else None
        self.defect = np.zeros((n, 6))

    def load(
        self, h: float, before: Array, H1: Array, d: Array, vdot1: Array, mass: float, r: Array
    ) -> None:
        """Right-hand side of the equations of the error, into ``r``.

        Args:
            h: Step size.
            before: ``v`` and ``v̇`` of the group at the start of the step, shape (≥ 2, n, 6).
            H1: Frames at its end.
            d: Its increments.
            vdot1: ``v̇`` at its end.
            mass: Factor of the mass matrix in the iteration matrix that will be used.
            r: Right-hand side, shape (size,), overwritten.
        """
        n = len(self.defect)
        defects(h, self._kinds, H1, before, d, vdot1, self.defect)
        push_all_forward(self._kinds, H1, self.defect, self._q)
        r[:] = 0.0
        forces = r[: 6 * n].reshape(n, 6)
        add_inertia_forces(self._equations, H1, self._q, mass, forces)
        self._equations.supports.rotate(H1, forces)
        if self._held is not None:
            forces[self._held] = 0.0

    def of(self, dx: Array) -> StepError:
        """The error, from the solution of these equations."""
        return self._largest.of(dx[: self.defect.size].reshape(-1, 6))


ITERATION = 0.01
"""Iteration error of a step, as a fraction of the step size tolerance."""

_NOTHING: Indices = np.empty(0, dtype=np.int64)
_NOWHERE: Indices = np.empty((0, 5), dtype=np.int64)

SWEEPS = 3
"""Number of iterations for the part of velocities across the joints."""

_MOTION = ("s.H", "s.H1", "s.motion", "multipliers", "balance")
"""State that a step changes, by attribute names."""


class AlphaSteps(Run):
    """Generalised-α with variable steps; see :class:`~.variable_steps.Stepper`."""

    STATE = attributes("_speed", "h", "_starter.factorisations")

    _watched: PackedArrays | None = None
    """Arrays of steps in the compiled loop."""

    # the whole matrix is refactorised, never the constraint Jacobian only
    _refreshes = _uses_correction = False

    def __init__(self, options: Options, equations: Equations, control: Control) -> None:
        """Set up without computing anything; ``control`` holds the level of the step size."""
        super().__init__(options, equations, control.size)
        self.control = control
        self.factors = StoredFactors(self._starter, rigid=equations.unknowns.rigid)
        self.solver = self.factors
        self.r, self.dx = self.solver.right_hand_side, self.solver.solution
        self._speed, self._scales = 0.0, dict[int, tuple[Array, Array]]()
        self._error, self._warm = TimeError(equations), False
        self._moved = ChangingArrays(self, _MOTION)
        self._errors = np.zeros((self._most, 4))

    @property
    def twists(self) -> Array:
        """Current twists of the moving nodes."""
        return self.s.twist1

    @property
    def increment(self) -> float:
        """Size of the last increment of the iteration."""
        return float(self.progress.increment)

    @property
    def factorisations(self) -> int:
        """Number of all factorisations so far."""
        return self.factors.factorisations + self._starter.factorisations

    # --- the size of the step ---

    def begin(self, h: float) -> None:
        """Start at time 0 with steps of size ``h``, with consistent accelerations."""
        s = self.s
        equations, frames = self.equations, self.equations.start.frames
        check_velocities(equations, h)
        s.H[:], s.H1[:], s.motion[:] = frames, frames, 0.0
        self._set_size(h)
        self.multipliers[:] = set_start(equations, self._starter, self.p, s, feedback=self.feedback)
        self.factors.levels.use(self.p.mass)
        self._starter.factorisations = 0
        equations.prescribed(0.0).act()
        self.balance.open(0.0, s.H, s.twist1, s.rate1, self.multipliers)
        if not self._warm:
            self._warm_up()
            self._warm = True

    def _set_size(self, h: float) -> None:
        self.h = h
        super()._set_size(h)

    def set_step(self, time: float, h: float) -> None:
        """Set the state at ``time`` as the start of a step of size ``h``."""
        s, r, levels = self.s, h / self.h, self.factors.levels
        if abs(r - 1.0) > SAME_SIZE:
            s.a[:] = s.vdot + r * (s.a - s.vdot)
            if self.equations.unknowns.constraints and self.factors.usable:
                s.v[:] -= self._across(time, 1.0 - r * r)
            self._set_size(h)
        levels.use(self.p.mass)
        if self.factors.usable:
            self.scale[:] = levels.scale()

    def _across(self, time: float, share: float) -> Array:
        """``share`` times the part of the group velocities across the joints, shape (n, 6).

        With the frozen matrix, whose Jacobian is old: by iteration.
        """
        equations, s, n = self.equations, self.s, self._moving
        driven, v = equations.prescribed(time, self.h), equations.start.velocities.copy()
        # not the recorded twists: they have no correction of a consistent start, and no part that
        # a step of another size, which was rejected, has put into the velocities
        v[:n], v[n + 1 :] = s.v, driven.velocities
        all_from_group(s.kinds, s.H, v[:n])
        constraints, across = equations.constraints(s.H), np.zeros_like(v)
        wanted = constraints.rates(v)[0] - driven.target_rates[0]
        self.r[: 6 * n] = 0.0
        for _ in range(SWEEPS):
            found, _ = constraints.rates(across)
            # the rows of the frozen matrix keep the scale of its factorisation
            scale = self.factors.levels.scale() * self.factors.levels.factor
            self.r[6 * n :] = scale * (share * wanted - found)
            super()._solve(self.solver.correct)
            across[:n] += self.dx[: 6 * n].reshape(n, 6)
        all_to_group(s.kinds, s.H, across[:n])
        return across[:n]

    def pass_event(self, time: float, restitution: Array | None = None) -> None:
        """Make accelerations and velocities at ``time`` consistent."""
        s = self.s
        # with the size of the next step: the last one may be so small that what depends on its
        # square is round-off
        self._set_size(self.control.size)
        self._end = time
        self._make_consistent(time, restitution)
        self.balance.jump(time, s.H, s.twist1, s.rate1, self.multipliers)

    def damp_oscillations(self, time: float, h: float) -> None:
        """Make accelerations consistent."""
        s = self.s
        self.set_step(time, h)
        self._make_consistent(time)
        self.balance.look(time, s.H, s.twist1, s.rate1, self.multipliers)

    # --- steps ---

    def step_to(self, start: float, end: float, index: int, lands: bool) -> int:
        """Make step ``index``; return its iterations, 0 if it failed."""
        self.progress.step, self._end = index - 1, end
        seen = end - side(end, self.h) if lands else end
        self._go_to_time(seen)
        self.progress.motion = self._speed * self.h
        iterations = self._take_step()
        if iterations:
            self._turn()
            self._speed = max(self._speed, float(self.progress.motion) / self.h)
            self.balance.add(self.h, seen, *self._accepted)
        return iterations

    @cached_property
    def make_many(self) -> MakeMany | None:
        """See the base class: no forces by Python, no supports along axes of their own."""
        plain = self._rule is not None and self._secants is None and self._ends
        plain = plain and not (self._prescribes or self._guided or self._corrects)
        plain = plain and not self.equations.arrays.floating.integers[0]
        return self._make_many if plain else None

    def _make_many(
        self, stops: PlainStops, values: Array, first: int, start: float, count: int
    ) -> tuple[Array, int]:
        """Make steps of the current size in the compiled loop, see :attr:`make_many`."""
        progress, levels, scene = self.progress, self.factors.levels, self.equations.scene
        progress.step, progress.total, self.reason = first, 0, ""
        progress.motion = self._speed * self.h
        self._began = scene.began.time + start - first * self.h
        self._go_to_time(start + self.h)
        if self._watched is None:
            self._watched = self._watch(stops, values)
        both = self._packed.addresses, self._watched.addresses
        last = first + min(count, len(self._errors))

        def call(
            scheme: PlainScheme, solution: PlainSolution, steps: PlainSteps, rule: PlainRule
        ) -> int:
            mass = levels.mass if self.factors.usable else 1.0
            no_rows = (_NOWHERE, _NOWHERE), _NOTHING
            span = first, last
            return uneventful.run(*both, scheme, solution, mass, steps, rule, *no_rows, *span)

        if not self._serve(call, ends=True):
            uneventful.take_back(*both)
        if progress.step < last:
            # a step was taken back: the balance continues from its start
            self.balance.look(start + (progress.step - first) * self.h, *self._accepted)
        self._speed = max(self._speed, float(progress.motion) / self.h)
        return self._errors[: progress.step - first], int(progress.total)

    def _watch(self, stops: PlainStops, values: Array) -> PackedArrays:
        """Arrays of :mod:`~.alpha.step.uneventful`."""
        s, known, n = self.s, self.equations.arrays, self._moving
        joints, probes = (views(each).turned.copy() for each in (known.joints, known.probes))
        watched = uneventful.Watched(
            H=s.H.copy(),
            H1=s.H1.copy(),
            motion=s.motion.copy(),
            multipliers=self.multipliers.copy(),
            balance=self.balance.total.copy(),
            turned=joints,
            probes=probes,
            stops=stops,
            values=values,
            ends=values.copy(),
            coordinates=np.zeros(len(known.probed)),
            inertia=known.inertia.plain,
            lengths=self.equations.unknowns.lengths.astype(np.int64),
            defect=np.zeros((n, 6)),
            q=np.zeros((n, 4, 3)),
            work=np.zeros((n, 4, 3)),
            errors=self._errors,
        )
        return PackedArrays(watched)

    def saved(self) -> dict[str, Array]:
        """A copy of the state that a step changes."""
        return self._moved.saved_state()

    def take_back(self, state: Mapping[str, Array]) -> None:
        """Restore a saved state."""
        self._moved.restore(state)

    def restore_from(self, other: AlphaSteps, state: Mapping[str, Array]) -> None:
        """Take the state that another stepper has saved."""
        self.take_back(state)
        self.h, self._speed, self.progress.step = other.h, other._speed, other.index

    def estimate(self, before: Mapping[str, Array], start: float, end: float) -> StepError:
        """Error of the step that was made from the state ``before``."""
        s, m = self.s, self.factors.levels.mass
        self._error.load(self.h, before["s.motion"], s.H, s.d, s.vdot, m, self.r)
        super()._solve(self.solver.correct)
        return self._error.of(self.dx)

    def recorder(
        self, plan: ChosenSteps, progress: bool | None, store: Checkpoints | None
    ) -> GrowingRecorder:
        """Create the history of results."""
        return GrowingRecorder(self.equations, plan, progress, store)

    def leave_balance(self) -> None:
        """Skip the energy balance."""
        self.balance.rest()

    _common = (*Run._common, "_speed", "h", "_end", "_born", "solver", "_starter.factorisations")

    @property
    def _now(self) -> float:
        """Time of the accepted state, on the later side of a discontinuity."""
        return self._end

    def restart(self, state: MovingState, common: Mapping[str, Array]) -> None:
        """Restart from the state of a scene that was divided, without matrices."""
        super().restart(state, common)
        self._born = int(common["_born"])

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Restore the state that :meth:`saved_state` returned, without matrices."""
        super().restore(kept)
        if not self._warm:
            self._warm_up()
            self._warm = True

    def refactorise_at(self, time: float) -> None:
        """Drop all matrices and factorise that of the current state."""
        self._set_size(self.h)
        self.factors.forget()
        # constraints may have been switched
        self.__dict__.pop("_packed", None)
        self._scales.clear()
        self.factors.levels.use(self.p.mass)
        # convected axes have been rotated since
        self.s.H1[: self._moving] = self.s.H[: self._moving]
        self._go_to_time(time)
        self._find(self._end_instant)
        # a step from a singular configuration factorises its own matrix
        with suppress(SingularMatrixError):
            self._factorise(self.s.H1)

    def record(self, recorder: GrowingRecorder, index: int, iterations: int) -> None:
        """Record the current state in the next row."""
        recorder.fill(0.0, *self._accepted, self.balance.so_far)

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

    def _solve(self, solve: Callable[[], None]) -> None:
        super()._solve(solve)
        if self._factor != 1.0:
            self.dx *= self._factor

    def _refresh(self) -> None:
        """Refactorise the whole matrix, which may belong to another step size."""
        self._factorise(self.s.H1)

    def _factorise(self, stressed: Array | None) -> None:
        level, m = self.control.level, len(self.multipliers)
        if level not in self._scales:
            found = self._fill(stressed, self.s.H1, None, turned=False)
            self._scales[level] = found, self.spread.copy()
        scale, self.spread[:] = self._scales[level]
        if m:
            self.r[-m:] *= scale / self.scale
        self.scale[:] = scale
        self._fill(stressed, self._ahead_of_this(), scale, turned=self._turned)
        self.factors.keep(scale)
