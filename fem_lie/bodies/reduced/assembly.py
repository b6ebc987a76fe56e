"""Reduced-order bodies: assembly of their strain energy as cells; compiled.

The energy is ``½ eᵀ K e`` with ``e_a = z_a + ½ Q_abc z_b z_c`` and the coordinates ``z`` of
:mod:`fem_lie.lie.node_types.floating`. A cell has all nodes of a body. Its constants are the
numbers of nodes, of other interfaces and of coordinates. Its data are, behind the nodal
coordinates, positions and directors of these interfaces, 12 each, ``K`` and ``Q``, with the last
index of ``Q`` first. The small-energy kernel does not apply, since strains depend on as many
products as there are modes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numba
import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import callback, compiled, uncounted
from fem_lie._jit.stack import blocks_at, matrix_at, stack
from fem_lie.forms.assembly import BodyTerm, NodalInertia
from fem_lie.forms.cell_sums import CellSum, CellTerm
from fem_lie.forms.kernels.addresses import UFCX_SIGNATURE, Pointer
from fem_lie.lie.node_types.floating_coordinates import add_times, coordinates, spread, strains
from fem_lie.lie.node_types.forces import pull_back, pull_back_derivative, push_forward
from fem_lie.lie.node_types.node_type import MODAL

_STEP = 1e-30


class _Cell(NamedTuple):
    """Nodal coordinates (k, 4, 3), interfaces (i, 4, 3), ``K``, ``Q_abc`` at ``[c, a, b]``."""

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


@uncounted
def _strain(cell: _Cell, J: Array, some: Array) -> None:
    """Set the derivative ``J`` (m, m) of strains, and ``z``, ``e``, stresses ``K e`` (3, m)."""
    coordinates(cell.q, cell.interfaces, some[0])
    strains(cell.Q, some[0], J, some[1])
    some[2, :] = 0.0
    add_times(cell.K, some[1], some[2])


@compiled
def _stiffness(cell: _Cell, J: Array, s: Array) -> Array:
    """Second derivative of the energy, ``Jᵀ K J + s_a Q_abc``, shape (m, m)."""
    found = J.T @ (cell.K @ J)
    for c in range(len(s)):
        add_times(cell.Q[c], s, found[c])
    return found


@compiled
def _kind(node: int, others: int) -> int:
    """Type of a node of the cell; the group of frames does not matter here."""
    return 0 if node <= others else MODAL


@callback(UFCX_SIGNATURE)
def energy_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Add the strain energy of a cell."""
    cell = _cell(w, c)
    m, value = cell.K.shape[0], numba.carray(A, (1,))
    some = matrix_at(stack(3 * m), 3, m)
    _strain(cell, matrix_at(stack(m * m), m, m), some)
    for a in range(m):
        value[0] += 0.5 * some[1, a] * some[2, a]


@callback(UFCX_SIGNATURE)
def force_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Add the forces on the nodes of a cell, along their axes."""
    cell = _cell(w, c)
    q, interfaces = cell.q, cell.interfaces
    k, m = q.shape[0], cell.K.shape[0]
    J, some = matrix_at(stack(m * m), m, m), matrix_at(stack(4 * m), 4, m)
    f, out = blocks_at(stack(12 * k), k, 4, 3), numba.carray(A, (k, 6))
    _strain(cell, J, some[:3])
    f[:], some[3] = 0.0, 0.0
    add_times(J, some[2], some[3])
    spread(some[3], q, interfaces, f)
    for i in range(k):
        pull_back(_kind(i, interfaces.shape[0]), q[i], f[i], 1.0, out[i])


@callback(UFCX_SIGNATURE)
def matrix_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Add the tangent stiffness of a cell in the twists of its nodes."""
    cell = _cell(w, c)
    q, interfaces = cell.q, cell.interfaces
    k, others, m = q.shape[0], interfaces.shape[0], cell.K.shape[0]
    J, some = np.empty((m, m)), np.zeros((4, m))
    _strain(cell, J, some[:3])
    g, H = some[3], _stiffness(cell, J, some[2])
    add_times(J, some[2], g)
    out = numba.carray(A, (k, 6, k, 6))
    f, unit, pushed, own = np.zeros_like(q), np.empty(6), np.empty((4, 3)), np.empty(6)
    spread(g, q, interfaces, f)
    for i in range(k):
        pull_back_derivative(_kind(i, others), q[i], f[i], 1.0, out[i, :, i])
    moved, changed = q.astype(np.complex128), np.empty(q.shape, np.complex128)
    z = np.zeros(m, np.complex128)
    for j in range(k):
        for column in range(6):
            unit[:] = 0.0
            unit[column] = 1.0
            push_forward(_kind(j, others), q[j], unit, pushed)
            moved[j] = q[j] + 1j * _STEP * pushed
            coordinates(moved, interfaces, z)
            changed[:] = 0.0
            spread(g + 1j * (H @ z.imag.copy()), moved, interfaces, changed)
            for i in range(k):
                own[:] = 0.0
                pull_back(_kind(i, others), q[i], changed[i].imag / _STEP, 1.0, own)
                out[i, :, j, column] += own
        moved[j] = q[j]


class ReducedData(Protocol):
    """Data of a reduced-order body that the assembly reads."""

    frames: Array
    within: Array
    stiffness: Array
    quadratic: Array
    density: Array


class ReducedAssembly(CellTerm, BodyTerm):
    """Reduced-order bodies as cells with all their nodes, in the order of the bodies."""

    label, within_frames = "reduced bodies", True

    def __init__(self, bodies: Sequence[ReducedData]) -> None:
        """Pack stiffness, and inertia of the frames."""
        count, k = len(bodies), len(bodies[0].frames)
        others, m = len(bodies[0].within), len(bodies[0].stiffness)
        cells = np.arange(count * k).reshape(count, k)
        super().__init__(cells, np.arange(count * k), np.arange(count))
        rows = [np.zeros((count, 12 * k))]
        rows += [np.array(each) for each in zip(*map(_packed, bodies), strict=True)]
        self._values = np.hstack(rows)
        self._sizes, nowhere = np.array([k, others, m], dtype=np.float64), np.zeros((count, 1))
        self._energy, self._forces, self._matrix = (
            CellSum(cells, kernel.address, self._values, self._sizes, nowhere)
            for kernel in (energy_kernel, force_kernel, matrix_kernel)
        )
        mass = np.zeros((count, k, 4, k, 4))
        mass[:, 0, :, 0] = [body.density[:4, :4] for body in bodies]
        self.inertia = NodalInertia(self.summed(mass))

    @property
    def contents(self) -> tuple[str, Array]:
        """Name and data of the energy, for fingerprints."""
        return "reduced body", self._values[:, 12 * self.cells.shape[1] :].copy()


def _packed(body: ReducedData) -> tuple[Array, Array, Array]:
    """Interfaces, ``K`` and ``Q`` of a body, flat, as the kernels read them."""
    last_first = body.quadratic.transpose(2, 0, 1)
    return body.within.ravel(), body.stiffness.ravel(), last_first.ravel()
