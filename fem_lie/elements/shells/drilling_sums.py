"""Drilling energy of six-parameter shells, ``∫ ½ γ c²``, assembled beside the forms of five.

``c = a₁·x,₂ − a₂·x,₁`` (:mod:`fem_lie.elements.shells.drilling_strain`) with tangents ``a = Σ Nᵢ
Rᵢ Aᵢ`` that nodes carry is bilinear in positions and directors: its derivatives in twists ``(u,
η)`` of the nodes are written down here, for cells of any kind and degree, and need no form::

    ∂c/∂u_j = R_jᵀ (a₁ G₂_j − a₂ G₁_j)        ∂c/∂η_j = N_j (A₁ × R_jᵀ x,₂ − A₂ × R_jᵀ x,₁)

with the slopes ``G`` of the shape functions in the unloaded surface. The stress γ c is carried.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import callback, compiled, inlined
from fem_lie._jit.stack import blocks_at, matrix_at, stack, vector_at
from fem_lie.forms.kernels.addresses import UFCX_SIGNATURE, Pointer
from fem_lie.lie.motions import add_turning

PlainShapes: TypeAlias = tuple[Array, Array, Array]
"""Shape functions at the points (g, k), their slopes G at those of all cells (m, g, 2, k), and what
nodes carry, A (m, k, 2, 3)."""


@compiled
def _point(
    H: Array,
    nodes: Indices,
    shapes: tuple[Array, Array, Array],
    work: tuple[Array, Array, Array],
    n: Array,
) -> float:
    """``x,₁ x,₂`` and ``a₁ a₂`` at a point, and the gradient ``n`` (k, 6) of ``c``; returns c.

    ``shapes`` are N, G and A there, ``work`` is x, a, and room for two vectors.
    """
    (N, G, A), (x, a, y) = shapes, work
    k = nodes.shape[0]
    x[:], a[:] = 0.0, 0.0
    for i in range(k):
        frame = H[nodes[i]]
        for b in range(2):
            for j in range(3):
                x[b, j] += G[b, i] * frame[0, j]
                for d in range(3):
                    a[b, j] += N[i] * A[i, b, d] * frame[1 + d, j]
    for i in range(k):
        frame = H[nodes[i]]
        for d in range(3):
            n[i, d] = 0.0
            for j in range(3):
                n[i, d] += frame[1 + d, j] * (a[0, j] * G[1, i] - a[1, j] * G[0, i])
        _local(frame, x[1], y[0])
        _local(frame, x[0], y[1])
        for d in range(3):
            e, f = (d + 1) % 3, (d + 2) % 3
            n[i, 3 + d] = N[i] * (
                A[i, 0, e] * y[0, f]
                - A[i, 0, f] * y[0, e]
                - A[i, 1, e] * y[1, f]
                + A[i, 1, f] * y[1, e]
            )
    return float(np.dot(a[0], x[1]) - np.dot(a[1], x[0]))


@compiled
def _local(frame: Array, v: Array, out: Array) -> None:
    for d in range(3):
        out[d] = frame[1 + d, 0] * v[0] + frame[1 + d, 1] * v[1] + frame[1 + d, 2] * v[2]


@compiled
def strains(
    H: Array, cells: Indices, shapes: PlainShapes, rest: Array, h: Array, out: tuple[Array, Array]
) -> None:
    """``c`` and its change along twists ``h`` (n, 6), both in ``out``, of shape (m, g)."""
    (N, G, A), (c, change) = shapes, out
    x, a, y = np.empty((2, 3)), np.empty((2, 3)), np.empty((2, 3))
    n = np.empty((cells.shape[1], 6))
    for e in range(cells.shape[0]):
        for g in range(N.shape[0]):
            here = N[g], G[e, g], A[e]
            c[e, g] = _point(H, cells[e], here, (x, a, y), n) - rest[e, g]
            change[e, g] = 0.0
            for i in range(cells.shape[1]):
                for k in range(6):
                    change[e, g] += n[i, k] * h[cells[e, i], k]


@compiled
def add_forces(
    H: Array, cells: Indices, shapes: PlainShapes, rest: Array, weight: Array, out: Array
) -> None:
    """``w c n`` of all points, added to ``out`` (n, 6)."""
    N, G, A = shapes
    x, a, y = np.empty((2, 3)), np.empty((2, 3)), np.empty((2, 3))
    n = np.empty((cells.shape[1], 6))
    for e in range(cells.shape[0]):
        for g in range(N.shape[0]):
            here = N[g], G[e, g], A[e]
            c = _point(H, cells[e], here, (x, a, y), n) - rest[e, g]
            for i in range(cells.shape[1]):
                for k in range(6):
                    out[cells[e, i], k] += weight[e, g] * c * n[i, k]


@inlined
def _add_own(S: float, n: Array, N: float, A: Array, work: tuple[Array, Array], own: Array) -> None:
    """What a node's own turning does to its forces ``S n``.

    ``work`` is ``R_jᵀ`` of x,₂ and x,₁, and room for six numbers.
    """
    y, force = work
    for d in range(6):
        force[d] = S * n[d]
    add_turning(force, 1.0, own)
    for d in range(3):
        # (R_jᵀ b)^ and A (R_jᵀ x)^ of the node's own turning
        p, q = (d + 1) % 3, (d + 2) % 3
        own[q, 3 + p] += S * n[d]
        own[p, 3 + q] -= S * n[d]
        for f in range(3):
            own[3 + d, 3 + f] += S * N * (y[0, d] * A[0, f] - y[1, d] * A[1, f])
        own[3 + d, 3 + d] -= S * N * (np.dot(A[0], y[0]) - np.dot(A[1], y[1]))


@inlined
def _mixed(S: float, N: float, G: Array, A: Array, M: Array) -> None:
    """``M = S (G₁_j Â₂_i − G₂_j Â₁_i) N_i``: translation of j, rotation of i; ``G`` is of j."""
    for d in range(3):
        s = S * N * (G[0] * A[1, d] - G[1] * A[0, d])
        M[d, d] = 0.0
        M[(d + 2) % 3, (d + 1) % 3] = s
        M[(d + 1) % 3, (d + 2) % 3] = -s


@compiled
def add_tangent(
    H: Array,
    cells: Indices,
    shapes: PlainShapes,
    factors: tuple[Array, Array],
    place: Indices,
    K: Array,
) -> None:
    """Second derivative along :func:`~fem_lie.lie.motions.retract`.

    ``∂r/∂h`` in twists is ``w n nᵀ + S ∂n/∂h`` with the carried stress ``S`` times area; what that
    motion has beyond is of the carried forces ``S n``, too.
    """
    (N, G, A), (weight, stress) = shapes, factors
    k = cells.shape[1]
    x, a, y = np.empty((2, 3)), np.empty((2, 3)), np.empty((2, 3))
    n, force, Q, M = np.empty((k, 6)), np.empty(6), np.empty((3, 3)), np.empty((3, 3))
    for e in range(cells.shape[0]):
        for g in range(N.shape[0]):
            _point(H, cells[e], (N[g], G[e, g], A[e]), (x, a, y), n)
            w, S = weight[e, g], stress[e, g]
            for j in range(k):
                frame = H[cells[e, j]]
                _local(frame, x[1], y[0])
                _local(frame, x[0], y[1])
                _add_own(S, n[j], N[g, j], A[e, j], (y, force), K[place[e, j, j]])
                for i in range(k):
                    block, across = K[place[e, j, i]], K[place[e, i, j]]
                    for d in range(6):
                        for f in range(6):
                            block[d, f] += w * n[j, d] * n[i, f]
                    other = H[cells[e, i]]
                    for d in range(3):
                        for f in range(3):
                            Q[d, f] = np.dot(frame[1 + d], other[1 + f])
                    _mixed(S, N[g, i], G[e, g, :, j], A[e, i], M)
                    for d in range(3):
                        for f in range(3):
                            value = 0.0
                            for p in range(3):
                                value += Q[d, p] * M[p, f]
                            block[d, 3 + f] += value
                            across[3 + f, d] += value


# --- cells one by one, of which conserving steps ask for energy and forces ---


def cell_data(shapes: PlainShapes, weight: Array, rest: Array) -> Array:
    """Numbers of each cell that follow the rows of its nodes, shape (m, any)."""
    N, G, A = shapes
    m = len(A)
    parts = [np.broadcast_to(N, (m, *N.shape)), G, A, weight, rest]
    return np.hstack([part.reshape(m, -1) for part in parts])


_Cell: TypeAlias = tuple[Array, tuple[Array, Array, Array], Array, Array]
"""Rows of the nodes of a cell, N, G and A, and weights and rest values."""


@inlined
def _cell(w: Pointer, c: Pointer) -> _Cell:
    """A cell with ``c[0]`` nodes and ``c[1]`` points."""
    k, count = int(c[0]), int(c[1])
    at_N = 12 * k
    at_G = at_N + count * k
    at_A = at_G + 2 * count * k
    at_w = at_A + 6 * k
    numbers = vector_at(w, at_w + 2 * count)
    N = numbers[at_N:at_G].reshape((count, k))
    G = numbers[at_G:at_A].reshape((count, 2, k))
    shapes = N, G, numbers[at_A:at_w].reshape((k, 2, 3))
    weight, rest = numbers[at_w : at_w + count], numbers[at_w + count :]
    return blocks_at(w, k, 4, 3), shapes, weight, rest


@inlined
def _own_numbers(nodes: Indices) -> None:
    for i in range(len(nodes)):
        nodes[i] = i


@callback(UFCX_SIGNATURE)
def energy_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Energy of a cell with the numbers of :func:`cell_data`."""
    rows, (N, G, carried), weight, rest = _cell(w, c)
    k = len(rows)
    room, n = blocks_at(stack(18), 3, 2, 3), matrix_at(stack(6 * k), k, 6)
    nodes = vector_at(stack(k), k).view(np.int64)
    _own_numbers(nodes)
    work = room[0], room[1], room[2]
    for g in range(len(rest)):
        value = _point(rows, nodes, (N[g], G[g], carried), work, n) - rest[g]
        A[0] += 0.5 * weight[g] * value * value


@callback(UFCX_SIGNATURE)
def force_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Its forces."""
    rows, (N, G, carried), weight, rest = _cell(w, c)
    k = len(rows)
    room, n = blocks_at(stack(18), 3, 2, 3), matrix_at(stack(6 * k), k, 6)
    nodes = vector_at(stack(k), k).view(np.int64)
    _own_numbers(nodes)
    work, out = (room[0], room[1], room[2]), matrix_at(A, k, 6)
    for g in range(len(rest)):
        value = _point(rows, nodes, (N[g], G[g], carried), work, n) - rest[g]
        for i in range(k):
            for d in range(6):
                out[i, d] += weight[g] * value * n[i, d]
