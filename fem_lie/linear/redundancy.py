"""Redundant constraints, and multipliers that they leave undetermined.

Idle multipliers exert no force: they are vectors with ``Bᵀ x = 0``, eigenvectors of ``G = B Bᵀ``
for the eigenvalue zero. They are not computed: powers of ``δ (G + δ)⁻¹`` filter the idle part out
of any ``x``, with one sparse factorisation and some solutions, at a cost linear in the size of the
scene.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, partial
from typing import NamedTuple, TypeAlias

import numpy as np
import scipy.linalg
import scipy.sparse as sp
import scipy.sparse.linalg

from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined
from fem_lie.linear.triangles import Triangle, Triangles, substitute

_NOTHING = 1e-10  # norm of a row that is zero up to round-off
_DEPENDENT = 1e-10  # squared distance of a dependent unit row from the span of others
_SHIFT = 1e-14
"""Shift of the squared length of each unit row.

The pivot of a dependent row is then the shift, times one plus the squares of its coefficients, and
not a quotient of round-off."""

IDLE = 1e-10
"""Largest squared motion of idle multipliers of unit size."""

_DENSE = 100
"""Number of constraints up to which their products are factorised as a dense matrix."""

_POWER = 2  # of the filter: a motion of 10⁻³ is kept to 10⁻⁸
_PASSES = 2  # the first leaves round-off over IDLE


def redundant_constraints(B: sp.csr_matrix, units: Array, measure: Array) -> Indices:
    """Constraints that follow from others.

    Args:
        B: Constraint Jacobian in the twists of the moving nodes, shape (m, 6 n).
        units: Unit of each unknown over the length of the model, shape (6 n,).
        measure: Norm scaling of each multiplier, shape (m,).
    """
    if B.shape[0] == 0:
        return np.empty(0, dtype=np.int64)
    B = scaled(B, np.asarray(1.0 / measure), units)
    norms = np.sqrt(np.asarray(B.multiply(B).sum(axis=1)).ravel())
    # within one rigid body both sides cancel up to round-off
    norms[norms < _NOTHING] = 0.0
    empty, full = np.flatnonzero(norms == 0.0), np.flatnonzero(norms)
    unit = scaled(B[full], 1.0 / norms[full])
    dependent = full[_squared_distances(unit) <= _DEPENDENT]
    return np.asarray(np.union1d(dependent, empty), dtype=np.int64)


def _squared_distances(unit: sp.csr_matrix) -> Array:
    """Squared distance of each unit row from the span of earlier ones, (m,).

    They are the pivots of ``B Bᵀ``, in an order that keeps its factors sparse.
    """
    if unit.shape[0] == 0:
        return np.empty(0)
    products = (unit @ unit.T + _SHIFT * sp.identity(unit.shape[0])).tocsc()
    factors = symmetric_factors(products)
    return np.asarray(factors.U.diagonal()[factors.perm_c])


def symmetric_factors(positive: sp.csc_matrix) -> scipy.sparse.linalg.SuperLU:
    """Factors of a positive definite matrix with pivots on the diagonal."""
    return scipy.sparse.linalg.splu(
        positive,
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )


def scaled(B: sp.csr_matrix, rows: Array, columns: Array | None = None) -> sp.csr_matrix:
    """A matrix whose rows and columns are multiplied by factors.

    Args:
        B: The matrix, shape (m, n).
        rows: Factors of the rows, shape (m,).
        columns: Factors of the columns, shape (n,); default: one.
    """
    data = B.data * np.repeat(rows, np.diff(B.indptr))
    if columns is not None:
        data *= columns[B.indices]
    return sp.csr_matrix((data, B.indices, B.indptr), shape=B.shape)


def _solution_with(products: sp.csr_matrix, shift: float) -> Callable[[Array], Array]:
    """Solution of equations with a positive semidefinite matrix plus a shift of its diagonal."""
    m = products.shape[0]
    if m <= _DENSE:
        factors = scipy.linalg.cho_factor(products.toarray() + shift * np.eye(m), overwrite_a=True)
        return partial(scipy.linalg.cho_solve, factors, check_finite=False)
    found: Callable[[Array], Array]
    found = symmetric_factors((products + shift * sp.identity(m)).tocsc()).solve
    return found


class IdleMultipliers:
    """Filter that removes the idle part of multipliers."""

    def __init__(self, B: sp.csr_matrix, measure: Array) -> None:
        """Factorise.

        Args:
            B: Constraint Jacobian over ``measure``, in unknowns of one dimension, shape (m, n).
            measure: Norm scaling of each multiplier, shape (m,): the removed part is orthogonal to
                the rest in the scaled multipliers.
        """
        self._measure, self._products = measure, B @ B.T
        largest = float(self._products.diagonal().max(initial=0.0))
        self._bound = IDLE * max(largest, np.finfo(float).tiny)

    @classmethod
    def of(cls, B: sp.csr_matrix, units: Array, measure: Array) -> IdleMultipliers:
        """Filter for a Jacobian (m, 6 n); ``units`` as for :func:`redundant_constraints`."""
        return cls(scaled(B, np.asarray(1.0 / measure), units), measure)

    def remove(self, multipliers: Array) -> Array:
        """The smallest multipliers that exert the same forces, shape (m,)."""
        x = multipliers * self._measure
        for _ in range(_PASSES):
            x = x - self._filter(x)
        return np.asarray(x / self._measure)

    def part(self, values: Array) -> Array:
        """Part of constraint ``values`` that no motion can change, shape (m,)."""
        return np.asarray(self._filter(values / self._measure) * self._measure)

    def for_compiled(self, first: int, right: Array) -> IdleFilter:
        """The same filter for compiled loops.

        Args:
            first: Position of the multipliers among all unknowns.
            right: Solutions of those loops over the multipliers of this filter, shape (m,).
        """
        m = len(right)
        shifted = (self._products + self._bound * sp.identity(m)).tocsc()
        return IdleFilter(
            np.array([first]),
            np.array([self._bound]),
            np.asarray(self._measure / right),
            np.empty((3, m)),
            *Triangles.of(symmetric_factors(shifted)),
        )

    @cached_property
    def _solve(self) -> Callable[[Array], Array]:
        return _solution_with(self._products, self._bound)

    def _filter(self, x: Array) -> Array:
        for _ in range(_POWER):
            x = self._bound * self._solve(x)
        return x


class IdleFilter(NamedTuple):
    """:class:`IdleMultipliers` for compiled loops; without constraints it has no effect.

    Attributes:
        first: Position of the multipliers among all unknowns, shape (1,).
        bound: Shift δ, shape (1,).
        weights: Scaling of the multipliers, shape (m,).
        work: Workspace, shape (3, m).
        row: As the following ones one of the :class:`~fem_lie.linear.triangles.Triangles` of
            ``G + δ``.
        column: See above.
        diagonal: See above.
        lower: See above.
        upper: See above.
    """

    first: Indices
    bound: Array
    weights: Array
    work: Array
    row: Indices
    column: Indices
    diagonal: Array
    lower: Triangle
    upper: Triangle

    @classmethod
    def none(cls) -> IdleFilter:
        """Filter without effect."""
        number = np.empty(0)
        return cls(np.zeros(1, np.int64), number, number, np.empty((3, 0)), *Triangles.none())


PlainIdleFilter: TypeAlias = tuple[
    Indices, Array, Array, Array, Indices, Indices, Array, Triangle, Triangle
]
"""An :class:`IdleFilter` as a plain tuple, for compiled functions."""


@inlined
def remove_idle(idle: PlainIdleFilter, x: Array) -> None:
    """:meth:`IdleMultipliers.remove` for the multipliers of a solution ``x``, shape (n,)."""
    place, bound, weights, work, row, column, diagonal, lower, upper = idle
    m = np.uint64(weights.shape[0])
    if m == 0:
        return
    first, left, part, y = place[0], work[0], work[1], work[2]
    for k in range(m):
        left[k] = weights[k] * x[first + k]
    for _ in range(_PASSES):
        for k in range(m):
            part[k] = left[k]
        for _ in range(_POWER):
            for k in range(m):
                y[np.uint64(column[k])] = bound[0] * part[k]
            substitute(diagonal, lower, upper, y, m)
            for k in range(m):
                part[k] = y[np.uint64(row[k])]
        for k in range(m):
            left[k] -= part[k]
    for k in range(m):
        x[first + k] = left[k] / weights[k]
