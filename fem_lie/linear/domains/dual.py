"""FETI-DP as preconditioner: what it solves is not the interface's own matrix.

FETI-DP takes its operator from the matrix of BDDC, which has eigenvalues lifted and no asymmetric
part. Solutions with it alone are those of another scene, by as much as the lift is over the least
eigenvalues of all domains together: of shells and nets in statics that is beyond one, and refining
them leads nowhere. So conjugate gradients, or GMRES, iterate around it with the matrix as it is.
"""

from __future__ import annotations

from petsc4py import PETSc

TOLERANCE = 1e-2
"""Of each iteration on multipliers: with 1e-8 round-off made them stop, as what they solve was no
longer positive, and the whole took twice as many."""


class Dual:
    """PETSc's ``KSPFETIDP``, called by an iteration around it."""

    def __init__(self, P: PETSc.Mat, prefix: str, most: int) -> None:
        """Nothing is set up yet.

        Args:
            P: Positive matrices of all domains.
            prefix: Of its options.
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
        if b.norm() == 0.0:  # of which it can make what is no number
            x.set(0.0)
            return
        self._ksp.solve(b, x)
        self._taken += self._ksp.getIterationNumber()

    def view(self, pc: PETSc.PC, viewer: PETSc.Viewer) -> None:
        """Tell what it is, as PETSc does."""
        self._ksp.view(viewer)

    def destroy(self, pc: PETSc.PC) -> None:
        """Give up what PETSc has."""
        self._ksp.destroy()

    def taken(self) -> int:
        """Iterations on multipliers since this was last asked."""
        taken, self._taken = self._taken, 0
        return taken
