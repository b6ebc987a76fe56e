"""Steps that conserve energy and momenta: prediction, iteration to stagnation, acceptance.

One compiled loop goes through the steps and comes back to Python for a new matrix, for results and
when a step fails.
"""

from __future__ import annotations

from math import sqrt
from typing import Any

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined, linked
from fem_lie.bodies.balances import BY_LOADS
from fem_lie.joints.equations.table import joint_table
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
from fem_lie.linear.factors import solve
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

DONE, MATRIX, FAILED = 0, 1, 2
_ULP = 4.0 * float(np.finfo(np.float64).eps)
"""What unknowns are changed by, in lengths of the model, to see what round-off does."""
_FELT = 8.0
"""Increments are round-off if they are at most as large as this many changes by it."""


@compiled
def begin(  # type: ignore[no-untyped-def]
    held, measure, scheme, state, this
):
    """Predict the step; returns the size of its largest motion."""
    h = scheme[0]
    H, V, trend, step, V1 = state[0], state[2], state[13], this[0], this[2]
    put(V, V1)
    put(state[3], this[13])
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
def _hold(H: Array, held: Any, u: Vector, ψ: Vector, step: Array) -> None:
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
def correction(measure: Array, r: Array, factors: tuple[Any, ...]) -> float:
    """Solve for the correction; returns the size of its largest part."""
    x, largest = r[1], 0.0
    solve(factors, r[0], r[2], x)
    for k in range(x.shape[0]):
        size = abs(x[k]) * measure[k]
        if size > largest or size != size:  # nan stays
            largest = size
    return largest


@compiled
def correct(  # type: ignore[no-untyped-def]
    held, scale, scheme, state, this
):
    """Apply the correction."""
    χ = scheme[1] * state[10][REMEMBERS]
    H, weights = state[0], state[3]
    step, middle, x = this[0], this[1][2], this[12][1]
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
def accept(  # type: ignore[no-untyped-def]
    mass, joints, probes, loads, scheme, state, this
):
    """Make the end of the step the start of the next."""
    H, rest, V, _, gap, F, W, account, w, w_F, lag, carry, books, trend, earlier, sizes = state
    step, rows, V1, F1, energies, change, losses = this[:7]
    n, (h, χ, μ) = step.shape[0], scheme
    _keep_what_is_left(rows[2], step, this[12][0], 0.5 * (1.0 + χ * lag[REMEMBERS]), lag, carry)
    if χ > 0.0:
        # the first step knows of no change before
        μ = μ if lag[REMEMBERS] > 0.0 else 1.0
        lag[REMEMBERS] = 1.0
        remember(lag, μ)
        w += μ * (V1 - V - w)
        w_F += μ * (F1 - F - w_F)
    books[0] += losses[0] + _work_of_loads(loads, rows, step, losses)
    books[1] += losses[1]
    books[2] += losses[2]
    books[BY_LOADS:] += h * losses[BY_LOADS:]
    advance(H[:n], rest, rows[3, :n])
    for i in range(n, H.shape[0]):
        for k in range(4):
            store_row(H[i], k, load_row(rows[0, i], k))
    unwrap(H, joint_table(joints))
    unwrap(H, joint_table(probes))
    put(V1, V)
    indptr, indices, blocks = mass
    inertia.multiply(indptr, indices, blocks, V, this[10][1])
    lag[ENERGY] = max(lag[ENERGY], 0.5 * np.sum(V * this[10][1]) + np.sum(energies[0]))
    for i in range(n):
        for at in (0, 3):
            end = load_row(V[i], 0) if at == 0 else _spin(H[i], V[i])
            store(trend[i], at, combined(1.0 / h, end, -1.0 / h**2, load(step[i], at)))
    put(F1, F)
    put(energies[0], W)
    for e in range(account.shape[0]):
        account[e] += energies[1, e]
    sizes[2], sizes[1], sizes[0] = sizes[1], sizes[0], h
    for c in range(gap.shape[0]):
        gap[c] += change[c]
        earlier[1, c], earlier[0, c] = earlier[0, c], this[13][c]


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
def _work_of_loads(loads: tuple[Any, ...], rows: Array, step: Array, losses: Array) -> float:
    """Work in the step of all loads without a potential; adds the forces of all to ``losses``."""
    dead, moment, following, constant = loads
    mean, middle, delta, work = rows[1], rows[2], rows[3], 0.0
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
    model: tuple[Any, ...],
    state: tuple[Any, ...],
    this: tuple[Any, ...],
    factors: tuple[Any, ...],
    options: tuple[float, int, int, float, float],
    counters: Indices,
    numbers: Array,
    last: int,
) -> int:
    """Go on until step ``last``, or until a new matrix is wanted, or a step fails.

    Args:
        model: See :class:`~fem_lie.solve.conserving.step.balance.Model`.
        state: See :class:`~fem_lie.solve.conserving.step.balance.State`.
        this: See :class:`~fem_lie.solve.conserving.step.balance.Step`.
        factors: Of the matrix.
        options: Tolerance (0: until nothing changes), most iterations, patience and cost as of
            :class:`~fem_lie.solve.motion.policies.Automatic`, and iterations that a step may go on
            for where that was not enough.
        counters: Shape (7,), updated.
        numbers: Shape (9,), updated.
        last: Step to reach.
    """
    tolerance, limit, patience, cost, spare = options
    # what takes all of the model is much code at each call
    held, measure, scale, scheme = model[5], model[6], model[7], model[11]
    while counters[STEPS] < last:
        if counters[ITERATION] == 0:
            numbers[MOTION] = max(begin(held, measure, scheme, state, this), numbers[MOTION])
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
        numbers[INCREMENT] = correction(measure, this[12], factors)
        counters[TOTAL] += 1
        if iteration == 1:
            numbers[MARK] = numbers[INCREMENT]
        noise = settled(counters, numbers)
        if not noise and stagnates(counters, numbers):
            # one sample of round-off may be small by chance
            numbers[FELT] = max(_round_off(model, state, this, factors), numbers[FELT])
            noise = numbers[INCREMENT] <= _FELT * numbers[FELT]
        if noise or converged(numbers, tolerance, iteration):
            # a correction that is noise is not made: what is accepted must be of one piece
            if not noise:
                correct(held, scale, scheme, state, this)
                residual(model, state, this)
            accept(model[2], model[1], model[12], model[8], scheme, state, this)
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
def _round_off(
    model: tuple[Any, ...], state: tuple[Any, ...], this: tuple[Any, ...], factors: tuple[Any, ...]
) -> float:
    """How much the correction changes with the unknowns' last digits.

    That is what round-off makes of it in this scene and posture, where stiffness over inertia, or
    constraints that are hardly independent, make much of it. An iteration that is at odds with its
    matrix does not feel it.
    """
    held, measure = model[5], model[6]
    H, weights, step, r = state[0], state[3], this[0], this[12]
    kept, kept_weights, x = step.copy(), weights.copy(), r[1].copy()
    n, sign = step.shape[0], 1.0
    for i in range(n):
        for k in range(6):
            step[i, k] += sign * _ULP / measure[6 * i + k]
            sign = -sign
        _hold(H[i], held[i], load(step[i], 0), load(step[i], 3), step[i])
        sign = -sign if i % 2 == 0 else sign
    for c in range(weights.shape[0]):
        weights[c] *= 1.0 + sign * _ULP
        sign = -sign
    residual(model, state, this)
    correction(measure, this[12], factors)
    largest = 0.0
    for k in range(x.shape[0]):
        largest = max(largest, abs(r[1, k] - x[k]) * measure[k])
    put(kept, step)
    put(kept_weights, weights)
    residual(model, state, this)
    put(x, r[1])
    return largest
