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

import numpy as np

from fem_lie import constraints, lie
from fem_lie._jit import Array, compiled
from fem_lie.results import Result
from fem_lie.scene import Scene
from fem_lie.solve.linear import ConvergenceError, DirectSolver, SingularMatrixError
from fem_lie.solve.policies import Automatic, EveryIteration, Policy
from fem_lie.solve.recorder import Recorder
from fem_lie.system import System

_log = logging.getLogger(__name__)

ROTATION = 0.1
"""In the size of an increment a rotation counts as a displacement of this part of the model's size."""

_ROUND_OFF = 1e-15  # increments below are round-off, whatever their ratio
_STAGNATION = 1e-6  # full Newton that no longer contracts below this has met round-off


@compiled
def _predict(v, vdot, a, h, am, af, gamma, beta, length, H, d, v1, vdot1, H1):  # type: ignore[no-untyped-def]
    """Start a step with the old ``v̇``; returns the size of the motion, see :data:`ROTATION`."""
    largest = 0.0
    for i in range(d.shape[0]):
        for k in range(6):
            vdot1[i, k] = vdot[i, k]
            a1 = (vdot[i, k] - am * a[i, k]) / (1.0 - am)
            d[i, k] = h * v[i, k] + h * h * ((0.5 - beta) * a[i, k] + beta * a1)
            v1[i, k] = v[i, k] + h * ((1.0 - gamma) * a[i, k] + gamma * a1)
            largest = max(largest, abs(d[i, k]) / length if k < 3 else ROTATION * abs(d[i, k]))
        lie.retract(H[i], d[i], H1[i])
    return largest


@compiled
def _correct(dx, scale, measure, length, mass, damping, H, d, v1, vdot1, weights, H1):  # type: ignore[no-untyped-def]
    """Apply a Newton correction; returns its size, see :data:`ROTATION`."""
    largest = 0.0
    for i in range(d.shape[0]):
        for k in range(6):
            x = dx[6 * i + k]
            d[i, k] -= x
            v1[i, k] -= damping * x
            vdot1[i, k] -= mass * x
            size = abs(x) / length if k < 3 else ROTATION * abs(x)
            if not size <= largest:
                largest = size
        lie.retract(H[i], d[i], H1[i])
    at = 6 * d.shape[0]
    for c in range(weights.shape[0]):
        weights[c] -= scale[c] * dx[at + c]
        # scaled multipliers are displacements that the matrix turns into the joint's force
        size = abs(dx[at + c]) * measure[c]
        if not size <= largest:
            largest = size
    return largest


@compiled
def _accept(am, af, v, vdot, a, H, v1, vdot1, H1):  # type: ignore[no-untyped-def]
    """Make the end of the step the start of the next."""
    for i in range(vdot1.shape[0]):
        for k in range(6):
            a[i, k] = ((1.0 - af) * vdot1[i, k] + af * vdot[i, k] - am * a[i, k]) / (1.0 - am)
            v[i, k] = v1[i, k]
            vdot[i, k] = vdot1[i, k]
        lie.reorthonormalise(H1[i])
        H[i] = H1[i]


@dataclass(frozen=True)
class GeneralisedAlpha:
    """Options of the scheme; :meth:`run` integrates.

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
        run = _Run(self, System(scene, dynamics=True), step)
        return run.integrate(Recorder(run.system, steps, step, save_every, progress))


class _Run:
    """State of one integration."""

    def __init__(self, scheme: GeneralisedAlpha, system: System, step: float) -> None:
        rho = scheme.radius
        self.scheme, self.system, self.h = scheme, system, step
        self.am, self.af = (2 * rho - 1) / (rho + 1), rho / (rho + 1)
        self.gamma = 0.5 + self.af - self.am
        self.beta = 0.25 * (self.gamma + 0.5) ** 2
        self.mass = (1 - self.am) / (step**2 * self.beta * (1 - self.af))
        self.damping = self.gamma / (step * self.beta)
        self.policy = scheme.policy.fresh()
        n = system.count
        self.H, self.v = system.frames.copy(), system.velocities.copy()
        self.H1, self.v1 = self.H.copy(), self.v.copy()
        self.vdot, self.vdot1, self.a, self.d = (np.zeros((n, 6)) for _ in range(4))
        self.weights, self.scale = np.zeros(system.m), np.ones(system.m)
        turns = ~system.table.selection[:, :3].any(axis=1)
        self.measure = np.where(turns, ROTATION, 1.0 / system.length)
        self.r, self.dx = np.zeros(system.size), np.zeros(system.size)
        self.solver = DirectSolver(system.kkt.matrix, scheme.petsc_options_prefix)
        self.solver.bind(self.r, self.dx)
        self._last_ratio, self._motion, self._index, self._born = 1.0, 0.0, 0, 0

    # --- start ---

    def start(self) -> None:
        """Consistent accelerations and multipliers; scaling of the constraints."""
        system, h = self.system, self.h
        self._check_velocities()
        self.vdot[:], self.weights[:] = self._accelerations(self.H, self.v, 0.0)
        # a₀ stands for v̇ at t₀ + (α_m − α_f) h, or the start is only first order
        # (Arnold, Brüls & Cardona, Numer. Math. 129 (2015) 149); extrapolated from t₀ + shift
        shift = (self.af - self.am) * h
        if shift > 0:
            n = system.count
            H, v = self.H.copy(), self.v.copy()
            d = shift * v[:n] + 0.5 * shift**2 * self.vdot
            H[:n] = lie.se3_retract(H[:n], d)
            v[:n] += shift * self.vdot
            later, _ = self._accelerations(H, v, shift)
            self.a[:] = 2.0 * self.vdot - later
        else:
            self.a[:] = self.vdot
        system.set_time(0.0)
        system.residual(self.H, self.v, self.vdot, self.weights, self.scale, self.r)
        self._fill(self.H, self.H)
        self.scale[:] = system.constraint_scale(self.H)

    def _check_velocities(self) -> None:
        system = self.system
        self._set_motion_velocities(0.0)
        first, second = np.zeros(system.m), np.zeros(system.m)
        constraints.rates(self.H, self.v, system.table, first, second)
        speed = max(np.abs(self.v[:, :3]).max() / system.length, np.abs(self.v[:, 3:]).max())
        # below the second bound the error of a whole step is less than 1e-9 of the size
        bound = max(1e-6 * speed, 1e-9 / self.h) * max(1.0, system.length)
        if (np.abs(first) > bound).any():
            c = int(np.abs(first).argmax())
            joint = system.joints[np.searchsorted(system.table.first, c, side="right") - 1]
            raise ValueError(
                f"the initial velocities break {joint.label}: its constraint changes at the rate "
                f"{first[c]:g}; give both bodies velocities that the joint allows"
            )

    def _set_motion_velocities(self, time: float) -> Array:
        """Velocities of prescribed frames into ``v``; returns their accelerations (p, 6)."""
        system, h = self.system, self.h
        if system.count + 1 == len(self.H):
            return np.zeros((0, 6))
        here = system.prescribed_frames(time)
        d = [lie.se3_relative(here, system.prescribed_frames(time + k * h)) for k in (1, 2, 3)]
        # d(t) = v t + v̇ t²/2 + j t³/6 through three later times
        self.v[system.count + 1 :] = (18 * d[0] - 9 * d[1] + 2 * d[2]) / (6 * h)
        return (-5 * d[0] + 4 * d[1] - d[2]) / h**2

    def _accelerations(self, H: Array, v: Array, time: float) -> tuple[Array, Array]:
        """``v̇`` and multipliers from the equations of motion and twice differentiated constraints."""
        system, n = self.system, self.system.count
        driven = self._set_motion_velocities(time)
        v[n + 1 :] = self.v[n + 1 :]
        if len(driven):
            H = np.concatenate([H[: n + 1], system.prescribed_frames(time)])
        system.set_time(time)
        zero, none, one = np.zeros((n, 6)), np.zeros(system.m), np.ones(system.m)
        system.residual(H, v, zero, none, one, self.r)
        first, second, drive = np.zeros(system.m), np.zeros(system.m), np.zeros(system.m)
        constraints.rates(H, v, system.table, first, second)
        if len(driven):
            rate = np.zeros_like(v)
            rate[n + 1 :] = driven
            constraints.rates(H, rate, system.table, drive, first)
        self.r[6 * n :] = second + drive
        system.fill_mass_matrix(H)
        try:
            self.solver.factorise()
        except SingularMatrixError as error:
            raise ValueError(
                "the mass matrix is singular: a body or section lacks inertia, or its rotary inertia"
            ) from error
        self.solver.solve()
        return -self.dx[: 6 * n].reshape(n, 6), -self.dx[6 * n :].copy()

    # --- steps ---

    def integrate(self, recorder: Recorder) -> Result:
        """All steps."""
        system = self.system
        self.start()
        self.solver.factorisations = 0
        recorder.record(0, self.H, self.v, self.weights, 0)
        begin = clock.perf_counter()
        with recorder:
            for index in range(1, recorder.steps + 1):
                if system.time_dependent:
                    system.set_time(index * self.h)
                    self.H1[system.count + 1 :] = system.prescribed_frames(index * self.h)
                self._index = index
                iterations = self._step()
                if iterations == 0:
                    seconds = clock.perf_counter() - begin
                    result = recorder.result(self.solver.factorisations, seconds)
                    raise ConvergenceError(
                        f"step {index} of {recorder.steps} (time {index * self.h:g}) did not "
                        f"converge in {self.scheme.max_iterations} iterations: last increment "
                        f"{self._increment:.2e}, residual {np.abs(self.r).max():.2e}, tolerance "
                        f"{self.scheme.tolerance:g}. Try a smaller step, a larger tolerance, or "
                        "policy=EveryIteration()",
                        result,
                    )
                recorder.record(index, self.H, self.v, self.weights, iterations)
        result = recorder.result(self.solver.factorisations, clock.perf_counter() - begin)
        self.solver.destroy()
        return result

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
            self.system.reset_stress(self.H)
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
        system = self.system
        motion = _predict(
            self.v,
            self.vdot,
            self.a,
            self.h,
            self.am,
            self.af,
            self.gamma,
            self.beta,
            system.length,
            self.H,
            self.d,
            self.v1,
            self.vdot1,
            self.H1,
        )
        self._motion = max(motion, self._motion)
        tolerance = max(self.scheme.tolerance * self._motion, _ROUND_OFF)
        previous, ratio = np.inf, self._last_ratio
        for iteration in range(1, self.scheme.max_iterations + 1):
            system.residual(self.H1, self.v1, self.vdot1, self.weights, self.scale, self.r)
            if policy.before_iteration(iteration) or self.solver.factorisations == 0:
                self._factorise(None if carried else self.H1)
            self.solver.solve()
            if carried:
                twists = lie.se3_tangent(self.d) @ -self.dx[: self.d.size].reshape(-1, 6, 1)
                system.carry_stress(self.H1, twists.ravel())
            self._increment = _correct(
                self.dx,
                self.scale,
                self.measure,
                system.length,
                self.mass,
                self.damping,
                self.H,
                self.d,
                self.v1,
                self.vdot1,
                self.weights,
                self.H1,
            )
            if previous < np.inf:
                # one lucky ratio must not end the next steps too early: forget slowly
                ratio = max(self._increment / previous, 0.7 * ratio)
            # the sum of all further increments of a linearly converging iteration
            remaining = self._increment * ratio / (1.0 - ratio) if ratio < 1.0 else np.inf
            stagnant = carried and ratio > 0.5 and self._increment < _STAGNATION
            if remaining <= tolerance or self._increment <= _ROUND_OFF or stagnant:
                self._last_ratio = ratio
                policy.after_step(iteration)
                _accept(
                    self.am,
                    self.af,
                    self.v,
                    self.vdot,
                    self.a,
                    self.H,
                    self.v1,
                    self.vdot1,
                    self.H1,
                )
                return iteration
            if not self._increment < 1e3:
                return 0
            previous = self._increment
        return 0

    def _factorise(self, stressed: Array | None) -> None:
        """New matrix; ``stressed``: frames whose stress it has, ``None`` for the carried one."""
        self._fill(stressed, self._ahead())
        self.solver.factorise()

    def _fill(self, stressed: Array | None, joint_frames: Array) -> None:
        if stressed is not None:
            self.system.reset_stress(stressed)
        self.system.fill_matrix(
            self.H1,
            self.v1,
            self.vdot1,
            self.weights,
            self.scale,
            self.d,
            self.mass,
            self.damping,
            joint_frames,
        )

    def _ahead(self) -> Array:
        """Frames in the middle of the time for which the matrix is likely to be kept.

        Only the constraints' Jacobian is taken there: it turns with the bodies, the rest does not.
        """
        steps = (self._index - self._born) // 2
        self._born = self._index
        frames = self.H1.copy()
        n = self.system.count
        frames[:n] = lie.se3_retract(frames[:n], steps * self.h * self.v1[:n])
        return frames
