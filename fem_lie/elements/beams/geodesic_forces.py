"""Forces and energy of the geodesic beam, by hand.

With the strain ``ε(d) − ε*`` of :func:`~fem_lie.elements.beams.geodesic.geodesic_strain` and the
stress ``σ = D (ε − ε*)`` the energy is ``½ ℓ (ε − ε*)·σ``. With ``N = ℓ (∂ε/∂d)ᵀ σ`` forces on the
nodes are ``(−T₆⁻ᵀ(−d) N, T₆⁻ᵀ(d) N)``. Of ``T₆⁻ᵀ`` all but the cross products is even in ``d``:
both nodes share one set of coefficients and one sum of even terms.

UFL and the element's map derive the same, but compute coefficients twice, and coordinates once more
for the energy: that takes 1.3 to 1.5 times as long for forces, and 2.2 times for forces and energy,
which conserving schemes ask for together.
"""

from __future__ import annotations

from math import sqrt

import numba

from fem_lie import lie
from fem_lie._arrays import Array
from fem_lie._jit import callback, inlined
from fem_lie._jit.stack import stack
from fem_lie.elements.beams.element import S_SHAPE
from fem_lie.forms.kernels.addresses import UFCX_SIGNATURE, Pointer
from fem_lie.lie.series import inverse_coefficients
from fem_lie.lie.tuples import (
    Vector,
    combined,
    cross,
    dot,
    load,
    minus,
    plus,
    scaled,
    store,
)

_Y, _LENGTH, _D, _EIGENSTRAIN, _UNLOADED, _SHARE, _ENERGY = 24, 30, 31, 67, 73, 79, 83
"""Where numbers of a cell are, behind the rows of both nodes."""
_SIZE = 84
_ARC = 1 / 60  # see geodesic_strain


@inlined
def set_stress(data: Array, N: Array) -> float:
    """Forces ``N`` (6,) that do work on the relative motion in ``data``; returns the energy."""
    e, length = numba.carray(stack(6), (6,)), data[_LENGTH]
    d, d0, inverse = data[_Y:_LENGTH], data[_UNLOADED:_SHARE], 1.0 / length
    for i in range(6):
        e[i] = (d[i] - d0[i]) * inverse
    F22, F23, F32, F33 = data[_SHARE], data[_SHARE + 1], data[_SHARE + 2], data[_SHARE + 3]
    β2, β3 = F22 * e[1] + F23 * e[2], F32 * e[1] + F33 * e[2]
    # θ = (d[5], −d[4]) and θ₀, their components along β
    p, p0 = d[5] * β2 - d[4] * β3, d0[5] * β2 - d0[4] * β3
    X, square = 1.0 + e[0], β2 * β2 + β3 * β3
    C = sqrt(X * X + square)
    per_C = 1.0 / C
    excess = S_SHAPE * square * per_C * per_C
    e[0] += square / (C + abs(X)) + excess * C
    if F22 != 0.0 or F33 != 0.0:
        e[0] += abs(X) - X
    e[1] -= _ARC * (d[5] * p - d0[5] * p0)
    e[2] += _ARC * (d[4] * p - d0[4] * p0)
    work = 0.0
    for i in range(6):
        e[i] -= data[_EIGENSTRAIN + i]
    for i in range(6):
        N[i] = 0.0
        for j in range(6):
            N[i] += data[_D + 6 * i + j] * e[j]
        work += N[i] * e[i]
    # what does work on β and on θ
    q, q0 = d[5] * N[1] - d[4] * N[2], d0[5] * N[1] - d0[4] * N[2]
    across = N[0] * per_C * (1.0 + 2.0 * S_SHAPE - excess)
    m2 = across * β2 - _ARC * (d[5] * q - d0[5] * q0)
    m3 = across * β3 + _ARC * (d[4] * q - d0[4] * q0)
    N[4] += length * _ARC * (N[2] * p + β3 * q)
    N[5] -= length * _ARC * (N[1] * p + β2 * q)
    if F22 != 0.0 or F33 != 0.0:
        N[0] *= X * per_C * (1.0 - excess)
    N[1] += F22 * m2 + F32 * m3
    N[2] += F23 * m2 + F33 * m3
    return 0.5 * length * work


@inlined
def both_ends(d: Array, N: Array) -> tuple[Vector, Vector, Vector, Vector]:
    """Of ``T₆⁻ᵀ(±d) N`` what is even and odd in ``d``, forces and then moments."""
    u, θ, f, m = load(d, 0), load(d, 3), load(N, 0), load(N, 3)
    (α, _, γ), (dα, _, dγ) = inverse_coefficients(dot(θ, θ))
    s, p = 2.0 * dot(θ, u), dot(θ, f)
    along = s * dγ * p + γ * (dot(u, f) + dot(θ, m))
    moment = plus(combined(s * dα, f, α, m), combined(along, θ, γ * p, u))
    odd = scaled(0.5, plus(cross(u, f), cross(θ, m)))
    return combined(α, f, γ * p, θ), moment, scaled(0.5, cross(θ, f)), odd


@callback(UFCX_SIGNATURE)
def force_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Forces and moments on both nodes, in their frames; the energy is left in its place."""
    H, data = numba.carray(w, (2, 4, 3)), numba.carray(w, (_SIZE,))
    N, d = numba.carray(stack(6), (6,)), data[_Y:_LENGTH]
    lie.relative(H[0], H[1], d)
    data[_ENERGY] = set_stress(data, N)
    force, moment, odd_force, odd_moment = both_ends(d, N)
    r = numba.carray(A, (12,))
    store(r, 0, minus(load(r, 0), plus(force, odd_force)))
    store(r, 3, minus(load(r, 3), plus(moment, odd_moment)))
    store(r, 6, plus(load(r, 6), minus(force, odd_force)))
    store(r, 9, plus(load(r, 9), minus(moment, odd_moment)))
