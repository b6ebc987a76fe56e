"""Forces of the Kirchhoff rod, hand-written: gradient of its energy in closed form.

Along the midpoint axes between the nodes, with the rotation ``exp(θ/2) = (q, v)`` as a quaternion,
``c`` the chord over the length, ``T`` and ``G`` the sum and difference of the end tangents, each
scaled by the parameter speed of a spline, the first and second derivative of the cubic at the Gauss
points ``σ = ± 1/√12`` are::

    c + m σ G,    (m G + σ (6 m T − 12 c))/ℓ.

``S`` and ``B`` are these along axes that rotate with the geodesic, ``exp(σθ)``; there, with
``n = |S|``, ``p = (S₂, S₃)/(n + S₁)`` and ``g = S·B/n²``, curvatures and torsion are::

    κ₃ = (B₂ − B₁ p₂)/n − g p₂,    κ₂ = −(B₃ − B₁ p₃)/n + g p₃,
    τ = (θ₁ + p₂ θ₂ + p₃ θ₃)/ℓ + (p₃ B₂ − p₂ B₃)/n.

UFL's code of :func:`~fem_lie.elements.rods.kirchhoff.rod_strains` takes three times as long for
forces, and twice as long for forces and energy. A gradient has the name of its variable with a bar.

The cubic joins points at ``r_A`` and ``r_B`` from the nodes, on the line of tension centres.
"""

from __future__ import annotations

from math import atan2, factorial, sqrt
from typing import TypeAlias

import numba

from fem_lie._arrays import Array
from fem_lie._jit import callback, inlined
from fem_lie.forms.kernels.addresses import UFCX_SIGNATURE, Pointer
from fem_lie.lie.series import rotation_vector
from fem_lie.lie.tuples import (
    Matrix,
    Vector,
    combined,
    cross,
    dot,
    load,
    load_frame,
    minus,
    negative,
    plus,
    rotate,
    rotate_back,
    scaled,
)

_SIGMA = 0.5 / sqrt(3.0)
_FLAT = 0.5  # 1 + trace: below it a quaternion loses digits
_SMALL = 1e-4  # sin² α, below which a few terms are α/sin α to round-off
_F = tuple(1.0 / factorial(k) for k in range(18))
_LENGTH, _D, _EIGENSTRAIN, _PRESENT, _SPEEDS, _CENTRE, _ENDS = 30, 31, 67, 73, 85, 89, 92
"""Offsets of the data of a cell, behind the coordinates of both nodes and their relative motion."""

_Bar: TypeAlias = tuple[tuple[Vector, Vector, Vector, Vector], float]


@inlined
def _quaternion(columns: tuple[Vector, Vector, Vector]) -> tuple[float, Vector]:
    """Quaternion of a rotation."""
    b1, b2, b3 = columns
    w = 1.0 + b1[0] + b2[1] + b3[2]
    if w < _FLAT:
        θ = rotation_vector(b1, b2, b3)
        q = 0.5 * sqrt(max(w, 0.0))
        size = sqrt(dot(θ, θ))
        return q, scaled(sqrt(1.0 - q * q) / size, θ)
    root = sqrt(w)
    axial = b2[2] - b3[1], b3[0] - b1[2], b1[1] - b2[0]
    return 0.5 * root, scaled(0.5 / root, axial)


@inlined
def _half_angle(q: float, s: float) -> tuple[float, float]:
    """``k = α/sin α`` and ``(1 − k)/sin² α`` of ``q = cos α``, ``s = sin² α``."""
    if s < _SMALL:
        rest = -1.0 / 6.0 - s * (3.0 / 40.0 + s * (5.0 / 112.0 + s * 35.0 / 1152.0))
        return 1.0 - s * rest, rest
    root = sqrt(s)
    k = atan2(root, q) / root
    return k, (1.0 - k) / s


@inlined
def _stumpff(x: float) -> tuple[float, float, float]:
    """``c₁, c₂, c₃`` for ``x < 1``: eight terms of each."""
    p, r = _F[16], _F[17]
    p = _F[12] - x * (_F[14] - x * p)
    r = _F[13] - x * (_F[15] - x * r)
    p = _F[6] - x * (_F[8] - x * (_F[10] - x * p))
    r = _F[7] - x * (_F[9] - x * (_F[11] - x * r))
    c2, c3 = _F[2] - x * (_F[4] - x * p), _F[3] - x * (_F[5] - x * r)
    return 1.0 - x * c3, c2, c3


@inlined
def _rotation(α: float, β: float, γ: float, a: Vector) -> Matrix:
    """``α I + β â + γ a aᵀ``, row by row."""
    x, y, z = a
    return (
        α + γ * x * x,
        γ * x * y - β * z,
        γ * x * z + β * y,
        γ * x * y + β * z,
        α + γ * y * y,
        γ * y * z - β * x,
        γ * x * z - β * y,
        γ * y * z + β * x,
        α + γ * z * z,
    )


@inlined
def _times(M: Matrix, a: Vector) -> Vector:
    return (
        M[0] * a[0] + M[1] * a[1] + M[2] * a[2],
        M[3] * a[0] + M[4] * a[1] + M[5] * a[2],
        M[6] * a[0] + M[7] * a[1] + M[8] * a[2],
    )


@inlined
def _transposed(M: Matrix) -> Matrix:
    return M[0], M[3], M[6], M[1], M[4], M[7], M[2], M[5], M[8]


@inlined
def _speed(c: Vector, T: Vector) -> tuple[float, float, float, float]:
    """``m``, and the square, half and root that it is made of."""
    square, half = 1.0 - dot(T, T) / 16.0, 0.375 * dot(c, T)
    root = sqrt(half * half + 2.25 * square * dot(c, c))
    return (root - half) / square, square, half, root


@inlined
def _stress(data: Array, at: int, pace: float, ε: tuple[float, Vector]) -> tuple[float, Vector]:
    """Axial force and moments at a point for strain ``m`` and ``(τ, κ₂, κ₃)``.

    All are at the tension centre; the stiffness is on the strains at the axis of the rod.
    """
    r2, r3 = data[_CENTRE + 1], data[_CENTRE + 2]
    τ, κ2, κ3 = ε[1]
    e0, e1, e2 = ε[0] + κ3 * r2 - κ2 * r3 - data[at], τ * r3 - data[at + 1], -τ * r2 - data[at + 2]
    e3, e4, e5 = τ - data[at + 3], κ2 - data[at + 4], κ3 - data[at + 5]
    x = _EIGENSTRAIN
    e0, e1, e2 = e0 - data[x], e1 - data[x + 1], e2 - data[x + 2]
    e3, e4, e5 = e3 - data[x + 3], e4 - data[x + 4], e5 - data[x + 5]
    weight = 0.5 * data[_LENGTH] * pace
    N = weight * _row(data, 0, e0, e1, e2, e3, e4, e5)
    Q2 = weight * _row(data, 1, e0, e1, e2, e3, e4, e5)
    Q3 = weight * _row(data, 2, e0, e1, e2, e3, e4, e5)
    M1 = weight * _row(data, 3, e0, e1, e2, e3, e4, e5)
    M2 = weight * _row(data, 4, e0, e1, e2, e3, e4, e5)
    M3 = weight * _row(data, 5, e0, e1, e2, e3, e4, e5)
    return N, (M1 + r3 * Q2 - r2 * Q3, M2 - r3 * N, M3 + r2 * N)


@inlined
def _row(data: Array, i: int, a: float, b: float, c: float, d: float, e: float, f: float) -> float:
    k = _D + 6 * i
    return (
        data[k] * a
        + data[k + 1] * b
        + data[k + 2] * c
        + data[k + 3] * d
        + data[k + 4] * e
        + data[k + 5] * f
    )


@inlined
def _at_point(
    data: Array, at: int, pace: float, m: float, θ: Vector, E: Matrix, slope: Vector, bend: Vector
) -> _Bar:
    """Gradients of the energy at a Gauss point.

    Args:
        data: Data of the cell.
        at: Offset of its unloaded strains.
        pace: Arc length per parameter, relative to that at the midpoint.
        m: Speed.
        θ: Rotation over the length.
        E: Axes at the point, as columns.
        slope: Derivative of the position, over the length.
        bend: Derivative of ``slope``.

    Returns:
        Gradients in ``slope`` and ``bend``, in ``θ`` over the length directly, and in rotations of
        the axes, along these; and the axial force.
    """
    back = _transposed(E)
    # per arc length here
    slower = 1.0 / pace
    S, B, θ = _times(back, slope), scaled(slower, _times(back, bend)), scaled(slower, θ)
    square = dot(S, S)
    n = sqrt(square)
    r, over = 1.0 / n, 1.0 / (n + S[0])
    along = dot(S, B)
    g, p2, p3 = along * r * r, S[1] * over, S[2] * over
    b2, b3 = B[1] - B[0] * p2, B[2] - B[0] * p3
    mixed = p3 * B[1] - p2 * B[2]
    τ = θ[0] + p2 * θ[1] + p3 * θ[2] + mixed * r
    N, (t, k2, k3) = _stress(data, at, pace, (m, (τ, g * p3 - b3 * r, b2 * r - g * p2)))
    both = B[0] * r + g
    p2_, p3_ = t * (θ[1] - B[2] * r) - k3 * both, t * (θ[2] + B[1] * r) + k2 * both
    g_ = k2 * p3 - k3 * p2
    r_ = t * mixed + k3 * b2 - k2 * b3 + 2.0 * g_ * along * r
    n_ = -(p2_ * p2 + p3_ * p3) * over
    radial, turned = (n_ - r_ * r * r) * r, g_ * r * r
    S_ = combined(radial, S, turned, B)
    S_ = S_[0] + n_, S_[1] + p2_ * over, S_[2] + p3_ * over
    B_ = combined(turned, S, r, ((k2 * p3 - k3 * p2), k3 + t * p3, -k2 - t * p2))
    w = negative(plus(cross(S, S_), cross(B, B_)))
    t *= slower
    return (_times(E, S_), scaled(slower, _times(E, B_)), (t, t * p2, t * p3), w), N


@callback(UFCX_SIGNATURE)
def force_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Add forces and moments on both nodes along their frames, and store the energy."""
    H, data = numba.carray(w, (2, 4, 3)), numba.carray(w, (_ENDS + 6,))
    out = numba.carray(A, (2, 6))
    xa, a1, a2, a3 = load_frame(H[0])
    xb, b1, b2, b3 = load_frame(H[1])
    ra, rb = load(data, _ENDS), load(data, _ENDS + 3)
    xa, xb = plus(xa, rotate(a1, a2, a3, ra)), plus(xb, rotate(b1, b2, b3, rb))
    q, v = _quaternion(
        (rotate_back(a1, a2, a3, b1), rotate_back(a1, a2, a3, b2), rotate_back(a1, a2, a3, b3))
    )
    inverse, s = 1.0 / data[_LENGTH], dot(v, v)
    share = 1.0 / (1.0 + q)
    Q = _rotation(q, 1.0, share, v)
    to_middle = _transposed(Q)
    c_ = scaled(inverse, rotate_back(a1, a2, a3, minus(xb, xa)))
    chord = _times(to_middle, c_)
    k, rest = _half_angle(q, s)
    θ = scaled(2.0 * k, v)
    T0 = combined(2.0 * share * v[0], v, 2.0 * q, (1.0, 0.0, 0.0))
    G0 = 0.0, 2.0 * v[2], -2.0 * v[1]
    start, end = data[_SPEEDS], data[_SPEEDS + 1]
    alike, unlike = 0.5 * (start + end), 0.5 * (end - start)
    T, G = combined(alike, T0, unlike, G0), combined(unlike, T0, alike, G0)
    m, square, half, root = _speed(chord, T)
    a = scaled(_SIGMA, θ)
    c1, c2, c3 = _stumpff(dot(a, a))
    E = _rotation(1.0 - dot(a, a) * c2, c1, c2, a)
    change, swing = scaled(_SIGMA * m, G), combined(6.0 * m, T, -12.0, chord)
    even, odd = scaled(m * inverse, G), scaled(_SIGMA * inverse, swing)
    rate = scaled(inverse, θ)
    (S1, B1, θ1, w1), N1 = _at_point(
        data, _PRESENT + 6, data[_SPEEDS + 3], m, rate, E, plus(chord, change), plus(even, odd)
    )
    (S2, B2, θ2, w2), N2 = _at_point(
        data,
        _PRESENT,
        data[_SPEEDS + 2],
        m,
        rate,
        _transposed(E),
        minus(chord, change),
        minus(even, odd),
    )
    total, difference = plus(S1, S2), scaled(_SIGMA, minus(S1, S2))
    bends, bent = scaled(inverse, plus(B1, B2)), scaled(_SIGMA * inverse, minus(B1, B2))
    both = plus(difference, bends)
    m_ = N1 + N2 + dot(G, both) + 6.0 * dot(T, bent)
    # the speed's own
    root_, square_, half_ = m_ / square, -m_ * m / square, -m_ / square
    half_ += root_ * half / root
    square_ += root_ * 1.125 * dot(chord, chord) / root
    on_chord = plus(
        combined(1.0, total, -12.0, bent),
        combined(2.25 * root_ * square / root, chord, 0.375 * half_, T),
    )
    on_T = plus(scaled(6.0 * m, bent), combined(0.375 * half_, chord, -0.125 * square_, T))
    on_G = scaled(m, both)
    on_T, on_G = combined(alike, on_T, unlike, on_G), combined(unlike, on_T, alike, on_G)
    # axes at the points rotate by J(±a) of the rotation
    even_w, odd_w = plus(w1, w2), minus(w1, w2)
    turn = plus(combined(1.0, odd_w, c2, cross(a, even_w)), scaled(c3, cross(a, cross(a, odd_w))))
    on_θ = combined(inverse, plus(θ1, θ2), _SIGMA, turn)
    h = combined(k, on_θ, rest * dot(v, on_θ), v)
    moved = cross(chord, on_chord)
    held = plus(plus(moved, cross(T0, on_T)), cross(G0, on_G))
    apart = plus(cross(G0, on_T), cross(T0, on_G))
    e = plus(h, scaled(0.5, plus(apart, scaled(share, cross(held, v)))))
    force, lever = scaled(inverse, on_chord), scaled(0.5, moved)
    on_a, on_b = negative(_times(Q, force)), _times(to_middle, force)
    found = (
        on_a,
        plus(_times(Q, negative(plus(e, lever))), cross(ra, on_a)),
        on_b,
        plus(_times(to_middle, minus(e, lever)), cross(rb, on_b)),
    )
    for i in range(2):
        for j in range(3):
            out[i, j] += found[2 * i][j]
            out[i, 3 + j] += found[2 * i + 1][j]
