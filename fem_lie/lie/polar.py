"""The rotation next to a matrix: the polar decomposition ``A = R U``, compiled."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled

_MOST = 60  # iterations; six do for moderate strains
_EXACT = 1e-15


@compiled
def polar_rotation(A: Array, R: Array) -> bool:
    """Set ``R`` (3, 3) to the rotation of ``A``; returns whether there is one.

    With the cofactor of ``A`` added, which turns alike, a matrix of rank two will do, such as that
    of places on a plane. Then ``R ← ½ (R + R⁻ᵀ)``.

    Args:
        A: Columns are images of axes, shape (3, 3).
        R: Overwritten.
    """
    size = np.sqrt((A * A).sum())
    if not size > 0.0:
        return False
    B = A / size
    _cofactor(B, R)
    R += B
    C = np.empty((3, 3))
    for _ in range(_MOST):
        _cofactor(R, C)
        volume = (R[0] * C[0]).sum()
        if not volume > 0.0:
            return False
        change = 0.0
        for i in range(3):
            for j in range(3):
                step = 0.5 * (C[i, j] / volume - R[i, j])
                R[i, j] += step
                change = max(change, abs(step))
        if change <= _EXACT:
            break
    return True


@compiled
def _cofactor(A: Array, out: Array) -> None:
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        for a in range(3):
            b, c = (a + 1) % 3, (a + 2) % 3
            out[i, a] = A[j, b] * A[k, c] - A[j, c] * A[k, b]
