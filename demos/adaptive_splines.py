"""A thin plate under a force at one point, on splines that are refined where the error is.

A square plate of side a, hinged all around, carries a force F in its middle. Without shear its
deflection is Navier's series (S. Timoshenko & S. Woinowsky-Krieger, Theory of plates and shells,
1959, § 34), whose inner sum is a closed form::

    w = 4 F a²/(π⁴ B) Σ_m Σ_n 1/(m² + n²)²,                          m, n odd
    Σ_n 1/(m² + n²)² = π/(8 m³) tanh(πm/2) − π²/(16 m²) / cosh²(πm/2)

Curvatures grow towards the force as a logarithm, without bound. A bicubic with continuous slopes
has an error of the energy norm of h² where the solution is smooth; on equal cells of size h here it
is h, with N unknowns N^(−1/2). Cells that are cut in four where the estimate says get N⁻¹ back.

Functions on cells of several sizes are the truncated ones of hierarchical splines (C. Giannelli,
B. Jüttler & H. Speleers, CAGD 29 (2012) 485). The error is found without knowledge of the series,
from recovered moments; it is compared to the true one, ``√(1 − w_h/w)``, of the energy.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import in_results, run
from scipy.special import zeta

import fem_lie as fl

FORCE = 1e-3
SECTION = fl.ShellSection.layer(0.01, fl.Material(2e11, 0.3, 7800.0))
EDGES = "a=0", "a=1", "b=0", "b=1"


def square(cells: int) -> fl.mesh.SplineMesh:
    """Of side 1."""
    return fl.mesh.spline_mesh(fl.mesh.smooth_patch(lambda a, b: (a, b, 0.0), (cells, cells)))


def middle(shell: fl.ThinShell) -> int:
    """The point under the force."""
    away = np.linalg.norm(shell.frames[: shell.model.points_count, 0] - [0.5, 0.5, 0.0], axis=1)
    return int(away.argmin())


def plate(mesh: fl.mesh.SplineMesh) -> fl.Scene:
    """Hinged, on any mesh."""
    scene = fl.Scene()
    shell = scene.add(fl.ThinShell(mesh, SECTION, name="plate"))
    for edge in EDGES:
        shell.hinge(edge)
    scene.add(fl.PointLoad(shell.point(middle(shell)), force=(0.0, 0.0, FORCE)))
    return scene


def deflection() -> float:
    """Navier's."""
    m = np.arange(1.0, 60.0, 2.0)
    t = np.tanh(0.5 * np.pi * m)
    # less what the sum of all 1/m³ has
    rest = np.pi / (8 * m**3) * (t - 1.0) - np.pi**2 / (16 * m**2) * (1.0 - t * t)
    total = rest.sum() + np.pi / 8 * 7 / 8 * zeta(3.0)
    return float(4.0 * FORCE / (np.pi**4 * SECTION.stiffness[3, 3]) * total)


def true_error(scene: fl.Scene, result: fl.StaticResult) -> float:
    """Relative, in the energy norm: twice the energy is the work of the force."""
    found = result.frames[-1][middle(scene.bodies[0]), 0, 2]
    return float(np.sqrt(1.0 - found / deflection()))


def equal(cells: int) -> tuple[int, float]:
    """Unknowns and true error of equal cells."""
    scene = plate(square(cells))
    return 6 * len(scene.bodies[0].frames), true_error(scene, fl.statics(scene))


def main(tolerance: float = 0.003, cells: int = 8, pictures: bool = True) -> dict[str, Any]:
    found = fl.adaptivity.adapt(plate, square(cells), tolerance=tolerance)
    error = true_error(found.scene, found.result)
    first, second = equal(2 * cells), equal(4 * cells)
    half = len(found.meshes) // 2
    path = np.log(found.unknowns[half:]), np.log(found.relative[half:])
    if pictures:
        found.error.picture(in_results("adaptive_splines.png"))
    return {
        "error": error,
        "effectivity": float(found.relative[-1]) / error,
        "unknowns": int(found.unknowns[-1]),
        "cells": len(found.mesh.cells),
        "sizes": len(np.unique(found.mesh.levels)),
        "order": float(np.polyfit(*path, 1)[0]),
        "unknowns_equal": second[0],
        "error_equal": second[1],
        "order_equal": float(np.log(second[1] / first[1]) / np.log(second[0] / first[0])),
    }


if __name__ == "__main__":
    run(main, show=True)
