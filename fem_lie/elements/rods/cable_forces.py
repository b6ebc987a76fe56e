"""Forces of the cable of places and slopes, by hand: the gradient of its energy in closed form.

With ``c`` the chord over the length, ``T = A + B`` and ``D = B − A`` of the end slopes ``A`` and
``B``, slope and bend of the cubic (the latter times the length) are, ``σ`` from the middle::

    f = (3/2 − 6 σ²) c + (3 σ² − ¼) T + σ D,    g = D − σ (12 c − 6 T).

Stretch counts at Lobatto's points, where ``f`` is ``A``, ``3/2 c − T/4`` and ``B``; bending at
Gauss' points, ``½ β |f × g|²/|f|⁴`` each, whose gradients are with ``ρ = f·g/|f|²``::

    ∂f = β/|f|² ((2 ρ² − |g|²/|f|²) f − ρ g),    ∂g = β/|f|² (g − ρ f).

What is derived here is what UFL derives of :mod:`.cable` in six times the time. The small-energy
kernel (``docs/how_to/gradient_element.py``) takes 2.15 times as long for forces, which is what an
explicit step takes, 1.2 times for forces and energy, and half as long for forces and tangent.
"""

from __future__ import annotations

from math import inf, sqrt

import numba
import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import callback, inlined
from fem_lie.forms.kernels.addresses import UFCX_SIGNATURE, Pointer
from fem_lie.lie.kinds import SLOPE, axes
from fem_lie.lie.tuples import (
    Vector,
    combined,
    dot,
    load_row,
    minus,
    negative,
    plus,
    rotate_back,
    scaled,
)

_SIGMA = 0.5 * sqrt(0.6)
_LENGTH, _STRETCH, _SPEED, _BENDING, _SLACK, _SIZE = 24, 25, 28, 31, 34, 35
"""Where numbers of a cell are, behind the rows of both nodes; and how many."""


def packed(lengths: Array, stiffness: Array, speeds: Array | None, slack: float | None) -> Array:
    """What the kernel reads of each cell, shape (m, 11).

    Args:
        lengths: In the parameter, negative where slopes point from the second end to the first,
            shape (m,).
        stiffness: Of the section, shape (m, 6, 6).
        speeds: Unstretched arc length per parameter at the points of both rules, in order, shape
            (m, 5), or ``None`` where it is one.
        slack: See :class:`~fem_lie.HermiteCable`.
    """
    J = np.ones((len(lengths), 5)) if speeds is None else speeds
    EA, EI = (stiffness[:, k, k, np.newaxis] for k in (0, 4))
    along = lengths[:, np.newaxis]
    stretch = EA * np.abs(along) * np.array([1.0, 4.0, 1.0]) / 6
    bending = EI / np.abs(along) * np.array([5.0, 8.0, 5.0]) / 18 / J[:, 1:4]
    limit = np.full(len(along), -inf if slack is None else slack)
    return np.column_stack([lengths, stretch, 1 / J[:, ::2], bending, limit])


@inlined
def _stress(ε: float, slack: float) -> float:
    """Over ``EA``; see :mod:`.thread_law`."""
    width, beyond = 0.5 * slack, ε - slack
    if ε > slack + width:
        return ε
    weak = slack / (1.0 + slack)
    between = 0.0 if beyond < -width else (beyond + width) ** 2 / (4.0 * width)
    return weak * (1.0 + ε) + (1.0 - weak) * between


@inlined
def _pulled(data: Array, k: int, f: Vector) -> Vector:
    """Gradient in the slope at Lobatto's point ``k``."""
    n = sqrt(dot(f, f))
    return scaled(data[_STRETCH + k] * _stress(n * data[_SPEED + k] - 1.0, data[_SLACK]) / n, f)


@inlined
def _bent(data: Array, k: int, f: Vector, g: Vector) -> tuple[Vector, Vector]:
    """Gradients in slope and bend at Gauss' point ``k``."""
    inverse = 1.0 / dot(f, f)
    scale, ρ = data[_BENDING + k] * inverse, dot(f, g) * inverse
    own = 2.0 * ρ * ρ - dot(g, g) * inverse
    return combined(scale * own, f, -scale * ρ, g), combined(scale, g, -scale * ρ, f)


@callback(UFCX_SIGNATURE)
def force_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Forces on places and slopes of both nodes, along their axes."""
    H, data = numba.carray(w, (2, 4, 3)), numba.carray(w, (_SIZE,))
    out = numba.carray(A, (2, 6))
    first, last = load_row(H[0], 1), load_row(H[1], 1)
    inverse = 1.0 / data[_LENGTH]
    chord = scaled(inverse, minus(load_row(H[1], 0), load_row(H[0], 0)))
    T, D = plus(first, last), minus(last, first)
    middle = combined(1.5, chord, -0.25, T)
    P, Q = combined(0.6, chord, 0.2, T), scaled(_SIGMA, combined(12.0, chord, -6.0, T))
    side = scaled(_SIGMA, D)
    f1, g1 = _bent(data, 0, minus(P, side), plus(D, Q))
    f2, g2 = _bent(data, 1, middle, D)
    f3, g3 = _bent(data, 2, plus(P, side), minus(D, Q))
    f2, on_P = plus(f2, _pulled(data, 1, middle)), plus(f1, f3)
    on_Q = scaled(_SIGMA, minus(g1, g3))
    on_D = plus(combined(_SIGMA, minus(f3, f1), 1.0, g2), plus(g1, g3))
    on_T = combined(1.0, combined(0.2, on_P, -0.25, f2), -6.0, on_Q)
    on_chord = combined(1.0, combined(0.6, on_P, 1.5, f2), 12.0, on_Q)
    force = scaled(inverse, on_chord)
    slopes = (
        plus(minus(on_T, on_D), _pulled(data, 0, first)),
        plus(plus(on_T, on_D), _pulled(data, 2, last)),
    )
    forces = negative(force), force
    for i in range(2):
        e1, e2, e3 = axes(SLOPE, H[i])
        for j in range(3):
            out[i, j] += rotate_back(e1, e2, e3, forces[i])[j]
            out[i, 3 + j] += rotate_back(e1, e2, e3, slopes[i])[j]
