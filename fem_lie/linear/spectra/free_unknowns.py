"""Free unknowns of a scene on one rank, or of the part of a scene that a rank has.

Matrices of parts are partial: their sum over all ranks is that of the scene. Vectors have the same
values at all copies of an unknown, and products of matrices and vectors are partial forces. Scalar
products of vectors and partial forces therefore are sums over all unknowns of all ranks; those of
two vectors are sums over the unknowns that ranks own.
"""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext
from functools import cached_property
from typing import Any, TypeVar

from petsc4py import PETSc

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

from fem_lie._arrays import Array, Indices
from fem_lie.ranks.divided_matrix import DividedMatrix, with_diagonal
from fem_lie.ranks.shared_nodes import SharedNodes

Numbers = TypeVar("Numbers", bound=npt.NDArray[Any])


def triangle(A: Array) -> Array:
    """Triangle (≤ c, c) of the QR factors of a matrix (r, c)."""
    return np.asarray(np.linalg.qr(A, mode="r"))


class FreeUnknowns:
    """Free unknowns of a scene on one rank.

    Attributes:
        several: Whether other ranks have parts, too.
    """

    several = False

    def total(self, values: Numbers) -> Numbers:
        """Sum over all ranks."""
        return values

    def largest(self, value: float) -> float:
        """Largest value of all ranks."""
        return value

    def of_first(self, values: Numbers) -> Numbers:
        """Values of the first rank."""
        return values

    def errors(self, *kinds: type[Exception]) -> AbstractContextManager[None]:
        """Context whose error of these classes on one rank is raised on all at its end."""
        return nullcontext()

    def owned(self, vectors: Numbers) -> Numbers:
        """Vectors (k, n) with zeros at unknowns that other ranks own."""
        return vectors

    def assembled(self, forces: Numbers) -> Numbers:
        """Sums over all ranks of partial forces, shape (k, n)."""
        return forces

    def of_owners(self, vectors: Array) -> Array:
        """Vectors (k, n) with the values of the owners at all copies."""
        return vectors

    def mean(self, values: Array) -> float:
        """Mean of a vector, shape (n,)."""
        both = self.owned(np.array([values, np.ones_like(values)])).sum(axis=1)
        total, count = self.total(both)
        return float(total / count)

    def triangle(self, A: Array) -> Array:
        """Triangle (≤ c, c) of the QR factors of the rows (r, c) of all ranks together."""
        return triangle(A)

    def whole_matrix(self, A: sp.csr_matrix) -> sp.csr_matrix:
        """Sum of the matrices (n, n) of all ranks, with all unknowns on each."""
        return A

    def whole_rows(self, B: sp.csr_matrix) -> sp.csr_matrix:
        """Rows (m, n) of all ranks, with all unknowns on each."""
        return B

    def whole_forces(self, forces: Numbers) -> Numbers:
        """Sums of partial forces (k, n) at all unknowns."""
        return forces

    def part(self, vectors: Numbers) -> Numbers:
        """Values at the unknowns of this rank, from vectors of all unknowns."""
        return vectors

    def matrix(self, A: sp.csr_matrix, n: int) -> OnRanks:
        """Sum of the matrices of all ranks for PETSc, with all of its diagonal.

        Args:
            A: Matrix of the unknowns and of multipliers.
            n: Number of unknowns.
        """
        return OnRanks(A, SharedNodes.alone(0), np.arange(A.shape[0]), np.arange(n))


ON_ONE_RANK = FreeUnknowns()


class DividedUnknowns(FreeUnknowns):
    """Free unknowns of a part of a scene, of which other ranks have copies."""

    several = True

    def __init__(self, shared: SharedNodes, free: Indices) -> None:
        """Store.

        Args:
            shared: Nodes that other ranks have, too.
            free: Numbers of the unknowns among six of each node, shape (n,).
        """
        self._shared, self._free = shared, free
        self._owned = shared.owned[free // 6]

    def total(self, values: Numbers) -> Numbers:
        """Sum over all ranks, the same on all."""
        return self._shared.comm.allreduce(values)

    def largest(self, value: float) -> float:
        """Largest value of all ranks."""
        return self._shared.largest(value)

    def of_first(self, values: Numbers) -> Numbers:
        """Values of the first rank."""
        return self._shared.comm.bcast(values)

    def errors(self, *kinds: type[Exception]) -> AbstractContextManager[None]:
        """Context whose error of these classes on one rank is raised on all at its end."""
        return self._shared.errors(*kinds)

    def owned(self, vectors: Numbers) -> Numbers:
        """Vectors (k, n) with zeros at unknowns that other ranks own."""
        return np.where(self._owned, vectors, 0.0)  # type: ignore[return-value]

    def assembled(self, forces: Numbers) -> Numbers:
        """Sums over all ranks of partial forces, shape (k, n)."""
        nodes = np.zeros((6 * len(self._shared.owned), len(forces)), dtype=forces.dtype)
        nodes[self._free] = forces.T
        if len(forces):
            self._shared.sum(nodes.view(nodes.real.dtype).reshape(len(self._shared.owned), -1))
        return nodes[self._free].T  # type: ignore[return-value]

    def of_owners(self, vectors: Array) -> Array:
        """Vectors (k, n) with the values of the owners at all copies."""
        return self.assembled(self.owned(vectors))

    @cached_property
    def _numbers(self) -> Indices:
        """Number of each unknown among those of all ranks, shape (n,)."""
        mine = int(self._owned.sum())
        nodes = np.zeros(6 * len(self._shared.owned), dtype=PETSc.IntType)
        first = self._shared.comm.scan(mine) - mine
        nodes[self._free[self._owned]] = first + np.arange(mine)
        self._shared.take_from_owners(nodes.reshape(-1, 6))
        return nodes[self._free].astype(np.int64)

    def whole_matrix(self, A: sp.csr_matrix) -> sp.csr_matrix:
        """Sum of the matrices (n, n) of all ranks, with all unknowns on each."""
        own = A.tocoo()
        entries = own.data, self._numbers[own.row], self._numbers[own.col]
        values, rows, columns = self._of_all(entries)
        return sp.csr_matrix((values, (rows, columns)), shape=(self._count, self._count))

    def whole_rows(self, B: sp.csr_matrix) -> sp.csr_matrix:
        """Rows (m, n) of all ranks, with all unknowns on each."""
        own = B.tocoo()
        first = self._shared.comm.scan(B.shape[0]) - B.shape[0]
        values, rows, columns = self._of_all((own.data, own.row + first, self._numbers[own.col]))
        shape = (self._shared.comm.allreduce(B.shape[0]), self._count)
        return sp.csr_matrix((values, (rows, columns)), shape=shape)

    def whole_forces(self, forces: Numbers) -> Numbers:
        """Sums of partial forces (k, n) at all unknowns."""
        found = np.zeros((len(forces), self._count), dtype=forces.dtype)
        found[:, self._numbers] = forces
        return self.total(found)  # type: ignore[return-value]

    def part(self, vectors: Numbers) -> Numbers:
        """Values at the unknowns of this rank, from vectors of all unknowns."""
        return vectors[:, self._numbers]  # type: ignore[return-value]

    @property
    def _count(self) -> int:
        return int(self._shared.comm.allreduce(int(self._owned.sum())))

    def _of_all(self, arrays: tuple[Any, ...]) -> list[Any]:
        found = self._shared.comm.allgather(arrays)
        return [np.concatenate(each) for each in zip(*found, strict=True)]

    def triangle(self, A: Array) -> Array:
        """Triangle (≤ c, c) of the QR factors of the rows (r, c) of all ranks together."""
        return triangle(np.concatenate(self._shared.comm.allgather(triangle(A))))

    def matrix(self, A: sp.csr_matrix, n: int) -> OnRanks:
        """Sum of the matrices of all ranks for PETSc, with all of its diagonal."""
        multipliers = 6 * len(self._shared.owned) + np.arange(A.shape[0] - n)
        return OnRanks(A, self._shared, np.concatenate([self._free, multipliers]), self._free)


def free_unknowns(shared: SharedNodes, free: Indices) -> FreeUnknowns:
    """Free unknowns of a scene or of a part.

    Args:
        shared: Nodes that other ranks have, too.
        free: Numbers of the unknowns among six of each node, shape (n,).
    """
    return DividedUnknowns(shared, free) if shared.several else ON_ONE_RANK


class OnRanks:
    """A matrix of unknowns and multipliers on all ranks, and vectors on each.

    Attributes:
        matrix: PETSc's matrix.
    """

    def __init__(
        self, A: sp.csr_matrix, shared: SharedNodes, rows: Indices, unknowns: Indices
    ) -> None:
        """Sum the partial matrices of all ranks.

        Args:
            A: That of this rank.
            shared: Nodes that other ranks have, too.
            rows: Numbers of its rows among six of each node and the multipliers.
            unknowns: Those without multipliers, shape (n,).
        """
        A = with_diagonal(A)
        csr = A.data, A.indices.astype(PETSc.IntType), A.indptr.astype(PETSc.IntType)
        self._sum = DividedMatrix(csr, shared, rows)
        self._unknowns = unknowns
        size = 6 * len(shared.owned) + A.shape[0]
        self._b, self._x = np.zeros(size), np.zeros(size)

    @property
    def matrix(self) -> PETSc.Mat:
        """PETSc's matrix."""
        return self._sum.matrix

    @property
    def size(self) -> int:
        """Number of rows of all ranks."""
        return int(self.matrix.size[0])

    @property
    def count(self) -> int:
        """Number n of unknowns of this rank."""
        return len(self._unknowns)

    def solve(self, ksp: PETSc.KSP, b: Array) -> Array:
        """Solution of ``A x = b`` without multipliers, both shape (n,)."""
        self._b[self._unknowns] = b
        self._sum.solve(ksp, self._b, self._x)
        return self._x[self._unknowns]

    def unknowns(self, vector: PETSc.Vec) -> Array:
        """Values of the unknowns in one of PETSc's vectors, shape (n,)."""
        self._sum.put(vector, self._x)
        return self._x[self._unknowns]
