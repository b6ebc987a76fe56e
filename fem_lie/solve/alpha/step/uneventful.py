"""Steps of a run with variable steps in the compiled loop, until something happens.

As :mod:`~.alpha.step.loop`, of which each step is made, with the error of each step and the numbers
by which limits of coordinates are watched, see :mod:`fem_lie.solve.motion.limits`. A step in which
one of these is not negative is taken back, as is one that fails; the caller repeats it by itself.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, linked
from fem_lie._jit.copies import copy_blocks, copy_vector
from fem_lie._jit.packed_arrays import Integers2, Numbers1, Numbers2, Numbers3, unpacking
from fem_lie.joints.equations import terms
from fem_lie.joints.equations.joint_arrays import joint_arrays
from fem_lie.lie.node_types import cubic_term, from_group, inertia, pull_all_back, push_all_forward
from fem_lie.lie.node_types.inertia import PlainInertia
from fem_lie.linear.factors import PlainSolution, solve_by_call
from fem_lie.solve.alpha.step import loop
from fem_lie.solve.alpha.step.loop import BETWEEN, DONE, EVENT, FAILED, SOLUTION, PlainSteps, Steps
from fem_lie.solve.alpha.step.node import PlainScheme
from fem_lie.solve.motion.limits import PlainStops, watch
from fem_lie.solve.motion.step_log import largest
from fem_lie.solve.refactorisation import PlainRule

AWAITED = 6
"""Phase beside those of the loop: a step is made, and the solution for its error is needed."""


class Watched(NamedTuple):
    """Arrays at fixed addresses, in addition to those of the loop.

    Attributes:
        H: Frames at the start of a step; this and what follows is restored if it is taken back.
        H1: Frames at the end of the step before.
        motion: See :class:`~fem_lie.solve.alpha.step.nodes.State`.
        multipliers: Lagrange multipliers.
        balance: Energy balance and impulses.
        turned: Angles of joints at the last accepted state.
        probes: Angles of reported coordinates.
        stops: Stops of limits.
        values: Watched number of each stop at the start of the step, shape (2 l,).
        ends: Those at the end.
        coordinates: Reported coordinates at the end.
        inertia: Mass matrix.
        lengths: Whether halves of the twists of nodes are lengths, shape (n, 2).
        defect: Defects of the step, shape (n, 6).
        q: Workspace, shape (n, 4, 3).
        work: Workspace, shape (n, 4, 3).
        errors: Error of each step of a call: :class:`~fem_lie.solve.motion.step_log.StepError`.
    """

    H: Numbers3
    H1: Numbers3
    motion: Numbers3
    multipliers: Numbers1
    balance: Numbers1
    turned: Numbers1
    probes: Numbers1
    stops: PlainStops
    values: Numbers1
    ends: Numbers1
    coordinates: Numbers1
    inertia: PlainInertia
    lengths: Integers2
    defect: Numbers2
    q: Numbers3
    work: Numbers3
    errors: Numbers2


_watched = unpacking(Watched)


@compiled
def defects(
    h: float, kinds: Indices, H1: Array, before: Array, d: Array, vdot1: Array, out: Array
) -> None:
    """Exact increments minus ``d``, in the nodes' frames at the end of the step; (n, 6).

    Args:
        h: Step size.
        kinds: Types of the nodes.
        H1: Frames at the end of the step.
        before: ``v`` and ``v̇`` of the group at its start, shape (≥ 2, n, 6).
        d: Increments of the step.
        vdot1: ``v̇`` at its end.
        out: The defects, overwritten.
    """
    bent = np.empty(6)
    for i in range(kinds.shape[0]):
        v, vdot = before[0, i], before[1, i]
        for k in range(6):
            jump = vdot1[i, k] - vdot[k]
            out[i, k] = h * v[k] + h * h * (0.5 * vdot[k] + jump / 6.0) - d[i, k]
        cubic_term(kinds[i], v, vdot, bent)
        for k in range(6):
            out[i, k] += h * h * h / 12.0 * bent[k]
        from_group(kinds[i], H1[i], out[i])


@linked
def _keep(table: Indices, watched: Indices) -> None:
    """Copy the state at the start of a step."""
    this, own = loop.packed(table), _watched(watched)
    copy_blocks(this.H, own.H)
    copy_blocks(this.H1, own.H1)
    copy_blocks(this.motion, own.motion)
    copy_vector(this.multipliers, own.multipliers)
    copy_vector(this.balance, own.balance)
    copy_vector(joint_arrays(this.joints[0]).turned, own.turned)
    copy_vector(joint_arrays(this.joints[1]).turned, own.probes)


@compiled
def take_back(table: Indices, watched: Indices) -> None:
    """Restore the state at the start of a step, which was made or failed.

    Args:
        table: Packed arrays, see :class:`~fem_lie.solve.alpha.step.loop.Packed`.
        watched: Packed arrays, see :class:`Watched`.
    """
    this, own = loop.packed(table), _watched(watched)
    copy_blocks(own.H, this.H)
    copy_blocks(own.H1, this.H1)
    copy_blocks(own.motion, this.motion)
    copy_vector(own.multipliers, this.multipliers)
    copy_vector(own.balance, this.balance)
    copy_vector(own.turned, joint_arrays(this.joints[0]).turned)
    copy_vector(own.probes, joint_arrays(this.joints[1]).turned)
    progress = this.progress[0]
    progress.step -= 1
    progress.phase = BETWEEN


@linked
def _happens(table: Indices, watched: Indices) -> bool:
    """Whether a watched number is not negative at the end of the step; otherwise it is kept."""
    this, own = loop.packed(table), _watched(watched)
    if own.values.shape[0] == 0:
        return False
    terms.violations(this.H, joint_arrays(this.joints[1]), own.coordinates)
    watch(own.coordinates, own.stops, this.multipliers, own.ends)
    for k in range(own.ends.shape[0]):
        if not (own.values[k] < 0.0 and own.ends[k] < 0.0):
            return True
    copy_vector(own.ends, own.values)
    return False


@linked
def _weigh_error(table: Indices, watched: Indices, h: float, mass: float) -> None:
    """Right-hand side of the error, see :class:`~fem_lie.solve.alpha.variable.TimeError`."""
    this, own = loop.packed(table), _watched(watched)
    indptr, indices, blocks = own.inertia
    defects(h, this.kinds, this.H, own.motion, this.motion[3], this.motion[1], own.defect)
    push_all_forward(this.kinds, this.H, own.defect, own.q)
    inertia.multiply(indptr, indices, blocks, own.q, own.work)
    for k in range(this.r.shape[0]):
        this.r[k] = 0.0
    pull_all_back(this.kinds, this.H, own.work, mass, this.r)
    for row in this.held:
        this.r[row] = 0.0


@linked
def _take_error(table: Indices, watched: Indices, factor: float, row: int) -> None:
    """Store the error of a step, whose solution was multiplied by a factor."""
    this, own = loop.packed(table), _watched(watched)
    for i in range(own.defect.shape[0]):
        for k in range(6):
            own.defect[i, k] = this.dx[6 * i + k] / factor
    translation, rotation, first, second = largest(own.defect, own.lengths)
    error = own.errors[row]
    error[0], error[1], error[2], error[3] = translation, rotation, first, second


@linked
def run(
    table: Indices,
    watched: Indices,
    scheme: PlainScheme,
    solution: PlainSolution,
    mass: float,
    steps: PlainSteps,
    rule: PlainRule,
    results: tuple[Indices, Indices],
    wanted: Indices,
    first: int,
    last: int,
) -> int:
    """Advance to the end of step ``last``, or to the start of one in which something happens.

    Args:
        table: Packed arrays, see :class:`~fem_lie.solve.alpha.step.loop.Packed`.
        watched: Packed arrays, see :class:`Watched`.
        scheme: Parameters.
        solution: Frozen factors.
        mass: Factor of the mass matrix in the matrix that was factorised.
        steps: Options of the loop.
        rule: Rule of the policy.
        results: Packed arrays of results, see :func:`~fem_lie.solve.alpha.step.loop.run`.
        wanted: Steps to be recorded: none, as rows have times that the loop does not know.
        first: Number of steps before the first one of all calls.
        last: Last step.

    Returns:
        Why the loop returned.
    """
    this = loop.packed(table)
    progress = this.progress[0]
    while True:
        if progress.phase == AWAITED:
            _take_error(table, watched, Steps(*steps).factor, progress.step - first - 1)
            progress.phase = BETWEEN
        current = progress.step
        if progress.phase == BETWEEN:
            if current >= last:
                return DONE
            _keep(table, watched)
            current += 1
        code = loop.run(table, scheme, solution, steps, rule, results, wanted, current)
        if code not in (DONE, FAILED):
            return code
        if code == DONE and _happens(table, watched):
            progress.total -= progress.iteration
            code = FAILED
        if code == FAILED:
            take_back(table, watched)
            return EVENT
        _weigh_error(table, watched, scheme[0], mass)
        if not solve_by_call(solution, this.r, this.dx):
            progress.phase = AWAITED
            return SOLUTION
        _take_error(table, watched, 1.0, current - first - 1)
