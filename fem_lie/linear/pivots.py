"""Stability of an equilibrium from the factors of its tangent.

Under loads with a potential the tangent at equilibrium is symmetric, and its number of negative
pivots equals that of its negative eigenvalues (Sylvester's law of inertia): without any the
equilibrium is stable. With m independent constraints the saddle-point matrix has m further negative
pivots.

Under other loads, such as moments about fixed axes, the symmetric part is not conclusive: it may be
indefinite at a stable equilibrium. Another equilibrium is adjacent where the determinant of the
tangent is zero, and with a negative determinant the equilibrium is unstable; a positive determinant
does not exclude flutter. (V. V. Bolotin, Nonconservative Problems of the Theory of Elastic
Stability, 1963.)
"""

from __future__ import annotations

from petsc4py import PETSc

import scipy.sparse as sp

from fem_lie.linear.equilibrated import SingularMatrixError
from fem_lie.linear.packages import NEGATIVE, lacks_memory
from fem_lie.ranks.divided_matrix import DividedMatrix, with_diagonal
from fem_lie.ranks.shared_nodes import SharedNodes

_NULL, _DETERMINANT = 24, 33  # MUMPS: ICNTL to look for null pivots, and for the determinant
_SPACE = 14  # MUMPS: ICNTL of the space beyond the estimate, in percent
_MORE_SPACE = 20, 100, 1000  # pivots that are delayed need more than the estimate
_ZERO, _MANTISSA = 28, 12  # INFOG of the number of null pivots, RINFOG of the determinant


def inertia(A: sp.csr_matrix, shared: SharedNodes | None = None) -> tuple[int, int]:
    """Numbers of negative and of zero pivots of a symmetric matrix, by MUMPS.

    Args:
        A: The matrix, or that of the part of this rank.
        shared: Nodes that other ranks have, too; default: none.

    Raises:
        SingularMatrixError: It cannot be factorised.
        MemoryError: There is not enough memory for the factors.
    """
    factors = _factors(A, PETSc.PC.Type.CHOLESKY, _NULL, shared)
    return int(factors.getMumpsInfog(NEGATIVE)), int(factors.getMumpsInfog(_ZERO))


def negative_determinant(A: sp.csr_matrix, shared: SharedNodes | None = None) -> bool:
    """Whether the determinant of a matrix is negative, by MUMPS; arguments as of :func:`inertia`.

    Raises:
        SingularMatrixError: It cannot be factorised.
        MemoryError: There is not enough memory for the factors.
    """
    factors = _factors(A, PETSc.PC.Type.LU, _DETERMINANT, shared)
    return bool(factors.getMumpsRinfog(_MANTISSA) < 0.0)


def _factors(A: sp.csr_matrix, kind: str, option: int, shared: SharedNodes | None) -> PETSc.Mat:
    """MUMPS' factors with an option switched on."""
    A = with_diagonal(A)
    csr = A.indptr.astype(PETSc.IntType), A.indices.astype(PETSc.IntType), A.data
    shared = SharedNodes.alone(0) if shared is None else shared
    matrix = DividedMatrix((A.data, csr[1], csr[0]), shared).matrix
    matrix.setOption(PETSc.Mat.Option.SYMMETRIC, kind == PETSc.PC.Type.CHOLESKY)
    for more in _MORE_SPACE:
        pc = PETSc.PC().create(matrix.comm)
        pc.setOperators(matrix)
        pc.setType(kind)
        pc.setFactorSolverType("mumps")
        pc.setFactorSetUpSolverType()
        pc.getFactorMatrix().setMumpsIcntl(option, 1)
        pc.getFactorMatrix().setMumpsIcntl(_SPACE, more)
        try:
            pc.setUp()
        except PETSc.Error as error:
            raise SingularMatrixError("the matrix is singular or not finite") from error
        if not lacks_memory(pc, None):
            return pc.getFactorMatrix()
    raise MemoryError(f"not enough memory to factorise the matrix of {A.shape[0]} unknowns")
