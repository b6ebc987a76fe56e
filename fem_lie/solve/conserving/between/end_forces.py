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
