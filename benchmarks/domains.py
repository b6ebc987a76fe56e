"""Domain decomposition of shells in local frames: iterations of BDDC and FETI-DP, over subdomains.

    tools/run mpirun --oversubscribe -n 4 python3 -m benchmarks.domains --cells 24 24 --cases NAME …

One rank has one subdomain. A square shell, six unknowns a node, biquadratic, is cut by DOLFINx's
partitioner; the tangent in nodal local frames is assembled into PETSc's MATIS without ghost cells.
Rigid motions in local frames are the near null space. A row of a table in Markdown is printed for
each case: subdomains, name, unknowns, on interfaces, in the coarse problem, iterations of conjugate
gradients to 1e-8, condition number, true residual, processor seconds of set-up and of the solution
and growth of memory in both, in megabytes, of all ranks together.

A name is made of *flat* or *cylinder* (bent by 2 rad), *step* (with the inertia of an implicit step
of 1 ms) or *static* (clamped along an edge, integrated in full), thickness over the longer side,
and how it is solved: *adaptive* (BDDC with deluxe scaling and adaptive primal unknowns), *plain*
(BDDC as it comes), *feti* (FETI-DP, as adaptive).

With ``--contrast`` the subdomains of odd ranks are so many times as stiff.
"""

from __future__ import annotations

import argparse
import gc
import re
import tempfile
from pathlib import Path
from time import process_time
from typing import NamedTuple

from mpi4py import MPI
from petsc4py import PETSc

import basix.ufl
import dolfinx.mesh
import numpy as np
import scipy.sparse as sp
import ufl
from dolfinx import fem, la
from dolfinx.mesh import GhostMode

from fem_lie import _compat
from fem_lie.forms.frames import NodalFrames, local_frame_forms

E, NU, DENSITY = 2.1e11, 0.3, 7850.0
STEP, SHEAR, DRILLING = 1e-3, 5 / 6, 0.1
TOLERANCE, RADIUS, THRESHOLD = 1e-8, 0.5, 3.0
LUMPS = np.array([1, 1, 1, 1, 4, 4, 4, 4, 16]) / 36
PAGES_PER_MB = 256


class Case(NamedTuple):
    """What is solved, and how."""

    curved: bool
    static: bool
    thickness: float
    solver: str


def case(name: str) -> Case:
    """That of a name such as ``cylinder-static-0.01-adaptive``."""
    shape, load, thickness, solver = name.split("-")
    choices = (shape, ("flat", "cylinder")), (load, ("step", "static")), (solver, tuple(SOLVERS))
    for given, known in choices:
        if given not in known:
            raise ValueError(f"wanted one of {', '.join(known)}, got {given!r} in {name!r}")
    return Case(shape == "cylinder", load == "static", float(thickness), solver)


SOLVERS = {
    "adaptive": ("cg", "", True),
    "plain": ("cg", "", False),
    "feti": ("fetidp", "fetidp_bddc_", True),
}
"""Type of the solver, prefix of the options of BDDC, whether it is adaptive."""


def square(cells: tuple[int, int], curved: bool) -> dolfinx.mesh.Mesh:
    """Quadrilaterals of a square in 3D, without ghost cells, made on the first rank."""
    points, corners = np.empty((0, 3)), np.empty((0, 4), dtype=np.int64)
    if MPI.COMM_WORLD.rank == 0:
        m, n = cells
        x, y = np.meshgrid(np.arange(m + 1), np.arange(n + 1), indexing="ij")
        points = np.column_stack([x.ravel(), y.ravel(), 0 * x.ravel()]) / max(cells)
        if curved:
            angle = points[:, 0] / RADIUS
            points[:, 0], points[:, 2] = RADIUS * np.sin(angle), RADIUS * (1 - np.cos(angle))
        k = np.arange(points.shape[0]).reshape(m + 1, n + 1)
        corners = np.stack([k[:-1, :-1], k[1:, :-1], k[:-1, 1:], k[1:, 1:]], -1).reshape(-1, 4)
    element = basix.ufl.element("Lagrange", "quadrilateral", 1, shape=(3,))
    options = _compat.ghost_options(GhostMode.none)
    return dolfinx.mesh.create_mesh(MPI.COMM_WORLD, cells=corners, x=points, e=element, **options)


def tilt(q: NodalFrames, x: np.ndarray) -> None:
    """Turn frames to the normals of the cylinder."""
    angle = np.arctan2(x[:, 0], RADIUS - x[:, 2])
    c, s, zero = np.cos(angle), np.sin(angle), 0 * angle
    first, normal = np.column_stack([c, zero, s]), np.column_stack([-s, zero, c])
    q.frames[:, 1:] = np.stack([first, np.cross(normal, first), normal], axis=1)


def energy(q: NodalFrames, thickness: float, degree: int) -> ufl.Form:
    """Membrane, bending, shear and drilling energy of the unloaded position of all nodes."""
    mesh = q.function.function_space.mesh
    rest = fem.Function(q.function.function_space)
    rest.x.array[:] = q.function.x.array
    x0, d0 = (ufl.as_vector([rest[3 * k + j] for j in range(3)]) for k in (0, 3))
    e0 = ufl.as_vector([rest[6 + j] for j in range(3)])
    n0 = ufl.as_vector([rest[9 + j] for j in range(3)])
    d1, d2, d3 = q.directors
    F, B, F0, B0 = ufl.grad(q.position), ufl.grad(d3), ufl.grad(x0), ufl.grad(n0)
    membrane = (F.T * F - F0.T * F0) / 2
    bending = (F.T * B + B.T * F - F0.T * B0 - B0.T * F0) / 2
    shear = F.T * d3 - F0.T * n0
    t1, t2, s1, s2 = (A * e for A in (F, F0) for e in (d0, e0))
    drilling = ufl.dot(t1, d2) - ufl.dot(t2, d1) - ufl.dot(s1, e0) + ufl.dot(s2, d0)

    def plane(e: ufl.core.expr.Expr) -> ufl.core.expr.Expr:
        return E / (1 - NU**2) / 2 * (NU * ufl.tr(e) ** 2 + (1 - NU) * ufl.inner(e, e))

    G = E / 2 / (1 + NU)
    density = (
        thickness * plane(membrane)
        + thickness**3 / 12 * plane(bending)
        + G * thickness / 2 * (SHEAR * ufl.dot(shear, shear) + DRILLING * drilling**2)
    )
    return density * ufl.Measure("dx", domain=mesh, metadata={"quadrature_degree": degree})


def rigid_motions(q: NodalFrames, A: PETSc.Mat, owned: int) -> PETSc.NullSpace:
    """The six in the frames of nodes, orthonormal."""
    x, R = q.frames[:owned, 0], q.frames[:owned, 1:]
    found = []
    for k in range(6):
        twist = np.eye(6)[k]
        v = twist[:3] + np.cross(twist[3:], x)
        turn = R @ twist[3:]
        vector = A.createVecRight()
        vector.array[:] = np.hstack([np.einsum("nij,nj->ni", R, v), turn]).ravel()
        for other in found:
            vector.axpy(-vector.dot(other), other)
        vector.normalize()
        found.append(vector)
    return PETSc.NullSpace().create(vectors=found, comm=PETSc.COMM_WORLD)


def inertia(q: NodalFrames, thickness: float) -> np.ndarray:
    """Lumped, of this rank's cells alone, times that of accelerations in an implicit step."""
    space = q.increment.function_space
    constant = fem.functionspace(space.mesh, ("DG", 0))
    areas = fem.assemble_vector(fem.form(ufl.TestFunction(constant) * ufl.dx)).array
    stencil = space.dofmap.list
    lumped = np.zeros(len(q.frames))
    np.add.at(lumped, stencil, areas[: len(stencil), None] * LUMPS)
    arm = np.repeat([1.0, thickness**2 / 12], 3)
    alpha_m, alpha_f = 1 / 3, 4 / 9
    beta = (1 + alpha_f - alpha_m) ** 2 / 4
    factor = (1 - alpha_m) / (STEP**2 * beta * (1 - alpha_f))
    return factor * DENSITY * thickness * lumped[:, None] * arm


def matrix(q: NodalFrames, asked: Case, contrast: float) -> PETSc.Mat:
    """The tangent, as a sum over subdomains, every other of which is stiffer."""
    forms = local_frame_forms(energy(q, asked.thickness, 5 if asked.static else 3), q)
    n = 6 * len(q.frames)
    part = fem.assemble_matrix(forms.tangent).to_scipy(ghosted=True).tocsr()[:, :n]
    part = part * contrast ** (MPI.COMM_WORLD.rank % 2)
    return parts_summed(q, part, None if asked.static else inertia(q, asked.thickness))


def parts_summed(q: NodalFrames, part: sp.csr_matrix, diagonal: np.ndarray | None) -> PETSc.Mat:
    """The sum over all ranks of their parts, with what comes to the diagonals of these."""
    part.sort_indices()
    csr = part.indptr.astype(PETSc.IntType), part.indices.astype(PETSc.IntType), part.data
    local = PETSc.Mat().createAIJ(part.shape, csr=csr, comm=PETSc.COMM_SELF)
    local.setBlockSize(6)
    if diagonal is not None:
        both = local.getDiagonal()
        both.array[:] += diagonal.ravel()
        local.setDiagonal(both)
    nodes = q.increment.function_space.dofmap.index_map
    names = nodes.local_to_global(np.arange(len(q.frames), dtype=np.int32)).astype(np.int32)
    to_all = PETSc.LGMap().create(names, bsize=6, comm=PETSc.COMM_WORLD)
    A = PETSc.Mat().create(PETSc.COMM_WORLD)
    A.setSizes(((6 * nodes.size_local, 6 * nodes.size_global),) * 2)
    A.setBlockSize(6)
    A.setType("is")
    A.setLGMap(to_all, to_all)
    A.setISLocalMat(local)
    A.assemble()
    A.setOption(PETSc.Mat.Option.SYMMETRIC, True)
    A.setOption(PETSc.Mat.Option.SPD, True)
    return A


def solver(A: PETSc.Mat, asked: Case, threshold: float = THRESHOLD) -> PETSc.KSP:
    """Conjugate gradients with BDDC, or those of FETI-DP."""
    kind, prefix, adaptive = SOLVERS[asked.solver]
    ksp = PETSc.KSP().create(PETSc.COMM_WORLD)
    ksp.setOptionsPrefix(f"{asked.solver}_")
    ksp.setOperators(A)
    ksp.setType(kind)
    options = PETSc.Options(f"{asked.solver}_{prefix}")
    if adaptive:
        options["pc_bddc_use_deluxe_scaling"] = True
        options["pc_bddc_adaptive_threshold"] = threshold
    if kind == "fetidp":
        PETSc.Options(f"{asked.solver}_")["fetidp_ksp_type"] = "cg"
        options["pc_bddc_deluxe_singlemat"] = True
    else:
        ksp.getPC().setType("bddc")
    ksp.setComputeSingularValues(True)
    ksp.setTolerances(rtol=TOLERANCE, max_it=1000)
    ksp.setFromOptions()
    return ksp


def coarse(ksp: PETSc.KSP) -> str:
    """Number of primal unknowns, as PETSc reports it."""
    with tempfile.TemporaryDirectory() as folder:
        path = MPI.COMM_WORLD.bcast(f"{folder}/view.txt")
        viewer = PETSc.Viewer().createASCII(path, comm=PETSc.COMM_WORLD)
        ksp.view(viewer)
        viewer.flush()
        viewer.destroy()
        MPI.COMM_WORLD.barrier()
        found = re.search(r"coarse (\d+)", Path(path).read_text())
        MPI.COMM_WORLD.barrier()
    return found.group(1) if found else "–"


def megabytes() -> float:
    """Resident memory of this rank."""
    gc.collect()
    return int(Path("/proc/self/statm").read_text().split()[1]) / PAGES_PER_MB


def interface(q: NodalFrames) -> int:
    """Unknowns of nodes that several subdomains have."""
    nodes = q.increment.function_space.dofmap.index_map
    several = fem.Function(fem.functionspace(q.function.function_space.mesh, ("Lagrange", 2)))
    several.x.array[:] = 1.0
    several.x.scatter_reverse(la.InsertMode.add)
    shared = several.x.array[: nodes.size_local] > 1.5
    return 6 * int(MPI.COMM_WORLD.allreduce(int(shared.sum())))


def loaded(q: NodalFrames, A: PETSc.Mat, asked: Case) -> PETSc.Vec:
    """A load; a clamped edge is taken out of the matrix and of it."""
    space = q.increment.function_space
    nodes, x = space.dofmap.index_map, space.tabulate_dof_coordinates()
    load = np.zeros((nodes.size_local, 6))
    load[:, 2], load[:, 4] = 1 + x[: nodes.size_local, 0], 0.1
    if asked.static:
        edge = np.flatnonzero(np.isclose(x[: nodes.size_local, 0], 0.0))
        held = 6 * (nodes.local_range[0] + edge)[:, None] + np.arange(6)
        A.zeroRowsColumns(held.ravel().astype(np.int32), diag=E * asked.thickness)
        load[edge] = 0.0
    b = A.createVecRight()
    b.array[:] = load.ravel()
    return b


def run(
    name: str, cells: tuple[int, int], threshold: float = THRESHOLD, contrast: float = 1.0
) -> str:
    """One row."""
    world, asked = MPI.COMM_WORLD, case(name)
    q = NodalFrames(square(cells, asked.curved), 2)
    nodes = q.increment.function_space.dofmap.index_map
    if asked.curved:
        tilt(q, q.increment.function_space.tabulate_dof_coordinates())
    A = matrix(q, asked, contrast)
    b, found = loaded(q, A, asked), A.createVecRight()
    A.setNearNullSpace(rigid_motions(q, A, nodes.size_local))
    ksp, before = solver(A, asked, threshold), megabytes()
    begin = process_time()
    ksp.setUp()
    middle = process_time()
    ksp.solve(b, found)
    used = np.array([middle - begin, process_time() - middle, megabytes() - before])
    used = world.allreduce(used)
    reason = ksp.getConvergedReason()
    took = f"{ksp.getIterationNumber()}" if reason > 0 else f"fails ({reason})"
    condition = "–"
    if asked.solver != "feti" and reason > 0:
        most, least = ksp.computeExtremeSingularValues()
        condition = f"{most / least:.3g}"
    left = f"{(A * found - b).norm() / b.norm():.0e}"
    row = (world.size, name, 6 * nodes.size_global, interface(q), coarse(ksp), took, condition)
    ksp.destroy()
    A.destroy()
    PETSc.garbage_cleanup(PETSc.COMM_WORLD)
    given = (*row, left, f"{used[0]:.2f}", f"{used[1]:.2f}", f"{used[2]:.0f}")
    return "| " + " | ".join(map(str, given)) + " |"


def main() -> None:
    """Print rows."""
    asking = argparse.ArgumentParser(description=__doc__, allow_abbrev=False)
    asking.add_argument("--cells", type=int, nargs=2, required=True)
    asking.add_argument("--cases", nargs="+", default=["flat-step-0.01-adaptive"])
    asking.add_argument("--threshold", type=float, default=THRESHOLD)
    asking.add_argument("--contrast", type=float, default=1.0)
    asked = asking.parse_args()
    for name in asked.cases:
        row = run(name, tuple(asked.cells), asked.threshold, asked.contrast)
        if MPI.COMM_WORLD.rank == 0:
            print(row, flush=True)


if __name__ == "__main__":
    main()
