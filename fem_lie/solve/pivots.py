"""What the factors of a tangent say of the stability of an equilibrium.

Under loads that have a potential the tangent at equilibrium is symmetric, and its number of
negative pivots that of its negative eigenvalues (Sylvester's law of inertia): with none of them the
equilibrium is stable. Bordered by m independent constraints it has m negative pivots more.

Under others, such as moments about fixed axes, the symmetric part says too much: it may be
indefinite where nothing happens. There is another equilibrium beside this one where the determinant
of the tangent is zero, and with a negative one the equilibrium is unstable; a positive one says
nothing of flutter. (V. V. Bolotin, Nonconservative Problems of the Theory of Elastic Stability,
1963.)
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from petsc4py import PETSc

import scipy.sparse as sp

from fem_lie.choices import Redundant
from fem_lie.solve.linear import NEGATIVE, DirectSolver, SingularMatrixError

if TYPE_CHECKING:
    from fem_lie.system import System

_NULL, _DETERMINANT = 24, 33  # MUMPS: ICNTL to look for null pivots, and for the determinant
_ZERO, _MANTISSA = 28, 12  # INFOG of the number of null pivots, RINFOG of the determinant

_SOFT = 1e-6  # give of constraints, over that of the stiffest spring

UNKNOWN = -1
"""Number of negative pivots of a matrix that cannot be factorised."""


def negative_pivots(system: System, solver: DirectSolver) -> int:
    """Negative eigenvalues of the tangent that was factorised last, of what constraints leave free.

    For loads without potential: 1 if their number is odd, 0 if it is even. It is −1 if the matrix
    cannot be factorised.
    """
    redundant = system.m > 0 and system.scene.redundant is not Redundant.REFUSE
    try:
        found = None if redundant else solver.negative_pivots()
        if found is None or not system.has_potential:
            A = tangent(system)
            if redundant:
                A = _softened(A, 6 * system.count)
            if not system.has_potential:
                return int(negative_determinant(A) != bool(system.m % 2))
            found = inertia((0.5 * (A + A.T)).tocsr())[0]
    except SingularMatrixError:
        return UNKNOWN
    return max(0, found - system.m)


def tangent(system: System) -> sp.csr_matrix:
    """The matrix as it is now, in rows and columns of one dimension."""
    values, columns, pointers = system.kkt.csr
    A = sp.csr_matrix((values.copy(), columns, pointers), shape=(system.size, system.size))
    units = sp.diags(system.kkt.units)
    return (units @ A @ units).tocsr()


def _softened(A: sp.csr_matrix, n: int) -> sp.csr_matrix:
    """With constraints after row ``n`` that give way a little, so that redundant ones count, too.

    The rows have the inertia of springs beside ``K``: as many negative pivots as rows.
    """
    stiffest = float(abs(A[:n, :n]).max()) or 1.0
    rows = A[n:, :n]
    give = _SOFT / stiffest * rows.multiply(rows).sum(axis=1).A1
    return sp.bmat([[A[:n, :n], A[:n, n:]], [rows, -sp.diags(give)]], format="csr")


def inertia(A: sp.csr_matrix) -> tuple[int, int]:
    """Numbers of negative and of zero pivots of a symmetric matrix, by MUMPS.

    Raises:
        SingularMatrixError: It cannot be factorised.
    """
    factors = _factors(A, PETSc.PC.Type.CHOLESKY, _NULL)
    return int(factors.getMumpsInfog(NEGATIVE)), int(factors.getMumpsInfog(_ZERO))


def negative_determinant(A: sp.csr_matrix) -> bool:
    """Whether the determinant of a matrix is negative, by MUMPS.

    Raises:
        SingularMatrixError: It cannot be factorised.
    """
    factors = _factors(A, PETSc.PC.Type.LU, _DETERMINANT)
    return bool(factors.getMumpsRinfog(_MANTISSA) < 0.0)


def _factors(A: sp.csr_matrix, kind: str, option: int) -> PETSc.Mat:
    """MUMPS' factors with an option switched on."""
    A.sort_indices()
    csr = A.indptr.astype(PETSc.IntType), A.indices.astype(PETSc.IntType), A.data
    matrix = PETSc.Mat().createAIJ(A.shape, csr=csr, comm=PETSc.COMM_SELF)
    matrix.setOption(PETSc.Mat.Option.SYMMETRIC, kind == PETSc.PC.Type.CHOLESKY)
    pc = PETSc.PC().create(PETSc.COMM_SELF)
    pc.setOperators(matrix)
    pc.setType(kind)
    pc.setFactorSolverType("mumps")
    pc.setFactorSetUpSolverType()
    pc.getFactorMatrix().setMumpsIcntl(option, 1)
    try:
        pc.setUp()
    except PETSc.Error as error:
        raise SingularMatrixError("the matrix is singular or not finite") from error
    return pc.getFactorMatrix()
