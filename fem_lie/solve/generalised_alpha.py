"""Generalised-α on SE(3) in local frames, index 3, with a kept iteration matrix.

Brüls, Cardona & Arnold, Mech. Mach. Theory 48 (2012) 121. With ``d`` the increment of a step::

    d = h v + h² ((½ − β) a + β a₁)            H₁ = H exp(d)
    v₁ = v + h ((1 − γ) a + γ a₁)              (1 − α_m) a₁ + α_m a = (1 − α_f) v̇₁ + α_f v̇

and the equations of motion at the end of the step. Constraints are scaled as in Bottasso, Bauchau &
Cardona, SIAM J. Sci. Comput. 29 (2007) 397, which makes the conditioning independent of h.
"""

from __future__ import annotations

import logging
import time as clock
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from fem_lie import lie
from fem_lie._jit import Array, compiled
from fem_lie.results import Result
from fem_lie.scene import Scene
from fem_lie.solve import free_bodies, scheme
from fem_lie.solve.linear import ConvergenceError, DirectSolver, SingularMatrixError
from fem_lie.solve.policies import Automatic, EveryIteration, Policy
from fem_lie.solve.recorder import Recorder
from fem_lie.solve.start import accelerations, check_velocities
from fem_lie.system import System

_log = logging.getLogger(__name__)

_STAGNATION = 1e-6  # full Newton that no longer contracts below this has met round-off


class _State(NamedTuple):
    """Start of a step, and its end with index 1; ``d`` is the increment between them."""

    H: Array
    v: Array
    vdot: Array
    a: Array
    d: Array
    H1: Array
    v1: Array
    vdot1: Array


# Compiled functions take these records as plain tuples: numba is three times as fast to call so.


@compiled
def _predict(parameters: tuple[float, ...], state: tuple[Array, ...]) -> float:
    """Start a step; returns the size of the motion, see :data:`scheme.ROTATION`."""
    H, v, vdot, a, d, H1, v1, vdot1 = state
    largest = 0.0
    for i in range(d.shape[0]):
        size = scheme.predict(
            parameters, scheme.SE3, H[i], v[i], vdot[i], a[i], d[i], H1[i], v1[i], vdot1[i]
        )
        largest = max(largest, size)
    return largest


@compiled
def _correct(
    parameters: tuple[float, ...],
    state: tuple[Array, ...],
    dx: Array,
    scale: Array,
    measure: Array,
    weights: Array,
) -> float:
    """Apply a Newton correction; returns its size, see :data:`scheme.ROTATION`."""
    H, _, _, _, d, H1, v1, vdot1 = state
    largest = 0.0
    for i in range(d.shape[0]):
        part = dx[6 * i : 6 * i + 6]
        size = scheme.correct(parameters, scheme.SE3, part, H[i], d[i], H1[i], v1[i], vdot1[i])
        if size > largest or size != size:  # nan stays
            largest = size
    at = 6 * d.shape[0]
    for c in range(weights.shape[0]):
        weights[c] -= scale[c] * dx[at + c]
        # scaled multipliers are displacements that the matrix turns into the joint's force
        size = abs(dx[at + c]) * measure[c]
        if size > largest or size != size:
            largest = size
    return largest


@compiled
def _accept(parameters: tuple[float, ...], state: tuple[Array, ...]) -> None:
    """Make the end of the step the start of the next."""
    H, v, vdot, a, _, H1, v1, vdot1 = state
    for i in range(a.shape[0]):
        scheme.accept(parameters, scheme.SE3, H[i], v[i], vdot[i], a[i], H1[i], v1[i], vdot1[i])
    H[:] = H1  # with the prescribed frames


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
        petsc_options_prefix: Prefix for the choice of the linear solver.
    """

    radius: float = 0.8
    tolerance: float = 2e-8
    policy: Policy = field(default_factory=Automatic)
    max_iterations: int = 30
    petsc_options_prefix: str = "fem_lie_dynamics_"

    def __post_init__(self) -> None:
        """Check the options."""
        if not 0.0 <= self.radius <= 1.0:
            raise ValueError(f"the spectral radius must be in [0, 1], got {self.radius}")
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
        step: float,
        save_every: int = 1,
        progress: bool | None = None,
    ) -> Result:
        """Integrate from the bodies' initial frames and velocities.

        Args:
            scene: What there is.
            duration: End time; a multiple of ``step``.
            step: Step size h.
            save_every: Keep every so many steps.
            progress: Show a bar; default: if standard error is a terminal.

        Raises:
            ValueError: Bad options or scene, before anything is computed.
            ConvergenceError: A step failed; its ``result`` holds what was computed.
        """
        if not (np.isfinite(step) and step > 0 and np.isfinite(duration) and duration > 0):
            raise ValueError(f"step and duration must be positive, got {step} and {duration}")
        steps = round(duration / step)
        if steps < 1 or abs(steps * step - duration) > 1e-6 * step:
            raise ValueError(f"duration {duration} is not a multiple of the step {step}")
        if save_every < 1:
            raise ValueError(f"save_every must be at least 1, got {save_every}")
        if free_bodies.applies(scene, self.policy):
            _log.info("free rigid bodies only (%d): no matrix of the scene", len(scene.bodies))
            return free_bodies.Run(self, scene, step).integrate(steps, save_every, progress)
        run = _Run(self, System(scene, dynamics=True), step)
        return run.integrate(Recorder(run.system, steps, step, save_every, progress))


class _Run:
    """State of one integration."""

    def __init__(self, options: GeneralisedAlpha, system: System, step: float) -> None:
        self.options, self.system = options, system
        self.p = scheme.parameters(options.radius, step, system.length)
        self.policy = options.policy.fresh()
        H, v, zero = system.frames, system.velocities, np.zeros((system.count, 6))
        self.s = _State(*(x.copy() for x in (H, v, zero, zero, zero, H, v, zero)))
        self._plain = tuple(self.p), tuple(self.s)
        self.weights, self.scale = np.zeros(system.m), np.ones(system.m)
        turns = ~system.table.selection[:, :3].any(axis=1)
        self.measure = np.where(turns, scheme.ROTATION, 1.0 / system.length)
        self.solver = DirectSolver(system.kkt.matrix, options.petsc_options_prefix)
        self.r, self.dx = self.solver.right_hand_side, self.solver.solution
        self._last_ratio, self._motion, self._index, self._born = 1.0, 0.0, 0, 0

    # --- start ---

    def start(self) -> None:
        """Consistent accelerations and multipliers; scaling of the constraints."""
        system, p, s = self.system, self.p, self.s
        check_velocities(system, p.h)
        vdot, weights = accelerations(system, self.solver, s.H, s.v, 0.0, p.h)
        s.vdot[:], self.weights[:] = vdot, weights
        # a₀ stands for v̇ at t₀ + (α_m − α_f) h, or the start is only first order
        # (Arnold, Brüls & Cardona, Numer. Math. 129 (2015) 149); extrapolated from t₀ + shift
        shift = (p.af - p.am) * p.h
        s.a[:] = vdot
        if shift > 0:
            n = system.count
            H, v = s.H.copy(), s.v.copy()
            H[:n] = lie.se3_retract(H[:n], shift * v[:n] + 0.5 * shift**2 * vdot)
            v[:n] += shift * vdot
            later, _ = accelerations(system, self.solver, H, v, shift, p.h)
            s.a[:] += vdot - later
        system.set_time(0.0)
        system.residual(s.H, s.v, s.vdot, self.weights, self.scale, self.r)
        self._fill(s.H, s.H)
        self.scale[:] = system.constraint_scale(s.H)
        self._warm_up()

    def _warm_up(self) -> None:
        """Compile what a step needs on a copy of the state: compilation is not integration."""
        parameters, state = self._plain[0], tuple(x.copy() for x in self.s)
        _predict(parameters, state)
        zero, weights = np.zeros_like(self.dx), self.weights.copy()
        _correct(parameters, state, zero, self.scale, self.measure, weights)
        _accept(parameters, state)

    # --- steps ---

    def integrate(self, recorder: Recorder) -> Result:
        """All steps."""
        system, s, h = self.system, self.s, self.p.h
        self.start()
        self.solver.factorisations = 0
        recorder.record(0, s.H, s.v, self.weights, 0)
        begin = clock.perf_counter()
        with recorder:
            for index in range(1, recorder.steps + 1):
                if system.time_dependent:
                    system.set_time(index * h)
                    s.H1[system.count + 1 :] = system.prescribed_frames(index * h)
                self._index = index
                iterations = self._step()
                if iterations == 0:
                    seconds = clock.perf_counter() - begin
                    result = recorder.result(self.solver.factorisations, seconds)
                    raise ConvergenceError(self._failure(recorder.steps), result)
                recorder.record(index, s.H, s.v, self.weights, iterations)
        return recorder.result(self.solver.factorisations, clock.perf_counter() - begin)

    def _failure(self, steps: int) -> str:
        residual = float(np.abs(self.r).max())
        limit, tolerance = self.options.max_iterations, self.options.tolerance
        return scheme.failure(
            self._index, steps, self.p.h, limit, self._increment, residual, tolerance
        )

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
        self._motion = max(_predict(*self._plain), self._motion)
        tolerance = max(self.options.tolerance * self._motion, scheme.ROUND_OFF)
        previous, ratio = np.inf, self._last_ratio
        for iteration in range(1, self.options.max_iterations + 1):
            system.residual(s.H1, s.v1, s.vdot1, self.weights, self.scale, self.r)
            if policy.before_iteration(iteration) or self.solver.factorisations == 0:
                self._factorise(None if carried else s.H1)
            self.solver.solve()
            if carried:
                twists = lie.se3_tangent(s.d) @ -self.dx[: s.d.size].reshape(-1, 6, 1)
                system.elastic.carry(s.H1, twists.ravel())
            self._increment = _correct(
                *self._plain, self.dx, self.scale, self.measure, self.weights
            )
            if previous < np.inf:
                # one lucky ratio must not end the next steps too early: forget slowly
                ratio = max(self._increment / previous, 0.7 * ratio)
            # the sum of all further increments of a linearly converging iteration
            remaining = self._increment * ratio / (1.0 - ratio) if ratio < 1.0 else np.inf
            stagnant = carried and ratio > 0.5 and self._increment < _STAGNATION
            if remaining <= tolerance or self._increment <= scheme.ROUND_OFF or stagnant:
                # not measured in this step: trust it less and less, until it is measured again
                self._last_ratio = ratio if iteration > 1 else ratio**0.8
                policy.after_step(iteration)
                _accept(*self._plain)
                return iteration
            if not self._increment < scheme.DIVERGED:
                return 0
            previous = self._increment
        return 0

    def _factorise(self, stressed: Array | None) -> None:
        """New matrix; ``stressed``: frames whose stress it has, ``None`` for the carried one."""
        self._fill(stressed, self._ahead())
        self.solver.factorise()

    def _fill(self, stressed: Array | None, joint_frames: Array) -> None:
        if stressed is not None:
            self.system.elastic.reset_stress(stressed)
        s = self.s
        self.system.fill_matrix(
            s.H1,
            s.v1,
            s.vdot1,
            self.weights,
            self.scale,
            s.d,
            self.p.mass,
            self.p.damping,
            joint_frames,
        )

    def _ahead(self) -> Array:
        """Frames in the middle of the time for which the matrix is likely to be kept.

        Only the constraints' Jacobian is taken there: it turns with the bodies, the rest does not.
        """
        steps = (self._index - self._born) // 2
        self._born = self._index
        frames, n = self.s.H1.copy(), self.system.count
        frames[:n] = lie.se3_retract(frames[:n], steps * self.p.h * self.s.v1[:n])
        return frames
