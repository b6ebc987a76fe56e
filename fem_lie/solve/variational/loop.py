"""Steps of the variational scheme in one compiled loop, and its packed arrays."""

from __future__ import annotations

from typing import Annotated, NamedTuple, TypeAlias

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, linked
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
from fem_lie.joints.equations.joint_arrays import PackedJoints
from fem_lie.joints.equations.terms import unwrap_both
from fem_lie.lie.node_types import inertia
from fem_lie.linear.factors import PlainFactors, solve
from fem_lie.solve.conserving.midpoint.cayley import advance
from fem_lie.solve.conserving.midpoint.products import accelerations, add_inertia
from fem_lie.solve.convergence import DIVERGES, GOES_ON, STAGNANT, estimate, judged
from fem_lie.solve.refactorisation import KNOWN, PlainRule, due, learn
from fem_lie.solve.variational import kinematics, momenta
from fem_lie.solve.variational.limit import vibrations_grow
from fem_lie.system.nodes.sums import residual
from fem_lie.system.outer_forces import look_and_sum_up

PROGRESS = record_type(
    made=int,
    iteration=int,
    total=int,
    motion=float,
    previous=float,
    ratio=float,
    increment=float,
)
"""Progress of a run: steps made, the current iteration (0 before the first), all iterations;
largest motion of the step, previous increment, ratio of increments, current increment."""


class Packed(NamedTuple):
    """Arrays of a run.

    Attributes:
        H: Nodal coordinates of all nodes, (N, 4, 3).
        rest: Further digits of ``H`` beyond double precision, (n, 4, 3).
        rates: Rates in the last step and the one before, see :func:`~.kinematics.set_rates`, (2, n,
            6).
        step: Increments of the current step, (n, 6).
        before: Momenta at the start, (n, 6).
        after: Momenta at the end, (n, 6).
        multipliers: Current Lagrange multipliers, (m,).
        earlier: Lagrange multipliers of the last step, (m,).
        gap: Constraint violations, (m,).
        delta: Increments of all nodes, see :func:`~.kinematics.between`, (N, 4, 3).
        mean: Mean coordinates, (N, 4, 3).
        end: Coordinates at the end, (N, 4, 3).
        middle: Nodes at the midpoint, (N, 4, 3).
        twists: Velocities at the midpoint, (N, 6).
        still: Zeros, (N, 6).
        none: Zeros, (m,).
        driven: Zeros, (m,).
        change: Increments of the constraints, (m,).
        forces: Forces on nodes, (n, 6).
        constraints: Constraint forces on nodes, (n, 6).
        r: Residual, (6 n + m,).
        x: Solution, (6 n + m,).
        y: Workspace, (6 n + m,).
        work: Workspace, (6 n + m,).
        scale: Scale of the constraints, (m,).
        measure: Norm weights of all unknowns.
        held: Which unknowns of the nodes are fixed, (n, 6).
        mass: Inertia.
        joints: Packed arrays of the joints.
        known: Iteration counts recorded by the rule.
        progress: See :data:`PROGRESS`.
        table: Packed arrays of :func:`~fem_lie.system.nodes.sums.residual`.
        balance_table: Packed arrays of :func:`~fem_lie.system.outer_forces.look_and_sum_up`.
        local: Twists for the energy balance, (n, 6).
        change_of_twists: Their rates, (n, 6).
        ahead: Multipliers for the energy balance, (m,).
        targets: Targets of the constraints, (m,).
        kinds: Types of the nodes, (n,).
        within: Reduced-order bodies, see :class:`~.momenta.Within`.
        probes: Packed arrays of the reported joint coordinates.
        q: Second rates of nodal coordinates and products, (n + p, 4, 3).
        pairs: Pairs of nodes that vibrate, see :class:`~.limit.Pairs`, (p, 2).
        squares: Squares of their frequencies, (p,).
    """

    H: Numbers3
    rest: Numbers3
    rates: Numbers3
    step: Numbers2
    before: Numbers2
    after: Numbers2
    multipliers: Numbers1
    earlier: Numbers1
    gap: Numbers1
    delta: Numbers3
    mean: Numbers3
    end: Numbers3
    middle: Numbers3
    twists: Numbers2
    still: Numbers2
    none: Numbers1
    driven: Numbers1
    change: Numbers1
    forces: Numbers2
    constraints: Numbers2
    r: Numbers1
    x: Numbers1
    y: Numbers1
    work: Numbers1
    scale: Numbers1
    measure: Numbers1
    held: Integers2
    mass: inertia.PlainInertia
    joints: PackedJoints
    known: Annotated[Records, one(KNOWN)]
    progress: Annotated[Records, one(PROGRESS)]
    table: Integers2
    balance_table: Integers2
    local: Numbers2
    change_of_twists: Numbers2
    ahead: Numbers1
    targets: Numbers1
    kinds: Integers1
    within: momenta.PlainWithin
    probes: PackedJoints
    q: Numbers3
    pairs: Integers2
    squares: Numbers1


packed = unpacking(Packed)


DONE, MATRIX, FAILED, GROWS = range(4)
"""Why the loop returns: all steps are made, a refactorisation is due, a step does not converge, or
vibrations grow in it."""

ROUND_OFF_LEVEL = 1e3 * float(np.finfo(np.float64).eps)
"""Increments below this level, over the length of the model, that do not decrease are round-off."""


@compiled
def _largest(x: Array, measure: Array) -> float:
    size = 0.0
    for k in range(x.shape[0]):
        here = abs(x[k] * measure[k])
        if here > size or here != here:  # nan stays
            size = here
    return size


class Steps(NamedTuple):
    """How steps are made.

    Attributes:
        h: Step size.
        tolerance: Tolerance of the iteration.
        most: Largest number of iterations of a step.
        viscous: Whether forces depend on velocities.
        limited: Whether steps fail in which vibrations grow.
        accepts: Whether the loop makes the end of a step the start of the next; otherwise it
            returns at the end.
        turns: Whether joints count their turns.
        accounts: Whether the energy balance is updated.
        loads: Whether it is by the work of loads.
        joints: Whether it is by the work of joints.
    """

    h: float
    tolerance: float
    most: int
    viscous: bool
    limited: bool
    accepts: bool
    turns: bool
    accounts: bool
    loads: bool
    joints: bool


PlainSteps: TypeAlias = tuple[float, float, int, bool, bool, bool, bool, bool, bool, bool]
"""Plain tuple of :class:`Steps`, with which compiled functions are called faster."""


@linked
def weigh(table: Indices, h: float, viscous: bool) -> None:
    """Residual of the momenta at the start and of the constraints at the end."""
    this = packed(table)
    n, H, step, held = this.step.shape[0], this.H, this.step, this.held
    coordinates = this.delta, this.mean, this.end, this.middle
    kinematics.between(this.kinds, H, step, coordinates, h, this.twists)
    v = this.twists if viscous else this.still
    residual(this.middle, v, this.still, this.none, this.scale, this.work, this.table)
    for i in range(n):
        for k in range(6):
            this.forces[i, k] = 0.0 if held[i, k] else this.work[6 * i + k]
    if viscous:
        bodies = this.within[0]
        accelerations(this.kinds, bodies, this.middle, v[:n], this.q)
        add_inertia(this.kinds, this.mass, bodies, this.middle, this.q, -1.0, this.forces)
    found = this.change, this.constraints
    momenta.constrain(H, coordinates, this.joints, this.multipliers, this.driven, found)
    acting = this.before, this.forces, this.constraints
    out = this.r[: 6 * n].reshape(n, 6), this.after
    momenta.balance(this.kinds, H, step, coordinates, this.mass, h, acting, held, this.within, out)
    for c in range(this.gap.shape[0]):
        this.r[6 * n + c] = this.scale[c] * (this.gap[c] + this.change[c])


@linked
def _begin(table: Indices, h: float) -> None:
    """Predict the step by extrapolating the last change of rates."""
    this = packed(table)
    progress, n = this.progress[0], this.step.shape[0]
    kinematics.predict(this.kinds, this.H, this.held, this.rates, h, this.step)
    this.multipliers[:] = this.earlier
    progress.motion = _largest(this.step.reshape(6 * n), this.measure)
    progress.previous, progress.ratio = np.inf, 1.0


@linked
def _correct(table: Indices) -> None:
    this = packed(table)
    n = this.step.shape[0]
    kinematics.correct(this.kinds, this.H, this.middle, this.held, this.x, this.step)
    for c in range(this.scale.shape[0]):
        # the residual has 4 times the forces of constraints
        this.multipliers[c] -= 0.25 * this.scale[c] * this.x[6 * n + c]


@linked
def _improve(table: Indices, factors: PlainFactors, steps: PlainSteps) -> int:
    """One iteration with a known residual; returns whether the step is made, continues or fails."""
    this, how = packed(table), Steps(*steps)
    progress = this.progress[0]
    solve(factors, this.r, this.y, this.x)
    increment, previous = _largest(this.x, this.measure), progress.previous
    ratio, remaining = estimate(increment, previous, progress.ratio)
    progress.ratio, progress.increment = ratio, increment
    progress.motion = max(progress.motion, increment)
    bound = how.tolerance * progress.motion
    verdict = judged(increment, previous, remaining, bound, ROUND_OFF_LEVEL)
    if verdict == DIVERGES:
        return FAILED
    if verdict != STAGNANT:
        _correct(table)
    progress.previous = increment
    if verdict == GOES_ON:
        return MATRIX
    if verdict != STAGNANT:
        weigh(table, how.h, how.viscous)
    return DONE


@linked
def _add_to_balance(table: Indices, h: float, loads: bool, joints: bool) -> None:
    """Update the energy balance by the trapezoidal rule.

    Velocities are those of a line through the last two steps.
    """
    this = packed(table)
    ends = this.local, this.change_of_twists
    kinematics.at_end(this.kinds, this.H, this.held, this.rates, h, ends)
    look_and_sum_up(
        h, (this.H, this.local, this.ahead, this.targets), loads, joints, this.balance_table
    )


@linked
def _accept(table: Indices, steps: PlainSteps) -> None:
    """Make the end of the step the start of the next."""
    this, how = packed(table), Steps(*steps)
    for c in range(this.gap.shape[0]):
        this.ahead[c] = 2.0 * this.multipliers[c] - this.earlier[c]
    advance(this.H, this.rest, this.delta[: this.step.shape[0]])
    momenta.keep_axes(this.kinds, this.end, this.H)
    this.gap[:] += this.change
    kinematics.keep_rates(this.kinds, this.step, this.twists, how.h, this.rates)
    this.before[:], this.earlier[:] = this.after, this.multipliers
    this.progress[0].made += 1
    if how.turns:
        unwrap_both(this.H, this.joints, this.probes)
    if how.accounts:
        _add_to_balance(table, how.h, how.loads, how.joints)


@linked
def run(
    table: Indices,
    factors: PlainFactors,
    rule: PlainRule,
    steps: PlainSteps,
    last: int,
    asked: bool,
) -> int:
    """Advance to the end of step ``last``; returns why the loop returned.

    Args:
        table: Packed arrays, see :class:`Packed`.
        factors: Factors of the matrix.
        rule: Rule for refactorisation.
        steps: How steps are made, see :class:`Steps`.
        last: Last step.
        asked: Whether the loop had returned for a matrix, which is now factorised.
    """
    this, how = packed(table), Steps(*steps)
    progress = this.progress[0]
    while progress.made < last:
        if progress.iteration == 0:
            _begin(table, how.h)
        while True:
            if not asked:
                if progress.iteration == how.most:
                    return FAILED
                progress.iteration += 1
                progress.total += 1
                weigh(table, how.h, how.viscous)
                if due(rule, this.known[0], progress.iteration) != 0:
                    return MATRIX
            asked = False
            code = _improve(table, factors, steps)
            if code == FAILED:
                return FAILED
            if code == DONE:
                break
        if how.limited and vibrations_grow(this.pairs, this.squares, this.H, this.end, how.h):
            return GROWS
        learn(rule, this.known[0], progress.iteration)
        progress.iteration = 0
        if not how.accepts:
            return DONE
        _accept(table, steps)
    return DONE
