"""Cholesky factors of a positive definite matrix, and a dense Schur complement of its last rows.

Matrices of bodies are symmetric, and positive definite if the bodies are supported. A joint adds
multipliers, a frame in space a few unsymmetric rows. These are the dense rows::

    [K  C] [x]   [a]        x = K⁻¹ a − Z T y,    Z T = K⁻¹ C
    [B  D] [y] = [b]        y = (D − B Z T)⁻¹ (b − B K⁻¹ a)

Rows of an averaging attachment, which couple all nodes of a face, stay out of the sparse
elimination. Many columns of ``C`` may be combinations of few; only these need solutions ``Z``.
"""

from __future__ import annotations

from typing import Any, NamedTuple, Protocol

from petsc4py import PETSc

import numpy as np
import scipy.linalg
import scipy.sparse as sp

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled

MOST = 60
"""Largest number of dense rows: each is one more solution."""

_SYMMETRIC = 1e-13  # tolerance over the largest entry, which is about one
_MOST_PAIRS = 20_000  # largest number of unsymmetric entries
_DEPENDENT = 1e-13  # distance of a dependent unit column from the span of others
_SINGULAR = 1e-14  # pivot of the Schur complement over its largest entry


class Matrix(Protocol):
    """The equilibrated copy, see :class:`~fem_lie.linear.equilibrated.Equilibrated`."""

    csr: tuple[Array, Any, Any]
    left: Array
    rank: int


class SaddlePoint(Protocol):
    """The original matrix, see :class:`~fem_lie.linear.saddle_point.KKT`."""

    filled: int
    version: int
    indptr: Indices


@compiled
def _unsymmetric(
    values: Array, columns: Indices, pointers: Indices, count: int, pairs: Indices
) -> int:
    """Nodes of unsymmetric entries in the first ``count`` rows; returns their number.

    It stops when ``pairs`` (p, 2) is full. Columns of a row ascend, and the pattern is symmetric.
    """
    below, found = pointers[:count].copy(), 0
    for i in range(count):
        for k in range(pointers[i], pointers[i + 1]):
            j = columns[k]
            if i < j < count:
                other = values[below[j]]
                below[j] += 1
                if not abs(values[k] - other) <= _SYMMETRIC:
                    if found == pairs.shape[0]:
                        return found + 1
                    pairs[found, 0], pairs[found, 1] = i // 6, j // 6
                    found += 1
    return found


def dense_rows_of(own: Matrix, count: int) -> Flags | None:
    """Whether a row is dense, shape (n,), or ``None`` if none is, or more than :data:`MOST`.

    Args:
        own: Equilibrated copy.
        count: Number of rows of nodes; all further rows are dense.
    """
    n, most = len(own.left), MOST + own.rank  # sums are not coupled with K
    if n - count > most:
        return None
    pairs = np.empty((_MOST_PAIRS, 2), dtype=np.int64)
    found = _unsymmetric(*own.csr, count, pairs)
    if found > _MOST_PAIRS:
        return None
    left, dense = pairs[:found], np.zeros(n, dtype=np.bool_)
    dense[count:] = True
    while len(left):
        # the node with most of them: frames are coupled with many others
        node = int(np.bincount(left.ravel()).argmax())
        dense[6 * node : 6 * node + 6] = True
        if dense.sum() > most:
            return None
        left = left[(left != node).all(axis=1)]
    # CHOLMOD refuses to solve for no columns
    return dense if dense.any() else None


class _Split(NamedTuple):
    """Positions and patterns of the blocks of the matrix.

    Attributes:
        dense: Whether a row is dense, shape (n,).
        inside: Numbers of the other rows.
        last: Numbers of the dense rows.
        of_K: Entries of ``K``, with its pattern ``K``; the other blocks are dense.
        of_rest: Entries of the dense rows and columns.
        rest: Row and column of each of these, (2, r).
    """

    dense: Flags
    inside: Indices
    last: Indices
    of_K: Indices
    K: sp.csr_matrix
    of_rest: Indices
    rest: Indices


def _split(own: Matrix, dense: Flags) -> _Split:
    values, columns, pointers = own.csr
    rows = np.repeat(np.arange(len(dense)), np.diff(pointers))
    inside, last = np.flatnonzero(~dense), np.flatnonzero(dense)
    number = np.cumsum(~dense) - 1
    within = ~dense[rows] & ~dense[columns]
    of_K, of_rest = np.flatnonzero(within), np.flatnonzero(~within)
    lengths = np.bincount(number[rows[of_K]], minlength=len(inside))
    first = np.append(0, np.cumsum(lengths)).astype(PETSc.IntType)
    own_columns = number[columns[of_K]].astype(PETSc.IntType)
    K = sp.csr_matrix((values[of_K], own_columns, first), shape=(len(inside),) * 2)
    rest = np.stack([rows[of_rest], columns[of_rest]])
    return _Split(dense, inside, last, of_K, K, of_rest, rest)


def _dense_blocks(entries: Array, parts: _Split) -> tuple[sp.csr_matrix, sp.csr_matrix, Array]:
    """``C`` and ``B``, and ``D`` as a dense array."""
    number = np.empty(len(parts.dense), dtype=np.int64)
    k, q = len(parts.inside), len(parts.last)
    number[parts.inside], number[parts.last] = np.arange(k), np.arange(q)
    rows, columns = number[parts.rest]
    in_row, in_column = parts.dense[parts.rest]

    def part(chosen: Flags, shape: tuple[int, int]) -> sp.csr_matrix:
        return sp.csr_matrix((entries[chosen], (rows[chosen], columns[chosen])), shape=shape)

    return (
        part(~in_row, (k, q)),
        part(~in_column, (q, k)),
        part(in_row & in_column, (q, q)).toarray(),
    )


def _independent(C: sp.csr_matrix) -> tuple[Indices, Array]:
    """Independent columns of ``C`` (k, q), and factors: ``C = C[:, columns] T``.

    Multipliers of an attachment and forces of its mean coordinates have the same columns.
    """
    rows = C[np.diff(C.indptr) > 0].toarray()
    size = np.linalg.norm(rows, axis=0)
    if not size.any():
        return np.empty(0, dtype=np.int64), np.empty((0, C.shape[1]))
    R, order = scipy.linalg.qr(
        rows / np.where(size > 0.0, size, 1.0), mode="r", pivoting=True, check_finite=False
    )
    pivots = np.abs(np.diagonal(R))
    rank = int((pivots > _DEPENDENT * pivots[0]).sum())
    columns, T = order[:rank], np.empty((rank, C.shape[1]))
    T[:, order] = scipy.linalg.solve_triangular(R[:rank, :rank], R[:rank], check_finite=False)
    return columns, T * size / size[columns, np.newaxis]


class SchurComplement:
    """Exact preconditioner of PETSc."""

    def __init__(self, kkt: SaddlePoint, own: Matrix, package: str) -> None:
        """Store the matrix; :meth:`setUp` factorises it.

        Args:
            kkt: The original matrix, which counts changes of values of nodes.
            own: Its equilibrated copy.
            package: Package that factorises ``K``.
        """
        self._kkt, self._own, self._package = kkt, own, package
        self._parts: _Split | None = None
        self._version = self._made = (-1, 0.0)
        self._pc: PETSc.PC | None = None

    def setUp(self, pc: PETSc.PC) -> None:
        """Factorise.

        Raises:
            ArithmeticError: No row or too many are dense, or the matrix is singular.
        """
        own = self._own
        dense = dense_rows_of(own, 6 * (len(self._kkt.indptr) - 1))
        if dense is None:
            raise ArithmeticError(f"there are no dense rows, or more than {MOST}")
        version = self._kkt.version, 0.0
        if self._parts is None or self._version != version or (self._parts.dense != dense).any():
            self._parts, self._version, self._made = _split(own, dense), version, (-1, 0.0)
            self._allocate(self._parts, pc.getOptionsPrefix())
        parts = self._parts
        self._factorise(parts)
        C, self._B, D = _dense_blocks(own.csr[0][parts.of_rest], parts)
        columns, self._T = _independent(C)
        self._Z = self._solutions(C[:, columns].toarray())
        gap = (self._B - C.T).data
        self._consistent = bool(np.abs(gap).max(initial=0.0) <= _SYMMETRIC)
        self._schur = D - (self._B @ self._Z) @ self._T
        self._factors = scipy.linalg.lu_factor(self._schur, check_finite=False)
        pivots = np.abs(np.diagonal(self._factors[0]))
        if not pivots.min(initial=np.inf) > _SINGULAR * np.abs(self._schur).max(initial=0.0):
            raise ArithmeticError("the Schur complement is singular")

    def _allocate(self, parts: _Split, prefix: str | None) -> None:
        """Allocate ``K`` and its factors, with PETSc's options of that prefix."""
        csr = parts.K.indptr, parts.K.indices, parts.K.data
        self._K = PETSc.Mat().createAIJWithArrays(parts.K.shape, csr, comm=PETSc.COMM_SELF)
        self._K.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        self._pc = PETSc.PC().create(PETSc.COMM_SELF)
        self._pc.setType(PETSc.PC.Type.CHOLESKY)
        self._pc.setFactorSolverType(self._package)
        self._pc.setOptionsPrefix(prefix)
        self._pc.setOperators(self._K)
        self._pc.setFromOptions()
        self._a, self._x = self._K.createVecs()

    def _factorise(self, parts: _Split) -> None:
        """Factorise ``K``, unless only constraints have changed."""
        assert self._pc is not None
        present = self._kkt.filled, float(self._own.left[parts.inside[0]])
        if self._made == present:
            return
        self._made = (-1, 0.0)
        parts.K.data[:] = self._own.csr[0][parts.of_K]
        self._K.stateIncrease()
        self._K.assemble()
        self._pc.setOperators(self._K)
        self._pc.setUp()
        self._made = present

    def _solutions(self, C: Array) -> Array:
        """``K⁻¹ C``."""
        assert self._pc is not None
        given = PETSc.Mat().createDense(C.shape, array=np.asfortranarray(C), comm=PETSc.COMM_SELF)
        found = PETSc.Mat().createDense(C.shape, comm=PETSc.COMM_SELF)
        for matrix in (given, found):
            matrix.setUp()
            matrix.assemble()
        self._pc.getFactorMatrix().matSolve(given, found)
        return np.array(found.getDenseArray())

    @property
    def factorising(self) -> PETSc.PC | None:
        """Preconditioner with the factors of ``K``."""
        return self._pc

    def negative_pivots(self) -> int | None:
        """Negative eigenvalues of the Schur complement; ``None`` if ``B`` is not ``Cᵀ``."""
        if not self._consistent:
            return None
        return int((np.linalg.eigvalsh(0.5 * (self._schur + self._schur.T)) < 0.0).sum())

    def apply(self, pc: PETSc.PC, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Solve."""
        assert self._pc is not None
        parts = self._parts
        assert parts is not None
        given, found = b.array_r, x.array
        self._a.array[:] = given[parts.inside]
        self._pc.apply(self._a, self._x)
        inner = self._x.array_r
        y = scipy.linalg.lu_solve(
            self._factors, given[parts.last] - self._B @ inner, check_finite=False
        )
        found[parts.inside], found[parts.last] = inner - self._Z @ (self._T @ y), y
