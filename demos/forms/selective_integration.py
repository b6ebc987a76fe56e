"""Selective integration with three degrees in one energy: a slender beam that would lock.

Two-node elements with bending integrated to degree 2, shear to degree 0 and stretching to
degree 1. A small dead force at the end bends it by w = F L^3 / (3 EI) + F L / GA. With all terms
integrated to degree 2, shear locks: w falls by the factor 1 + GA h^2 / (12 EI).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import ufl
from clamped import end, line, load_steps, position, problem, simo_strains
from dolfinx import fem

import fem_lie as fl

EA, GA, EI, FORCE = 1e4, 5e3, 1.0, 1e-4


def deflection(cells: int, shear: int) -> float:
    """Deflection of the end with shear integrated to a degree."""
    msh = line(cells)
    q = fl.NodalFrames(msh)
    e, dx = simo_strains(q), ufl.Measure("dx", domain=msh)
    energy = EI / 2 * ufl.inner(e[3], e[3]) * dx(degree=2)
    for k, stiffness, degree in ((0, EA, 1), (1, GA, shear), (2, GA, shear)):
        energy += stiffness / 2 * e[k] ** 2 * dx(degree=degree)
    energy += EI / 2 * (e[4] ** 2 + e[5] ** 2) * dx(degree=2)
    force = fem.Constant(msh, np.zeros(3))
    forms = [fl.local_frame_forms(energy, q), fl.extend.dead_force(force, end(msh, 1.0), q)]
    load_steps(problem(q, forms), force, (0.0, 0.0, FORCE), steps=1)
    return float(position(q, (1.0, 0.0, 0.0))[2])


def main(cells: int = 16) -> dict[str, Any]:
    exact = FORCE / (3 * EI) + FORCE / GA
    w, locked = deflection(cells, shear=0), deflection(cells, shear=2)
    return {
        "deflection": w,
        "error": abs(w / exact - 1),
        "locking": exact / locked,
        "expected_locking": 1 + GA / (12 * EI * cells**2),
    }


if __name__ == "__main__":
    print(main())
