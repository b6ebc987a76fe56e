"""Newton's method on the group in PETSc, for a clamped line with a moment at its tip."""

from __future__ import annotations

from mpi4py import MPI
from petsc4py import PETSc

import basix.ufl
import numpy as np
from dolfinx import fem, la, mesh
from dolfinx.fem import petsc

import fem_lie as fl

LENGTH = 1.0


def line(comm: MPI.Comm, elements: int) -> mesh.Mesh:
    """The x axis from 0 to the length, in space."""
    n = elements if comm.rank == 0 else 0
    x = np.zeros((n + 1 if n else 0, 3))
    x[:, 0] = np.linspace(0.0, LENGTH, len(x))
    cells = np.column_stack([np.arange(n), np.arange(1, n + 1)])
    interval = basix.ufl.element("Lagrange", "interval", 1, shape=(3,))
    return mesh.create_mesh(comm, cells=cells, x=x, e=interval)


class Cantilever:
    """Newton's method on the group, in twenty lines of PETSc."""

    def __init__(self, q: fl.NodalFrames, forms: fl.extend.LocalFrameForms) -> None:
        self.q, self.forms = q, forms
        V = q.increment.function_space
        clamp = fem.locate_dofs_geometrical(V, lambda x: np.isclose(x[0], 0.0))
        self.tip = fem.locate_dofs_geometrical(V, lambda x: np.isclose(x[0], LENGTH))
        self.bcs = [fem.dirichletbc(np.zeros(6), clamp, V)]
        self.load = fem.Function(V)
        self.A = petsc.create_matrix(forms.tangent)
        self.ksp = PETSc.KSP().create(V.mesh.comm)
        self.ksp.setOperators(self.A)
        self.ksp.setType("preonly")
        self.ksp.getPC().setType("lu")
        self.ksp.getPC().setFactorSolverType("mumps")

    def solve(self, moment: float) -> int:
        """Iterate to the moment at the tip; returns the iterations, 0 if it diverges."""
        self.load.x.array.reshape(-1, 6)[self.tip, 5] = moment
        h = self.q.increment.x
        for iteration in range(1, 31):
            self.A.zeroEntries()
            petsc.assemble_matrix(self.A, self.forms.tangent, bcs=self.bcs)
            self.A.assemble()
            b = petsc.assemble_vector(self.forms.residual)
            b.ghostUpdate(addv=PETSc.InsertMode.ADD, mode=PETSc.ScatterMode.REVERSE)
            b.aypx(-1.0, self.load.x.petsc_vec)
            petsc.set_bc(b, self.bcs)
            self.ksp.solve(b, h.petsc_vec)
            b.destroy()
            h.scatter_forward()
            size = la.norm(h, la.Norm.linf)
            if not size < 1e3:
                return 0
            self.forms.update_stress()  # the stress, before its configuration changes
            self.q.update(h.array)
            if size < 1e-9:
                return iteration
        return 0

    def tip_position(self) -> np.ndarray:
        """Position of the end, on all processes."""
        owned = self.tip[self.tip < self.q.increment.function_space.dofmap.index_map.size_local]
        return self.load.function_space.mesh.comm.allreduce(self.q.frames[owned, 0].sum(axis=0))

    def curve(self) -> np.ndarray:
        """Positions of this process's nodes in their order along the strip."""
        x = self.load.function_space.tabulate_dof_coordinates()[:, 0]
        return self.q.frames[np.argsort(x), 0].copy()
