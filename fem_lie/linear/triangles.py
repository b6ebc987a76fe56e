"""Triangular factors of SuperLU for compiled loops, by columns and without their diagonal."""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
import scipy.sparse.linalg as spla

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined

ONE, TWO = np.uint64(1), np.uint64(2)


Triangle: TypeAlias = tuple[Array, Indices, Indices]
"""Values, row indices and column pointers."""


class Triangles(NamedTuple):
    """``Aᵀ = Pᵣᵀ L U P_cᵀ``, both factors by columns, without the diagonal.

    Attributes:
        row: Permutation ``Pᵣ``, shape (n,).
        column: Permutation ``P_c``.
        diagonal: Inverse of the diagonal of ``U``.
        lower: ``L``.
        upper: ``U``.
    """

    row: Indices
    column: Indices
    diagonal: Array
    lower: Triangle
    upper: Triangle

    @classmethod
    def none(cls) -> Triangles:
        """Factors of an empty matrix."""
        number, whole = np.empty(0), np.empty(0, dtype=np.int64)
        triangle = number, whole, whole
        return cls(whole, whole, number, triangle, triangle)

    @classmethod
    def of(cls, lu: spla.SuperLU) -> Triangles:
        """From the factors of ``Aᵀ``."""
        L, U = lu.L, lu.U
        diagonal: Array = np.ones(L.shape[0])
        lower = _strict(L.data, L.indices, L.indptr, diagonal)
        upper = _strict(U.data, U.indices, U.indptr, diagonal)
        row, column = lu.perm_r.astype(np.int64), lu.perm_c.astype(np.int64)
        return cls(row, column, np.reciprocal(diagonal), lower, upper)


@compiled
def _strict(values: Array, indices: Indices, pointers: Indices, diagonal: Array) -> Triangle:
    """Triangle by columns without its diagonal, which is written into ``diagonal``."""
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


@inlined
def _along(values: Array, indices: Indices, y: Array, first: np.uint64, end: np.uint64) -> float:
    """Product of a row of a triangle with ``y``, in two sums, as each waits for its last term."""
    even, odd, k = 0.0, 0.0, first
    while k + ONE < end:
        even += values[k] * y[np.uint64(indices[k])]
        odd += values[k + ONE] * y[np.uint64(indices[k + ONE])]
        k += TWO
    if k < end:
        even += values[k] * y[np.uint64(indices[k])]
    return even + odd


@inlined
def substitute(diagonal: Array, lower: Triangle, upper: Triangle, y: Array, n: np.uint64) -> None:
    """``y ← L⁻ᵀ U⁻ᵀ y``, the first ``n`` of ``y``.

    Indices are unsigned: the compiler would check signed ones at each use.
    """
    values, indices, pointers = upper
    for j in range(n):
        first, end = np.uint64(pointers[j]), np.uint64(pointers[j + ONE])
        y[j] = (y[j] - _along(values, indices, y, first, end)) * diagonal[j]
    values, indices, pointers = lower
    for j in range(n):
        i = n - ONE - j
        y[i] -= _along(values, indices, y, np.uint64(pointers[i]), np.uint64(pointers[i + ONE]))
