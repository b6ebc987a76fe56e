"""Sum of the matrices of all parts of a scene: one matrix of PETSc, with rows on all ranks."""

from __future__ import annotations

from typing import Any

from petsc4py import PETSc

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices
from fem_lie.ranks.shared_nodes import SharedNodes


class DividedMatrix:
    """Sum of the matrices of all parts; all methods are collective.

    Rows of a shared node are those of its owner. Multipliers belong to one part each.

    Attributes:
        matrix: The PETSc matrix on all ranks.
    """

    def __init__(
        self, csr: tuple[Array, npt.NDArray[Any], npt.NDArray[Any]], shared: SharedNodes
    ) -> None:
        """Number the rows of all ranks; :meth:`take` sets the values.

        Args:
            csr: Values, columns, row pointers of the matrix of this part: six rows for each node,
                then the multipliers.
            shared: Nodes that other ranks have, too.
        """
        # objects without references on any rank are freed by all ranks together
        PETSc.garbage_cleanup(shared.comm)
        self._values, columns, pointers = csr
        size, nodes, comm = len(pointers) - 1, len(shared.owned), shared.comm
        owned = np.append(np.repeat(shared.owned, 6), np.ones(size - 6 * nodes, dtype=bool))
        self._owned: Indices = np.flatnonzero(owned)
        self._shared, self._nodes = shared, nodes
        counts = comm.allgather(len(self._owned))
        numbers = np.zeros(size, dtype=PETSc.IntType)
        numbers[self._owned] = sum(counts[: comm.rank]) + np.arange(len(self._owned))
        shared.take_from_owners(numbers[: 6 * nodes].reshape(-1, 6))
        own = PETSc.LGMap().create(numbers, comm=comm)
        local = PETSc.Mat().createAIJWithArrays(
            (size, size), (pointers, columns, self._values), comm=PETSc.COMM_SELF
        )
        self._parts = PETSc.Mat().create(comm)
        self._parts.setSizes(((counts[comm.rank], sum(counts)),) * 2)
        self._parts.setType(PETSc.Mat.Type.IS)
        self._parts.setLGMap(own, own)
        self._parts.setISLocalMat(local)
        self._parts.assemble()
        self._local = local
        self.matrix: PETSc.Mat = self._parts.convert(PETSc.Mat.Type.AIJ, PETSc.Mat())
        self._b, self._x = self.matrix.createVecs()

    def take(self) -> None:
        """Sum the current values of all parts."""
        for each in (self._local, self._parts):
            each.stateIncrease()
            each.assemble()
        self._parts.convert(PETSc.Mat.Type.AIJ, self.matrix)

    def solve(self, ksp: PETSc.KSP, b: Array, x: Array) -> None:
        """Solve ``A x = b``, both with the same values at all copies of a node.

        Args:
            ksp: Solver of the matrix.
            b: Right-hand side.
            x: Solution, overwritten.
        """
        self._b.array[:] = b[self._owned]
        ksp.solve(self._b, self._x)
        x[self._owned] = self._x.array
        self._shared.take_from_owners(x[: 6 * self._nodes].reshape(-1, 6))
