"""Energy, forces and tangent of the cells of a thin shell: kernels of UFCx's signature.

With covariant strains ``ε = (E₁₁, E₂₂, 2 E₁₂, κ₁₁, κ₂₂, 2 κ₁₂)`` at the quadrature points,
``W = Σ_g ½ ε·D ε``. Membrane strains are sampled, ``E₁₁`` at the points of one set, ``E₂₂`` and
``2 E₁₂`` at those of others, and interpolated to the quadrature points; a fraction of the strains
there themselves may be mixed in. Curvatures are those at the points. Weights, areas and the
transformation to the section axes are in ``D``.

The tangent has the geometric stiffness of a linearised stress. In the small-energy kernel all
strains of a cell would be those of one point, whose stiffness couples them
(``benchmarks/derived_kernels.py``): forces take three times as long, tangents six times.
"""

from __future__ import annotations

import numba
import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import callback, compiled
from fem_lie._jit.stack import stack
from fem_lie.elements.thin_shells.cell_tables import read_data, read_rule, read_tables
from fem_lie.elements.thin_shells.nodal_coordinates import (
    NODES,
    UNKNOWNS,
    VECTORS,
    gather,
    gather_motion,
    pull,
    pull_symmetric,
)
from fem_lie.elements.thin_shells.stiffness import (
    add_geometric,
    add_geometric_of_samples,
    add_material,
)
from fem_lie.elements.thin_shells.strains import (
    at_point,
    change_rows,
    differentiate,
    find_strains,
    find_stress,
    geometric,
    on_derivatives,
    on_samples,
    on_vectors,
    work_at,
    work_size,
)
from fem_lie.forms.kernels.addresses import UFCX_SIGNATURE, Pointer, pointer


@callback(UFCX_SIGNATURE)
def energy_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Energy of a cell."""
    rule, data = read_tables(w, c)
    points = rule.counts[3]
    work = work_at(stack(work_size(rule)), rule)
    value, S = numba.carray(A, (1,)), numba.carray(stack(6 * points), (6, points))
    gather(data.coordinates, data.sizes, work.q.T)
    find_strains(rule, data, work)
    find_stress(data.stiffness, work.strains, S)
    for k in range(6):
        for g in range(points):
            value[0] += 0.5 * S[k, g] * work.strains[k, g]


@callback(UFCX_SIGNATURE)
def force_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Forces on the nodes of a cell."""
    rule, data = read_tables(w, c)
    points, count = rule.counts[3], rule.table.shape[0]
    work = work_at(stack(work_size(rule)), rule)
    S, F = numba.carray(stack(6 * points), (6, points)), numba.carray(stack(3 * count), (3, count))
    f = numba.carray(stack(UNKNOWNS), (3, VECTORS))
    gather(data.coordinates, data.sizes, work.q.T)
    find_strains(rule, data, work)
    find_stress(data.stiffness, work.strains, S)
    on_samples(rule, S, work.samples)
    on_derivatives(rule, work.d, S, work.samples, F)
    on_vectors(rule.table, F, f)
    pull(data.coordinates, data.sizes, f.T, numba.carray(A, (NODES, 6)))


@callback(UFCX_SIGNATURE)
def tangent_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Tangent stiffness of a cell, with the independent stress."""
    rule, data = read_tables(w, c)
    points, S = rule.counts[3], data.stress
    work = work_at(stack(work_size(rule)), rule)
    K = numba.carray(stack(UNKNOWNS * UNKNOWNS), (UNKNOWNS, UNKNOWNS))
    change = stack(6 * UNKNOWNS)
    rows, rows3 = numba.carray(change, (6, UNKNOWNS)), numba.carray(change, (6, 3, VECTORS))
    stress_rows = numba.carray(stack(6 * UNKNOWNS), (6, UNKNOWNS))
    D, P = numba.carray(stack(36), (6, 6)), numba.carray(stack(256), (VECTORS, VECTORS))
    G, turn = numba.carray(stack(225), (5, 3, 5, 3)), numba.carray(stack(45), (5, 3, 3))
    half = numba.carray(stack(15 * VECTORS), (5, 3, VECTORS))
    gather(data.coordinates, data.sizes, work.q.T)
    differentiate(rule, work.q, work.d)
    K[:] = 0.0
    for g in range(points):
        change_rows(rule, work, g, rows3)
        add_material(rows, data.stiffness, g, D, stress_rows, K)
        geometric(at_point(rule, work.d, g), (S[3, g], S[4, g], S[5, g]), G, turn)
        for j in range(3):
            G[0, j, 0, j] += rule.share * S[0, g]
            G[1, j, 1, j] += rule.share * S[1, g]
            G[0, j, 1, j] += rule.share * S[2, g]
            G[1, j, 0, j] += rule.share * S[2, g]
        add_geometric(rule, g, G, half, K)
    on_samples(rule, S, work.samples)
    add_geometric_of_samples(rule, work.samples, P, K)
    pull_symmetric(data.coordinates, data.sizes, K, numba.carray(A, (NODES, 6, NODES, 6)))


@compiled
def update_stress(H: Array, h: Array, cells: Indices, storage: tuple[int, int], c: int) -> None:
    """Set the independent stress of all cells to ``D (ε + ε' h)``.

    Args:
        H: Coordinates of all nodes, shape (n, 4, 3).
        h: Increments of all nodes, shape (n, 6).
        cells: Nodes of each cell, shape (m, 8).
        storage: Address and length of the cells' data.
        c: Address of the tables.
    """
    rule = read_rule(pointer(c))
    work = work_at(stack(work_size(rule)), rule)
    moved, dq, rows = np.empty((NODES, 6)), np.empty((3, VECTORS)), np.empty((6, 3, VECTORS))
    for e in range(cells.shape[0]):
        data = read_data(pointer(storage[0] + 8 * storage[1] * e), rule.counts)
        for i in range(NODES):
            data.coordinates[i] = H[cells[e, i]]
            moved[i] = h[cells[e, i]]
        gather(data.coordinates, data.sizes, work.q.T)
        find_strains(rule, data, work)
        gather_motion(data.coordinates, data.sizes, moved, dq.T)
        for g in range(rule.counts[3]):
            change_rows(rule, work, g, rows)
            for k in range(6):
                for j in range(3):
                    for a in range(VECTORS):
                        work.strains[k, g] += rows[k, j, a] * dq[j, a]
        find_stress(data.stiffness, work.strains, data.stress)


@compiled
def all_strains(H: Array, cells: Indices, storage: tuple[int, int], c: int, out: Array) -> None:
    """Strains at the points of all cells, shape (m, 6, g); arguments of :func:`update_stress`."""
    rule = read_rule(pointer(c))
    work = work_at(stack(work_size(rule)), rule)
    for e in range(cells.shape[0]):
        data = read_data(pointer(storage[0] + 8 * storage[1] * e), rule.counts)
        for i in range(NODES):
            data.coordinates[i] = H[cells[e, i]]
        gather(data.coordinates, data.sizes, work.q.T)
        find_strains(rule, data, work)
        out[e] = work.strains
