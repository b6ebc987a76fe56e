r"""Seams of thin shells: places and normals of two cells at one place of their edges held together.

With places ``r``, covariant slopes ``r₁, r₂`` and normals ``n`` of both sides at a point of the
seam, ``w`` its part of the length, ``N`` and ``M`` stiffness per length::

    e = (r_A − r_B + D (r₁, r₂, n)_A, n_A − n_B + C (r₁, r₂, n)_A),    W = ½ w (N |e_r|² + M |e_n|²)

where the numbers ``D``, ``C`` are such that the unloaded shell has ``e = 0``: nothing is strained
as it lies, nor by rigid motion. Parametrisations of the sides may be any. Vectors are linear in the
unknowns, so that the matrix is ``Zᵀ (E'ᵀ C E' + S·e″) Z`` with the constant ``Z`` of shapes; ``S``
is carried from iterate to iterate, its part by complex steps, which are exact.
"""

from __future__ import annotations

from typing import Any

import numba
import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import callback, compiled, inlined
from fem_lie._jit.stack import stack
from fem_lie.elements.thin_shells.rows import NODES, VECTORS, half_of, node_of, row_of, scale_of
from fem_lie.forms.kernels.addresses import UFCX_SIGNATURE, Pointer, pointer, shift
from fem_lie.lie.kinds.kind import CROSSING, SURFACE, axes
from fem_lie.lie.tuples import (
    combined,
    cross,
    dot,
    load,
    load_row,
    minus,
    plus,
    scaled,
    store,
)

_BOTH = 2 * NODES
DATA = 12 * _BOTH
"""Numbers of the point follow the rows of both cells: see :class:`.seam.SeamPoints`; then S."""
_SHAPES = 6
_TAKEN = _SHAPES + 6 * VECTORS
STRESS = _TAKEN + 8
_SIZE = STRESS + 6
_TINY = 1e-30  # a complex step: its square is nothing

# three vectors of a side, as tuples of numbers, real or complex
_Numbers = Any


@inlined
def _find(H: Array, data: Array, q: Array) -> None:
    """Places and slopes of both sides, shape (6, 3)."""
    q[:] = 0.0
    for side in range(2):
        for a in range(VECTORS):
            row = load_row(H[NODES * side + node_of(a)], row_of(a))
            for c in range(3):
                at = _SHAPES + VECTORS * (3 * side + c) + a
                share = data[at] * scale_of(a, data[3 * side : 3 * side + 3])
                store(q[3 * side + c], 0, plus(load(q[3 * side + c], 0), scaled(share, row)))


@inlined
def _normal(r1: _Numbers, r2: _Numbers) -> _Numbers:
    """And one over its length before it is a unit vector."""
    m = cross(r1, r2)
    inverse = 1.0 / np.sqrt(dot(m, m))
    return scaled(inverse, m), inverse


@inlined
def _gaps(q: Array, data: Array) -> _Numbers:
    """``e``."""
    r1, r2 = load_row(q, 1), load_row(q, 2)
    n, other = _normal(r1, r2)[0], _normal(load_row(q, 4), load_row(q, 5))[0]
    t = _TAKEN
    place = plus(
        minus(load_row(q, 0), load_row(q, 3)),
        plus(combined(data[t], r1, data[t + 1], r2), scaled(data[t + 2], n)),
    )
    normal = plus(
        minus(n, other),
        plus(combined(data[t + 3], r1, data[t + 4], r2), scaled(data[t + 5], n)),
    )
    return place, normal


@inlined
def _pulled(r1: _Numbers, r2: _Numbers, P: _Numbers) -> _Numbers:
    """What ``P`` on the normal is on both slopes."""
    n, inverse = _normal(r1, r2)
    across = scaled(inverse, minus(P, scaled(dot(n, P), n)))
    return cross(r2, across), cross(across, r1)


@inlined
def _on_slopes(slopes: _Numbers, data: Array, Sr: _Numbers, Sn: _Numbers) -> _Numbers:
    """Gradient of ``S·e`` in the slopes of both sides."""
    t = _TAKEN
    own = combined(data[t + 2], Sr, 1.0 + data[t + 5], Sn)
    first, second = _pulled(slopes[0], slopes[1], own)
    third, fourth = _pulled(slopes[2], slopes[3], scaled(-1.0, Sn))
    return (
        plus(first, combined(data[t], Sr, data[t + 3], Sn)),
        plus(second, combined(data[t + 1], Sr, data[t + 4], Sn)),
        third,
        fourth,
    )


@inlined
def _slopes(q: Array) -> _Numbers:
    return load_row(q, 1), load_row(q, 2), load_row(q, 4), load_row(q, 5)


@inlined
def _gradient(q: Array, data: Array, Sr: _Numbers, Sn: _Numbers, g: Array) -> None:
    """Of ``S·e`` in the six vectors, (6, 3)."""
    a1, a2, b1, b2 = _on_slopes(_slopes(q), data, Sr, Sn)
    store(g[0], 0, Sr)
    store(g[1], 0, a1)
    store(g[2], 0, a2)
    store(g[3], 0, scaled(-1.0, Sr))
    store(g[4], 0, b1)
    store(g[5], 0, b2)


@inlined
def _add_geometric(q: Array, data: Array, G: Array) -> None:
    """Derivative of the gradient in the slopes, at the carried stress, to ``G`` (18, 18)."""
    Sr, Sn = load(data, STRESS), load(data, STRESS + 3)
    moved = numba.carray(stack(12), (12,))
    ι: _Numbers = complex(0.0, 1.0)
    z = _slopes(q)
    for j in range(12):
        moved[:] = 0.0
        moved[j] = _TINY
        at = (
            plus(z[0], scaled(ι, load(moved, 0))),
            plus(z[1], scaled(ι, load(moved, 3))),
            plus(z[2], scaled(ι, load(moved, 6))),
            plus(z[3], scaled(ι, load(moved, 9))),
        )
        column = 3 * (1 + j // 3 + (1 if j >= 6 else 0)) + j % 3
        found = _on_slopes(at, data, Sr, Sn)
        for k in range(4):
            row = 3 * (1 + k + (1 if k >= 2 else 0))
            for i in range(3):
                G[row + i, column] += found[k][i].imag / _TINY


@inlined
def _motions(H: Array, data: Array, Z: Array) -> None:
    """How the six vectors move with the unknowns of all nodes, (18, 96)."""
    Z[:] = 0.0
    for side in range(2):
        for a in range(VECTORS):
            node = node_of(a)
            kind = SURFACE if node < NODES // 2 else CROSSING
            own = axes(kind, H[NODES * side + node])
            column = 6 * (NODES * side + node) + 3 * half_of(a)
            for c in range(3):
                at = _SHAPES + VECTORS * (3 * side + c) + a
                share = data[at] * scale_of(a, data[3 * side : 3 * side + 3])
                for k in range(3):
                    for j in range(3):
                        Z[3 * (3 * side + c) + j, column + k] += share * own[k][j]


@callback(UFCX_SIGNATURE)
def energy_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """``W`` of a point."""
    H, data = numba.carray(w, (_BOTH, 4, 3)), numba.carray(shift(w, DATA), (_SIZE,))
    q, value = numba.carray(stack(18), (6, 3)), numba.carray(A, (1,))
    _find(H, data, q)
    er, en = _gaps(q, data)
    value[0] += 0.5 * (data[STRESS - 2] * dot(er, er) + data[STRESS - 1] * dot(en, en))


@callback(UFCX_SIGNATURE)
def force_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Its forces on the nodes of both cells."""
    H, data = numba.carray(w, (_BOTH, 4, 3)), numba.carray(shift(w, DATA), (_SIZE,))
    q, g = numba.carray(stack(18), (6, 3)), numba.carray(stack(18), (18,))
    Z, out = numba.carray(stack(18 * 96), (18, 96)), numba.carray(A, (96,))
    _find(H, data, q)
    er, en = _gaps(q, data)
    Sr, Sn = scaled(data[STRESS - 2], er), scaled(data[STRESS - 1], en)
    _gradient(q, data, Sr, Sn, g.reshape(6, 3))
    _motions(H, data, Z)
    for i in range(18):
        for k in range(96):
            out[k] += g[i] * Z[i, k]


@inlined
def _changes(q: Array, data: Array, E: Array) -> None:
    """``e'`` in the six vectors, (6, 18)."""
    zero = (0.0, 0.0, 0.0)
    for k in range(3):
        unit = (1.0 if k == 0 else 0.0), (1.0 if k == 1 else 0.0), (1.0 if k == 2 else 0.0)
        _gradient(q, data, unit, zero, E[k].reshape(6, 3))
        _gradient(q, data, zero, unit, E[3 + k].reshape(6, 3))


@callback(UFCX_SIGNATURE)
def matrix_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """``Zᵀ (E'ᵀ C E' + S·e″) Z`` at the carried stress."""
    H, data = numba.carray(w, (_BOTH, 4, 3)), numba.carray(shift(w, DATA), (_SIZE,))
    q, E = numba.carray(stack(18), (6, 3)), numba.carray(stack(108), (6, 18))
    G, Z = numba.carray(stack(324), (18, 18)), numba.carray(stack(18 * 96), (18, 96))
    GZ, K = numba.carray(stack(18 * 96), (18, 96)), numba.carray(A, (96, 96))
    _find(H, data, q)
    _changes(q, data, E)
    G[:] = 0.0
    for k in range(6):
        factor = data[STRESS - 2] if k < 3 else data[STRESS - 1]
        for i in range(18):
            for j in range(18):
                G[i, j] += factor * E[k, i] * E[k, j]
    _add_geometric(q, data, G)
    _motions(H, data, Z)
    GZ[:] = 0.0
    for i in range(18):
        for j in range(18):
            for k in range(96):
                GZ[i, k] += G[i, j] * Z[j, k]
    for i in range(18):
        for j in range(96):
            for k in range(96):
                K[j, k] += Z[i, j] * GZ[i, k]


@compiled
def carry_stress(H: Array, h: Array, nodes: Indices, place: tuple[int, int]) -> None:
    """Stress at the end of increments ``h`` (n, 6), to first order, to where it is packed."""
    rows, q, E = np.empty((_BOTH, 4, 3)), np.empty((6, 3)), np.empty((6, 18))
    Z, moved = np.empty((18, 96)), np.empty(96)
    for i in range(nodes.shape[0]):
        data = numba.carray(pointer(place[0] + 8 * place[1] * i), (_SIZE,))
        for node in range(_BOTH):
            rows[node] = H[nodes[i, node]]
            moved[6 * node : 6 * node + 6] = h[nodes[i, node]]
        _find(rows, data, q)
        er, en = _gaps(q, data)
        _changes(q, data, E)
        _motions(rows, data, Z)
        for k in range(6):
            e = er[k] if k < 3 else en[k - 3]
            for j in range(18):
                for m in range(96):
                    e += E[k, j] * Z[j, m] * moved[m]
            data[STRESS + k] = (data[STRESS - 2] if k < 3 else data[STRESS - 1]) * e
