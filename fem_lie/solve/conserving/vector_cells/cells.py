"""Elastic forces of a step on nodes with vector coordinates, whose work is the energy change.

They apply to *any* cell with an objective energy ``W``, and need only its energy and nodal forces.
The coordinates of its nodes are vectors ``r`` that rotate with a rigid motion; positions are
relative to their centre. With means ``r̄`` and increments ``Δr`` of a step::

    f = C f(C⁻¹ r̄) + (ΔW − f·s)/|s|² M s

1. *Mean.* The rigid part of the step, a translation and a rotation, is fitted in a metric ``M`` (1
   on positions, a length squared on position gradients). With half of the rotation ``Q``, means of
   rotating vectors are shrunk by ``C = ½ (Q + Qᵀ)``: without a correction a cell that rotates by θ
   would have a strain of ``θ²/8``. Forces at the unshrunk mean have neither resultant nor moment
   about it, and as ``(C a) × (C b) = det(C) C⁻¹ (a × b)``, the forces above have none about the
   mean. This holds for any C, to round-off, and so without balancing small differences, which is
   impossible for nodes on a straight line.
2. *Energy.* ``s`` is the increment without its rigid part, so that ``M s`` has no resultant and no
   moment; the factor is that of Gonzalez' discrete gradient (J. Nonlinear Sci. 6 (1996) 449) in the
   quotient by rigid motions. It is of third order in the deformation of the step.

Cells whose energy depends on directions fixed in space, such as a clamped end of a discrete rod,
conserve no angular momentum: ``C = 1``, and ``s`` is the increment without its translation.

Round-off of energies is not corrected at once, but accounted for as in
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
from fem_lie.solve.conserving.vector_cells.cell_arrays import (
    NOTHING,
    POSITIONS,
    VectorCells,
    are_positions,
    energy_of,
    forces_of,
    gather,
    has_position,
    largest_cell,
)


class Energies(NamedTuple):
    """Energies of all cells, each of shape (M,).

    Attributes:
        start: Stored energy at the start of the step.
        account: Work done on the cells up to its start.
        end: Stored energy at the end, overwritten.
        work: Work done in the step, overwritten.
    """

    start: Array
    account: Array
    end: Array
    work: Array


@inlined_uncounted
def additional_factor(
    energies: Energies,
    e: int,
    factors: tuple[float, float, float],
    known: tuple[float, float, float, float, float],
) -> float:
    """Factor of ``M s`` by which a cell's work is the change of its energy; records the work.

    Args:
        energies: Energies of all cells, with that at the end of this one.
        e: Index of the cell.
        factors: As in :func:`add_elastic`.
        known: Work of the mean forces, ``|s|²``, scale of the round-off of forces, the cell's size
            squared, and the error of its energy if that is a difference of larger numbers.
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
"""Fraction of the metric of rotations below which a cell is a line along an axis."""
_SWEEPS = 3
"""Number of iterations that correct for it about the other axes."""


class Work(NamedTuple):
    """Workspace for one cell after the other.

    Attributes:
        r: Vectors of its nodes at the mean, from the centre, (k, 2, 3), like the next three.
        d: Increments, later without the rigid part.
        f: Forces.
        other: Vectors at which kernels are evaluated.
        coordinates: Nodes, (k, 4, 3).
        A: Metric of rotations, (3, 3).
    """

    r: Array
    d: Array
    f: Array
    other: Array
    coordinates: Array
    A: Array


@compiled
def workspace_for(most: int) -> Work:
    """Workspace for cells of up to ``most`` nodes."""
    halves = np.empty((4, most, 2, 3))
    A = np.empty((3, 3))
    return Work(halves[0], halves[1], halves[2], halves[3], np.empty((most, 4, 3)), A)


@inlined
def part_of(work: Work, count: int) -> Work:
    """The part of a workspace for ``count`` nodes."""
    r, d, f, other, coordinates, A = work
    return Work(r[:count], d[:count], f[:count], other[:count], coordinates[:count], A)


@uncounted
def take_centre(cells: VectorCells, e: int, halves: Array) -> Vector:
    """Subtract the mean position from vectors (k, 2, 3); returns it."""
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
    """``A⁻¹ b`` of a metric of rotations (3, 3), zero about an axis on which all nodes lie."""
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
def rotation_of(cells: VectorCells, e: int, work: Work) -> Vector:
    """Best fit of a rotation to the increments ``d`` of the means ``r``, as a Cayley vector."""
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
def _mean_forces(cells: VectorCells, e: int, H: Array, ω: Vector, work: Work) -> None:
    """``C f(C⁻¹ r̄)`` into ``work.f``."""
    r, f, other = work.r, work.f, work.other
    for a in range(r.shape[0]):
        for k in range(2):
            store_row(other[a], k, unshrunk(ω, load_row(r[a], k)))
    forces_of(cells, e, H, other, work.coordinates, f)
    for a in range(r.shape[0]):
        for k in range(2):
            store_row(f[a], k, shrunk(ω, load_row(f[a], k)))


class Nodes(NamedTuple):
    """Start of a step, and its increments.

    Attributes:
        H: Nodes at the start, (≥ n, 4, 3).
        rest: Their digits beyond double precision, (n, 4, 3).
        step: Increments of both vectors, (n, 6).
    """

    H: Array
    rest: Array
    step: Array


@inlined_uncounted
def set_out(cells: VectorCells, e: int, nodes: Nodes, work: Work) -> None:
    """Means ``r`` from the first node, increments ``d``, and vectors at the end of a cell."""
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
    cells: VectorCells,
    nodes: Nodes,
    energies: Energies,
    factors: tuple[float, float, float],
    out: Array,
) -> float:
    """Add the elastic forces of a step to ``out``, except of cells of position nodes.

    Args:
        cells: All cells.
        nodes: Nodes and increments.
        energies: Energies of the cells.
        factors: Factor of ``M s`` in further forces, whose work is not accounted for; mean ``|s|²``
            of a cell in the previous iteration; and the energy of a cell that the round-off of the
            scene's energy hides.
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
    workspace: Work,
    out: Array,
) -> float:
    """The same with a workspace for a cell."""
    repay, squares = factors[0], 0.0
    for e in range(cells.sees.shape[0]):
        if are_positions(cells, e):
            continue
        begin, count = cells.first[e], cells.first[e + 1] - cells.first[e]
        r, d, f = workspace.r[:count], workspace.d[:count], workspace.f[:count]
        work = Work(r, d, f, workspace.other[:count], workspace.coordinates[:count], workspace.A)
        set_out(cells, e, nodes, work)
        energies.end[e] = energy_of(cells, e, nodes.H, work.other, work.coordinates)
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
        factor = additional_factor(energies, e, factors, known)
        squares += square
        for a in range(count):
            i = cells.nodes[begin + a]
            for k in range(2):
                whole_factor = (factor + repay) * cells.weights[begin + a, k]
                push = combined(1.0, load_row(f[a], k), whole_factor, load_row(d[a], k))
                store(out[i], 3 * k, plus(load(out[i], 3 * k), push))
    return squares


@compiled
def energies_at(cells: VectorCells, H: Array, rest: Array, W: Array) -> None:
    """Energies ``W`` (M,) of all cells at nodes ``H``."""
    workspace = workspace_for(largest_cell(cells.first))
    for e in range(W.shape[0]):
        here = slice(cells.first[e], cells.first[e + 1])
        work = part_of(workspace, cells.first[e + 1] - cells.first[e])
        gather(cells.kinds[here], cells.nodes[here], H, rest, work.other)
        W[e] = energy_of(cells, e, H, work.other, work.coordinates)
