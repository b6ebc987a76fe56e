"""Hermite vectors of a thin-shell cell from its nodes, and forces back on the nodes: compiled.

A corner of a cell is two nodes, a SURFACE_GRADIENT and a MIXED_DERIVATIVE node of
:mod:`fem_lie.lie.node_types`; a cell has its four SURFACE_GRADIENT nodes first, then their
MIXED_DERIVATIVE nodes. The vectors ``q`` (16, 3) are, at each corner, the position and its
derivatives along ξ, η and both. Nodes have derivatives in the parameters of the patch, the mixed
one times an area.

A corner of a refined cell may be a hanging node: the midpoint of an edge of the larger neighbour.
It has no unknowns. The cell uses the node at the far end of that edge instead, and the vectors of
the corner are those of the cubic edge at its midpoint. So each cell has four points, whatever its
neighbours, and kernels do not distinguish the cases.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined
from fem_lie.lie.node_types.node_type import MIXED_DERIVATIVE, SURFACE_GRADIENT, axes
from fem_lie.lie.tuples import load, load_row, rotate, rotate_back, scaled, store

CORNERS, VECTORS, NODES, UNKNOWNS = 4, 16, 8, 48
SIZES = 4
"""Sizes of a cell: factors of ∂u, ∂v and the mixed derivative, and a code of hanging corners."""
COORDINATES: Indices = np.concatenate(
    [4 * np.arange(CORNERS)[:, np.newaxis] + pair for pair in ((0, 1), (3, 2))]
).ravel()
"""Index of the Hermite vector of each coordinate vector, one node after the other."""


@inlined
def node_of(a: int) -> int:
    """Node of the cell that has the Hermite vector ``a``."""
    return a // 4 + (CORNERS if a % 4 >= 2 else 0)


@inlined
def half_of(a: int) -> int:
    """Index (0 or 1) of the Hermite vector ``a`` among the vectors of its node."""
    return 1 if a % 4 == 1 or a % 4 == 2 else 0


@inlined
def row_of(a: int) -> int:
    """Row of the node's coordinates with the Hermite vector ``a``."""
    return half_of(a) + (1 if a % 4 >= 2 else 0)


@inlined
def scale_of(a: int, sizes: Array) -> float:
    """Factor of that row; ``sizes`` (≥ 3,): of ∂ξ, ∂η and both."""
    return 1.0 if a % 4 == 0 else sizes[a % 4 - 1]


@inlined
def _hangs(code: int, k: int) -> bool:
    return (code >> (2 + k)) & 1 == 1


@inlined
def _edge_vectors(code: int, k: int, m: int) -> tuple[int, int, int, float]:
    """Hermite vectors at the regular and the hanging corner, derivative along the edge; side.

    Along the edge the derivatives of positions are gradients (``m`` 0), and those of gradients
    across are mixed derivatives (``m`` 1).
    """
    own = code & 3
    first = m * (2 >> k)
    side = 1.0 - 2.0 * ((own >> k) & 1)
    return 4 * own + first, 4 * (own ^ (1 << k)) + first, 1 << k, side


@compiled
def fill_hanging(code: int, q: Array) -> None:
    """Set vectors of hanging corners from those of both ends of their edges; ``q`` (16, any)."""
    for k in range(2):
        if _hangs(code, k):
            for m in range(2):
                own, end, slope, side = _edge_vectors(code, k, m)
                for j in range(q.shape[1]):
                    a, da, b, db = q[own, j], q[own + slope, j], q[end, j], q[end + slope, j]
                    # derivatives are in the parameters of the quarter, half those of the edge
                    q[end, j] = 0.5 * (a + b) + 0.25 * side * (da - db)
                    q[end + slope, j] = 0.75 * side * (b - a) - 0.25 * (da + db)


@compiled
def pull_hanging(code: int, f: Array) -> None:
    """Transpose of :func:`fill_hanging`: forces ``f`` (16, any) on vectors of the ends."""
    for k in range(2):
        if _hangs(code, k):
            for m in range(2):
                own, end, slope, side = _edge_vectors(code, k, m)
                for j in range(f.shape[1]):
                    g, dg = f[end, j], f[end + slope, j]
                    f[own, j] += 0.5 * g - 0.75 * side * dg
                    f[own + slope, j] += 0.25 * (side * g - dg)
                    f[end, j] = 0.5 * g + 0.75 * side * dg
                    f[end + slope, j] = -0.25 * (side * g + dg)


@inlined
def _kind(node: int) -> int:
    return SURFACE_GRADIENT if node < CORNERS else MIXED_DERIVATIVE


@compiled
def gather(H: Array, sizes: Array, q: Array) -> None:
    """Hermite vectors ``q`` (16, 3) of the coordinates of a cell's nodes (8, 4, 3)."""
    for a in range(VECTORS):
        store(q[a], 0, scaled(scale_of(a, sizes), load_row(H[node_of(a)], row_of(a))))
    fill_hanging(int(sizes[3]), q)


@compiled
def gather_motion(H: Array, sizes: Array, h: Array, q: Array) -> None:
    """Changes ``δq`` (16, 3) by increments ``h`` (8, 6) of the nodes along their axes."""
    for a in range(VECTORS):
        node = node_of(a)
        d1, d2, d3 = axes(_kind(node), H[node])
        moved = rotate(d1, d2, d3, load(h[node], 3 * half_of(a)))
        store(q[a], 0, scaled(scale_of(a, sizes), moved))
    fill_hanging(int(sizes[3]), q)


@compiled
def pull(H: Array, sizes: Array, f: Array, out: Array) -> None:
    """Add forces ``f`` (16, 3) on the vectors as forces on the nodes to ``out`` (8, 6).

    ``f`` is overwritten.
    """
    pull_hanging(int(sizes[3]), f)
    for node in range(NODES):
        d1, d2, d3 = axes(_kind(node), H[node])
        for a in range(4 * (node % CORNERS), 4 * (node % CORNERS) + 4):
            if node_of(a) == node:
                local = rotate_back(d1, d2, d3, scaled(scale_of(a, sizes), load(f[a], 0)))
                for k in range(3):
                    out[node, 3 * half_of(a) + k] += local[k]


@compiled
def pull_matrix(H: Array, sizes: Array, K: Array, R: Array, out: Array) -> None:
    """Add ``K`` (48, 48) on the vectors to the matrix of the nodes, ``out`` (8, 6, 8, 6).

    ``K`` is overwritten; ``R``: workspace, shape (8, 3, 3).
    """
    for k in range(3):
        pull_hanging(int(sizes[3]), K[k::3])
        pull_hanging(int(sizes[3]), K[:, k::3].T)
    for node in range(NODES):
        for k, axis in enumerate(axes(_kind(node), H[node])):
            store(R[node, k], 0, axis)
    turned = np.empty((3, 3))
    for a in range(VECTORS):
        i, first = node_of(a), 3 * half_of(a)
        for b in range(VECTORS):
            j, second = node_of(b), 3 * half_of(b)
            scale = scale_of(a, sizes) * scale_of(b, sizes)
            for m in range(3):
                for n in range(3):
                    turned[m, n] = 0.0
                    for k in range(3):
                        turned[m, n] += K[3 * a + m, 3 * b + k] * R[j, n, k]
            for m in range(3):
                for n in range(3):
                    s = 0.0
                    for k in range(3):
                        s += R[i, m, k] * turned[k, n]
                    out[i, first + m, j, second + n] += scale * s


@compiled
def pull_symmetric(H: Array, sizes: Array, K: Array, out: Array) -> None:
    """:func:`pull_matrix` for a symmetric ``K`` with components first, ``[16 i + a, …]``.

    It is read where ``j ≥ i``, and overwritten.
    """
    R, half = np.empty((3, 3, VECTORS)), np.empty((3, VECTORS))
    node, first, scale = np.empty(VECTORS, np.int64), np.empty(VECTORS, np.int64), np.empty(VECTORS)
    for a in range(VECTORS):
        node[a], first[a], scale[a] = node_of(a), 3 * half_of(a), scale_of(a, sizes)
        for k, axis in enumerate(axes(_kind(node[a]), H[node[a]])):
            for j in range(3):
                R[k, j, a] = scale[a] * axis[j]
    for a in range(UNKNOWNS):
        for b in range(VECTORS * (a // VECTORS), UNKNOWNS):
            K[b, a] = K[a, b]
    for k in range(0, UNKNOWNS, VECTORS):
        pull_hanging(int(sizes[3]), K[k : k + VECTORS])
        pull_hanging(int(sizes[3]), K[:, k : k + VECTORS].T)
    for a in range(UNKNOWNS):
        for k in range(3):
            for b in range(VECTORS):
                plane = R[k, 0, b] * K[a, b] + R[k, 1, b] * K[a, VECTORS + b]
                half[k, b] = plane + R[k, 2, b] * K[a, 2 * VECTORS + b]
        for k in range(3):
            for b in range(VECTORS):
                K[a, VECTORS * k + b] = half[k, b]
    for a in range(VECTORS):
        for k in range(3):
            x, y, z = R[k, 0, a], R[k, 1, a], R[k, 2, a]
            for n in range(3):
                for b in range(VECTORS):
                    c = VECTORS * n + b
                    plane = x * K[a, c] + y * K[VECTORS + a, c]
                    entry = plane + z * K[2 * VECTORS + a, c]
                    out[node[a], first[a] + k, node[b], first[b] + n] += entry
