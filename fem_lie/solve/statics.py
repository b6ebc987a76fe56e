"""Statics by load steps: Newton's method on the group with the stress as an iterate."""

from __future__ import annotations

import logging
import os
import time as clock
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from fem_lie import lie
from fem_lie._jit import Array, compiled
from fem_lie.bodies import Point
from fem_lie.elements.shell_maps import retract
from fem_lie.info import SceneInfo
from fem_lie.joints import Connection
from fem_lie.plot import SI, Units
from fem_lie.scene import Scene
from fem_lie.solve.linear import (
    ConvergenceError,
    DirectSolver,
    SingularMatrixError,
    methods_for,
)
from fem_lie.solve.rotation import Rotation
from fem_lie.solve.steady import fill_steady
from fem_lie.system import System

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Flags = npt.NDArray[np.bool_]

_log = logging.getLogger(__name__)


@compiled
def advance(H: Array, dx: Array, held: Flags, uncoupled: Flags, size: float) -> float:
    """Move the nodes by ``−dx``; returns the largest increment over ``size``.

    ``H ← H exp(−dx)``, or for uncoupled nodes the motion of :mod:`fem_lie.elements.shell_maps`.
    """
    largest, h = 0.0, np.empty((1, 6))
    for i in range(held.shape[0]):
        if not held[i].all():
            for k in range(6):
                h[0, k] = -dx[6 * i + k]
                step = abs(h[0, k]) / (size if k < 3 else 1.0)
                if step > largest or step != step:  # nan stays
                    largest = step
            if uncoupled[i]:
                retract(H[i : i + 1], h)
            else:
                lie.retract(H[i], h[0], H[i])
                lie.reorthonormalise(H[i])
    return largest


@dataclass(frozen=True)
class StaticResult:
    """Equilibrium states.

    Attributes:
        factors: Load factors of the accepted steps, shape (k,), the last is 1.
        frames: Frames at them, shape (k, nodes, 4, 3).
        joint_forces: Force and moment of each joint on its point ``a``, at the joint and in the
            axes that it has on that side, shape (k, j, 6).
        iterations: Linear solves of each accepted step, shape (k,).
        failed_iterations: Linear solves of steps that were given up.
        info: Bodies and joints.
        initial: Frames of the unloaded configuration, shape (nodes, 4, 3).
        steady_rotation: Of the frame in which this is an equilibrium, at load factor 1.
        seconds: Wall time from the first assembly to the last solution, without set-up.
    """

    factors: Array
    frames: Array
    joint_forces: Array
    iterations: npt.NDArray[np.int64]
    failed_iterations: int
    info: SceneInfo
    initial: Array
    steady_rotation: Rotation
    seconds: float

    def position(self, point: Point | str) -> Array:
        """Positions of a point at all steps, shape (k, 3)."""
        return self.frames[:, self.info.node(point), 0]

    def joint_force(self, joint: Connection | str) -> Array:
        """Force and moment of a joint on its point ``a``, in its axes there, shape (k, 6)."""
        return self.joint_forces[:, self.info.joint(joint)]

    def rotation(self, point: Point | str) -> Array:
        """Rotation matrices of a point at all steps, shape (k, 3, 3)."""
        return lie.rotation(self.frames[:, self.info.node(point)])

    def plot(
        self,
        *points: Point | str,
        path: str | os.PathLike[str] | None = None,
        units: Units = SI,
    ) -> Figure:
        """Displacements of points over the load factor; saved if there is a path."""
        from fem_lie.plot import displacements

        return displacements(self, points, path, units=units)

    def picture(
        self,
        path: str | os.PathLike[str],
        *,
        trace: Sequence[Point | str] = (),
        frames: bool = False,
        title: str = "",
        units: Units = SI,
    ) -> None:
        """Draw the unloaded bodies and all equilibrium states, the later the darker.

        Args:
            path: Name of the ``.png`` file.
            trace: Points whose paths are drawn, too.
            frames: Draw the nodal frames of the last state.
            title: Above the picture.
            units: For the axes.
        """
        from fem_lie.picture import draw

        states = np.concatenate([self.initial[np.newaxis], self.frames])
        paths = [states[:, self.info.node(point), 0] for point in trace]
        draw(self.info, states, path, paths=paths, triads=frames, title=title, units=units)


def statics(
    scene: Scene,
    *,
    spin: npt.ArrayLike = (0.0, 0.0, 0.0),
    about: npt.ArrayLike = (0.0, 0.0, 0.0),
    load_steps: int = 1,
    carried_stress: bool = True,
    tolerance: float = 1e-10,
    max_iterations: int = 25,
    smallest_step: float = 1e-3,
    petsc_options_prefix: str = "fem_lie_statics_",
) -> StaticResult:
    """Equilibrium under the full loads, reached from the unloaded configuration.

    Loads without history grow with the load factor from 0 to 1; histories and prescribed motions
    are evaluated at the load factor. A step that fails is halved; later steps grow back.

    With ``spin`` it is equilibrium in a frame that turns steadily, with all centrifugal forces;
    frames are those of the instant at which the two frames coincide. Clamps, ground and prescribed
    motions then belong to the turning frame: they are the hub. Centrifugal forces grow with the
    load factor, the angular velocity with its root. Damping in space (``Damping.mass``) drags.

    Args:
        scene: What there is.
        spin: Angular velocity of that frame, global components, rad per time.
        about: A place on the axis of rotation.
        load_steps: Number of equal steps to begin with.
        carried_stress: Carry the stress as an iterate (Magisano, Leonetti & Garcea 2017), which
            converges in a few iterations at any slenderness; otherwise plain Newton.
        tolerance: Predicted error of a step's end, in rotations and in translations over the
            size of the model.
        max_iterations: More are a failure of the step.
        smallest_step: Smallest step of the load factor before giving up.
        petsc_options_prefix: Prefix for the choice of the linear solver.

    Raises:
        ValueError: Bad scene or options; no inertia, or gravity or forces fixed in space that are
            not parallel to the axis, with ``spin``.
        ConvergenceError: The smallest step failed; its ``result`` holds the states before.
    """
    if load_steps < 1 or not tolerance > 0 or max_iterations < 1 or not 0 < smallest_step <= 1:
        raise ValueError(
            "wanted load_steps ≥ 1, tolerance > 0, max_iterations ≥ 1, 0 < smallest_step ≤ 1; got "
            f"{load_steps}, {tolerance}, {max_iterations}, {smallest_step}"
        )
    rotation = Rotation.of(spin, about)
    rotation.check(scene)
    newton = _Newton(
        scene, rotation, carried_stress, tolerance, max_iterations, petsc_options_prefix
    )
    reached, step = 0.0, 1.0 / load_steps
    while reached < 1.0:
        target = min(1.0, reached + step)
        # the last step must land on 1 in spite of round-off
        target = 1.0 if 1.0 - target < 1e-9 else target
        if not newton.solve(target):
            step /= 2
            if step < smallest_step:
                raise ConvergenceError(
                    f"no equilibrium from load factor {reached:g} to {target:g}: after "
                    f"{newton.iterations} iterations the residual is {newton.residual:.2e} and "
                    f"the last increment {newton.last:.2e} (tolerance {tolerance:g}). "
                    + newton.advice(),
                    newton.result(),
                )
            _log.info("step to load factor %g failed, halved to %g", target, step)
            continue
        reached = target
        step = min(2 * step, 1.0 / load_steps)
    return newton.result()


class _Newton:
    """Newton's method from one accepted state to the next; it keeps those that were accepted."""

    def __init__(
        self,
        scene: Scene,
        rotation: Rotation,
        carried: bool,
        tolerance: float,
        max_iterations: int,
        prefix: str,
    ) -> None:
        self.system = system = System(scene, dynamics=bool(rotation))
        self._rotation = rotation
        self._carried, self._tolerance, self._max = carried, tolerance, max_iterations
        self.H: Array = system.frames.copy()
        self.multipliers: Array = np.zeros(system.m)
        self._zero = np.zeros((system.count, 6))
        self._scale = np.ones(system.m)
        self._solver = DirectSolver(system.kkt.matrix, prefix, methods_for(system))
        self._r, self._dx = self._solver.right_hand_side, self._solver.solution
        self.iterations: int = 0
        self.residual: float = 0.0
        self.last: float = 0.0
        system.elastic.reset_stress(self.H)
        self._fill()
        self._scale[:] = system.tangent.constraint_scale(self.H)

        self._factors: list[float] = []
        self._frames: list[Array] = []
        self._forces: list[Array] = []
        self._counts: list[int] = []
        self._failed = 0
        self._begin = clock.perf_counter()

    def result(self) -> StaticResult:
        """The accepted states."""
        system, k = self.system, len(self._factors)
        return StaticResult(
            np.array(self._factors),
            np.array(self._frames).reshape(k, system.numbering.total, 4, 3),
            np.array(self._forces).reshape(k, len(system.connections.items), 6),
            np.array(self._counts, dtype=np.int64),
            self._failed,
            system.info(),
            system.numbering.attachment.frames(system.frames).copy(),
            self._rotation,
            clock.perf_counter() - self._begin,
        )

    def advice(self) -> str:
        """What to try."""
        if not np.isfinite(self.last):
            return (
                "The matrix is singular: is every body held by clamps or joints, with no motion "
                "left free?"
            )
        if not self._carried:
            return "Try carried_stress=True, or more load_steps."
        return (
            "Try more load_steps; if the load has a maximum here (snap-through), prescribe a "
            "displacement instead of a load."
        )

    def solve(self, factor: float) -> bool:
        """Go to the load factor and keep that state; if it fails, stay at the old one."""
        system = self.system
        H, multipliers = self.H.copy(), self.multipliers.copy()
        system.set_time(factor, factor)
        self.H[system.count + 1 :] = system.prescribed_frames(factor)
        previous = np.inf
        self.iterations = 0
        while self.iterations < self._max:
            self.iterations += 1
            try:
                self._iterate(factor)
            except SingularMatrixError:
                self.last = np.inf
            if not np.isfinite(self.last) or self.last > 1e3:
                break
            ratio = min(1.0, self.last / previous) if self.iterations > 1 else 1.0
            # quadratic convergence: the next increment is this one times the ratio squared
            if self.last * ratio**2 <= self._tolerance:
                self._factors.append(factor)
                self._frames.append(system.numbering.attachment.frames(self.H).copy())
                self._forces.append(system.joint_forces(self.H, self.multipliers))
                self._counts.append(self.iterations)
                system.connections.accept(self.H)
                return True
            previous = self.last
        self.H, self.multipliers = H, multipliers
        self._failed += self.iterations
        system.elastic.reset_stress(H)
        return False

    def _iterate(self, factor: float) -> None:
        system, H, zero = self.system, self.H, self._zero
        if not self._carried:
            system.elastic.reset_stress(H)
        # centrifugal forces grow as the loads do
        v = self._rotation.velocities(H[: system.count], np.sqrt(factor))
        system.residual(H, v, zero, self.multipliers, self._scale, self._r)
        self.residual = float(np.abs(self._r).max(initial=0.0))
        if self._rotation:
            fill_steady(system, H, v, self.multipliers, self._scale)
        else:
            self._fill()
        self._solver.factorise()
        self._solver.solve()
        if system.supports:
            system.supports.turn_back(H, self._dx[: 6 * system.count].reshape(-1, 6))
        if self._carried:
            system.elastic.carry(H, -self._dx[: 6 * system.count])
        self.last = advance(H, self._dx, system.held, system.uncoupled, system.length)
        system.carried_drilling.turn(H)
        self.multipliers -= self._scale * self._dx[6 * system.count :]

    def _fill(self) -> None:
        zero = self._zero
        self.system.fill_matrix(self.H, zero, zero, self.multipliers, self._scale, zero, 0.0, 0.0)
