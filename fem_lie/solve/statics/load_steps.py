"""Statics by load steps: Newton's method on the group with linearised stress updates."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fem_lie._arrays import Array, flag, number, whole
from fem_lie.bodies.model import FoldedElementError
from fem_lie.forms.abilities import PassedThroughError
from fem_lie.joints.connection import LostBranchError
from fem_lie.lie.node_types import advance
from fem_lie.linear.choice import Solutions
from fem_lie.linear.direct import ConvergenceError, DirectSolver
from fem_lie.parts.part_scene import divided
from fem_lie.results.equilibrium import StaticResult
from fem_lie.results.gathering import gathered
from fem_lie.results.record import FrictionForces
from fem_lie.scene import Scene
from fem_lie.scene.rotation import Rotation
from fem_lie.solve.convergence import Verdict
from fem_lie.solve.iteration import Criterion, Iterated, Polishing, QuadraticRate, iterate
from fem_lie.solve.progress_bars import Reach, Stopwatch, load_bar
from fem_lie.solve.refactorisation import Refactorisation
from fem_lie.solve.statics.unstable import (
    HELD,
    POLISHED,
    UNKNOWN,
    FreeMotions,
    FreeRigidMotions,
    FreeStartError,
    SingularStartError,
    negative_pivots,
)
from fem_lie.system.equations import Equations, Plan, TimeState

if TYPE_CHECKING:
    from fem_lie.system.equations import Equations


def move(equations: Equations, H: Array, x: Array, *, linearised: bool) -> float:
    """Move nodes by ``−x``.

    Args:
        equations: Equations of the scene.
        H: Frames of all nodes, ground and prescribed motions, changed.
        x: Solution of the equations, in the nodes' frames, (≥ 6 n,).
        linearised: Whether the stress is updated linearly, too.

    Returns:
        The largest increment, over the unit of its unknown.
    """
    unknowns = equations.unknowns
    equations.history_variables.move_reference_angles(H, -x[: 6 * unknowns.moving])
    if linearised:
        equations.history_variables.update_stress(H, -x[: 6 * unknowns.moving])
    ways = unknowns.held, unknowns.separates_director, unknowns.separates_rotation
    advance(unknowns.kinds, H, x, *ways)
    equations.history_variables.rotate_axes(H)
    size = float(np.abs(x[: 6 * unknowns.moving] / unknowns.units).max(initial=0.0))
    return equations.shared.largest(size)


@dataclass(frozen=True)
class Newton:
    """Newton's method from one load factor to the next.

    Attributes:
        tolerance: Predicted error at the end of a step, in rotations and in translations over the
            size of the model.
        max_iterations: Largest number of iterations of a step.
        smallest_step: Smallest load step, below which the analysis fails.
        linearised_stress: Iterate on the stress as an independent unknown, by linearised updates
            (Magisano, Leonetti & Garcea 2017), which converges in a few iterations at any
            slenderness; otherwise plain Newton.

    Raises:
        ValueError: A tolerance that is not positive, a step outside of (0, 1].
    """

    tolerance: float = 1e-10
    max_iterations: int = 25
    smallest_step: float = 1e-3
    linearised_stress: bool = True

    def __post_init__(self) -> None:
        """Check the options."""
        number(self.tolerance, "Newton: tolerance")
        number(self.smallest_step, "Newton: smallest_step")
        whole(self.max_iterations, "Newton: max_iterations")
        flag(self.linearised_stress, "Newton: linearised_stress")
        if not self.tolerance > 0 or not 0 < self.smallest_step <= 1:
            raise ValueError(
                "Newton: expected tolerance > 0 and 0 < smallest_step ≤ 1, got "
                f"{self.tolerance} and {self.smallest_step}"
            )


_SMALLEST = 1e-3  # smallest increment of the preload
_FARTHEST = 1e3  # larger increments, over their units, have diverged
_FROM_START = (
    0.5 * np.pi
)  # the same from a start, whose elements may be bent far: they would invert
_NEAR = 1e-2  # the same near a converged state

_log = logging.getLogger(__name__)


class LoadSteps(Iterated):
    """Newton's method from one accepted state to the next, with a record of the accepted states."""

    def __init__(
        self,
        scene: Scene,
        rotation: Rotation,
        options: Newton,
        prefix: str,
        free: FreeRigidMotions = FreeRigidMotions.REFUSED,
    ) -> None:
        """Number the unknowns; for the arguments see :func:`~.statics.statics`."""
        part = divided(scene, prefix)
        self.equations = equations = Equations(scene, dynamics=bool(rotation), part=part)
        unknowns = equations.unknowns
        self._rotation = rotation
        self._options = options
        self.H: Array = equations.start.frames.copy()
        self.multipliers: Array = np.zeros(unknowns.m)
        self._moving = unknowns.moving
        self._zero = np.zeros((unknowns.moving, 6))
        self._solver = DirectSolver(equations.matrix, prefix, solutions=Solutions.FEW)
        self._solver.take_low_rank()
        self._r, self._dx = self._solver.right_hand_side, self._solver.solution
        self.iterations: int = 0
        self.residual: float = 0.0
        self.last: float = 0.0
        self._lost, self._factor = "", 0.0
        # fraction of the forces that are out of balance at a start, and these
        self._left, self._unbalanced, self._farthest = 0.0, np.zeros_like(self._r), _FARTHEST
        self._criterion: Criterion = Polishing(_NEAR)
        equations.history_variables.update_stress(self.H)
        now = TimeState(self.H, self._zero, self._zero, self.multipliers)
        self._scale = equations.fill(now, None, Plan(self._zero))
        self._found = equations.residual(now, self._scale, self._r, linearised=True)

        self._factors: list[float] = []
        self._frames: list[Array] = []
        self._forces: list[Array] = []
        self._reactions: list[Array] = []
        self._counts: list[int] = []
        self._pivots: list[int] = []
        self._friction: list[Array | None] = []
        self._failed, self._failed_steps = 0, 0
        self._to_check = free is FreeRigidMotions.REFUSED
        self._may_be_free = not self._to_check
        self._watch = Stopwatch()

    def result(self) -> StaticResult:
        """The accepted states, of the whole scene."""
        return gathered(self._own_result(), self.equations.part)

    def _own_result(self) -> StaticResult:
        equations, unknowns, k = self.equations, self.equations.unknowns, len(self._factors)
        return StaticResult(
            np.array(self._factors),
            np.array(self._frames).reshape(k, unknowns.total, 4, 3),
            np.array(self._forces).reshape(k, unknowns.connections, 6),
            np.cumsum(self._counts, dtype=np.int64),
            self._failed,
            equations.info,
            self._rotation,
            self._watch.seconds,
            np.array(self._reactions).reshape(k, len(unknowns.supported), 6),
            negative_pivots=np.array(self._pivots, dtype=np.int64),
            factorisations=self._solver.factorisations,
            load_steps=k,
            failed_steps=self._failed_steps,
            friction=FrictionForces.of_states(self._friction),
            subdomains=self._solver.subdomains,
        )

    def run(self, levels: Sequence[float], step: float, smallest: float) -> StaticResult:
        """Go through the requested load factors; failed steps are halved, later steps grow again.

        Args:
            levels: Increasing load factors.
            step: Largest step of the load factor.
            smallest: Smallest step, below which the analysis fails.

        Raises:
            ConvergenceError: The smallest step failed; its ``result`` holds the states before.
        """
        with load_bar(levels[-1]) as show:
            return self._run(levels, step, smallest, show)

    def _run(
        self, levels: Sequence[float], step: float, smallest: float, show: Reach
    ) -> StaticResult:
        began, now = self.equations.scene.began, step
        reached = began.factor if began.state is None else levels[0]
        if reached and not self._balance(reached, smallest):
            raise self._failure(reached, reached)
        strained = not reached and self.equations.unknowns.preloaded
        for level in levels:
            while reached < level:
                target = min(level, reached + now)
                # the last step must land on the level in spite of round-off
                target = level if level - target < 1e-9 * levels[-1] else target
                # large prescribed rotations divide a step before it is tried
                ahead = self.equations.prescribed(reached).limited(target)
                target = -self.equations.shared.largest(-ahead)
                if self.solve(target):
                    reached, now = target, min(2 * now, step)
                    show(reached)
                    continue
                if strained:
                    strained = False
                    _log.info("step to load factor %g failed, springs are preloaded first", target)
                    self._preload(min(smallest, _SMALLEST))
                    continue
                now /= 2
                if now < smallest:
                    raise self._failure(reached, target)
                _log.info("step to load factor %g failed, halved to %g", target, now)
        return self.result()

    def _balance(self, factor: float, smallest: float) -> bool:
        """Go from the start to equilibrium at a load factor, and record it; return whether.

        If Newton's method fails, forces out of balance at the start are removed part by part.

        Args:
            factor: The load factor.
            smallest: Smallest part.
        """
        removed, part, self._farthest = 0.0, 1.0, _FROM_START
        self._act(factor)
        self._unbalanced = self._r.copy()
        while part >= smallest:
            target = min(1.0, removed + part)
            self._left = 1.0 - target
            if target == 1.0 and self.solve(factor):
                self._farthest = _FARTHEST
                return True
            if target < 1.0 and self._reach(factor) is not None:
                removed, part = target, 2.0 * part
            else:
                part /= 2.0
                _log.info("step from the start failed, forces are removed in parts of %g", part)
        return False

    def _preload(self, smallest: float) -> None:
        """Preload the springs step by step, without loads; on failure the state is restored."""
        history, part, step = self.equations.history_variables, 0.0, 0.5
        H, multipliers, saved = self.H.copy(), self.multipliers.copy(), history.saved_state()
        while part < 1.0:
            if self._reach(0.0, min(1.0, part + step)) is not None:
                part, step = min(1.0, part + step), 2.0 * step
                continue
            step /= 2.0
            if step < smallest:
                _log.info("springs cannot be preloaded without loads")
                history.restore(saved)
                self.H, self.multipliers = H, multipliers
                return

    def _failure(self, reached: float, target: float) -> ConvergenceError:
        where = (
            f"from load factor {reached:g} to {target:g}"
            if reached < target
            else f"near the start at load factor {target:g}"
        )
        text = (
            f"no equilibrium {where}: after {self.iterations} "
            f"iterations the residual is {self.residual:.2e} and the last increment "
            f"{self.last:.2e} (tolerance {self._options.tolerance:g}). "
        )
        kind, lost = ConvergenceError, self._lost
        if free := "" if self._factors else self._free_at_start():
            kind = FreeStartError
        if self.iterations == 1 and not np.isfinite(self.last):
            kind = SingularStartError
        why = lost or self.equations.report(self.H).rotation_hint
        return kind(f"{text}{free or self._advice()}{why}", self.result())

    def _advice(self) -> str:
        if not np.isfinite(self.last):
            return f"The matrix is singular. {HELD}"
        if not self._options.linearised_stress:
            return "Try Newton(linearised_stress=True), or more load_steps."
        return (
            "Try more load_steps; if the load has a maximum here (snap-through), prescribe a "
            "displacement instead of a load."
        )

    def _free_at_start(self) -> str:
        """Message on rigid motions that nothing resists in the first state, if there are any."""
        search, target, none = FreeMotions(self.equations), self._factor, np.zeros_like(self._r)
        if not len(allowed := search.allowed(self.H)):
            return ""
        self._act(self.equations.scene.began.factor)
        free = search.unresisted(allowed, none)
        self._act(target)
        # second derivatives along motions depend on coordinates unless forces are balanced there
        if len(free) and search.balanced(free, self._r):
            free = search.unresisted(free, none)
        free = free if len(free) else search.symmetries(allowed)
        return f"In the first state {search.freedom(free)}" if len(free) else ""

    def _act(self, factor: float) -> None:
        """Residual and matrix of the current state with the loads and supports of a factor."""
        now = self.equations.prescribed(factor)
        now.act(factor, 1.0)
        self.H[self._moving + 1 :] = now.frames
        self._factor = factor
        self._fill(factor)

    def solve(self, factor: float) -> bool:
        """Go to the load factor and record that state; on failure, stay at the old one."""
        pivots = self._reach(factor)
        if pivots is None:
            return False
        v = self._rotation.velocities(self.equations.unknowns.kinds, self.H, np.sqrt(factor))
        report = self.equations.report(self.H, v, self._zero, self.multipliers)
        self._factors.append(factor)
        self._frames.append(report.frames.copy())
        self._forces.append(report.joints.forces)
        self._reactions.append(report.reactions)
        self._counts.append(self.iterations)
        self._pivots.append(pivots)
        friction = self.equations.history_variables.friction_forces(self.H, self._zero)
        self._friction.append(friction)
        return True

    def _reach(self, factor: float, preload: float = 1.0) -> int | None:
        """Iterate to equilibrium at a load factor.

        Args:
            factor: The load factor.
            preload: Fraction of the preload of springs that acts.

        Returns:
            Its number of negative pivots; ``None`` if there is no equilibrium nearby; the state is
            then restored.
        """
        equations = self.equations
        H, multipliers, saved = (
            self.H.copy(),
            self.multipliers.copy(),
            equations.history_variables.saved_state(),
        )
        now = equations.prescribed(factor)
        now.act(factor, preload)
        self.H[self._moving + 1 :] = now.frames
        self._factor, self._lost = factor, ""
        self._criterion = QuadraticRate(self._options.tolerance, self._farthest)
        ended = iterate(self, self._options.max_iterations)
        self.iterations, self.last = ended.iterations, ended.size
        if ended.converged:
            try:
                return self._accept(factor, H)
            except (FoldedElementError, PassedThroughError, LostBranchError) as error:
                self._lost = f" The step was refused: {error}."
        self.H, self.multipliers = H, multipliers
        self._failed += self.iterations
        self._failed_steps += 1
        equations.history_variables.restore(saved)
        return None

    def _accept(self, factor: float, before: Array) -> int:
        """Accept the current state; returns its number of negative pivots.

        Args:
            factor: Its load factor.
            before: Frames at the start of the step.

        Raises:
            FoldedElementError: An element rotates too far.
            LostBranchError: A joint or a prescribed motion rotates too far.
            PassedThroughError: Surfaces passed through each other.
        """
        self.equations.report(self.H).check_rotations(f"at load factor {factor:g}")
        if self._to_check and factor:
            self._check_held(factor)
        pivots = self._negative_pivots(factor)
        self.equations.history_variables.check_passage(before, self.H)
        self.equations.history_variables.accept(self.H, before)
        return pivots

    def _check_held(self, factor: float) -> None:
        """Raise an error if the first state has free rigid motions that pivots do not show.

        Raises:
            SingularStartError: It has.
        """
        self._to_check, search = False, FreeMotions(self.equations)
        if not len(search.allowed(self.H)):
            return
        history = self.equations.history_variables
        H, multipliers, saved = self.H.copy(), self.multipliers.copy(), history.saved_state()
        # unbalanced forces would contribute resistance
        self._factor, self._criterion = factor, Polishing(_NEAR)
        if iterate(self, POLISHED).verdict != Verdict.GOES_ON:
            # corrections of a singular matrix are round-off without bound
            self.H, self.multipliers = H, multipliers
            history.restore(saved)
        self._fill(factor)
        free = search.unresisted(search.allowed(self.H), self._r)
        self.H, self.multipliers = H, multipliers
        history.restore(saved)
        if len(free):
            raise SingularStartError(search.message(free, factor), self.result())

    def _negative_pivots(self, factor: float) -> int:
        """Negative pivots of the last iteration; if there are any, of the converged state.

        Residual forces have a skew part: only at equilibrium may the tangent be symmetric. The
        first iteration does not have the stress of this load factor yet, which changes although
        nothing moves in a heated column between clamps.
        """
        has_potential = self.equations.unknowns.has_potential
        last = has_potential and self.iterations > 1
        found = negative_pivots(self.equations, self._solver) if last else UNKNOWN
        if found > 0 or not last:
            self._factorise(factor)
            found = negative_pivots(self.equations, self._solver)
        if found > 0 and self._may_be_free:
            search = FreeMotions(self.equations)
            # the sign of their pivots is that of round-off
            if len(search.unresisted(search.allowed(self.H), self._r)):
                return UNKNOWN
        return found

    def _factorise(self, factor: float) -> None:
        """Residual and factors of the matrix of the current state."""
        self._fill(factor)
        self._solver.factorise()

    def _fill(self, factor: float) -> None:
        """Residual and matrix of the current state."""
        equations, H, zero = self.equations, self.H, self._zero
        if not self._options.linearised_stress:
            equations.history_variables.update_stress(H)
        # centrifugal forces are in proportion to the load factor
        v = self._rotation.velocities(equations.unknowns.kinds, H, np.sqrt(factor))
        now = TimeState(H, v, zero, self.multipliers)
        equations.residual(now, self._scale, self._r, self._found, linearised=True)
        if self._left:
            self._r -= self._left * self._unbalanced
        self.residual = equations.shared.largest(float(np.abs(self._r).max(initial=0.0)))
        plan = Plan(zero, self._scale, steady=bool(self._rotation))
        equations.fill(now, self._found, plan)

    # --- one iteration, see :class:`~fem_lie.solve.iteration.Iterated` ---

    def evaluate(self, iteration: int) -> bool:
        """Evaluate residual and tangent stiffness."""
        self._fill(self._factor)
        return False

    def refactorise(self, update: Refactorisation) -> None:
        """Factorise the tangent stiffness."""
        self._solver.factorise()

    def correct(self) -> float:
        """Solve for a correction and apply it; return its size over the units of the unknowns."""
        self._solver.solve()
        nodes = self._dx[: 6 * self._moving].reshape(-1, 6)
        self.equations.supports.rotate_back(self.H, nodes)
        size = move(self.equations, self.H, self._dx, linearised=self._options.linearised_stress)
        self.multipliers -= self._scale * self._dx[6 * self._moving :]
        return size

    def judge(self, size: float) -> Verdict:
        """Verdict by the quadratic convergence rate."""
        return self._criterion.judge(size)
