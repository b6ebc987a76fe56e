"""An energy on the end of a line: a rotational spring that is periodic in the rotation.

A clamped beam has a spring at its end with the energy in the directors

    W = c (1 - d_1 . e_1) = c (1 - cos theta),

integrated by ds. A moment M at the end makes an arc of a circle with the end rotation theta,

    EI theta / L + c sin theta = M.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import ufl
from clamped import diagonal, end, line, load_steps, position, problem, simo_strains
from dolfinx import fem
from scipy.optimize import brentq

import fem_lie as fl

EI, SPRING, MOMENT = 1.0, 2.0, 2.5


def main(cells: int = 32) -> dict[str, Any]:
    msh = line(cells)
    q, ds = fl.NodalFrames(msh, degree=2), end(msh, 1.0)
    e, C = simo_strains(q), diagonal(1e4, 5e3, 5e3, EI, EI, EI)
    energy = fl.extend.StrainEnergy(e, lambda e: ufl.inner(e, C * e) / 2, ufl.dx(msh, degree=3))
    moment = fem.Constant(msh, np.zeros(3))
    forms = [
        fl.local_frame_forms(energy, q),
        fl.local_frame_forms(SPRING * (1 - q.directors[0][0]) * ds, q),
        fl.extend.dead_moment(moment, ds, q),
    ]
    iterations = load_steps(problem(q, forms), moment, (0.0, 0.0, MOMENT), steps=2)
    tip = position(q, (1.0, 0.0, 0.0))
    theta = brentq(lambda a: EI * a + SPRING * np.sin(a) - MOMENT, 0.0, np.pi)
    exact = np.array([np.sin(theta), 1 - np.cos(theta), 0.0]) / theta
    error = float(np.linalg.norm(tip - exact))
    return {"tip": tip.tolist(), "tip_error": error, "iterations": iterations}


if __name__ == "__main__":
    print(main())
