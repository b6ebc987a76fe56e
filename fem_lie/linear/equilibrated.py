"""Equilibration of the matrix with the length, mass and time of the scene; errors of solutions.

Rows and columns of translations and of their multipliers are multiplied by the length of the model,
and all by one number that makes the largest entry about one: direct solvers see the same matrix in
all systems of units. All factors are powers of two, so nothing is rounded.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from petsc4py import PETSc

import numpy as np
import scipy.sparse as sp

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled
from fem_lie.linear.low_rank import Extended
from fem_lie.linear.redundancy import IdleFilter, IdleMultipliers, scaled

if TYPE_CHECKING:
    from fem_lie.linear.saddle_point import KKT

ACCURATE = 1e-10
"""Largest accepted residual of a solution, over the size of the terms that cancel in it.

A stable solver leaves 1e-16 … 1e-13.
"""


ITERABLE = 1e-3
"""Largest residual, likewise, of a correction that an iteration takes without refinement.

By so much at least the correction reduces each residual, and the next one reduces the rest. It has
to be :data:`ACCURATE` in the norm of rows. Rows that have only small unknowns leave more than that
of their own terms: those across the plane of a motion, or without multipliers.
"""


class BackwardError(NamedTuple):
    """Residual of a solution in the equations that it leaves most of.

    Attributes:
        of_terms: Over the size of the terms in the equation.
        of_rows: Over the largest entry of its row times the largest unknown.
    """

    of_terms: float
    of_rows: float

    @property
    def iterable(self) -> bool:
        """Whether an iteration takes the solution without refinement."""
        return self.of_terms <= ITERABLE and self.of_rows <= ACCURATE


_SYMMETRIC = 5e-14
"""Largest skew part of a symmetric matrix whose largest entry is about one."""


_WHOLE: Flags = np.zeros(0, dtype=np.bool_)
"""Of a matrix without blocks that are parts only."""

_NO_BLOCKS: Array = np.zeros((0, 6, 6))


SMALL_SKEW = 1e-4
"""Largest entry of ``½ (A − Aᵀ)`` in a matrix of unit diagonal that an iteration does not notice.

It is about the convergence rate of an iteration with the symmetric part. Measured for nets of beams
(``docs/measured/choices.md``): 3e-3 costs 2 %, 4e-2 a third of the iterations, but with 1e-3 the
last iteration of a step leaves more than before.
"""


class SingularMatrixError(ArithmeticError):
    """Error: the matrix is singular, so that it has no factorisation."""


class InaccurateSolutionError(SingularMatrixError):
    """No solver reaches an accurate solution."""


@compiled
def _take(
    values: Array, columns: Indices, pointers: Indices, units: Array, held: Flags, out: Array
) -> float:
    """``out = W A W``, with ``W = diag(units)``; returns the largest entry.

    Held unknowns keep their unit row. The result is not finite if the matrix is not.
    """
    largest, total = 0.0, 0.0
    for i in range(len(units)):
        for k in range(pointers[i], pointers[i + 1]):
            out[k] = units[i] * values[k] * units[columns[k]]
            total += out[k]
            if not held[i] and abs(out[k]) > largest:
                largest = abs(out[k])
    return total - total if total - total != 0.0 else largest


@compiled
def _divide(
    largest: float, pointers: Indices, units: Array, held: Flags, out: Array, left: Array
) -> None:
    """Divide rows that are not held by a power of two near ``largest``; ``left`` are all factors.

    Rows of a matrix without entries stay as they are.
    """
    power = 2.0 ** np.round(np.log2(largest)) if largest > 0.0 else 1.0
    for i in range(len(units)):
        left[i] = 1.0 if held[i] else units[i] / power
        if not held[i]:
            for k in range(pointers[i], pointers[i + 1]):
                out[k] /= power


@compiled
def _products(values: Array, columns: Indices, pointers: Indices, x: Array, sums: Array) -> None:
    """Set ``A x``, ``|A| |x|`` and the largest entries of the rows, shape (n, 3)."""
    for i in range(len(x)):
        left, size, norm = 0.0, 0.0, 0.0
        for k in range(pointers[i], pointers[i + 1]):
            part = values[k] * x[columns[k]]
            left += part
            size += abs(part)
            norm = max(norm, abs(values[k]))
        sums[i, 0], sums[i, 1], sums[i, 2] = left, size, norm


@compiled
def _backward_error(b: Array, sums: Array, most: float, n: int, r: Array) -> tuple[float, float]:
    """``r = b − A x``; returns the backward error by components and by rows.

    M. Arioli, J. W. Demmel & I. S. Duff, SIAM J. Matrix Anal. Appl. 10 (1989) 165: rows with nearly
    no cancelling terms are measured by the largest unknown, ``most``, of all ``n``.
    """
    error = of_rows = 0.0
    for i in range(len(b)):
        left, size, norm = b[i] - sums[i, 0], abs(b[i]) + sums[i, 1], sums[i, 2]
        r[i] = left
        largest = norm * most + abs(b[i])
        if size < 1e-13 * n * largest:
            size += norm * most
        if not abs(left) <= error * size:  # true for nan
            error = abs(left) / size if size > 0.0 else np.inf
        if not abs(left) <= of_rows * largest:
            of_rows = abs(left) / largest if largest > 0.0 else np.inf
    return error, of_rows


@compiled
def _diagonal(values: Array, columns: Indices, pointers: Indices) -> Array:
    """Diagonal, shape (n,)."""
    n = len(pointers) - 1
    found = np.zeros(n)
    for i in range(n):
        for k in range(pointers[i], pointers[i + 1]):
            if columns[k] == i:
                found[i] = values[k]
    return found


@compiled
def _to_unit_diagonal(values: Array, columns: Indices, pointers: Indices, diagonal: Array) -> Array:
    """Factors ``s`` (n,) for which ``s A s`` has a unit diagonal.

    Rows without a diagonal, those of multipliers, have a largest entry of one instead.
    """
    s = np.zeros(len(diagonal))
    for i in range(len(diagonal)):
        if diagonal[i] != 0.0:
            s[i] = 1.0 / np.sqrt(abs(diagonal[i]))
    for i in range(len(diagonal)):
        if diagonal[i] == 0.0:
            largest = 0.0
            for k in range(pointers[i], pointers[i + 1]):
                if diagonal[columns[k]] != 0.0:
                    largest = max(largest, abs(values[k]) * s[columns[k]])
            s[i] = 1.0 / largest if largest > 0.0 else 1.0
    return s


@compiled
def _skewness(
    values: Array,
    columns: Indices,
    pointers: Indices,
    scale: Array,
    limit: float,
    parts: Flags,
    blocks: Array,
) -> float:
    """``max s_i |a_ij − a_ji| s_j / 2``, or the first above the limit; nan: unsymmetric pattern.

    Entries below the diagonal are met in their order.

    Args:
        values: Values of the matrix by rows.
        columns: Columns, which ascend in a row.
        pointers: Row pointers.
        scale: ``s``, shape (n,).
        limit: Largest value of interest.
        parts: Nodes of whose own block this is a part only, shape (m,).
        blocks: Skew part of these blocks, scaled, which does not count, shape (m, 6, 6), added.
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
                skew = 0.5 * scale[i] * (values[k] - values[mirrored]) * scale[j]
                node = i // 6
                if node == j // 6 and node < len(parts) and parts[node]:
                    blocks[node, i % 6, j % 6] += skew
                elif not abs(skew) <= limit:
                    return abs(skew)
                else:
                    most = max(most, abs(skew))
    return most


@compiled
def _symmetrise(values: Array, columns: Indices, pointers: Indices) -> None:
    """``A ← ½ (A + Aᵀ)`` for a symmetric pattern."""
    below = pointers[:-1].copy()
    for i in range(len(pointers) - 1):
        for k in range(pointers[i], pointers[i + 1]):
            j = columns[k]
            if j > i:
                mean = 0.5 * (values[k] + values[below[j]])
                values[k] = values[below[j]] = mean
                below[j] += 1


class Equilibrated:
    """Equilibrated copy of the matrix.

    The additional unknowns of a low-rank part come last; they have no right-hand side.

    Attributes:
        left: Factors of rows, shape (n,): ``L b`` is the right-hand side for ``matrix``.
        right: Factors of columns: its solution times these is that of the scene.
        csr: Values, columns, row pointers.
        part: Low-rank part, or ``None``.
        rank: Rank of that part, which adds twice as many unknowns, half of them multipliers.
    """

    def __init__(self, kkt: KKT) -> None:
        """Share the pattern of ``kkt``; :meth:`take` copies values."""
        self._kkt = kkt
        self._extended: Extended | None
        self._share()

    def _share(self) -> None:
        """Share the current pattern."""
        kkt, part = self._kkt, self._kkt.low_rank
        (_, columns, pointers), self._version = kkt.csr, kkt.version
        self.part, self.rank, self._extended = part, 0, None
        self.right, self._held = kkt.units, kkt.unit_rows
        if part is not None:
            self._extended, self.rank = Extended(pointers, columns, part), len(part.core)
            columns, pointers = self._extended.columns, self._extended.pointers
            self.right = np.append(self.right, np.full(2 * self.rank, kkt.length))
            self._held = np.append(self._held, np.zeros(2 * self.rank, dtype=bool))
        values: Array = np.zeros(len(columns))
        self.csr = values, columns, pointers
        self.left: Array = np.ones(len(self.right))
        self._matrix: PETSc.Mat | None = None

    @property
    def matrix(self) -> PETSc.Mat:
        """PETSc matrix, created on first use; :meth:`take` changes its values.

        It is a new one after a change of the pattern.
        """
        if self._matrix is None:
            values, columns, pointers = self.csr
            self._matrix = PETSc.Mat().createAIJWithArrays(
                (len(self.right),) * 2, (pointers, columns, values), comm=PETSc.COMM_SELF
            )
        return self._matrix

    def take(self) -> None:
        """Copy the current matrix.

        Raises:
            SingularMatrixError: It is not finite.
        """
        part = self._kkt.low_rank
        if self._version != self._kkt.version or (part is None) != (self._extended is None):
            self._share()
        self.part, values, (own, columns, pointers) = part, self._kkt.csr[0], self.csr
        if self._extended is not None and part is not None:
            values = self._extended.values(values, part)
        largest = _take(values, columns, pointers, self.right, self._held, own)
        largest = self._kkt.shared.largest(largest)
        if not np.isfinite(largest):
            raise SingularMatrixError("the matrix is not finite")
        _divide(largest, pointers, self.right, self._held, own, self.left)
        if self._matrix is not None:
            self._matrix.stateIncrease()
            self._matrix.assemble()

    def drop_skew_part(self) -> None:
        """Keep only the symmetric part if the rest is at most :data:`SMALL_SKEW`; collective."""
        diagonal, shared = _diagonal(*self.csr), self._kkt.shared
        shared.sum(diagonal[: self._kkt.held.size].reshape(-1, 6))
        scale = _to_unit_diagonal(*self.csr, diagonal)
        # forces of the parts of a node cancel in its own block, which has the largest skew part
        parts, blocks = _WHOLE, _NO_BLOCKS
        if shared.several:
            parts, blocks = shared.copied, np.zeros((len(self._kkt.held), 6, 6))
        own = _skewness(*self.csr, scale, SMALL_SKEW, parts, blocks)
        shared.sum(blocks)
        if shared.all(own <= SMALL_SKEW and float(np.abs(blocks).max(initial=0.0)) <= SMALL_SKEW):
            _symmetrise(*self.csr)
            if self._matrix is not None:
                self._matrix.stateIncrease()

    def is_symmetric(self) -> bool:
        """Whether it is symmetric up to round-off; its largest entry is about one."""
        scale = np.ones(len(self.left))
        own = _skewness(*self.csr, scale, _SYMMETRIC, _WHOLE, _NO_BLOCKS)
        return self._kkt.shared.all(bool(own <= _SYMMETRIC))

    def backward_error(self, b: Array, x: Array, r: Array) -> BackwardError:
        """Backward error of a solution ``x`` for ``b`` of this matrix; sets ``r = b − A x``."""
        shared, n = self._kkt.shared, self._kkt.held.size
        sums = np.empty((len(x), 3))
        _products(*self.csr, x, sums)
        shared.sum(sums[:n].reshape(-1, 18))
        most = shared.largest(float(np.abs(x).max(initial=0.0)))
        found = _backward_error(b, sums, most, self._kkt.size, r)
        return BackwardError(*(shared.largest(error) for error in found))

    def idle(self) -> IdleMultipliers | None:
        """Multipliers without force in this matrix, if constraints may be redundant."""
        if not self._kkt.redundant:
            return None
        n, m, whole = len(self._kkt.units), len(self._kkt.measure), (len(self.left),) * 2
        B = sp.csr_matrix(self.csr, shape=whole)[: n - m, n - m : n].T.tocsr()
        size = np.sqrt(np.asarray(B.multiply(B).sum(axis=1)).ravel())
        size[size == 0.0] = 1.0
        return IdleMultipliers(scaled(B, 1.0 / size), size)

    def idle_filter(self) -> IdleFilter:
        """Filter of the solutions of the scene for compiled loops; see :meth:`idle`."""
        found, n, m = self.idle(), len(self._kkt.units), len(self._kkt.measure)
        if found is None or m == 0:
            return IdleFilter.none()
        return found.for_compiled(n - m, self.right[n - m : n])
