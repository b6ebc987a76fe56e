"""FETI-DP as a preconditioner: its operator is not the matrix of the interface.

FETI-DP takes its operator from the matrix of BDDC, which has lifted eigenvalues and no unsymmetric
part. Its solutions differ from those of the scene by the lift over the least eigenvalues of all
subdomains together: for shells and nets in statics this exceeds one, and refinement does not
converge. Conjugate gradients or GMRES with the actual matrix therefore iterate around it.
"""

from __future__ import annotations

from petsc4py import PETSc

TOLERANCE = 1e-2
"""Relative tolerance of each iteration on multipliers. With 1e-8 the iterations stopped by
round-off, as their operator was no longer positive, and took twice as many in total.
"""


class Dual:
    """PETSc's ``KSPFETIDP`` as a preconditioner."""

    def __init__(self, P: PETSc.Mat, prefix: str, most: int) -> None:
        """Store the matrices; :meth:`setUp` builds the preconditioner.

        Args:
            P: Positive matrices of all subdomains.
            prefix: Prefix of its options.
            most: Iterations of one solution.
        """
        self._taken = 0
        self._ksp = PETSc.KSP().create(PETSc.COMM_WORLD)
        self._ksp.setOptionsPrefix(prefix)
        self._ksp.setOperators(P, P)
        self._ksp.setType("fetidp")
        self._ksp.setTolerances(rtol=TOLERANCE, max_it=most)
        self._ksp.setFromOptions()

    def setUp(self, pc: PETSc.PC) -> None:
        """Choose primal unknowns, and factorise."""
        self._ksp.setUp()

    def apply(self, pc: PETSc.PC, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Solve with the positive matrices."""
        if b.norm() == 0.0:  # for which it may return nan
            x.set(0.0)
            return
        self._ksp.solve(b, x)
        self._taken += self._ksp.getIterationNumber()

    def view(self, pc: PETSc.PC, viewer: PETSc.Viewer) -> None:
        """Show its description, as PETSc does."""
        self._ksp.view(viewer)

    def destroy(self, pc: PETSc.PC) -> None:
        """Free the objects of PETSc."""
        self._ksp.destroy()

    def taken(self) -> int:
        """Iterations on multipliers since this was last asked."""
        taken, self._taken = self._taken, 0
        return taken
