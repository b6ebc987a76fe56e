"""A beam with independent strains and resultants, by Hu-Washizu, and a law of one's own.

Strains e and resultants s, constant in each two-node element, make

    W = integral of w(e) + s . (eps(y) - e)

stationary; the law w needs no inverse. Here it stiffens in bending,

    w = EA e_1^2/2 + GA (e_2^2 + e_3^2)/2 + EI |kappa|^2/2 + c kappa_3^4/4.

Bent by a moment M at its end the beam becomes an arc of the curvature that solves
EI kappa + c kappa^3 = M.
"""

from __future__ import annotations

from typing import Any

import basix.ufl
import numpy as np
import ufl
from clamped import end, line, load_steps, position, problem, simo_strains
from dolfinx import fem
from scipy.optimize import brentq

import fem_lie as fl

EA, EI, C, MOMENT = 1e4, 1.0, 0.1, 4.0


def law(e: ufl.core.expr.Expr) -> ufl.core.expr.Expr:
    """Energy per length."""
    axial = EA / 2 * (e[0] ** 2 + (e[1] ** 2 + e[2] ** 2) / 2)
    return axial + EI / 2 * (e[3] ** 2 + e[4] ** 2 + e[5] ** 2) + C / 4 * e[5] ** 4


def bend(cells: int, steps: int) -> tuple[np.ndarray, int]:
    """End of the beam, and iterations."""
    msh = line(cells)
    q = fl.NodalFrames(msh)
    part = basix.ufl.element("DG", "interval", 0, shape=(6,))
    local = fem.Function(fem.functionspace(msh, basix.ufl.mixed_element([part, part])))
    s, e = ufl.split(local)
    energy = (law(e) + ufl.inner(s, simo_strains(q) - e)) * ufl.dx(msh, degree=0)
    moment = fem.Constant(msh, np.zeros(3))
    forms = [
        fl.local_frame_forms(energy, q, local=local),
        fl.extend.dead_moment(moment, end(msh, 1.0), q),
    ]
    iterations = load_steps(problem(q, forms), moment, (0.0, 0.0, MOMENT), steps)
    return position(q, (1.0, 0.0, 0.0)), iterations


def main(cells: int = 32, steps: int = 4) -> dict[str, Any]:
    kappa = brentq(lambda k: EI * k + C * k**3 - MOMENT, 0.0, MOMENT / EI)
    exact = np.array([np.sin(kappa), 1 - np.cos(kappa), 0.0]) / kappa
    (tip, iterations), (finer, _) = bend(cells, steps), bend(2 * cells, steps)
    errors = [float(np.linalg.norm(x - exact)) for x in (tip, finer)]
    return {
        "tip": tip.tolist(),
        "tip_error": errors[0],
        "ratio_of_errors": errors[0] / errors[1],
        "iterations": iterations,
    }


if __name__ == "__main__":
    print(main())
