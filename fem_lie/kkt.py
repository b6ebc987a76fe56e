"""The one sparse matrix of a scene: 6×6 blocks of node pairs, bordered by constraint rows.

::

    [ S      Bᵀ σ ]
    [ σ BT   0    ]

with ``σ`` the scaling of the constraints, and ``T`` between increments and twists: with ``(BT)ᵀ``
as columns a body that turns by θ in a step would converge at the rate θ/2. It is filled by one
compiled loop into a PETSc matrix that shares its memory; unknowns that are held have unit rows.
"""

from __future__ import annotations

from typing import Any

from petsc4py import PETSc

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

from fem_lie._jit import Array, Indices, compiled
from fem_lie.constraints import JointTable

Flags = npt.NDArray[np.bool_]


@compiled
def _fill(
    bptr: Indices,
    bind: Indices,
    blocks: Array,
    held: Flags,
    iptr: Indices,
    ipairs: Indices,
    sides: Indices,
    columns: Array,
    rows: Array,
    scale: Array,
    data: Array,
) -> None:
    at = 0
    for i in range(bptr.shape[0] - 1):
        for k in range(6):
            for b in range(bptr[i], bptr[i + 1]):
                j = bind[b]
                for n in range(6):
                    if not (held[i, k] or held[j, n]):
                        data[at] = blocks[b, k, n]
                    else:
                        data[at] = 1.0 if i == j and k == n else 0.0
                    at += 1
            for entry in range(iptr[i], iptr[i + 1]):
                c, side = ipairs[entry, 0], ipairs[entry, 1]
                data[at] = 0.0 if held[i, k] else columns[c, side, k] * scale[c]
                at += 1
    for c in range(rows.shape[0]):
        for order in range(2):
            side = sides[c, order]
            if side >= 0:
                for n in range(6):
                    data[at] = rows[c, side, n] * scale[c]
                    at += 1


@compiled
def _clear_held(rows: Array, nodes: Indices, held: Flags) -> None:
    for c in range(rows.shape[0]):
        for side in range(2):
            node = nodes[c, side]
            for k in range(6):
                if node >= held.shape[0] or held[node, k]:
                    rows[c, side, k] = 0.0


class KKT:
    """Pattern and memory of the bordered matrix.

    Attributes:
        indptr: Rows of the pattern of node pairs, with ``indices``.
        matrix: The PETSc matrix; :meth:`fill` changes its values.
    """

    def __init__(
        self,
        pairs: list[tuple[Indices, Indices]],
        table: JointTable,
        held: Flags,
    ) -> None:
        """Build the pattern.

        Args:
            pairs: Rows and columns of coupled node pairs; joints and the diagonal are added.
            table: The joints.
            held: Which unknowns of the nodes are zero, shape (n, 6).
        """
        count, m = len(held), len(table.selection)
        per_constraint = np.repeat(np.arange(len(table.nodes)), np.diff(table.first))
        self._nodes, self._held = table.nodes[per_constraint], held
        moving = table.nodes[(table.nodes < count).all(axis=1)]
        diagonal = np.arange(count)
        r = np.concatenate([diagonal, moving[:, 0], moving[:, 1], *(p[0] for p in pairs)])
        c = np.concatenate([diagonal, moving[:, 1], moving[:, 0], *(p[1] for p in pairs)])
        pattern = sp.csr_matrix((np.ones(len(r)), (r, c)), shape=(count, count))
        pattern.sort_indices()
        self.indptr, self.indices = pattern.indptr, pattern.indices
        self._border(count, m)
        self._data = np.zeros(self._size)
        shape = 6 * count + m
        self.matrix = PETSc.Mat().createAIJWithArrays(
            (shape, shape), (self._row_pointers, self._columns, self._data), comm=PETSc.COMM_SELF
        )

    @property
    def csr(self) -> tuple[Array, npt.NDArray[Any], npt.NDArray[Any]]:
        """The matrix as it is now: values, columns, row pointers; views."""
        return self._data, self._columns, self._row_pointers

    def _border(self, count: int, m: int) -> None:
        """Which constraints touch which nodes, and the scalar pattern."""
        c, side = np.nonzero(self._nodes < count)
        node = self._nodes[c, side]
        order = np.lexsort((c, node))
        self._incident = np.stack([c, side], axis=1)[order]
        self._incident_ptr = np.searchsorted(node[order], np.arange(count + 1))
        key = np.where(self._nodes < count, self._nodes, -1)
        self._sides = np.argsort(np.where(key < 0, count, key), axis=1, kind="stable")
        self._sides[np.take_along_axis(key, self._sides, axis=1) < 0] = -1
        columns = []
        lengths = []
        for i in range(count):
            blocks = self.indices[self.indptr[i] : self.indptr[i + 1]]
            entries = self._incident[self._incident_ptr[i] : self._incident_ptr[i + 1], 0]
            row = np.concatenate(
                [(6 * blocks[:, np.newaxis] + np.arange(6)).ravel(), 6 * count + entries]
            )
            columns += [row] * 6
            lengths += [len(row)] * 6
        for constraint in range(m):
            sides = self._sides[constraint]
            nodes = self._nodes[constraint, sides[sides >= 0]]
            columns.append((6 * nodes[:, np.newaxis] + np.arange(6)).ravel())
            lengths.append(6 * len(nodes))
        self._row_pointers = np.concatenate([[0], np.cumsum(lengths)]).astype(PETSc.IntType)
        self._columns = np.concatenate(columns).astype(PETSc.IntType)
        self._size = len(self._columns)

    def place(self, rows: Indices, columns: Indices) -> Indices:
        """Positions of node pairs among the blocks; -1 where a node does not move."""
        count = len(self._held)
        key = np.repeat(np.arange(count), np.diff(self.indptr)) * count + self.indices
        moves = (rows < count) & (columns < count)
        found = np.searchsorted(key, np.where(moves, rows * count + columns, 0))
        return np.where(moves, found, -1)

    def fill(self, blocks: Array, columns: Array, rows: Array, scale: Array) -> None:
        """Set the values.

        Args:
            blocks: ``S``, shape (nnz, 6, 6).
            columns: ``B`` in the twists of nodes A and B, shape (m, 2, 6); those of nodes that do
                not move are set to zero, as in ``rows``.
            rows: ``BT`` in their increments, shape (m, 2, 6).
            scale: ``σ``, shape (m,).
        """
        _clear_held(columns, self._nodes, self._held)
        _clear_held(rows, self._nodes, self._held)
        _fill(
            self.indptr,
            self.indices,
            blocks,
            self._held,
            self._incident_ptr,
            self._incident,
            self._sides,
            columns,
            rows,
            scale,
            self._data,
        )
        self.matrix.stateIncrease()
        self.matrix.assemble()
