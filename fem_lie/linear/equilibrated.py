"""The matrix of a scene in its own length, mass and time, and the error of its solutions.

Rows and columns of translations and of their multipliers are multiplied by the length of the
model, and all by one number that makes the largest entry about one: direct solvers see the same
matrix in all systems of units. All factors are powers of two, so nothing is rounded.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from petsc4py import PETSc

import numpy as np
import scipy.sparse as sp

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled
from fem_lie.linear.redundancy import IdleMultipliers

if TYPE_CHECKING:
    from fem_lie.linear.bordered import KKT

ACCURATE = 1e-10
"""Residual of a solution over the size of what cancels in it, above which it is not accepted.

A solver that is stable leaves 1e-16 … 1e-13."""


_SYMMETRIC = 1e-13
"""Difference of two entries of a symmetric matrix whose largest entry is about one."""


class SingularMatrixError(ArithmeticError):
    """The matrix has no factorisation."""


class InaccurateSolutionError(SingularMatrixError):
    """No solver could solve with the matrix."""


@compiled
def _take(
    values: Array,
    columns: Indices,
    pointers: Indices,
    units: Array,
    held: Flags,
    out: Array,
    left: Array,
) -> float:
    """``out = L A W``, with ``W = diag(units)`` and ``L = W/largest``; returns the largest entry.

    What is held keeps its unit row. The result is not finite if the matrix is not.
    """
    largest, total = 0.0, 0.0
    for i in range(len(units)):
        for k in range(pointers[i], pointers[i + 1]):
            out[k] = units[i] * values[k] * units[columns[k]]
            total += out[k]
            if not held[i] and abs(out[k]) > largest:
                largest = abs(out[k])
    if largest == 0.0 or total - total != 0.0:
        return total - total
    power = 2.0 ** np.round(np.log2(largest))
    for i in range(len(units)):
        left[i] = 1.0 if held[i] else units[i] / power
        if not held[i]:
            for k in range(pointers[i], pointers[i + 1]):
                out[k] /= power
    return largest


@compiled
def _backward_error(
    values: Array, columns: Indices, pointers: Indices, b: Array, x: Array, r: Array
) -> float:
    """``r = b − A x``; returns its largest part of what cancels in a row.

    M. Arioli, J. W. Demmel & I. S. Duff, SIAM J. Matrix Anal. Appl. 10 (1989) 165: rows in which
    next to nothing cancels are measured by the largest unknown.
    """
    n, most = len(b), 0.0
    for i in range(n):
        most = max(most, abs(x[i]))
    error = 0.0
    for i in range(n):
        left, size, norm = b[i], abs(b[i]), 0.0
        for k in range(pointers[i], pointers[i + 1]):
            part = values[k] * x[columns[k]]
            left -= part
            size += abs(part)
            norm = max(norm, abs(values[k]))
        r[i] = left
        if size < 1e-13 * n * (norm * most + abs(b[i])):
            size += norm * most
        if not abs(left) <= error * size:  # nan stays
            error = abs(left) / size if size > 0.0 else np.inf
    return error


@compiled
def _asymmetry(values: Array, columns: Indices, pointers: Indices, allowed: float) -> float:
    """``max |a_ij − a_ji|``, or the first that is not allowed; nan if the pattern is unsymmetric.

    Columns of a row ascend, so that those below the diagonal of a row are met one after the other.
    """
    n, most = len(pointers) - 1, 0.0
    below = pointers[:n].copy()
    for i in range(n):
        for k in range(pointers[i], pointers[i + 1]):
            j = columns[k]
            if j > i:
                mirrored = below[j]
                if mirrored == pointers[j + 1] or columns[mirrored] != i:
                    return np.nan
                below[j] += 1
                most = max(most, abs(values[k] - values[mirrored]))
                if most > allowed:
                    return most
    return most


class Equilibrated:
    """A copy of the matrix that stays as it was taken.

    Attributes:
        left: Of rows, shape (n,): ``L b`` is the right-hand side for ``matrix``.
        right: Of columns: its solution times this is that of the scene.
        csr: Values, columns, row pointers.
    """

    def __init__(self, kkt: KKT) -> None:
        """Share the pattern of ``kkt``; :meth:`take` comes later."""
        self._kkt = kkt
        self.right = kkt.units
        self.left: Array = np.ones(len(kkt.units))
        self._share()

    def _share(self) -> None:
        """The pattern, as it is now."""
        values, columns, pointers = self._kkt.csr
        self._version = self._kkt.version
        self.csr = np.zeros_like(values), columns, pointers
        self._matrix: PETSc.Mat | None = None

    @property
    def matrix(self) -> PETSc.Mat:
        """For PETSc, made when it is first asked for; :meth:`take` changes its values.

        It is another one after the pattern has changed.
        """
        if self._matrix is None:
            values, columns, pointers = self.csr
            self._matrix = PETSc.Mat().createAIJWithArrays(
                (len(self.right),) * 2, (pointers, columns, values), comm=PETSc.COMM_SELF
            )
        return self._matrix

    def take(self) -> None:
        """Copy the matrix as it is now.

        Raises:
            SingularMatrixError: It is not finite.
        """
        if self._version != self._kkt.version:
            self._share()
        largest = _take(*self._kkt.csr, self.right, self._kkt.unit_rows, self.csr[0], self.left)
        if not np.isfinite(largest):
            raise SingularMatrixError("the matrix is not finite")
        if self._matrix is not None:
            self._matrix.stateIncrease()
            self._matrix.assemble()

    def is_symmetric(self) -> bool:
        """Whether it is, but for round-off; its largest entry is about one."""
        return bool(_asymmetry(*self.csr, _SYMMETRIC) <= _SYMMETRIC)

    def backward_error(self, b: Array, x: Array, r: Array) -> float:
        """Of the solution ``x`` for ``b``, both of this matrix; sets ``r = b − A x``."""
        return float(_backward_error(*self.csr, b, x, r))

    def idle(self) -> IdleMultipliers | None:
        """What exerts no force together in this matrix, if its constraints may be redundant."""
        if not self._kkt.redundant:
            return None
        n, m = len(self.left), len(self._kkt.measure)
        B = sp.csr_matrix(self.csr, shape=(n, n))[: n - m, n - m :].T.tocsr()
        size = np.sqrt(np.asarray(B.multiply(B).sum(axis=1)).ravel())
        size[size == 0.0] = 1.0
        return IdleMultipliers(sp.diags(1.0 / size) @ B, size)
