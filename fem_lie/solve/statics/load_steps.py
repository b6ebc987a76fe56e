"""Statics by load steps: Newton's method on the group with the stress as an iterate."""

from __future__ import annotations

import logging
from collections.abc import Sequence

import numpy as np

from fem_lie._arrays import Array
from fem_lie.lie.motions import advance
from fem_lie.linear.direct import ConvergenceError, DirectSolver
from fem_lie.linear.equilibrated import SingularMatrixError
from fem_lie.results.equilibrium import StaticResult
from fem_lie.scene import Scene
from fem_lie.scene.rotation import Rotation
from fem_lie.solve.methods import methods_for
from fem_lie.solve.statics.pivots import negative_pivots
from fem_lie.solve.statics.steady import fill_steady
from fem_lie.solve.stopwatch import Stopwatch
from fem_lie.system import System
from fem_lie.system.nodes.element_turns import FoldedElementError

_log = logging.getLogger(__name__)


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
        """Number the unknowns; for the arguments see :func:`~.statics.statics`."""
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
