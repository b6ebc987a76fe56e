"""Steps of generalised-α in one compiled loop, and its records.

The loop returns to Python for a new matrix, for forces that are not in one compiled sum, for
solutions that need more than the frozen factors, for questions of the policy, for steps that fail,
and after the last requested step. The next call continues where it returned.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple, TypeAlias

import numpy as np

from fem_lie._arrays import Indices
from fem_lie._jit import inlined, linked
from fem_lie._jit.copies import copy_vector
from fem_lie._jit.packed_arrays import (
    Integers1,
    Integers2,
    Numbers1,
    Numbers2,
    Numbers3,
    one,
    unpacking,
)
from fem_lie._jit.records import Records, record_type
from fem_lie.joints.equations.joint_arrays import PackedJoints, joint_arrays
from fem_lie.joints.equations.terms import unwrap_both
from fem_lie.lie.polar import PlainSurroundings, convect_axes
from fem_lie.linear.factors import PlainSolution, solve_by_call
from fem_lie.solve.alpha.step.node import PlainScheme
from fem_lie.solve.alpha.step.nodes import TWISTS, PlainState, accept, correct, predict, refer_to
from fem_lie.solve.convergence import CONVERGED, GOES_ON, ROUND_OFF, UNMEASURED, estimate, judged
from fem_lie.solve.recording.result_row import fill_whole
from fem_lie.solve.refactorisation import KNOWN, PlainRule, due, learn
from fem_lie.system.nodes.sums import residual
from fem_lie.system.outer_forces import look_and_sum_up

BETWEEN, OPEN, WEIGHED, SOLVED, CHECKED, LEARNED = range(6)
"""Phases: between steps; the residual is needed; it is known; the correction is known; the step has
converged; the policy has recorded its iterations."""

PROGRESS = record_type(
    step=int,
    iteration=int,
    phase=int,
    update=int,
    total=int,
    row=int,
    wanted=int,
    near=int,
    ratio=float,
    now=float,
    previous=float,
    increment=float,
    motion=float,
)
"""Progress of a run: current or last step, its iteration, the phase; what is to be refactorised,
see :class:`~fem_lie.solve.refactorisation.Refactorisation`; all iterations; the next row of
results, how many requested rows are filled in, and whether an element is near its rotation limit in
the last one (1); ratio of increments at the start of steps and in the current one, the previous
increment and the current one, and the largest motion in a step."""


class Packed(NamedTuple):
    """Arrays of a run at fixed addresses.

    Attributes:
        H: Frames at the start of a step, see :class:`~fem_lie.solve.alpha.step.nodes.State`.
        H1: Frames at its end.
        motion: See :class:`~fem_lie.solve.alpha.step.nodes.State`.
        kinds: Types of the nodes.
        scaling: Norm weights of the nodes.
        inverse: See :class:`~fem_lie.solve.alpha.step.nodes.State`.
        elastic: Nodes of elements.
        fixed: Which increments are held, shape (n, 6).
        multipliers: Lagrange multipliers, shape (m,).
        first: Lagrange multipliers at the start of the step.
        scale: Scale of the constraints.
        spread: Norm weights of scaled multipliers in the size of a correction, see
            :class:`~fem_lie.system.equations.Plan`, (m, w).
        joined: Which constraints belong to the same vector as the previous one.
        held: Equations of fixed unknowns.
        r: Residual, shape (6 n + m,).
        dx: Correction.
        forces: Packed arrays of :func:`~fem_lie.system.nodes.sums.residual`.
        balance_table: Packed arrays of :func:`~fem_lie.system.outer_forces.look_and_sum_up`.
        balance: Energy balance and impulses, shape (15,).
        targets: Targets of the constraints, shape (m,).
        joints: Packed numbers and integers of joints and of reported coordinates.
        cells: Packed arrays of cells with energy, two arrays.
        around: Surroundings of nodes with convected axes.
        progress: See :data:`PROGRESS`.
        known: Iteration counts recorded by the policy.
    """

    H: Numbers3
    H1: Numbers3
    motion: Numbers3
    kinds: Integers1
    scaling: Numbers2
    inverse: Numbers3
    elastic: Integers1
    fixed: Integers2
    multipliers: Numbers1
    first: Numbers1
    scale: Numbers1
    spread: Numbers2
    joined: Integers1
    held: Integers1
    r: Numbers1
    dx: Numbers1
    forces: Integers2
    balance_table: Integers2
    balance: Numbers1
    targets: Numbers1
    joints: tuple[PackedJoints, PackedJoints]
    cells: tuple[Integers2, Integers1]
    around: PlainSurroundings
    progress: Annotated[Records, one(PROGRESS)]
    known: Annotated[Records, one(KNOWN)]


packed = unpacking(Packed)


class Steps(NamedTuple):
    """Options of the loop.

    Attributes:
        tolerance: Allowed iteration error, as a fraction of the largest motion in a step.
        finest: Largest iteration error, whatever the motion.
        limit: Largest number of iterations.
        factor: Factor of all corrections.
        summed: Whether residuals are one compiled sum.
        missing: Whether there is no matrix yet.
        checked: Whether constraints may be contradictory.
        ended: Whether the loop ends steps itself: revolutions, energy balance, rows.
        turns: Whether joints count revolutions.
        accounts: Whether the energy balance is updated.
        loads: Whether loads contribute to the balance.
        joints: Whether joints contribute to it.
        began: Time at step 0.
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
    accounts: bool
    loads: bool
    joints: bool
    began: float

    @property
    def plain(self) -> PlainSteps:
        """The options as a plain tuple, with which compiled functions are called faster."""
        return (*self,)


PlainSteps: TypeAlias = tuple[
    float, float, int, float, bool, bool, bool, bool, bool, bool, bool, bool, float
]
"""Plain tuple of :class:`Steps`."""

DONE, RESIDUAL, MATRIX, SOLUTION, CHECK, QUESTION, FAILED, EVENT = range(8)
"""Why the loop returns: the last step is made; a residual is needed; the matrix is to be
refactorised and a correction computed; a correction is needed; a step has converged with
constraints that may be contradictory; the policy asks for the staleness of the matrix; the step has
failed; something happens in the next step, see :mod:`~.alpha.step.uneventful`."""


@linked
def _begin(table: Indices, scheme: PlainScheme, state: PlainState) -> None:
    """Predict the next step."""
    this = packed(table)
    progress = this.progress[0]
    progress.step += 1
    progress.iteration = 1
    copy_vector(this.multipliers, this.first)
    progress.motion = max(predict(scheme, state), progress.motion)
    progress.previous, progress.now = np.inf, progress.ratio


@linked
def _weigh(table: Indices) -> None:
    """Evaluate the residual at the current end of the step."""
    this = packed(table)
    v, a = this.motion[6], this.motion[7]
    residual(this.H1, v, a, this.multipliers, this.scale, this.r, this.forces)
    for row in this.held:
        this.r[row] = 0.0


@linked
def _solve(table: Indices, solution: PlainSolution, steps: PlainSteps, rule: PlainRule) -> int:
    """Correction for the residual, or the code of a request."""
    this, how = packed(table), Steps(*steps)
    progress = this.progress[0]
    update = due(rule, this.known[0], progress.iteration)
    if update != 0 or how.missing:
        progress.update = update
        return MATRIX
    if not solve_by_call(solution, this.r, this.dx):
        return SOLUTION
    if how.factor != 1.0:
        for k in range(this.dx.shape[0]):
            this.dx[k] *= how.factor
    return DONE


@linked
def _correct(table: Indices, scheme: PlainScheme, state: PlainState, steps: PlainSteps) -> int:
    """Apply the correction; returns the next phase, or that before the first one on failure."""
    this, how = packed(table), Steps(*steps)
    progress = this.progress[0]
    scale, spread = this.scale, this.spread
    refer_to(this.motion[3], this.kinds, this.fixed, this.elastic, this.inverse)
    increment = correct(scheme, state, this.dx, scale, spread, this.joined, this.multipliers)
    ratio, remaining = estimate(increment, progress.previous, progress.now)
    progress.increment, progress.now = increment, ratio
    bound = allowed(progress.motion, how.tolerance, how.finest)
    verdict = judged(increment, progress.previous, remaining, bound, 0.0)
    if verdict == CONVERGED:
        return CHECKED
    if verdict != GOES_ON or progress.iteration == how.limit:
        return BETWEEN
    progress.previous = increment
    progress.iteration += 1
    return OPEN


@inlined
def allowed(motion: float, tolerance: float, finest: float) -> float:
    """Allowed iteration error of a step for a largest motion; see :class:`Steps`."""
    return max(min(tolerance * motion, finest), ROUND_OFF)


@inlined
def starting_ratio(ratio: float, iteration: int) -> float:
    """Ratio of increments with which the next steps start, from the iterations of a step."""
    return ratio if iteration > 1 else ratio**UNMEASURED


@linked
def _end(table: Indices, h: float, steps: PlainSteps) -> None:
    """Rotate convected axes, count revolutions and update the energy balance."""
    this, how = packed(table), Steps(*steps)
    convect_axes(this.H, this.around, this.motion, TWISTS)
    if how.turns:
        joints, probes = this.joints
        unwrap_both(this.H, joints, probes)
    if how.accounts:
        end = this.H, this.motion[6], this.multipliers, this.targets
        look_and_sum_up(h, end, how.loads, how.joints, this.balance_table)


@linked
def _record(table: Indices, h: float, results: tuple[Indices, Indices]) -> bool:
    """Fill in the next row of results; returns whether an element is near its rotation limit."""
    this = packed(table)
    progress = this.progress[0]
    scene, rows = results
    near = fill_whole(
        this.H,
        this.motion[6],
        this.multipliers,
        this.balance,
        scene,
        rows,
        this.cells,
        progress.row,
        progress.total,
        progress.step * h,
    )
    progress.near = int(near)
    progress.row += 1
    progress.wanted += 1
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
    """Advance to the end of step ``last``; returns why the loop returned.

    Args:
        table: Packed arrays, see :class:`Packed`.
        scheme: Parameters.
        solution: Frozen factors.
        steps: Options of the loop.
        rule: Rule of the policy.
        results: Packed arrays of :func:`~fem_lie.solve.recording.result_row.fill_whole`: constant
            arrays of the scene, and arrays of all rows.
        wanted: Increasing numbers of the steps to be recorded, for which space is reserved.
        last: Last step.
    """
    this, h = packed(table), scheme[0]
    progress = this.progress[0]
    state = this.H, this.H1, this.motion, this.kinds, this.scaling, this.inverse
    ended = Steps(*steps).ended
    while True:
        if progress.phase == BETWEEN:
            if progress.step >= last:
                return DONE
            _begin(table, scheme, state)
            if ended:
                joint_arrays(this.joints[0]).clock[0] = Steps(*steps).began + progress.step * h
            progress.phase = OPEN
        if progress.phase == OPEN:
            progress.phase = WEIGHED
            if not Steps(*steps).summed:
                return RESIDUAL
            _weigh(table)
        if progress.phase == WEIGHED:
            code = _solve(table, solution, steps, rule)
            progress.phase = SOLVED
            if code != DONE:
                return code
        if progress.phase == SOLVED:
            progress.phase = _correct(table, scheme, state, steps)
            if progress.phase == BETWEEN:
                return FAILED
            if progress.phase == OPEN:
                continue
            if Steps(*steps).checked:
                return CHECK
        if progress.phase == CHECKED:
            progress.ratio = starting_ratio(progress.now, progress.iteration)
            progress.phase = LEARNED
            if learn(rule, this.known[0], progress.iteration):
                return QUESTION
        accept(scheme, state)
        progress.total += progress.iteration
        progress.phase = BETWEEN
        if ended:
            _end(table, h, steps)
            at = progress.wanted
            if at < wanted.shape[0] and wanted[at] == progress.step and _record(table, h, results):
                return DONE
