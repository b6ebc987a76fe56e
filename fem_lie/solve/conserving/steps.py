"""Steps of a run of a conserving scheme: one by one, and many in one compiled loop.

A step begins with a prediction, and ends when nothing but round-off changes. Where that fails with
the matrix that is kept, new ones are made until it converges fast: first from no motion at all, for
what is predicted has the waves that the step does not resolve as large as their velocities say, far
beyond what they are at its end; then from the prediction. Where that fails, too, the step is made
in parts (:mod:`fem_lie.solve.division`), each of which conserves as a step does.
"""

from __future__ import annotations

import logging
from typing import NamedTuple, TypeAlias

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled, linked
from fem_lie.linear.equilibrated import SingularMatrixError
from fem_lie.linear.factors import PlainFactors
from fem_lie.solve.conserving.midpoint.any_node import twists
from fem_lie.solve.conserving.midpoint.end_forces import at_end, rates_at_end
from fem_lie.solve.conserving.run_state import RunState
from fem_lie.solve.conserving.step import corrections, joints, loop
from fem_lie.solve.conserving.step.corrections import STEPS, TOTAL
from fem_lie.solve.conserving.step.packing import PackedModel, model_of, state_of
from fem_lie.solve.recording.result_row import close_row, fill_by_both
from fem_lie.solve.secants import Secants
from fem_lie.system.nodes.fixed_axes import wrenches
from fem_lie.system.nodes.sums import residual

PlainSupports: TypeAlias = tuple[Indices, Array, Flags, Indices, Array, Array]
"""A :class:`Supports`, as compiled functions are quicker to call with."""

ROW, WANTED, NEAR = 0, 1, 2
"""Of ``place``: next row of results, how many of the wanted ones there are, and whether an element
turns nearly too far in the last one."""


class Supports(NamedTuple):
    """What reactions of a state are made of.

    Attributes:
        table: For the sum of all forces, see :func:`fem_lie.system.nodes.sums.residual`.
        turning: Of directors, see :func:`~fem_lie.lie.node_types.inertia.turning_of`.
        held: Which unknowns are zero, (n, 6).
        nodes: Those that are held from outside, (s,).
        rows: Reactions of all rows, (rows, s, 6); no rows if nobody asks for them.
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
    model: PackedModel,
    starts: Indices,
    steps: Indices,
    factors: PlainFactors,
    options: tuple[float, int, int, float, float],
    counters: Indices,
    numbers: Array,
    results: tuple[Indices, Indices, Indices],
    supports: PlainSupports,
    place: Indices,
    last: int,
) -> int:
    """Go on until step ``last`` as :func:`fem_lie.solve.conserving.step.loop.run`, which see.

    Args:
        model: See there, and so on.
        starts: See there. Multipliers of three steps are known.
        steps: See there.
        factors: See there.
        options: See there.
        counters: See there.
        numbers: See there.
        results: What of the scene is in rows, the rows, see
            :mod:`~fem_lie.solve.recording.result_row`, and the steps that have one.
        supports: Whose reactions are in rows, see :class:`Supports`.
        place: Where the results are, see :data:`ROW`, (3,), updated.
        last: Step to reach; the end of an earlier one is where an element turns too far.
    """
    wanted = results[2]
    while counters[STEPS] < last:
        at = place[WANTED]
        to = wanted[at] if at < wanted.shape[0] else last
        code = loop.run(model, starts, steps, factors, options, counters, numbers, to)
        if code != loop.DONE:
            return code
        if at < wanted.shape[0]:
            place[NEAR] = _fill(model, starts, results[:2], supports[1], place[ROW], counters)
            if supports[4].shape[0] > 0:
                _fill_reactions(model, starts, supports, place[ROW])
            place[ROW] += 1
            place[WANTED] += 1
            if place[NEAR]:
                return loop.DONE
    return loop.DONE


@compiled
def _fill(
    packed: PackedModel,
    starts: Indices,
    results: tuple[Indices, Indices],
    turning: Array,
    row: int,
    counters: Indices,
) -> bool:
    """Fill in a row with the present state; returns whether an element turns nearly too far."""
    s, (scene, rows), (_, _, (h, _, _)) = state_of(starts), results, packed
    kinds = model_of(packed).kinds
    weights, n = s.weights, kinds.shape[0]
    room = np.zeros((3, n, 6))
    v, unused, still = room[0], room[1], room[2]
    twists(kinds, turning, s.H, s.V[:n], still, v, unused)
    if weights.shape[0] > 0:
        weights = at_end(s.weights, s.earlier, s.sizes)
    potential, springs, near = fill_by_both(s.H, v, s.V, weights, s.balance, scene, rows, row)
    close_row(rows, row, potential, springs + np.sum(s.W), counters[STEPS] * h, counters[TOTAL])
    return near


@compiled
def _fill_reactions(
    packed: PackedModel, starts: Indices, supports: PlainSupports, row: int
) -> None:
    """Fill in the reactions of the present state, by the equations of motion there."""
    (table, turning, held, nodes, rows, ones), s = supports, state_of(starts)
    kinds, n = model_of(packed).kinds, s.rates.shape[1]
    rates, v, a = np.empty((n, 6)), np.empty((n, 6)), np.empty((n, 6))
    r, weights = np.empty(6 * n + s.weights.shape[0]), s.weights
    if weights.shape[0] > 0:
        weights = at_end(s.weights, s.earlier, s.sizes)
    rates_at_end(s.rates, s.sizes, rates)
    twists(kinds, turning, s.H, s.V[:n], rates, v, a)
    residual(s.H, v, a, weights, ones, r, table)
    rows[row] = wrenches(kinds, s.H, r[: 6 * n].reshape(n, 6), held, nodes)


_log = logging.getLogger(__name__)

_FALLBACK = 1, 40.0
"""Patience, and the cost of a matrix in iterations, of a step that failed."""
_SLOW = 4
"""Times as many iterations as else may be made with new matrices: they converge surely from no
motion, and slowly where much energy is in waves that the step does not resolve."""
_LONG, _SETTLED = 20, 1e-11
"""Iterations without progress after which increments of this size, in lengths, are round-off."""
_UNPREDICTED = 8
"""Steps that begin without a prediction after one that had no end with it."""
_LEARNT, _SPIRALS = 8, 10.0
"""Corrections that one learns from where the matrix alone fails, and the most that they may grow
by."""
_SHARE = 0.4
"""Of the cost of a matrix, what a step may go on for instead: the next steps gain by it, too."""


class Steps(RunState):
    """How steps are made.

    Attributes:
        endures: Whether a matrix is kept that makes a step slow, as long as another one costs more.
    """

    endures = True

    @property
    def divides(self) -> bool:
        """Whether a step that failed may be made in parts, by the policy.

        Unlike contradictions, surfaces that go through each other in it are no reason against.
        """
        return self._may_fall_back

    def _go_to(self, last: int, start: float, end: float) -> bool:
        """Make all steps up to ``last``, the first from ``start`` to ``end``; whether they were."""
        first, size = self.index, end - start
        while self.index < last:
            past = (self.index - first) * size
            if not self._next(last, start + past, end + past):
                return False
        return True

    def _next(self, last: int, start: float, end: float) -> bool:
        """Make the next step or, where that takes no parts, some up to ``last``; whether it was."""
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
        """See :class:`~fem_lie.solve.division.Divisible`."""
        self.counters[corrections.STEPS] = self.begun
        self._set_end(start, end)
        return self._goes(self.begun + 1) or self._fallback_converged()

    def resize(self, time: float, size: float) -> None:
        """See :class:`~fem_lie.solve.division.Divisible`."""
        self._resize(self.part_size)
        self._forget_iteration()

    def _forget_iteration(self) -> None:
        """Begin the next step anew, with a matrix of its own size."""
        self._factors, self.numbers[corrections.EXCESS] = None, np.inf
        self.counters[corrections.ITERATION] = self.counters[corrections.ASKED] = 0

    def _set_end(self, start: float, end: float) -> None:
        self._end = end
        if self._changing:
            self._set_time(start, end)

    def _goes(self, last: int) -> bool:
        """Whether steps up to ``last`` are made with the matrix that is kept."""
        rule = (1, 0.0) if self.rule is None else self.rule
        while self.unpredicted and self.index < last:
            if not self._make(rule, still=True):
                return False
            self.unpredicted -= 1
        return self.index == last or self._go(last, rule) != loop.FAILED

    def _fallback_converged(self) -> bool:
        """The step that failed, otherwise; whether it is made."""
        _log.info("step %d: the iteration matrix is too old, new matrices", self.index + 1)
        self.s.weights[:] = self.this.weights
        numbers = self.numbers
        stalled = self.counters[corrections.STALLS] >= _LONG and not len(self._vectors)
        # cells of nodes that are no frames keep an old matrix from its end likewise
        if stalled and numbers[corrections.LEAST] <= _SETTLED:
            numbers[corrections.FLOOR] = numbers[corrections.LEAST]
        # a step that surfaces go through does so again
        return not self.reason and self._again()

    def _again(self) -> bool:
        """The step that failed from its start, with new matrices until it converges fast."""
        if len(self._vectors) and self._make_learning():
            return True
        # from no motion contacts are those of the start of the step
        predicted_first = self._python_forces.touching and not len(self._vectors)
        for still in (False, True) if predicted_first else (True, False):
            self.numbers[corrections.EXCESS] = np.inf
            if self._make(_FALLBACK, still=still, always=True):
                self.unpredicted = _UNPREDICTED if still else 0
                return True
            self.s.weights[:] = self.this.weights
            if self.reason:
                break
        return False

    def _make_learning(self) -> bool:
        """The step with one new matrix, whose corrections learn from each other.

        What cells feel of the rotation of a step is not in the matrix: a few directions, in which
        no matrix helps.
        """
        kept = self._python_forces.learns
        self._python_forces.learn(Secants(_LEARNT, self._node_measure, growth=_SPIRALS))
        self.numbers[corrections.EXCESS] = np.inf
        each, self._each = self._each, True
        made = self._make((self.options.max_iterations + 1, np.inf), still=False)
        self._python_forces.learn(kept)
        self._each = each
        if not made:
            self.s.weights[:] = self.this.weights
        return made

    def _make(self, rule: tuple[int, float], *, still: bool, always: bool = False) -> bool:
        """Make one step; whether it is.

        Args:
            rule: When a matrix is made, see :meth:`~fem_lie.solve.motion.policies.Policy.rule`.
            still: From no motion at all. What is predicted has waves that the step does not resolve
                as large as their velocities say, far beyond what they are at its end.
            always: Whatever else the policy says.
        """
        self.reason = ""
        self._begin()
        if still:
            self.this.step[:] = 0.0
        return self._go(self.index + 1, rule, always=always) != loop.FAILED

    def _begin(self) -> None:
        """Predict the next step, before a matrix for it is made."""
        counters, numbers, packed = self.counters, self.numbers, self._packed
        counters[corrections.ITERATION], counters[corrections.ASKED] = 1, 0
        counters[corrections.STALLS] = counters[corrections.GROWTHS] = 0
        motion = joints.packed_begin(packed.model, packed.state, packed.step)
        numbers[corrections.MOTION] = max(motion, numbers[corrections.MOTION])
        numbers[corrections.PREVIOUS] = numbers[corrections.LEAST] = np.inf
        numbers[corrections.RECENT :] = np.inf
        numbers[corrections.FELT] = 0.0

    def _go(self, last: int, rule: tuple[int, float], *, always: bool = False) -> int:
        """Make steps up to ``last``."""
        limit = self.options.max_iterations * (_SLOW if always else 1)
        go = self._go_each if self._each else self._go_free
        return go(last, rule, limit, always=always)

    def _go_each(
        self, last: int, rule: tuple[int, float], limit: int, *, always: bool = False
    ) -> int:
        """The same where there is something to do in Python before and after each step."""
        python_forces = self._python_forces
        while self.index < last:
            self.reason = ""
            python_forces.begin()
            go = self._go_free if python_forces.contacts is None else self._meet
            code = go(self.index + 1, rule, limit, always=always)
            if code != loop.DONE:
                return code
            self._go_on()
        return loop.DONE

    def _meet(self, last: int, rule: tuple[int, float], limit: int, *, always: bool = False) -> int:
        """Make step ``last``, the next one, of a scene with contacts.

        Contacts that do not act at its predicted end are not evaluated in it. If they do at the end
        that is found, the step is made again with them.
        """
        python_forces, before = self._python_forces, self.saved()
        if self._end_forces.act_always:
            python_forces.touch(True)
        else:
            if self.counters[corrections.ITERATION] == 0:
                self._begin()
            python_forces.look_ahead()
        code = self._go_free(last, rule, limit, always=always)
        if code == loop.DONE and not python_forces.touching and self._end_forces.overlap(self.s.H):
            self.take_back(before)
            self._begin()
            python_forces.touch(True)
            code = self._go_free(last, rule, limit, always=always)
        if code == loop.DONE and not self._keep_apart(before["s.H"], self.s.H):
            self.take_back(before)
            return loop.FAILED
        return code

    def _go_on(self) -> None:
        """What is to be done after a step."""
        s, python_forces, memory = self.s, self._python_forces, self.equations.memory
        memory.accept(s.H)
        if python_forces.joints is not None:
            python_forces.joints.accept(s.H, self.model.driven, s.gap)
        python_forces.accept()
        if len(self._vectors):
            memory.rotate_axes(s.H)

    def _go_free(
        self, last: int, rule: tuple[int, float], limit: int, *, always: bool = False
    ) -> int:
        counters, given = self.counters, self._given(rule, limit)
        while True:
            packed = self._packed
            tables = packed.model, packed.state, packed.step
            if self._factors is None:
                code = loop.MATRIX
                if counters[corrections.ITERATION] == 0:
                    self._begin()
                counters[corrections.ASKED] = counters[corrections.ITERATION]
            else:
                factors = self._factors.plain
                code = loop.run(*tables, factors, given, counters, self.numbers, last)
                self._python_forces.check()
            if code == loop.LOST:
                code = self._restart_step()
                if code == loop.DONE and self.index < last:
                    continue
                return code
            if code == loop.DONE and self.rule is None:
                self.decisions.after_step(int(counters[corrections.LAST]))
            if code != loop.MATRIX:
                return code
            iteration = int(counters[corrections.ITERATION])
            asked = always or self.rule is not None or self._factors is None
            wanted = asked or self.decisions.before_iteration(iteration)
            if wanted and not self._refactorised():
                return loop.FAILED

    def _refactorised(self) -> bool:
        """Make a new matrix; whether it has factors."""
        try:
            self._factorise()
        except SingularMatrixError:
            self.numbers[corrections.INCREMENT] = np.inf
            return False
        return True

    def _restart_step(self) -> int:
        """Make the present step by full Newton, for kept constraints would lead it astray."""
        self.counters[corrections.ASKED], self._lost = 0, True
        rule = 1, 0.0
        if self._each:
            limit = self.options.max_iterations * _SLOW
            code = self._go_free(self.index + 1, rule, limit, always=True)
        else:
            code = self._go(self.index + 1, rule, always=True)
        self._lost = False
        return code

    def _given(self, rule: tuple[int, float], limit: int) -> tuple[float, int, int, float, float]:
        """What the loop is told."""
        spare = _SHARE * rule[1] if self.endures and np.isfinite(rule[1]) else 0.0
        return self.options.tolerance, limit, *rule, spare
