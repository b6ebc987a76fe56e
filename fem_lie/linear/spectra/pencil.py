"""The constrained quadratic eigenvalue problem of small vibrations.

``(s² M + s C + K) φ + Bᵀ μ = 0``, ``B φ = 0``.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp

from fem_lie._arrays import Array
from fem_lie.linear.spectra.extended import Extended, product
from fem_lie.linear.spectra.rigid_parts import RigidParts
from fem_lie.linear.spectra.slepc import Complex

SHIFT = 1e-10  # over the largest ratio of stiffness to mass: rigid motion must not make it singular
_ROUND_OFF = 1e-12  # of the largest ratio of stiffness to mass, and of the terms that cancel
_SYMMETRIC = 1e-9


@dataclass(frozen=True, eq=False)
class Pencil:
    """Matrices of the free unknowns, all in the unit of energy (times powers of time).

    Attributes:
        M: Mass, shape (n, n).
        C: Damping and gyroscopic coupling, or ``None``.
        K: Stiffness.
        B: Constraints, shape (m, n).
        parts: Stiffness split into that of elements, which rigid motion does not strain, and the
            rest; ``None`` if it is not known.
    """

    M: sp.csr_matrix
    C: sp.csr_matrix | None
    K: sp.csr_matrix
    B: sp.csr_matrix
    parts: RigidParts | None = None

    @cached_property
    def fastest(self) -> float:
        """Square root of the largest ratio of stiffness to mass of one unknown, a rate."""
        mass, stiffness = self.M.diagonal(), np.abs(self.K.diagonal())
        ratio = stiffness[mass > 0] / mass[mass > 0]
        return float(np.sqrt(ratio.max(initial=0.0)))

    @cached_property
    def symmetric(self) -> bool:
        """Whether the stiffness is symmetric."""
        asymmetry = abs(self.K - self.K.T).max()
        return bool(asymmetry <= _SYMMETRIC * abs(self.K).max())

    def kinetic(self, vectors: Complex) -> Array:
        """``φᴴ M φ`` of each row."""
        return np.asarray((vectors.conj() * (self.M @ vectors.T).T).sum(axis=1).real)

    def stiffness(self, vectors: Array) -> Extended:
        """``K φ`` of real rows in extended precision, without round-off of rigid motion."""
        if self.parts is None:
            return product(self.K, vectors)
        # pressure is among forces whose stiffness is not symmetric
        split = self.parts.product if self.symmetric else self.parts.product_with_pressure
        return split(vectors)

    @property
    def split_is_exact(self) -> bool:
        """Whether ``parts`` are all of ``K``: nodes without a drilling rotation lack rigid ones."""
        probe = np.random.default_rng(0).normal(size=(1, self.K.shape[0]))
        whole = product(self.K, probe)
        return bool(abs(self.stiffness(probe) - whole).max() <= _SYMMETRIC * abs(whole).max())

    def terms(self, vectors: Complex) -> tuple[Complex, Complex, Complex]:
        """``M φ``, ``C φ`` and ``K φ`` of rows, see :meth:`stiffness`."""
        both = np.concatenate([vectors.real, vectors.imag])
        stiff = self.stiffness(both)
        zero = np.zeros_like(stiff)
        damped = zero if self.C is None else product(self.C, both)
        halves = (np.split(x, 2) for x in (product(self.M, both), damped, stiff))
        M, C, K = (real + 1j * imaginary for real, imaginary in halves)
        return M, C, K

    def round_off(self, vectors: Complex, mass: Array) -> Array:
        """Rates that round-off makes of zero, for vectors (k, n) beside a mass ``φᴴ M φ``, (k,)."""
        if self.parts is None:
            size = np.abs(vectors)
            energy = _ROUND_OFF * (size * (abs(self.K) @ size.T).T).sum(axis=1)
        else:
            energy = self.parts.round_off(vectors.real) + self.parts.round_off(vectors.imag)
        ratio = np.divide(energy, mass, out=np.full(len(mass), np.inf), where=mass > 0)
        return np.asarray(np.sqrt(np.minimum(ratio, _ROUND_OFF * self.fastest**2)))
