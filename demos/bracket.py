"""A bracket from STEP files, bolted to the ground, carries a flexible arm with a load at its end.

STEP files are as those from elsewhere: in millimetres and without names. One has the bracket, a
solid with three holes, one the middle surface of the arm, a plate of 5 mm. Scripts of gmsh mesh the
solid with tetrahedra, and the surface with quadrilaterals and triangles, all of second order; walls
of holes and ends of the arm are found by place. One bolt in the base is rigid and stiffens its hole
(RBE2: all nodes move with one frame); the other one takes force and moment but lets its hole deform
(RBE3: the mean motion of the nodes is held). The root of the arm is bolted rigidly to the hole in
the upright plate, and a clamp at its other end carries the load.

Everything is compared with CalculiX 2.20 (demos/reference/bracket.json): C3D10 elements on the mesh
of the bracket, C3D20 bricks for the arm, *RIGID BODY for rigid bolts and the clamp, linear
equations for the mean motion; benchmarks/calculix_bracket.py draws the STEP files, writes the input
and runs it. Errors are over the largest component of the displacement of the tip, of the forces and
of the moments of all bolts, and of each frequency.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from command_line import in_results, run

import fem_lie as fl

STEEL = {"E": 2.1e11, "nu": 0.3, "density": 7800.0}
START, LENGTH, WIDTH, THICKNESS = np.array([0.008, 0.04, 0.065]), 0.3, 0.03, 0.005
END = START + LENGTH * np.eye(3)[0]
FORCE = (0.0, 0.5, -1.0)  # small, as CalculiX is linear
HOLES = {"rigid": (0.07, 0.02, 0.006), "mean": (0.07, 0.06, 0.006), "upper": (*START[1:], 0.008)}
REFERENCE = Path(__file__).parent / "reference"
SCRIPTS = "bracket.geo", "arm.geo"


def around(hole: str, i: int, j: int) -> Any:
    """Where the wall of a hole through the plane of two coordinates is."""
    a, b, radius = HOLES[hole]
    return lambda x: np.hypot(x[i] - a, x[j] - b) < 1.001 * radius


def meshes(size: float) -> tuple[fl.mesh.VolumeMesh, fl.mesh.MixedSurfaceMesh]:
    """Tetrahedra of the solid, triangles and quadrilaterals of the arm; names by place."""
    scripts = [fl.mesh.run_gmsh_script(REFERENCE / f, {"size": size}) for f in SCRIPTS]
    solid, sheet = fl.mesh.read_gmsh_volume(scripts[0]), fl.mesh.read_gmsh_surface(scripts[1])
    holes = {"rigid": around("rigid", 0, 1), "mean": around("mean", 0, 1)}
    ends = {"root": lambda x: x[0] < START[0] + 1e-9, "end": lambda x: x[0] > END[0] - 1e-9}
    return solid.named(faces={**holes, "upper": around("upper", 1, 2)}), sheet.named(curves=ends)


def main(size: float = 0.012, pictures: bool = True) -> dict[str, Any]:
    solid, sheet = meshes(size)
    bracket = fl.Solid(solid, fl.sections.SaintVenantKirchhoff(**STEEL), name="bracket")
    arm = fl.Shell(sheet, fl.ShellSection.layer(THICKNESS, fl.Material(**STEEL)), name="arm")
    root, end = arm.point(START), arm.point(END)
    scene, ground, coupling = fl.Scene(), fl.ground(), fl.joints.KinematicCoupling
    for item in (bracket, arm, fl.PointLoad(end, force=FORCE)):
        scene.add(item)
    rigid = scene.add(coupling(ground, bracket.points("rigid")))
    mean = scene.add(fl.joints.Fixed(ground, bracket.point("mean")))
    scene.add(coupling(root, [*arm.points("root"), *bracket.points("upper")]))
    scene.add(coupling(end, arm.points("end")))
    result = fl.statics(scene)
    if pictures:
        result.picture(in_results("bracket.png"), magnified=200.0)
    bolts = np.array([result.joint_force(bolt, axes="global")[-1] for bolt in (rigid, mean)])
    found = {"forces": bolts[:, :3], "moments": bolts[:, 3:], "tip": result.displacement(end)[-1]}
    found["frequencies"] = fl.vibrations(scene, 6).frequencies
    exact = json.loads((REFERENCE / "bracket.json").read_text())
    gaps = {key: np.abs(value - exact[key]) for key, value in found.items()}
    errors = {key: gap.max() / np.abs(exact[key]).max() for key, gap in gaps.items()}
    errors["frequencies"] = (gaps["frequencies"] / exact["frequencies"]).max()
    cells = {part.mesh.cell: len(part.cells) for part in sheet.parts}
    return {"cells": cells, **{k: v.tolist() for k, v in found.items()}, "errors": errors}


if __name__ == "__main__":
    run(main, show=True)
