"""The operations of SE(3) in :mod:`fem_lie.lie` for one point at a time, for compiled loops.

Nothing is allocated: results go to the last argument, ``out``, which may be any view of the right
shape and may be one of the inputs. Shapes: frames ``H`` (4, 3), twists and forces (6,), matrices
(6, 6); they are not checked. Conventions stand in :mod:`fem_lie.lie`, formulas in
:mod:`fem_lie.lie.series`.
"""

from __future__ import annotations

from fem_lie._arrays import Array
from fem_lie._jit import inlined
from fem_lie.lie.series import (
    Coefficients,
    blend,
    cayley,
    dual_blend,
    dual_part,
    exponential,
    inverse_coefficients,
    inverse_transposed_second,
    matrix,
    rotation_vector,
    tangent_coefficients,
)
from fem_lie.lie.tuples import (
    ZERO,
    Vector,
    combined,
    dot,
    load,
    load_frame,
    minus,
    negative,
    plus,
    plus_outer,
    rotate,
    rotate_back,
    scaled,
    shifted_hat,
    store,
    store_block,
    store_codual,
    store_dual,
    store_frame,
    store_row,
)

# --- frames -------------------------------------------------------------------------------------


@inlined
def exp_se3(d: Array, out: Array) -> None:
    """Frame ``exp(d) = (exp θ̂, Tᵀ(θ) u)`` of an increment ``d = (u, θ)``.

    Args:
        d: Increment (u, θ), shape (6,).
        out: The result, shape (4, 3), written in place.
    """
    p, r1, r2, r3 = exponential(load(d, 0), load(d, 3))
    store_frame(out, p, r1, r2, r3)


@inlined
def retract(H: Array, d: Array, out: Array) -> None:
    """Frame ``H exp(d)`` after a local increment ``d``.

    Args:
        H: Frame, shape (4, 3).
        d: Increment (u, θ), shape (6,).
        out: The result, shape (4, 3), written in place.
    """
    p, r1, r2, r3 = exponential(load(d, 0), load(d, 3))
    x, d1, d2, d3 = load_frame(H)
    moved = plus(x, rotate(d1, d2, d3, p))
    store_frame(out, moved, rotate(d1, d2, d3, r1), rotate(d1, d2, d3, r2), rotate(d1, d2, d3, r3))


@inlined
def log_se3(H: Array, out: Array) -> None:
    """Increment ``d = log(H)`` with ``|θ| ≤ π``: translation, rotation in rad.

    Args:
        H: Frame, shape (4, 3).
        out: The result, shape (6,), written in place.
    """
    x, d1, d2, d3 = load_frame(H)
    _store_log(out, x, d1, d2, d3)


@inlined
def relative(A: Array, B: Array, out: Array) -> None:
    """Increment ``log(A⁻¹B)`` from frame A to frame B, components in A, ``|θ| ≤ π``.

    Args:
        A: Frame, shape (4, 3).
        B: Frame, shape (4, 3).
        out: The result, shape (6,), written in place.
    """
    xa, a1, a2, a3 = load_frame(A)
    xb, b1, b2, b3 = load_frame(B)
    _store_log(
        out,
        rotate_back(a1, a2, a3, minus(xb, xa)),
        rotate_back(a1, a2, a3, b1),
        rotate_back(a1, a2, a3, b2),
        rotate_back(a1, a2, a3, b3),
    )


@inlined
def compose(A: Array, B: Array, out: Array) -> None:
    """Frame ``A B = (R_A R_B, x_A + R_A x_B)``.

    Args:
        A: Frame, shape (4, 3).
        B: Frame, shape (4, 3).
        out: The result, shape (4, 3), written in place.
    """
    xa, a1, a2, a3 = load_frame(A)
    xb, b1, b2, b3 = load_frame(B)
    moved = plus(xa, rotate(a1, a2, a3, xb))
    store_frame(out, moved, rotate(a1, a2, a3, b1), rotate(a1, a2, a3, b2), rotate(a1, a2, a3, b3))


@inlined
def inverse(H: Array, out: Array) -> None:
    """Inverse frame ``H⁻¹ = (Rᵀ, −Rᵀx)``.

    Args:
        H: Frame, shape (4, 3).
        out: The result, shape (4, 3), written in place.
    """
    x, (a, b, c), (d, e, f), (g, h, i) = load_frame(H)
    back = rotate_back((a, b, c), (d, e, f), (g, h, i), x)
    store_frame(out, negative(back), (a, d, g), (b, e, h), (c, f, i))


@inlined
def reorthonormalise(H: Array) -> None:
    """One Newton-Schulz step ``R ← R(3I − RᵀR)/2`` in place; the error of ``RᵀR`` is squared.

    Args:
        H: Frame, shape (4, 3).
    """
    _, d1, d2, d3 = load_frame(H)
    a, b, c = 0.5 * dot(d1, d2), 0.5 * dot(d2, d3), 0.5 * dot(d3, d1)
    store_row(H, 1, minus(_stretched(d1), combined(a, d2, c, d3)))
    store_row(H, 2, minus(_stretched(d2), combined(b, d3, a, d1)))
    store_row(H, 3, minus(_stretched(d3), combined(c, d1, b, d2)))


# --- tangent operator ---------------------------------------------------------------------------


@inlined
def tangent(d: Array, out: Array) -> None:
    """Tangent operator ``T₆(d)`` of the exponential map: ``H⁻¹δH = (T₆(d) δd)^``.

    Args:
        d: Increment (u, θ), shape (6,).
        out: The result, shape (6, 6), written in place.
    """
    _store_matrix(tangent_coefficients(_angle2(d)), 1.0, d, out)


@inlined
def tangent_inverse(d: Array, out: Array) -> None:
    """Inverse ``T₆⁻¹(d)`` of the tangent operator, for ``|θ| < 2π``.

    Args:
        d: Increment (u, θ), shape (6,).
        out: The result, shape (6, 6), written in place.
    """
    _store_matrix(inverse_coefficients(_angle2(d)), 1.0, d, out)


@inlined
def tangent_inverse_minus(d: Array, out: Array) -> None:
    """Inverse of the tangent operator at ``−d``: ``T₆⁻¹(−d) = T₆⁻¹(d) Ad(exp −d)``.

    Args:
        d: Increment (u, θ), shape (6,).
        out: The result, shape (6, 6), written in place.
    """
    _store_matrix(inverse_coefficients(_angle2(d)), -1.0, d, out)


@inlined
def apply_tangent(d: Array, v: Array, out: Array) -> None:
    """Product ``T₆(d) v`` of the tangent operator with a twist.

    Args:
        d: Increment (u, θ), shape (6,).
        v: Twist, shape (6,).
        out: The result, shape (6,), written in place.
    """
    _store_twist(tangent_coefficients(_angle2(d)), 1.0, d, v, out)


@inlined
def apply_tangent_transposed(d: Array, f: Array, out: Array) -> None:
    """Product ``T₆ᵀ(d) f`` of the transposed tangent operator with a force and moment.

    Args:
        d: Increment (u, θ), shape (6,).
        f: Force and moment, shape (6,).
        out: The result, shape (6,), written in place.
    """
    _store_force(tangent_coefficients(_angle2(d)), -1.0, d, f, out)


@inlined
def apply_tangent_inverse(d: Array, v: Array, out: Array) -> None:
    """Product ``T₆⁻¹(d) v`` of the inverse tangent operator with a twist.

    Args:
        d: Increment (u, θ), shape (6,).
        v: Twist, shape (6,).
        out: The result, shape (6,), written in place.
    """
    _store_twist(inverse_coefficients(_angle2(d)), 1.0, d, v, out)


@inlined
def apply_tangent_inverse_minus(d: Array, v: Array, out: Array) -> None:
    """Product ``T₆⁻¹(−d) v`` of the inverse tangent operator at ``−d`` with a twist.

    Args:
        d: Increment (u, θ), shape (6,).
        v: Twist, shape (6,).
        out: The result, shape (6,), written in place.
    """
    _store_twist(inverse_coefficients(_angle2(d)), -1.0, d, v, out)


@inlined
def apply_tangent_inverse_transposed(d: Array, f: Array, out: Array) -> None:
    """Product ``T₆⁻ᵀ(d) f`` of the inverse transpose with a force and moment.

    Args:
        d: Increment (u, θ), shape (6,).
        f: Force and moment, shape (6,).
        out: The result, shape (6,), written in place.
    """
    _store_force(inverse_coefficients(_angle2(d)), -1.0, d, f, out)


@inlined
def apply_tangent_inverse_transposed_minus(d: Array, f: Array, out: Array) -> None:
    """Product ``T₆⁻ᵀ(−d) f`` of the inverse transpose at ``−d`` with a force and moment.

    Args:
        d: Increment (u, θ), shape (6,).
        f: Force and moment, shape (6,).
        out: The result, shape (6,), written in place.
    """
    _store_force(inverse_coefficients(_angle2(d)), 1.0, d, f, out)


@inlined
def tangent_inverse_transposed_derivative(d: Array, f: Array, out: Array) -> None:
    """Derivative ``G(d, f) = ∂(T₆⁻ᵀ(d) f)/∂d`` at constant ``f``; a column per component.

    Args:
        d: Increment (u, θ), shape (6,).
        f: Force and moment, shape (6,).
        out: The result, shape (6, 6), written in place.
    """
    _store_derivative(1.0, d, f, out)


@inlined
def tangent_inverse_transposed_derivative_minus(d: Array, f: Array, out: Array) -> None:
    """``G(−d, f)``: ``∂(T₆⁻ᵀ(δ) f)/∂δ`` at ``δ = −d``; the derivative is by δ, not by d.

    Args:
        d: Increment (u, θ), shape (6,).
        f: Force and moment, shape (6,).
        out: The result, shape (6, 6), written in place.
    """
    _store_derivative(-1.0, d, f, out)


# --- Cayley map ---------------------------------------------------------------------------------


@inlined
def cayley_se3(d: Array, out: Array) -> None:
    """Frame ``cay(d) = (I − ½X)⁻¹(I + ½X)``, ``X = d̂``: rotation ``cay ψ`` of ``d = (u, ψ)``.

    Args:
        d: Increment (u, θ), shape (6,).
        out: The result, shape (4, 3), written in place.
    """
    p, r1, r2, r3 = cayley(load(d, 0), load(d, 3))
    store_frame(out, p, r1, r2, r3)


@inlined
def cayley_tangent_se3(d: Array, out: Array) -> None:
    """Tangent operator of Cayley's map: ``H⁻¹δH = (C₆(d) δd)^`` for ``H = cay d``.

    ``C₆(d) = [[A, −½ûC], [0, C]]``, ``A = (I + ½ψ̂)⁻¹``.

    From ``H⁻¹δH = (I + ½X)⁻¹ δX (I − ½X)⁻¹``; ``C(ψ)`` is that of SO(3).

    Args:
        d: Increment (u, θ), shape (6,).
        out: The result, shape (6, 6), written in place.
    """
    u, ψ = load(d, 0), load(d, 3)
    r = 1.0 / (1.0 + 0.25 * dot(ψ, ψ))
    # −½ û (I − ½ψ̂) r, with û ψ̂ = ψ uᵀ − (u·ψ) I
    coupling = shifted_hat(-0.25 * r * dot(u, ψ), scaled(-0.5 * r, u))
    store_block(out, 0, 0, matrix((r, -0.5 * r, 0.25 * r), ψ))
    store_block(out, 0, 3, plus_outer(coupling, scaled(0.25 * r, ψ), u))
    store_block(out, 3, 0, ZERO)
    store_block(out, 3, 3, shifted_hat(r, scaled(-0.5 * r, ψ)))


@inlined
def cayley_tangent_inverse_se3(d: Array, out: Array) -> None:
    """Inverse ``C₆⁻¹(d) = [[A, ½Aû], [0, C⁻¹]]``, ``A = I + ½ψ̂``, of :func:`cayley_tangent_se3`.

    Args:
        d: Increment (u, θ), shape (6,).
        out: The result, shape (6, 6), written in place.
    """
    u, ψ = load(d, 0), load(d, 3)
    # ¼ ψ̂ û = ¼ (u ψᵀ − (u·ψ) I)
    coupling = shifted_hat(-0.25 * dot(u, ψ), scaled(0.5, u))
    store_block(out, 0, 0, shifted_hat(1.0, scaled(0.5, ψ)))
    store_block(out, 0, 3, plus_outer(coupling, scaled(0.25, u), ψ))
    store_block(out, 3, 0, ZERO)
    store_block(out, 3, 3, matrix((1.0, 0.5, 0.25), ψ))


# --- load and store -----------------------------------------------------------------------------


@inlined
def _store_log(out: Array, x: Vector, d1: Vector, d2: Vector, d3: Vector) -> None:
    θ = rotation_vector(d1, d2, d3)
    k, _ = inverse_coefficients(dot(θ, θ))
    store(out, 0, blend(k, negative(θ), x))
    store(out, 3, θ)


@inlined
def _stretched(d: Vector) -> Vector:
    """``d + ½(1 − d·d) d``, in the order that rounds a unit vector least."""
    return plus(d, scaled(0.5 - 0.5 * dot(d, d), d))


@inlined
def _angle2(d: Array) -> float:
    θ = load(d, 3)
    return dot(θ, θ)


@inlined
def _store_twist(
    k: tuple[Coefficients, Coefficients], s: float, d: Array, v: Array, out: Array
) -> None:
    """``[[M, dM], [0, M]](s d) v``: rotations are real, translations dual parts."""
    u, θ = scaled(s, load(d, 0)), scaled(s, load(d, 3))
    real, dual = dual_blend(k[0], k[1], θ, u, load(v, 3), load(v, 0))
    store(out, 0, dual)
    store(out, 3, real)


@inlined
def _store_force(
    k: tuple[Coefficients, Coefficients], s: float, d: Array, f: Array, out: Array
) -> None:
    """``[[M, 0], [dM, M]](s d) f``: forces are real, moments dual parts."""
    u, θ = scaled(s, load(d, 0)), scaled(s, load(d, 3))
    real, dual = dual_blend(k[0], k[1], θ, u, load(f, 0), load(f, 3))
    store(out, 0, real)
    store(out, 3, dual)


@inlined
def _store_matrix(k: tuple[Coefficients, Coefficients], s: float, d: Array, out: Array) -> None:
    u, θ = scaled(s, load(d, 0)), scaled(s, load(d, 3))
    store_dual(out, matrix(k[0], θ), dual_part(k[0], k[1], θ, u))


@inlined
def _store_derivative(s: float, d: Array, f: Array, out: Array) -> None:
    u, θ = scaled(s, load(d, 0)), scaled(s, load(d, 3))
    F, dF = inverse_transposed_second(θ, u, load(f, 0), load(f, 3))
    store_codual(out, F, dF)
