"""Elastic forces of a step on nodes with vector coordinates, whose work is the energy change.

For *any* cell with an objective energy ``W``, known by its energy and its nodal forces alone. The
rows of its nodes are vectors ``r`` that turn with a rigid motion, places from their centre. Of one
step with means ``r̄`` and increments ``Δr``::

    f = C f(C⁻¹ r̄) + (ΔW − f·s)/|s|² M s

1. *Mean.* The rigid part of the step, a translation and a rotation, is fitted in a metric ``M``
   (1 on places, a length squared on slopes). With the rotation ``Q`` half-way, means of vectors
   that turn are shrunk by ``C = ½ (Q + Qᵀ)``: without that a cell that turns by θ had a strain of
   ``θ²/8``. Forces at the unshrunk mean have neither resultant nor moment about it, and as
   ``(C a) × (C b) = det(C) C⁻¹ (a × b)``, those above have none about the mean: whatever C is, to
   round-off, and so without any balance of small differences, which straight lines do not allow.
2. *Energy.* ``s`` is the step without its rigid part, so that ``M s`` has no resultant and no
   moment; the factor is that of Gonzalez' discrete gradient (J. Nonlinear Sci. 6 (1996) 449) in the
   quotient by rigid motions. It is of third order in the deformation of the step.

Cells that see directions fixed in space, such as a clamped end of a discrete rod, have no moment to
keep: ``C = 1``, and ``s`` is the step without its translation.

What of energies is round-off is left out, and made up as in
:mod:`fem_lie.solve.conserving.midpoint.discrete_gradient`.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled, inlined, inlined_uncounted, uncounted
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
from fem_lie.solve.conserving.midpoint.discrete_gradient import KNOWN, ROUND_OFF, beyond, factor_of
from fem_lie.solve.conserving.midpoint.mean_forces import (
    add_resistance,
    shrunk,
    solve_symmetric,
    unshrunk,
)
from fem_lie.solve.conserving.vector_cells.cell_table import (
    NOTHING,
    POSITIONS,
    CellTable,
    are_positions,
    energy_of,
    forces_of,
    gather,
    has_position,
    largest_cell,
)


class Energies(NamedTuple):
    """Of all cells, each of shape (M,).

    Attributes:
        start: Stored at the start of the step.
        account: Work done on them up to there.
        end: Stored at the end, overwritten.
        work: Done in the step, overwritten.
    """

    start: Array
    account: Array
    end: Array
    work: Array


@inlined_uncounted
def factor_beside(
    energies: Energies,
    e: int,
    factors: tuple[float, float, float],
    known: tuple[float, float, float, float, float],
) -> float:
    """Factor of ``M s`` by which a cell's work is the change of its energy; notes the work.

    Args:
        energies: Of all cells, with that at the end of this one.
        e: The cell.
        factors: As of :func:`add_elastic`.
        known: Work of the mean forces, ``|s|²``, what round-off of forces goes by, the cell's size
            squared, and the error of its energy where that is a difference of larger numbers.
    """
    (_, typical, unknown), (made, square, round_off_level, ρ2, cancels) = factors, known
    round_off_level = ROUND_OFF * round_off_level + unknown + cancels
    debt = energies.start[e] - energies.account[e]
    missing = beyond(energies.end[e] - energies.start[e] - made, KNOWN * round_off_level)
    missing += debt if abs(debt) > round_off_level else 0.0
    factor = factor_of(
        missing, KNOWN * round_off_level, square, max(0.01 * typical, ROUND_OFF * ρ2)
    )
    energies.work[e] = made + factor * square
    return factor


_THIN = 1e-12
"""Of the metric of rotations, about an axis along which all of a cell lies."""
_SWEEPS = 3
"""That make good for it about the others."""


class Work(NamedTuple):
    """Memory for one cell after the other.

    Attributes:
        r: Halves of its nodes at the mean, from the centre, (k, 2, 3), as the next three.
        d: Increments, then those without the rigid part.
        f: Forces.
        other: Halves at which something is asked for.
        rows: Rows of the nodes, (k, 4, 3).
        A: Metric of rotations, (3, 3).
    """

    r: Array
    d: Array
    f: Array
    other: Array
    rows: Array
    A: Array


@compiled
def memory(most: int) -> Work:
    """For cells of that many nodes."""
    halves = np.empty((4, most, 2, 3))
    A = np.empty((3, 3))
    return Work(halves[0], halves[1], halves[2], halves[3], np.empty((most, 4, 3)), A)


@inlined
def part_of(work: Work, count: int) -> Work:
    """That of it which so many nodes take."""
    r, d, f, other, rows, A = work
    return Work(r[:count], d[:count], f[:count], other[:count], rows[:count], A)


@uncounted
def take_centre(cells: CellTable, e: int, halves: Array) -> Vector:
    """Take the mean of the places out of halves (k, 2, 3); returns it."""
    begin, count, centre = cells.first[e], 0, (0.0, 0.0, 0.0)
    for a in range(halves.shape[0]):
        if has_position(cells.kinds[begin + a]):
            centre, count = plus(centre, load_row(halves[a], 0)), count + 1
    centre = scaled(1.0 / max(count, 1), centre)
    for a in range(halves.shape[0]):
        if has_position(cells.kinds[begin + a]):
            store_row(halves[a], 0, minus(load_row(halves[a], 0), centre))
    return centre


@inlined_uncounted
def solve_thin(A: Array, b: Vector) -> Vector:
    """``A⁻¹ b`` of a metric of rotations (3, 3), nothing about an axis along which all lies."""
    thin = _THIN * (A[0, 0] + A[1, 1] + A[2, 2])
    if thin == 0.0:
        return 0.0, 0.0, 0.0
    for k in range(3):
        A[k, k] += thin
    ω = solve_symmetric(A, b)
    for _ in range(_SWEEPS):
        left = (
            b[0] - (A[0, 0] - thin) * ω[0] - A[0, 1] * ω[1] - A[0, 2] * ω[2],
            b[1] - A[1, 0] * ω[0] - (A[1, 1] - thin) * ω[1] - A[1, 2] * ω[2],
            b[2] - A[2, 0] * ω[0] - A[2, 1] * ω[1] - (A[2, 2] - thin) * ω[2],
        )
        ω = plus(ω, solve_symmetric(A, left))
    for k in range(3):
        A[k, k] -= thin
    return ω


@uncounted
def rotation_of(cells: CellTable, e: int, work: Work) -> Vector:
    """The vector of Cayley's map that fits the increments ``d`` of the means ``r`` best."""
    r, d, A, begin = work.r, work.d, work.A, cells.first[e]
    A[:] = 0.0
    b = (0.0, 0.0, 0.0)
    for a in range(r.shape[0]):
        for k in range(2):
            weight, arm = cells.weights[begin + a, k], load_row(r[a], k)
            add_resistance(A, weight, arm)
            b = plus(b, scaled(weight, cross(arm, load_row(d[a], k))))
    return solve_thin(A, b)


@uncounted
def _mean_forces(cells: CellTable, e: int, H: Array, ω: Vector, work: Work) -> None:
    """``C f(C⁻¹ r̄)`` into ``work.f``."""
    r, f, other = work.r, work.f, work.other
    for a in range(r.shape[0]):
        for k in range(2):
            store_row(other[a], k, unshrunk(ω, load_row(r[a], k)))
    forces_of(cells, e, H, other, work.rows, f)
    for a in range(r.shape[0]):
        for k in range(2):
            store_row(f[a], k, shrunk(ω, load_row(f[a], k)))


class Nodes(NamedTuple):
    """Start of a step, and its increments.

    Attributes:
        H: Rows at the start, (≥ n, 4, 3).
        rest: Digits that do not fit into them, (n, 4, 3).
        step: Increments of both halves, (n, 6).
    """

    H: Array
    rest: Array
    step: Array


@inlined_uncounted
def set_out(cells: CellTable, e: int, nodes: Nodes, work: Work) -> None:
    """Means ``r`` from the first node and increments ``d`` of a cell, and halves at the end."""
    r, d, other, begin = work.r, work.d, work.other, cells.first[e]
    mine = cells.nodes[begin : cells.first[e + 1]]
    kinds = cells.kinds[begin : cells.first[e + 1]]
    gather(kinds, mine, nodes.H, nodes.rest, r)
    origin = load(nodes.step[mine[0]], 0)
    for a in range(mine.shape[0]):
        for k in range(2):
            moved = load(nodes.step[mine[a]], 3 * k)
            start = load_row(r[a], k)
            seen = minus(moved, origin) if k == 0 and has_position(kinds[a]) else moved
            store_row(d[a], k, moved)
            store_row(r[a], k, combined(1.0, start, 0.5, seen))
            store_row(other[a], k, plus(start, seen))


@compiled
def add_elastic(
    cells: CellTable,
    nodes: Nodes,
    energies: Energies,
    factors: tuple[float, float, float],
    out: Array,
) -> float:
    """Add the elastic forces of a step to ``out``, but of cells of places.

    Args:
        cells: All cells.
        nodes: What they do.
        energies: Of the cells.
        factors: Of ``M s`` in forces beside, whose work is on no account; ``|s|²`` of a cell on the
            average, before; and what of its energy cannot be seen in that of the scene.
        out: Forces on both halves, (n, 6), updated.

    Returns:
        The sum of ``|s|²``.
    """
    return _add_all(cells, nodes, energies, factors, memory(largest_cell(cells.first)), out)


@uncounted
def _add_all(
    cells: CellTable,
    nodes: Nodes,
    energies: Energies,
    factors: tuple[float, float, float],
    room: Work,
    out: Array,
) -> float:
    """The same with the memory for a cell."""
    repay, squares = factors[0], 0.0
    for e in range(cells.sees.shape[0]):
        if are_positions(cells, e):
            continue
        begin, count = cells.first[e], cells.first[e + 1] - cells.first[e]
        r, d, f = room.r[:count], room.d[:count], room.f[:count]
        work = Work(r, d, f, room.other[:count], room.rows[:count], room.A)
        set_out(cells, e, nodes, work)
        energies.end[e] = energy_of(cells, e, nodes.H, work.other, work.rows)
        take_centre(cells, e, r)
        ω = (0.0, 0.0, 0.0)
        if cells.sees[e] < POSITIONS:
            take_centre(cells, e, d)
        if cells.sees[e] == NOTHING:
            ω = rotation_of(cells, e, work)
        _mean_forces(cells, e, nodes.H, ω, work)
        made, square, round_off_level, ρ2 = 0.0, 0.0, 0.0, 0.0
        for a in range(count):
            for k in range(2):
                weight, arm = cells.weights[begin + a, k], load_row(r[a], k)
                s = minus(load_row(d[a], k), cross(ω, arm))
                store_row(d[a], k, s)
                push = load_row(f[a], k)
                made += dot(push, s)
                square += weight * dot(s, s)
                round_off_level += sqrt(dot(push, push) * dot(arm, arm))
                ρ2 += weight * dot(arm, arm) / count
        known = (made, square, round_off_level, ρ2, cells.cancels[e])
        factor = factor_beside(energies, e, factors, known)
        squares += square
        for a in range(count):
            i = cells.nodes[begin + a]
            for k in range(2):
                beside = (factor + repay) * cells.weights[begin + a, k]
                push = combined(1.0, load_row(f[a], k), beside, load_row(d[a], k))
                store(out[i], 3 * k, plus(load(out[i], 3 * k), push))
    return squares


@compiled
def energies_at(cells: CellTable, H: Array, rest: Array, W: Array) -> None:
    """Energies ``W`` (M,) of all cells at rows ``H``."""
    room = memory(largest_cell(cells.first))
    for e in range(W.shape[0]):
        here = slice(cells.first[e], cells.first[e + 1])
        work = part_of(room, cells.first[e + 1] - cells.first[e])
        gather(cells.kinds[here], cells.nodes[here], H, rest, work.other)
        W[e] = energy_of(cells, e, H, work.other, work.rows)
