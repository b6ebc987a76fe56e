"""Direct solution with a kept factorisation, through PETSc."""

from __future__ import annotations

from typing import Any

from petsc4py import PETSc

import numpy as np


class ConvergenceError(RuntimeError):
    """An iteration did not converge; the message says where, how far it came, and what to try.

    Attributes:
        result: What was computed before, if anything.
    """

    def __init__(self, message: str, result: Any = None) -> None:
        """Keep the results with the message."""
        super().__init__(message)
        self.result = result


class SingularMatrixError(ArithmeticError):
    """The matrix has no factorisation."""


class DirectSolver:
    """Factorise now, solve many times.

    KLU is the fastest for chains of bodies (block triangular, little fill). Any other direct solver
    of PETSc can be chosen at run time with ``-<prefix>pc_factor_mat_solver_type``.

    Attributes:
        factorisations: How many there were.
        right_hand_side: Where :meth:`solve` finds it, and ``solution``: where it leaves that.
    """

    def __init__(self, matrix: PETSc.Mat, prefix: str) -> None:
        """Keep the matrix; nothing is factorised yet.

        Args:
            matrix: Square matrix whose values change between factorisations.
            prefix: Prefix of the PETSc options.
        """
        self._ksp = PETSc.KSP().create(matrix.comm)
        self._ksp.setOptionsPrefix(prefix)
        self._ksp.setOperators(matrix)
        self._ksp.setType(PETSc.KSP.Type.PREONLY)
        self._ksp.getPC().setType(PETSc.PC.Type.LU)
        self._ksp.getPC().setFactorSolverType("klu")
        self._ksp.setFromOptions()
        self._matrix = matrix
        self.factorisations = 0
        size = matrix.getSize()[0]
        self.right_hand_side, self.solution = np.zeros(size), np.zeros(size)
        self._b = PETSc.Vec().createWithArray(self.right_hand_side, comm=matrix.comm)
        self._x = PETSc.Vec().createWithArray(self.solution, comm=matrix.comm)

    def factorise(self) -> None:
        """Factorise the matrix as it is now.

        Raises:
            SingularMatrixError: It cannot be factorised.
        """
        self._ksp.setOperators(self._matrix)
        try:
            self._ksp.setUp()
        except PETSc.Error as error:
            raise SingularMatrixError("the matrix is singular or not finite") from error
        self.factorisations += 1

    def solve(self) -> None:
        """Solve with the last factorisation."""
        self._ksp.solve(self._b, self._x)
