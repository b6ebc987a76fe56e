"""What is found of each cell once: its metric, what of space it sees, the round-off of its energy.

Compiled.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from fem_lie._arrays import Array, Flags
from fem_lie._jit import compiled, inlined
from fem_lie.lie.tuples import combined, cross, dot, load_row, minus, plus
from fem_lie.solve.conserving.between.discrete_gradient import ROUND_OFF
from fem_lie.solve.conserving.rows.cells import Work, memory, part_of, take_centre
from fem_lie.solve.conserving.rows.halves import (
    DIRECTIONS,
    NOTHING,
    PLACES,
    CellTable,
    energy_of,
    forces_of,
    gather,
    has_place,
    largest_cell,
)

_FEEL, _SEEN = 0.05, 1e-6
"""Motions, in lengths of a cell, by which it is seen whether forces balance, and to what."""
_MIXED = (1 / 39) ** 2
"""Weight of a mixed derivative, times lengths, beside that of a place: of the squares of Hermite's
cubic functions on an edge, slopes have 1/39 of what places have, and this is across both."""
_NEXT, _SAMPLES, _USUAL = 1e-9, 6, 16.0
"""Motions, in lengths of a cell, whose work is compared with the change of its energy; how many;
and how many times the round-off of a well-written energy the difference may be."""


@compiled
def measure_cells(cells: CellTable, lengths: Flags, H: Array, rest: Array) -> None:
    """Set the weights of all cells, what they see of space, and what cancels, at rows ``H``.

    Args:
        cells: Their ``weights``, ``sees`` and ``cancels`` are set.
        lengths: Which halves of the nodes are lengths, others having no dimension, (n, 2).
        H: Rows of all nodes, (≥ n, 4, 3).
        rest: Digits of these that do not fit into them, (≥ n, 4, 3).
    """
    room = memory(largest_cell(cells.first))
    for e in range(cells.first.shape[0] - 1):
        here = slice(cells.first[e], cells.first[e + 1])
        work = part_of(room, cells.first[e + 1] - cells.first[e])
        gather(cells.kinds[here], cells.nodes[here], H, rest, work.r)
        take_centre(cells, e, work.r)
        _weigh(cells, lengths, e, work.r)
        cells.cancels[e] = _cancelled(cells, e, H, work)
        cells.sees[e] = _seen(cells, e, H, work)


@compiled
def weigh_cells(cells: CellTable, lengths: Flags, H: Array, rest: Array) -> None:
    """Set the weights alone, see :func:`measure_cells`."""
    room = memory(largest_cell(cells.first))
    for e in range(cells.first.shape[0] - 1):
        here = slice(cells.first[e], cells.first[e + 1])
        work = part_of(room, cells.first[e + 1] - cells.first[e])
        gather(cells.kinds[here], cells.nodes[here], H, rest, work.r)
        take_centre(cells, e, work.r)
        _weigh(cells, lengths, e, work.r)


@inlined
def _weigh(cells: CellTable, lengths: Flags, e: int, r: Array) -> None:
    """1 for places; as much for a slope of the usual size as for a place at the usual distance."""
    begin, far, long, places, slopes = cells.first[e], 0.0, 0.0, 0, 0
    for a in range(r.shape[0]):
        for k in range(2):
            arm = load_row(r[a], k)
            if k == 0 and has_place(cells.kinds[begin + a]):
                far, places = far + dot(arm, arm), places + 1
            elif dot(arm, arm) > 0.0 and not lengths[cells.nodes[begin + a], k]:
                long, slopes = long + dot(arm, arm), slopes + 1
    share, mixed = far / places * slopes / long if slopes > 0 else 0.0, _MIXED
    if far == 0.0:  # at one position there is no length, and slopes say all of a rotation
        share, mixed = 1.0, 0.0
    for a in range(r.shape[0]):
        i = cells.nodes[begin + a]
        for k in range(2):
            place = k == 0 and has_place(cells.kinds[begin + a])
            cells.weights[begin + a, k] = 1.0 if place else mixed if lengths[i, k] else share


@inlined
def _shake(cells: CellTable, e: int, r: Array, part: float, phase: float, out: Array) -> None:
    """Set ``out`` to halves ``r`` that are moved by that part of the cell's size, each otherwise.

    ``out`` may be ``r``.
    """
    begin, ρ2 = cells.first[e], 0.0
    for a in range(r.shape[0]):
        for k in range(2):
            ρ2 += cells.weights[begin + a, k] * dot(load_row(r[a], k), load_row(r[a], k))
    for a in range(r.shape[0]):
        for k in range(2):
            weight = cells.weights[begin + a, k]
            size = part * sqrt(ρ2 / (weight * r.shape[0])) if weight > 0.0 else 0.0
            for j in range(3):
                phase += 1.0
                out[a, k, j] = r[a, k, j] + size * np.cos(phase)


@inlined
def _cancelled(cells: CellTable, e: int, H: Array, work: Work) -> float:
    """Error of the energy of a cell beyond that which round-off of its positions makes.

    Over a motion by 1e-9 of the cell's size the mean of the forces at both ends does the work by
    which the energy changes, to 1e-27 of a stiffness: what is between them is round-off.
    """
    r, f, here, error, usual = work.r, work.f, work.other, 0.0, 0.0
    forces_of(cells, e, H, r, work.rows, f)
    here[:] = r
    W = energy_of(cells, e, H, here, work.rows)
    for sample in range(_SAMPLES):
        _shake(cells, e, r, _NEXT, 7.0 * sample, here)
        forces_of(cells, e, H, here, work.rows, work.d)
        change, done = energy_of(cells, e, H, here, work.rows) - W, 0.0
        for a in range(r.shape[0]):
            for k in range(2):
                push, arm = load_row(work.d[a], k), load_row(here[a], k)
                mean = combined(0.5, load_row(f[a], k), 0.5, push)
                done += dot(mean, minus(arm, load_row(r[a], k)))
                usual += ROUND_OFF * sqrt(dot(push, push) * dot(arm, arm))
        error = max(error, abs(change - done))
    return error if error > _USUAL * usual / _SAMPLES else 0.0


@inlined
def _seen(cells: CellTable, e: int, H: Array, work: Work) -> int:
    """What a cell sees: whether its forces, a little deformed, have a resultant or a moment."""
    r, f, begin = work.r, work.f, cells.first[e]
    _shake(cells, e, r, _FEEL, 0.0, r)
    forces_of(cells, e, H, r, work.rows, f)
    force, moment, sizes, moments = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0, 0.0
    for a in range(r.shape[0]):
        for k in range(2):
            push, arm = load_row(f[a], k), load_row(r[a], k)
            if k == 0 and has_place(cells.kinds[begin + a]):
                force, sizes = plus(force, push), sizes + sqrt(dot(push, push))
            moment = plus(moment, cross(arm, push))
            moments += sqrt(dot(arm, arm) * dot(push, push))
    if dot(force, force) > (_SEEN * sizes) ** 2:
        return PLACES
    return DIRECTIONS if dot(moment, moment) > (_SEEN * moments) ** 2 else NOTHING
