"""Geometric stiffness: the derivative of the tangent stiffness in the load factor.

With the stress, the Lagrange multipliers and the loads of linear theory at the load factor λ, in
the unloaded configuration, the tangent stiffness is ``K(λ) = K₀ + λ K_g``. The difference of two of
them loses the digits by which ``λ K_g`` is smaller than ``K₀``. The load factor ``s`` of the
difference therefore makes both about equally large, whatever the size of the loads.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp

from fem_lie._arrays import Array
from fem_lie.solve.stability.equilibrium import StableEquilibrium

_ALIKE = 3.0  # powers of two by which the change and the stiffness may differ
_ROUND_OFF = 2.0**-40  # of the stiffness: a smaller change is none
_SCALINGS, _SHRINKINGS = 5, 10
_PROPORTIONAL = 1e-9  # relative deviation of a change from a straight line
_CONVERGED = 1e-5


class GeometricStiffness(NamedTuple):
    """``s K_g`` of the free unknowns in their units.

    Attributes:
        symmetric: Symmetric part, shape (n, n).
        skew: The other part, of loads without a potential, shape (n, n).
        factor: ``s``, a power of two.
    """

    symmetric: sp.csr_matrix
    skew: sp.csr_matrix
    factor: float

    @classmethod
    def of(cls, G: sp.csr_matrix, factor: float) -> GeometricStiffness:
        """Split the matrix ``s K_g``."""
        return cls((0.5 * (G + G.T)).tocsr(), (0.5 * (G - G.T)).tocsr(), factor)


def geometric_stiffness(
    model: StableEquilibrium, K: sp.csr_matrix, dx: Array
) -> GeometricStiffness:
    """That of the loads of a scene.

    Args:
        model: The scene in its unloaded configuration.
        K: Its tangent stiffness there, shape (n, n).
        dx: Displacements and multipliers of linear theory at load factor 1.

    Raises:
        ValueError: The tangent stiffness has no derivative in the load factor.
    """
    state = model.linear_state(dx)

    def change(factor: float) -> sp.csr_matrix:
        return (model.stressed(state, factor) - K).tocsr()

    factor, D = _alike(change, abs(K).max(), model.largest(dx))
    if not D.count_nonzero():
        return GeometricStiffness.of(D, factor)
    E = change(-0.5 * factor)
    if abs(D + 2.0 * E).max() <= _PROPORTIONAL * abs(D).max():
        return GeometricStiffness.of(D, factor)
    return _extrapolated(change, D, E, factor)


def _alike(
    change: Callable[[float], sp.csr_matrix], stiffness: float, displacement: float
) -> tuple[float, sp.csr_matrix]:
    """A load factor at which the change is about as large as the stiffness, and the change.

    The change is zero if there is none at any load factor.

    The first one makes the displacements of linear theory as large as the model, or its rotations
    about one radian; where nothing moves, any will do.
    """
    factor = 2.0 ** -np.round(np.log2(displacement)) if displacement else 1.0
    D = change(factor)
    for _ in range(_SCALINGS):
        power = np.log2(max(abs(D).max() / stiffness, _ROUND_OFF))
        if abs(power) <= _ALIKE:
            return float(factor), D
        factor *= 2.0 ** -np.round(power)
        D = change(factor)
    return float(factor), sp.csr_matrix(D.shape)


def _extrapolated(
    change: Callable[[float], sp.csr_matrix], D: sp.csr_matrix, E: sp.csr_matrix, factor: float
) -> GeometricStiffness:
    """From changes at ``s`` and ``−s/2`` for smaller and smaller s, with an error of third order.

    Elements of the user's may have unknowns of their own on which the tangent stiffness depends in
    any way.
    """
    first, least, best = factor, np.inf, D
    before = sp.csr_matrix(D.shape)
    for _ in range(_SHRINKINGS):
        found = ((first / factor) * (D - 4.0 * E) / 3.0).tocsr()
        error = abs(found - before).max() / abs(found).max()
        if error > least and least <= _CONVERGED:
            break  # round-off begins to grow
        if error < least:
            least, best = error, found
        before, factor = found, factor / 16.0
        D, E = change(factor), change(-0.5 * factor)
    if least <= _CONVERGED:
        return GeometricStiffness.of(best, first)
    raise ValueError(
        "the tangent stiffness has no derivative in the load factor, which linear buckling expects "
        "of every element: follow the path by fl.follow_path"
    )
