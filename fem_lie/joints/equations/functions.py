"""Nonlinear functions of the relative motion ``z = (Δ, Q)`` of two frames.

::

    φ = atan2(s·z, c·z)     an angle, with two rows s and c of each joint; unwrapped
    ℓ = |Δ|                 the distance of the two origins
    σ = |(Q₃₁, Q₃₂)|        sine of the angle between the axes e₃
    ω = axial(Qᵀ Q̇)         angular velocity of B relative to A, in the axes of B

Joints add them to linear terms ``S z``. For the rotation of B about e₃ of A, ``s·z = Q₂₁ −
Q₁₂`` and ``c·z = Q₁₁ + Q₂₂``, with ``s² + c² = (1 + Q₃₃)²``: smooth unless the axes are opposite.
The components of ω are rates of no coordinate: friction uses their derivatives ``∂ω/∂ż`` only.
"""

from __future__ import annotations

import math

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled, inlined

ANGLE, DISTANCE, TILT, SPIN = range(4)
"""Numbers of the functions; the three components of ω begin at ``SPIN``."""

COUNT = SPIN + 3
"""Number of factors of functions in a term."""


@inlined
def _components(z: Array, angle: Array) -> tuple[float, float]:
    s = c = 0.0
    for k in range(12):
        s += angle[0, k] * z[k]
        c += angle[1, k] * z[k]
    return s, c


@inlined
def values(z: Array, angle: Array, turned: float, out: Array) -> None:
    """Values of the three functions; the angle is the one within half a turn of ``turned``."""
    s, c = _components(z, angle)
    away = math.atan2(s, c) - turned
    out[ANGLE] = turned + away - 2.0 * np.pi * np.round(away / (2.0 * np.pi))
    out[DISTANCE] = math.sqrt(z[0] * z[0] + z[1] * z[1] + z[2] * z[2])
    out[TILT] = math.sqrt(z[9] * z[9] + z[10] * z[10])


@inlined
def add_gradients(z: Array, angle: Array, factors: Array, p: Array) -> None:
    """``p += Σ factorsₖ ∂fₖ/∂z``, shape (12,)."""
    if factors[ANGLE] != 0.0:
        s, c = _components(z, angle)
        over = factors[ANGLE] / (s * s + c * c)
        for k in range(12):
            p[k] += over * (c * angle[0, k] - s * angle[1, k])
    if factors[DISTANCE] != 0.0:
        over = factors[DISTANCE] / math.sqrt(z[0] * z[0] + z[1] * z[1] + z[2] * z[2])
        for k in range(3):
            p[k] += over * z[k]
    if factors[TILT] != 0.0:
        over = factors[TILT] / math.sqrt(z[9] * z[9] + z[10] * z[10])
        p[9] += over * z[9]
        p[10] += over * z[10]
    _add_spin(z, factors, p)


@inlined
def _add_spin(z: Array, factors: Array, p: Array) -> None:
    """Add ``½ q × m`` to the rows of ``p`` for the rows q of Q, with the factors m of ω."""
    x, y, w = factors[SPIN], factors[SPIN + 1], factors[SPIN + 2]
    if x != 0.0 or y != 0.0 or w != 0.0:
        for row in range(3, 12, 3):
            p[row] += 0.5 * (z[row + 1] * w - z[row + 2] * y)
            p[row + 1] += 0.5 * (z[row + 2] * x - z[row] * w)
            p[row + 2] += 0.5 * (z[row] * y - z[row + 1] * x)


@compiled
def add_gradient_changes(z: Array, dz: Array, angle: Array, factors: Array, dp: Array) -> None:
    """``dp += Σ factorsₖ ∂²fₖ/∂z² dz``, shape (12,)."""
    if factors[ANGLE] != 0.0:
        s, c = _components(z, angle)
        ds, dc = _components(dz, angle)
        n = s * s + c * c
        rate = 2.0 * (s * ds + c * dc) / n
        over = factors[ANGLE] / n
        for k in range(12):
            change = dc * angle[0, k] - ds * angle[1, k]
            dp[k] += over * (change - rate * (c * angle[0, k] - s * angle[1, k]))
    _add_spin(dz, factors, dp)
    _add_norm_change(z, dz, 0, 3, factors[DISTANCE], dp)
    _add_norm_change(z, dz, 9, 2, factors[TILT], dp)


@inlined
def _add_norm_change(z: Array, dz: Array, at: int, count: int, factor: float, dp: Array) -> None:
    """``add_gradient_changes`` for the norm of ``count`` components from ``at`` on."""
    if factor != 0.0:
        square = along = 0.0
        for k in range(at, at + count):
            square += z[k] * z[k]
            along += z[k] * dz[k]
        over = factor / math.sqrt(square)
        for k in range(at, at + count):
            dp[k] += over * (dz[k] - z[k] * along / square)


@compiled
def add_secants(z: Array, dz: Array, angle: Array, factors: Array, g: Array) -> None:
    """Add discrete gradients, ``g += Σ factorsₖ gₖ`` with ``gₖ·dz = fₖ(z + dz) − fₖ(z)``, (12,).

    The equality holds to round-off. ``gₖ`` has the direction of the gradient at ``z + ½ dz``, and
    tends to it for small ``dz``.
    """
    if factors[ANGLE] != 0.0:
        s, c = _components(z, angle)
        ds, dc = _components(dz, angle)
        cross = ds * c - dc * s
        s1, c1 = s + 0.5 * ds, c + 0.5 * dc
        over = 1.0 / (s1 * s1 + c1 * c1)
        if cross != 0.0:
            over = math.atan2(cross, s * (s + ds) + c * (c + dc)) / cross
        for k in range(12):
            g[k] += factors[ANGLE] * over * (c1 * angle[0, k] - s1 * angle[1, k])
    _add_norm_secant(z, dz, 0, 3, factors[DISTANCE], g)
    _add_norm_secant(z, dz, 9, 2, factors[TILT], g)


@inlined
def _add_norm_secant(z: Array, dz: Array, at: int, count: int, factor: float, g: Array) -> None:
    """``add_secants`` for the norm of ``count`` components from ``at`` on."""
    if factor != 0.0:
        before = after = 0.0
        for k in range(at, at + count):
            before += z[k] * z[k]
            after += (z[k] + dz[k]) ** 2
        over = 2.0 * factor / (math.sqrt(before) + math.sqrt(after))
        for k in range(at, at + count):
            g[k] += over * (z[k] + 0.5 * dz[k])
