"""Multipliers that exert no force together: what redundant constraints leave open.

Idle are the vectors with ``Bᵀ x = 0``, eigenvectors of ``G = B Bᵀ`` for the eigenvalue zero. They
are never computed: of any ``x`` the powers of ``δ (G + δ)⁻¹`` leave their part and no other, for
one sparse factorisation and some solutions, which is linear in the scene.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg

from fem_lie._arrays import Array

IDLE = 1e-10
"""Squared size of what multipliers of unit size move together, below which they move nothing."""

_POWER = 2  # of the filter: what moves 10⁻³ together keeps all but 10⁻⁸
_PASSES = 2  # round-off over IDLE is what the first leaves


def symmetric_factors(positive: sp.csc_matrix) -> scipy.sparse.linalg.SuperLU:
    """Of a positive definite matrix, whose diagonal are the pivots whatever they are."""
    return scipy.sparse.linalg.splu(
        positive,
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )


class IdleMultipliers:
    """Takes the idle part out of multipliers."""

    def __init__(self, scaled: sp.csr_matrix, measure: Array) -> None:
        """Factorise.

        Args:
            scaled: Jacobian of all constraints over ``measure``, in unknowns of one dimension;
                shape (m, n).
            measure: What counts of each multiplier is its value times this, shape (m,): the part
                that is taken out is at right angles to the rest in that.
        """
        self._measure = measure
        gram = scaled @ scaled.T
        self._bound = IDLE * max(float(gram.diagonal().max(initial=0.0)), np.finfo(float).tiny)
        shifted = (gram + self._bound * sp.identity(len(measure))).tocsc()
        self._factors = symmetric_factors(shifted)

    @classmethod
    def of(cls, B: sp.csr_matrix, length: float, measure: Array) -> IdleMultipliers:
        """From the Jacobian in the twists of nodes, (m, 6 n), of a model of this ``length``."""
        columns = np.tile([1.0, 1, 1] + [1.0 / length] * 3, B.shape[1] // 6)
        return cls(sp.diags(1.0 / measure) @ B @ sp.diags(columns), measure)

    def remove(self, multipliers: Array) -> Array:
        """The smallest multipliers that exert the same forces, shape (m,)."""
        x = multipliers * self._measure
        for _ in range(_PASSES):
            x = x - self._filter(x)
        return np.asarray(x / self._measure)

    def part(self, values: Array) -> Array:
        """What of the ``values`` of constraints no motion can change, shape (m,)."""
        return np.asarray(self._filter(values / self._measure) * self._measure)

    def _filter(self, x: Array) -> Array:
        for _ in range(_POWER):
            x = self._bound * self._factors.solve(x)
        return x
