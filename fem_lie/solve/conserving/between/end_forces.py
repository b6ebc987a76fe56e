"""Forces of constraints at the ends of steps, from those that act over the steps.

A multiplier λ of a conserving step is the force over that step: of second order in its middle, but
for a part that changes its sign from step to step. Velocities that satisfy the constraints of each
mean ``q̄`` miss those at the ends of steps by ``c h²`` once in two steps; the joint takes that
difference back and forth, with the force ``±2 c h``. So the force at the end of a step, a straight
line through three of its past values and what alternates with an impulse of constant size, is::

    λ(t₁) = Σ wₖ λₖ,      Σ wₖ = 1,   Σ wₖ (t₁ − tₖ) = 0,   Σ wₖ (−1)ᵏ/hₖ = 0,

for constant steps ``λ₁ + ½ λ₂ − ½ λ₃``, the last one first.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled
from fem_lie.lie.tuples import cross, scaled


@compiled
def at_end(last: Array, earlier: Array, sizes: Array) -> Array:
    """Multipliers at the end of the last step, shape (m,).

    Args:
        last: Those over the last step.
        earlier: Those over the two before, the later one first, (2, m).
        sizes: Of these three steps, the last one first, (3,).
    """
    h1, h2, h3 = sizes[0], sizes[1], sizes[2]
    after = 0.5 * h1, h1 + 0.5 * h2, h1 + h2 + 0.5 * h3
    w = cross(after, (1.0 / h1, -1.0 / h2, 1.0 / h3))
    w = scaled(1.0 / (w[0] + w[1] + w[2]), w)
    out = np.empty_like(last)
    for c in range(last.shape[0]):
        out[c] = w[0] * last[c] + w[1] * earlier[0, c] + w[2] * earlier[1, c]
    return out


@compiled
def rates_at_end(rates: Array, sizes: Array, out: Array) -> None:
    """Accelerations of increments (n, 6) at the end of the last step.

    Mean accelerations of a step are those of its middle; the end is half a step further, along the
    line through the last two of them: of second order.

    Args:
        rates: Means over the last step and the one before, or at the instant where it began,
            (2, n, 6).
        sizes: Of these steps; nil at an instant.
        out: Overwritten.
    """
    whole = sizes[0] + sizes[1]
    share = sizes[0] / whole if whole > 0.0 else 0.0
    for i in range(out.shape[0]):
        for k in range(6):
            out[i, k] = rates[0, i, k] + share * (rates[0, i, k] - rates[1, i, k])
