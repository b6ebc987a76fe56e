"""Steps that conserve energy and momenta: prediction, and iteration to stagnation.

One compiled loop goes through the steps and comes back to Python for a new matrix, for results and
when a step fails.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled, inlined, linked
from fem_lie.forms.fixed_arrays import put
from fem_lie.joints.equations.table import PackedJoints
from fem_lie.lie.kinds.inertia import Inertia
from fem_lie.lie.tuples import (
    Vector,
    combined,
    dot,
    load,
    load_row,
    minus,
    rotate,
    rotate_back,
    store,
)
from fem_lie.linear.factors import PlainFactors
from fem_lie.solve.conserving.step.acceptance import accept
from fem_lie.solve.conserving.step.balance import residual
from fem_lie.solve.conserving.step.cayley import spin
from fem_lie.solve.conserving.step.corrections import (
    ASIDE,
    ASKED,
    CLOSE,
    EXCESS,
    FALLS,
    FELT,
    FINE,
    FLOOR,
    INCREMENT,
    ITERATION,
    LEAST,
    MARK,
    MOTION,
    NEARLY,
    PREVIOUS,
    STALLS,
    STEPS,
    TOTAL,
    converged,
    correction,
    count,
    growth,
    hasten,
    lags,
    settled,
    size,
    stagnates,
)
from fem_lie.solve.conserving.step.dissipation import (
    MEMORY,
    REMEMBERS,
    begin_products,
    set_turnings,
)
from fem_lie.solve.conserving.step.joints import border_at
from fem_lie.solve.conserving.step.packing import PackedModel, model_of, state_of, step_of
from fem_lie.solve.conserving.step.records import (
    Legs,
    Model,
    Scheme,
    State,
    Step,
    products_of,
    solution_of,
    span_of,
)

DONE, MATRIX, FAILED, LOST = 0, 1, 2, 3
_ULP = 4.0 * float(np.finfo(np.float64).eps)
"""What unknowns are changed by, in lengths of the model, to see what round-off does."""
_FELT = 8.0
"""Increments are round-off if they are at most as large as this many changes by it."""
_ASTRAY = 1e-6
"""Unless they are larger than this: far from any solution, where elements fold, all is felt."""
_SMALL = 0.1
"""What of the constraints is not in the matrix, where a step may end by the rate of convergence."""
_USUAL, _OF_ONE = 2, 0.1
"""Terms for old constraints that cost nothing, and what others cost, in iterations."""


@linked
def packed_begin(model: PackedModel, state: Indices, step: Indices) -> float:
    """:func:`begin` of :class:`~fem_lie.solve.conserving.step.packing.Packed`."""
    m = model_of(model)
    return begin(m.held, m.measure, m.inertia, m.scheme, state_of(state), step_of(step))


@compiled
def begin(
    held: Flags, measure: Array, mass: Inertia, scheme: Scheme, state: State, this: Step
) -> float:
    """Predict the step; returns the size of its largest motion."""
    H, V, trend, step = state.H, state.V, state.trend, this.step
    put(V, this.V1)
    put(state.weights, this.weights)
    if scheme.loss * state.lag[REMEMBERS] > 0.0:
        begin_products(mass, V, state.w, products_of(this))
    h = scheme.h
    ahead, largest = h * h, 0.0
    for i in range(step.shape[0]):
        u = combined(h, load_row(V[i], 0), ahead, load(trend[i], 0))
        ψ = combined(h, spin(H[i], V[i]), ahead, load(trend[i], 3))
        _hold(H[i], held[i], u, ψ, step[i])
        for k in range(6):
            largest = max(largest, abs(step[i, k]) * measure[6 * i + k])
    return largest


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
def _compare(
    joints: PackedJoints, legs: Legs, held: Flags, scheme: Scheme, state: State, this: Step
) -> None:
    """What of the step as it is is not in the matrix: its constraints, and rotations of Π."""
    along, change = span_of(this.rows), this.border
    if this.turnings.shape[1] > 0:
        χ, frames = scheme.loss * state.lag[REMEMBERS], (along.mean, along.middle)
        set_turnings(products_of(this), frames, held, χ, scheme.h, this.turnings)
    if legs.nodes.shape[0] == 0:
        return
    border_at(joints, legs, held, (along.end, along.middle, along.middle), change)
    for side in range(2):
        for leg in range(change.shape[1]):
            for k in range(6):
                change[side, leg, k] -= state.border[side, leg, k]


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
    """Go on until step ``last``, or until a new matrix is wanted, or a step fails or would be lost.

    It would be where the constraints of its predicted end are not nearly those of the matrix.

    Args:
        packed: The model, see :class:`~fem_lie.solve.conserving.step.packing.Packed`.
        starts: The state.
        steps: The step.
        factors: Of the matrix.
        options: Tolerance (0: until nothing changes), most iterations, patience and cost as of
            :class:`~fem_lie.solve.motion.policies.Automatic`, and iterations that a step may go on
            for where that was not enough; without such (0) a step is made with whatever it has.
        counters: Shape (7,), updated.
        numbers: Shape (10,), updated.
        last: Step to reach.
    """
    model, state, this = model_of(packed), state_of(starts), step_of(steps)
    tolerance, limit, patience, cost, spare = options
    # what takes all of the model is much code at each call
    held, measure, scale, scheme = model.held, model.measure, model.scale, model.scheme
    supported = bool(np.any(model.supported))
    legs, aside, compared = model.legs, (this.border, this.turnings), False
    while counters[STEPS] < last:
        if counters[ITERATION] == 0:
            numbers[MOTION] = max(
                begin(held, measure, model.inertia, scheme, state, this), numbers[MOTION]
            )
            numbers[PREVIOUS], numbers[LEAST], numbers[FELT] = np.inf, np.inf, 0.0
            counters[ITERATION], counters[STALLS], compared = 1, 0, False
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
        residual(model, state, this, True)
        if not compared:
            _compare(model.joints, legs, held, scheme, state, this)
            compared = True
            if iteration == 1 and spare > 0.0 and legs.nodes.shape[0] > 0:
                border, probe = this.border, state.probe
                if growth(measure, scale, this.r, factors, legs, border, probe) > FALLS:
                    return LOST
        fine = numbers[FLOOR]
        close = CLOSE if iteration == 1 else NEARLY
        numbers[INCREMENT], terms, numbers[ASIDE] = correction(
            measure,
            scale,
            this.r,
            factors,
            legs,
            aside,
            (close, fine, 1.0 if iteration == 1 else numbers[ASIDE]),
        )
        numbers[EXCESS] += _OF_ONE * max(terms - _USUAL, 0)
        if state.slow.shape[0] > 0:
            x, cut = solution_of(this.r).x, state.lag[MEMORY] < 1.0
            hasten(measure, x, state.slow, state.share, (cut, iteration == 1), 16.0 * fine)
        counters[TOTAL] += 1
        if iteration == 1:
            numbers[MARK] = numbers[INCREMENT]
        noise = settled(counters, numbers)
        if not noise and stagnates(counters, numbers):
            # one sample of round-off may be small by chance
            numbers[FELT] = max(_round_off(model, state, this, factors), numbers[FELT])
            noise = numbers[INCREMENT] <= min(_FELT * numbers[FELT], _ASTRAY)
        known = legs.nodes.shape[0] == 0 or numbers[ASIDE] < _SMALL
        if noise or converged(numbers, tolerance, iteration, known):
            # a correction that is noise is not made: what is accepted must be of one piece
            if not noise:
                correct(held, scale, scheme, state, this)
                # to move cells by less than their places can tell makes no other forces, but for
                # what a support holds of them
                residual(model, state, this, supported or numbers[INCREMENT] > FINE)
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
    residual(model, state, this, True)
    aside = this.border, this.turnings
    correction(measure, model.scale, this.r, factors, model.legs, aside, (NEARLY, 0.0, 1.0))
    for k in range(x.shape[0]):
        solution.x[k] -= x[k]
    largest = size(measure, solution.x)
    put(kept, step)
    put(kept_weights, weights)
    residual(model, state, this, True)
    put(x, solution.x)
    return largest
