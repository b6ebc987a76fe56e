"""Vectors, matrices and wrenches as tuples of numbers, for compiled code.

Vectors are tuples of 3 numbers and matrices tuples of 9, row by row: they are kept in registers,
without allocation. In a six-vector with a dual part, ``(A, dA)`` represents a matrix (6, 6).
"""

from __future__ import annotations

from typing import TypeAlias

from fem_lie._arrays import Array
from fem_lie._jit import inlined

Vector: TypeAlias = tuple[float, float, float]
Matrix: TypeAlias = tuple[float, float, float, float, float, float, float, float, float]

ZERO: Matrix = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@inlined
def load(v: Array, k: int) -> Vector:
    """Three numbers of ``v`` from index ``k``."""
    return v[k], v[k + 1], v[k + 2]


@inlined
def store(v: Array, k: int, a: Vector) -> None:
    """Write three numbers into ``v`` from index ``k``."""
    v[k], v[k + 1], v[k + 2] = a


@inlined
def load_row(M: Array, i: int) -> Vector:
    """Row ``i`` of a matrix with three columns."""
    return M[i, 0], M[i, 1], M[i, 2]


@inlined
def store_row(M: Array, i: int, a: Vector) -> None:
    """Write row ``i`` of a matrix with three columns."""
    M[i, 0], M[i, 1], M[i, 2] = a


@inlined
def store_rows(M: Array, i: int, a: Vector, b: Vector, c: Vector) -> None:
    """Write three rows from row ``i``."""
    store_row(M, i, a)
    store_row(M, i + 1, b)
    store_row(M, i + 2, c)


@inlined
def store_block(M: Array, i: int, j: int, A: Matrix) -> None:
    """Write nine numbers, row by row, from entry (i, j)."""
    M[i, j], M[i, j + 1], M[i, j + 2] = A[0], A[1], A[2]
    M[i + 1, j], M[i + 1, j + 1], M[i + 1, j + 2] = A[3], A[4], A[5]
    M[i + 2, j], M[i + 2, j + 1], M[i + 2, j + 2] = A[6], A[7], A[8]


@inlined
def load_frame(H: Array) -> tuple[Vector, Vector, Vector, Vector]:
    """Position and directors of a frame (4, 3)."""
    return load_row(H, 0), load_row(H, 1), load_row(H, 2), load_row(H, 3)


@inlined
def store_frame(out: Array, x: Vector, d1: Vector, d2: Vector, d3: Vector) -> None:
    """Write a frame (4, 3)."""
    store_row(out, 0, x)
    store_rows(out, 1, d1, d2, d3)


@inlined
def store_dual(out: Array, A: Matrix, dA: Matrix) -> None:
    """Write ``[[A, dA], [0, A]]``, (6, 6)."""
    store_block(out, 0, 0, A)
    store_block(out, 0, 3, dA)
    store_block(out, 3, 0, ZERO)
    store_block(out, 3, 3, A)


@inlined
def store_codual(out: Array, A: Matrix, dA: Matrix) -> None:
    """Write ``[[0, A], [A, dA]]``, (6, 6)."""
    store_block(out, 0, 0, ZERO)
    store_block(out, 0, 3, A)
    store_block(out, 3, 0, A)
    store_block(out, 3, 3, dA)


@inlined
def dot(a: Vector, b: Vector) -> float:
    """``a·b``."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def cross(a: Vector, b: Vector) -> Vector:
    """``a × b``."""
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


@inlined
def scaled(s: float, a: Vector) -> Vector:
    """``s a``."""
    return s * a[0], s * a[1], s * a[2]


@inlined
def negative(a: Vector) -> Vector:
    """``−a``."""
    return -a[0], -a[1], -a[2]


@inlined
def plus(a: Vector, b: Vector) -> Vector:
    """``a + b``."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@inlined
def minus(a: Vector, b: Vector) -> Vector:
    """``a − b``."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@inlined
def combined(s: float, a: Vector, t: float, b: Vector) -> Vector:
    """``s a + t b``."""
    return s * a[0] + t * b[0], s * a[1] + t * b[1], s * a[2] + t * b[2]


@inlined
def shifted_hat(s: float, a: Vector) -> Matrix:
    """``s I + â``."""
    return s, -a[2], a[1], a[2], s, -a[0], -a[1], a[0], s


@inlined
def plus_outer(A: Matrix, a: Vector, b: Vector) -> Matrix:
    """``A + a bᵀ``."""
    return (
        A[0] + a[0] * b[0],
        A[1] + a[0] * b[1],
        A[2] + a[0] * b[2],
        A[3] + a[1] * b[0],
        A[4] + a[1] * b[1],
        A[5] + a[1] * b[2],
        A[6] + a[2] * b[0],
        A[7] + a[2] * b[1],
        A[8] + a[2] * b[2],
    )


@inlined
def rotate(d1: Vector, d2: Vector, d3: Vector, v: Vector) -> Vector:
    """``R v`` of the rotation with the directors ``d1, d2, d3``."""
    return (
        d1[0] * v[0] + d2[0] * v[1] + d3[0] * v[2],
        d1[1] * v[0] + d2[1] * v[1] + d3[1] * v[2],
        d1[2] * v[0] + d2[2] * v[1] + d3[2] * v[2],
    )


@inlined
def rotate_back(d1: Vector, d2: Vector, d3: Vector, v: Vector) -> Vector:
    """``Rᵀ v`` of the rotation with the directors ``d1, d2, d3``."""
    return dot(d1, v), dot(d2, v), dot(d3, v)


@inlined
def add_wrench(out: Array, at: int, x: Vector, force: Vector, moment: Vector) -> None:
    """Add a force at ``x`` and a moment, global components, to six numbers of ``out``."""
    store(out, at, plus(load(out, at), force))
    store(out, at + 3, plus(load(out, at + 3), plus(moment, cross(x, force))))


@inlined
def add_dead(out: Array, at: int, sign: float, H: Array, f: Array) -> None:
    """Add ``sign f`` with forces ``f`` on the vectors (x, d₁, d₂, d₃) of ``H`` to ``out``."""
    for k in range(4):
        arm = cross(load_row(H, k), load_row(f, k))
        for j in range(3):
            if k == 0:
                out[at + j] += sign * f[k, j]
            out[at + 3 + j] += sign * arm[j]
