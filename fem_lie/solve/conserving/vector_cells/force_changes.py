"""Changes of elastic forces over a step, which dissipation filters; metric and round-off of cells.

Forces of a cell are stored along global axes and rotate with it: the forces at the start, and the
filter state, are rotated with the cell to the end of the step, where the change is computed. The
filtered forces are rotated back to the midpoint and shrunk, as elastic forces are (:mod:`.cells`),
and their resultant and moment about the mean are removed.
:mod:`fem_lie.solve.conserving.step.dissipation` has the filter.

Constants of each cell are computed once: its metric, the invariance and the round-off of its
energy. All functions are compiled.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Flags
from fem_lie._jit import compiled, inlined
from fem_lie.lie.tuples import (
    Vector,
    combined,
    cross,
    dot,
    load,
    load_row,
    minus,
    plus,
    scaled,
    store,
    store_row,
)
from fem_lie.solve.conserving.midpoint.cayley import half, turned
from fem_lie.solve.conserving.midpoint.discrete_gradient import ROUND_OFF
from fem_lie.solve.conserving.midpoint.mean_forces import shrunk
from fem_lie.solve.conserving.vector_cells.cell_arrays import (
    DIRECTIONS,
    NOTHING,
    POSITIONS,
    VectorCells,
    energy_of,
    forces_of,
    gather,
    has_position,
    largest_cell,
)
from fem_lie.solve.conserving.vector_cells.cells import (
    Nodes,
    Work,
    part_of,
    rotation_of,
    set_out,
    solve_thin,
    take_centre,
    workspace_for,
)

_FEEL, _SEEN = 0.05, 1e-6
"""Displacements, in lengths of a cell, with which its invariance is tested, and the tolerance."""
_MIXED = (1 / 39) ** 2
"""Weight of a mixed derivative, times lengths, relative to that of a position: for Hermite's cubic
functions on an edge, gradients have 1/39 of the squares of positions, and this applies across
both."""
_NEXT, _SAMPLES, _USUAL = 1e-9, 6, 16.0
"""Displacements, in lengths of a cell, over which work and energy change are compared; their
number; and the allowed difference, as a multiple of the round-off of a well-conditioned energy."""


@compiled
def measure_cells(cells: VectorCells, lengths: Flags, H: Array, rest: Array) -> None:
    """Set the metric, invariance and energy error of all cells at nodes ``H``.

    Args:
        cells: Cells; ``weights``, ``sees`` and ``cancels`` are set.
        lengths: Which vectors of the nodes are lengths, others being dimensionless, (n, 2).
        H: All nodes, (≥ n, 4, 3).
        rest: Their digits beyond double precision, (≥ n, 4, 3).
    """
    workspace = workspace_for(largest_cell(cells.first))
    for e in range(cells.first.shape[0] - 1):
        here = slice(cells.first[e], cells.first[e + 1])
        work = part_of(workspace, cells.first[e + 1] - cells.first[e])
        gather(cells.kinds[here], cells.nodes[here], H, rest, work.r)
        take_centre(cells, e, work.r)
        _weigh(cells, lengths, e, work.r)
        cells.cancels[e] = _cancelled(cells, e, H, work)
        cells.sees[e] = _seen(cells, e, H, work)


@compiled
def weigh_cells(cells: VectorCells, lengths: Flags, H: Array, rest: Array) -> None:
    """Set the metric only, see :func:`measure_cells`."""
    workspace = workspace_for(largest_cell(cells.first))
    for e in range(cells.first.shape[0] - 1):
        here = slice(cells.first[e], cells.first[e + 1])
        work = part_of(workspace, cells.first[e + 1] - cells.first[e])
        gather(cells.kinds[here], cells.nodes[here], H, rest, work.r)
        take_centre(cells, e, work.r)
        _weigh(cells, lengths, e, work.r)


@inlined
def _weigh(cells: VectorCells, lengths: Flags, e: int, r: Array) -> None:
    """Metric: 1 for positions.

    A gradient of the usual size counts like a position at usual distance.
    """
    begin, far, long, positions, slopes = cells.first[e], 0.0, 0.0, 0, 0
    for a in range(r.shape[0]):
        for k in range(2):
            arm = load_row(r[a], k)
            if k == 0 and has_position(cells.kinds[begin + a]):
                far, positions = far + dot(arm, arm), positions + 1
            elif dot(arm, arm) > 0.0 and not lengths[cells.nodes[begin + a], k]:
                long, slopes = long + dot(arm, arm), slopes + 1
    share, mixed = far / positions * slopes / long if slopes > 0 else 0.0, _MIXED
    if far == 0.0:  # at one position there is no length, and gradients determine the rotation
        share, mixed = 1.0, 0.0
    for a in range(r.shape[0]):
        i = cells.nodes[begin + a]
        for k in range(2):
            is_position = k == 0 and has_position(cells.kinds[begin + a])
            cells.weights[begin + a, k] = 1.0 if is_position else mixed if lengths[i, k] else share


@inlined
def _shake(cells: VectorCells, e: int, r: Array, part: float, phase: float, out: Array) -> None:
    """Displace vectors ``r`` differently by the fraction ``part`` of the cell's size, into ``out``.

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
def _cancelled(cells: VectorCells, e: int, H: Array, work: Work) -> float:
    """Error of the energy of a cell beyond the round-off of its positions.

    Over a displacement of 1e-9 of the cell's size the mean of the forces at both ends does the work
    of the energy change, to 1e-27 of a stiffness: the difference between them is round-off.
    """
    r, f, here, error, usual = work.r, work.f, work.other, 0.0, 0.0
    forces_of(cells, e, H, r, work.coordinates, f)
    here[:] = r
    W = energy_of(cells, e, H, here, work.coordinates)
    for sample in range(_SAMPLES):
        _shake(cells, e, r, _NEXT, 7.0 * sample, here)
        forces_of(cells, e, H, here, work.coordinates, work.d)
        change, done = energy_of(cells, e, H, here, work.coordinates) - W, 0.0
        for a in range(r.shape[0]):
            for k in range(2):
                push, arm = load_row(work.d[a], k), load_row(here[a], k)
                mean = combined(0.5, load_row(f[a], k), 0.5, push)
                done += dot(mean, minus(arm, load_row(r[a], k)))
                usual += ROUND_OFF * sqrt(dot(push, push) * dot(arm, arm))
        error = max(error, abs(change - done))
    return error if error > _USUAL * usual / _SAMPLES else 0.0


@inlined
def _seen(cells: VectorCells, e: int, H: Array, work: Work) -> int:
    """Invariance of a cell: whether its forces, slightly deformed, have a resultant or a moment."""
    r, f, begin = work.r, work.f, cells.first[e]
    _shake(cells, e, r, _FEEL, 0.0, r)
    forces_of(cells, e, H, r, work.coordinates, f)
    force, moment, sizes, moments = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0, 0.0
    for a in range(r.shape[0]):
        for k in range(2):
            push, arm = load_row(f[a], k), load_row(r[a], k)
            if k == 0 and has_position(cells.kinds[begin + a]):
                force, sizes = plus(force, push), sizes + sqrt(dot(push, push))
            moment = plus(moment, cross(arm, push))
            moments += sqrt(dot(arm, arm) * dot(push, push))
    if dot(force, force) > (_SEEN * sizes) ** 2:
        return POSITIONS
    return DIRECTIONS if dot(moment, moment) > (_SEEN * moments) ** 2 else NOTHING


class CellForces(NamedTuple):
    """Forces of all cells on both vectors of each node, global components, (cell nodes, 2, 3) each.

    Attributes:
        start: Forces at the start of the step.
        filter_state: Filter state at the start.
        end: Forces at the end, overwritten like the following.
        change: Change from the start, rotated to the end.
        kept: Filter state, rotated to the end.
    """

    start: Array
    filter_state: Array
    end: Array
    change: Array
    kept: Array


@inlined
def _balance(cells: VectorCells, e: int, work: Work) -> None:
    """Remove resultant and moment about the mean from ``work.f``, as invariance demands."""
    r, f, begin = work.r, work.f, cells.first[e]
    if cells.sees[e] < POSITIONS:
        take_centre(cells, e, f)
    if cells.sees[e] == NOTHING:
        moment = (0.0, 0.0, 0.0)
        for a in range(r.shape[0]):
            for k in range(2):
                moment = plus(moment, cross(load_row(r[a], k), load_row(f[a], k)))
        w = solve_thin(work.A, moment)
        for a in range(r.shape[0]):
            for k in range(2):
                push = scaled(cells.weights[begin + a, k], cross(w, load_row(r[a], k)))
                store_row(f[a], k, minus(load_row(f[a], k), push))


@inlined
def _add(cells: VectorCells, e: int, ω: Vector, given: Array, work: Work, out: Array) -> float:
    """Add forces (k, 2, 3), rotated to the end, to those on all nodes; returns their work."""
    begin, back, made = cells.first[e], scaled(-1.0, half(ω)), 0.0
    for a in range(given.shape[0]):
        for k in range(2):
            store_row(work.f[a], k, shrunk(ω, turned(back, load_row(given[a], k))))
    _balance(cells, e, work)
    for a in range(given.shape[0]):
        i = cells.nodes[begin + a]
        for k in range(2):
            push = load_row(work.f[a], k)
            made += dot(push, load_row(work.d[a], k))
            store(out[i], 3 * k, plus(load(out[i], 3 * k), push))
    return made


@compiled
def add_changes(
    cells: VectorCells, nodes: Nodes, cell_forces: CellForces, out: Array
) -> tuple[float, float]:
    """Add changes of elastic forces to ``out[0]`` and their filter state to ``out[1]``.

    Args:
        cells: All cells.
        nodes: Nodes and increments.
        cell_forces: Forces and filter state, updated.
        out: Forces on both vectors, (2, n, 6), updated.

    Returns:
        The works of both.
    """
    workspace = workspace_for(largest_cell(cells.first))
    by_change = by_filter = 0.0
    for e in range(cells.sees.shape[0]):
        begin, end = cells.first[e], cells.first[e + 1]
        work = part_of(workspace, end - begin)
        set_out(cells, e, nodes, work)
        forces_of(cells, e, nodes.H, work.other, work.coordinates, cell_forces.end[begin:end])
        take_centre(cells, e, work.r)
        ω = (0.0, 0.0, 0.0)
        if cells.sees[e] < POSITIONS:
            take_centre(cells, e, work.d)
        if cells.sees[e] == NOTHING:
            ω = rotation_of(cells, e, work)
        for a in range(end - begin):
            for k in range(2):
                s = minus(load_row(work.d[a], k), cross(ω, load_row(work.r[a], k)))
                store_row(work.d[a], k, s)
                before = turned(ω, load_row(cell_forces.start[begin + a], k))
                change = minus(load_row(cell_forces.end[begin + a], k), before)
                store_row(cell_forces.change[begin + a], k, change)
                kept = turned(ω, load_row(cell_forces.filter_state[begin + a], k))
                store_row(cell_forces.kept[begin + a], k, kept)
        by_change += _add(cells, e, ω, cell_forces.change[begin:end], work, out[0])
        by_filter += _add(cells, e, ω, cell_forces.kept[begin:end], work, out[1])
    return by_change, by_filter


@compiled
def forces_at(cells: VectorCells, H: Array, rest: Array, out: Array) -> None:
    """Forces (cell nodes, 2, 3) of all cells at nodes ``H``."""
    workspace = workspace_for(largest_cell(cells.first))
    for e in range(cells.sees.shape[0]):
        here = slice(cells.first[e], cells.first[e + 1])
        work = part_of(workspace, cells.first[e + 1] - cells.first[e])
        gather(cells.kinds[here], cells.nodes[here], H, rest, work.other)
        forces_of(cells, e, H, work.other, work.coordinates, out[here])
