"""The constrained quadratic eigenvalue problem of small vibrations, as SLEPc takes it.

``(s² M + s C + K) φ + Bᵀ μ = 0``, ``B φ = 0``.

Products whose sums are carried in extended precision, where the machine has one.

Stiff elements cancel in ``K φ`` of slow motions: of sums in double precision, round-off is left.

Stiffness of motions in which elements hardly strain, without the round-off of those that do.

Elements do not feel rigid motion: ``K_e R = 0`` for the twists ``R`` that move all nodes of a
connected piece together, whatever its stress, since forces in local frames are invariant. Nodes
store such a motion with round-off, of which the elements make far more than a soft spring has. So
``φ = R y + ψ`` is split first, and with ``K_s`` what is not of elements::

    φᵀ K φ' = φᵀ K_s φ' + ψᵀ K_e ψ' + (R y)ᵀ P ψ'

The last is of stress alone: the internal forces ``f`` of a piece have no resultant in any state,
``Rᵀ f = 0``, so that ``(R y)ᵀ K_e ψ = −(δR y)ᵀ f``, with ``δR = −ad(ψ) R``.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeVar

from petsc4py import PETSc

import numpy as np
import numpy.typing as npt
import scipy.linalg
import scipy.sparse as sp
from slepc4py import SLEPc

from fem_lie._arrays import Array, Indices
from fem_lie._compat import slepc_errors
from fem_lie.linear.direct import ConvergenceError
from fem_lie.linear.packages import lacks_memory

Complex = npt.NDArray[np.complex128]

_TOLERANCE = 1e-9


def padded(A: sp.csr_matrix, B: sp.csr_matrix) -> sp.csr_matrix:
    """Zero rows and columns for the multipliers."""
    return sp.block_diag([A, sp.csr_matrix((B.shape[0],) * 2)], format="csr")


def to_petsc(A: sp.csr_matrix) -> PETSc.Mat:
    """The same matrix for PETSc, with all of its diagonal."""
    # a direct solver wants a diagonal, even if it is zero
    A = (A + sp.diags(np.full(A.shape[0], 0.0), format="csr")).tocsr()
    A.sort_indices()
    pointers = (A.indptr.astype(PETSc.IntType), A.indices.astype(PETSc.IntType), A.data)
    return PETSc.Mat().createAIJ(A.shape, csr=pointers, comm=PETSc.COMM_SELF)


def set_up(solver: Any, wanted: int, kind: Any, prefix: str) -> None:
    """Solve for ``wanted`` pairs nearest to a target, factorised.

    Raises:
        ConvergenceError: SLEPc fails.
        MemoryError: There is not enough memory for the factors.
    """
    solver.setOptionsPrefix(prefix)
    solver.setWhichEigenpairs(kind.Which.TARGET_MAGNITUDE)
    solver.setDimensions(wanted)
    solver.setTolerances(_TOLERANCE, 200)
    transform = solver.getST()
    transform.setType(SLEPc.ST.Type.SINVERT)
    if kind is SLEPc.PEP:
        transform.setTransform(True)
    solve_factorised(solver, prefix)


def solve_factorised(solver: Any, prefix: str) -> None:
    """Solve by a direct factorisation, with the user's options.

    Raises:
        ConvergenceError: SLEPc fails.
    """
    linear = solver.getST().getKSP()
    linear.setType(PETSc.KSP.Type.PREONLY)
    linear.getPC().setType(PETSc.PC.Type.LU)
    linear.getPC().setFactorSolverType("mumps")
    solver.setFromOptions()
    try:
        with slepc_errors():
            solver.solve()
    except PETSc.Error as error:
        if lacks_memory(linear.getPC(), error):
            size = linear.getOperators()[0].size[0]
            raise MemoryError(
                f"not enough memory to factorise the matrix of {size} unknowns"
            ) from error
        raise ConvergenceError(
            f"SLEPc failed (PETSc error {error.ierr}): the matrix may be singular; see its "
            f"options under the prefix {prefix!r}"
        ) from error


def pairs_of(solver: Any, K: sp.csr_matrix, n: int) -> tuple[Complex, Complex]:
    """All converged eigenvalues and vectors, without multipliers."""
    found = solver.getConverged()
    real, imaginary = (PETSc.Vec().createSeq(K.shape[0]) for _ in range(2))
    values, vectors = np.empty(found, dtype=np.complex128), np.empty((found, n), np.complex128)
    for k in range(found):
        values[k] = solver.getEigenpair(k, real, imaginary)
        vectors[k] = real.array[:n] + 1j * imaginary.array[:n]
    return values, vectors


Extended = npt.NDArray[np.longdouble]


def product(A: sp.csr_matrix, vectors: Array | Extended) -> Extended:
    """``A φ`` of real rows ``φ``, shape (k, n)."""
    wide = vectors.T.astype(np.longdouble)
    return np.asarray((A.astype(np.longdouble) @ wide).T, dtype=np.longdouble)


Real = TypeVar("Real", np.float64, np.longdouble)

_KNOWN = 1e-7  # part of its size to which an eigenvector is known
_ULPS = 1e-14
_VANISHES = 1e-2  # of the largest stiffness, to a last bit
_MOST = 1200  # rigid motions of all pieces, of which those that joints allow are looked for
FREE = 1e-9  # rigid motions of a piece of size one that move what is held by less


def kernel(A: Array) -> Array:
    """Orthonormal basis (z, k) of what a matrix (m, z) of one dimension takes to zero.

    Of a tall one the triangle has it: the SVD of all of it would have m² numbers.
    """
    if not A.size:
        return np.eye(A.shape[1])
    return np.asarray(scipy.linalg.null_space(np.linalg.qr(A, mode="r"), rcond=FREE))


class RigidParts:
    """Splits vectors of free unknowns.

    Attributes:
        rest: Stiffness without elements, shape (n, n); likewise ``elements`` and ``stress``, ``P``.
    """

    def __init__(
        self,
        rest: sp.csr_matrix,
        elements: sp.csr_matrix,
        stress: sp.csr_matrix,
        motions: list[tuple[Indices, Array]],
    ) -> None:
        """Keep the matrices.

        Args:
            rest: See above.
            elements: See above.
            stress: See above.
            motions: Of each piece its unknowns, shape (k,), and an orthonormal basis of its rigid
                motions that what is held allows, shape (k, ≤ 6).
        """
        self.rest, self.elements, self.stress = rest, elements, stress
        self._motions = motions

    def mechanisms(self, B: sp.csr_matrix) -> Array:
        """Basis (z, n) of motions without strain of elements that the constraints ``B`` allow."""
        n, columns = B.shape[1], [basis.shape[1] for _, basis in self._motions]
        if sum(columns) > _MOST:
            return np.empty((0, n))
        R = np.zeros((n, sum(columns)))
        for (unknowns, basis), last in zip(self._motions, np.cumsum(columns), strict=True):
            R[unknowns, last - basis.shape[1] : last] = basis
        size = np.sqrt(np.asarray(B.multiply(B).sum(axis=1)).ravel())
        allowed = (sp.diags(1.0 / np.where(size > 0.0, size, 1.0)) @ B) @ R
        return np.asarray((R @ kernel(allowed)).T)

    def strained(self, vectors: npt.NDArray[Real]) -> npt.NDArray[Real]:
        """``ψ`` of each row."""
        out = vectors.copy()
        for unknowns, basis in self._motions:
            part = out[:, unknowns]
            # once more: what the first leaves is round-off of all of it
            for _ in range(2):
                part = part - (part @ basis) @ basis.T
            out[:, unknowns] = part
        return out

    def product(self, vectors: Array) -> Extended:
        """``K φ`` of rows, shape (k, n), in extended precision."""
        strained = self.strained(vectors)
        elastic, stressed = product(self.elements, strained), product(self.stress, strained)
        resultant = stressed - self.strained(stressed)
        return product(self.rest, vectors) + self.strained(elastic) + resultant

    def product_with_pressure(self, vectors: Array) -> Extended:
        """The same where forces of elements have a resultant, as those of pressure do."""
        return product(self.rest, vectors) + product(self.elements, self.strained(vectors))

    def round_off(self, vectors: Array) -> Array:
        """What of ``φᵀ K φ`` of each row can be round-off.

        Strains below those of a vector that is known to a part of its size are all round-off.
        """
        strained = self.strained(vectors)
        size, small = np.abs(vectors), np.abs(strained)
        cancels = (size * (abs(self.rest) @ size.T).T).sum(axis=1)
        cancels += (size * (abs(self.stress) @ small.T).T).sum(axis=1)
        # forces that vanish, such as those of springs at rest, are round-off of stiffness
        cancels += _VANISHES * abs(self.rest).max() * (size * size).sum(axis=1)
        strains = (small * (abs(self.elements) @ small.T).T).sum(axis=1)
        rigid = np.linalg.norm(strained, axis=1) <= _KNOWN * np.linalg.norm(vectors, axis=1)
        return np.asarray(_ULPS * cancels + np.where(rigid, strains, _ULPS * strains))


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
