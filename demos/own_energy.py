"""A strip with a nonlinear section law of one's own, in a plain DOLFINx script.

The first of three ways to use fem_lie: no scene, no beam, no solver of ours. The energy of a beam
in positions x and directors d_1, d_2, d_3 of its nodes (R = [d_1 d_2 d_3]) is written in UFL,

    Gamma = R^T x' - e_1,    kappa = axial(R^T R'),    W = integral of w(Gamma, kappa) ds,

here with a strip that stiffens as it is bent,

    w = EA/2 Gamma_1^2 + GA/2 (Gamma_2^2 + Gamma_3^2)
        + GJ/2 kappa_1^2 + EI/2 (kappa_2^2 + kappa_3^2) + c/4 kappa_3^4,

and that is all that is said about it: FFCx differentiates and compiles, fem_lie takes the
derivatives into the local frames of the nodes, and DOLFINx assembles forces and tangent with six
unknowns per node, to be solved for increments H <- H exp(h). Three nodes per element and two
quadrature points: nothing locks.

Bent by a moment M at its tip the strip becomes an arc of the curvature that solves

    EI kappa + c kappa^3 = M,

an equation with one real root. The error against this closed form is of fourth order in the
elements' length.

A strain and a law (fl.StrainEnergy) say more than an energy: the stress can be carried as an
iterate (see rollup.py), and large steps converge for stiff sections, too. Both are run here.

Before that the forms are checked on random large deformations: the residual against differences
of the energy, the tangent against differences of the residual, and that neither feels a rigid
motion by 1000 rad and 1000 lengths.
"""

from __future__ import annotations

from math import asinh, pi, sinh, sqrt
from pathlib import Path
from typing import Any

from mpi4py import MPI
from petsc4py import PETSc

import basix.ufl
import numpy as np
import ufl
from command_line import in_results, run
from dolfinx import fem, la, mesh
from dolfinx.fem import petsc
from matplotlib.figure import Figure

import fem_lie as fl
from fem_lie import lie
from fem_lie.pictures.diagrams import COLOURS

show = PETSc.Sys.Print  # prints on one process only
LENGTH, BENDING, STIFFENING = 1.0, 1.0, 0.1  # L, EI, c
MOMENT = BENDING * 1.5 * pi + STIFFENING * (1.5 * pi) ** 3  # makes three quarters of a circle


def line(comm: MPI.Comm, elements: int) -> mesh.Mesh:
    """The x axis from 0 to the length, in space."""
    n = elements if comm.rank == 0 else 0
    x = np.zeros((n + 1 if n else 0, 3))
    x[:, 0] = np.linspace(0.0, LENGTH, len(x))
    cells = np.column_stack([np.arange(n), np.arange(1, n + 1)])
    interval = basix.ufl.element("Lagrange", "interval", 1, shape=(3,))
    return mesh.create_mesh(comm, cells=cells, x=x, e=interval)


def strip(
    msh: mesh.Mesh, stiffness_ratio: float, carried: bool = True
) -> tuple[fl.NodalFrames, fl.LocalFrameForms]:
    """The nodes' frames, and the forms of the energy in them."""
    q = fl.NodalFrames(msh, degree=2)
    stretch, kappa = fl.director_strains(q)
    strain = ufl.as_vector([stretch[0] - 1, stretch[1], stretch[2], *kappa])
    EA = fem.Constant(msh, stiffness_ratio * BENDING / LENGTH**2)
    EI = fem.Constant(msh, BENDING)
    c = fem.Constant(msh, STIFFENING)

    def law(s: ufl.core.expr.Expr) -> ufl.core.expr.Expr:
        axial = EA / 2 * (s[0] ** 2 + s[1] ** 2 / 2 + s[2] ** 2 / 2)
        return axial + EI / 2 * (s[3] ** 2 + s[4] ** 2 + s[5] ** 2) + c / 4 * s[5] ** 4

    dx = ufl.Measure("dx", domain=msh, metadata={"quadrature_degree": 3})
    energy = fl.StrainEnergy(strain, law, dx)
    return q, fl.local_frame_forms(energy if carried else energy.form(), q)


# --- equilibrium ----------------------------------------------------------------------------------


class Cantilever:
    """Newton's method on the group, in twenty lines of PETSc."""

    def __init__(self, q: fl.NodalFrames, forms: fl.LocalFrameForms) -> None:
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
            self.forms.carry()  # the stress, before its configuration changes
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


def exact_curvature(moment: float) -> float:
    """The real root of EI kappa + c kappa^3 = M."""
    scale = sqrt(BENDING / (3 * STIFFENING))
    return 2 * scale * sinh(asinh(1.5 * moment / (BENDING * scale)) / 3)


def exact_position(moment: float, s: float | np.ndarray = LENGTH) -> np.ndarray:
    kappa = exact_curvature(moment)
    return np.array([np.sin(kappa * s), 1 - np.cos(kappa * s), 0 * s]) / kappa


def bend(
    elements: int, load_steps: int, stiffness_ratio: float, carried: bool = True
) -> tuple[Cantilever, list[int], list[np.ndarray]]:
    """Apply the moment in equal steps; iterations and shape of each, ended by one that fails."""
    beam = Cantilever(*strip(line(MPI.COMM_WORLD, elements), stiffness_ratio, carried))
    iterations, curves = [], [beam.curve()]
    for step in range(1, load_steps + 1):
        iterations.append(beam.solve(MOMENT * step / load_steps))
        curves.append(beam.curve())
        if iterations[-1] == 0:
            break
    return beam, iterations, curves


# --- checks of the forms --------------------------------------------------------------------------


def checks(seed: int = 1) -> dict[str, float]:
    """Errors of derivatives and of invariance on a random large deformation, relative."""
    rng = np.random.default_rng(seed)
    q, forms = strip(line(MPI.COMM_SELF, 3), stiffness_ratio=10.0)
    n = len(q.frames)
    start = lie.se3_retract(q.frames, rng.normal(size=(n, 6)) * ([0.3] * 3 + [1.0] * 3))

    def at(frames: np.ndarray, form: str) -> np.ndarray:
        q.frames[:] = frames
        if form == "energy":
            return np.array(fem.assemble_scalar(forms.energy))
        if form == "residual":
            return fem.assemble_vector(forms.residual).array
        q.increment.x.array[:] = 0.0
        forms.carry()  # by no increment: the carried stress is the true one
        return fem.assemble_matrix(forms.tangent).to_dense()

    def differences(form: str, step: float) -> np.ndarray:
        """Derivative in all increments, of fourth order."""
        columns = []
        for unit in np.eye(6 * n).reshape(-1, n, 6):
            f = [at(lie.se3_retract(start, k * step * unit), form) for k in (-2, -1, 1, 2)]
            columns.append((f[0] - 8 * f[1] + 8 * f[2] - f[3]) / (12 * step))
        return np.array(columns).T

    residual, tangent = at(start, "residual"), at(start, "tangent")
    far = lie.frame(
        1000.0 * LENGTH * np.array([0.6, 0.0, 0.8]), lie.so3_exp([600.0, -640.0, 480.0])
    )
    moved = lie.se3_compose(far, start)
    return {
        "gradient_error": error(differences("energy", 1e-3), residual),
        "tangent_error": error(differences("residual", 1e-3), tangent),
        "invariance_error": max(
            error(at(moved, "residual"), residual), error(at(moved, "tangent"), tangent)
        ),
        "residual_largest": float(np.abs(residual).max()),
        "tangent_largest": float(np.abs(tangent).max()),
    }


def error(values: np.ndarray, reference: np.ndarray) -> float:
    return float(np.abs(values - reference).max() / np.abs(reference).max())


# --- the whole ------------------------------------------------------------------------------------


def converge(elements: int, load_steps: int, stiffness_ratio: float) -> dict[str, Any]:
    """Tip against the closed form on three meshes."""
    exact = exact_position(MOMENT)
    tips, errors = [], []
    for count in (max(1, elements // 2), elements, 2 * elements):
        beam, _, _ = bend(count, load_steps, stiffness_ratio)
        tips.append(beam.tip_position())
        errors.append(float(np.linalg.norm(tips[-1] - exact) / LENGTH))
    return {
        **{f"tip_{axis}": float(value) for axis, value in zip("xyz", tips[1], strict=True)},
        "tip_error": errors[1],
        "order": float(np.log2(errors[1] / errors[2])),
    }


def main(
    elements: int = 16,
    load_steps: int = 6,
    stiffness_ratio: float = 1e6,
    pictures: bool = True,
) -> dict[str, Any]:
    record: dict[str, Any] = {
        "elements": elements,
        "load_steps": load_steps,
        "stiffness_ratio": stiffness_ratio,
        **checks(),
    }
    record |= converge(elements, load_steps, stiffness_ratio)
    _, iterations, curves = bend(elements, load_steps, stiffness_ratio)
    _, plain, _ = bend(elements, load_steps, stiffness_ratio, carried=False)
    record |= {
        "iterations": sum(iterations),
        "iterations_per_step": sum(iterations) / load_steps,
        "plain_converged": 0 not in plain,
    }
    if pictures and MPI.COMM_WORLD.size == 1:
        path = in_results("own_energy.png")
        draw(curves, path)
    return record


def draw(curves: list[np.ndarray], path: Path) -> None:
    """Nodes at all load steps on the exact arcs."""
    figure = Figure(figsize=(6.4, 4.1), dpi=150, layout="constrained")
    axes = figure.subplots()
    s = np.linspace(0.0, LENGTH, 200)
    steps = len(curves) - 1
    for step, curve in enumerate(curves):
        x, y, _ = exact_position(MOMENT * step / steps, s) if step else (s, 0 * s, None)
        axes.plot(x, y, color="black", linewidth=0.8, label="" if step else "closed form")
        label = "" if step else "nodes of the elements"
        axes.plot(curve[:, 0], curve[:, 1], "o", color=COLOURS[0], markersize=3.5, label=label)
    axes.set_aspect("equal")
    axes.set(xlabel="x / L", ylabel="y / L", title="A strip that stiffens as it is bent")
    axes.grid(color="#DDDDDD", linewidth=0.6)
    axes.legend(frameon=False)
    figure.savefig(path)


if __name__ == "__main__":
    run(main, show=True)
