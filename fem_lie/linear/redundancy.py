"""Joints whose constraints follow from those of others."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from fem_lie._arrays import Array, Indices
from fem_lie.linear.idle_multipliers import symmetric_factors

_NOTHING = 1e-10  # of a row whose entries would be of order 1
_DEPENDENT = 1e-10  # squared distance of a unit row from the span of others
_SHIFT = 1e-14
"""Added to the squared length of each unit row: what depends on others leaves this much of itself,
times one and the squares of its coefficients, and not round-off that is divided by round-off."""


def redundant_constraints(B: sp.csr_matrix, length: float, measure: Array) -> Indices:
    """Those that follow from the others.

    Args:
        B: Jacobian of all in the twists of the moving nodes, shape (m, 6 n).
        length: Of the model: what a rotation counts.
        measure: What counts of the multiplier of each is its value times this, shape (m,).
    """
    if B.shape[0] == 0:
        return np.empty(0, dtype=np.int64)
    B = (
        sp.diags(1.0 / measure)
        @ B
        @ sp.diags(np.tile([1.0, 1, 1] + [1.0 / length] * 3, B.shape[1] // 6))
    )
    norms = np.sqrt(np.asarray(B.multiply(B).sum(axis=1)).ravel())
    # within one rigid body both sides cancel up to round-off
    norms[norms < _NOTHING] = 0.0
    empty, full = np.flatnonzero(norms == 0.0), np.flatnonzero(norms)
    dependent = full[_squared_distances(sp.diags(1.0 / norms[full]) @ B[full]) <= _DEPENDENT]
    return np.asarray(np.union1d(dependent, empty), dtype=np.int64)


def _squared_distances(unit: sp.csr_matrix) -> Array:
    """Of each unit row from the span of those that a sparse elimination takes before, (m,).

    They are the pivots of the Gram matrix, in an order that keeps its factors sparse.
    """
    if unit.shape[0] == 0:
        return np.empty(0)
    gram = (unit @ unit.T + _SHIFT * sp.identity(unit.shape[0])).tocsc()
    factors = symmetric_factors(gram)
    return np.asarray(factors.U.diagonal()[factors.perm_c])
