r"""Energy, forces and matrix of cells of the beam of places and three slopes.

Kernels of UFCx's signature, ``W = ½ ε·C ε`` of the strains of :mod:`.strains` less those of the
unloaded cell, with the ``C`` of :mod:`.ancf`. The matrix has the geometric part of a stress that is
carried from iterate to iterate.
"""

from __future__ import annotations

import numba
import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import callback, compiled, inlined
from fem_lie._jit.stack import stack
from fem_lie.elements.gradients.strains import (
    LEVERS,
    NODES,
    STRAINS,
    UNKNOWNS,
    VECTORS,
    Data,
    add_geometric,
    change_rows,
    find_levers,
    find_strains,
    gather,
    gather_motion,
    lever_table,
    pull,
    pull_levers,
    pull_matrix,
    pull_stress,
    read,
)
from fem_lie.forms.kernels.addresses import UFCX_SIGNATURE, Pointer, pointer


@inlined
def _strains(data: Data, q: Array, z: Array, e: Array) -> None:
    """Vectors, levers and strains of a cell."""
    gather(data.rows, q)
    find_levers(data.length, q, z)
    find_strains(z, e)
    for k in range(STRAINS):
        e[k] -= data.unloaded[k]


@inlined
def _stress(C: Array, e: Array, S: Array) -> None:
    for i in range(STRAINS):
        total = 0.0
        for k in range(STRAINS):
            total += C[i, k] * e[k]
        S[i] = total


@callback(UFCX_SIGNATURE)
def energy_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Energy of a cell."""
    data, value = read(w), numba.carray(A, (1,))
    q, z = numba.carray(stack(UNKNOWNS), (VECTORS, 3)), numba.carray(stack(33), (LEVERS, 3))
    e, S = numba.carray(stack(STRAINS), (STRAINS,)), numba.carray(stack(STRAINS), (STRAINS,))
    _strains(data, q, z, e)
    _stress(data.stiffness, e, S)
    for k in range(STRAINS):
        value[0] += 0.5 * S[k] * e[k]


@callback(UFCX_SIGNATURE)
def force_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Forces on the nodes of a cell."""
    data = read(w)
    q, z = numba.carray(stack(UNKNOWNS), (VECTORS, 3)), numba.carray(stack(33), (LEVERS, 3))
    e, S = numba.carray(stack(STRAINS), (STRAINS,)), numba.carray(stack(STRAINS), (STRAINS,))
    fz = numba.carray(stack(33), (LEVERS, 3))
    _strains(data, q, z, e)
    _stress(data.stiffness, e, S)
    pull_stress(z, S, fz)
    pull_levers(data.length, fz, q)
    pull(data.rows, q, numba.carray(A, (NODES, 6)))


@callback(UFCX_SIGNATURE)
def tangent_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Matrix of a cell, with the carried stress."""
    data = read(w)
    q, z = numba.carray(stack(UNKNOWNS), (VECTORS, 3)), numba.carray(stack(33), (LEVERS, 3))
    T, change = numba.carray(stack(88), (LEVERS, VECTORS)), stack(STRAINS * UNKNOWNS)
    B, B3 = numba.carray(change, (STRAINS, UNKNOWNS)), numba.carray(change, (STRAINS, VECTORS, 3))
    CB = numba.carray(stack(STRAINS * UNKNOWNS), (STRAINS, UNKNOWNS))
    K = numba.carray(stack(UNKNOWNS * UNKNOWNS), (UNKNOWNS, UNKNOWNS))
    G = numba.carray(stack(64), (VECTORS, VECTORS))
    R, half = numba.carray(stack(36), (NODES, 3, 3)), numba.carray(stack(9), (3, 3))
    gather(data.rows, q)
    find_levers(data.length, q, z)
    lever_table(data.length, T)
    change_rows(z, T, B3)
    CB[:] = 0.0
    for i in range(STRAINS):
        for k in range(STRAINS):
            for a in range(UNKNOWNS):
                CB[i, a] += data.stiffness[i, k] * B[k, a]
    K[:] = 0.0
    for k in range(STRAINS):
        for a in range(UNKNOWNS):
            for b in range(UNKNOWNS):
                K[a, b] += B[k, a] * CB[k, b]
    G[:] = 0.0
    add_geometric(data.stress, T, G)
    for a in range(VECTORS):
        for b in range(VECTORS):
            for j in range(3):
                K[3 * a + j, 3 * b + j] += G[a, b]
    pull_matrix(data.rows, K, R, half, numba.carray(A, (NODES, 6, NODES, 6)))


@compiled
def carry_stress(H: Array, h: Array, cells: Indices, place: tuple[int, int]) -> None:
    """Make the carried stress of all cells ``C (ε + ε' h)``.

    Args:
        H: Rows of all nodes, shape (n, 4, 3).
        h: Their motions, shape (n, 6).
        cells: Nodes of each cell, shape (m, 4).
        place: Address and length of the cells' data.
    """
    q, z, e = np.empty((VECTORS, 3)), np.empty((LEVERS, 3)), np.empty(STRAINS)
    T, B, moved = np.empty((LEVERS, VECTORS)), np.empty((STRAINS, VECTORS, 3)), np.empty((NODES, 6))
    for i in range(cells.shape[0]):
        data = read(pointer(place[0] + 8 * place[1] * i))
        for node in range(NODES):
            data.rows[node] = H[cells[i, node]]
            moved[node] = h[cells[i, node]]
        _strains(data, q, z, e)
        lever_table(data.length, T)
        change_rows(z, T, B)
        gather_motion(data.rows, moved, q)
        for k in range(STRAINS):
            for a in range(VECTORS):
                for j in range(3):
                    e[k] += B[k, a, j] * q[a, j]
        _stress(data.stiffness, e, data.stress)


@compiled
def all_strains(H: Array, cells: Indices, place: tuple[int, int], out: Array) -> None:
    """Strains of all cells, shape (m, 18); arguments as :func:`carry_stress`."""
    q, z = np.empty((VECTORS, 3)), np.empty((LEVERS, 3))
    for i in range(cells.shape[0]):
        data = read(pointer(place[0] + 8 * place[1] * i))
        for node in range(NODES):
            data.rows[node] = H[cells[i, node]]
        _strains(data, q, z, out[i])


@compiled
def unloaded_strains(H: Array, lengths: Array, cells: Indices, out: Array) -> None:
    """Strains of cells as they are made, shape (m, 18), of rows (n, 4, 3) and lengths (m,)."""
    q, z, rows = np.empty((VECTORS, 3)), np.empty((LEVERS, 3)), np.empty((NODES, 4, 3))
    for i in range(cells.shape[0]):
        for node in range(NODES):
            rows[node] = H[cells[i, node]]
        gather(rows, q)
        find_levers(lengths[i], q, z)
        find_strains(z, out[i])
