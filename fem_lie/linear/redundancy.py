"""Joints whose constraints follow from those of others, and what these leave open.

Idle are multipliers that exert no force together, the vectors with ``Bᵀ x = 0``, eigenvectors of
``G = B Bᵀ`` for the eigenvalue zero. They are never computed: of any ``x`` the powers of
``δ (G + δ)⁻¹`` leave their part and no other, for one sparse factorisation and some solutions,
which is linear in the scene.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg

from fem_lie._arrays import Array, Indices

_NOTHING = 1e-10  # of a row whose entries would be of order 1
_DEPENDENT = 1e-10  # squared distance of a unit row from the span of others
_SHIFT = 1e-14
"""Added to the squared length of each unit row: what depends on others leaves this much of itself,
times one and the squares of its coefficients, and not round-off that is divided by round-off."""

IDLE = 1e-10
"""Squared size of what multipliers of unit size move together, below which they move nothing."""

_POWER = 2  # of the filter: what moves 10⁻³ together keeps all but 10⁻⁸
_PASSES = 2  # round-off over IDLE is what the first leaves


def redundant_constraints(B: sp.csr_matrix, units: Array, measure: Array) -> Indices:
    """Those that follow from the others.

    Args:
        B: Jacobian of all in the twists of the moving nodes, shape (m, 6 n).
        units: Unit of each unknown over the length of the model, shape (6 n,).
        measure: What counts of the multiplier of each is its value times this, shape (m,).
    """
    if B.shape[0] == 0:
        return np.empty(0, dtype=np.int64)
    B = sp.diags(1.0 / measure) @ B @ sp.diags(units)
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
    def of(cls, B: sp.csr_matrix, units: Array, measure: Array) -> IdleMultipliers:
        """From the Jacobian (m, 6 n); ``units`` are as of :func:`redundant_constraints`."""
        return cls(sp.diags(1.0 / measure) @ B @ sp.diags(units), measure)

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
