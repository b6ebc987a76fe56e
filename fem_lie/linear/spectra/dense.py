"""All eigenvalues of a small problem, from its scaled, shifted and inverted companion matrix."""

from __future__ import annotations

import numpy as np
import scipy.linalg
import scipy.sparse as sp

from fem_lie._arrays import Array
from fem_lie.linear.direct import ConvergenceError
from fem_lie.linear.spectra.krylov import Approximation
from fem_lie.linear.spectra.pencil import SHIFT, Pencil
from fem_lie.linear.spectra.slepc import Complex

MOST = 600  # unknowns, less those that constraints eliminate: some seconds
_INFINITE = 1e-14  # of the largest inverse: eigenvalues of unknowns without mass


def dense(pencil: Pencil, count: int, floor: float) -> Approximation:
    """The smallest eigenvalues without iterations that could miss some of them.

    Raises:
        ConvergenceError: The problem is too large, or singular at the shift.
    """
    n, m = pencil.M.shape[0], pencil.B.shape[0]
    if n - m > MOST:
        raise ConvergenceError(f"{n - m} unknowns are too many for a dense eigenvalue problem")
    basis = _admissible(pencil.B)
    rate = max(np.sqrt(SHIFT) * pencil.fastest, floor) or 1.0
    K = np.asarray(basis @ pencil.terms(basis.astype(np.complex128))[2].T.real, dtype=np.float64)
    M = basis @ (pencil.M @ basis.T)
    C = np.zeros_like(M) if pencil.C is None else basis @ (pencil.C @ basis.T)
    P = K + rate * C + rate**2 * M
    scale = 1.0 / np.sqrt(np.abs(np.diag(P)).clip(1e-300))
    try:
        inverse = np.linalg.inv(scale[:, np.newaxis] * P * scale)
    except np.linalg.LinAlgError as error:
        raise ConvergenceError("the dense eigenvalue problem is singular at its shift") from error
    inverse = scale[:, np.newaxis] * inverse * scale
    if pencil.C is not None:
        s, reduced = _quadratic(M, C + 2.0 * rate * M, inverse, rate)
    elif pencil.symmetric:
        s, reduced = _symmetric(K, M)
    else:
        s, reduced = _linear(M, inverse, rate)
    order = np.argsort(np.abs(s), kind="stable")[: 2 * count + n // 4]

    def solve(residuals: Complex) -> Complex:
        return np.asarray(residuals @ basis.T @ inverse.T @ basis)

    return Approximation(s[order], reduced[order] @ basis, solve)


def _admissible(B: sp.csr_matrix) -> Array:
    """Orthonormal rows (r, n) that satisfy the constraints."""
    if not B.shape[0]:
        return np.eye(B.shape[1])
    size = np.sqrt(np.asarray(B.multiply(B).sum(axis=1)).ravel())
    return np.asarray(scipy.linalg.null_space((sp.diags(1.0 / size) @ B).toarray()).T)


def _symmetric(K: Array, M: Array) -> tuple[Complex, Complex]:
    """Roots with ``Im s ≥ 0`` of ``(s² M + K) x = 0``, and ``x`` as rows."""
    try:
        squares, x = scipy.linalg.eigh(0.5 * (K + K.T), M)
    except np.linalg.LinAlgError as error:
        raise ConvergenceError("the mass matrix is not positive definite") from error
    return np.sqrt((-squares).astype(np.complex128)), x.T.astype(np.complex128)


def _linear(M: Array, inverse: Array, rate: float) -> tuple[Complex, Complex]:
    """The same, with the inverse of ``K + rate² M``, where ``K`` is not symmetric."""
    θ, x = np.linalg.eig(inverse @ M)
    finite = np.abs(θ) > _INFINITE * np.abs(θ).max()
    s = np.sqrt(rate**2 - 1.0 / θ[finite].astype(np.complex128))
    return np.where(s.imag < 0, -s, s), x.T[finite].astype(np.complex128)


def _quadratic(M: Array, C: Array, inverse: Array, rate: float) -> tuple[Complex, Complex]:
    """All roots of ``(t² M + t C + P) x = 0``, ``s = rate + t``, with the inverse of ``P``.

    ``μ = unit/t`` are eigenvalues of a companion matrix whose blocks are about one.
    """
    n = len(M)
    inertia, damping = inverse @ M, inverse @ C
    unit = 1.0 / np.sqrt(np.linalg.norm(inertia, 2))
    lower = np.hstack([-(unit**2) * inertia, -unit * damping])
    μ, x = np.linalg.eig(np.vstack([np.hstack([np.zeros((n, n)), np.eye(n)]), lower]))
    finite = np.abs(μ) > _INFINITE * np.abs(μ).max()
    s = rate + unit / μ[finite].astype(np.complex128)
    return s, x[:n].T[finite].astype(np.complex128)
