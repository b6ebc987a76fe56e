"""Many steps with their rows of results in one compiled loop, as long as a kept matrix will do."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, linked
from fem_lie.linear.factors import PlainFactors
from fem_lie.solve.conserving.between.end_forces import at_end
from fem_lie.solve.conserving.step import loop
from fem_lie.solve.conserving.step.corrections import STEPS, TOTAL
from fem_lie.solve.conserving.step.packing import PackedModel, state_of
from fem_lie.solve.recording.result_row import close_row, fill_by_rates

ROW, WANTED, NEAR = 0, 1, 2
"""Of ``place``: next row of results, how many of the wanted ones there are, and whether an element
turns nearly too far in the last one."""


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
        place: Where the results are, see :data:`ROW`, (3,), updated.
        last: Step to reach; the end of an earlier one is where an element turns too far.
    """
    scene, rows, wanted = results
    _, _, (h, _, _) = model
    while counters[STEPS] < last:
        at = place[WANTED]
        to = wanted[at] if at < wanted.shape[0] else last
        code = loop.run(model, starts, steps, factors, options, counters, numbers, to)
        if code != loop.DONE:
            return code
        if at < wanted.shape[0]:
            place[NEAR] = _fill(starts, scene, rows, place[ROW], counters, h)
            place[ROW] += 1
            place[WANTED] += 1
            if place[NEAR]:
                return loop.DONE
    return loop.DONE


@compiled
def _fill(
    starts: Indices, scene: Indices, rows: Indices, row: int, counters: Indices, h: float
) -> bool:
    """Fill in a row with the present state; returns whether an element turns nearly too far."""
    s = state_of(starts)
    weights, v = s.weights, np.empty((s.V.shape[0], 6))
    if weights.shape[0] > 0:
        weights = at_end(s.weights, s.earlier, s.sizes)
    potential, springs, near = fill_by_rates(s.H, s.V, v, weights, s.books, scene, rows, row)
    close_row(rows, row, potential, springs + np.sum(s.W), counters[STEPS] * h, counters[TOTAL])
    return near
