"""Energy ``½ eᵀ K e`` of bodies that deform in few shapes, as cells: compiled.

The cell is all nodes of the body; coordinates ``z`` are those of
:mod:`fem_lie.lie.kinds.floating`, and ``e_a = z_a + ½ Q_abc z_b z_c``. Constants are the number of
nodes, of other interfaces and of coordinates; data behind the rows of the nodes are places and
directors of these interfaces, 12 each, ``K`` and ``Q``, which is symmetric in its last two.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import callback, compiled
from fem_lie.forms.kernels.addresses import UFCX_SIGNATURE, Pointer
from fem_lie.lie.kinds.floating_coordinates import coordinates, spread
from fem_lie.lie.kinds.forces import pull, pull_derivative, push
from fem_lie.lie.kinds.kind import AMPLITUDE

_STEP = 1e-30


class _Cell(NamedTuple):
    """Rows of the nodes (k, 4, 3), interfaces (i, 4, 3), ``K`` (m, m) and ``Q`` (m, m, m)."""

    q: Array
    interfaces: Array
    K: Array
    Q: Array


@compiled
def _cell(w: Pointer, c: Pointer) -> _Cell:
    sizes = numba.carray(c, (3,))
    k, others, m = int(sizes[0]), int(sizes[1]), int(sizes[2])
    head = 12 * (k + others)
    middle = head + m * m
    data = numba.carray(w, (middle + m * m * m,))
    q = data[: 12 * k].reshape((k, 4, 3))
    interfaces = data[12 * k : head].reshape((others, 4, 3))
    K, Q = data[head:middle].reshape((m, m)), data[middle:].reshape((m, m, m))
    return _Cell(q, interfaces, K, Q)


@compiled
def _strained(cell: _Cell) -> tuple[Array, Array, Array]:
    """Strains ``e`` (m,), their derivative (m, m) and stresses ``K e``."""
    m = cell.K.shape[0]
    z, e, J = np.zeros(m), np.zeros(m), np.eye(m)
    coordinates(cell.q, cell.interfaces, z)
    for a in range(m):
        for b in range(m):
            for c in range(m):
                J[a, b] += cell.Q[a, b, c] * z[c]
            e[a] += 0.5 * J[a, b] * z[b]
        e[a] += 0.5 * z[a]
    return e, J, _times(cell.K, e)


@compiled
def _times(A: Array, x: Array) -> Array:
    """The product ``A x``."""
    found = np.zeros(A.shape[0])
    for a in range(A.shape[0]):
        for b in range(A.shape[1]):
            found[a] += A[a, b] * x[b]
    return found


@compiled
def _stiffness(cell: _Cell, J: Array, s: Array) -> Array:
    """Second derivative of the energy, ``Jᵀ K J + s_a Q_abc``."""
    m = cell.K.shape[0]
    KJ, found = np.zeros((m, m)), np.zeros((m, m))
    for a in range(m):
        for b in range(m):
            for c in range(m):
                KJ[a, c] += cell.K[a, b] * J[b, c]
    for a in range(m):
        for b in range(m):
            for c in range(m):
                found[b, c] += J[a, b] * KJ[a, c] + s[a] * cell.Q[a, b, c]
    return found


@compiled
def _kind(node: int, others: int) -> int:
    """Of a node of the cell, whatever the group of frames."""
    return 0 if node <= others else AMPLITUDE


@callback(UFCX_SIGNATURE)
def energy_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """The energy."""
    e, _, s = _strained(_cell(w, c))
    value = numba.carray(A, (1,))
    for a in range(e.shape[0]):
        value[0] += 0.5 * e[a] * s[a]


@callback(UFCX_SIGNATURE)
def force_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Forces on the nodes, in their axes."""
    cell = _cell(w, c)
    q, interfaces = cell.q, cell.interfaces
    _, J, s = _strained(cell)
    f, out = np.zeros_like(q), numba.carray(A, (q.shape[0], 6))
    spread(_times(J.T, s), q, interfaces, f)
    for i in range(q.shape[0]):
        pull(_kind(i, interfaces.shape[0]), q[i], f[i], 1.0, out[i])


@callback(UFCX_SIGNATURE)
def matrix_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Their derivative in the nodes' twists."""
    cell = _cell(w, c)
    q, interfaces = cell.q, cell.interfaces
    k, others, m = q.shape[0], interfaces.shape[0], cell.K.shape[0]
    _, J, s = _strained(cell)
    g, H = _times(J.T, s), _stiffness(cell, J, s)
    out = numba.carray(A, (k, 6, k, 6))
    f, unit, pushed, own = np.zeros_like(q), np.empty(6), np.empty((4, 3)), np.empty(6)
    spread(g, q, interfaces, f)
    for i in range(k):
        pull_derivative(_kind(i, others), q[i], f[i], 1.0, out[i, :, i])
    moved, changed = q.astype(np.complex128), np.empty(q.shape, np.complex128)
    z = np.zeros(m, np.complex128)
    for j in range(k):
        for column in range(6):
            unit[:] = 0.0
            unit[column] = 1.0
            push(_kind(j, others), q[j], unit, pushed)
            moved[j] = q[j] + 1j * _STEP * pushed
            coordinates(moved, interfaces, z)
            changed[:] = 0.0
            spread(g + 1j * _times(H, z.imag.copy()), moved, interfaces, changed)
            for i in range(k):
                own[:] = 0.0
                pull(_kind(i, others), q[i], changed[i].imag / _STEP, 1.0, own)
                out[i, :, j, column] += own
        moved[j] = q[j]
