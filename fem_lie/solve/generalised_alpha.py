"""Generalised-α in local frames, index 3, with a kept iteration matrix.

Brüls, Cardona & Arnold, Mech. Mach. Theory 48 (2012) 121. With ``d`` the increment of a step::

    d = h v + h² ((½ − β) a + β a₁)            H₁ = H exp(d)
    v₁ = v + h ((1 − γ) a + γ a₁)              (1 − α_m) a₁ + α_m a = (1 − α_f) v̇₁ + α_f v̇

and the equations of motion at the end of the step. Each body moves on SE(3), as written here, or on
R³×SO(3) (:mod:`fem_lie.groups`). Constraints are scaled as in Bottasso, Bauchau & Cardona, SIAM J.
Sci. Comput. 29 (2007) 397, which makes the conditioning independent of h.
"""

from __future__ import annotations

import logging
import os
import time as clock
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from fem_lie import lie
from fem_lie._jit import Array
from fem_lie.groups import Parametrisation, turn_all, turn_all_back, twists
from fem_lie.results import Result
from fem_lie.scene import Scene
from fem_lie.solve import free_bodies
from fem_lie.solve.checkpoints import Checkpoints, fingerprint
from fem_lie.solve.linear import (
    ConvergenceError,
    DirectSolver,
    SingularMatrixError,
    methods_in_time,
)
from fem_lie.solve.options import Components, Index
from fem_lie.solve.policies import Automatic, EveryIteration, Policy, Update
from fem_lie.solve.projection import project
from fem_lie.solve.recorder import Recorder
from fem_lie.solve.scheme import (
    DIVERGED,
    ROTATION,
    ROUND_OFF,
    UNMEASURED,
    estimate,
    failure,
    parameters,
)
from fem_lie.solve.staleness import back_to_local, staleness
from fem_lie.solve.start import check_velocities, set_start
from fem_lie.solve.step_control import StepChoice
from fem_lie.solve.steps import WRITTEN_LOCALLY, State, accept, correct, predict
from fem_lie.system import System

_log = logging.getLogger(__name__)

_STAGNATION = 1e-6  # full Newton that no longer contracts below this has met round-off


@dataclass(frozen=True)
class GeneralisedAlpha:
    """Options of the scheme; :meth:`run` integrates.

    Scenes of rigid bodies alone, without joints, clamps and motions, need no matrix of the scene:
    they go through one compiled loop, see :mod:`fem_lie.solve.free_bodies`.

    Attributes:
        radius: Spectral radius at infinite frequency, in [0, 1]: 1 conserves, 0 damps at once.
        tolerance: Predicted error of the iteration in each step over the largest motion in a step
            so far: the relative error of velocities, which is what energy and momentum feel.
        policy: When to factorise.
        max_iterations: More in one step are a failure.
        parametrisation: The map from increments to rotations.
        components: In which components the iteration matrix is kept.
        index: Which constraints hold at the end of each step.
        petsc_options_prefix: Prefix for the choice of the linear solver.
    """

    radius: float = 0.8
    tolerance: float = 2e-8
    policy: Policy = field(default_factory=Automatic)
    max_iterations: int = 30
    parametrisation: Parametrisation = Parametrisation.EXPONENTIAL
    components: Components = Components.LOCAL
    index: Index = Index.THREE
    petsc_options_prefix: str = "fem_lie_dynamics_"

    def __post_init__(self) -> None:
        """Check the options."""
        if not 0.0 <= self.radius <= 1.0:
            raise ValueError(f"the spectral radius must be in [0, 1], got {self.radius}")
        # plain numbers are welcome, others raise ValueError
        Parametrisation(self.parametrisation), Components(self.components), Index(self.index)
        if not self.tolerance > 0 or self.max_iterations < 1:
            raise ValueError(
                "wanted tolerance > 0 and max_iterations ≥ 1, got "
                f"{self.tolerance}, {self.max_iterations}"
            )

    def run(
        self,
        scene: Scene,
        *,
        duration: float,
        step: float | StepChoice,
        save_every: int = 1,
        progress: bool | None = None,
        file: str | os.PathLike[str] | None = None,
        checkpoint_every: int | None = None,
    ) -> Result:
        """Integrate from the bodies' initial frames and velocities.

        Args:
            scene: What there is.
            duration: End time; a multiple of ``step``.
            step: Step size h; or :class:`~fem_lie.AdaptiveStep`, which chooses it by a tolerance,
                or :class:`~fem_lie.ConstantStep`, which estimates the error of each step, too.
            save_every: Keep every so many steps.
            progress: Show a bar; default: if standard error is a terminal.
            file: Where results go as they are made, instead of into memory; the result reads them
                from there. With it :meth:`resume` can go on after an interruption.
            checkpoint_every: Steps between two checkpoints; default: a hundredth of all.

        Raises:
            ValueError: Bad options or scene, before anything is computed.
            ConvergenceError: A step failed; its ``result`` holds what was computed.
        """
        if save_every < 1:
            raise ValueError(f"save_every must be at least 1, got {save_every}")
        if isinstance(step, StepChoice):
            if file is not None or checkpoint_every is not None:
                raise ValueError("results go to a file as they are made with constant steps only")
            from fem_lie.solve import variable_steps

            return variable_steps.run(self, scene, duration, step, save_every, progress)
        if not (np.isfinite(step) and step > 0 and np.isfinite(duration) and duration > 0):
            raise ValueError(f"step and duration must be positive, got {step} and {duration}")
        steps = round(duration / step)
        if steps < 1 or abs(steps * step - duration) > 1e-6 * step:
            raise ValueError(f"duration {duration} is not a multiple of the step {step}")
        if file is None and checkpoint_every is not None:
            raise ValueError("checkpoint_every needs a file to which results go")
        exponential = self.parametrisation == Parametrisation.EXPONENTIAL
        # the loop for free bodies has no checkpoints: with a file they take the general road
        if file is None and exponential and free_bodies.applies(scene, self.policy):
            _log.info("free rigid bodies only (%d): no matrix of the scene", len(scene.bodies))
            return free_bodies.Run(self, scene, step).integrate(steps, save_every, progress)
        system = System(scene, dynamics=True, parametrisation=self.parametrisation)
        run, store = _Run(self, system, step), None
        if file is not None:
            every = max(1, steps // 100) if checkpoint_every is None else checkpoint_every
            store = Checkpoints(file, every, (steps, step, save_every), fingerprint(system, self))
        return run.integrate(Recorder(run.system, steps, step, save_every, progress, store))

    def resume(
        self, scene: Scene, file: str | os.PathLike[str], *, progress: bool | None = None
    ) -> Result:
        """Go on from the last checkpoint of an interrupted run, to the same end.

        Args:
            scene: The scene as it was given to :meth:`run`.
            file: The file that was given.
            progress: Show a bar; default: if standard error is a terminal.

        Returns:
            To the last bit what :meth:`run` would have returned, but for the seconds.

        Raises:
            FileNotFoundError: There is no such file, or no checkpoint yet.
            ValueError: The checkpoint belongs to another scene or other options.
        """
        system = System(scene, dynamics=True, parametrisation=self.parametrisation)
        store = Checkpoints.resume(file, fingerprint(system, self))
        steps, step, save_every = store.plan
        recorder = Recorder(system, steps, step, save_every, progress, store)
        run = _Run(self, system, step)
        run.restore(store.memory)
        return run.integrate(recorder)


class _Run:
    """State of one integration."""

    def __init__(self, options: GeneralisedAlpha, system: System, step: float) -> None:
        self.options, self.system = options, system
        self.p = parameters(options.radius, step, system.length)
        system.velocity_factor = 1.0 / self.p.damping
        self.policy = options.policy.fresh()
        self.policy.bound = system.m > 0
        self.s = State.start(system.frames, system.kinds)
        spin = float(np.abs(system.velocities[:, 3:]).max())
        system.choices = system.scene.choices.resolve(spin * step)
        _log.info("%s; matrix: %s", system.describe(), type(options.policy).__name__)
        self._projects = options.index == Index.STABILISED_TWO and system.m > 0
        self._turned = options.components == Components.INERTIAL
        if self._turned and system.supports:
            raise ValueError("supports along fixed axes (Shell.guide) need Components.LOCAL")
        self._plain = tuple(self.p), tuple(self.s)
        self.weights, self.scale = np.zeros(system.m), np.ones(system.m)
        turns = system.connections.angular
        self.measure = np.where(turns, ROTATION, 1.0 / system.length)
        methods = methods_in_time(system)
        self.solver = DirectSolver(system.kkt.matrix, options.petsc_options_prefix, methods)
        self.r, self.dx = self.solver.right_hand_side, self.solver.solution
        self._last_ratio, self._motion, self._index, self._born = 1.0, 0.0, 0, 0
        self._end = 0.0

    # --- start ---

    def start(self) -> None:
        """Consistent accelerations and multipliers; scaling of the constraints."""
        system, p, s = self.system, self.p, self.s
        check_velocities(system, p.h)
        self.weights[:] = set_start(system, self.solver, p, s)
        system.set_time(0.0)
        system.residual(s.H, s.twist1, s.rate1, self.weights, self.scale, self.r)
        self._fill(s.H, s.H, turned=False)
        self.scale[:] = system.tangent.constraint_scale(s.H)
        self._warm_up()

    def _warm_up(self) -> None:
        """Compile what a step needs on a copy of the state: compilation is not integration."""
        scheme, state = self._plain[0], tuple(x.copy() for x in self.s)
        predict(scheme, state)
        zero, weights = np.zeros_like(self.dx), self.weights.copy()
        correct(scheme, state, zero, self.scale, self.measure, weights)
        accept(scheme, state)
        estimate(1.0, np.inf, 1.0)
        if self._turned:
            self._fill(self.s.H, self.s.H, turned=True)
            turn_all(self.s.H, zero, self.system.count)
            turn_all_back(self.s.H, zero, self.system.count)

    # --- steps ---

    def integrate(self, recorder: Recorder) -> Result:
        """All steps."""
        system, s, h = self.system, self.s, self.p.h
        if recorder.row == 0:
            self.start()
            self.solver.factorisations = self.solver.refreshes = 0
            recorder.record(0, s.H, s.twist1, self.weights, 0)
        begin = clock.perf_counter() - recorder.seconds
        with recorder:
            for index in range(self._index + 1, recorder.steps + 1):
                if system.time_dependent:
                    system.set_time(index * h)
                    s.H1[system.count + 1 :] = system.prescribed_frames(index * h)
                self._index, self._end = index, index * h
                iterations = self._step()
                if iterations == 0:
                    seconds = clock.perf_counter() - begin
                    result = self._result(recorder, seconds)
                    raise ConvergenceError(self._failure(recorder.steps), result)
                system.connections.accept(s.H)
                recorder.record(index, s.H, s.twist1, self.weights, iterations)
                if recorder.checkpoint_due(index):
                    recorder.seconds = clock.perf_counter() - begin
                    recorder.write_checkpoint(self.memory())
        return self._result(recorder, clock.perf_counter() - begin)

    def _result(self, recorder: Recorder, seconds: float) -> Result:
        return recorder.result(self.solver.factorisations, seconds, self.solver.refreshes)

    def memory(self) -> dict[str, Array]:
        """All that the next steps depend on."""
        numbers = [self._last_ratio, self._motion, self._index, self._born]
        kept = {"H": self.s.H, "H1": self.s.H1, "motion": self.s.motion, "weights": self.weights}
        kept |= {"scale": self.scale, "numbers": np.array(numbers, dtype=np.float64)}
        kept |= {"matrix": self.system.kkt.csr[0], "blocks": self.system.tangent.A}
        counts = [self.solver.factorisations, self.solver.refreshes]
        kept |= {"counts": np.array(counts), "joints": self.system.connections.memory}
        carried = self.system.elastic.carried()
        kept |= {f"carried.{k}": part for k, part in enumerate(carried)}
        return kept | {f"policy.{name}": np.array(x) for name, x in vars(self.policy).items()}

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Be as when :meth:`memory` was called."""
        s, system = self.s, self.system
        s.H[:], s.H1[:], s.motion[:] = kept["H"], kept["H1"], kept["motion"]
        self.weights[:], self.scale[:] = kept["weights"], kept["scale"]
        self._last_ratio, self._motion = (float(x) for x in kept["numbers"][:2])
        self._index, self._born = (int(x) for x in kept["numbers"][2:])
        if system.time_dependent:
            system.set_time(self._index * self.p.h)
        carried = range(len(system.elastic.carried()))
        system.elastic.restore([kept[f"carried.{k}"] for k in carried])
        for name, value in vars(self.policy).items():
            setattr(self.policy, name, type(value)(kept[f"policy.{name}"]))
        system.connections.memory = kept["joints"]
        system.kkt.csr[0][:], system.tangent.A[:] = kept["matrix"], kept["blocks"]
        system.kkt.matrix.stateIncrease()
        system.kkt.matrix.assemble()
        self.solver.factorise()
        self.solver.factorisations, self.solver.refreshes = (int(x) for x in kept["counts"])

    def _failure(self, steps: int) -> str:
        limit, tolerance = self.options.max_iterations, self.options.tolerance
        residual = float(np.abs(self.r).max())
        return failure(self._index, steps, self.p.h, limit, self._increment, residual, tolerance)

    def _step(self) -> int:
        """One step; returns its iterations, 0 if it failed.

        A step that diverges with the kept matrix is done again with a new one in every iteration
        and with the stress as an iterate.
        """
        weights = self.weights.copy()
        count = self._iterate(self.policy, carried=False)
        if count == 0 and self.policy.rescue:
            _log.info("step %d: kept matrix diverges, full iteration", self._index)
            self.weights[:] = weights
            # the predicted end of the step may be far off: its stress is no start
            self.system.elastic.reset_stress(self.s.H)
            count = self._iterate(EveryIteration(), carried=True)
        return count

    def _iterate(self, policy: Policy, *, carried: bool) -> int:
        """Predict, and correct until it converges; returns the iterations, 0 on failure."""
        try:
            return self._newton(policy, carried)
        except SingularMatrixError:
            self._increment = np.inf
            return 0

    def _newton(self, policy: Policy, carried: bool) -> int:
        system, s = self.system, self.s
        self._motion = max(predict(*self._plain), self._motion)
        tolerance = self._tolerance()
        previous, ratio = np.inf, self._last_ratio
        for iteration in range(1, self.options.max_iterations + 1):
            if not carried:
                system.elastic.settle(s.H1)
            system.residual(s.H1, s.twist1, s.rate1, self.weights, self.scale, self.r)
            update = policy.before_iteration(iteration)
            if self.solver.factorisations == 0 or update == Update.ALL or update is True:
                self._factorise(None if carried else s.H1)
            elif update == Update.CONSTRAINTS:
                self._refresh()
            self._solve()
            if carried:
                h = np.empty_like(s.d)
                twists(s.kinds, s.d, -self.dx[: s.d.size].reshape(-1, 6), h)
                system.elastic.carry(s.H1, h.ravel())
            self._increment = correct(*self._plain, self.dx, self.scale, self.measure, self.weights)
            ratio, remaining = estimate(self._increment, previous, ratio)
            stagnant = carried and ratio > 0.5 and self._increment < _STAGNATION
            if remaining <= tolerance or self._increment <= ROUND_OFF or stagnant:
                self._last_ratio = ratio if iteration > 1 else ratio**UNMEASURED
                policy.after_step(iteration)
                if policy.asks and not self._turned:
                    policy.answer(iteration, ratio, self._staleness())
                if self._projects:
                    project(system, self.solver, s, self.scale, self._end, self.p.h)
                accept(*self._plain)
                if system.carried_drilling:
                    system.carried_drilling.turn_motion(s.H, s.motion, s.kinds, WRITTEN_LOCALLY)
                return iteration
            if not self._increment < DIVERGED:
                return 0
            previous = self._increment
        return 0

    def _staleness(self) -> float:
        """See :mod:`fem_lie.solve.staleness`; in the direction of the last correction."""
        x = self.dx.copy()
        back_to_local(self.s.H1, self.s.kinds, x)
        weights, scale, measure = self.weights, self.scale, self.measure
        return staleness(
            self.system, self.solver, self._plain[0], self.s, weights, scale, measure, x
        )

    def _tolerance(self) -> float:
        """Error that the iteration of a step may leave, see :data:`~.scheme.ROTATION`."""
        return max(self.options.tolerance * self._motion, ROUND_OFF)

    def _solve(self) -> None:
        """Solve; the residual and the solution are in local components."""
        system, H1, n = self.system, self.s.H1, self.system.count
        if self._turned:
            turn_all(H1, self.r, n)
        self.solver.solve()
        if self._turned:
            turn_all_back(H1, self.dx, n)
        if system.supports:
            system.supports.turn_back(H1, self.dx[: 6 * n].reshape(-1, 6))

    def _factorise(self, stressed: Array | None) -> None:
        """New matrix; ``stressed``: frames whose stress it has, ``None`` for the carried one."""
        self._fill(stressed, self._ahead(), turned=self._turned)
        self.solver.factorise()

    def _refresh(self) -> None:
        """The constraints anew in the kept matrix."""
        if self._turned:
            self._factorise(self.s.H1)
            return
        tangent, s = self.system.tangent, self.s
        tangent.refill_border(self._ahead(), s.kinds, s.d, self.scale)
        self.solver.refresh()

    def _fill(self, stressed: Array | None, joint_frames: Array, *, turned: bool) -> None:
        if not self.system.choices.geometric:
            self.system.elastic.clear_stress()
        elif stressed is not None:
            self.system.elastic.reset_stress(stressed)
        s = self.s
        self.system.fill_matrix(
            s.H1,
            s.twist1,
            s.rate1,
            self.weights,
            self.scale,
            s.d,
            self.p.mass,
            self.p.damping,
            joint_frames,
            inertial=turned,
        )

    def _ahead(self) -> Array:
        """Frames in the middle of the time for which the matrix is likely to be kept.

        Only the constraints' Jacobian is taken there: it turns with the bodies, the rest does not.
        """
        steps = (self._index - self._born) // 2
        self._born = self._index
        s, frames = self.s, self.s.H1.copy()
        n = len(s.kinds)
        # along a screw motion on either group: joints stay closed
        frames[:n] = lie.se3_retract(s.H1[:n], steps * self.p.h * s.twist1)
        return frames
