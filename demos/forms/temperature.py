"""A beam and its temperature, solved at once: sunshine on the end of a bimetal.

The beam bends by its temperature T, kappa_3 = beta T, and is kept at T = 0 where it is clamped.
The sun heats its end in proportion to what it sees of it, q0 d_1 . e_1. No force acts, so that
T(s) = q0 cos(theta) s / k with the rotation theta of the end, and

    theta = beta q0 cos(theta) L^2 / (2 k).

Blocks: forces by `local_frame_forms`, their derivative in T and the derivative of the heat flux
in the frames by `fl.extend`, conduction by UFL. Newton's method converges quadratically.
"""

from __future__ import annotations

from typing import Any

from petsc4py import PETSc

import numpy as np
import ufl
from clamped import diagonal, end, line, position, simo_strains
from dolfinx import fem
from dolfinx.fem import petsc
from scipy.optimize import brentq

import fem_lie as fl

BETA, FLUX, CONDUCTIVITY = 1.0, 3.0, 1.0


def main(cells: int = 32) -> dict[str, Any]:
    msh = line(cells)
    q, dx, ds = fl.NodalFrames(msh), ufl.dx(msh, degree=0), end(msh, 1.0)
    T = fem.Function(fem.functionspace(msh, ("Lagrange", 1)))
    V, S = q.increment.function_space, T.function_space
    e = simo_strains(q) - BETA * T * ufl.as_vector([0, 0, 0, 0, 0, 1])
    W = ufl.inner(e, diagonal(10.0, 10.0, 10.0, 1.0, 1.0, 1.0) * e) / 2 * dx
    heat = CONDUCTIVITY * ufl.inner(ufl.grad(T), ufl.grad(ufl.TestFunction(S))) * dx
    heat -= FLUX * q.directors[0][0] * ufl.TestFunction(S) * ds
    beam = fl.local_frame_forms(W, q)
    a = [
        [beam.tangent, fl.extend.derivative_in_field(W, q, T)],
        [fl.extend.derivative_in_frames(heat, q), fem.form(ufl.derivative(heat, T))],
    ]
    clamps = [fem.locate_dofs_geometrical(space, lambda x: np.isclose(x[0], 0)) for space in (V, S)]
    bcs = [fem.dirichletbc(np.zeros(6), clamps[0], V), fem.dirichletbc(0.0, clamps[1], S)]
    ksp = PETSc.KSP().create(msh.comm)
    ksp.setType("preonly")
    ksp.getPC().setType("lu")
    ksp.getPC().setFactorSolverType("mumps")
    dT, sizes = fem.Function(S), []
    while not sizes or (sizes[-1] > 1e-9 and len(sizes) < 20):
        blocks = [[petsc.assemble_matrix(form, bcs) for form in row] for row in a]
        for block in (*blocks[0], *blocks[1]):
            block.assemble()
        parts = [petsc.assemble_vector(form) for form in (beam.residual, fem.form(heat))]
        for part in parts:
            part.ghostUpdate(PETSc.InsertMode.ADD, PETSc.ScatterMode.REVERSE)
            petsc.set_bc(part, bcs)
        A = PETSc.Mat().createNest(blocks).convert("aij")
        x, b = A.createVecs()
        b.array[:] = -np.concatenate([part.array for part in parts])
        ksp.setOperators(A)
        ksp.solve(b, x)
        sizes.append(x.norm(PETSc.NormType.NORM_INFINITY))
        owned = 6 * V.dofmap.index_map.size_local
        for f, values in ((q.increment, x.array_r[:owned]), (dT, x.array_r[owned:])):
            f.x.array[: len(values)] = values
            f.x.scatter_forward()
        q.update(q.increment.x.array)
        T.x.array[:] += dT.x.array
    tip = position(q, (1.0, 0.0, 0.0))
    theta = brentq(lambda t: t - BETA * FLUX / (2 * CONDUCTIVITY) * np.cos(t), 0.0, np.pi / 2)
    s = (np.arange(10000) + 0.5) / 10000
    exact = np.array([np.cos(theta * s**2).mean(), np.sin(theta * s**2).mean(), 0.0])
    error = float(np.linalg.norm(tip - exact))
    return {"tip": tip.tolist(), "tip_error": error, "iterations": len(sizes)}


if __name__ == "__main__":
    print(main())
