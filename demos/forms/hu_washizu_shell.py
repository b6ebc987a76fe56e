"""A Reissner-Mindlin shell by Hu-Washizu with a law of one's own.

Strains e = (membrane, bending, shear) and resultants s, all bilinear in each nine-node cell, make

    W = integral of w(e) + s . (eps(y) - e)

stationary. The law w stiffens in bending along the strip,

    w = A |E|^2/2 + B |kappa|^2/2 + c kappa_11^4/4 + G |gamma|^2/2,

so that a moment m per width at its end bends it to an arc of the curvature that solves
B kappa + c kappa^3 = m. The kernels condense 64 unknowns per cell.
"""

from __future__ import annotations

from typing import Any

import basix.ufl
import numpy as np
import ufl
from clamped import end, load_steps, plate_strains, position, problem, strip
from dolfinx import fem
from scipy.optimize import brentq

import fem_lie as fl

LENGTH, WIDTH, MOMENT = 10.0, 1.0, 0.4
A, G, B, C = 1e4, 4e3, 1.0, 10.0


def law(e: ufl.core.expr.Expr) -> ufl.core.expr.Expr:
    """Energy per area."""
    stiffness = ufl.diag(ufl.as_vector([A, A, A / 2, B, B, B / 2, G, G]))
    return ufl.inner(e, stiffness * e) / 2 + C / 4 * e[3] ** 4


def main(cells: int = 8, steps: int = 4) -> dict[str, Any]:
    msh = strip(cells, LENGTH, WIDTH)
    q = fl.NodalFrames(msh, degree=2)
    membrane, bending, shear, drilling = plate_strains(q)
    part = basix.ufl.element("DQ", "quadrilateral", 1, shape=(8,))
    local = fem.Function(fem.functionspace(msh, basix.ufl.mixed_element([part, part])))
    s, e = ufl.split(local)
    energy = law(e) + ufl.inner(s, ufl.as_vector([*membrane, *bending, *shear]) - e)
    energy += 0.05 * A * drilling**2
    moment = fem.Constant(msh, np.zeros(3))
    forms = [
        fl.local_frame_forms(energy * ufl.dx(msh, degree=4), q, local=local),
        fl.extend.dead_moment(moment, end(msh, LENGTH), q),
    ]
    iterations = load_steps(problem(q, forms), moment, (0.0, -MOMENT, 0.0), steps)
    tip = position(q, (LENGTH, WIDTH / 2, 0.0))
    kappa = brentq(lambda k: B * k + C * k**3 - MOMENT, 0.0, MOMENT / B)
    angle = kappa * LENGTH
    exact = np.array([np.sin(angle) / kappa, WIDTH / 2, (1 - np.cos(angle)) / kappa])
    error = float(np.linalg.norm(tip - exact) / LENGTH)
    return {"tip": tip.tolist(), "tip_error": error, "iterations": iterations}


if __name__ == "__main__":
    print(main())
