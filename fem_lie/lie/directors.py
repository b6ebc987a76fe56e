"""A frame as four vectors ``q = (x, d₁, d₂, d₃)``: their rates and accelerations; compiled.

For a twist ``v = (u, ω)`` along the frame's own axes, ``q̇ = L v`` is ``ẋ = R u`` and ``ḋ_k = R (ω
× e_k)``. Forces ``f`` on the four vectors are the generalised force ``Lᵀ f`` on the frame: force
``Rᵀ f_x``, moment ``Σ e_k × Rᵀ f_k``.
"""

from __future__ import annotations

from math import sqrt

from fem_lie._arrays import Array
from fem_lie._jit import inlined, uncounted
from fem_lie.lie.tuples import Vector, combined, cross, dot, load_row, plus, scaled, store_rows

_OPPOSITE = 1e-12
"""Least ``1 + cos``: there is no smallest rotation to the opposite direction."""


@uncounted
def rotate_onto(rows: Array, way: Vector) -> None:
    """Rotate the axes in ``rows`` (4, 3) by the smallest rotation of the first onto ``way``."""
    D, second_axis = load_row(rows, 1), load_row(rows, 2)
    t = scaled(1.0 / sqrt(dot(way, way)), way)
    near = max(1.0 + dot(D, t), _OPPOSITE)
    second = combined(1.0, second_axis, -dot(second_axis, t) / near, plus(D, t))
    store_rows(rows, 1, t, second, cross(t, second))


@inlined
def push_forward(H: Array, v: Array, out: Array) -> None:
    """Rates ``q̇ = L v``, shape (4, 3)."""
    u0, u1, u2, w0, w1, w2 = v[0], v[1], v[2], v[3], v[4], v[5]
    for j in range(3):
        d1, d2, d3 = H[1, j], H[2, j], H[3, j]
        out[0, j] = d1 * u0 + d2 * u1 + d3 * u2
        out[1, j] = d2 * w2 - d3 * w1
        out[2, j] = d3 * w0 - d1 * w2
        out[3, j] = d1 * w1 - d2 * w0


@inlined
def _along(H: Array, a: int, f: Array, k: int) -> float:
    """Component of ``f[k]`` along director ``a`` of the frame ``H``."""
    return H[1 + a, 0] * f[k, 0] + H[1 + a, 1] * f[k, 1] + H[1 + a, 2] * f[k, 2]


@inlined
def pull_back(H: Array, f: Array, sign: float, r: Array) -> None:
    """Add the generalised force ``sign · Lᵀ f`` of forces ``f`` (4, 3) to ``r`` (6,)."""
    for a in range(3):
        r[a] += sign * _along(H, a, f, 0)
    r[3] += sign * (_along(H, 2, f, 2) - _along(H, 1, f, 3))
    r[4] += sign * (_along(H, 0, f, 3) - _along(H, 2, f, 1))
    r[5] += sign * (_along(H, 1, f, 1) - _along(H, 0, f, 2))


@inlined
def pull_back_derivative(H: Array, f: Array, sign: float, block: Array) -> None:
    """Add ``sign · ∂(Lᵀ f)/∂h`` to ``block`` (6, 6).

    The blocks are ``(Rᵀf_x)^`` in (force, rotation) and ``Σ m_k e_kᵀ − (e_k·m_k) I`` with ``m_k =
    Rᵀ f_k`` in (moment, rotation).
    """
    n0, n1, n2 = _along(H, 0, f, 0), _along(H, 1, f, 0), _along(H, 2, f, 0)
    block[0, 4] -= sign * n2
    block[0, 5] += sign * n1
    block[1, 3] += sign * n2
    block[1, 5] -= sign * n0
    block[2, 3] -= sign * n1
    block[2, 4] += sign * n0
    trace = 0.0
    for k in range(3):
        trace += _along(H, k, f, 1 + k)
        for a in range(3):
            block[3 + a, 3 + k] += sign * _along(H, a, f, 1 + k)
    for a in range(3):
        block[3 + a, 3 + a] -= sign * trace


@inlined
def local_acceleration(v: Array, a: Array, w: Array) -> None:
    """Components ``w`` (4, 3) of ``Rᵀ q̈``: ``u̇ + ω×u`` and ``(ω̇^ + ω^ω^) e_k``."""
    u0, u1, u2, w0, w1, w2 = v[0], v[1], v[2], v[3], v[4], v[5]
    a0, a1, a2 = a[3], a[4], a[5]
    w[0, 0] = a[0] + w1 * u2 - w2 * u1
    w[0, 1] = a[1] + w2 * u0 - w0 * u2
    w[0, 2] = a[2] + w0 * u1 - w1 * u0
    w[1, 0] = -w1 * w1 - w2 * w2
    w[1, 1] = w0 * w1 + a2
    w[1, 2] = w0 * w2 - a1
    w[2, 0] = w0 * w1 - a2
    w[2, 1] = -w0 * w0 - w2 * w2
    w[2, 2] = w1 * w2 + a0
    w[3, 0] = w0 * w2 + a1
    w[3, 1] = w1 * w2 - a0
    w[3, 2] = -w0 * w0 - w1 * w1


@inlined
def to_global(H: Array, w: Array, out: Array) -> None:
    """Global components of four vectors with components ``w`` (4, 3) in the frame."""
    for k in range(4):
        for j in range(3):
            out[k, j] = H[1, j] * w[k, 0] + H[2, j] * w[k, 1] + H[3, j] * w[k, 2]


@inlined
def hat_minus(w: Array, scale: float, out: Array) -> None:
    """``out −= scale · ŵ``."""
    out[0, 1] += scale * w[2]
    out[0, 2] -= scale * w[1]
    out[1, 0] -= scale * w[2]
    out[1, 2] += scale * w[0]
    out[2, 0] += scale * w[1]
    out[2, 1] -= scale * w[0]


@inlined
def acceleration_derivatives(
    translates: bool,
    v: Array,
    a: Array,
    factors: tuple[float, float],
    right: tuple[Array, Array],
    work: tuple[Array, Array],
) -> None:
    """Derivatives of q̈ in local components: ``W[k]`` in (a, v), ``X[k]`` in h, each (4, 3, 6).

    ``W = mass ∂q̈/∂a + damping ∂q̈/∂v``; ``X`` is the effect of a rotation of the frame, ``−ŵ_k``.

    Args:
        translates: Whether ``a`` contains ẍ itself, as on R³×SO(3), where it depends neither on ω
            nor on the rotation of the frame.
        v: Twist.
        a: Rate of the twist.
        factors: ``mass`` and ``damping``.
        right: ``W`` and ``X``, overwritten.
        work: Arrays of shapes (3,) and (4, 3).
    """
    (mass, damping), (W, X), (unit, vector) = factors, right, work
    W[:] = 0.0
    X[:] = 0.0
    u, omega = v[:3], v[3:]
    for j in range(3):
        W[0, j, j] = mass
    if not translates:
        hat_minus(omega, -damping, W[0, :, :3])
        hat_minus(u, damping, W[0, :, 3:])
    for k in range(3):
        unit[:] = 0.0
        unit[k] = 1.0
        hat_minus(unit, mass, W[1 + k, :, 3:])
        # ∂(ω×(ω×e_k))/∂ω = ω e_kᵀ + ω_k I − 2 e_k ωᵀ
        for j in range(3):
            W[1 + k, j, 3 + k] += damping * omega[j]
            W[1 + k, j, 3 + j] += damping * omega[k]
            W[1 + k, k, 3 + j] -= 2.0 * damping * omega[j]
    local_acceleration(v, a, vector)
    for k in range(1 if translates else 0, 4):
        hat_minus(vector[k], 1.0, X[k, :, 3:])
