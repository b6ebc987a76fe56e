"""Whether loads have a potential among the motions that supports and joints leave free.

Linear buckling compares energies: its load factors are those of the symmetric part ``G`` of the
geometric stiffness. Loads without a potential, such as forces that follow or moments about fixed
axes, add a skew part ``S``, and then a mode φ of ``(K + λ G) φ = 0`` is none of the structure. What
counts is how the loads act: a force that follows a guided end, end moments on forks and pressure on
a ring in its plane do have a potential among the motions that are free.

Where ``S φ = 0`` the load factor is right, and none is lower: real eigenvalues of ``−K⁻¹ (G + S)``
are not above the largest of ``−K⁻¹ G`` (I. Bendixson, Acta Mathematica 25 (1902) 359). Flutter at a
lower load takes an ``S`` that is not small beside ``G``.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from fem_lie._arrays import Array
from fem_lie.solve.stability.equilibrium import StableEquilibrium
from fem_lie.solve.stability.linear_buckling.geometric import GeometricStiffness

_OF_MODES, _OF_ALL = 1e-6, 1e-2  # skew part over load stiffness that counts
_TINY = 1e-300
_SEED, _REPEATS, _SETTLED = 1, 12, 1e-3


def check_potential(
    model: StableEquilibrium, K: sp.csr_matrix, G: GeometricStiffness, found: tuple[Array, Array]
) -> None:
    """Raise ``ValueError`` if the skew part of the geometric stiffness counts.

    Args:
        model: The scene, whose tangent stiffness in the unloaded configuration is factorised.
        K: That one of the free unknowns in their units, shape (n, n).
        G: The geometric stiffness.
        found: Load factors of its symmetric part, shape (k,), the lowest first, and their modes,
            shape (k, n).
    """
    factors, modes = found
    parts = [factors[k] * _response(model, K, G.skew, modes[k])[0] for k in range(len(factors))]
    least = factors[0] if len(factors) else 1.0 / max(energy_radius(model, K, G.symmetric), _TINY)
    of_all = float(least * energy_radius(model, K, G.skew))
    if of_all > _OF_ALL or max(parts, default=0.0) > _OF_MODES:
        raise ValueError(
            "linear buckling expects loads that have a potential among the free motions, got an "
            f"unsymmetric load stiffness, {max(of_all, *parts):.1e} of the symmetric one (forces "
            "that follow, or moments about fixed axes): its load factors would be wrong. Follow "
            "the path by fl.follow_path, which finds divergence by the determinant, and look for "
            "flutter by fl.vibrations(scene, at=fl.statics(scene)) at increasing loads"
        )


def _response(
    model: StableEquilibrium, K: sp.csr_matrix, A: sp.csr_matrix, x: Array
) -> tuple[float, Array]:
    """``‖y‖`` for x of length one, with ``y = K⁻¹ A x`` and ``‖y‖² = yᵀ K y``; and y."""
    y = model.solve_free(A @ x)
    squares = [max(float(z @ (K @ z)), 0.0) for z in (x, y)]
    return float(np.sqrt(squares[1] / squares[0])) if squares[0] else 0.0, y


def energy_radius(model: StableEquilibrium, K: sp.csr_matrix, A: sp.csr_matrix) -> float:
    """Largest ``|xᵀ A y|`` of free motions with ``xᵀ K x = yᵀ K y = 1``, ``A`` symmetric or skew.

    ``K⁻¹ A`` is normal in the product of ``K``, so that repeated products with it grow by that, the
    modulus of its largest eigenvalues: of a symmetric ``A`` one over the load factor that is least,
    of either sign.
    """
    if not A.count_nonzero():
        return 0.0
    # smooth, and allowed by constraints: what is sought is no motion of single nodes
    x = model.solve_free(np.random.default_rng(_SEED).standard_normal(K.shape[0]))
    value = 0.0
    for _ in range(_REPEATS):
        before, (value, x) = value, _response(model, K, A, x)
        if abs(value - before) <= _SETTLED * value:
            break
    return value
