"""Problems of adaptive_shell.py: an L-shaped plate, and a pinched cylinder.

The plate: three unit squares around a corner of 270 degrees, thickness 0.1, E = 1e6, nu = 0.3,
clamped all around, under pressure. Bending moments at the corner are unbounded. The goal is the
deflection in the middle of the corner square.

The cylinder: pinched between two diaphragms by two unit forces, R = 300, L = 600, t = 3, E = 3e6,
nu = 0.3 (T. Belytschko et al., CMAME 51 (1985) 221), an eighth of it is solved. Under a force on
one point a shell with shear moves ever further as its mesh is refined, so it is spread over a pad
of 60 x 94, or of 15 x 24, five times the thickness. The goal is the deflection in the middle of the
pad. The mesh that is refined by the error begins with cells that are small at the pad alone.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

import fem_lie as fl

MESHES = Path(__file__).parents[1] / "meshes"
RADIUS, CELLS = 300.0, 10


class Problem(NamedTuple):
    """First meshes, of cells that follow the error and of equal ones; the goal, the true surface.

    With ``fall`` meshes are generated again, each with this fraction of the error before.
    """

    mesh: Callable[[], fl.mesh.SurfaceMesh]
    equal: Callable[[], fl.mesh.SurfaceMesh]
    build: Callable[[fl.mesh.SurfaceMesh], fl.Scene]
    goal: fl.adaptivity.PointDisplacementGoal
    onto: Callable[[np.ndarray], np.ndarray] | None
    fall: float | None


def l_plate(mesh: fl.mesh.SurfaceMesh) -> fl.Scene:
    """The clamped plate."""
    section = fl.ShellSection.layer(0.1, fl.Material(1e6, 0.3, 1.0))
    scene = fl.Scene()
    shell = scene.add(fl.Shell(mesh, section, name="plate"))
    shell.clamp("rim")
    scene.add(fl.loads.SurfacePressure(shell, -1e-3))
    return scene


def on_cylinder(x: np.ndarray) -> np.ndarray:
    """The position on the cylinder about x that is nearest."""
    return np.array([x[0], *(RADIUS * x[1:] / np.hypot(*x[1:]))])


def eighth(pad: int = CELLS, cells: int = CELLS) -> fl.mesh.SurfaceMesh:
    """From the force to the side, and from mid-length to a diaphragm.

    The pad is one of so many parts of each side; cells there are cut until it is made of them.
    """

    def position(a: float, b: float) -> np.ndarray:
        angle = a * np.pi / 2
        return RADIUS * np.array([b, -np.sin(angle), np.cos(angle)])

    mesh, parts = fl.mesh.parametric_surface(position, (cells, cells), cell="triangle"), cells
    while parts < pad:
        mesh, parts = fl.adaptivity.refine(mesh, under(mesh, parts), onto=on_cylinder), 2 * parts
    return replace(mesh, groups={"pad": under(mesh, pad)})


def under(mesh: fl.mesh.SurfaceMesh, parts: int) -> np.ndarray:
    """Cells in the first of so many parts of each side."""
    x, y, z = mesh.points[mesh.cells].mean(axis=1).T
    return np.flatnonzero((x < RADIUS / parts) & (np.arctan2(-y, z) < np.pi / 2 / parts))


def pinched_cylinder(mesh: fl.mesh.SurfaceMesh) -> fl.Scene:
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
        shell.roller("b=1", direction)
    scene = fl.Scene()
    scene.add(shell)
    pad = shell.model.areas()[mesh.group("pad")].sum()
    scene.add(fl.AreaLoad(shell, force=(0, 0, -0.25 / pad), cells="pad"))
    return scene


def plate_mesh() -> fl.mesh.SurfaceMesh:
    """Triangles a quarter of a side long."""
    return fl.mesh.read_gmsh_surface(fl.mesh.run_gmsh_script(MESHES / "l_plate.geo"))


PAD = fl.adaptivity.PointDisplacementGoal("cylinder.00", (0, 0, -1))
PROBLEMS = {
    "l_plate": Problem(
        plate_mesh,
        plate_mesh,
        l_plate,
        fl.adaptivity.PointDisplacementGoal("plate.middle", (0, 0, -1)),
        None,
        0.75,
    ),
    "pinched_cylinder": Problem(eighth, eighth, pinched_cylinder, PAD, on_cylinder, None),
    "small_pad": Problem(
        lambda: eighth(4 * CELLS),
        lambda: eighth(4 * CELLS, 4 * CELLS),
        pinched_cylinder,
        PAD,
        on_cylinder,
        None,
    ),
}
