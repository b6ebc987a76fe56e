r"""Energy, forces and matrix of cells of the plate of places and three slopes.

Kernels of UFCx's signature, ``W = ½ ε·C ε`` of the strains of :mod:`.plate_strains` less those of
the unloaded cell, with the ``C`` of :mod:`.plate`. The matrix has the geometric part of a stress
that is carried from iterate to iterate. Nodes are those of thin shells, with the slope across the
thickness where these have the mixed derivative.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import callback, compiled, inlined
from fem_lie._jit.stack import stack
from fem_lie.elements.gradients.plate_strains import LEVERS, STRAINS, levers, terms
from fem_lie.elements.thin_shells.rows import (
    NODES,
    SIZES,
    UNKNOWNS,
    VECTORS,
    gather,
    gather_motion,
    pull,
    pull_matrix,
)
from fem_lie.forms.kernels.addresses import UFCX_SIGNATURE, Pointer, pointer, shift

_T = np.ascontiguousarray(levers())
_LEVER, _VECTOR = (np.ascontiguousarray(index) for index in np.nonzero(_T))
_WEIGHT = np.ascontiguousarray(_T[_LEVER, _VECTOR])
_PARTS = len(_LEVER)
_PRODUCTS, _FACTOR = terms()
_TERMS = len(_FACTOR)
_ROWS = 12 * NODES
STRESS_AT = _ROWS + SIZES + STRAINS + STRAINS**2
"""Where the carried stress begins in a cell's data; it is the last of them."""


class Data(NamedTuple):
    """What the kernels read of one cell.

    Attributes:
        rows: Of its nodes, shape (8, 4, 3).
        sizes: Of the cell along u and v, one, and zero, shape (4,).
        unloaded: Strains then, shape (44,).
        stiffness: Of the whole cell, shape (44, 44).
        stress: What is carried, shape (44,).
    """

    rows: Array
    sizes: Array
    unloaded: Array
    stiffness: Array
    stress: Array


@inlined
def _read(w: Pointer) -> Data:
    at = _ROWS + SIZES
    sizes, unloaded = (
        numba.carray(shift(w, _ROWS), (SIZES,)),
        numba.carray(shift(w, at), (STRAINS,)),
    )
    stiffness = numba.carray(shift(w, at + STRAINS), (STRAINS, STRAINS))
    stress = numba.carray(shift(w, STRESS_AT), (STRAINS,))
    return Data(numba.carray(w, (NODES, 4, 3)), sizes, unloaded, stiffness, stress)


@compiled
def _find(q: Array, z: Array, e: Array) -> None:
    """Levers ``z`` (45, 3) and strains ``e`` (44,) of vectors (16, 3)."""
    z[:] = 0.0
    for t in range(_PARTS):
        lever, vector, weight = _LEVER[t], _VECTOR[t], _WEIGHT[t]
        for j in range(3):
            z[lever, j] += weight * q[vector, j]
    e[:] = 0.0
    for t in range(_TERMS):
        k, a, b = _PRODUCTS[t]
        e[k] += _FACTOR[t] * (z[a, 0] * z[b, 0] + z[a, 1] * z[b, 1] + z[a, 2] * z[b, 2])


@inlined
def _strains(data: Data, q: Array, z: Array, e: Array) -> None:
    """Less those of the unloaded cell."""
    gather(data.rows, data.sizes, q)
    _find(q, z, e)
    for k in range(STRAINS):
        e[k] -= data.unloaded[k]


@inlined
def _stress(C: Array, e: Array, S: Array) -> None:
    for i in range(STRAINS):
        total = 0.0
        for k in range(STRAINS):
            total += C[i, k] * e[k]
        S[i] = total


@compiled
def _changes(z: Array, B: Array) -> None:
    """``∂e/∂q``, shape (44, 16, 3)."""
    B[:] = 0.0
    for t in range(_TERMS):
        k, a, b = _PRODUCTS[t]
        for i in range(VECTORS):
            first, second = _FACTOR[t] * _T[a, i], _FACTOR[t] * _T[b, i]
            for j in range(3):
                B[k, i, j] += first * z[b, j] + second * z[a, j]


@callback(UFCX_SIGNATURE)
def energy_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Energy of a cell."""
    data, value = _read(w), numba.carray(A, (1,))
    q, z = numba.carray(stack(48), (VECTORS, 3)), numba.carray(stack(3 * LEVERS), (LEVERS, 3))
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
    data = _read(w)
    q, z = numba.carray(stack(48), (VECTORS, 3)), numba.carray(stack(3 * LEVERS), (LEVERS, 3))
    e, S = numba.carray(stack(STRAINS), (STRAINS,)), numba.carray(stack(STRAINS), (STRAINS,))
    fz = numba.carray(stack(3 * LEVERS), (LEVERS, 3))
    _strains(data, q, z, e)
    _stress(data.stiffness, e, S)
    fz[:] = 0.0
    for t in range(_TERMS):
        k, a, b = _PRODUCTS[t]
        s = _FACTOR[t] * S[k]
        for j in range(3):
            fz[a, j] += s * z[b, j]
            fz[b, j] += s * z[a, j]
    q[:] = 0.0
    for t in range(_PARTS):
        lever, vector, weight = _LEVER[t], _VECTOR[t], _WEIGHT[t]
        for j in range(3):
            q[vector, j] += weight * fz[lever, j]
    pull(data.rows, data.sizes, q, numba.carray(A, (NODES, 6)))


@callback(UFCX_SIGNATURE)
def tangent_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Matrix of a cell, with the carried stress."""
    data = _read(w)
    q, z = numba.carray(stack(48), (VECTORS, 3)), numba.carray(stack(3 * LEVERS), (LEVERS, 3))
    e, change = numba.carray(stack(STRAINS), (STRAINS,)), stack(STRAINS * UNKNOWNS)
    B, B3 = numba.carray(change, (STRAINS, UNKNOWNS)), numba.carray(change, (STRAINS, VECTORS, 3))
    CB = numba.carray(stack(STRAINS * UNKNOWNS), (STRAINS, UNKNOWNS))
    K = numba.carray(stack(UNKNOWNS * UNKNOWNS), (UNKNOWNS, UNKNOWNS))
    R = numba.carray(stack(9 * NODES), (NODES, 3, 3))
    _strains(data, q, z, e)
    _changes(z, B3)
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
    for t in range(_TERMS):
        k, a, b = _PRODUCTS[t]
        s = _FACTOR[t] * data.stress[k]
        for m in range(VECTORS):
            for n in range(VECTORS):
                G = s * (_T[a, m] * _T[b, n] + _T[b, m] * _T[a, n])
                for j in range(3):
                    K[3 * m + j, 3 * n + j] += G
    pull_matrix(data.rows, data.sizes, K, R, numba.carray(A, (NODES, 6, NODES, 6)))


@compiled
def carry_stress(H: Array, h: Array, cells: Indices, place: tuple[int, int]) -> None:
    """Make the carried stress of all cells ``C (ε + ε' h)``.

    Args:
        H: Rows of all nodes, shape (n, 4, 3).
        h: Their motions, shape (n, 6).
        cells: Nodes of each cell, shape (m, 8).
        place: Address and length of the cells' data.
    """
    q, z, e = np.empty((VECTORS, 3)), np.empty((LEVERS, 3)), np.empty(STRAINS)
    B, moved = np.empty((STRAINS, VECTORS, 3)), np.empty((NODES, 6))
    for i in range(cells.shape[0]):
        data = _read(pointer(place[0] + 8 * place[1] * i))
        for node in range(NODES):
            data.rows[node] = H[cells[i, node]]
            moved[node] = h[cells[i, node]]
        _strains(data, q, z, e)
        _changes(z, B)
        gather_motion(data.rows, data.sizes, moved, q)
        for k in range(STRAINS):
            for a in range(VECTORS):
                for j in range(3):
                    e[k] += B[k, a, j] * q[a, j]
        _stress(data.stiffness, e, data.stress)


def strains_of(q: Array) -> Array:
    """Strains of cells with vectors (m, 16, 3), those unloaded not taken off, shape (m, 44)."""
    found, z = np.empty((len(q), STRAINS)), np.empty((LEVERS, 3))
    for cell in range(len(q)):
        _find(np.ascontiguousarray(q[cell]), z, found[cell])
    return found
