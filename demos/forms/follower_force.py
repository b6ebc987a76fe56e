"""A force that follows the end of a beam.

Its components along the directors are constant. It has no energy: `fl.extend.follower_force` is
its virtual work, with the (unsymmetric) tangent.

Let psi be the angle between the end and the section at the distance s from it. A force P across
the end gives EI psi'' = P cos(psi) with psi = psi' = 0 at s = 0: an initial value problem, whose
solution is the inextensible beam. (J. H. Argyris, S. Symeonidis, CMAME 26 (1981) 75.)
"""

from __future__ import annotations

from typing import Any

import numpy as np
import ufl
from clamped import diagonal, end, line, load_steps, position, problem, simo_strains
from dolfinx import fem
from scipy.integrate import solve_ivp

import fem_lie as fl

FORCE, EA = 10.0, 1e8  # EI = L = 1


def exact() -> np.ndarray:
    """End of the beam whose other end is clamped along the x axis."""

    def rates(s: float, y: np.ndarray) -> list[float]:
        return [y[1], FORCE * np.cos(y[0]), np.cos(y[0]), np.sin(y[0])]

    angle, _, along, across = solve_ivp(rates, (0, 1), np.zeros(4), rtol=1e-11, atol=1e-12).y[:, -1]
    # from the axes of the end into those of the clamp
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * along + s * across, s * along - c * across, 0.0])


def main(cells: int = 16, steps: int = 4) -> dict[str, Any]:
    msh = line(cells)
    q = fl.NodalFrames(msh, degree=2)
    e, C = simo_strains(q), diagonal(EA, EA, EA, 1.0, 1.0, 1.0)
    energy = fl.extend.StrainEnergy(e, lambda e: ufl.inner(e, C * e) / 2, ufl.dx(msh, degree=3))
    force = fem.Constant(msh, np.zeros(3))
    forms = [fl.local_frame_forms(energy, q), fl.extend.follower_force(force, end(msh, 1.0), q)]
    iterations = load_steps(problem(q, forms), force, (0.0, FORCE, 0.0), steps)
    tip = position(q, (1.0, 0.0, 0.0))
    error = float(np.linalg.norm(tip - exact()))
    return {"tip": tip.tolist(), "tip_error": error, "iterations": iterations}


if __name__ == "__main__":
    print(main())
