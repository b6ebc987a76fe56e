"""Accelerations at the ends of steps of a scheme that knows velocities there, and means between.

Mean accelerations of a step are those of its middle; the end is half a step further, along the line
through the last two of them: of second order.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled


class Mean(NamedTuple):
    """Spatial accelerations over a time.

    Attributes:
        rates: Of the places and rotations of the nodes, global components, shape (n, 6).
        span: How long; 0 at an instant.
    """

    rates: Array
    span: float


class EndRates(NamedTuple):
    """What is known of the last step, and of the one before."""

    last: Mean
    older: Mean

    @classmethod
    def at(cls, rates: Array) -> EndRates:
        """Known at this instant."""
        mean = Mean(rates, 0.0)
        return cls(mean, mean)

    def after(self, rates: Array, span: float) -> EndRates:
        """With one more step."""
        return EndRates(Mean(rates, span), self.last)

    def end(self) -> Array:
        """At the end of the last step, shape (n, 6)."""
        last, older = self
        whole = last.span + older.span
        share = last.span / whole if whole > 0.0 else 0.0
        return np.asarray(last.rates + share * (last.rates - older.rates))


def spatial(H: Array, v: Array, rate: Array) -> Array:
    """Spatial accelerations from local twists and their rates, all (n, 6), at frames ``H``."""
    local = rate.copy()
    local[:, :3] += np.cross(v[:, 3:], v[:, :3])
    return np.einsum("nij,nki->nkj", H[:, 1:], local.reshape(-1, 2, 3)).reshape(-1, 6)


@compiled
def local_rates(H: Array, v: Array, rates: Array) -> Array:
    """The other way round."""
    local = np.empty_like(rates)
    for i in range(rates.shape[0]):
        for k in range(3):
            local[i, k] = local[i, 3 + k] = 0.0
            for j in range(3):
                local[i, k] += H[i, 1 + k, j] * rates[i, j]
                local[i, 3 + k] += H[i, 1 + k, j] * rates[i, 3 + j]
        local[i, 0] -= v[i, 4] * v[i, 2] - v[i, 5] * v[i, 1]
        local[i, 1] -= v[i, 5] * v[i, 0] - v[i, 3] * v[i, 2]
        local[i, 2] -= v[i, 3] * v[i, 1] - v[i, 4] * v[i, 0]
    return local
