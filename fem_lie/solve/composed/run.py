"""Run of composed steps: sub-steps, results at the ends of steps, checkpoints."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit.records import block_of
from fem_lie._state import attributes, put_back, saved
from fem_lie.linear.direct import DirectSolver
from fem_lie.results import Result
from fem_lie.results.record import Record
from fem_lie.solve.composed import momentum_parts
from fem_lie.solve.composed.parts import Part
from fem_lie.solve.conserving.run_state import PREFIX, Options
from fem_lie.solve.conserving.step import loop
from fem_lie.solve.convergence import failure
from fem_lie.solve.motion.consistent import accelerations
from fem_lie.solve.motion.integration import DividedIntegration
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.plan import EqualSteps
from fem_lie.solve.recording.recorder import History
from fem_lie.solve.recording.result_row import ResultRow
from fem_lie.system.equations import Equations, TimeState

_COUNTED = "_position", "_progresses"
"""State that a step changes in addition to that of its sub-steps."""


class ComposedRun(DividedIntegration[History]):
    """Run of composed steps of a conserving scheme."""

    STATE = attributes("_position", "_parts")

    def __init__(
        self, options: Options, equations: Equations, step: float, halves: tuple[float, ...]
    ) -> None:
        """Set up without computing anything.

        Args:
            options: Options of the scheme of the sub-steps.
            equations: Equations of the scene.
            step: Size of the whole steps.
            halves: Sizes of the half sub-steps over that of the step; two of them differ.
        """
        super().__init__(options.policy, equations, step)
        self.equations_state = equations.history_variables
        self.options, shares = options, list(dict.fromkeys(halves))
        first = Part(options, equations, step, shares[0], halves.count(shares[0]), None)
        other = Part(options, equations, step, shares[1], halves.count(shares[1]), first)
        self._parts = first, other
        self._order = np.array([shares.index(half) for half in halves], dtype=np.int64)
        self._ends = np.cumsum([0.0, *halves])
        self._progresses = tuple(part.progress for part in self._parts)
        self._position = momentum_parts.POSITION()
        self._start, self._left = 0.0, (0, np.inf, np.inf)
        self._filled, self._r = ResultRow(equations), np.empty(equations.unknowns.size)
        self._solver: DirectSolver | None = None

    def history(
        self, plan: EqualSteps, progress: bool | None, store: Checkpoints | None
    ) -> History:
        """Create the history of results."""
        return History(self.equations.info, plan, progress, store)

    def start(self) -> None:
        """Compute the initial state."""
        first, other = self._parts
        first.start()
        other.start_as(first)

    @property
    def frames(self) -> Array:
        """Current frames of all nodes, ground and prescribed motions."""
        return self._parts[0].frames

    @property
    def index(self) -> int:
        """Number of steps made, including the current one."""
        return int(self._position.made)

    # --- steps ---

    def _advance(self, history: History) -> bool:
        last = history.next_stop(self.index)
        while self.index < last:
            if self.division.level:
                made = self._cover()
            else:
                made = self._go(last) or (self.divides and self._divide())
            if not made:
                return False
        return True

    def _go(self, last: int) -> bool:
        """Make whole steps up to ``last``, or all before one that fails.

        Return whether any was made.
        """
        first = self.index
        failed = self._failed_at(last)
        return failed is None or (failed > first and self._failed_at(failed) is None)

    def _failed_at(self, last: int) -> int | None:
        """The first step up to ``last`` that fails, if any; the state is then restored."""
        first, before = self._parts[0], self._parts[0].saved()
        counted = saved(self, _COUNTED)
        while self.index < last:
            if not (self._all_parts(last) if self._quick else self._one_part()):
                failed, self._left = self.index, self._failed_sub_step()
                first.take_back(before)
                put_back(self, _COUNTED, counted)
                for part in self._parts:
                    part.keep_old_matrix()
                return failed
        return None

    def _failed_sub_step(self) -> tuple[int, float, float]:
        """Number of the failed sub-step, from 1, its last increment and largest residual."""
        part = self._parts[self._position.chosen]
        increment, left = part.progress.increment, np.abs(part.this.r[0]).max()
        return int(self._position.part) + 1, float(increment), float(left)

    def attempt(self, start: float, end: float) -> bool:
        """Make a whole step; return whether it converged."""
        self._position.made, self._start = self.begun, start
        return self._failed_at(self.begun + 1) is None

    def resize(self, time: float, size: float) -> None:
        """Start whole steps of another size."""
        first, other = self._parts
        first.resize_whole(self.part_size)
        other.resize_whole(self.part_size, shared=True)

    @property
    def _quick(self) -> bool:
        """Whether there is nothing to do between sub-steps."""
        first, other = self._parts
        kept = first.factors is not None and other.factors is not None
        asked = first.rule is None or self.equations.unknowns.time_dependent
        return kept and not (asked or first.asks or first.still or other.still)

    def _all_parts(self, last: int) -> bool:
        """Advance to step ``last``, or to the end of a sub-step with a request."""
        first, other = self._parts
        assert first.factors is not None and other.factors is not None
        code = momentum_parts.run(
            (first.compiled_model, other.compiled_model),
            *first.compiled_state,
            (first.factors, other.factors),
            first.compiled_options,
            (first.progress_at, other.progress_at),
            (np.array([first.h, other.h]), self._order),
            block_of(self._position)[0],
            last,
        )
        if code == loop.DONE:
            return True
        part = self._parts[self._order[self._position.part]]
        return self._passed(part.go_on(code, *self._span()))

    def _one_part(self) -> bool:
        """Make the next sub-step; return whether it converged."""
        position = self._position
        k = int(self._order[position.part])
        part, before = self._parts[k], self._parts[position.chosen]
        if position.chosen != k:
            momentum_parts.resize(part.s.last_residual, before.h, part.h)
            position.chosen = k
        return self._passed(part.make(*self._span()))

    def _passed(self, made: bool) -> bool:
        position = self._position
        if made:
            position.part += 1
            if position.part == len(self._order):
                position.part = 0
                position.made += 1
        return made

    def _span(self) -> tuple[float, float]:
        """Start and end of the current sub-step."""
        k = int(self._position.part)
        ends = self._ends[k : k + 2]
        if self.division.level:
            start, end = self._start + ends * self.part_size
        else:
            start, end = (self.index + ends) * self.h
        return float(start), float(end)

    def _failure(self, steps: int) -> str:
        options, (part, increment, left) = self.options, self._left
        limit, tolerance = options.max_iterations, options.tolerance
        numbers = limit, increment, left, tolerance, self._may_fall_back
        text = f"sub-step {part} of {failure(self.index + 1, steps, self.h, *numbers)}"
        return self._nor_in_parts(text)

    # --- results ---

    @property
    def _iterations(self) -> int:
        return sum(int(part.progress.total) for part in self._parts)

    def _record(self, history: History) -> bool:
        wanted = history.wants(self.index)
        if wanted:
            self._keep_row(history)
        if self.index:
            history.update_if_due(self.index, self._iterations)
        return wanted

    def _result(self, history: History) -> Result:
        factorisations = sum(int(part.counts[0]) for part in self._parts)
        self.division.report(self.index)
        divided = self.division.divided
        return history.result(factorisations, history.seconds, divided=divided)

    def _keep_row(self, history: History) -> None:
        """Record the end of a step, with forces from the equations of motion.

        Forces of the sub-steps are of no higher order than the sub-steps themselves.
        """
        equations, s, row = self.equations, self._parts[0].s, history.row
        n, held = equations.unknowns.moving, len(equations.unknowns.supported) > 0
        v, multipliers = equations.start.velocities.copy(), s.multipliers
        rates: Array = np.zeros((n, 6))
        v[:n] = self._parts[0].local(s.V[:n], s.H)
        if Record.FORCES in history.filled and (held or len(multipliers)):
            rates, multipliers = self._end_forces(v)
        self._filled.by_both(history, s.H, (s.V, v[:n]), multipliers, s.balance)
        if Record.FORCES in history.filled and held:
            report = equations.report(s.H, v, rates, multipliers, linearised=False)
            history.reactions[row] = report.reactions
        if Record.ENERGIES in history.filled:
            joints = self._parts[0].joints
            if joints is not None:
                history.elastic[row] = joints.energy(s.H)
            history.elastic[row] += s.W.sum()
        history.keep(np.array([self.index]), np.array([self._iterations]))

    def _end_forces(self, v: Array) -> tuple[Array, Array]:
        """Accelerations and multipliers at the current state with twists ``v`` of all nodes.

        They are of fourth order, and need a matrix of their own at each recorded state.
        """
        equations, s = self.equations, self._parts[0].s
        if self._solver is None:
            self._solver = DirectSolver(equations.matrix, PREFIX)
        still = np.zeros((equations.unknowns.moving, 6))
        # internal unknowns of elements are those of the sub-steps, not yet set in these equations
        equations.residual(
            TimeState(s.H, v, still, s.multipliers), np.ones(len(s.multipliers)), self._r
        )
        time, size = self.index * self.h, min(abs(part.h) for part in self._parts)
        return accelerations(equations, self._solver, s.H, v, time, size, sweeps=2)
