"""Meshes, supports and Newton's method that the examples with own energies share."""

from __future__ import annotations

from collections.abc import Sequence

from mpi4py import MPI

import basix.ufl
import numpy as np
import ufl
from dolfinx import fem, mesh

import fem_lie as fl


def line(cells: int, length: float = 1.0, comm: MPI.Comm = MPI.COMM_WORLD) -> mesh.Mesh:
    """The x axis from 0 to the length, in space."""
    n = cells if comm.rank == 0 else 0
    x = np.zeros((n + 1 if n else 0, 3))
    x[:, 0] = np.linspace(0.0, length, len(x))
    pairs = np.column_stack([np.arange(n), np.arange(1, n + 1)])
    interval = basix.ufl.element("Lagrange", "interval", 1, shape=(3,))
    return mesh.create_mesh(comm, cells=pairs, x=x, e=interval)


def strip(cells: int, length: float, width: float) -> mesh.Mesh:
    """One row of quadrilaterals along the x axis, in space."""
    n = cells if MPI.COMM_WORLD.rank == 0 else 0
    x = np.zeros((2 * (n + 1) if n else 0, 3))
    x[:, 0] = np.repeat(np.linspace(0.0, length, n + 1), 2)[: len(x)]
    x[:, 1] = np.tile([0.0, width], n + 1)[: len(x)]
    corners = 2 * np.arange(n)[:, None] + np.array([0, 2, 1, 3])
    quadrilateral = basix.ufl.element("Lagrange", "quadrilateral", 1, shape=(3,))
    return mesh.create_mesh(MPI.COMM_WORLD, cells=corners, x=x, e=quadrilateral)


def end(msh: mesh.Mesh, length: float) -> ufl.Measure:
    """``ds`` where x is the length: a vertex of a line, an edge of a shell."""
    below = msh.topology.dim - 1
    msh.topology.create_connectivity(below, below + 1)
    found = mesh.locate_entities_boundary(msh, below, lambda x: np.isclose(x[0], length))
    tags = mesh.meshtags(msh, below, found, np.ones(len(found), dtype=np.int32))
    return ufl.Measure("ds", domain=msh, subdomain_data=tags)(1)


def problem(q: fl.NodalFrames, forms: Sequence[fl.extend.LocalFrameForms]) -> fl.FrameProblem:
    """Equilibrium with all nodes at x = 0 clamped."""
    V = q.increment.function_space
    held = fem.locate_dofs_geometrical(V, lambda x: np.isclose(x[0], 0.0))
    return fl.FrameProblem(forms, q, [fem.dirichletbc(np.zeros(6), held, V)])


def newton(equilibrium: fl.FrameProblem, line_search: str = "basic") -> int:
    """Iterations of SNES; full steps by default."""
    snes = equilibrium.snes(line_search=line_search)
    snes.setTolerances(rtol=0.0, atol=1e-9, stol=1e-10, max_it=60)
    snes.solve(None, equilibrium.x.x.petsc_vec)
    if snes.getConvergedReason() <= 0:
        raise RuntimeError(f"SNES failed with reason {snes.getConvergedReason()}")
    return snes.getIterationNumber()


def load_steps(
    equilibrium: fl.FrameProblem, load: fem.Constant, full: Sequence[float], steps: int
) -> int:
    """All iterations of equal load steps."""
    iterations = 0
    for step in range(1, steps + 1):
        load.value = np.asarray(full) * step / steps
        iterations += newton(equilibrium)
    return iterations


def position(q: fl.NodalFrames, point: Sequence[float]) -> np.ndarray:
    """Position of the node that was at ``point``, on all ranks."""
    space = q.increment.function_space
    owned = space.dofmap.index_map.size_local
    near = np.isclose(space.tabulate_dof_coordinates()[:owned], point).all(axis=1)
    found = space.mesh.comm.allgather(q.frames[:owned, 0][near])
    return np.concatenate(found)[0]


def simo_strains(q: fl.NodalFrames) -> ufl.core.expr.Expr:
    """Strains (Γ, κ) of a beam along the x axis."""
    stretch, curvature = fl.elements.director_strains(q)
    return ufl.as_vector([stretch[0] - 1, stretch[1], stretch[2], *curvature])


def plate_strains(q: fl.NodalFrames) -> tuple[ufl.core.expr.Expr, ...]:
    """Strains of a plate in the x-y plane: membrane, bending, shear, and drilling.

    Membrane and bending have the components (11, 22, 2 12).
    """
    x, d = q.position, q.directors
    a, b = ([ufl.grad(f)[:, k] for k in range(2)] for f in (x, d[2]))

    def symmetric(c: list, f: list, unit: float) -> ufl.core.expr.Expr:
        twice = ufl.inner(c[0], f[1]) + ufl.inner(c[1], f[0])
        return ufl.as_vector([ufl.inner(c[0], f[0]) - unit, ufl.inner(c[1], f[1]) - unit, twice])

    shear = ufl.as_vector([ufl.inner(a[0], d[2]), ufl.inner(a[1], d[2])])
    drilling = (ufl.inner(a[0], d[1]) - ufl.inner(a[1], d[0])) / 2
    membrane = symmetric(a, a, 1.0)
    return (
        ufl.diag(ufl.as_vector([0.5, 0.5, 1.0])) * membrane,
        symmetric(a, b, 0.0),
        shear,
        drilling,
    )


def diagonal(*stiffness: float) -> ufl.core.expr.Expr:
    """Diagonal section stiffness."""
    return ufl.diag(ufl.as_vector(stiffness))
