"""Many steps with their rows of results in one compiled loop, as long as a kept matrix will do."""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled, linked
from fem_lie.linear.factors import PlainFactors
from fem_lie.solve.conserving.between.any_node import twists
from fem_lie.solve.conserving.between.end_forces import at_end, rates_at_end
from fem_lie.solve.conserving.step import loop
from fem_lie.solve.conserving.step.corrections import STEPS, TOTAL
from fem_lie.solve.conserving.step.packing import PackedModel, model_of, state_of
from fem_lie.solve.recording.result_row import close_row, fill_by_both
from fem_lie.system.nodes.fixed_axes import wrenches
from fem_lie.system.nodes.sums import residual

PlainSupports: TypeAlias = tuple[Indices, Array, Flags, Indices, Array, Array]
"""A :class:`Supports`, as compiled functions are quicker to call with."""

ROW, WANTED, NEAR = 0, 1, 2
"""Of ``place``: next row of results, how many of the wanted ones there are, and whether an element
turns nearly too far in the last one."""


class Supports(NamedTuple):
    """What reactions of a state are made of.

    Attributes:
        table: For the sum of all forces, see :func:`fem_lie.system.nodes.sums.residual`.
        turning: Of directors, see :func:`~fem_lie.lie.kinds.inertia.turning_of`.
        held: Which unknowns are zero, (n, 6).
        nodes: Those that are held from outside, (s,).
        rows: Reactions of all rows, (rows, s, 6); no rows if nobody asks for them.
        ones: Factors of the constraints, (m,).
    """

    table: Indices
    turning: Array
    held: Flags
    nodes: Indices
    rows: Array
    ones: Array


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
    supports: PlainSupports,
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
        supports: Whose reactions are in rows, see :class:`Supports`.
        place: Where the results are, see :data:`ROW`, (3,), updated.
        last: Step to reach; the end of an earlier one is where an element turns too far.
    """
    wanted = results[2]
    while counters[STEPS] < last:
        at = place[WANTED]
        to = wanted[at] if at < wanted.shape[0] else last
        code = loop.run(model, starts, steps, factors, options, counters, numbers, to)
        if code != loop.DONE:
            return code
        if at < wanted.shape[0]:
            place[NEAR] = _fill(model, starts, results[:2], supports[1], place[ROW], counters)
            if supports[4].shape[0] > 0:
                _fill_reactions(model, starts, supports, place[ROW])
            place[ROW] += 1
            place[WANTED] += 1
            if place[NEAR]:
                return loop.DONE
    return loop.DONE


@compiled
def _fill(
    packed: PackedModel,
    starts: Indices,
    results: tuple[Indices, Indices],
    turning: Array,
    row: int,
    counters: Indices,
) -> bool:
    """Fill in a row with the present state; returns whether an element turns nearly too far."""
    s, (scene, rows), (_, _, (h, _, _)) = state_of(starts), results, packed
    kinds = model_of(packed).kinds
    weights, n = s.weights, kinds.shape[0]
    room = np.zeros((3, n, 6))
    v, unused, still = room[0], room[1], room[2]
    twists(kinds, turning, s.H, s.V[:n], still, v, unused)
    if weights.shape[0] > 0:
        weights = at_end(s.weights, s.earlier, s.sizes)
    potential, springs, near = fill_by_both(s.H, v, s.V, weights, s.books, scene, rows, row)
    close_row(rows, row, potential, springs + np.sum(s.W), counters[STEPS] * h, counters[TOTAL])
    return near


@compiled
def _fill_reactions(
    packed: PackedModel, starts: Indices, supports: PlainSupports, row: int
) -> None:
    """Fill in the reactions of the present state, by the equations of motion there."""
    (table, turning, held, nodes, rows, ones), s = supports, state_of(starts)
    kinds, n = model_of(packed).kinds, s.rates.shape[1]
    rates, v, a = np.empty((n, 6)), np.empty((n, 6)), np.empty((n, 6))
    r, weights = np.empty(6 * n + s.weights.shape[0]), s.weights
    if weights.shape[0] > 0:
        weights = at_end(s.weights, s.earlier, s.sizes)
    rates_at_end(s.rates, s.sizes, rates)
    twists(kinds, turning, s.H, s.V[:n], rates, v, a)
    residual(s.H, v, a, weights, ones, r, table)
    rows[row] = wrenches(kinds, s.H, r[: 6 * n].reshape(n, 6), held, nodes)
