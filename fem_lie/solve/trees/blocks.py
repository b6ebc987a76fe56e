"""Symmetric matrices, and inertias (6, 6) as rows of numbers, for compiled code."""

from __future__ import annotations

from typing import TypeAlias

from fem_lie._arrays import Array
from fem_lie._jit import inlined
from fem_lie.lie.tuples import Matrix, Vector, combined, cross, plus, rotate, scaled

Symmetric: TypeAlias = tuple[float, float, float, float, float, float]
"""Symmetric 3×3 matrix: xx, xy, xz, yy, yz, zz."""

INERTIA = 21
"""Numbers of an inertia: symmetric block of translations (6), coupling (9), rotations (6)."""


@inlined
def first_half(M: Array, i: int) -> Vector:
    """First three numbers of row ``i`` of a matrix with six columns."""
    return M[i, 0], M[i, 1], M[i, 2]


@inlined
def second_half(M: Array, i: int) -> Vector:
    """Last three numbers of row ``i``."""
    return M[i, 3], M[i, 4], M[i, 5]


@inlined
def store_halves(M: Array, i: int, u: Vector, ω: Vector) -> None:
    """Write the six numbers of row ``i``."""
    M[i, 0], M[i, 1], M[i, 2] = u
    M[i, 3], M[i, 4], M[i, 5] = ω


@inlined
def add_three(M: Array, i: int, at: int, values: Vector) -> None:
    """Add three numbers to row ``i`` from column ``at``."""
    M[i, at] += values[0]
    M[i, at + 1] += values[1]
    M[i, at + 2] += values[2]


@inlined
def load_symmetric(M: Array, i: int, at: int) -> Symmetric:
    """Six numbers of row ``i`` from column ``at``."""
    return M[i, at], M[i, at + 1], M[i, at + 2], M[i, at + 3], M[i, at + 4], M[i, at + 5]


@inlined
def load_blocks(M: Array, i: int) -> tuple[Symmetric, Matrix, Symmetric]:
    """Blocks of an inertia: translations, coupling, rotations."""
    B = M[i, 6], M[i, 7], M[i, 8], M[i, 9], M[i, 10], M[i, 11], M[i, 12], M[i, 13], M[i, 14]
    return load_symmetric(M, i, 0), B, load_symmetric(M, i, 15)


@inlined
def times_symmetric(S: Symmetric, v: Vector) -> Vector:
    """``S v``."""
    return (
        S[0] * v[0] + S[1] * v[1] + S[2] * v[2],
        S[1] * v[0] + S[3] * v[1] + S[4] * v[2],
        S[2] * v[0] + S[4] * v[1] + S[5] * v[2],
    )


@inlined
def times(M: Matrix, v: Vector) -> Vector:
    """``M v``."""
    return (
        M[0] * v[0] + M[1] * v[1] + M[2] * v[2],
        M[3] * v[0] + M[4] * v[1] + M[5] * v[2],
        M[6] * v[0] + M[7] * v[1] + M[8] * v[2],
    )


@inlined
def transposed_times(M: Matrix, v: Vector) -> Vector:
    """``Mᵀ v``."""
    return (
        M[0] * v[0] + M[3] * v[1] + M[6] * v[2],
        M[1] * v[0] + M[4] * v[1] + M[7] * v[2],
        M[2] * v[0] + M[5] * v[1] + M[8] * v[2],
    )


@inlined
def inverse_of(S: Symmetric) -> Symmetric:
    """``S⁻¹``, by cofactors."""
    a, b, c, d, e, f = S
    xx, xy, xz = d * f - e * e, c * e - b * f, b * e - c * d
    r = 1.0 / (a * xx + b * xy + c * xz)
    return r * xx, r * xy, r * xz, r * (a * f - c * c), r * (b * c - a * e), r * (a * d - b * b)


@inlined
def rotated(d1: Vector, d2: Vector, d3: Vector, S: Symmetric) -> Symmetric:
    """``R S Rᵀ``."""
    t1 = rotate(d1, d2, d3, (S[0], S[1], S[2]))
    t2 = rotate(d1, d2, d3, (S[1], S[3], S[4]))
    t3 = rotate(d1, d2, d3, (S[2], S[4], S[5]))
    return (
        t1[0] * d1[0] + t2[0] * d2[0] + t3[0] * d3[0],
        t1[0] * d1[1] + t2[0] * d2[1] + t3[0] * d3[1],
        t1[0] * d1[2] + t2[0] * d2[2] + t3[0] * d3[2],
        t1[1] * d1[1] + t2[1] * d2[1] + t3[1] * d3[1],
        t1[1] * d1[2] + t2[1] * d2[2] + t3[1] * d3[2],
        t1[2] * d1[2] + t2[2] * d2[2] + t3[2] * d3[2],
    )


@inlined
def rotated_full(d1: Vector, d2: Vector, d3: Vector, M: Matrix) -> tuple[Vector, Vector, Vector]:
    """Rows of ``R M Rᵀ``."""
    t1 = rotate(d1, d2, d3, (M[0], M[3], M[6]))
    t2 = rotate(d1, d2, d3, (M[1], M[4], M[7]))
    t3 = rotate(d1, d2, d3, (M[2], M[5], M[8]))
    return (
        plus(scaled(t1[0], d1), combined(t2[0], d2, t3[0], d3)),
        plus(scaled(t1[1], d1), combined(t2[1], d2, t3[1], d3)),
        plus(scaled(t1[2], d1), combined(t2[2], d2, t3[2], d3)),
    )


@inlined
def add_inertia(
    M: Array, i: int, A: Symmetric, b: tuple[Vector, Vector, Vector], D: Symmetric
) -> None:
    """Add blocks ``A``, the rows of ``B``, and ``D``."""
    for k in range(6):
        M[i, k] += A[k]
        M[i, 15 + k] += D[k]
    for k in range(3):
        M[i, 6 + k] += b[0][k]
        M[i, 9 + k] += b[1][k]
        M[i, 12 + k] += b[2][k]


@inlined
def rows_crossed(r: Vector, A: Symmetric) -> tuple[Vector, Vector, Vector]:
    """Rows of ``−A r̂``, the coupling of a mass at ``r`` with rotations."""
    return (
        cross(r, (A[0], A[1], A[2])),
        cross(r, (A[1], A[3], A[4])),
        cross(r, (A[2], A[4], A[5])),
    )


@inlined
def columns_crossed(r: Vector, rows: tuple[Vector, Vector, Vector]) -> Symmetric:
    """Upper triangle of ``r̂ B`` of a matrix ``B`` with these rows."""
    c1, c2, c3 = rows
    h1 = cross(r, (c1[0], c2[0], c3[0]))
    h2 = cross(r, (c1[1], c2[1], c3[1]))
    h3 = cross(r, (c1[2], c2[2], c3[2]))
    return h1[0], h2[0], h3[0], h2[1], h3[1], h3[2]
