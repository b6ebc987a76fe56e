"""A beam with independent stress resultants, by Hellinger-Reissner: the elastica.

The energy of strains eps(y) and resultants s that are constant in each two-node element,

    W = integral of s . eps - s . C^-1 s / 2,

is stationary in s. The kernels condense s cell by cell; Newton's method sees six unknowns per node.
With one quadrature point it has the solution of the displacement element, but not its tangent: the
resultants are an iterate of their own, and few iterations are needed for stiff sections.

Reference: K. Mattiasson, IJNME 17 (1981) 145, for a force of 10 EI/L^2 across the end:
u = 0.55500 L, w = 0.81061 L. Two-node elements are of second order.
"""

from __future__ import annotations

from typing import Any

import basix.ufl
import numpy as np
import ufl
from clamped import diagonal, end, line, load_steps, position, problem, simo_strains
from dolfinx import fem

import fem_lie as fl

EXACT, EA = np.array([1 - 0.55500, 0.0, 0.81061]), 1e6


def bend(cells: int, steps: int, mixed: bool) -> tuple[np.ndarray, int]:
    """End of the beam, and iterations."""
    msh = line(cells)
    q, dx = fl.NodalFrames(msh), ufl.dx(msh, degree=0)
    e, section = simo_strains(q), (EA, EA, EA, 1.0, 1.0, 1.0)
    if mixed:
        element = basix.ufl.element("DG", "interval", 0, shape=(6,))
        s = fem.Function(fem.functionspace(msh, element))
        flexibility = diagonal(*(1 / stiffness for stiffness in section))
        energy = (ufl.inner(s, e) - ufl.inner(s, flexibility * s) / 2) * dx
        beam = fl.local_frame_forms(energy, q, local=s)
    else:
        beam = fl.local_frame_forms(ufl.inner(e, diagonal(*section) * e) / 2 * dx, q)
    force = fem.Constant(msh, np.zeros(3))
    load = fl.extend.dead_force(force, end(msh, 1.0), q)
    iterations = load_steps(problem(q, [beam, load]), force, (0.0, 0.0, 10.0), steps)
    return position(q, (1.0, 0.0, 0.0)), iterations


def main(cells: int = 32, steps: int = 4) -> dict[str, Any]:
    tip, iterations = bend(cells, steps, mixed=True)
    finer, _ = bend(2 * cells, steps, mixed=True)
    plain, plain_iterations = bend(cells, 5 * steps, mixed=False)
    errors = [float(np.linalg.norm(x - EXACT)) for x in (tip, finer)]
    return {
        "tip": tip.tolist(),
        "tip_error": errors[0],
        "ratio_of_errors": errors[0] / errors[1],
        "difference_to_displacement": float(np.linalg.norm(tip - plain)),
        "iterations": iterations,
        "plain_iterations": plain_iterations,
    }


if __name__ == "__main__":
    print(main())
