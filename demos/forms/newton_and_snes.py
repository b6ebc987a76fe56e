"""One problem by DOLFINx's NewtonSolver and by PETSc's SNES, which reject trial points or do not.

`fl.FrameProblem` moves the frames to each trial point from those at which the tangent was last
assembled: line searches apply no increment twice. A beam with EA L^2/EI = 20 is bent by the moment
of a quarter of a circle. All solvers end in the same frames; the full step (`basic`) is fastest, as
residuals add forces and moments, and increments that are right stretch the beam at first. For
slender beams the others stall.

The end is at 2/pi (1, 1): second order for two-node elements.
"""

from __future__ import annotations

from typing import Any

from mpi4py import MPI

import numpy as np
import ufl
from clamped import diagonal, end, line, newton, position, problem, simo_strains
from dolfinx import fem
from dolfinx.nls.petsc import NewtonSolver

import fem_lie as fl


def quarter(cells: int) -> tuple[fl.NodalFrames, fl.FrameProblem]:
    """Frames, and the equilibrium with the whole moment."""
    msh = line(cells)
    q = fl.NodalFrames(msh)
    C = diagonal(20.0, 10.0, 10.0, 1.0, 1.0, 1.0)
    energy = fl.extend.StrainEnergy(
        simo_strains(q), lambda e: ufl.inner(e, C * e) / 2, ufl.dx(msh, degree=0)
    )
    moment = fem.Constant(msh, (0.0, 0.0, np.pi / 2))
    load = fl.extend.dead_moment(moment, end(msh, 1.0), q)
    return q, problem(q, [fl.local_frame_forms(energy, q), load])


def main(cells: int = 16) -> dict[str, Any]:
    q, equilibrium = quarter(cells)
    solver = NewtonSolver(MPI.COMM_WORLD, equilibrium)
    solver.atol, solver.rtol = 1e-10, 1e-12
    solver.krylov_solver.setType("preonly")
    solver.krylov_solver.getPC().setType("lu")
    iterations = {"newton": solver.solve(equilibrium.x)[0]}
    tip = position(q, (1.0, 0.0, 0.0))
    difference = 0.0
    for line_search in ("basic", "bt", "cp"):
        q, equilibrium = quarter(cells)
        iterations[line_search] = newton(equilibrium, line_search)
        difference = max(difference, np.linalg.norm(position(q, (1.0, 0.0, 0.0)) - tip))
    exact = 2 / np.pi * np.array([1.0, 1.0, 0.0])
    error = float(np.linalg.norm(tip - exact))
    return {"tip_error": error, "difference": float(difference), **iterations}


if __name__ == "__main__":
    print(main())
