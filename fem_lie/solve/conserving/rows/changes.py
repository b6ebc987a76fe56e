"""Changes of elastic forces over a step, on nodes that are no frames, and their memory; compiled.

What :mod:`fem_lie.solve.conserving.step.dissipation` filters. Forces of a cell are known along
global axes and turn with it: those of the start, and what is remembered, are turned by its rotation
to the end of the step, where the change is told. What acts is turned back half-way and shrunk, as
elastic forces are (:mod:`.cells`), and freed of the resultant and of the moment about the mean that
this gives it.
"""

from __future__ import annotations

from typing import NamedTuple

from fem_lie._arrays import Array
from fem_lie._jit import compiled, inlined
from fem_lie.lie.tuples import (
    Vector,
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
from fem_lie.solve.conserving.between.cayley import half, turned
from fem_lie.solve.conserving.between.mean_forces import shrunk
from fem_lie.solve.conserving.rows.cells import (
    Nodes,
    Work,
    memory,
    part_of,
    rotation_of,
    set_out,
    solve_thin,
    take_centre,
)
from fem_lie.solve.conserving.rows.halves import (
    NOTHING,
    PLACES,
    CellTable,
    forces_of,
    gather,
    largest_cell,
)


class Lasting(NamedTuple):
    """Forces of all cells on both halves of each place, global components, (places, 2, 3) each.

    Attributes:
        start: At the start of the step.
        memory: Of changes, there.
        end: At the end, overwritten like the following.
        change: From the start, as the end has it.
        kept: The memory, as the end has it.
    """

    start: Array
    memory: Array
    end: Array
    change: Array
    kept: Array


@inlined
def _balance(cells: CellTable, e: int, work: Work) -> None:
    """Take the resultant and the moment about the mean out of ``work.f``, as far as none is due."""
    r, f, begin = work.r, work.f, cells.first[e]
    if cells.sees[e] < PLACES:
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
def _add(cells: CellTable, e: int, ω: Vector, given: Array, work: Work, out: Array) -> float:
    """Add forces (k, 2, 3), as the end has them, to those on all nodes; returns their work."""
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
    cells: CellTable, nodes: Nodes, lasting: Lasting, out: Array
) -> tuple[float, float]:
    """Add changes of elastic forces to ``out[0]`` and their memory to ``out[1]``.

    Args:
        cells: All cells.
        nodes: What they do.
        lasting: What of their forces is known, and becomes so.
        out: On both halves, (2, n, 6), updated.

    Returns:
        The works of both.
    """
    room = memory(largest_cell(cells.first))
    by_change = by_memory = 0.0
    for e in range(cells.sees.shape[0]):
        begin, end = cells.first[e], cells.first[e + 1]
        work = part_of(room, end - begin)
        set_out(cells, e, nodes, work)
        forces_of(cells, e, nodes.H, work.other, work.rows, lasting.end[begin:end])
        take_centre(cells, e, work.r)
        ω = (0.0, 0.0, 0.0)
        if cells.sees[e] < PLACES:
            take_centre(cells, e, work.d)
        if cells.sees[e] == NOTHING:
            ω = rotation_of(cells, e, work)
        for a in range(end - begin):
            for k in range(2):
                s = minus(load_row(work.d[a], k), cross(ω, load_row(work.r[a], k)))
                store_row(work.d[a], k, s)
                before = turned(ω, load_row(lasting.start[begin + a], k))
                change = minus(load_row(lasting.end[begin + a], k), before)
                store_row(lasting.change[begin + a], k, change)
                kept = turned(ω, load_row(lasting.memory[begin + a], k))
                store_row(lasting.kept[begin + a], k, kept)
        by_change += _add(cells, e, ω, lasting.change[begin:end], work, out[0])
        by_memory += _add(cells, e, ω, lasting.kept[begin:end], work, out[1])
    return by_change, by_memory


@compiled
def forces_at(cells: CellTable, H: Array, rest: Array, out: Array) -> None:
    """Forces (places, 2, 3) of all cells at rows ``H``."""
    room = memory(largest_cell(cells.first))
    for e in range(cells.sees.shape[0]):
        here = slice(cells.first[e], cells.first[e + 1])
        work = part_of(room, cells.first[e + 1] - cells.first[e])
        gather(cells.kinds[here], cells.nodes[here], H, rest, work.other)
        forces_of(cells, e, H, work.other, work.rows, out[here])
