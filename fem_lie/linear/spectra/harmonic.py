"""Steady-state harmonic solutions of the constrained equations of small vibrations.

``(−ω² M + i ω C + K) φ + Bᵀ μ = f``, ``B φ = 0``, directly or in a reduced basis.
"""

from __future__ import annotations

import numpy as np
import scipy.linalg
import scipy.sparse as sp
import scipy.sparse.linalg

from fem_lie._arrays import Array
from fem_lie.linear.direct import ConvergenceError
from fem_lie.linear.spectra.pencil import Complex, Pencil

_REFINEMENTS = 3
_SETTLED = 1e-6  # of the solution: the last correction, with residuals in extended precision
_INDEPENDENT = 1e-8  # of the largest basis vector


class Harmonic:
    """Amplitudes of harmonic motion under one load, at any angular frequency."""

    def __init__(self, pencil: Pencil, force: Complex) -> None:
        """Store the equations.

        Args:
            pencil: Matrices of the free unknowns.
            force: Complex amplitudes of the forces on them, shape (n,).
        """
        self._pencil, self._force = pencil, force
        self._scale = float(np.mean(np.abs(pencil.K.diagonal()))) or 1.0

    def direct(self, frequency: float) -> Complex:
        """Amplitudes at an angular frequency by a factorisation, shape (n,).

        Raises:
            ConvergenceError: The matrix is singular.
        """
        n, m = self._pencil.M.shape[0], self._pencil.B.shape[0]
        try:
            factors = scipy.sparse.linalg.splu(self._matrix(frequency).tocsc())
        except RuntimeError:
            raise _unbounded(frequency) from None
        x, change = np.zeros(n + m, dtype=np.complex128), np.inf
        for _ in range(1 + _REFINEMENTS):
            correction = factors.solve(self._residual(frequency, x))
            x = x + correction
            size = np.abs(x[:n]).max()
            change = np.abs(correction[:n]).max() / size if size > 0 else 0.0
            if change <= np.finfo(np.float64).eps:
                break
        if not change <= _SETTLED:
            raise _unbounded(frequency)
        return np.asarray(x[:n])

    def reduced(self, vectors: Complex, frequencies: Array) -> Complex:
        """Amplitudes in the span of modes and of the direct solution at the lowest frequency.

        That solution contains the response of all faster modes, which is nearly static.

        Args:
            vectors: Modes, shape (r, n).
            frequencies: Angular frequencies, shape (k,).

        Returns:
            Shape (k, n).

        Raises:
            ConvergenceError: The matrix is singular at a frequency.
        """
        pencil, first = self._pencil, self.direct(float(frequencies.min()))
        given = np.concatenate([vectors, first[np.newaxis]])
        size = np.sqrt(pencil.kinetic(given)).clip(1e-300)
        both = np.concatenate([part / size[:, np.newaxis] for part in (given.real, given.imag)])
        basis = scipy.linalg.orth(both.T, rcond=_INDEPENDENT).T
        terms = pencil.terms(basis.astype(np.complex128))
        M, C, K = ((basis @ term.real.T).astype(np.float64) for term in terms)
        force = basis @ self._force
        found = np.empty((len(frequencies), len(basis)), dtype=np.complex128)
        for row, frequency in zip(found, frequencies, strict=True):
            try:
                row[:] = np.linalg.solve(K + 1j * frequency * C - frequency**2 * M, force)
            except np.linalg.LinAlgError:
                raise _unbounded(frequency) from None
        return np.asarray(found @ basis)

    def _matrix(self, frequency: float) -> sp.csr_matrix:
        pencil = self._pencil
        A = pencil.K - frequency**2 * pencil.M
        if pencil.C is not None:
            A = A + 1j * frequency * pencil.C
        if not pencil.B.shape[0]:
            return A.astype(np.complex128)
        B = self._scale * pencil.B
        return sp.bmat([[A, B.T], [B, None]], format="csr").astype(np.complex128)

    def _residual(self, frequency: float, x: Complex) -> Complex:
        """Forces that are not balanced, and violated constraints."""
        pencil, scale = self._pencil, self._scale
        φ, μ = np.split(x, [pencil.M.shape[0]])
        M, C, K = (term[0].astype(np.clongdouble) for term in pencil.terms(φ[np.newaxis]))
        ω = np.longdouble(frequency)
        forces = self._force - (K + 1j * ω * C - ω * ω * M) - scale * (pencil.B.T @ μ)
        return np.concatenate([forces, -scale * (pencil.B @ φ)]).astype(np.complex128)


def _unbounded(frequency: float) -> ConvergenceError:
    return ConvergenceError(
        f"the response at the angular frequency {frequency:g} is unbounded: it is a frequency of "
        "the scene without damping, or zero, at which nothing resists a free motion. Expected "
        "damping, other frequencies, or supports"
    )
