"""Eigenvalues nearest to a shift, by SLEPc.

With the constraint block ``B`` the problem has infinite eigenvalues; shift-and-invert maps them to
zero, where Krylov methods do not see them. (V. Hernandez, J. E. Roman & V. Vidal, ACM Trans. Math.
Softw. 31 (2005) 351; C. Campos & J. E. Roman, SIAM J. Sci. Comput. 38 (2016) S385.)
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from slepc4py import SLEPc

from fem_lie.linear.spectra.free_unknowns import FreeUnknowns, OnRanks
from fem_lie.linear.spectra.pencil import (
    SHIFT,
    Complex,
    ComplexExtended,
    Pencil,
    padded,
    pairs_of,
    set_up,
)

_TARGET = 0.1  # shift over the unit of s
_FAR = 10.0  # largest eigenvalue over the unit of s
_SPARE = 8  # additional pairs: the nearest to the shift are not quite the smallest


@dataclass(frozen=True, eq=False)
class Approximation:
    """Computed eigenpairs before their check.

    Attributes:
        s: Eigenvalues, both of a conjugate pair for quadratic problems, shape (k,).
        vectors: Eigenvectors as rows, shape (k, n).
        solve: Function for ``e`` with ``P e + Bᵀ μ = r``, ``B e = 0`` of rows ``r``, shape (k, n);
            ``P`` is the quadratic at the shift, and ``r`` are partial forces.
    """

    s: Complex
    vectors: Complex
    solve: Callable[[ComplexExtended], Complex]


@dataclass(frozen=True)
class Krylov:
    """Krylov–Schur, or TOAR if there is damping or gyroscopic coupling.

    Attributes:
        prefix: Prefix of SLEPc's options.
        nearer: Shift over the usual one.
        spare: Number of additional pairs.
    """

    prefix: str
    nearer: float = 1.0
    spare: int = _SPARE

    def __call__(self, pencil: Pencil, count: int, floor: float) -> Approximation:
        """Compute eigenpairs, see :func:`~fem_lie.linear.spectra.smallest.smallest`."""
        if pencil.C is None:
            shift = SHIFT * pencil.fastest**2 * self.nearer**2 or 1.0
            found = self._linear(pencil, count, shift)
            largest = np.sort(np.abs(found.s) ** 2)[:count].max(initial=0.0)
            if 0.0 < largest < shift:
                # with a distant shift multiple eigenvalues are hard to separate
                found = self._linear(pencil, count, 0.1 * largest)
            return found
        rate = max(np.sqrt(SHIFT) * pencil.fastest, floor) or 1.0
        found = self._quadratic(pencil, count, rate)
        largest = np.sort(np.abs(found.s))[: 2 * count].max(initial=0.0)
        if largest > _FAR * rate:
            # with a distant shift they are not accurate
            found = self._quadratic(pencil, count, largest)
        return found

    def _linear(self, pencil: Pencil, count: int, shift: float) -> Approximation:
        """Eigenvalues ``−s²`` of ``K φ + Bᵀ μ = −s² M φ``."""
        K = pencil.on_ranks(_saddle_point(pencil, pencil.K, shift))
        M = pencil.on_ranks(padded(pencil.M, pencil.B))
        solver = SLEPc.EPS().create(K.matrix.comm)
        solver.setOperators(K.matrix, M.matrix)
        types = SLEPc.EPS.ProblemType
        solver.setProblemType(types.GHEP if pencil.symmetric else types.GNHEP)
        solver.setTarget(-shift)
        wanted, unknowns = min(count + self.spare, K.size), pencil.unknowns
        set_up(solver, wanted, SLEPc.EPS, self.prefix, unknowns)
        squares, vectors = pairs_of(solver, K, unknowns)
        s = np.sqrt((-squares).astype(np.complex128))
        solve = _Factors(solver, K, unknowns, 1.0)
        return Approximation(np.where(s.imag < 0, -s, s), vectors, solve)

    def _quadratic(self, pencil: Pencil, count: int, rate: float) -> Approximation:
        """Eigenvalues ``s``, scaled by a rate so that the required ones are about one."""
        assert pencil.C is not None
        # about one as well: very small eigenvalues have been found
        stiffest = pencil.unknowns.largest(float(pencil.diagonals[1].max(initial=0.0)))
        size = stiffest + rate**2 * pencil.mass_unit
        unit = 2.0 ** -np.round(np.log2(size))
        scaled = (
            unit * _saddle_point(pencil, pencil.K, rate**2),
            padded(unit * rate * pencil.C, pencil.B),
            padded(unit * rate**2 * pencil.M, pencil.B),
        )
        matrices = [pencil.on_ranks(part) for part in scaled]
        K = matrices[0]
        solver = SLEPc.PEP().create(K.matrix.comm)
        solver.setOperators([each.matrix for each in matrices])
        solver.setTarget(_TARGET * self.nearer)
        wanted, unknowns = min(2 * count + self.spare, K.size), pencil.unknowns
        set_up(solver, wanted, SLEPc.PEP, self.prefix, unknowns)
        s, vectors = pairs_of(solver, K, unknowns)
        return Approximation(rate * s, vectors, _Factors(solver, K, unknowns, unit))


def _saddle_point(pencil: Pencil, K: sp.csr_matrix, shift: float) -> sp.csr_matrix:
    """``[[K, Bᵀ], [B, 0]]`` with constraints scaled as the stiffness."""
    B, (mass, stiffness) = pencil.B, pencil.diagonals
    size = pencil.unknowns.mean(stiffness + shift * mass)
    if not B.shape[0]:
        return K
    # for any unit of each
    rows = np.sqrt(np.asarray(B.multiply(B).sum(axis=1)).ravel())
    B = sp.diags(size / rows) @ B
    return sp.bmat([[K, B.T], [B, None]], format="csr")


@dataclass(frozen=True, eq=False)
class _Factors:
    """Factorisation with which a solver of SLEPc inverts the problem at its shift.

    Attributes:
        solver: Solver that owns the factorisation.
        matrix: The problem at its shift.
        unknowns: Its unknowns.
        unit: Factor of the problem.
    """

    solver: Any
    matrix: OnRanks
    unknowns: FreeUnknowns
    unit: float

    def __call__(self, residuals: ComplexExtended) -> Complex:
        """Solve, see ``Approximation.solve``."""
        linear = self.solver.getST().getKSP()
        forces = (self.unit * self.unknowns.assembled(residuals)).astype(np.complex128)
        found = np.zeros_like(forces)
        for factor, parts in ((1.0, forces.real), (1.0j, forces.imag)):
            for k in range(len(found)):
                found[k] += factor * self.matrix.solve(linear, parts[k])
        return found
