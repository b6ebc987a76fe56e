"""Steps that conserve energy and momenta: prediction, and iteration to stagnation.

One compiled loop goes through the steps and comes back to Python for a new matrix, for results and
when a step fails.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import linked
from fem_lie._jit.call_back import call_back
from fem_lie.forms.fixed_arrays import put
from fem_lie.lie.tuples import dot, load, load_row
from fem_lie.linear.factors import PlainFactors
from fem_lie.solve.conserving.step.acceptance import accept
from fem_lie.solve.conserving.step.balance import residual
from fem_lie.solve.conserving.step.corrections import (
    ASIDE,
    ASKED,
    EXCESS,
    FELT,
    FINE,
    FLOOR,
    INCREMENT,
    ITERATION,
    LEAST,
    LEFT,
    MARK,
    MOTION,
    NEEDED,
    PREVIOUS,
    STALLS,
    STEPS,
    TOTAL,
    ULPS,
    converged,
    count,
    hasten,
    lags,
    largest_force,
    settled,
    size,
    stagnates,
)
from fem_lie.solve.conserving.step.dissipation import MEMORY, MOMENTUM
from fem_lie.solve.conserving.step.nodes import begin, compare, correct, hold
from fem_lie.solve.conserving.step.packing import PackedModel, model_of, state_of, step_of
from fem_lie.solve.conserving.step.records import ERROR, LEARN, solution_of
from fem_lie.solve.conserving.step.series import (
    CLOSE,
    FALLS,
    NEARLY,
    correction,
    growth,
)
from fem_lie.solve.motion.convergence import ROUND_OFF

DONE, MATRIX, FAILED, LOST = 0, 1, 2, 3
_ULP = 4.0 * float(np.finfo(np.float64).eps)
"""What unknowns are changed by, in lengths of the model, to see what round-off does."""
_FELT = 8.0
"""Increments are round-off if they are at most as large as this many changes by it."""
_ASTRAY = 1e-6
"""Unless they are larger than this: far from any solution, where elements fold, all is felt."""
_SMALL = 0.1
"""What of the constraints is not in the matrix, where a step may end by the rate of convergence."""
_FALLS = 0.5
"""Ratio of forces left over on nodes that are no frames, where one more correction is worth it."""
_SEEN = 1e-13
"""Of the largest momentum of a node, impulses that are."""
_USUAL, _OF_ONE = 2, 0.1
"""Terms for old constraints that cost nothing, and what others cost, in iterations."""


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
        counters: Shape (8,), updated.
        numbers: Shape (11,), updated.
        last: Step to reach.
    """
    model, state, this = model_of(packed), state_of(starts), step_of(steps)
    tolerance, limit, patience, cost, spare = options
    measure, scale, outside, supported = model.measure, model.scale, model.outside, False
    for i in range(model.supported.shape[0]):
        for k in range(6):
            supported = supported or model.supported[i, k] != 0
    legs, ends, aside, compared = model.legs, model.ends, (this.border, this.turnings), False
    noise_level = _noise_level(packed, starts)
    vectors, h = model.rows.sees.shape[0] > 0, model.scheme.h
    while counters[STEPS] < last:
        if counters[ITERATION] == 0:
            numbers[MOTION] = max(begin(packed, starts, steps), numbers[MOTION])
            numbers[PREVIOUS], numbers[LEAST], numbers[FELT] = np.inf, np.inf, 0.0
            counters[ITERATION], counters[STALLS], compared = 1, 0, False
            numbers[LEFT], noise_level = np.inf, _noise_level(packed, starts)
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
        residual(packed, starts, steps, True)
        if outside[ERROR] != 0:
            return FAILED
        if not compared:
            compare(packed, starts, steps)
            compared = True
            if iteration == 1 and spare > 0.0 and legs.nodes.shape[0] > 0:
                border, probe = this.border, state.probe
                if growth(measure, scale, this.r, factors, legs, ends, border, probe) > FALLS:
                    return LOST
        fine = numbers[FLOOR]
        close = CLOSE if iteration == 1 else NEARLY
        numbers[INCREMENT], terms, numbers[ASIDE] = correction(
            measure,
            scale,
            this.r,
            factors,
            legs,
            ends,
            aside,
            (close, fine, 1.0 if iteration == 1 else numbers[ASIDE]),
        )
        if outside[LEARN] != 0:
            call_back(outside[LEARN])
            numbers[INCREMENT] = size(measure, solution_of(this.r).x)
        if ends.inverse.shape[0] == 0:
            numbers[EXCESS] += _OF_ONE * max(terms - _USUAL, 0)
        if state.slow.shape[0] > 0:
            x, cut = solution_of(this.r).x, state.lag[MEMORY] < 1.0
            hasten(measure, x, state.slow, state.share, (cut, iteration == 1), 16.0 * fine)
        counters[TOTAL] += 1
        falls, goes_on, astray, moved = False, False, False, 0.0
        if vectors:
            # stiff cells feel what is no increment any more: it is taken out before a step ends
            left = largest_force(model.kinds, model.arms, solution_of(this.r).residual)
            matters = tolerance == 0.0 and left * abs(h) > _SEEN * state.lag[MOMENTUM]
            falls, numbers[LEFT] = matters and left < _FALLS * numbers[LEFT], left
            moved = size(model.of_vectors, solution_of(this.r).x)
            goes_on, astray = tolerance == 0.0 and moved > ROUND_OFF, moved > noise_level
        # at the last digits of cells without frames no matrix helps: policies do not count them
        if numbers[PREVIOUS] > ULPS or 2.0 * moved <= numbers[INCREMENT]:
            counters[NEEDED] = iteration
        if iteration == 1:
            numbers[MARK] = numbers[INCREMENT]
        noise = settled(counters, numbers) and not falls
        # neither increments of cells without frames nor corrections that learn are compared with it
        compares = not astray and outside[LEARN] == 0
        if not noise and compares and stagnates(counters, numbers):
            # one sample of round-off may be small by chance
            numbers[FELT] = max(_round_off(packed, starts, steps, factors), numbers[FELT])
            noise = numbers[INCREMENT] <= min(_FELT * numbers[FELT], _ASTRAY)
        known = legs.nodes.shape[0] == 0 or numbers[ASIDE] < _SMALL
        more = falls or goes_on
        if noise or (converged(numbers, tolerance, iteration, known) and not more):
            # a correction that is noise is not made: what is accepted must be of one piece
            if not noise:
                correct(packed, starts, steps)
                # to move cells by less than their places can tell makes no other forces, but for
                # what a support holds of them
                residual(packed, starts, steps, supported or numbers[INCREMENT] > FINE)
            accept(packed, starts, steps)
            count(counters, numbers)
            counters[STEPS] += 1
            counters[ITERATION] = counters[ASKED] = 0
        elif iteration == limit or not numbers[INCREMENT] < 1e3:
            return FAILED
        else:
            correct(packed, starts, steps)
            numbers[PREVIOUS] = numbers[INCREMENT]
            counters[ITERATION] += 1
    return DONE


@linked
def _noise_level(packed: PackedModel, starts: Indices) -> float:
    """Largest increment that may be round-off: far from the origin positions are known to less."""
    model, H, far = model_of(packed), state_of(starts).H, 0.0
    if model.rows.sees.shape[0] == 0:
        return ULPS
    for i in range(model.kinds.shape[0]):
        for j in range(3):
            far = max(far, abs(H[i, 0, j]) * model.measure[6 * i])
    return max(ULPS, 0.1 * ULPS * far)


@linked
def _round_off(
    packed: PackedModel, starts: Indices, steps: Indices, factors: PlainFactors
) -> float:
    """How much the correction changes with the unknowns' last digits.

    That is what round-off makes of it in this scene and posture, where stiffness over inertia, or
    constraints that are hardly independent, make much of it, and places far from the origin have
    the fewer digits. An iteration that is at odds with its matrix does not feel it.
    """
    model, state, this = model_of(packed), state_of(starts), step_of(steps)
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
        hold(model.kinds[i], H[i], held[i], load(step[i], 0), load(step[i], 3), step[i])
        sign = -sign if i % 2 == 0 else sign
    for c in range(weights.shape[0]):
        weights[c] *= 1.0 + sign * _ULP
        sign = -sign
    residual(packed, starts, steps, True)
    aside = this.border, this.turnings
    given = measure, model.scale, this.r, factors, model.legs, model.ends
    correction(*given, aside, (NEARLY, 0.0, 1.0))
    for k in range(x.shape[0]):
        solution.x[k] -= x[k]
    largest = size(measure, solution.x)
    put(kept, step)
    put(kept_weights, weights)
    residual(packed, starts, steps, True)
    put(x, solution.x)
    return largest
