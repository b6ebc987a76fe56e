"""A force that is fixed in space, with its tangent: the elastica.

Residuals are along nodal frames, where a force f fixed in space has components R^T f, which change
with the rotation: the tangent has -[R^T f]x, without which Newton's method does not converge
quadratically. `fl.extend.dead_force` is the virtual work of f, from which both follow.

A force F = alpha EI / L^2 across the end of a clamped, inextensible beam deflects it as tabulated
by K. Mattiasson, IJNME 17 (1981) 145, by elliptic integrals; alpha = 10: u = 0.55500 L,
w = 0.81061 L.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import ufl
from clamped import diagonal, end, line, load_steps, position, problem, simo_strains
from dolfinx import fem

import fem_lie as fl

ALPHA, EXACT = 10.0, np.array([1 - 0.55500, 0.0, 0.81061])
EA = 1e8  # EI = 1: nearly inextensible and rigid in shear


def main(cells: int = 16, steps: int = 4) -> dict[str, Any]:
    msh = line(cells)
    q = fl.NodalFrames(msh, degree=2)
    e, C = simo_strains(q), diagonal(EA, EA, EA, 1.0, 1.0, 1.0)
    energy = fl.extend.StrainEnergy(e, lambda e: ufl.inner(e, C * e) / 2, ufl.dx(msh, degree=3))
    force = fem.Constant(msh, np.zeros(3))
    forms = [fl.local_frame_forms(energy, q), fl.extend.dead_force(force, end(msh, 1.0), q)]
    iterations = load_steps(problem(q, forms), force, (0.0, 0.0, ALPHA), steps)
    tip = position(q, (1.0, 0.0, 0.0))
    error = float(np.linalg.norm(tip - EXACT))
    return {"tip": tip.tolist(), "tip_error": error, "iterations": iterations}


if __name__ == "__main__":
    print(main())
