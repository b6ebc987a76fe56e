"""A strip with a nonlinear user-defined section law, in a plain DOLFINx script.

The first of three ways to use fem_lie: no scene, no beam, PETSc's Newton method. The energy of a
beam in positions x and directors d_1, d_2, d_3 of its nodes (R = [d_1 d_2 d_3]) is written in UFL,

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

A strain and a law (fl.extend.StrainEnergy) say more than an energy: the stress can be carried as an
iterate (see rollup.py), and large steps converge for stiff sections, too. Both are run here.

Before that the forms are checked on random large deformations: the residual against differences
of the energy, the tangent against differences of the residual, and that neither feels a rigid
motion by 1000 rad and 1000 lengths.
"""

from __future__ import annotations

from math import pi
from typing import Any

from mpi4py import MPI

import numpy as np
import ufl
from command_line import run
from dolfinx import fem, mesh
from forms.clamped import end, line, position, problem
from records import components
from reference.derivatives import checks
from reference.stiffening_strip import position as exact_position
from strip_pictures import draw

import fem_lie as fl

LENGTH = 1.0
STRIP = BENDING, STIFFENING = 1.0, 0.1  # EI, c
MOMENT = BENDING * 1.5 * pi + STIFFENING * (1.5 * pi) ** 3  # makes three quarters of a circle


def strip(
    msh: mesh.Mesh, stiffness_ratio: float, carried: bool = True
) -> tuple[fl.NodalFrames, fl.extend.LocalFrameForms]:
    """The nodes' frames, and the forms of the energy in them."""
    q = fl.NodalFrames(msh, degree=2)
    stretch, kappa = fl.elements.director_strains(q)
    strain = ufl.as_vector([stretch[0] - 1, stretch[1], stretch[2], *kappa])
    EA = fem.Constant(msh, stiffness_ratio * BENDING / LENGTH**2)
    EI, c = (fem.Constant(msh, value) for value in STRIP)

    def law(s: ufl.core.expr.Expr) -> ufl.core.expr.Expr:
        axial = EA / 2 * (s[0] ** 2 + s[1] ** 2 / 2 + s[2] ** 2 / 2)
        return axial + EI / 2 * (s[3] ** 2 + s[4] ** 2 + s[5] ** 2) + c / 4 * s[5] ** 4

    dx = ufl.Measure("dx", domain=msh, metadata={"quadrature_degree": 3})
    energy = fl.extend.StrainEnergy(strain, law, dx)
    return q, fl.local_frame_forms(energy if carried else energy.form(), q)


def bend(
    elements: int, load_steps: int, stiffness_ratio: float, carried: bool = True
) -> tuple[fl.NodalFrames, list[int], list[np.ndarray]]:
    """Apply the moment in equal steps; iterations and shape of each, ended by one that fails."""
    msh = line(elements, LENGTH)
    q, forms = strip(msh, stiffness_ratio, carried)
    moment = fem.Constant(msh, (0.0, 0.0, 0.0))
    equilibrium = problem(q, [forms, fl.extend.dead_moment(moment, end(msh, LENGTH), q)])
    snes = equilibrium.snes()
    snes.setTolerances(rtol=0.0, atol=1e-9, stol=1e-9, max_it=30)
    iterations, curves = [], [curve(q)]
    for step in range(1, load_steps + 1):
        moment.value[2] = MOMENT * step / load_steps
        snes.solve(None, equilibrium.x.x.petsc_vec)
        converged = snes.getConvergedReason() > 0
        iterations.append(snes.getIterationNumber() if converged else 0)
        curves.append(curve(q))
        if not converged:
            break
    return q, iterations, curves


def curve(q: fl.NodalFrames) -> np.ndarray:
    """Positions of this process's nodes in their order along the strip."""
    x = q.increment.function_space.tabulate_dof_coordinates()[:, 0]
    return q.frames[np.argsort(x), 0].copy()


def main(
    elements: int = 16, load_steps: int = 6, stiffness_ratio: float = 1e6, pictures: bool = True
) -> dict[str, Any]:
    exact = exact_position(MOMENT, LENGTH, *STRIP)
    q, iterations, curves = bend(elements, load_steps, stiffness_ratio)
    finer, _, _ = bend(2 * elements, load_steps, stiffness_ratio)
    _, plain, _ = bend(elements, load_steps, stiffness_ratio, carried=False)
    tip, finer_tip = (position(f, (LENGTH, 0.0, 0.0)) for f in (q, finer))
    gaps = [float(np.linalg.norm(x - exact) / LENGTH) for x in (tip, finer_tip)]
    if pictures and MPI.COMM_WORLD.size == 1:
        s = np.linspace(0.0, LENGTH, 200)
        draw(curves, lambda share: exact_position(share * MOMENT, s, *STRIP))
    return {
        "elements": elements,
        "load_steps": load_steps,
        "stiffness_ratio": stiffness_ratio,
        **checks(*strip(line(3, comm=MPI.COMM_SELF), stiffness_ratio=10.0)),
        **components("tip", tip),
        "tip_error": gaps[0],
        "order": float(np.log2(gaps[0] / gaps[1])),
        "iterations": sum(iterations),
        "iterations_per_step": sum(iterations) / load_steps,
        "plain_converged": 0 not in plain,
    }


if __name__ == "__main__":
    run(main, show=True)
