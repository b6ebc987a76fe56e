"""Constrained quadratic eigenvalue problem of small vibrations.

``(s² M + s C + K) φ + Bᵀ μ = 0``, ``B φ = 0``.

Sums of products use extended precision where the machine has it: stiff elements cancel in ``K φ``
of slow motions, and sums in double precision leave round-off.

The stiffness of motions with nearly unstrained elements is computed without the round-off of
strained ones. Elements do not resist rigid motion: ``K_e R = 0`` for the twists ``R`` that move all
nodes of a connected group together, for any stress, since forces in local frames are invariant. A
rigid motion of nodes has round-off, from which elements make larger forces than a soft spring. A
vector is therefore split into ``φ = R y + ψ``, and with the stiffness ``K_s`` of everything but
elements::

    φᵀ K φ' = φᵀ K_s φ' + ψᵀ K_e ψ' + (R y)ᵀ P ψ'

The last term depends on stress only: the internal forces ``f`` of a group have no resultant in any
state, ``Rᵀ f = 0``, so that ``(R y)ᵀ K_e ψ = −(δR y)ᵀ f``, with ``δR = −ad(ψ) R``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeVar

from petsc4py import PETSc

import numpy as np
import numpy.typing as npt
import scipy.linalg
import scipy.sparse as sp
from slepc4py import SLEPc

from fem_lie._arrays import Array
from fem_lie._compat import slepc_errors
from fem_lie.linear.direct import ConvergenceError
from fem_lie.linear.packages import lacks_memory
from fem_lie.linear.spectra.free_unknowns import ON_ONE_RANK, FreeUnknowns, OnRanks

Complex = npt.NDArray[np.complex128]

_TOLERANCE = 1e-9


def padded(A: sp.csr_matrix, B: sp.csr_matrix) -> sp.csr_matrix:
    """The matrix with zero rows and columns for the multipliers."""
    return sp.block_diag([A, sp.csr_matrix((B.shape[0],) * 2)], format="csr")


def set_up(solver: Any, count: int, kind: Any, prefix: str, unknowns: FreeUnknowns) -> None:
    """Compute ``count`` pairs nearest to a target with a factorisation.

    Raises:
        ConvergenceError: SLEPc fails.
        MemoryError: There is not enough memory for the factors.
    """
    solver.setOptionsPrefix(prefix)
    solver.setWhichEigenpairs(kind.Which.TARGET_MAGNITUDE)
    solver.setDimensions(count)
    solver.setTolerances(_TOLERANCE, 200)
    transform = solver.getST()
    transform.setType(SLEPc.ST.Type.SINVERT)
    if kind is SLEPc.PEP:
        transform.setTransform(True)
    solve_factorised(solver, prefix, unknowns)


def solve_factorised(solver: Any, prefix: str, unknowns: FreeUnknowns) -> None:
    """Solve by a direct factorisation, with the user's options.

    Raises:
        ConvergenceError: SLEPc fails, on any rank.
        MemoryError: There is not enough memory for the factors.
    """
    with unknowns.errors(ConvergenceError, MemoryError):
        _solve_factorised(solver, prefix)


def _solve_factorised(solver: Any, prefix: str) -> None:
    linear = solver.getST().getKSP()
    linear.setType(PETSc.KSP.Type.PREONLY)
    linear.getPC().setType(PETSc.PC.Type.LU)
    linear.getPC().setFactorSolverType("mumps")
    rows = solver.getOperators()[0].getOwnershipRanges()
    if not np.diff(rows).all():
        # the others normalise by LAPACK, which refuses a rank without rows
        solver.getBV().setType(SLEPc.BV.Type.VECS)
    # each rank solves the projected problem: with other round-off it may decide otherwise
    solver.getDS().setParallel(SLEPc.DS.ParallelType.SYNCHRONIZED)
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


def pairs_of(solver: Any, matrix: OnRanks, unknowns: FreeUnknowns) -> tuple[Complex, Complex]:
    """All converged eigenvalues and vectors, without multipliers, the same on all ranks."""
    found = solver.getConverged()
    real, imaginary = matrix.matrix.createVecs()
    values, vectors = np.empty(found, dtype=np.complex128), []
    for k in range(found):
        values[k] = solver.getEigenpair(k, real, imaginary)
        vectors.append(matrix.unknowns(real) + 1j * matrix.unknowns(imaginary))
    return unknowns.of_first(values), np.array(vectors).reshape(found, matrix.count)


Extended = npt.NDArray[np.longdouble]
ComplexExtended = npt.NDArray[np.clongdouble]


def product(A: sp.csr_matrix, vectors: Array | Extended) -> Extended:
    """``A φ`` of real rows ``φ``, shape (k, n)."""
    wide = vectors.T.astype(np.longdouble)
    return np.asarray((A.astype(np.longdouble) @ wide).T, dtype=np.longdouble)


Real = TypeVar("Real", np.float64, np.longdouble)

_KNOWN = 1e-7  # relative accuracy of an eigenvector
_ULPS = 1e-14
_VANISHES = 1e-2  # of the round-off of the largest stiffness
_MOST = 1200  # largest number of rigid motions of all groups for the search of mechanisms
FREE = 1e-9  # largest motion of supports in a free rigid motion of a group of size one


def kernel(triangle: Array) -> Array:
    """Orthonormal basis (z, k) of the null space of a matrix (m, z) of one dimension.

    Args:
        triangle: That of its QR factors: the SVD of a tall matrix would need m² numbers.
    """
    if not triangle.size:
        return np.eye(triangle.shape[1])
    return np.asarray(scipy.linalg.null_space(triangle, rcond=FREE))


class RigidParts:
    """Split of vectors of free unknowns into rigid motion and strain.

    Attributes:
        rest: Stiffness without elements, shape (n, n); likewise ``elements`` and ``stress``, ``P``.
    """

    def __init__(
        self,
        rest: sp.csr_matrix,
        elements: sp.csr_matrix,
        stress: sp.csr_matrix,
        motions: sp.csr_matrix,
        unknowns: FreeUnknowns,
    ) -> None:
        """Store the matrices.

        Args:
            rest: Stiffness without elements, shape (n, n).
            elements: Stiffness of elements.
            stress: ``P``.
            motions: Orthonormal rigid motions that supports allow, of all connected groups of
                elements, as columns, shape (n, r).
            unknowns: The unknowns of this rank.
        """
        self.rest, self.elements, self.stress = rest, elements, stress
        self._R, self._unknowns = motions, unknowns
        self._wide = motions.astype(np.longdouble)

    def mechanisms(self, B: sp.csr_matrix) -> Array:
        """Basis (z, n) of motions without strain of elements that the constraints ``B`` allow."""
        n, r = self._R.shape
        if r > _MOST:
            return np.empty((0, n))
        size = np.sqrt(np.asarray(B.multiply(B).sum(axis=1)).ravel())
        allowed = sp.diags(1.0 / np.where(size > 0.0, size, 1.0)) @ B @ self._R
        return np.asarray((self._R @ kernel(self._unknowns.triangle(allowed.toarray()))).T)

    def strained(self, vectors: npt.NDArray[Real]) -> npt.NDArray[Real]:
        """``ψ`` of each row."""
        return self._without_rigid(vectors, self._unknowns.owned, lambda moved: moved)

    def _resisting(self, forces: Extended) -> Extended:
        """Partial forces (k, n) without their resultants on groups: they do no work on ``R``."""
        return self._without_rigid(forces, lambda given: given, self._unknowns.owned)

    def _without_rigid(
        self,
        rows: npt.NDArray[Real],
        counted: Callable[[npt.NDArray[Real]], npt.NDArray[Real]],
        taken: Callable[[npt.NDArray[Real]], npt.NDArray[Real]],
    ) -> npt.NDArray[Real]:
        R = self._wide if rows.dtype == np.longdouble else self._R
        # twice: the first pass leaves round-off of the whole vector
        for _ in range(2):
            share = self._unknowns.total(R.T @ counted(rows).T)
            rows = rows - taken((R @ share).T)
        return rows

    def product(self, vectors: Array) -> Extended:
        """``K φ`` of rows, shape (k, n), in extended precision."""
        strained = self.strained(vectors)
        elastic, stressed = product(self.elements, strained), product(self.stress, strained)
        resultant = stressed - self._resisting(stressed)
        return product(self.rest, vectors) + self._resisting(elastic) + resultant

    def product_with_pressure(self, vectors: Array) -> Extended:
        """``K φ`` of rows if forces of elements have a resultant, as those of pressure do."""
        return product(self.rest, vectors) + product(self.elements, self.strained(vectors))

    def round_off(self, vectors: Array) -> Array:
        """Part of ``φᵀ K φ`` of each row that may be round-off.

        Strains below those of a vector with a relative error of its size are all round-off.
        """
        strained, total = self.strained(vectors), self._unknowns.total
        size, small = np.abs(vectors), np.abs(strained)
        cancels = (size * (abs(self.rest) @ size.T).T).sum(axis=1)
        cancels += (size * (abs(self.stress) @ small.T).T).sum(axis=1)
        strains = (small * (abs(self.elements) @ small.T).T).sum(axis=1)
        whole, elastic = ((self._unknowns.owned(x) ** 2).sum(axis=1) for x in (size, small))
        cancels, strains, whole, elastic = total(np.array([cancels, strains, whole, elastic]))
        # vanishing forces, such as those of springs at rest, are round-off of stiffness
        stiffest = self._unknowns.largest(float(abs(self.rest).max()))
        cancels = cancels + _VANISHES * stiffest * whole
        rigid = np.sqrt(elastic) <= _KNOWN * np.sqrt(whole)
        return np.asarray(_ULPS * cancels + np.where(rigid, strains, _ULPS * strains))


SHIFT = 1e-10  # over the largest ratio of stiffness to mass: regular with rigid motions
_ROUND_OFF = 1e-12  # of the largest ratio of stiffness to mass, and of the terms that cancel
_SYMMETRIC = 1e-9


def _largest_row(A: PETSc.Mat) -> float:
    """Largest sum of absolute values of a row."""
    return float(A.norm(PETSc.NormType.NORM_INFINITY))


@dataclass(frozen=True, eq=False)
class Pencil:
    """Matrices of the free unknowns, all in the unit of energy (times powers of time).

    Attributes:
        M: Mass matrix, shape (n, n).
        C: Damping and gyroscopic matrix, or ``None``.
        K: Stiffness matrix.
        B: Constraint Jacobian, shape (m, n).
        parts: Stiffness split into that of elements, which rigid motion does not strain, and the
            rest; ``None`` if unknown.
        unknowns: The unknowns, of which this rank may have a part.
    """

    M: sp.csr_matrix
    C: sp.csr_matrix | None
    K: sp.csr_matrix
    B: sp.csr_matrix
    parts: RigidParts | None = None
    unknowns: FreeUnknowns = ON_ONE_RANK

    @cached_property
    def diagonals(self) -> tuple[Array, Array]:
        """Diagonals of mass and absolute stiffness, each shape (n,)."""
        mass, stiffness = self.unknowns.assembled(
            np.array([self.M.diagonal(), self.K.diagonal()], dtype=np.float64)
        )
        return np.asarray(mass), np.abs(stiffness)

    @cached_property
    def fastest(self) -> float:
        """Square root of the largest ratio of stiffness to mass of one unknown, a rate."""
        mass, stiffness = self.diagonals
        ratio = stiffness[mass > 0] / mass[mass > 0]
        return float(np.sqrt(self.unknowns.largest(ratio.max(initial=0.0))))

    @cached_property
    def symmetric(self) -> bool:
        """Whether the stiffness is symmetric."""
        K = self.on_ranks(self.K).matrix
        skew = K.transpose(PETSc.Mat())
        skew.axpy(-1.0, K)
        return bool(_largest_row(skew) <= _SYMMETRIC * _largest_row(K))

    def on_ranks(self, A: sp.csr_matrix) -> OnRanks:
        """Matrix of the unknowns and of multipliers for PETSc."""
        return self.unknowns.matrix(A, self.K.shape[0])

    @property
    def whole(self) -> Pencil:
        """The problem with all unknowns on this rank."""
        if not self.unknowns.several:
            return self
        of_all = self.unknowns.whole_matrix
        C = None if self.C is None else of_all(self.C)
        return Pencil(of_all(self.M), C, of_all(self.K), self.unknowns.whole_rows(self.B))

    @property
    def mass_unit(self) -> float:
        """Largest mass of an unknown, or 1 without any."""
        return self.unknowns.largest(float(self.diagonals[0].max(initial=0.0))) or 1.0

    def work(self, vectors: Any, forces: Any) -> Any:
        """``φ f`` of rows of vectors (k, n) and partial forces (l, n), shape (k, l)."""
        return self.unknowns.total(vectors @ forces.T)

    def kinetic(self, vectors: Array | Complex) -> Array:
        """``φᴴ M φ`` of each row."""
        own = (vectors.conj() * (self.M @ vectors.T).T).sum(axis=1).real
        return np.asarray(self.unknowns.total(own))

    def stiffness(self, vectors: Array) -> Extended:
        """``K φ`` of real rows in extended precision, without round-off of rigid motion."""
        if self.parts is None:
            return product(self.K, vectors)
        # pressure has an unsymmetric stiffness
        split = self.parts.product if self.symmetric else self.parts.product_with_pressure
        return split(vectors)

    @property
    def split_is_exact(self) -> bool:
        """Whether ``parts`` are all of ``K``: nodes without drilling lack rigid motions."""
        probe = np.random.default_rng(0).normal(size=(1, self.K.shape[0]))
        probe = self.unknowns.of_owners(probe)
        whole = product(self.K, probe)
        both = np.concatenate([self.stiffness(probe) - whole, whole]).astype(np.float64)
        difference, size = np.abs(self.unknowns.assembled(both)).max(axis=1, initial=0.0)
        largest = self.unknowns.largest
        return largest(float(difference)) <= _SYMMETRIC * largest(float(size))

    def terms(self, vectors: Complex) -> tuple[Complex, Complex, Complex]:
        """``M φ``, ``C φ`` and ``K φ`` of rows, see :meth:`stiffness`."""
        imaginary = self.unknowns.largest(float(np.abs(vectors.imag).max(initial=0.0))) > 0.0
        parts = [vectors.real, vectors.imag] if imaginary else [vectors.real]
        rows = np.concatenate(parts)
        stiff = self.stiffness(rows)
        damped = np.zeros_like(stiff) if self.C is None else product(self.C, rows)
        found: list[Any] = [np.split(x, len(parts)) for x in (product(self.M, rows), damped, stiff)]
        M, C, K = (each[0] + (1j * each[1] if imaginary else 0j) for each in found)
        return M, C, K

    def round_off(self, vectors: Complex, mass: Array) -> Array:
        """Rates that round-off makes of zero, for vectors (k, n) with ``φᴴ M φ``, (k,)."""
        if self.parts is None:
            size = np.abs(vectors)
            own = (size * (abs(self.K) @ size.T).T).sum(axis=1)
            energy = _ROUND_OFF * self.unknowns.total(own)
        else:
            energy = self.parts.round_off(vectors.real) + self.parts.round_off(vectors.imag)
        ratio = np.divide(energy, mass, out=np.full(len(mass), np.inf), where=mass > 0)
        return np.asarray(np.sqrt(np.minimum(ratio, _ROUND_OFF * self.fastest**2)))
