"""What cells are told once: their metric, and what of space they see; compiled."""

from __future__ import annotations

from math import sqrt

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled, inlined
from fem_lie.lie.tuples import cross, dot, load_row, plus
from fem_lie.solve.conserving.rows.cells import Work, memory, part_of, take_centre
from fem_lie.solve.conserving.rows.halves import (
    DIRECTIONS,
    NOTHING,
    PLACES,
    CellTable,
    forces_of,
    gather,
    has_place,
    largest_cell,
)

_FEEL, _SEEN = 0.05, 1e-6
"""Motions, in lengths of a cell, by which it is seen whether forces balance, and to what."""


@compiled
def measure_cells(cells: CellTable, H: Array, rest: Array) -> None:
    """Find the weights of all cells, and what of space they see, at rows ``H``."""
    room = memory(largest_cell(cells.first))
    for e in range(cells.first.shape[0] - 1):
        here = slice(cells.first[e], cells.first[e + 1])
        work = part_of(room, cells.first[e + 1] - cells.first[e])
        gather(cells.kinds[here], cells.nodes[here], H, rest, work.r)
        take_centre(cells, e, work.r)
        _weigh(cells, e, work.r)
        cells.sees[e] = _seen(cells, e, H, work)


@compiled
def weigh_cells(cells: CellTable, H: Array, rest: Array) -> None:
    """Find the weights alone."""
    room = memory(largest_cell(cells.first))
    for e in range(cells.first.shape[0] - 1):
        here = slice(cells.first[e], cells.first[e + 1])
        work = part_of(room, cells.first[e + 1] - cells.first[e])
        gather(cells.kinds[here], cells.nodes[here], H, rest, work.r)
        take_centre(cells, e, work.r)
        _weigh(cells, e, work.r)


@inlined
def _weigh(cells: CellTable, e: int, r: Array) -> None:
    """1 for places; as much for a slope of the usual size as for a place at the usual distance."""
    begin, far, long, places, slopes = cells.first[e], 0.0, 0.0, 0, 0
    for a in range(r.shape[0]):
        for k in range(2):
            arm = load_row(r[a], k)
            if k == 0 and has_place(cells.kinds[begin + a]):
                far, places = far + dot(arm, arm), places + 1
            elif dot(arm, arm) > 0.0:
                long, slopes = long + dot(arm, arm), slopes + 1
    share = far / places * slopes / long if slopes > 0 else 0.0
    if far == 0.0:  # all are at one place
        share = 1.0
    for a in range(r.shape[0]):
        kind = cells.kinds[begin + a]
        cells.weights[begin + a, 0] = 1.0 if has_place(kind) else share
        cells.weights[begin + a, 1] = share


@inlined
def _seen(cells: CellTable, e: int, H: Array, work: Work) -> int:
    """What a cell sees: whether its forces, a little deformed, have a resultant or a moment."""
    r, f, begin, phase, ρ2 = work.r, work.f, cells.first[e], 0.0, 0.0
    for a in range(r.shape[0]):
        for k in range(2):
            ρ2 += cells.weights[begin + a, k] * dot(load_row(r[a], k), load_row(r[a], k))
    for a in range(r.shape[0]):
        for k in range(2):
            weight = cells.weights[begin + a, k]
            size = _FEEL * sqrt(ρ2 / (weight * r.shape[0])) if weight > 0.0 else 0.0
            for j in range(3):
                phase += 1.0
                r[a, k, j] += size * np.cos(phase)
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
