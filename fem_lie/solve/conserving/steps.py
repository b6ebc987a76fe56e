"""Steps of a run of a conserving scheme: one by one, and many in one compiled loop.

A step begins with a prediction and ends at round-off. If it does not converge with the frozen
matrix, it is repeated with new matrices until it converges fast: first without a prediction,
because predicted unresolved oscillations are far larger than those at the end; then with the
prediction. If this fails, too, the step is divided (:mod:`fem_lie.solve.division`); each sub-step
conserves like a step.
"""

from __future__ import annotations

import logging
from typing import NamedTuple, TypeAlias

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled, linked
from fem_lie._jit.records import Record
from fem_lie.linear.equilibrated import SingularMatrixError
from fem_lie.linear.factors import PlainFactors
from fem_lie.solve.conserving.midpoint.any_node import twists
from fem_lie.solve.conserving.midpoint.end_forces import at_end, rates_at_end
from fem_lie.solve.conserving.run_state import RunState
from fem_lie.solve.conserving.step import loop
from fem_lie.solve.conserving.step.corrections import progress_of
from fem_lie.solve.conserving.step.packing import model_of, state_of
from fem_lie.solve.recording.result_row import close_row, fill_by_both
from fem_lie.solve.secants import Secants
from fem_lie.system.nodes.fixed_axes import wrenches
from fem_lie.system.nodes.sums import residual

PlainSupports: TypeAlias = tuple[Indices, Array, Flags, Indices, Array, Array]
"""Plain tuple of :class:`Supports`, with which compiled functions are called faster."""


class Supports(NamedTuple):
    """Arrays for the reactions of a state.

    Attributes:
        table: Packed arrays of the sum of all forces, see
            :func:`fem_lie.system.nodes.sums.residual`.
        turning: Angular velocities per rate of the directors, see
            :func:`~fem_lie.lie.node_types.inertia.turning_of`.
        held: Which unknowns are zero, (n, 6).
        nodes: Supported nodes, (s,).
        rows: Reactions in all rows of results, (rows, s, 6); no rows if they are not recorded.
        ones: Factors of the constraints, (m,).
    """

    table: Indices
    turning: Array
    held: Flags
    nodes: Indices
    rows: Array
    ones: Array


@linked
def run(
    model: Indices,
    starts: Indices,
    steps: Indices,
    factors: PlainFactors,
    options: tuple[float, int, int, float, float],
    progress_at: Indices,
    results: tuple[Indices, Indices, Indices],
    supports: PlainSupports,
    last: int,
) -> int:
    """Advance to step ``last`` as :func:`fem_lie.solve.conserving.step.loop.run`, filling in rows.

    Args:
        model: As in that function.
        starts: As in that function. Multipliers of three steps are known.
        steps: As in that function.
        factors: As in that function.
        options: As in that function.
        progress_at: As in that function.
        results: Constant arrays of the scene and arrays of all rows, see
            :mod:`~fem_lie.solve.recording.result_row`, and the numbers of the recorded steps.
        supports: Supports whose reactions are recorded, see :class:`Supports`.
        last: Last step; the loop returns earlier if an element exceeds its rotation limit.
    """
    wanted, progress = results[2], progress_of(progress_at).progress[0]
    while progress.steps < last:
        at = progress.wanted
        to = wanted[at] if at < wanted.shape[0] else last
        code = loop.run(model, starts, steps, factors, options, progress_at, to)
        if code != loop.DONE:
            return code
        if at < wanted.shape[0]:
            progress.near = _fill(model, starts, results[:2], supports[1], progress)
            if supports[4].shape[0] > 0:
                _fill_reactions(model, starts, supports, progress.row)
            progress.row += 1
            progress.wanted += 1
            if progress.near:
                return loop.DONE
    return loop.DONE


@compiled
def _fill(
    packed: Indices,
    starts: Indices,
    results: tuple[Indices, Indices],
    turning: Array,
    progress: Record,
) -> bool:
    """Fill in a row with the current state.

    Returns whether an element is near its rotation limit.
    """
    s, (scene, rows), model = state_of(starts), results, model_of(packed)
    kinds, row, h = model.kinds, progress.row, model.scheme.h
    multipliers, n = s.multipliers, kinds.shape[0]
    workspace = np.zeros((3, n, 6))
    v, unused, still = workspace[0], workspace[1], workspace[2]
    twists(kinds, turning, s.H, s.V[:n], still, v, unused)
    if multipliers.shape[0] > 0:
        multipliers = at_end(s.multipliers, s.earlier, s.sizes)
    potential, springs, near = fill_by_both(s.H, v, s.V, multipliers, s.balance, scene, rows, row)
    close_row(rows, row, potential, springs + np.sum(s.W), progress.steps * h, progress.total)
    return near


@compiled
def _fill_reactions(packed: Indices, starts: Indices, supports: PlainSupports, row: int) -> None:
    """Fill in the reactions of the current state, from the equations of motion."""
    (table, turning, held, nodes, rows, ones), s = supports, state_of(starts)
    kinds, n = model_of(packed).kinds, s.rates.shape[1]
    rates, v, a = np.empty((n, 6)), np.empty((n, 6)), np.empty((n, 6))
    r, multipliers = np.empty(6 * n + s.multipliers.shape[0]), s.multipliers
    if multipliers.shape[0] > 0:
        multipliers = at_end(s.multipliers, s.earlier, s.sizes)
    rates_at_end(s.rates, s.sizes, rates)
    twists(kinds, turning, s.H, s.V[:n], rates, v, a)
    residual(s.H, v, a, multipliers, ones, r, table)
    rows[row] = wrenches(kinds, s.H, r[: 6 * n].reshape(n, 6), held, nodes)


_log = logging.getLogger(__name__)

_FALLBACK = 1, 40.0
"""Patience, and cost of a matrix in iterations, for a step that failed."""
_SLOW = 4
"""Factor of the iteration limit with new matrices: without a prediction they converge reliably, but
slowly if much energy is in oscillations that the step does not resolve."""
_LONG, _SETTLED = 20, 1e-11
"""Iterations without progress after which increments of this size, in lengths of the model, are
round-off."""
_UNPREDICTED = 8
"""Number of steps without a prediction after one that did not converge with it."""
_LEARNT, _SPIRALS = 8, 10.0
"""Number of secants if new matrices fail, and the largest ratio of successive corrections."""
_SHARE = 0.4
"""Fraction of the cost of a matrix that a step may spend on further iterations instead: earlier
steps share the gain."""


class Steps(RunState):
    """Steps of a run of a conserving scheme.

    Attributes:
        endures: Whether a matrix stays frozen even if a step is slow, as long as a new one costs
            more.
    """

    endures = True

    @property
    def divides(self) -> bool:
        """Whether the policy allows a failed step to be divided.

        Unlike contradictory constraints, surfaces that pass through each other do not prevent it.
        """
        return self._may_fall_back

    def _go_to(self, last: int, start: float, end: float) -> bool:
        """Make all steps up to ``last``, the first from ``start`` to ``end``.

        Return whether they converged.
        """
        first, size = self.index, end - start
        while self.index < last:
            past = (self.index - first) * size
            if not self._next(last, start + past, end + past):
                return False
        return True

    def _next(self, last: int, start: float, end: float) -> bool:
        """Make the next step, or several up to ``last`` if none is divided.

        Return whether it was made.
        """
        first = self.index
        if not self.division.level:
            self._set_end(start, end + (last - first - 1) * (end - start))
            if self._goes(last) or (self._may_fall_back and self._fallback_converged()):
                return True
            if not self.divides:
                return False
            return self._divide()
        return self._cover()

    def attempt(self, start: float, end: float) -> bool:
        """Make a step, see :class:`~fem_lie.solve.division.Divisible`."""
        self.progress.steps = self.begun
        self._set_end(start, end)
        return self._goes(self.begun + 1) or self._fallback_converged()

    def resize(self, time: float, size: float) -> None:
        """Start steps of another size, see :class:`~fem_lie.solve.division.Divisible`."""
        self._resize(self.part_size)
        self._forget_iteration()

    def _forget_iteration(self) -> None:
        """Reset the iteration history, so that the next step refactorises for its own size."""
        self._factors, self.progress.excess = None, np.inf
        self.progress.iteration = self.progress.asked = 0

    def _set_end(self, start: float, end: float) -> None:
        self._end = end
        if self._changing:
            self._set_time(start, end)

    def _goes(self, last: int) -> bool:
        """Whether steps up to ``last`` converge with the frozen matrix."""
        rule = (1, 0.0) if self.rule is None else self.rule
        while self.unpredicted and self.index < last:
            if not self._make(rule, still=True):
                return False
            self.unpredicted -= 1
        return self.index == last or self._go(last, rule) != loop.FAILED

    def _fallback_converged(self) -> bool:
        """Repeat the failed step with the fallback methods; return whether it converged."""
        _log.info("step %d: the iteration matrix is too old, new matrices", self.index + 1)
        self.s.multipliers[:] = self.this.multipliers
        progress = self.progress
        stalled = self.progress.stalls >= _LONG and not self.model.vectors
        # cells on nodes with vector coordinates also prevent convergence with an old matrix
        if stalled and progress.least <= _SETTLED:
            progress.floor = progress.least
        # a step in which surfaces pass through each other would repeat it
        return not self.reason and self._retry()

    def _retry(self) -> bool:
        """Repeat the failed step from its start, with new matrices until it converges fast."""
        if self.model.vectors and self._make_with_secants():
            return True
        # without a prediction contacts are those at the start of the step
        predicted_first = self._python_forces.touching and not self.model.vectors
        for still in (False, True) if predicted_first else (True, False):
            self.progress.excess = np.inf
            if self._make(_FALLBACK, still=still, always=True):
                self.unpredicted = _UNPREDICTED if still else 0
                return True
            self.s.multipliers[:] = self.this.multipliers
            if self.reason:
                break
        return False

    def _make_with_secants(self) -> bool:
        """Make the step with one new matrix and secants from earlier corrections.

        The matrix does not contain the effect of the rotation of a step on cells: a few directions,
        in which no matrix helps.
        """
        kept = self._python_forces.learns
        given = _LEARNT, self._node_measure, self.equations.shared
        self._python_forces.learn(Secants(*given, growth=_SPIRALS))
        self.progress.excess = np.inf
        each, self._each = self._each, True
        made = self._make((self.options.max_iterations + 1, np.inf), still=False)
        self._python_forces.learn(kept)
        self._each = each
        if not made:
            self.s.multipliers[:] = self.this.multipliers
        return made

    def _make(self, rule: tuple[int, float], *, still: bool, always: bool = False) -> bool:
        """Make one step; return whether it converged.

        Args:
            rule: Refactorisation rule, see
                :meth:`~fem_lie.solve.motion.policies.RefactorisationPolicy.rule`.
            still: Start without a prediction, in which unresolved oscillations are far larger than
                at the end of the step.
            always: Ignore the other options of the policy.
        """
        self.reason = ""
        self._begin()
        if still:
            self.this.step[:] = 0.0
        return self._go(self.index + 1, rule, always=always) != loop.FAILED

    def _begin(self) -> None:
        """Predict the next step, before its matrix is assembled."""
        packed = self._packed
        loop.predict(packed.model, packed.state, packed.step, self._progress_at)

    def _go(self, last: int, rule: tuple[int, float], *, always: bool = False) -> int:
        """Make steps up to ``last``."""
        limit = self.options.max_iterations * (_SLOW if always else 1)
        go = self._go_each if self._each else self._go_free
        return go(last, rule, limit, always=always)

    def _go_each(
        self, last: int, rule: tuple[int, float], limit: int, *, always: bool = False
    ) -> int:
        """The same if Python has something to do before and after each step."""
        python_forces = self._python_forces
        while self.index < last:
            self.reason = ""
            python_forces.begin()
            start = self.s.H.copy()
            go = self._go_free if python_forces.contacts is None else self._step_with_contacts
            code = go(self.index + 1, rule, limit, always=always)
            if code != loop.DONE:
                return code
            self._go_on(start)
        return loop.DONE

    def _step_with_contacts(
        self, last: int, rule: tuple[int, float], limit: int, *, always: bool = False
    ) -> int:
        """Make step ``last``, the next one, of a scene with contacts.

        Contacts that do not act at the predicted end are not evaluated in the step. If they act at
        the computed end, the step is repeated with them.
        """
        python_forces, before = self._python_forces, self.saved()
        if self._end_forces.act_always:
            python_forces.touch(True)
        else:
            if self.progress.iteration == 0:
                self._begin()
            python_forces.look_ahead()
        code = self._go_free(last, rule, limit, always=always)
        if code == loop.DONE and not python_forces.touching and self._end_forces.overlap(self.s.H):
            self.take_back(before)
            self._begin()
            python_forces.touch(True)
            code = self._go_free(last, rule, limit, always=always)
        if code == loop.DONE and not self._surfaces_stay_separate(before["s.H"], self.s.H):
            self.take_back(before)
            return loop.FAILED
        return code

    def _go_on(self, start: Array) -> None:
        """Tasks after a step from frames ``start``."""
        s, python_forces, history = self.s, self._python_forces, self.equations.history_variables
        history.accept(s.H, start)
        if python_forces.joints is not None:
            python_forces.joints.accept(s.H, self.model.driven, s.gap)
        python_forces.accept()
        if self.model.vectors:
            history.rotate_axes(s.H)

    def _go_free(
        self, last: int, rule: tuple[int, float], limit: int, *, always: bool = False
    ) -> int:
        progress, given = self.progress, self._given(rule, limit)
        while True:
            packed = self._packed
            tables = packed.model, packed.state, packed.step
            if self._factors is None:
                code = loop.MATRIX
                if progress.iteration == 0:
                    self._begin()
                progress.asked = progress.iteration
            else:
                factors = self._factors.plain
                code = loop.run(*tables, factors, given, self._progress_at, last)
                self._check_callbacks()
            if code == loop.LOST:
                code = self._restart_step()
                if code == loop.DONE and self.index < last:
                    continue
                return code
            if code == loop.DONE and self.rule is None:
                self.decisions.after_step(int(progress.last))
            if code != loop.MATRIX:
                return code
            iteration = int(progress.iteration)
            asked = always or self.rule is not None or self._factors is None
            wanted = asked or self.decisions.before_iteration(iteration)
            if wanted and not self._refactorised():
                return loop.FAILED

    def _check_callbacks(self) -> None:
        """Raise the error of a callback of compiled steps, if there was one."""
        self._python_forces.check()
        if self._ranks is not None:
            self._ranks.check()

    def _refactorised(self) -> bool:
        """Factorise a new matrix; return whether it is regular."""
        try:
            self._factorise()
        except SingularMatrixError:
            self.progress.increment = np.inf
            return False
        return True

    def _restart_step(self) -> int:
        """Repeat the current step by full Newton: the frozen Jacobian would mislead it."""
        self.progress.asked, self._lost = 0, True
        rule = 1, 0.0
        if self._each:
            limit = self.options.max_iterations * _SLOW
            code = self._go_free(self.index + 1, rule, limit, always=True)
        else:
            code = self._go(self.index + 1, rule, always=True)
        self._lost = False
        return code

    def _given(self, rule: tuple[int, float], limit: int) -> tuple[float, int, int, float, float]:
        """Options for the loop."""
        spare = _SHARE * rule[1] if self.endures and np.isfinite(rule[1]) else 0.0
        return self.options.tolerance, limit, *rule, spare
