"""Run of a conserving scheme: results and checkpoints; the steps are in :mod:`.steps`."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from functools import cached_property

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._state import part_of, put_back, saved
from fem_lie.linear.direct import DirectSolver
from fem_lie.linear.factors import Factors, factorise
from fem_lie.results import Result
from fem_lie.results.record import Record
from fem_lie.solve.conserving import steps
from fem_lie.solve.conserving.cell_state import CellState
from fem_lie.solve.conserving.midpoint.any_node import twists
from fem_lie.solve.conserving.midpoint.end_forces import at_end, rates_at_end
from fem_lie.solve.conserving.run_state import PREFIX
from fem_lie.solve.conserving.step import loop
from fem_lie.solve.conserving.step.records import Solution
from fem_lie.solve.conserving.steps import Steps
from fem_lie.solve.convergence import failure
from fem_lie.solve.motion.consistent import accelerations
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.plan import EqualSteps
from fem_lie.solve.recording.recorder import History
from fem_lie.solve.recording.whole_state import MovingState

_log = logging.getLogger(__name__)

_AT_A_TIME = 20_000
"""Steps times unknowns (some milliseconds) after which the loop returns, so that it can be
interrupted."""
_CANCELLED = 1e-13
"""Relative error of energies, over the largest one of a run, above which a warning is logged."""


class Run(Steps):
    """Run with constant steps."""

    _common: tuple[str, ...] = (
        *("decisions", "division", "progress", "counts", "size", "unpredicted"),
        *("s.filter_state", "s.sizes", "_end_forces.debt"),
    )
    """State that all ranks of a divided scene have in common."""

    @property
    def _now(self) -> float:
        """Time of the current state, on the later side of a discontinuity."""
        return self.index * self.h

    def history(
        self, plan: EqualSteps, progress: bool | None, store: Checkpoints | None
    ) -> History:
        """Create the history of results."""
        return History(self.equations.info, plan, progress, store, self.equations.part)

    # --- steps ---

    def _advance(self, history: History) -> bool:
        first = history.row
        made = self._reaches(history)
        # rows that the compiled loop has filled in show which steps it has made
        self._rotations.note(self.this.step[self._framed, 3:])
        self._rotations.note(
            self.h * history.velocities[first : history.row, self._framed_rows, 3:]
        )
        return made

    def _reaches(self, history: History) -> bool:
        """Advance to the next step with something to do; return whether it was reached."""
        if self._alone:
            return self._make_in_loop(history)
        last = history.next_stop(self.index)
        if self.rule is None or self._changing or self._each or self._ranks is not None:
            last = self.index + 1
        return self._go_to(last, self.index * self.h, (self.index + 1) * self.h)

    @property
    def _alone(self) -> bool:
        """Whether the compiled loop can make and record the next steps by itself."""
        arrays, s = self.equations.arrays, self.s
        ruled = self.rule is not None and self._factors is not None
        known = len(s.multipliers) == 0 or s.sizes[-1] > 0.0
        return (
            ruled
            and not (self.unpredicted or self.division.level)
            and known
            and arrays.complete
            and (not self._held or self._table is not None)
            and not (self._changing or self._each)
            and self._ranks is None
        )

    def _make_in_loop(self, history: History) -> bool:
        """Make as many steps as the loop can make and record by itself.

        Return whether one was made.
        """
        assert self.rule is not None
        most = max(1, _AT_A_TIME // self.equations.unknowns.size)
        last, wanted = history.steps_in_loop(self.index, most)
        results = self._filled.scene, history.arrays.addresses, wanted
        supports = self._supports(history)
        progress, packed = self.progress, self._packed
        progress.row, progress.wanted, progress.near = history.row, 0, 0
        given = self._given(self.rule, self.options.max_iterations)
        code = loop.MATRIX
        while code == loop.MATRIX:
            assert self._factors is not None
            kept = self._factors.plain, given, self._progress_at
            how = *kept, results, supports, last
            code = steps.run(packed.model, packed.state, packed.step, *how)
            self._check_callbacks()
            if code == loop.MATRIX and not self._refactorised():
                code = loop.FAILED
        filled = int(progress.wanted)
        self._kept = int(wanted[filled - 1]) if filled else -1
        history.row, history.turns_far = int(progress.row), bool(progress.near)
        if code == loop.LOST:
            code = self._restart_step()
        if code == loop.DONE or (self._may_fall_back and self._fallback_converged()):
            return True
        return self.divides and self._divide()

    def _supports(self, history: History) -> steps.PlainSupports:
        """Supports whose reactions the compiled loop fills in."""
        unknowns, arrays = self.equations.unknowns, self.equations.arrays
        wanted = self._held and Record.FORCES in history.filled
        rows = history.reactions if wanted else np.empty((0, 0, 6))
        table = np.empty((0, 5), dtype=np.int64) if self._table is None else self._table
        ones = np.ones(unknowns.m)
        held = unknowns.held, unknowns.supported
        return (*steps.Supports(table, arrays.turning, *held, rows, ones),)

    @property
    def _table(self) -> Indices | None:
        """Packed arrays of the sum of all forces, if they are one compiled sum."""
        return self._found.addresses if self.equations.arrays.in_one_sum else None

    def _failure(self, steps: int) -> str:
        increment = float(self.progress.increment)
        own = float(np.abs(Solution(*self.this.r).residual).max(initial=0.0))
        largest = self.equations.shared.largest(own)
        limit, tolerance = self.options.max_iterations, self.options.tolerance
        after_fallback = self._may_fall_back
        index = self.index + 1
        text = failure(index, steps, self.h, limit, increment, largest, tolerance, after_fallback)
        text = self._because(text, steps, index)
        return self._nor_in_parts(text)

    # --- results ---

    def _record(self, history: History) -> bool:
        index = self.index
        filled = self._kept == index > 0
        wanted = filled or history.wants(index)
        if wanted and not filled:
            self.keep(history)
        if index:
            history.update_if_due(index, int(self.progress.total))
        return wanted

    def _result(self, history: History) -> Result:
        self._rotations.report()
        self.division.report(self.index)
        self._warn_of_cancellation()
        return history.result(int(self.counts[0]), history.seconds, divided=self.division.divided)

    def _warn_of_cancellation(self) -> None:
        """Warn of constitutive laws that lose the digits of small strains, if energies show it."""
        cancels, most = self.vector_cells.cancels, float(self.s.filter_state.energy)
        error = float(np.linalg.norm(cancels))
        if error > _CANCELLED * most:
            _log.warning(
                "energies of %d cells are differences of larger numbers, wrong by %.1e of %.1e: "
                "energy is conserved no better. Write the law with "
                "fem_lie.sections.log1p, expm1 and det_minus_one, which keep all digits "
                "of small strains",
                *(np.count_nonzero(cancels), error, most),
            )

    def keep(self, history: History) -> None:
        """Record the current state."""
        s, row, multipliers = self.s, history.row, self.s.multipliers
        if Record.FORCES in history.filled:
            multipliers = self._end_multipliers()
        if self._changing:
            # drives are violated by their difference from the target at the end
            self.equations.prescribed(self._end).act()
        motion = s.V, self.local(s.V[: self.moving], s.H)
        self._filled.by_both(history, s.H, motion, multipliers, s.balance)
        if self._held and Record.FORCES in history.filled:
            history.reactions[row] = self._reactions(multipliers)
        if Record.ENERGIES in history.filled:
            if self._python_forces.joints is not None:
                history.elastic[row] = self._python_forces.joints.energy(s.H)
            history.elastic[row] += s.W.sum() + self._end_forces.energy + self._end_forces.held
        history.keep(np.array([self.index]), np.array([self.progress.total]))

    def _end_multipliers(self) -> Array:
        """Multipliers at the end of the last step, see :mod:`.midpoint.end_forces`.

        In the first two steps, and after an event, they are those of the equations of motion.
        """
        equations, s, n = self.equations, self.s, self.moving
        if equations.unknowns.constraints == 0 or self.index == 0:
            return s.multipliers
        if s.sizes[-1] > 0.0:
            return at_end(s.multipliers, s.earlier, s.sizes)
        v, matrix = equations.start.velocities.copy(), equations.matrix.csr[0].copy()
        v[:n] = self.local(s.V[:n], s.H)
        solver = DirectSolver(equations.matrix, PREFIX)
        _, multipliers = accelerations(equations, solver, s.H, v, self._end, self.h)
        # the frozen factors are those of this matrix
        equations.matrix.csr[0][:] = matrix
        return multipliers

    def _reactions(self, multipliers: Array) -> Array:
        """Reactions of supports, from the equations of motion at the end of the step."""
        s, (end, v, rates) = self.s, np.empty((3, self.moving, 6))
        rates_at_end(s.rates, s.sizes, end)
        V = s.V[: self.moving]
        twists(self._kinds, self.equations.arrays.turning, s.H, V, end, v, rates)
        return self.equations.report(s.H, v, rates, multipliers, linearised=False).reactions

    # --- checkpoints ---

    def divided_state(self) -> dict[str, Array]:
        """See the base class; motion and constraints are those of :class:`~.step.records.State`."""
        s, n = self.s, self.moving
        last = s.last_residual.copy()
        self.equations.shared.sum(last)  # owners have it
        digits = (each[:n].reshape(n, 2, 6).swapaxes(0, 1) for each in (s.rest, s.V, s.w))
        motion = np.concatenate([*digits, s.rates, [s.trend, last]])
        of_joints = np.stack([s.multipliers, *s.earlier, s.gap, self.model.scale])
        of_cells = self._cell_state.pairs, self._cell_state.values
        moving = MovingState(s.H[:n], motion, of_joints, s.balance, *of_cells)
        return saved(self, self._common) | moving._asdict()

    @property
    def cell_pairs(self) -> Indices:
        """See the base class."""
        return self._cell_state.pairs

    @cached_property
    def _cell_state(self) -> CellState:
        cells, dissipates = (self.cells, self.vector_cells), self.options.dissipation > 0.0
        return CellState(self.equations, *cells, self.s, dissipates=dissipates)

    def restart(self, state: MovingState, common: Mapping[str, Array]) -> None:
        """Restart from the state of a scene that was divided, with a new matrix."""
        put_back(self, self._common, common)
        equations, s, n, time = self.equations, self.s, self.moving, self._now
        s.H[:n], s.H[n + 1 :] = state.frames, equations.prescribed(time).frames
        digits = state.motion[:6].reshape(3, 2, n, 6).swapaxes(1, 2).reshape(3, n, 4, 3)
        s.rest[:], s.V[:n], s.w[:n] = digits
        s.rates[:], s.trend[:], s.last_residual[:] = state.motion[6:8], *state.motion[8:]
        s.last_residual[~equations.shared.owned] = 0.0
        s.multipliers[:], s.earlier[:], s.gap[:], self.model.scale[:] = (
            *(state.multipliers[0], state.multipliers[1:3]),
            *state.multipliers[3:],
        )
        s.balance[:] = state.balance
        self._push_products(s.H, s.V)
        self._set_size(self.size)
        if self._changing:  # loads as in the last step
            equations.prescribed(time - 0.5 * s.sizes[0]).act()
            self.cells.pack()
            self._take_loads()
        self._evaluate_start()
        self._cell_state.restore(state.of_cells)
        equations.history_variables.update_stress(s.H)
        if self.joints is not None:
            self.joints.restart(s.H, s.gap)
        self._end_forces.at_rest(s.H)
        self._forget_iteration()

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Restore the state that :meth:`saved_state` returned."""
        super().restore(kept)
        self._set_size(self.size)
        if self._changing:
            self.equations.prescribed(max(self.index - 0.5, 0.0) * self.h).act()
            self.cells.pack()
            self._take_loads()
            self.cells.restore(part_of(kept, "cells"))
        self._factors = self._frozen_factors(kept)

    def _frozen_factors(self, kept: Mapping[str, Array]) -> Factors | None:
        """Factors with which a restarted run continues, if there are any."""
        stale = np.isinf(self.progress.excess)
        return None if stale else self._with_inverse(factorise(self.equations.matrix))
