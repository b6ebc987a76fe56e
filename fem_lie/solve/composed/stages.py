"""All parts of composed steps in one compiled loop, as long as the kept matrices will do."""

from __future__ import annotations

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, linked
from fem_lie.linear.factors import PlainFactors
from fem_lie.solve.conserving.step import loop
from fem_lie.solve.conserving.step.corrections import STEPS
from fem_lie.solve.conserving.step.packing import PackedModel, state_of

MADE, PART, SIZE = 0, 1, 2
"""Of ``place``: whole steps made, parts of the present one, and the size for which the state is."""


@compiled
def resize(carry: Array, before: float, h: float) -> None:
    """What round-off has left over is an impulse: as a force it depends on the size of the step."""
    ratio = before / h
    for i in range(carry.shape[0]):
        for k in range(carry.shape[1]):
            carry[i, k] *= ratio


@linked
def run(
    models: tuple[PackedModel, PackedModel],
    starts: Indices,
    steps: Indices,
    factors: tuple[PlainFactors, PlainFactors],
    options: tuple[float, int, int, float, float],
    counters: Indices,
    numbers: Array,
    sizes: tuple[Array, Indices],
    place: Indices,
    last: int,
) -> int:
    """Go on until step ``last``, or until a part wants a new matrix or fails.

    Args:
        models: Of each of the two sizes of parts, see
            :class:`~fem_lie.solve.conserving.step.packing.Packed`.
        starts: The state.
        steps: The present part.
        factors: Of the matrix of each size.
        options: See :func:`fem_lie.solve.conserving.step.loop.run`.
        counters: Of each size, (2, 8), updated.
        numbers: Of each size, (2, 11), updated.
        sizes: Both, and which of them each part has, (2,) and (parts,).
        place: Where the run is, (3,), see :data:`MADE`; updated.
        last: Whole steps to be made.
    """
    h, order = sizes
    while place[MADE] < last:
        while place[PART] < order.shape[0]:
            k = order[place[PART]]
            if place[SIZE] != k:
                resize(state_of(starts).carry, h[place[SIZE]], h[k])
                place[SIZE] = k
            to = counters[k, STEPS] + 1
            given = starts, steps, factors[k], options
            code = loop.run(models[k], *given, counters[k], numbers[k], to)
            if code != loop.DONE:
                return code
            place[PART] += 1
        place[PART] = 0
        place[MADE] += 1
    return loop.DONE
