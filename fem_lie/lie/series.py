"""Functions of rotation vectors as tuples of numbers, for compiled code.

All operators of SO(3) have one form, with coefficients that depend on ``x = θ·θ``::

    M(θ) = α I + β θ̂ + γ θθᵀ                                       (′ = d/dx below)

and those of SE(3) are the same over dual numbers: with ``θ + ε u`` in place of ``θ``, where
``ε² = 0``, the real part is the rotation and the dual part the translation (Chirikjian, vol. 2,
§10).
"""

from __future__ import annotations

from math import atan2, cos, factorial, pi, sin, sqrt
from typing import TypeAlias

from fem_lie._jit import inlined, inlined_series
from fem_lie.lie.tuples import (
    Matrix,
    Vector,
    combined,
    cross,
    dot,
    plus,
    plus_outer,
    scaled,
    shifted_hat,
)

Coefficients: TypeAlias = tuple[float, float, float]

_F = tuple(1.0 / factorial(k) for k in range(30))
_PI2 = pi * pi


@inlined_series
def stumpff(x: float) -> tuple[float, float, float, float, float, float, float, float]:
    """Stumpff functions ``c_k(x) = Σ (−x)ⁱ/(2i+k)!``, k = 0 … 7: ``cos θ``, ``sin θ/θ``, ….

    Entire in x; every ``c_k = 1/k! − x c_{k+2}`` is a Horner step, and the derivatives need no
    division: ``c_k′ = (k c_{k+2} − c_{k+1})/2``. Beyond θ = π nothing cancels in the closed forms.
    """
    if x > _PI2:
        θ = sqrt(x)
        c0, c1 = cos(θ), sin(θ) / θ
        c2, c3 = (1.0 - c0) / x, (1.0 - c1) / x
        c4, c5 = (0.5 - c2) / x, (_F[3] - c3) / x
        return c0, c1, c2, c3, c4, c5, (_F[4] - c4) / x, (_F[5] - c5) / x
    p = q = 0.0
    if x > 0.5:
        p = _F[20] - x * (_F[22] - x * (_F[24] - x * (_F[26] - x * _F[28])))
        q = _F[21] - x * (_F[23] - x * (_F[25] - x * (_F[27] - x * _F[29])))
    p = _F[12] - x * (_F[14] - x * (_F[16] - x * (_F[18] - x * p)))
    q = _F[13] - x * (_F[15] - x * (_F[17] - x * (_F[19] - x * q)))
    c6, c7 = _F[6] - x * (_F[8] - x * (_F[10] - x * p)), _F[7] - x * (_F[9] - x * (_F[11] - x * q))
    c4, c5 = _F[4] - x * c6, _F[5] - x * c7
    c2, c3 = _F[2] - x * c4, _F[3] - x * c5
    return 1.0 - x * c2, 1.0 - x * c3, c2, c3, c4, c5, c6, c7


@inlined
def tangent_coefficients(x: float) -> tuple[Coefficients, Coefficients]:
    """``(α, β, γ)`` and their derivatives for ``T = I − b θ̂ + c θ̂²``."""
    _, a, b, c, c4, c5, _, _ = stumpff(x)
    return (a, -b, c), (0.5 * (c - b), 0.5 * c - c4, 0.5 * (3.0 * c5 - c4))


@inlined
def inverse_series(x: float) -> tuple[float, float, float]:
    """``e = (1 − (θ/2) cot(θ/2))/θ²`` with ``e′`` and ``e″``.

    ``e = −(log b)′`` and ``b = c₁²/2``, both at θ/2: quotients of series without cancellation up to
    the pole at 2π, where the Bernoulli series has stopped converging.
    """
    _, c1, c2, c3, c4, c5, c6, c7 = stumpff(0.25 * x)
    r = 1.0 / c1
    e = 0.25 * r * (c2 - c3)
    de = 0.5 * e * e - (1.0 / 32.0) * r * (3.0 * (c5 - c4) + c3)
    dn = 7.5 * (c7 - c6) + 3.0 * c5 - 0.5 * c4
    return e, de, 1.5 * e * de - 0.25 * e * e * e - (1.0 / 128.0) * r * dn


@inlined
def inverse_coefficients(x: float) -> tuple[Coefficients, Coefficients]:
    """``(α, β, γ)`` and their derivatives for ``T⁻¹ = I + ½ θ̂ + e θ̂²``."""
    e, de, _ = inverse_series(x)
    return (1.0 - x * e, 0.5, e), (-e - x * de, 0.0, de)


@inlined
def blend(k: Coefficients, θ: Vector, w: Vector) -> Vector:
    """``M(θ) w``."""
    return plus(combined(k[0], w, k[1], cross(θ, w)), scaled(k[2] * dot(θ, w), θ))


@inlined
def dual_blend(
    k: Coefficients, dk: Coefficients, θ: Vector, u: Vector, v: Vector, w: Vector
) -> tuple[Vector, Vector]:
    """``M(θ + εu)(v + εw)``: real and dual part."""
    α, β, γ = k
    s, p = 2.0 * dot(θ, u), dot(θ, v)
    moved = combined(s * dk[1], θ, β, u)
    along_θ = s * dk[2] * p + γ * (dot(u, v) + dot(θ, w))
    dual = plus(combined(s * dk[0], v, α, w), plus(cross(moved, v), scaled(β, cross(θ, w))))
    return blend(k, θ, v), plus(dual, combined(along_θ, θ, γ * p, u))


@inlined
def matrix(k: Coefficients, θ: Vector) -> Matrix:
    """``M(θ)``."""
    return plus_outer(shifted_hat(k[0], scaled(k[1], θ)), scaled(k[2], θ), θ)


@inlined
def dual_part(k: Coefficients, dk: Coefficients, θ: Vector, u: Vector) -> Matrix:
    """Dual part of ``M(θ + εu)``, the derivative of ``M`` along ``u``."""
    _, β, γ = k
    s = 2.0 * dot(θ, u)
    A = shifted_hat(s * dk[0], combined(s * dk[1], θ, β, u))
    return plus_outer(plus_outer(A, combined(s * dk[2], θ, γ, u), θ), scaled(γ, θ), u)


@inlined
def blend_derivative(k: Coefficients, dk: Coefficients, θ: Vector, w: Vector) -> Matrix:
    """``∂(M(θ) w)/∂θ``."""
    _, β, γ = k
    A = shifted_hat(γ * dot(θ, w), scaled(-β, w))
    return plus_outer(plus_outer(A, scaled(2.0, blend(dk, θ, w)), θ), scaled(γ, θ), w)


@inlined
def inverse_transposed_second(θ: Vector, u: Vector, n: Vector, m: Vector) -> tuple[Matrix, Matrix]:
    """``∂(T⁻ᵀ(θ) n)/∂θ`` with ``θ + εu`` and ``n + εm`` in it: real and dual part."""
    x, s, p = dot(θ, θ), 2.0 * dot(θ, u), dot(θ, n)
    e, de, dde = inverse_series(x)
    dp = dot(u, n) + dot(θ, m)
    q = combined(p, θ, -x, n)
    dq = plus(combined(dp, θ, p, u), combined(-s, n, -x, m))
    w = combined(2.0 * de, q, -2.0 * e, n)
    dw = plus(combined(2.0 * s * dde, q, -2.0 * s * de, n), combined(2.0 * de, dq, -2.0 * e, m))
    F = plus_outer(shifted_hat(e * p, scaled(0.5, n)), w, θ)
    dF = plus_outer(shifted_hat(s * de * p + e * dp, scaled(0.5, m)), dw, θ)
    dF = plus_outer(plus_outer(dF, w, u), combined(s * de, θ, e, u), n)
    eθ = scaled(e, θ)
    return plus_outer(F, eθ, n), plus_outer(dF, eθ, m)


@inlined
def exponential(u: Vector, θ: Vector) -> tuple[Vector, Vector, Vector, Vector]:
    """Position ``Tᵀ(θ) u`` and columns of ``exp θ̂``."""
    cosine, a, b, c, _, _, _, _ = stumpff(dot(θ, θ))
    E = matrix((cosine, a, b), θ)
    return blend((a, b, c), θ, u), (E[0], E[3], E[6]), (E[1], E[4], E[7]), (E[2], E[5], E[8])


@inlined
def cayley(u: Vector, ψ: Vector) -> tuple[Vector, Vector, Vector, Vector]:
    """Position and columns of the rotation of ``cay(u, ψ) = (I − ½X)⁻¹(I + ½X)``, ``X = (u, ψ)^``.

    The position is ``(I − ½ψ̂)⁻¹ u``.
    """
    x = dot(ψ, ψ)
    r = 1.0 / (1.0 + 0.25 * x)
    E = matrix((1.0 - 0.5 * r * x, r, 0.5 * r), ψ)
    p = blend((r, 0.5 * r, 0.25 * r), ψ, u)
    return p, (E[0], E[3], E[6]), (E[1], E[4], E[7]), (E[2], E[5], E[8])


@inlined
def rotation_vector(r1: Vector, r2: Vector, r3: Vector) -> Vector:
    """Rotation vector, ``|θ| ≤ π``, of the rotation with columns ``r1, r2, r3``.

    Shepperd's choice (1978) of a quaternion, here ``(w, v)`` up to a positive factor: the one whose
    largest entry is a sum of non-negative terms, so that there is no cancellation for any rotation.
    """
    a, b, c = r1[0], r2[1], r3[2]
    if a + b + c > max(a, b, c):
        w, v = 1.0 + a + b + c, (r2[2] - r3[1], r3[0] - r1[2], r1[1] - r2[0])
    elif a >= max(b, c):
        w, v = r2[2] - r3[1], (1.0 + a - b - c, r1[1] + r2[0], r3[0] + r1[2])
    elif b >= c:
        w, v = r3[0] - r1[2], (r1[1] + r2[0], 1.0 + b - c - a, r2[2] + r3[1])
    else:
        w, v = r1[1] - r2[0], (r3[0] + r1[2], r2[2] + r3[1], 1.0 + c - a - b)
    s = sqrt(dot(v, v))
    if s == 0.0:
        return 0.0, 0.0, 0.0
    sign = 1.0 if w >= 0.0 else -1.0
    return scaled(sign * 2.0 * atan2(s, abs(w)) / s, v)
