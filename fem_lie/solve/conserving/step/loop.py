"""Steps that conserve energy and momenta: prediction, iteration to stagnation, acceptance.

One compiled loop goes through the steps and comes back to Python for a new matrix, for results and
when a step fails.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled, inlined, linked
from fem_lie.bodies.balances import BY_LOADS, DAMPING, NUMERICAL, WORK
from fem_lie.joints.equations.table import PackedJoints, joint_table
from fem_lie.joints.equations.terms import unwrap
from fem_lie.lie.tuples import (
    Vector,
    combined,
    cross,
    dot,
    load,
    load_row,
    minus,
    plus,
    rotate,
    rotate_back,
    scaled,
    store,
    store_row,
)
from fem_lie.lie.wrenches import add_dead, add_wrench
from fem_lie.linear.factors import PlainFactors, solve
from fem_lie.solve.conserving.step.balance import residual
from fem_lie.solve.conserving.step.cayley import advance
from fem_lie.solve.conserving.step.copies import put
from fem_lie.solve.conserving.step.dissipation import (
    ENERGY,
    LEAK,
    LIMIT,
    REMEMBERS,
    REPAID,
    remember,
)
from fem_lie.solve.conserving.step.records import (
    Model,
    PackedModel,
    Scheme,
    State,
    Step,
    model_of,
    solution_of,
    span_of,
    state_of,
    step_of,
)
from fem_lie.solve.conserving.step.stopping import (
    ASKED,
    EXCESS,
    FELT,
    INCREMENT,
    ITERATION,
    LEAST,
    MARK,
    MOTION,
    PREVIOUS,
    STALLS,
    STEPS,
    TOTAL,
    converged,
    count,
    lags,
    settled,
    stagnates,
)
from fem_lie.system.nodes import inertia
from fem_lie.system.nodes.inertia import Inertia
from fem_lie.system.nodes.loads import Loads

DONE, MATRIX, FAILED = 0, 1, 2
_ULP = 4.0 * float(np.finfo(np.float64).eps)
"""What unknowns are changed by, in lengths of the model, to see what round-off does."""
_FELT = 8.0
"""Increments are round-off if they are at most as large as this many changes by it."""
_ASTRAY = 1e-6
"""Unless they are larger than this: far from any solution, where elements fold, all is felt."""


@linked
def packed_begin(model: PackedModel, state: Indices, step: Indices) -> float:
    """:func:`begin` of :class:`~fem_lie.solve.conserving.step.records.Packed`."""
    m = model_of(model)
    return begin(m.held, m.measure, m.scheme.h, state_of(state), step_of(step))


@compiled
def begin(held: Flags, measure: Array, h: float, state: State, this: Step) -> float:
    """Predict the step; returns the size of its largest motion."""
    H, V, trend, step = state.H, state.V, state.trend, this.step
    put(V, this.V1)
    put(state.weights, this.weights)
    ahead, largest = h * h, 0.0
    for i in range(step.shape[0]):
        u = combined(h, load_row(V[i], 0), ahead, load(trend[i], 0))
        ψ = combined(h, _spin(H[i], V[i]), ahead, load(trend[i], 3))
        _hold(H[i], held[i], u, ψ, step[i])
        for k in range(6):
            largest = max(largest, abs(step[i, k]) * measure[6 * i + k])
    return largest


@inlined
def _spin(H: Array, V: Array) -> Vector:
    """Angular velocity of rates of a frame."""
    twice = (0.0, 0.0, 0.0)
    for k in range(1, 4):
        twice = plus(twice, cross(load_row(H, k), load_row(V, k)))
    return scaled(0.5, twice)


@inlined
def _hold(H: Array, held: Flags, u: Vector, ψ: Vector, step: Array) -> None:
    """``step = (u, ψ)`` without its parts along the held axes of the frame."""
    any_held = False
    for k in range(6):
        any_held = any_held or held[k]
    if any_held:
        a = rotate_back(load_row(H, 1), load_row(H, 2), load_row(H, 3), u)
        b = rotate_back(load_row(H, 1), load_row(H, 2), load_row(H, 3), ψ)
        a = (0.0 if held[0] else a[0], 0.0 if held[1] else a[1], 0.0 if held[2] else a[2])
        b = (0.0 if held[3] else b[0], 0.0 if held[4] else b[1], 0.0 if held[5] else b[2])
        u = rotate(load_row(H, 1), load_row(H, 2), load_row(H, 3), a)
        ψ = rotate(load_row(H, 1), load_row(H, 2), load_row(H, 3), b)
    store(step, 0, u)
    store(step, 3, ψ)


@compiled
def correction(measure: Array, r: Array, factors: PlainFactors) -> float:
    """Solve for the correction; returns the size of its largest part."""
    residual, x, work = solution_of(r)
    largest = 0.0
    solve(factors, residual, work, x)
    for k in range(x.shape[0]):
        size = abs(x[k]) * measure[k]
        if size > largest or size != size:  # nan stays
            largest = size
    return largest


@compiled
def correct(held: Flags, scale: Array, scheme: Scheme, state: State, this: Step) -> None:
    """Apply the correction."""
    χ = scheme.loss * state.lag[REMEMBERS]
    H, weights = state.H, state.weights
    step, middle, x = this.step, span_of(this.rows).middle, solution_of(this.r).x
    n = step.shape[0]
    for i in range(n):
        m, dx = middle[i], x[6 * i : 6 * i + 6]
        u = rotate(load_row(m, 1), load_row(m, 2), load_row(m, 3), load(dx, 0))
        ψ = rotate(load_row(m, 1), load_row(m, 2), load_row(m, 3), load(dx, 3))
        u, ψ = minus(load(step[i], 0), u), minus(load(step[i], 3), ψ)
        _hold(H[i], held[i], u, ψ, step[i])
    for c in range(weights.shape[0]):
        # the residual has 2/(1 + χ) times the forces, the matrix one times their derivatives
        weights[c] -= 0.5 * (1.0 + χ) * scale[c] * x[6 * n + c]


@compiled
def accept(
    mass: Inertia,
    tables: tuple[PackedJoints, PackedJoints],
    loads: Loads,
    conservative: Array,
    scheme: Scheme,
    state: State,
    this: Step,
) -> None:
    """Make the end of the step the start of the next; ``tables``: of joints and of probes."""
    H, V, F, lag, trend = state.H, state.V, state.F, state.lag, state.trend
    w, w_F, books, account = state.w, state.w_F, state.books, state.account
    step, V1, F1, losses = this.step, this.V1, this.F1, this.losses
    end, _, middle, delta = span_of(this.rows)
    n, (h, χ, μ) = step.shape[0], scheme
    share = 0.5 * (1.0 + χ * lag[REMEMBERS])
    _keep_what_is_left(middle, step, solution_of(this.r).residual, share, lag, state.carry)
    if χ > 0.0:
        # the first step knows of no change before
        μ = μ if lag[REMEMBERS] > 0.0 else 1.0
        lag[REMEMBERS] = 1.0
        remember(lag, μ)
        w += μ * (V1 - V - w)
        w_F += μ * (F1 - F - w_F)
    books[WORK] += losses[WORK] + _work_of_loads(loads, conservative, this.rows, step, losses)
    books[DAMPING] += losses[DAMPING]
    books[NUMERICAL] += losses[NUMERICAL]
    books[BY_LOADS:] += h * losses[BY_LOADS:]
    advance(H[:n], state.rest, delta[:n])
    for i in range(n, H.shape[0]):
        for k in range(4):
            store_row(H[i], k, load_row(end[i], k))
    joints, probes = tables
    unwrap(H, joint_table(joints))
    unwrap(H, joint_table(probes))
    put(V1, V)
    momenta = this.q[1]
    inertia.multiply(mass.indptr, mass.indices, mass.blocks, V, momenta)
    lag[ENERGY] = max(lag[ENERGY], 0.5 * np.sum(V * momenta) + np.sum(this.W1))
    for i in range(n):
        for at in (0, 3):
            later = load_row(V[i], 0) if at == 0 else _spin(H[i], V[i])
            store(trend[i], at, combined(1.0 / h, later, -1.0 / h**2, load(step[i], at)))
    put(F1, F)
    put(this.W1, state.W)
    for e in range(account.shape[0]):
        account[e] += this.work[e]
    sizes, earlier = state.sizes, state.earlier
    sizes[2], sizes[1], sizes[0] = sizes[1], sizes[0], h
    for c in range(state.gap.shape[0]):
        state.gap[c] += this.change[c]
        earlier[1, c], earlier[0, c] = earlier[0, c], this.weights[c]


@compiled
def _keep_what_is_left(
    middle: Array, step: Array, r: Array, factor: float, lag: Array, carry: Array
) -> None:
    """Forces and energy that the next step makes up for, from the residual ``r``."""
    gain = square = 0.0
    for i in range(step.shape[0]):
        m, left = middle[i], r[6 * i : 6 * i + 6]
        for at in (0, 3):
            f = rotate(load_row(m, 1), load_row(m, 2), load_row(m, 3), load(left, at))
            f = scaled(factor, f)
            for j in range(3):
                gain += (f[j] - carry[i, at + j]) * step[i, at + j]
                square += f[j] * f[j] if at == 0 else 0.0
            store(carry[i], at, f)
    lag[LEAK] += gain - lag[REPAID]
    lag[LIMIT] = sqrt(square)


@compiled
def _work_of_loads(loads: Loads, constant: Array, rows: Array, step: Array, losses: Array) -> float:
    """Work in the step of all loads without a potential; adds the forces of all to ``losses``."""
    dead, moment, following = loads
    _, mean, middle, delta = span_of(rows)
    work = 0.0
    for i in range(step.shape[0]):
        for k in range(4):
            for j in range(3):
                work += (dead[i, k, j] - constant[i, k, j]) * delta[i, k, j]
        add_dead(losses, BY_LOADS, 1.0, mean[i], dead[i])
        d1, d2, d3 = load_row(middle[i], 1), load_row(middle[i], 2), load_row(middle[i], 3)
        f = rotate(d1, d2, d3, load(following[i], 0))
        m = plus(load(moment[i], 0), rotate(d1, d2, d3, load(following[i], 3)))
        work += dot(f, load(step[i], 0)) + dot(m, load(step[i], 3))
        add_wrench(losses, BY_LOADS, load_row(mean[i], 0), f, m)
    return work


@linked
def run(
    packed: PackedModel,
    starts: Indices,
    steps: Indices,
    factors: PlainFactors,
    options: tuple[float, int, int, float, float],
    counters: Indices,
    numbers: Array,
    last: int,
) -> int:
    """Go on until step ``last``, or until a new matrix is wanted, or a step fails.

    Args:
        packed: The model, see :class:`~fem_lie.solve.conserving.step.records.Packed`.
        starts: The state.
        steps: The step.
        factors: Of the matrix.
        options: Tolerance (0: until nothing changes), most iterations, patience and cost as of
            :class:`~fem_lie.solve.motion.policies.Automatic`, and iterations that a step may go on
            for where that was not enough.
        counters: Shape (7,), updated.
        numbers: Shape (9,), updated.
        last: Step to reach.
    """
    model, state, this = model_of(packed), state_of(starts), step_of(steps)
    tolerance, limit, patience, cost, spare = options
    # what takes all of the model is much code at each call
    held, measure, scale, scheme = model.held, model.measure, model.scale, model.scheme
    while counters[STEPS] < last:
        if counters[ITERATION] == 0:
            numbers[MOTION] = max(begin(held, measure, scheme.h, state, this), numbers[MOTION])
            numbers[PREVIOUS], numbers[LEAST], numbers[FELT] = np.inf, np.inf, 0.0
            counters[ITERATION], counters[STALLS] = 1, 0
        iteration = counters[ITERATION]
        if counters[ASKED] != iteration:
            counters[ASKED] = iteration
            if iteration == 1:
                due = numbers[EXCESS] >= cost
            else:
                due = (iteration - 1) % patience == 0
                if due and spare > 0.0:
                    due = lags(numbers, tolerance, patience, spare)
            if due:
                return MATRIX
        residual(model, state, this)
        numbers[INCREMENT] = correction(measure, this.r, factors)
        counters[TOTAL] += 1
        if iteration == 1:
            numbers[MARK] = numbers[INCREMENT]
        noise = settled(counters, numbers)
        if not noise and stagnates(counters, numbers):
            # one sample of round-off may be small by chance
            numbers[FELT] = max(_round_off(model, state, this, factors), numbers[FELT])
            noise = numbers[INCREMENT] <= min(_FELT * numbers[FELT], _ASTRAY)
        if noise or converged(numbers, tolerance, iteration):
            # a correction that is noise is not made: what is accepted must be of one piece
            if not noise:
                correct(held, scale, scheme, state, this)
                residual(model, state, this)
            joints = model.joints, model.probes
            accept(model.inertia, joints, model.loads, model.conservative, scheme, state, this)
            count(counters, numbers)
            counters[STEPS] += 1
            counters[ITERATION] = counters[ASKED] = 0
        elif iteration == limit or not numbers[INCREMENT] < 1e3:
            return FAILED
        else:
            correct(held, scale, scheme, state, this)
            numbers[PREVIOUS] = numbers[INCREMENT]
            counters[ITERATION] += 1
    return DONE


@linked
def _round_off(model: Model, state: State, this: Step, factors: PlainFactors) -> float:
    """How much the correction changes with the unknowns' last digits.

    That is what round-off makes of it in this scene and posture, where stiffness over inertia, or
    constraints that are hardly independent, make much of it, and places far from the origin have
    the fewer digits. An iteration that is at odds with its matrix does not feel it.
    """
    held, measure = model.held, model.measure
    H, weights, step, solution = state.H, state.weights, this.step, solution_of(this.r)
    kept, kept_weights, x = step.copy(), weights.copy(), solution.x.copy()
    n, sign = step.shape[0], 1.0
    for i in range(n):
        place = load_row(H[i], 0)
        far = max(1.0, measure[6 * i] * sqrt(dot(place, place)))
        for k in range(6):
            step[i, k] += sign * _ULP * (far if k < 3 else 1.0) / measure[6 * i + k]
            sign = -sign
        _hold(H[i], held[i], load(step[i], 0), load(step[i], 3), step[i])
        sign = -sign if i % 2 == 0 else sign
    for c in range(weights.shape[0]):
        weights[c] *= 1.0 + sign * _ULP
        sign = -sign
    residual(model, state, this)
    correction(measure, this.r, factors)
    largest = 0.0
    for k in range(x.shape[0]):
        largest = max(largest, abs(solution.x[k] - x[k]) * measure[k])
    put(kept, step)
    put(kept_weights, weights)
    residual(model, state, this)
    put(x, solution.x)
    return largest
