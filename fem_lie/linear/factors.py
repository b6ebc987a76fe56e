"""Sparse factors for compiled loops: factorised by SuperLU, solved with by a few lines of our own.

A step of a small scene takes a hundred microseconds; a call of a library from Python for each
solution would be a good part of that.
"""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie.linear.equilibrated import (
    ACCURATE,
    Equilibrated,
    InaccurateSolutionError,
    SingularMatrixError,
)

if TYPE_CHECKING:
    from fem_lie.linear.bordered import KKT

_log = logging.getLogger(__name__)


Triangle: TypeAlias = tuple[Array, Indices, Indices]
"""Values, row indices and column pointers."""

PlainFactors: TypeAlias = tuple[Array, Array, Indices, Indices, Array, Triangle, Triangle]
"""Of :class:`Factors`, for compiled functions."""


class Factors(NamedTuple):
    """``(A_left A A_right)ᵀ = Pᵣᵀ L U P_cᵀ``, both factors by columns, without the diagonal.

    Attributes:
        left: Diagonal of ``A_left``, by which the equations are equilibrated, shape (n,); likewise
            ``right``.
        row: Permutation ``Pᵣ``, shape (n,).
        column: Permutation ``P_c``.
        diagonal: Inverse of that of ``U``.
        lower: ``L``.
        upper: ``U``.
    """

    left: Array
    right: Array
    row: Indices
    column: Indices
    diagonal: Array
    lower: Triangle
    upper: Triangle

    @property
    def plain(self) -> PlainFactors:
        """As compiled functions are quicker to call with."""
        return (*self,)


def factorise(kkt: KKT) -> Factors:
    """Factors of the matrix as it is now.

    Raises:
        SingularMatrixError: It has none, or none that solve with it.
    """
    own = Equilibrated(kkt)
    own.take()
    n = len(own.left)
    transposed = sp.csc_matrix(own.csr, shape=(n, n))
    known = np.ones(n)
    b, (y, x, r) = transposed.T @ known, np.empty((3, n))
    for pivoting in ({"permc_spec": "MMD_AT_PLUS_A", "diag_pivot_thresh": 0.01}, {}):
        try:
            lu = spla.splu(transposed, **pivoting)
        except RuntimeError as error:
            raise SingularMatrixError("the matrix is singular") from error
        factors = _unpacked(lu, own)
        solve(factors.plain, b / own.left, y, x)
        left = own.backward_error(b, x / own.right, r)
        if left <= ACCURATE:
            return factors
        _log.info("SuperLU: residual %.1e", left)
    raise InaccurateSolutionError(f"the matrix is nearly singular: a residual of {left:.1e}")


def _unpacked(lu: spla.SuperLU, own: Equilibrated) -> Factors:
    L, U = lu.L, lu.U
    diagonal: Array = np.ones(len(own.left))
    lower = _strict(L.data, L.indices, L.indptr, diagonal)
    upper = _strict(U.data, U.indices, U.indptr, diagonal)
    row, column = lu.perm_r.astype(np.int64), lu.perm_c.astype(np.int64)
    return Factors(own.left, own.right, row, column, np.reciprocal(diagonal), lower, upper)


@compiled
def _strict(values: Array, indices: Indices, pointers: Indices, diagonal: Array) -> Triangle:
    """A triangle by columns without its diagonal, which is written into ``diagonal``."""
    n = diagonal.shape[0]
    kept, rows = np.empty(values.shape[0]), np.empty(values.shape[0], dtype=np.int64)
    first, at = np.zeros(n + 1, dtype=np.int64), 0
    for j in range(n):
        for k in range(pointers[j], pointers[j + 1]):
            if indices[k] == j:
                diagonal[j] = values[k]
            else:
                kept[at], rows[at] = values[k], indices[k]
                at += 1
        first[j + 1] = at
    return kept[:at], rows[:at], first


@compiled
def solve(factors: PlainFactors, b: Array, y: Array, x: Array) -> None:
    """``x = A⁻¹ b``; ``y`` is work, all of shape (n,)."""
    left, right, row, column, diagonal, lower, upper = factors
    values, indices, pointers = upper
    n = b.shape[0]
    for j in range(n):
        y[column[j]] = left[j] * b[j]
    for j in range(n):
        total = y[j]
        for k in range(pointers[j], pointers[j + 1]):
            total -= values[k] * y[indices[k]]
        y[j] = total * diagonal[j]
    values, indices, pointers = lower
    for j in range(n - 1, -1, -1):
        total = y[j]
        for k in range(pointers[j], pointers[j + 1]):
            total -= values[k] * y[indices[k]]
        y[j] = total
    for j in range(n):
        x[j] = right[j] * y[row[j]]
