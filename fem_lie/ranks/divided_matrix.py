"""Sum of the matrices of all parts of a scene: one matrix of PETSc, with rows on all ranks."""

from __future__ import annotations

from typing import Any

from petsc4py import PETSc

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.ranks.shared_nodes import SharedNodes


def with_diagonal(A: sp.csr_matrix) -> sp.csr_matrix:
    """A copy of a square matrix in which each row has an entry on the diagonal, even if it is zero.

    PETSc passes symmetric matrices of several ranks to MUMPS from the diagonal of each row on, and
    loses rows that have none.
    """
    entries, every = A.tocoo(), np.arange(A.shape[0])
    rows, columns = np.append(entries.row, every), np.append(entries.col, every)
    values = np.append(entries.data, np.zeros(len(every)))
    found = sp.csr_matrix((values, (rows, columns)), shape=A.shape)
    found.sort_indices()
    return found


class DividedMatrix:
    """Sum of the matrices of all parts; all methods are collective.

    Rows of a shared node are those of its owner. Multipliers belong to one part each. On one rank
    it is the matrix itself.

    Attributes:
        matrix: The PETSc matrix on all ranks.
    """

    def __init__(
        self,
        csr: tuple[Array, npt.NDArray[Any], npt.NDArray[Any]],
        shared: SharedNodes,
        rows: Indices | None = None,
    ) -> None:
        """Number the rows of all ranks; :meth:`take` sets the values.

        Args:
            csr: Values, columns, row pointers of the matrix of this part.
            shared: Nodes that other ranks have, too.
            rows: Unknowns of the rows among those of the part, which are six for each node, then
                the multipliers; default: all. A shared node has the same ones on all ranks.
        """
        # objects without references on any rank are freed by all ranks together
        PETSc.garbage_cleanup(shared.comm)
        self._values, columns, pointers = csr
        size, nodes, comm = len(pointers) - 1, len(shared.owned), shared.comm
        rows = np.arange(size) if rows is None else rows
        of_node = rows < 6 * nodes
        owned = np.full(size, True)
        owned[of_node] = shared.owned[rows[of_node] // 6]
        self._owned: Indices = rows[owned]
        self._shared, self._nodes = shared, nodes
        self._parts = None
        self._local = PETSc.Mat().createAIJWithArrays(
            (size, size), (pointers, columns, self._values), comm=PETSc.COMM_SELF
        )
        if shared.several:
            numbers = self._numbers(rows, owned, of_node)
            own = PETSc.LGMap().create(numbers, comm=comm)
            mine, total = int(owned.sum()), comm.allreduce(int(owned.sum()))
            self._parts = PETSc.Mat().create(comm)
            self._parts.setSizes(((mine, total),) * 2)
            self._parts.setType(PETSc.Mat.Type.IS)
            self._parts.setLGMap(own, own)
            self._parts.setISLocalMat(self._local)
            self._parts.assemble()
            self.matrix: PETSc.Mat = self._parts.convert(PETSc.Mat.Type.AIJ, PETSc.Mat())
        else:
            self.matrix = self._local
        self._b, self._x = self.matrix.createVecs()

    def _numbers(self, rows: Indices, owned: Flags, of_node: Flags) -> npt.NDArray[Any]:
        """Number of each row among those of all ranks."""
        mine = int(owned.sum())
        first = self._shared.comm.scan(mine) - mine
        numbers = np.zeros(len(rows), dtype=PETSc.IntType)
        numbers[owned] = first + np.arange(mine)
        copies = np.zeros(6 * self._nodes, dtype=PETSc.IntType)
        copies[rows[of_node]] = numbers[of_node]
        self._shared.take_from_owners(copies.reshape(-1, 6))
        numbers[of_node] = copies[rows[of_node]]
        return numbers

    def take(self) -> None:
        """Sum the current values of all parts."""
        self._local.stateIncrease()
        self._local.assemble()
        if self._parts is not None:
            self._parts.stateIncrease()
            self._parts.assemble()
            self._parts.convert(PETSc.Mat.Type.AIJ, self.matrix)

    def solve(self, ksp: PETSc.KSP, b: Array, x: Array) -> None:
        """Solve ``A x = b``, both with the same values at all copies of a node.

        Args:
            ksp: Solver of the matrix.
            b: Right-hand side of all unknowns of the part.
            x: Solution; the unknowns of the rows and of shared nodes are overwritten.
        """
        self._b.array[:] = b[self._owned]
        ksp.solve(self._b, self._x)
        self.put(self._x, x)

    def put(self, vector: PETSc.Vec, x: Array) -> None:
        """Copy a vector of the matrix into one of all unknowns of the part.

        Args:
            vector: The vector.
            x: The unknowns of the rows and of shared nodes are overwritten.
        """
        x[self._owned] = vector.array
        self._shared.take_from_owners(x[: 6 * self._nodes].reshape(-1, 6))
