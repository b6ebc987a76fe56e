"""Energy ``½ zᵀ K z`` of bodies that deform in few shapes, as cells: compiled.

The cell is all nodes of the body; coordinates ``z`` are those of
:mod:`fem_lie.lie.kinds.floating`. Constants are the number of nodes, of other interfaces and of
coordinates; data behind the rows of the nodes are places and directors of these interfaces, 12
each, and ``K``.
"""

from __future__ import annotations

import numba
import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import callback, compiled
from fem_lie.forms.kernels.addresses import UFCX_SIGNATURE, Pointer
from fem_lie.lie.kinds.floating_coordinates import Rows, coordinates, spread
from fem_lie.lie.kinds.forces import pull, pull_derivative, push
from fem_lie.lie.kinds.kind import AMPLITUDE

_STEP = 1e-30


@compiled
def _cell(w: Pointer, c: Pointer) -> tuple[Array, Array, Array]:
    """Rows of the nodes, interfaces, and stiffness."""
    sizes = numba.carray(c, (3,))
    k, others, m = int(sizes[0]), int(sizes[1]), int(sizes[2])
    head = 12 * (k + others)
    data = numba.carray(w, (head + m * m,))
    q = data[: 12 * k].reshape((k, 4, 3))
    return q, data[12 * k : head].reshape((others, 4, 3)), data[head:].reshape((m, m))


@compiled
def _forces(q: Rows, interfaces: Array, K: Array, f: Rows) -> None:
    """Set forces on rows ``q`` (k, 4, 3)."""
    m = K.shape[0]
    z, g = np.zeros(m, q.dtype), np.zeros(m, q.dtype)
    coordinates(q, interfaces, z)
    for a in range(m):
        for b in range(m):
            g[a] += K[a, b] * z[b]
    f[:] = 0.0
    spread(g, q, interfaces, f)


@compiled
def _kind(node: int, others: int) -> int:
    """Of a node of the cell, whatever the group of frames."""
    return 0 if node <= others else AMPLITUDE


@callback(UFCX_SIGNATURE)
def energy_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """The energy."""
    q, interfaces, K = _cell(w, c)
    z, value = np.zeros(K.shape[0]), numba.carray(A, (1,))
    coordinates(q, interfaces, z)
    for a in range(K.shape[0]):
        for b in range(K.shape[0]):
            value[0] += 0.5 * z[a] * K[a, b] * z[b]


@callback(UFCX_SIGNATURE)
def force_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Forces on the nodes, in their axes."""
    q, interfaces, K = _cell(w, c)
    f, out = np.empty_like(q), numba.carray(A, (q.shape[0], 6))
    _forces(q, interfaces, K, f)
    for i in range(q.shape[0]):
        pull(_kind(i, interfaces.shape[0]), q[i], f[i], 1.0, out[i])


@callback(UFCX_SIGNATURE)
def matrix_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Their derivative in the nodes' twists."""
    q, interfaces, K = _cell(w, c)
    k, others = q.shape[0], interfaces.shape[0]
    out = numba.carray(A, (k, 6, k, 6))
    f, unit, pushed, own = np.empty_like(q), np.empty(6), np.empty((4, 3)), np.empty(6)
    _forces(q, interfaces, K, f)
    for i in range(k):
        pull_derivative(_kind(i, others), q[i], f[i], 1.0, out[i, :, i])
    moved, changed = np.zeros(q.shape, np.complex128), np.empty(q.shape, np.complex128)
    moved[:] = q
    for j in range(k):
        for column in range(6):
            unit[:] = 0.0
            unit[column] = 1.0
            push(_kind(j, others), q[j], unit, pushed)
            moved[j] = q[j] + 1j * _STEP * pushed
            _forces(moved, interfaces, K, changed)
            for i in range(k):
                own[:] = 0.0
                pull(_kind(i, others), q[i], changed[i].imag / _STEP, 1.0, own)
                out[i, :, j, column] += own
        moved[j] = q[j]
