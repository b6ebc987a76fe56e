"""A Reissner-Mindlin shell with independent membrane and shear forces: the cantilever of Sze.

Nine nodes have positions and directors; membrane forces n and shear forces t are bilinear in each
cell and make

    W = integral of n . E - n . A^-1 n / 2 + t . gamma - |t|^2 / (2 G) + kappa . B kappa / 2

stationary. E is Green's membrane strain, kappa = sym(x,a . d3,b), gamma = x,a . d3; a small
stiffness holds the rotation about d3. Nothing locks, and the forces are iterates of their own.

A strip of 10 x 1 x 0.1 with E = 1.2e6, nu = 0 is bent by a force of 4 at its end to w = 6.698 and
u = 3.286. (K. Y. Sze, X. H. Liu, S. H. Lo, Finite Elem. Anal. Des. 40 (2004) 1551.)
"""

from __future__ import annotations

from typing import Any

import basix.ufl
import numpy as np
import ufl
from clamped import diagonal, end, load_steps, plate_strains, position, problem, strip
from dolfinx import fem

import fem_lie as fl

LENGTH, WIDTH, THICKNESS, E, FORCE = 10.0, 1.0, 0.1, 1.2e6, 4.0
EXACT = np.array([-3.286, 6.698])


def main(cells: int = 8, steps: int = 4) -> dict[str, Any]:
    msh = strip(cells, LENGTH, WIDTH)
    q = fl.NodalFrames(msh, degree=2)
    membrane, bending, shear, drilling = plate_strains(q)
    local = fem.Function(
        fem.functionspace(msh, basix.ufl.element("DQ", "quadrilateral", 1, shape=(5,)))
    )
    n, t = (ufl.as_vector([local[k] for k in part]) for part in ((0, 1, 2), (3, 4)))
    A, G = E * THICKNESS, 5 / 6 * E / 2 * THICKNESS
    B = diagonal(*(E * THICKNESS**3 / 12 * np.array([1.0, 1.0, 0.5])))
    flexibility = diagonal(1 / A, 1 / A, 2 / A)
    energy = ufl.inner(n, membrane) - ufl.inner(n, flexibility * n) / 2
    energy += ufl.inner(t, shear) - ufl.inner(t, t) / (2 * G)
    energy += ufl.inner(bending, B * bending) / 2 + 0.05 * A * drilling**2
    force = fem.Constant(msh, np.zeros(3))
    forms = [
        fl.local_frame_forms(energy * ufl.dx(msh, degree=4), q, local=local),
        fl.extend.dead_force(force, end(msh, LENGTH), q),
    ]
    iterations = load_steps(problem(q, forms), force, (0.0, 0.0, FORCE / WIDTH), steps)
    tip = position(q, (LENGTH, WIDTH / 2, 0.0)) - np.array([LENGTH, WIDTH / 2, 0.0])
    error = np.linalg.norm(tip[[0, 2]] - EXACT) / np.linalg.norm(EXACT)
    return {"tip": tip.tolist(), "tip_error": float(error), "iterations": iterations}


if __name__ == "__main__":
    print(main())
