"""Operations of SO(3) in :mod:`fem_lie.lie` for one point, for compiled loops.

As in :mod:`fem_lie.lie.se3`, results are written in place, without allocation; rotations are
director rows ``D``, shape ``(3, 3)``.
"""

from __future__ import annotations

from fem_lie._arrays import Array
from fem_lie._jit import inlined
from fem_lie.lie.series import (
    blend,
    blend_derivative,
    exponential,
    inverse_coefficients,
    matrix,
    rotation_vector,
    tangent_coefficients,
)
from fem_lie.lie.tuples import (
    dot,
    load,
    load_row,
    negative,
    scaled,
    shifted_hat,
    store,
    store_block,
    store_rows,
)


@inlined
def exp_so3(theta: Array, out: Array) -> None:
    """Directors of the rotation ``R = exp θ̂``: rows of ``Rᵀ``.

    Args:
        theta: Rotation vector, rad, shape (3,).
        out: The result, shape (3, 3), written in place.
    """
    _, r1, r2, r3 = exponential((0.0, 0.0, 0.0), load(theta, 0))
    store_rows(out, 0, r1, r2, r3)


@inlined
def log_so3(D: Array, out: Array) -> None:
    """Rotation vector of a rotation given by its directors, rad, ``|θ| ≤ π``.

    Args:
        D: Director rows, shape (3, 3).
        out: The result, shape (3,), written in place.
    """
    store(out, 0, rotation_vector(load_row(D, 0), load_row(D, 1), load_row(D, 2)))


@inlined
def tangent_so3(theta: Array, out: Array) -> None:
    """Tangent operator ``T(θ)`` of the exponential map: ``RᵀδR = (T(θ) δθ)^``.

    Args:
        theta: Rotation vector, rad, shape (3,).
        out: The result, shape (3, 3), written in place.
    """
    t = load(theta, 0)
    k, _ = tangent_coefficients(dot(t, t))
    store_block(out, 0, 0, matrix(k, t))


@inlined
def tangent_inverse_so3(theta: Array, out: Array) -> None:
    """Inverse ``T⁻¹(θ)`` of the tangent operator, for ``|θ| < 2π``.

    Args:
        theta: Rotation vector, rad, shape (3,).
        out: The result, shape (3, 3), written in place.
    """
    t = load(theta, 0)
    k, _ = inverse_coefficients(dot(t, t))
    store_block(out, 0, 0, matrix(k, t))


@inlined
def apply_tangent_so3(theta: Array, w: Array, out: Array) -> None:
    """Product ``T(θ) w`` of the tangent operator with a vector.

    Args:
        theta: Rotation vector, rad, shape (3,).
        w: Vector, shape (3,).
        out: The result, shape (3,), written in place.
    """
    t = load(theta, 0)
    k, _ = tangent_coefficients(dot(t, t))
    store(out, 0, blend(k, t, load(w, 0)))


@inlined
def apply_tangent_transposed_so3(theta: Array, w: Array, out: Array) -> None:
    """Product ``Tᵀ(θ) w = T(−θ) w`` of the transposed tangent operator with a vector.

    Args:
        theta: Rotation vector, rad, shape (3,).
        w: Vector, shape (3,).
        out: The result, shape (3,), written in place.
    """
    t = load(theta, 0)
    k, _ = tangent_coefficients(dot(t, t))
    store(out, 0, blend(k, negative(t), load(w, 0)))


@inlined
def apply_tangent_inverse_so3(theta: Array, w: Array, out: Array) -> None:
    """Product ``T⁻¹(θ) w`` of the inverse tangent operator with a vector.

    Args:
        theta: Rotation vector, rad, shape (3,).
        w: Vector, shape (3,).
        out: The result, shape (3,), written in place.
    """
    t = load(theta, 0)
    k, _ = inverse_coefficients(dot(t, t))
    store(out, 0, blend(k, t, load(w, 0)))


@inlined
def apply_tangent_inverse_transposed_so3(theta: Array, w: Array, out: Array) -> None:
    """Product ``T⁻ᵀ(θ) w = T⁻¹(−θ) w`` of the inverse transpose with a vector.

    Args:
        theta: Rotation vector, rad, shape (3,).
        w: Vector, shape (3,).
        out: The result, shape (3,), written in place.
    """
    t = load(theta, 0)
    k, _ = inverse_coefficients(dot(t, t))
    store(out, 0, blend(k, negative(t), load(w, 0)))


@inlined
def tangent_derivative_so3(theta: Array, w: Array, out: Array) -> None:
    """Derivative ``∂(T(θ) w)/∂θ`` at constant ``w``; one column per component of θ.

    Args:
        theta: Rotation vector, rad, shape (3,).
        w: Vector, shape (3,).
        out: The result, shape (3, 3), written in place.
    """
    t = load(theta, 0)
    k, dk = tangent_coefficients(dot(t, t))
    store_block(out, 0, 0, blend_derivative(k, dk, t, load(w, 0)))


@inlined
def tangent_inverse_derivative_so3(theta: Array, w: Array, out: Array) -> None:
    """Derivative ``∂(T⁻¹(θ) w)/∂θ`` at constant ``w``; one column per component of θ.

    Args:
        theta: Rotation vector, rad, shape (3,).
        w: Vector, shape (3,).
        out: The result, shape (3, 3), written in place.
    """
    t = load(theta, 0)
    k, dk = inverse_coefficients(dot(t, t))
    store_block(out, 0, 0, blend_derivative(k, dk, t, load(w, 0)))


@inlined
def cayley_so3(psi: Array, out: Array) -> None:
    """Directors of the rotation ``R = cay ψ = I + (ψ̂ + ½ψ̂²)/(1 + |ψ|²/4)``: rows of ``Rᵀ``.

    Args:
        psi: Cayley vector ψ, shape (3,).
        out: The result, shape (3, 3), written in place.
    """
    t = load(psi, 0)
    x = dot(t, t)
    r = 1.0 / (1.0 + 0.25 * x)
    k = (1.0 - 0.5 * r * x, -r, 0.5 * r)  # of the transpose: its rows are the columns of cay ψ
    store_block(out, 0, 0, matrix(k, t))


@inlined
def cayley_tangent_so3(psi: Array, out: Array) -> None:
    """Tangent operator of Cayley's map: ``RᵀδR = (C(ψ) δψ)^`` for ``R = cay ψ``.

    ``C(ψ) = (I − ½ψ̂)/(1 + |ψ|²/4)``.

    Args:
        psi: Cayley vector ψ, shape (3,).
        out: The result, shape (3, 3), written in place.
    """
    t = load(psi, 0)
    r = 1.0 / (1.0 + 0.25 * dot(t, t))
    store_block(out, 0, 0, shifted_hat(r, scaled(-0.5 * r, t)))


@inlined
def cayley_tangent_inverse_so3(psi: Array, out: Array) -> None:
    """Inverse ``C⁻¹(ψ) = I + ½ψ̂ + ¼ψψᵀ`` of the tangent operator of Cayley's map.

    Args:
        psi: Cayley vector ψ, shape (3,).
        out: The result, shape (3, 3), written in place.
    """
    t = load(psi, 0)
    store_block(out, 0, 0, matrix((1.0, 0.5, 0.25), t))
