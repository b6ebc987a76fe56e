"""Eigenvalue problems as SLEPc takes them."""

from __future__ import annotations

from typing import Any

from petsc4py import PETSc

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp
from slepc4py import SLEPc

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
