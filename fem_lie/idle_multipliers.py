"""Multipliers that exert no force together: what redundant constraints leave open.

Idle are the vectors with ``Bᵀ x = 0``, eigenvectors of ``G = B Bᵀ`` for the eigenvalue zero. They
are never computed: of any ``x`` the powers of ``δ (G + δ)⁻¹`` leave their part and no other, for
one sparse factorisation and some solutions, which is linear in the scene.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg

from fem_lie._jit import Array

IDLE = 1e-10
"""Squared size of what multipliers of unit size move together, below which they move nothing."""

_POWER = 2  # of the filter: what moves 10⁻³ together keeps all but 10⁻⁸
_PASSES = 2  # round-off over IDLE is what the first leaves


class IdleMultipliers:
    """Takes the idle part out of multipliers."""

    def __init__(self, B: sp.csr_matrix, length: float, measure: Array) -> None:
        """Factorise.

        Args:
            B: Jacobian of all constraints in the twists of nodes, shape (m, 6 n).
            length: Of the model: what a rotation counts.
            measure: What counts of each multiplier is its value times this, shape (m,): the part
                that is taken out is at right angles to the rest in that.
        """
        self._measure = measure
        columns = np.tile([1.0, 1, 1] + [1.0 / length] * 3, B.shape[1] // 6)
        scaled = sp.diags(1.0 / measure) @ B @ sp.diags(columns)
        gram = scaled @ scaled.T
        self._bound = IDLE * max(float(gram.diagonal().max(initial=0.0)), np.finfo(float).tiny)
        shifted = (gram + self._bound * sp.identity(B.shape[0])).tocsc()
        options = {"SymmetricMode": True}
        self._factors = scipy.sparse.linalg.splu(
            shifted, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options
        )

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
