"""Statics by load steps: Newton's method on the group with the stress as an iterate."""

from __future__ import annotations

import logging
import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from fem_lie import lie
from fem_lie._jit import Array, compiled
from fem_lie.bodies import Point
from fem_lie.element_turns import FoldedElementError
from fem_lie.elements.shell_maps import retract
from fem_lie.info import SceneInfo
from fem_lie.joints import Connection
from fem_lie.plot import SI, Units
from fem_lie.reactions import Support, reaction
from fem_lie.scene import Scene
from fem_lie.solve.linear import (
    ConvergenceError,
    DirectSolver,
    SingularMatrixError,
    methods_for,
)
from fem_lie.solve.pivots import negative_pivots
from fem_lie.solve.rotation import Rotation
from fem_lie.solve.steady import fill_steady
from fem_lie.solve.stopwatch import Stopwatch
from fem_lie.system import System

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Flags = npt.NDArray[np.bool_]

_log = logging.getLogger(__name__)

_DRAWN = 7  # states in a picture, beside the unloaded one


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
        reactions: Force and moment of each support on its node, about it, global components, see
            :meth:`reaction`, shape (k, s, 6).
        negative_pivots: Negative eigenvalues of the tangent at each state on what constraints leave
            free, shape (k,): with none it is stable. Under loads without potential it is 1 if their
            number is odd, else 0; −1 where the matrix could not be factorised.
        factorisations: Of the matrix, in all.
        turned_back: Load factors at which the load had a maximum on the way, roughly.
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
    reactions: Array
    negative_pivots: npt.NDArray[np.int64] = field(
        default_factory=lambda: np.empty(0, dtype=np.int64), kw_only=True
    )
    factorisations: int = field(default=0, kw_only=True)
    turned_back: tuple[float, ...] = field(default=(), kw_only=True)

    @property
    def stable(self) -> Flags:
        """Which states are stable, shape (k,); under loads without potential: as far as is known.

        See ``negative_pivots``.
        """
        return np.asarray(self.negative_pivots == 0)

    @property
    def total_iterations(self) -> int:
        """Linear solutions in all."""
        return int(self.iterations.sum()) + self.failed_iterations

    def position(self, point: Point | str) -> Array:
        """Positions of a point at all steps, shape (k, 3)."""
        return self.frames[:, self.info.node(point), 0]

    def joint_force(self, joint: Connection | str) -> Array:
        """Force and moment of a joint on its point ``a``, in its axes there, shape (k, 6)."""
        return self.joint_forces[:, self.info.joint(joint)]

    def reaction(self, *supports: Support) -> Array:
        """Force and moment of a clamp or guide, or of several together, shape (k, 6).

        See :meth:`fem_lie.Result.reaction`.
        """
        return reaction(self, supports)

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
        at: Sequence[int | float] | None = None,
        *,
        trace: Sequence[Point | str] = (),
        frames: bool = False,
        title: str = "",
        units: Units = SI,
    ) -> None:
        """Draw the unloaded bodies and equilibrium states, the later the darker.

        Args:
            path: Name of the ``.png`` file.
            at: Which states: whole numbers are indices, others load factors, of which the nearest
                is taken; default: all if they are seven at most, or so many of them, evenly.
            trace: Points whose paths through all states are drawn, too.
            frames: Draw the nodal frames of the last state.
            title: Above the picture.
            units: For the axes.

        Raises:
            ValueError: There is no such state.
        """
        from fem_lie.picture import draw

        states = np.concatenate([self.initial[np.newaxis], self.frames])
        paths = [states[:, self.info.node(point), 0] for point in trace]
        drawn = states[[0, *(1 + row for row in self._rows(at))]]
        draw(self.info, drawn, path, paths=paths, triads=frames, title=title, units=units)

    def _rows(self, at: Sequence[int | float] | None) -> list[int]:
        """Numbers of the states to be drawn."""
        count = len(self.factors)
        if at is None:
            even = np.linspace(0, count - 1, min(_DRAWN, count))
            return [int(row) for row in even.round()]
        rows = []
        for state in at:
            if isinstance(state, int | np.integer):
                if not -count <= state < count:
                    raise ValueError(f"there are {count} states, got the index {state}")
                rows.append(int(state) % count)
            elif np.isfinite(state):
                rows.append(int(np.abs(self.factors - state).argmin()))
            else:
                raise ValueError(f"a load factor must be finite, got {state}")
        return rows


class SingularStartError(ConvergenceError):
    """A step began with a singular matrix: no other way of loading helps."""


class LoadSteps:
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
        """Number the unknowns; for the arguments see :func:`~fem_lie.solve.equilibrium.statics`."""
        self.system = system = System(scene, dynamics=bool(rotation))
        self._rotation = rotation
        self._carried, self._tolerance, self._max = carried, tolerance, max_iterations
        self.H: Array = system.frames.copy()
        self.multipliers: Array = np.zeros(system.m)
        self._zero = np.zeros((system.count, 6))
        self._scale = np.ones(system.m)
        self._solver = DirectSolver(system.kkt, prefix, methods_for(system))
        self._r, self._dx = self._solver.right_hand_side, self._solver.solution
        self.iterations: int = 0
        self.residual: float = 0.0
        self.last: float = 0.0
        self._folded = ""
        system.elastic.reset_stress(self.H)
        self._fill()
        self._scale[:] = system.tangent.constraint_scale(self.H)

        self._factors: list[float] = []
        self._frames: list[Array] = []
        self._forces: list[Array] = []
        self._reactions: list[Array] = []
        self._counts: list[int] = []
        self._pivots: list[int] = []
        self._failed = 0
        self._watch = Stopwatch()

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
            self._watch.seconds,
            np.array(self._reactions).reshape(k, len(system.supported), 6),
            negative_pivots=np.array(self._pivots, dtype=np.int64),
            factorisations=self._solver.factorisations,
        )

    def run(self, levels: Sequence[float], step: float, smallest: float) -> StaticResult:
        """Go through the wanted load factors; a step that fails is halved, later steps grow back.

        Args:
            levels: Increasing.
            step: Of the load factor, at most.
            smallest: Below this it gives up.

        Raises:
            ConvergenceError: The smallest step failed; its ``result`` holds the states before.
        """
        reached, now = 0.0, step
        for level in levels:
            while reached < level:
                target = min(level, reached + now)
                # the last step must land on the level in spite of round-off
                target = level if level - target < 1e-9 * levels[-1] else target
                if self.solve(target):
                    reached, now = target, min(2 * now, step)
                    continue
                now /= 2
                if now < smallest:
                    kind = SingularStartError if self._singular else ConvergenceError
                    raise kind(self._failure(reached, target), self.result())
                _log.info("step to load factor %g failed, halved to %g", target, now)
        return self.result()

    @property
    def _singular(self) -> bool:
        """Whether the last step failed at once, because its matrix is singular."""
        return self.iterations == 1 and not np.isfinite(self.last)

    def _failure(self, reached: float, target: float) -> str:
        return (
            f"no equilibrium from load factor {reached:g} to {target:g}: after {self.iterations} "
            f"iterations the residual is {self.residual:.2e} and the last increment "
            f"{self.last:.2e} (tolerance {self._tolerance:g}). {self.advice()}"
            f"{self._folded or self.system.turn_hint(self.H)}"
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
        self.iterations, self._folded = 0, ""
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
                try:
                    system.check_turns(self.H, f"at load factor {factor:g}")
                except FoldedElementError as error:
                    self._folded = f" It folds: {error}."
                    break
                self._factors.append(factor)
                self._frames.append(system.numbering.attachment.frames(self.H).copy())
                self._forces.append(system.joint_forces(self.H, self.multipliers))
                v = self._rotation.velocities(self.H[: system.count], np.sqrt(factor))
                state = self.H, v, self._zero, self.multipliers
                self._reactions.append(system.reactions(*state))
                self._counts.append(self.iterations)
                self._pivots.append(self._negative_pivots(factor))
                system.connections.accept(self.H)
                return True
            previous = self.last
        self.H, self.multipliers = H, multipliers
        self._failed += self.iterations
        system.elastic.reset_stress(H)
        return False

    def _negative_pivots(self, factor: float) -> int:
        """Of the last iteration; if it has some, of the state that it has led to."""
        found = negative_pivots(self.system, self._solver)
        if found > 0:
            self._factorise(factor)
            found = negative_pivots(self.system, self._solver)
        return found

    def _factorise(self, factor: float) -> None:
        """Residual and matrix of the present state."""
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

    def _iterate(self, factor: float) -> None:
        system, H = self.system, self.H
        self._factorise(factor)
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
