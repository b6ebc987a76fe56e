r"""Curvatures of a surface at a point, with their derivatives: compiled.

Of ``z = (r₁, r₂, r₁₁, r₂₂, r₁₂)``, derivatives of the place, with the normal ``n = m/|m|``,
``m = r₁ × r₂``, changes of curvature are those of ``κ = −(r₁₁·n, r₂₂·n, 2 r₁₂·n)``. For moments
``M`` let ``Q = M₁ r₁₁ + M₂ r₂₂ + 2 M₃ r₁₂``; then ``M·κ = −Q·n`` and, with
``P = (Q − n n·Q)/|m|``::

    d(M·κ)  = −M₁ n·dr₁₁ − M₂ n·dr₂₂ − 2 M₃ n·dr₁₂ − P·dm,    dm = dr₁ × r₂ + r₁ × dr₂
    d²(M·κ) = −2 dQ·dn − dm·B dm − 2 P·(dr₁ × dr₂),           dn = (dm − n n·dm)/|m|
    B       = −(P nᵀ + n Pᵀ)/|m| − n·Q (I − n nᵀ)/|m|²
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled, inlined
from fem_lie.lie.tuples import Vector, combined, cross, dot, minus, plus, scaled

Derivatives: TypeAlias = tuple[Vector, Vector, Vector, Vector, Vector]
"""``z``, or what belongs to it."""


@inlined
def normal(z: Derivatives) -> tuple[Vector, float]:
    """Unit normal, and the area ``|m|`` per area of parameters."""
    m = cross(z[0], z[1])
    size = np.sqrt(dot(m, m))
    return scaled(1.0 / size, m), size


@inlined
def curvatures(z: Derivatives) -> Vector:
    """``κ`` at ``z``."""
    n, _ = normal(z)
    return -dot(z[2], n), -dot(z[3], n), -2.0 * dot(z[4], n)


@inlined
def _of_moments(z: Derivatives, M: Vector) -> Vector:
    """``Q``."""
    bent = combined(M[0], z[2], M[1], z[3])
    return plus(bent, scaled(2.0 * M[2], z[4]))


@inlined
def pull_moments(z: Derivatives, M: Vector) -> Derivatives:
    """``∂(M·κ)/∂z``."""
    n, size = normal(z)
    Q = _of_moments(z, M)
    P = scaled(1.0 / size, minus(Q, scaled(dot(Q, n), n)))
    return (
        cross(P, z[1]),
        cross(z[0], P),
        scaled(-M[0], n),
        scaled(-M[1], n),
        scaled(-2.0 * M[2], n),
    )


@inlined
def _store_hat(A: Array, factor: float, a: Vector) -> None:
    """``A = factor â``, shape (3, 3)."""
    A[0, 0], A[1, 1], A[2, 2] = 0.0, 0.0, 0.0
    A[0, 1], A[1, 0] = -factor * a[2], factor * a[2]
    A[0, 2], A[2, 0] = factor * a[1], -factor * a[1]
    A[1, 2], A[2, 1] = -factor * a[0], factor * a[0]


@compiled
def geometric(z: Derivatives, M: Vector, G: Array, work: Array) -> None:
    """``G = ∂²(M·κ)/∂z²``, shape (5, 3, 5, 3); ``work``: shape (5, 3, 3)."""
    n, size = normal(z)
    Q = _of_moments(z, M)
    along = dot(Q, n)
    P = scaled(1.0 / size, minus(Q, scaled(along, n)))
    B, turn, product = work[0], work[1], work[2]
    for i in range(3):
        for j in range(3):
            flat = (1.0 if i == j else 0.0) - n[i] * n[j]
            B[i, j] = -(P[i] * n[j] + n[i] * P[j]) / size - along * flat / size**2
            turn[i, j] = flat / size
    G[:] = 0.0
    factors = (M[0], M[1], 2.0 * M[2])
    # dm = X₁ dr₁ + X₂ dr₂
    _store_hat(work[3], -1.0, z[1])
    _store_hat(work[4], 1.0, z[0])
    for b in range(2):
        X = work[3 + b]
        _multiply(turn, X, product)
        for k in range(3):
            for i in range(3):
                for j in range(3):
                    G[2 + k, i, b, j] = -factors[k] * product[i, j]
                    G[b, j, 2 + k, i] = -factors[k] * product[i, j]
        _multiply(B, X, product)
        for a in range(2):
            Y = work[3 + a]
            for i in range(3):
                for j in range(3):
                    s = Y[0, i] * product[0, j] + Y[1, i] * product[1, j] + Y[2, i] * product[2, j]
                    G[a, i, b, j] = -s
    _store_hat(product, 1.0, P)
    for i in range(3):
        for j in range(3):
            G[0, i, 1, j] += product[i, j]
            G[1, i, 0, j] += product[j, i]


@inlined
def _multiply(A: Array, X: Array, out: Array) -> None:
    for i in range(3):
        for j in range(3):
            out[i, j] = A[i, 0] * X[0, j] + A[i, 1] * X[1, j] + A[i, 2] * X[2, j]
