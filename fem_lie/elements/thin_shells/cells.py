r"""Energy, forces and matrix of the cells of a thin shell: kernels of UFCx's signature.

With covariant strains ``ε = (E₁₁, E₂₂, 2 E₁₂, κ₁₁, κ₂₂, 2 κ₁₂)`` at the points of integration,
``W = Σ_g ½ ε·D ε``. Membrane strains are sampled, ``E₁₁`` at the points of one set, ``E₂₂`` and
``2 E₁₂`` at those of others, and interpolated to the points of integration; a share of the strains
there themselves may be mixed in. Curvatures are those at the points. Weights, areas and the
transformation to the section's axes are in ``D``.

The matrix has the geometric part of a stress that is carried from iterate to iterate.
"""

from __future__ import annotations

import numba
import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import callback, compiled, inlined
from fem_lie._jit.stack import stack
from fem_lie.elements.thin_shells.cell_tables import read_data, read_rule, read_tables
from fem_lie.elements.thin_shells.curvature import geometric, pull_moments
from fem_lie.elements.thin_shells.rows import (
    NODES,
    UNKNOWNS,
    VECTORS,
    gather,
    gather_motion,
    pull,
    pull_matrix,
)
from fem_lie.elements.thin_shells.stiffness import (
    add_geometric,
    add_geometric_of_samples,
    add_material,
)
from fem_lie.elements.thin_shells.strain_changes import add_to_samples, change_rows, pull_samples
from fem_lie.elements.thin_shells.strains import differentiate, find_strains, room, room_size
from fem_lie.forms.kernels.addresses import UFCX_SIGNATURE, Pointer, pointer
from fem_lie.lie.tuples import load, load_row, plus, scaled, store


@inlined
def _stress(D: Array, strain: Array, out: Array) -> None:
    for i in range(6):
        out[i] = 0.0
        for j in range(6):
            out[i] += D[i, j] * strain[j]


@callback(UFCX_SIGNATURE)
def energy_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Energy of a cell."""
    rule, data = read_tables(w, c)
    samples, points = data.sampled.shape[0], data.unloaded.shape[0]
    work = room(stack(room_size(samples, points)), samples, points)
    value, S = numba.carray(A, (1,)), numba.carray(stack(6), (6,))
    gather(data.rows, data.sizes, work.q)
    find_strains(rule, data, work)
    for g in range(points):
        _stress(data.stiffness[g], work.strains[g], S)
        for k in range(6):
            value[0] += 0.5 * S[k] * work.strains[g, k]


@callback(UFCX_SIGNATURE)
def force_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Forces on the nodes of a cell."""
    rule, data = read_tables(w, c)
    samples, points = data.sampled.shape[0], data.unloaded.shape[0]
    work = room(stack(room_size(samples, points)), samples, points)
    f, on_samples = numba.carray(stack(UNKNOWNS), (VECTORS, 3)), work.samples
    S, fz = numba.carray(stack(6), (6,)), numba.carray(stack(15), (5, 3))
    gather(data.rows, data.sizes, work.q)
    find_strains(rule, data, work)
    f[:] = 0.0
    on_samples[:] = 0.0
    for g in range(points):
        _stress(data.stiffness[g], work.strains[g], S)
        add_to_samples(rule, g, S, on_samples)
        z = work.z[g]
        pull_moments(z, load(S, 3), fz)
        n1, n2, n12 = scaled(rule.share, load(S, 0))
        r1, r2 = load_row(z, 0), load_row(z, 1)
        store(fz[0], 0, plus(load_row(fz, 0), plus(scaled(n1, r1), scaled(n12, r2))))
        store(fz[1], 0, plus(load_row(fz, 1), plus(scaled(n2, r2), scaled(n12, r1))))
        for a in range(VECTORS):
            for k in range(5):
                for j in range(3):
                    f[a, j] += rule.points[g, k, a] * fz[k, j]
    pull_samples(rule, work.slopes, on_samples, f)
    pull(data.rows, data.sizes, f, numba.carray(A, (NODES, 6)))


@callback(UFCX_SIGNATURE)
def tangent_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Matrix of a cell, with the carried stress."""
    rule, data = read_tables(w, c)
    samples, points = data.sampled.shape[0], data.unloaded.shape[0]
    work = room(stack(room_size(samples, points)), samples, points)
    K = numba.carray(stack(UNKNOWNS * UNKNOWNS), (UNKNOWNS, UNKNOWNS))
    change = stack(6 * UNKNOWNS)
    rows, rows3 = numba.carray(change, (6, UNKNOWNS)), numba.carray(change, (6, VECTORS, 3))
    stress_rows = numba.carray(stack(6 * UNKNOWNS), (6, UNKNOWNS))
    G, fz = numba.carray(stack(225), (5, 3, 5, 3)), numba.carray(stack(15), (5, 3))
    turn, half = numba.carray(stack(45), (5, 3, 3)), numba.carray(stack(48), (VECTORS, 3))
    P, R = numba.carray(stack(256), (VECTORS, VECTORS)), numba.carray(stack(72), (NODES, 3, 3))
    gather(data.rows, data.sizes, work.q)
    differentiate(rule, work.q, work.slopes, work.z)
    K[:] = 0.0
    work.samples[:] = 0.0
    for g in range(points):
        S = data.stress[g]
        change_rows(rule, work, g, fz, rows3)
        add_material(rows, data.stiffness[g], stress_rows, K)
        add_to_samples(rule, g, S, work.samples)
        geometric(work.z[g], load(S, 3), G, turn)
        for j in range(3):
            G[0, j, 0, j] += rule.share * S[0]
            G[1, j, 1, j] += rule.share * S[1]
            G[0, j, 1, j] += rule.share * S[2]
            G[1, j, 0, j] += rule.share * S[2]
        add_geometric(rule.points[g], G, half, K)
    add_geometric_of_samples(rule, work.samples, P, K)
    pull_matrix(data.rows, data.sizes, K, R, numba.carray(A, (NODES, 6, NODES, 6)))


@compiled
def carry_stress(H: Array, h: Array, cells: Indices, place: tuple[int, int], c: int) -> None:
    """Make the carried stress of all cells ``D (ε + ε' h)``.

    Args:
        H: Rows of all nodes, shape (n, 4, 3).
        h: Their motions, shape (n, 6).
        cells: Nodes of each cell, shape (m, 8).
        place: Address and length of the cells' data.
        c: Address of the tables.
    """
    rule = read_rule(pointer(c))
    n1, n2, n3, points = rule.counts
    samples = n1 + n2 + n3
    work = room(stack(room_size(samples, points)), samples, points)
    moved, own = np.empty((NODES, 6)), np.empty(6)
    dq, rows, fz = np.empty((VECTORS, 3)), np.empty((6, VECTORS, 3)), np.empty((5, 3))
    for e in range(cells.shape[0]):
        data = read_data(pointer(place[0] + 8 * place[1] * e), samples, points)
        for i in range(NODES):
            data.rows[i] = H[cells[e, i]]
            moved[i] = h[cells[e, i]]
        gather(data.rows, data.sizes, work.q)
        find_strains(rule, data, work)
        gather_motion(data.rows, data.sizes, moved, dq)
        for g in range(points):
            change_rows(rule, work, g, fz, rows)
            for k in range(6):
                own[k] = work.strains[g, k]
                for a in range(VECTORS):
                    for j in range(3):
                        own[k] += rows[k, a, j] * dq[a, j]
            _stress(data.stiffness[g], own, data.stress[g])


@compiled
def all_strains(H: Array, cells: Indices, place: tuple[int, int], c: int, out: Array) -> None:
    """Strains at the points of all cells, shape (m, g, 6); arguments as :func:`carry_stress`."""
    rule = read_rule(pointer(c))
    n1, n2, n3, points = rule.counts
    samples = n1 + n2 + n3
    work = room(stack(room_size(samples, points)), samples, points)
    for e in range(cells.shape[0]):
        data = read_data(pointer(place[0] + 8 * place[1] * e), samples, points)
        for i in range(NODES):
            data.rows[i] = H[cells[e, i]]
        gather(data.rows, data.sizes, work.q)
        find_strains(rule, data, work)
        out[e] = work.strains
