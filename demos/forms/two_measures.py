"""Two energies on two parts of one mesh, dx(1) and dx(2): a stepped beam that a moment bends.

Each part bends to an arc of its own curvature, kappa_k = M / EI_k: the first to the angle
theta_1 = kappa_1 L / 2, where the second begins.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import ufl
from clamped import diagonal, end, line, load_steps, position, problem, simo_strains
from dolfinx import fem, mesh

import fem_lie as fl

BENDING, MOMENT = {1: 2.0, 2: 1.0}, 2.0


def main(cells: int = 32) -> dict[str, Any]:
    msh = line(cells)
    q = fl.NodalFrames(msh, degree=2)
    owned = msh.topology.index_map(1).size_local
    numbers = np.arange(owned, dtype=np.int32)
    far = mesh.compute_midpoints(msh, 1, numbers)[:, 0] > 0.5
    parts = mesh.meshtags(msh, 1, numbers, np.where(far, 2, 1).astype(np.int32))
    dx = ufl.Measure("dx", domain=msh, subdomain_data=parts, metadata={"quadrature_degree": 3})
    e, forms = simo_strains(q), []
    for tag, EI in BENDING.items():
        C = diagonal(1e4, 5e3, 5e3, EI, EI, EI)
        energy = fl.extend.StrainEnergy(e, lambda e, C=C: ufl.inner(e, C * e) / 2, dx(tag))
        forms.append(fl.local_frame_forms(energy, q))
    moment = fem.Constant(msh, np.zeros(3))
    forms.append(fl.extend.dead_moment(moment, end(msh, 1.0), q))
    iterations = load_steps(problem(q, forms), moment, (0.0, 0.0, MOMENT), steps=2)

    exact, angle = np.zeros(3), 0.0
    for EI in BENDING.values():
        kappa, start = MOMENT / EI, angle
        angle += kappa / 2
        exact += np.array([np.sin(angle) - np.sin(start), np.cos(start) - np.cos(angle), 0]) / kappa
    tip = position(q, (1.0, 0.0, 0.0))
    error = float(np.linalg.norm(tip - exact))
    return {"tip": tip.tolist(), "tip_error": error, "iterations": iterations}


if __name__ == "__main__":
    print(main())
