"""A mesh that follows the error: a pinched cylinder.

It is pinched between two diaphragms by two unit forces, R = 300, L = 600, t = 3, E = 3e6, nu = 0.3
(T. Belytschko et al., CMAME 51 (1985) 221), an eighth of it is solved. Under a force on one point a
shell with shear moves ever further as its mesh is refined, so it is spread over a pad of 60 x 94.
The goal is the deflection in the middle of the pad.

How the mesh is refined is shown by adaptive_shell.py.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from adaptive_shell import Case, study
from command_line import run

import fem_lie as fl

RADIUS, CELLS = 300.0, 10


def on_cylinder(x: np.ndarray) -> np.ndarray:
    """The place on the cylinder about x that is nearest."""
    return np.array([x[0], *(RADIUS * x[1:] / np.hypot(*x[1:]))])


def eighth() -> fl.SurfaceMesh:
    """From the force to the side, and from mid-length to a diaphragm."""

    def place(a: float, b: float) -> np.ndarray:
        angle = a * np.pi / 2
        return RADIUS * np.array([b, -np.sin(angle), np.cos(angle)])

    mesh = fl.surface(place, (CELLS, CELLS), cell="triangle")
    return replace(mesh, groups={"pad": np.flatnonzero((mesh.cells == 0).any(axis=1))})


def pinched_cylinder(mesh: fl.SurfaceMesh) -> fl.Scene:
    """An eighth, with a quarter of a force."""
    section = fl.ShellSection.layer(3.0, fl.Material(3e6, 0.3, 1.0))
    shell = fl.Shell(
        mesh,
        section,
        director=lambda x: np.array([0.0, *x[1:]]) / np.hypot(*x[1:]),
        name="cylinder",
    )
    shell.symmetry("b=0", (1, 0, 0))
    shell.symmetry("a=0", (0, 1, 0))
    shell.symmetry("a=1", (0, 0, 1))
    for direction in ((0, 1, 0), (0, 0, 1)):
        shell.guide("b=1", direction)
    scene = fl.Scene()
    scene.add(shell)
    pad = RADIUS * np.pi / 2 * RADIUS / CELLS**2
    scene.add(fl.AreaLoad(shell, force=(0, 0, -0.25 / pad), cells="pad"))
    return scene


CYLINDER = Case(
    eighth, pinched_cylinder, fl.PointDisplacement("cylinder.00", (0, 0, -1)), on_cylinder
)


def main(tolerance: float = 0.01, pictures: bool = True) -> dict[str, Any]:
    picture = "adaptive_cylinder.png" if pictures else ""
    return study("pinched_cylinder", CYLINDER, tolerance, picture)


if __name__ == "__main__":
    run(main, show=True)
