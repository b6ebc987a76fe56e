"""Elastic forces of a step on cells of position nodes only; compiled.

The method is that of :mod:`.cells`, specialised to edges and bends of ropes and nets: half of the
coordinates of other nodes, no axes to rotate, and the rotation of an edge in closed form. A net has
tens of thousands of these cells, and its steps spend nearly all their time on them.
"""

from __future__ import annotations

from math import sqrt

from fem_lie._arrays import Array
from fem_lie._jit import compiled, inlined_uncounted, uncounted
from fem_lie._jit.stack import blocks_at, stack, vector_at
from fem_lie.forms.cell_forms import coefficients
from fem_lie.forms.kernels.addresses import Pointer, call_kernel, pointer
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
from fem_lie.solve.conserving.midpoint.mean_forces import add_resistance, shrunk, unshrunk
from fem_lie.solve.conserving.vector_cells.cell_arrays import (
    ENERGY,
    FORCES,
    NOTHING,
    POSITIONS,
    VectorCells,
    are_positions,
    largest_cell,
    workspace_size,
)
from fem_lie.solve.conserving.vector_cells.cells import (
    Energies,
    Nodes,
    Work,
    additional_factor,
    solve_thin,
    workspace_for,
)


@inlined_uncounted
def _ask(
    cells: VectorCells, e: int, which: int, positions: Array, count: int, found: Pointer
) -> None:
    """Add the energy, or forces (k, 6), of a cell at positions (k, 2, 3), along global axes."""
    calls = cells.calls[e, which]
    w = coefficients(calls[1], calls[4], calls[5], stack(workspace_size(calls)))
    coordinates = blocks_at(w, count, 4, 3)
    for a in range(count):
        store_row(coordinates[a], 0, load_row(positions[a], 0))
        store_row(coordinates[a], 1, (1.0, 0.0, 0.0))
        store_row(coordinates[a], 2, (0.0, 1.0, 0.0))
        store_row(coordinates[a], 3, (0.0, 0.0, 1.0))
    call_kernel(calls[0], found, w, pointer(calls[2]), pointer(calls[3]))


@inlined_uncounted
def _set_out(cells: VectorCells, e: int, nodes: Nodes, count: int, work: Work) -> None:
    """Means ``r`` and increments ``d`` relative to their centres, and positions at the end."""
    H, rest, step = nodes
    begin, first = cells.first[e], cells.nodes[cells.first[e]]
    x, digits, origin = load_row(H[first], 0), load_row(rest[first], 0), load(step[first], 0)
    mean = centre = (0.0, 0.0, 0.0)
    for a in range(count):
        i = cells.nodes[begin + a]
        # differences of the large parts are exact, those of the small parts have all digits
        start = plus(minus(load_row(H[i], 0), x), minus(load_row(rest[i], 0), digits))
        seen = minus(load(step[i], 0), origin)
        middle = combined(1.0, start, 0.5, seen)
        store_row(work.d[a], 0, seen)
        store_row(work.r[a], 0, middle)
        store_row(work.other[a], 0, plus(start, seen))
        mean, centre = plus(mean, seen), plus(centre, middle)
    mean, centre = scaled(1.0 / count, mean), scaled(1.0 / count, centre)
    back = mean
    if cells.sees[e] == POSITIONS:
        back = scaled(-1.0, origin)
    for a in range(count):
        store_row(work.d[a], 0, minus(load_row(work.d[a], 0), back))
        store_row(work.r[a], 0, minus(load_row(work.r[a], 0), centre))


@inlined_uncounted
def _turn(work: Work, count: int) -> Vector:
    """Best fit of a rotation to the increments ``d`` of the means ``r``, as a Cayley vector."""
    r, d, A, b, square = work.r, work.d, work.A, (0.0, 0.0, 0.0), 0.0
    for a in range(count):
        arm = load_row(r[a], 0)
        b, square = plus(b, cross(arm, load_row(d[a], 0))), square + dot(arm, arm)
    if count == 2:
        # nodes on a line, to which b is perpendicular
        return scaled(1.0 / square, b) if square > 0.0 else b
    A[:] = 0.0
    for a in range(count):
        add_resistance(A, 1.0, load_row(r[a], 0))
    return solve_thin(A, b)


@compiled
def add_position_cells(
    cells: VectorCells,
    nodes: Nodes,
    energies: Energies,
    factors: tuple[float, float, float],
    out: Array,
) -> float:
    """Add the elastic forces of a step of cells of position nodes to ``out``, and of no others.

    Args:
        cells: All cells.
        nodes: Nodes and increments.
        energies: Energies of the cells.
        factors: As in :func:`~fem_lie.solve.conserving.vector_cells.cells.add_elastic`.
        out: Forces on both vectors, (n, 6), updated.

    Returns:
        The sum of ``|s|²``.
    """
    return _add_all(cells, nodes, energies, factors, workspace_for(largest_cell(cells.first)), out)


@uncounted
def _add_all(
    cells: VectorCells,
    nodes: Nodes,
    energies: Energies,
    factors: tuple[float, float, float],
    work: Work,
    out: Array,
) -> float:
    """The same with a workspace for a cell."""
    size = 6 * work.r.shape[0]
    buffer = stack(size)
    found, squares = vector_at(buffer, size), 0.0
    for e in range(cells.sees.shape[0]):
        begin, count = cells.first[e], cells.first[e + 1] - cells.first[e]
        if not are_positions(cells, e):
            continue
        _set_out(cells, e, nodes, count, work)
        found[0] = 0.0
        _ask(cells, e, ENERGY, work.other, count, buffer)
        energies.end[e] = found[0]
        ω = _turn(work, count) if cells.sees[e] == NOTHING else (0.0, 0.0, 0.0)
        for a in range(count):
            store_row(work.other[a], 0, unshrunk(ω, load_row(work.r[a], 0)))
        for k in range(6 * count):
            found[k] = 0.0
        _ask(cells, e, FORCES, work.other, count, buffer)
        made = square = round_off_level = ρ2 = 0.0
        for a in range(count):
            arm, push = load_row(work.r[a], 0), shrunk(ω, load(found, 6 * a))
            s = minus(load_row(work.d[a], 0), cross(ω, arm))
            store_row(work.d[a], 0, s)
            store_row(work.f[a], 0, push)
            made, square = made + dot(push, s), square + dot(s, s)
            reach = dot(arm, arm)
            round_off_level += sqrt(dot(push, push) * reach)
            ρ2 += reach / count
        known = (made, square, round_off_level, ρ2, cells.cancels[e])
        factor = additional_factor(energies, e, factors, known)
        squares += square
        whole_factor = factor + factors[0]
        for a in range(count):
            i = cells.nodes[begin + a]
            push = combined(1.0, load_row(work.f[a], 0), whole_factor, load_row(work.d[a], 0))
            store(out[i], 0, plus(load(out[i], 0), push))
    return squares
