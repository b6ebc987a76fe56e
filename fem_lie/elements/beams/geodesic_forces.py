"""Forces and energy of the geodesic beam, by hand.

With the strain ``ε = (d − d₀)/ℓ − ε*`` and the stress ``N = D ε`` the energy is ``½ ℓ ε·N``, and
forces on the nodes are ``(−T₆⁻ᵀ(−d) N, T₆⁻ᵀ(d) N)``. Of ``T₆⁻ᵀ`` all but the cross products is
even in ``d``: both nodes share one set of coefficients and one sum of even terms.

That is what UFL and the element's map derive, which compute coefficients twice, and coordinates
once more for the energy.
"""

from __future__ import annotations

import numba

from fem_lie import lie
from fem_lie._arrays import Array
from fem_lie._jit import callback, inlined
from fem_lie._jit.stack import stack
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

_Y, _LENGTH, _D, _EIGENSTRAIN, _UNLOADED, _ENERGY = 24, 30, 31, 67, 73, 79
"""Where numbers of a cell are, behind the rows of both nodes."""
_SIZE = 80


@inlined
def set_stress(data: Array, N: Array) -> float:
    """Stress ``N`` (6,) of the relative motion in ``data``; returns the energy."""
    e, inverse = numba.carray(stack(6), (6,)), 1.0 / data[_LENGTH]
    for i in range(6):
        e[i] = (data[_Y + i] - data[_UNLOADED + i]) * inverse - data[_EIGENSTRAIN + i]
    work = 0.0
    for i in range(6):
        N[i] = 0.0
        for j in range(6):
            N[i] += data[_D + 6 * i + j] * e[j]
        work += N[i] * e[i]
    return 0.5 * data[_LENGTH] * work


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
