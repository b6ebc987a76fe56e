"""Steps that conserve energy and momenta: prediction, and iteration down to round-off.

One compiled loop makes the steps and returns to Python for a new matrix, for results and when a
step fails.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from fem_lie._arrays import Indices
from fem_lie._jit import linked
from fem_lie._jit.call_back import call_back
from fem_lie.forms.fixed_arrays import put
from fem_lie.lie.tuples import dot, load, load_row
from fem_lie.linear.factors import PlainFactors
from fem_lie.solve.conserving.step.acceptance import accept
from fem_lie.solve.conserving.step.balance import residual
from fem_lie.solve.conserving.step.corrections import (
    CYCLES,
    FINE,
    LEARNING,
    ULPS,
    WINDOW,
    accelerate,
    converged,
    count,
    forget,
    is_lost,
    is_round_off,
    lags,
    larger,
    progress_of,
    shorten,
    size,
    size_of_vectors,
    stagnates,
    stalls,
)
from fem_lie.solve.conserving.step.joints import begin, compare, correct, hold
from fem_lie.solve.conserving.step.packing import model_of, state_of, step_of
from fem_lie.solve.conserving.step.ranks import largest, ranks_of
from fem_lie.solve.conserving.step.records import ERROR, LEARN, TOUCHES, solution_of
from fem_lie.solve.conserving.step.series import (
    CLOSE,
    FALLS,
    NEARLY,
    correction,
    growth,
)
from fem_lie.solve.conserving.vector_cells.cell_arrays import has_position
from fem_lie.solve.convergence import ROUND_OFF
from fem_lie.solve.refactorisation import is_due

DONE, MATRIX, FAILED, LOST = 0, 1, 2, 3
_ULP = 4.0 * float(np.finfo(np.float64).eps)
"""Perturbation of unknowns, in lengths of the model, that measures the effect of round-off."""
_FELT = 8.0
"""Increments are round-off if they are at most this multiple of the measured effect."""
_ASTRAY = 1e-6
"""Unless they are larger than this: far from any solution, where elements fold, round-off has large
effects."""
_SMALL = 0.1
"""Relative change of constraints since the matrix at which a step may end by the convergence
rate."""
_USUAL, _OF_ONE = 2, 0.1
"""Series terms for constraint changes that cost nothing, and the cost of further ones, in
iterations."""


@linked
def predict(packed: Indices, starts: Indices, steps: Indices, progress_at: Indices) -> None:
    """Predict the next step, and forget the iteration of the last one; see :func:`run`."""
    progress = progress_of(progress_at).progress[0]
    ranks = ranks_of(model_of(packed), step_of(steps))
    progress.motion = max(largest(ranks, begin(packed, starts, steps)), progress.motion)
    progress.previous, progress.least, progress.felt = np.inf, np.inf, 0.0
    progress.iteration, progress.asked, progress.stalls, progress.growths = 1, 0, 0, 0
    forget(progress)


@linked
def run(
    packed: Indices,
    starts: Indices,
    steps: Indices,
    factors: PlainFactors,
    options: tuple[float, int, int, float, float],
    progress_at: Indices,
    last: int,
) -> int:
    """Advance to step ``last``, or until a matrix is needed, or a step fails or would fail.

    It would fail if the constraints of its predicted end differ too much from those of the matrix.

    Args:
        packed: The model, see :class:`~fem_lie.solve.conserving.step.packing.Packed`.
        starts: The state.
        steps: The step.
        factors: Factors of the matrix.
        options: Tolerance (0: down to round-off), largest number of iterations, patience and cost
            as in :class:`~fem_lie.solve.motion.policies.Automatic`, and number of further
            iterations allowed where this was not enough; with 0 a step is made with the existing
            matrix.
        progress_at: Address of the progress, a :data:`.corrections.PROGRESS`; updated.
        last: Last step.
    """
    model, state, this = model_of(packed), state_of(starts), step_of(steps)
    progress = progress_of(progress_at).progress[0]
    recent = progress.recent
    tolerance, limit, patience, cost, spare = options
    measure, scale, addresses, supported = model.measure, model.scale, model.addresses, False
    for i in range(model.supported.shape[0]):
        for k in range(6):
            supported = supported or model.supported[i, k] != 0
    incidences, ends, aside, compared = (
        model.incidences,
        model.ends,
        (this.border, this.turnings),
        False,
    )
    touches = addresses[TOUCHES] != 0
    kinds, vectors, ranks = model.kinds, model.vectors, ranks_of(model, this)
    round_off_level, solver = _round_off_level(packed, starts, steps), (factors, ranks)
    while progress.steps < last:
        if progress.iteration == 0:
            predict(packed, starts, steps, progress_at)
            compared, round_off_level = False, _round_off_level(packed, starts, steps)
        iteration = progress.iteration
        if progress.asked != iteration:
            progress.asked = iteration
            due = is_due(iteration, patience, progress.excess, cost)
            if due and iteration > 1 and spare > 0.0:
                due = lags(
                    progress, tolerance, patience, spare, round_off_level if vectors else FINE
                )
            if due:
                return MATRIX
        residual(packed, starts, steps, True)
        if addresses[ERROR] != 0:
            return FAILED
        if not compared:
            compare(packed, starts, steps)
            compared = True
            if iteration == 1 and spare > 0.0 and incidences.nodes.shape[0] > 0:
                border, probe = this.border, state.probe
                if growth(measure, scale, this.r, factors, incidences, ends, border, probe) > FALLS:
                    return LOST
        fine = progress.floor
        noticed = round_off_level if vectors else 16.0 * fine
        close = CLOSE if iteration == 1 else NEARLY
        progress.increment, terms, progress.aside = correction(
            measure,
            scale,
            this.r,
            solver,
            incidences,
            ends,
            aside,
            (close, fine, 1.0 if iteration == 1 else progress.aside),
        )
        if addresses[LEARN] != 0:
            call_back(addresses[LEARN])
        if ends.inverse.shape[0] == 0:
            progress.excess += _OF_ONE * max(terms - _USUAL, 0)
        # secants handle the directions of their own corrections
        if state.slow.shape[0] > 0 and addresses[LEARN] == 0:
            x, cut = solution_of(this.r).x, state.filter_state[0].gain < 1.0
            flags, sizes = (cut, iteration == 1), (progress.increment, noticed)
            accelerate(measure, x, state.slow, state.share, flags, sizes, ranks)
        progress.total += 1
        x, moved, rests, stalled = solution_of(this.r).x, 0.0, True, False
        own, before = progress.increment, larger(progress.previous, recent[0])
        if vectors or touches:
            moved = own
            if vectors:
                own = largest(ranks, size(model.of_frames, x))
                moved = largest(ranks, size_of_vectors(kinds, measure, x))
            window = WINDOW if addresses[LEARN] == 0 else LEARNING
            stalled = stalls(progress, moved, window) and moved <= round_off_level
            rests = moved <= ROUND_OFF or stalled
            if not vectors:
                # the effect of round-off on contacts may be larger than this level
                rests = stalled or moved > round_off_level or moved == 0.0
            if tolerance > 0.0:
                own, rests = larger(own, moved), True
        # no matrix helps at the last digits of cells without frames: policies do not count them
        if not vectors or before > round_off_level or moved <= own:
            progress.needed = iteration
        done = at_round_off = False
        progress.increment = own
        if rests:
            at_round_off = is_round_off(progress, touches)
            compares = moved <= round_off_level and addresses[LEARN] == 0
            if not at_round_off and compares and stagnates(progress):
                # a single sample of round-off may be small by chance
                progress.felt = max(_round_off(packed, starts, steps, factors), progress.felt)
                at_round_off = progress.increment <= min(_FELT * progress.felt, _ASTRAY)
            # matrices do not contain the contacts of the end of the step
            known = incidences.nodes.shape[0] == 0 or progress.aside < _SMALL
            known = known and not touches
            done = at_round_off or converged(progress, tolerance, iteration, known)
            at_round_off = at_round_off and (stalled or moved <= own)
        progress.increment = larger(own, moved)
        if iteration == 1:
            progress.mark = progress.increment
        # with a matrix in each iteration, changing contacts may need more iterations
        watched = vectors or (touches and patience > 1)
        lost = watched and is_lost(progress, before) and moved > round_off_level
        # contacts that change in turns, which no matrix ends
        lost = lost or (touches and progress.stalls >= CYCLES)
        if done:
            # a correction at round-off is not applied: the accepted state must be consistent
            if not at_round_off:
                correct(packed, starts, steps)
                # moving cells by less than the digits of their positions does not change forces,
                # except for supported nodes
                residual(packed, starts, steps, supported or progress.increment > FINE)
            accept(packed, starts, steps)
            count(progress)
            progress.steps += 1
            progress.iteration = progress.asked = 0
        elif lost or iteration == limit or not progress.increment < 1e3:
            return FAILED
        else:
            if touches:
                shorten(x, progress.increment, progress.stalls)
            correct(packed, starts, steps)
            progress.previous = own
            progress.iteration += 1
    return DONE


@linked
def _round_off_level(packed: Indices, starts: Indices, steps: Indices) -> float:
    """Largest increment that may be round-off: far from the origin positions are less exact."""
    model, H, far = model_of(packed), state_of(starts).H, 0.0
    if not model.vectors:
        return ULPS
    for i in range(model.kinds.shape[0]):
        if has_position(model.kinds[i]):
            for j in range(3):
                far = max(far, abs(H[i, 0, j]) * model.measure[6 * i])
    return max(ULPS, 0.1 * ULPS * largest(ranks_of(model, step_of(steps)), far))


@linked
def _round_off(packed: Indices, starts: Indices, steps: Indices, factors: PlainFactors) -> float:
    """Change of the correction with the last digits of the unknowns.

    This is the effect of round-off in this scene and configuration. It is large if stiffness is
    large over inertia, if constraints are nearly dependent, or if positions are far from the
    origin. It does not depend on how well the matrix fits.
    """
    model, state, this = model_of(packed), state_of(starts), step_of(steps)
    held, measure, signs, ranks = model.held, model.measure, model.signs, ranks_of(model, this)
    H, multipliers, step, solution = state.H, state.multipliers, this.step, solution_of(this.r)
    kept, saved_multipliers, x = step.copy(), multipliers.copy(), solution.x.copy()
    n = step.shape[0]
    for i in range(n):
        position = load_row(H[i], 0)
        far = max(1.0, measure[6 * i] * sqrt(dot(position, position)))
        for k in range(6):
            step[i, k] += signs[6 * i + k] * _ULP * (far if k < 3 else 1.0) / measure[6 * i + k]
        hold(model.kinds[i], H[i], held[i], load(step[i], 0), load(step[i], 3), step[i])
    for c in range(multipliers.shape[0]):
        multipliers[c] *= 1.0 + signs[6 * n + c] * _ULP
    residual(packed, starts, steps, True)
    aside = this.border, this.turnings
    given = measure, model.scale, this.r, (factors, ranks), model.incidences, model.ends
    correction(*given, aside, (NEARLY, 0.0, 1.0))
    for k in range(x.shape[0]):
        solution.x[k] -= x[k]
    change = largest(ranks, size(measure, solution.x))
    put(kept, step)
    put(saved_multipliers, multipliers)
    residual(packed, starts, steps, True)
    put(x, solution.x)
    return change
