"""Steps of generalised-α in one compiled loop, and the records that it takes and changes.

That is a new matrix, forces that are no single sum, a solution that takes more than kept factors, a
question of the policy, a step that fails, and whatever is to be done after a step that was given.
It is called again then, and goes on where it was.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined, linked
from fem_lie._jit.copies import copy_vector
from fem_lie.forms.fixed_arrays import integers1, integers2, numbers1, numbers2, numbers3
from fem_lie.joints.equations.table import PackedJoints
from fem_lie.joints.equations.terms import unwrap_both
from fem_lie.lie.polar import PlainSurroundings, convect_axes
from fem_lie.linear.factors import PlainSolution, solve_by_call
from fem_lie.solve.alpha.step.node import PlainScheme
from fem_lie.solve.alpha.step.nodes import TWISTS, PlainState, accept, correct, predict
from fem_lie.solve.convergence import CONVERGED, GOES_ON, ROUND_OFF, UNMEASURED, estimate, judged
from fem_lie.solve.recording.result_row import fill_whole
from fem_lie.solve.renewal import PlainRule, due, learn
from fem_lie.system.nodes.sums import residual
from fem_lie.system.outer_forces import look_and_sum_up

BETWEEN, OPEN, WEIGHED, SOLVED, CHECKED, LEARNED = range(6)
"""Phases: between steps; a residual is wanted; it is known; the correction is; the step has
converged; what it cost has been learned."""

STEP, ITERATION, PHASE, UPDATE, TOTAL, ROW, WANTED, NEAR, COUNTERS = range(9)
"""Counters: the step that is made or was made last, its iteration, the phase; what is made anew,
see :class:`~fem_lie.solve.renewal.Update`; all iterations; the next row of results, how many of
the wanted ones were filled in, and whether an element turns nearly too far in the last (1)."""

RATIO, NOW, PREVIOUS, INCREMENT, MOTION, NUMBERS = range(6)
"""Numbers: ratio of increments that steps begin with and that of the present one, the increment
before and the present one, and the largest motion in a step."""


class Packed(NamedTuple):
    """What a run has in arrays that stay where they are, in the order of their table.

    Attributes:
        H: Start of a step, see :class:`~fem_lie.solve.alpha.step.nodes.State`.
        H1: Likewise.
        motion: Likewise.
        kinds: Likewise.
        scaling: Likewise.
        weights: Multipliers, shape (m,).
        first: Those at the start of the step.
        scale: Of the constraints.
        spread: Of scaled multipliers in the size of a correction, see
            :class:`~fem_lie.system.equations.Plan`, (m, w).
        joined: Which constraints are one vector with the one before.
        held: Which of the equations are those of held unknowns.
        r: Residual, shape (6 n + m,).
        dx: Correction.
        forces: Table of :func:`~fem_lie.system.nodes.sums.residual`.
        books: Table of :func:`~fem_lie.system.outer_forces.look_and_sum_up`.
        booked: Balance and impulses, shape (15,).
        targets: Of the constraints, shape (m,).
        joints: Numbers and integers of their table, and those of probes.
        cells: Those that have energy, two arrays.
        around: Places whose axes turn.
        counters: See :data:`STEP`.
        numbers: See :data:`RATIO`.
        known: What the policy has learned.
    """

    H: Array
    H1: Array
    motion: Array
    kinds: Indices
    scaling: Array
    weights: Array
    first: Array
    scale: Array
    spread: Array
    joined: Indices
    held: Indices
    r: Array
    dx: Array
    forces: Indices
    books: Indices
    booked: Array
    targets: Array
    joints: tuple[PackedJoints, PackedJoints]
    cells: tuple[Indices, Indices]
    around: PlainSurroundings
    counters: Indices
    numbers: Array
    known: Array

    @property
    def arrays(self) -> list[Array | Indices]:
        """One after the other."""
        found: list[Array | Indices] = []
        for part in self:
            for inner in part if isinstance(part, tuple) else (part,):
                found.extend(inner if isinstance(inner, tuple) else (inner,))
        return found


@inlined
def packed(table: Indices) -> Packed:
    """From the table of its arrays."""
    return Packed(
        numbers3(table, 0),
        numbers3(table, 1),
        numbers3(table, 2),
        integers1(table, 3),
        numbers2(table, 4),
        numbers1(table, 5),
        numbers1(table, 6),
        numbers1(table, 7),
        numbers2(table, 8),
        integers1(table, 9),
        integers1(table, 10),
        numbers1(table, 11),
        numbers1(table, 12),
        integers2(table, 13),
        integers2(table, 14),
        numbers1(table, 15),
        numbers1(table, 16),
        (
            (numbers1(table, 17), integers1(table, 18)),
            (numbers1(table, 19), integers1(table, 20)),
        ),
        (integers2(table, 21), integers1(table, 22)),
        (
            integers1(table, 23),
            integers1(table, 24),
            integers1(table, 25),
            numbers2(table, 26),
            numbers3(table, 27),
        ),
        integers1(table, 28),
        numbers1(table, 29),
        numbers1(table, 30),
    )


class Steps(NamedTuple):
    """How steps are made.

    Attributes:
        tolerance: Of the error that the iteration leaves, in the largest motion of a step.
        finest: What it may leave at most, whatever the motion.
        limit: Most iterations.
        factor: Of all solutions.
        summed: Whether residuals are one compiled sum.
        missing: Whether there is no matrix yet.
        checked: Whether constraints may contradict each other.
        ended: Whether steps are ended here: turns counted, all booked, rows filled in.
        turns: Whether joints count turns.
        booked: Whether there is anything to book.
        loads: Whether loads are looked at for it.
        joints: Whether joints are.
    """

    tolerance: float
    finest: float
    limit: int
    factor: float
    summed: bool
    missing: bool
    checked: bool
    ended: bool
    turns: bool
    booked: bool
    loads: bool
    joints: bool

    @property
    def plain(self) -> PlainSteps:
        """As compiled functions are quicker to call with."""
        return (*self,)


PlainSteps: TypeAlias = tuple[
    float, float, int, float, bool, bool, bool, bool, bool, bool, bool, bool
]
"""A :class:`Steps` at the door from Python."""

DONE, RESIDUAL, MATRIX, SOLUTION, CHECK, QUESTION, FAILED = range(7)
"""Why the loop has come back: the last step is made; a residual is wanted; a matrix is to be made
anew and solved with; the equations are to be solved; a step has converged with constraints that may
contradict each other; the policy asks how stale the matrix is; the step has failed."""


@linked
def _begin(table: Indices, scheme: PlainScheme, state: PlainState) -> None:
    """Predict the next step."""
    this = packed(table)
    counters, numbers = this.counters, this.numbers
    counters[STEP] += 1
    counters[ITERATION] = 1
    copy_vector(this.weights, this.first)
    numbers[MOTION] = max(predict(scheme, state), numbers[MOTION])
    numbers[PREVIOUS], numbers[NOW] = np.inf, numbers[RATIO]


@linked
def _weigh(table: Indices) -> None:
    """The residual at the end of the step as it is."""
    this = packed(table)
    v, a = this.motion[6], this.motion[7]
    residual(this.H1, v, a, this.weights, this.scale, this.r, this.forces)
    for row in this.held:
        this.r[row] = 0.0


@linked
def _solve(table: Indices, solution: PlainSolution, steps: PlainSteps, rule: PlainRule) -> int:
    """Correction for the residual, or the code for what is wanted instead."""
    this, how = packed(table), Steps(*steps)
    counters = this.counters
    update = due(rule, this.known, counters[ITERATION])
    if update != 0 or how.missing:
        counters[UPDATE] = update
        return MATRIX
    if not solve_by_call(solution, this.r, this.dx):
        return SOLUTION
    if how.factor != 1.0:
        for k in range(this.dx.shape[0]):
            this.dx[k] *= how.factor
    return DONE


@linked
def _correct(table: Indices, scheme: PlainScheme, state: PlainState, steps: PlainSteps) -> int:
    """Apply the correction; the phase that follows, or that before the first if it fails."""
    this, how = packed(table), Steps(*steps)
    counters, numbers = this.counters, this.numbers
    scale, spread = this.scale, this.spread
    increment = correct(scheme, state, this.dx, scale, spread, this.joined, this.weights)
    ratio, remaining = estimate(increment, numbers[PREVIOUS], numbers[NOW])
    numbers[INCREMENT], numbers[NOW] = increment, ratio
    bound = allowed(numbers[MOTION], how.tolerance, how.finest)
    verdict = judged(increment, numbers[PREVIOUS], remaining, bound, 0.0)
    if verdict == CONVERGED:
        return CHECKED
    if verdict != GOES_ON or counters[ITERATION] == how.limit:
        return BETWEEN
    numbers[PREVIOUS] = increment
    counters[ITERATION] += 1
    return OPEN


@inlined
def allowed(motion: float, tolerance: float, finest: float) -> float:
    """Error that the iteration of a step may leave, of a largest motion; see :class:`Steps`."""
    return max(min(tolerance * motion, finest), ROUND_OFF)


@inlined
def settled_ratio(ratio: float, iteration: int) -> float:
    """What the next steps begin with after a step of so many iterations."""
    return ratio if iteration > 1 else ratio**UNMEASURED


@linked
def _end(table: Indices, h: float, steps: PlainSteps) -> None:
    """Turn axes, count turns and book the step that was accepted."""
    this, how = packed(table), Steps(*steps)
    convect_axes(this.H, this.around, this.motion, TWISTS)
    if how.turns:
        joints, probes = this.joints
        unwrap_both(this.H, joints, probes)
    if how.booked:
        end = this.H, this.motion[6], this.weights, this.targets
        look_and_sum_up(h, end, how.loads, how.joints, this.books)


@linked
def _record(table: Indices, h: float, results: tuple[Indices, Indices]) -> bool:
    """Fill in the next row of results; returns whether an element turns nearly too far."""
    this = packed(table)
    counters = this.counters
    scene, rows = results
    near = fill_whole(
        this.H,
        this.motion[6],
        this.weights,
        this.booked,
        scene,
        rows,
        this.cells,
        counters[ROW],
        counters[TOTAL],
        counters[STEP] * h,
    )
    counters[NEAR] = int(near)
    counters[ROW] += 1
    counters[WANTED] += 1
    return near


@linked
def run(
    table: Indices,
    scheme: PlainScheme,
    solution: PlainSolution,
    steps: PlainSteps,
    rule: PlainRule,
    results: tuple[Indices, Indices],
    wanted: Indices,
    last: int,
) -> int:
    """Go on to the end of step ``last``; returns why it came back.

    Args:
        table: Of fixed arrays, see :class:`Packed`.
        scheme: Parameters.
        solution: With the factors that are kept.
        steps: How steps are made.
        rule: Of the policy.
        results: Tables of :func:`~fem_lie.solve.recording.result_row.fill_whole`: what of the scene
            is in a row, and the arrays of all rows.
        wanted: Steps whose rows are filled in, increasing, for which there is room.
        last: Step to reach.
    """
    this, h = packed(table), scheme[0]
    counters, numbers = this.counters, this.numbers
    state = this.H, this.H1, this.motion, this.kinds, this.scaling
    ended = Steps(*steps).ended
    while True:
        if counters[PHASE] == BETWEEN:
            if counters[STEP] >= last:
                return DONE
            _begin(table, scheme, state)
            counters[PHASE] = OPEN
        if counters[PHASE] == OPEN:
            counters[PHASE] = WEIGHED
            if not Steps(*steps).summed:
                return RESIDUAL
            _weigh(table)
        if counters[PHASE] == WEIGHED:
            code = _solve(table, solution, steps, rule)
            counters[PHASE] = SOLVED
            if code != DONE:
                return code
        if counters[PHASE] == SOLVED:
            counters[PHASE] = _correct(table, scheme, state, steps)
            if counters[PHASE] == BETWEEN:
                return FAILED
            if counters[PHASE] == OPEN:
                continue
            if Steps(*steps).checked:
                return CHECK
        if counters[PHASE] == CHECKED:
            numbers[RATIO] = settled_ratio(numbers[NOW], counters[ITERATION])
            counters[PHASE] = LEARNED
            if learn(rule, this.known, counters[ITERATION]):
                return QUESTION
        accept(scheme, state)
        counters[TOTAL] += counters[ITERATION]
        counters[PHASE] = BETWEEN
        if ended:
            _end(table, h, steps)
            at = counters[WANTED]
            if at < wanted.shape[0] and wanted[at] == counters[STEP] and _record(table, h, results):
                return DONE
