"""A run of generalised-α with constant steps: prediction, iteration with a kept matrix.

Formulas in :mod:`fem_lie.solve.alpha.generalised_alpha`.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from fem_lie._arrays import Array
from fem_lie.lie.kinds import follow_all, turn_all, turn_all_back, twists
from fem_lie.linear.direct import DirectSolver
from fem_lie.linear.equilibrated import SingularMatrixError
from fem_lie.results import Result
from fem_lie.solve.alpha.options import Components, Index, Options
from fem_lie.solve.alpha.projection import project
from fem_lie.solve.alpha.staleness import back_to_local, staleness
from fem_lie.solve.alpha.start import set_start
from fem_lie.solve.alpha.step.node import parameters
from fem_lie.solve.alpha.step.nodes import WRITTEN_LOCALLY, State, accept, correct, predict
from fem_lie.solve.methods import methods_in_time
from fem_lie.solve.motion.consistent import check_velocities
from fem_lie.solve.motion.convergence import (
    DIVERGED,
    ROTATION,
    ROUND_OFF,
    UNMEASURED,
    contradicts,
    estimate,
    failure,
)
from fem_lie.solve.motion.integration import Integration
from fem_lie.solve.motion.policies import Decisions, EveryIteration, Update
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.recorder import Recorder
from fem_lie.solve.recording.saving import Saving
from fem_lie.system.equations import Equations, Instant, Plan

_log = logging.getLogger(__name__)

_STAGNATION = 1e-6  # full Newton that no longer contracts below this has met round-off


class Run(Integration[Recorder]):
    """State of one integration.

    Attributes:
        options: Of the scheme.
        p: Its parameters.
        s: Start and end of a step.
        weights: Multipliers.
        solver: Of the iteration.
        books: What loads, drives and supports have done.
        forces: What the last residual of the iteration found.
    """

    _refreshes: ClassVar[bool] = True
    """Whether the border of the kept matrix may be made anew by itself."""

    def __init__(self, options: Options, equations: Equations, step: float) -> None:
        """Allocate everything; nothing is computed yet.

        Args:
            options: Of the scheme.
            equations: Of the scene.
            step: Step size.
        """
        unknowns = equations.unknowns
        m, length = unknowns.m, unknowns.length
        super().__init__(options.policy, equations, step, bound=self._refreshes and m > 0)
        self.options, self.p = options, parameters(options.radius, step, length)
        equations.measure_velocities(1.0 / self.p.damping)
        self.s = State.start(equations.start.frames, unknowns.kinds)
        self._guided, self._moving = unknowns.guided, unknowns.moving
        self._changing = unknowns.time_dependent
        self._projects = options.index == Index.STABILISED_TWO and m > 0
        self._turned = options.components == Components.INERTIAL
        if self._turned and self._guided:
            raise ValueError("supports along fixed axes (Shell.guide) need Components.LOCAL")
        self._plain = self.p.plain, self.s.plain
        self.weights, self.scale = np.zeros(m), np.ones(m)
        s = self.s
        self._accepted = Instant(s.H, s.twist1, s.rate1, self.weights)
        self._end_instant, self.forces = self._accepted._replace(H=s.H1), equations.room()
        self.measure = np.where(unknowns.angular, ROTATION, 1.0 / length)
        self._sizes = self.scale, self.measure, unknowns.joined
        methods = methods_in_time(equations)
        self.solver = DirectSolver(equations.matrix, options.petsc_options_prefix, methods)
        self.r, self.dx = self.solver.right_hand_side, self.solver.solution
        self._last_ratio, self._motion, self._index, self._born = 1.0, 0.0, 0, 0
        self._end, self._iterations, self._made = 0.0, 0, 0
        self.books = equations.books()

    def history(
        self, steps: int, saving: Saving, progress: bool | None, store: Checkpoints | None
    ) -> Recorder:
        """What takes its rows from the equations."""
        return Recorder(self.equations, steps, self.h, saving, progress, store)

    @property
    def index(self) -> int:
        """Steps made, and the one that is being made."""
        return self._index

    # --- start ---

    def start(self) -> None:
        """Consistent accelerations and multipliers; scaling of the constraints."""
        equations, p, s = self.equations, self.p, self.s
        check_velocities(equations, p.h)
        self.weights[:] = set_start(equations, self.solver, p, s)
        equations.set_time(0.0)
        equations.residual(self._accepted, self.scale, self.r, self.forces)
        self._fill(s.H, s.H, turned=False)
        self.scale[:] = equations.constraint_scale(s.H)
        self.books.open(0.0, *self._accepted)
        self._warm_up()
        self.solver.factorisations = self.solver.refreshes = 0

    def _warm_up(self) -> None:
        """Compile what a step needs on a copy of the state: compilation is not integration."""
        scheme, copy = self.p.plain, self.s.copy()
        state = copy.plain
        predict(scheme, state)
        zero, weights = np.zeros_like(self.dx), self.weights.copy()
        correct(scheme, state, zero, *self._sizes, weights)
        accept(scheme, state)
        estimate(1.0, np.inf, 1.0)
        # the first iteration makes the matrix that counts
        s, d, turned = self.s, copy.d, self._turned
        given = self._ahead(), None, turned, None, self.choices
        plan = Plan(d, self.scale, self.p.mass, self.p.damping, *given)
        self.equations.fill(self._end_instant, self.forces, plan)
        if turned:
            turn_all(s.kinds, s.H, zero)
            turn_all_back(s.kinds, s.H, zero)
        else:
            self.equations.refresh(self._ahead(), d, self.scale)

    # --- steps ---

    def _advance(self, history: Recorder) -> bool:
        self._index += 1
        self._end = self._index * self.h
        self._go_to_time(self._end)
        self._iterations = self._step()
        if self._iterations:
            self.equations.accept(self.s.H)
            self._book(self._end)
        return self._iterations > 0

    def _go_to_time(self, time: float) -> None:
        """Loads, targets and prescribed frames at the end of the step."""
        if self._changing:
            self.equations.set_time(time)
            self.s.H1[self._moving + 1 :] = self.equations.prescribed(time).frames

    def _book(self, end: float) -> None:
        self.books.add(self.h, end, *self._accepted)

    def _record(self, history: Recorder) -> bool:
        return history.record(self._index, *self._accepted, self._iterations, self.books.total)

    def _result(self, history: Recorder) -> Result:
        return history.result(self.solver.factorisations, history.seconds, self.solver.refreshes)

    def memory(self) -> dict[str, Array]:
        """All that the next steps depend on."""
        numbers = [self._last_ratio, self._motion, self._index, self._born]
        counts = [self.solver.factorisations, self.solver.refreshes]
        kept = {"H": self.s.H, "H1": self.s.H1, "motion": self.s.motion, "weights": self.weights}
        kept |= {"scale": self.scale, "numbers": np.array(numbers, dtype=np.float64)}
        kept |= {"counts": np.array(counts)}
        return super().memory() | self.books.memory() | kept

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Be as when :meth:`memory` was called."""
        s, equations = self.s, self.equations
        s.H[:], s.H1[:], s.motion[:] = kept["H"], kept["H1"], kept["motion"]
        self.weights[:], self.scale[:] = kept["weights"], kept["scale"]
        self.books.restore(kept)
        self._last_ratio, self._motion = (float(x) for x in kept["numbers"][:2])
        self._index, self._born = (int(x) for x in kept["numbers"][2:])
        if equations.unknowns.time_dependent:
            equations.set_time(self._index * self.h)
        super().restore(kept)
        self.solver.factorise()
        self.solver.factorisations, self.solver.refreshes = (int(x) for x in kept["counts"])

    def _failure(self, steps: int) -> str:
        limit, tolerance = self.options.max_iterations, self.options.tolerance
        residual = float(np.abs(self.r).max())
        if self.reason:
            return f"step {self._index} of {steps} (time {self._end:g}) failed: {self.reason}"
        rescued, reached = self.options.policy.rescue, self._increment
        return failure(self._index, steps, self.p.h, limit, reached, residual, tolerance, rescued)

    def _step(self) -> int:
        """One step; returns its iterations, those that failed, too; 0 if all has failed.

        A step that diverges with the kept matrix is done again with a new one in every iteration
        and with the stress as an iterate.
        """
        weights, self.reason = self.weights.copy(), ""
        count = self._iterate(self.decisions, carried=False)
        if count == 0 and self.options.policy.rescue:
            in_vain = self._made
            _log.info("step %d: kept matrix diverges, full iteration", self._index)
            self.weights[:] = weights
            # the predicted end of the step may be far off: its stress is no start
            self.equations.carry(self.s.H)
            count = self._iterate(EveryIteration().begin(bound=False), carried=True)
            count += in_vain if count else 0
        return count

    def _iterate(self, decisions: Decisions, *, carried: bool) -> int:
        """Predict, and correct until it converges; returns the iterations, 0 on failure."""
        try:
            return self._newton(decisions, carried)
        except SingularMatrixError:
            self._increment = np.inf
            return 0

    def _newton(self, decisions: Decisions, carried: bool) -> int:
        equations, s = self.equations, self.s
        self._motion = max(predict(*self._plain), self._motion)
        tolerance = self._tolerance()
        previous, ratio = np.inf, self._last_ratio
        end = self._end_instant, self.scale, self.r, self.forces
        for iteration in range(1, self.options.max_iterations + 1):
            self._made = iteration
            equations.residual(*end, carried=carried)
            update = decisions.before_iteration(iteration)
            if self.solver.factorisations == 0 or update == Update.ALL or update is True:
                self._factorise(None if carried else s.H1)
            elif update == Update.CONSTRAINTS:
                self._refresh()
            self._solve()
            if carried:
                h = np.empty_like(s.d)
                twists(s.kinds, s.d, -self.dx[: s.d.size].reshape(-1, 6), h)
                equations.carry(s.H1, h.ravel())
            scale, measure, joined = self._sizes
            self._increment = correct(*self._plain, self.dx, scale, measure, joined, self.weights)
            ratio, remaining = estimate(self._increment, previous, ratio)
            stagnant = carried and ratio > 0.5 and self._increment < _STAGNATION
            if remaining <= tolerance or self._increment <= ROUND_OFF or stagnant:
                if equations.matrix.redundant and self._contradicts(tolerance, stagnant):
                    return 0
                self._last_ratio = ratio if iteration > 1 else ratio**UNMEASURED
                decisions.after_step(iteration)
                if decisions.asks and not self._turned:
                    decisions.answer(iteration, ratio, self._staleness())
                if self._projects:
                    project(equations, self.solver, s, self.scale, self._end, self.p.h)
                accept(*self._plain)
                equations.turn_drills(s.H, s.motion, WRITTEN_LOCALLY)
                return iteration
            if not self._increment < DIVERGED:
                return 0
            previous = self._increment
        return 0

    def _contradicts(self, tolerance: float, stagnant: bool) -> bool:
        """Whether what is left of the constraints' violation is not the iteration's."""
        values = self.r[6 * self._moving :] / self.scale
        # increments of an iteration that goes nowhere explain nothing
        allowed = tolerance if stagnant else max(tolerance, self._increment)
        if not contradicts(values, self.measure, allowed):
            return False
        self.reason = self.equations.constraints(self.s.H1).contradiction(values)
        return True

    def _staleness(self) -> float:
        """See :mod:`fem_lie.solve.alpha.staleness`; in the direction of the last correction."""
        x = self.dx.copy()
        back_to_local(self.s.H1, self.s.kinds, x)
        return staleness(
            self.equations, self.solver, self.p.plain, self.s, self.weights, self._sizes, x
        )

    def _tolerance(self) -> float:
        """Error that the iteration of a step may leave, see :data:`~.convergence.ROTATION`."""
        return max(self.options.tolerance * self._motion, ROUND_OFF)

    def _solve(self) -> None:
        """Solve; the residual and the solution are in local components."""
        H1, kinds = self.s.H1, self.s.kinds
        if self._turned:
            turn_all(kinds, H1, self.r)
        self.solver.solve()
        if self._turned:
            turn_all_back(kinds, H1, self.dx)
        if self._guided:
            self.equations.to_frames(H1, self.dx)

    def _factorise(self, stressed: Array | None) -> None:
        """New matrix; ``stressed``: frames whose stress it has, ``None`` for the carried one."""
        self._fill(stressed, self._ahead(), turned=self._turned)
        self.solver.factorise()

    def _refresh(self) -> None:
        """The constraints anew in the kept matrix."""
        if self._turned:
            self._factorise(self.s.H1)
            return
        self.equations.refresh(self._ahead(), self.s.d, self.scale)
        self.solver.refresh()

    def _fill(self, stressed: Array | None, joint_frames: Array, *, turned: bool) -> None:
        p = self.p
        given = joint_frames, None, turned, stressed, self.choices
        plan = Plan(self.s.d, self.scale, p.mass, p.damping, *given)
        self.equations.fill(self._end_instant, self.forces, plan)

    def _ahead(self) -> Array:
        """Frames in the middle of the time for which the matrix is likely to be kept.

        Only the constraints' Jacobian is taken there: it turns with the bodies, the rest does not.
        """
        steps = (self._index - self._born) // 2
        self._born = self._index
        s, frames = self.s, self.s.H1.copy()
        # along a screw motion on either group: joints stay closed
        follow_all(s.kinds, s.H1, steps * self.p.h * s.twist1, frames)
        return frames
