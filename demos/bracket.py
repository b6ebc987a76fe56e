"""A bracket from a STEP file, bolted to the ground, carries a flexible arm with a load at its end.

The bracket is drawn with gmsh's OpenCASCADE kernel, written as STEP and read back, as a drawing
from elsewhere would be: in millimetres and without names. Its holes are found by place, and it is
meshed with tetrahedra of second order. One bolt in the base is rigid and stiffens the edge of its
hole (RBE2: all nodes move with one frame); the other one takes force and moment but lets its hole
deform (RBE3: the mean motion of the nodes is held). The arm, a beam, is bolted rigidly to a hole in
the upright plate.

Everything is compared with CalculiX 2.20 (demos/reference/bracket.json) on the same mesh of the
bracket: C3D10 elements, *RIGID BODY for the rigid bolts, linear equations for the mean motion, and
an arm of C3D20 bricks; benchmarks/calculix_bracket.py writes its input and runs it. Errors are over
the largest component of the displacement of the tip, of the force and of the moment of all bolts,
and of each frequency.
"""

from __future__ import annotations

import json
import tempfile
from pathlib import Path
from typing import Any

import gmsh
import numpy as np
from command_line import in_results, run

import fem_lie as fl

STEEL = {"E": 2.1e11, "nu": 0.3, "density": 7800.0}
LENGTH, SIDE, START = 0.3, 0.016, np.array([0.008, 0.04, 0.065])
FORCE = (0.0, 5.0, -10.0)
HOLES = {"rigid": (0.07, 0.02), "mean": (0.07, 0.06)}  # positions in the base, radius 6 mm
REFERENCE = Path(__file__).parent / "reference" / "bracket.json"


def draw(file: Path) -> None:
    """Write an L of two plates of 8 mm with three holes, in millimetres."""
    occ = gmsh.model.occ
    plates = [[(3, occ.addBox(0, 0, 0, *edges))] for edges in ((100, 80, 8), (8, 80, 90))]
    holes = [occ.addCylinder(1e3 * x, 1e3 * y, -1, 0, 0, 10, 6) for x, y in HOLES.values()]
    holes.append(occ.addCylinder(-1, *1e3 * START[1:], 10, 0, 0, 8))
    occ.cut(occ.fuse(*plates)[0], [(3, hole) for hole in holes])
    occ.synchronize()
    gmsh.write(str(file))
    gmsh.clear()


def bracket_mesh(size: float) -> fl.mesh.VolumeMesh:
    """Tetrahedra of second order from a STEP file, with names for the walls of the holes."""
    gmsh.initialize(["gmsh", "-v", "0"])
    draw(file := Path(tempfile.mkdtemp(), "bracket.step"))
    gmsh.model.occ.dilate(gmsh.model.occ.importShapes(str(file)), 0, 0, 0, *3 * [1e-3])
    gmsh.model.occ.synchronize()
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 12)
    gmsh.option.setNumber("Mesh.ElementOrder", 2)
    gmsh.model.mesh.generate(3)
    mesh = fl.mesh.read_gmsh_volume()
    gmsh.finalize()
    (a, b), (c, d), (e, f) = *HOLES.values(), START[1:]
    return mesh.named(
        faces={
            "rigid": lambda x: np.hypot(x[0] - a, x[1] - b) < 6.01e-3,
            "mean": lambda x: np.hypot(x[0] - c, x[1] - d) < 6.01e-3,
            "upper": lambda x: np.hypot(x[1] - e, x[2] - f) < 8.01e-3,
        }
    )


def errors(found: dict[str, Any]) -> dict[str, float]:
    """Differences from CalculiX, see above."""
    exact = {key: np.array(value) for key, value in json.loads(REFERENCE.read_text()).items()}
    gaps = {key: np.abs(found[key] - value) for key, value in exact.items() if key != "nodes"}
    bolts = np.array([gaps[f"{bolt}_bolt"] for bolt in HOLES]).reshape(-1, 3).max(axis=1)
    sizes = np.abs([exact[f"{bolt}_bolt"] for bolt in HOLES]).reshape(-1, 2, 3).max(axis=(0, 2))
    return {
        "tip": gaps["tip"].max() / np.abs(exact["tip"]).max(),
        "bolts": (bolts.reshape(-1, 2) / sizes).max(),
        "frequencies": (gaps["frequencies"] / exact["frequencies"]).max(),
    }


def main(size: float = 0.012, cells: int = 8, pictures: bool = True) -> dict[str, Any]:
    steel = fl.sections.SaintVenantKirchhoff(**STEEL)
    bracket = fl.Solid(bracket_mesh(size), steel, name="bracket")
    section = fl.Section.rectangle(SIDE, SIDE, fl.Material(**STEEL))
    end = START + LENGTH * np.eye(3)[0]
    arm = fl.Beam.straight(START, end, section, cells=cells, name="arm")
    scene, ground, coupling = fl.Scene(), fl.ground(), fl.joints.KinematicCoupling
    for item in (
        bracket,
        arm,
        coupling(ground, bracket.points("rigid"), name="rigid"),
        fl.joints.Fixed(ground, bracket.point("mean"), name="mean"),
        coupling(arm.point("start"), bracket.points("upper"), name="upper"),
        fl.PointLoad(arm.point("end"), force=FORCE),
    ):
        scene.add(item)
    result = fl.statics(scene)
    found = {f"{bolt}_bolt": result.joint_force(bolt, axes="global")[-1] for bolt in HOLES}
    found["tip"] = result.displacement("arm.end")[-1]
    found["frequencies"] = fl.vibrations(scene, 6).frequencies
    if pictures:
        result.picture(in_results("bracket.png"), magnified=100.0)
    numbers = {name: np.asarray(value).tolist() for name, value in found.items()}
    return {"nodes": len(bracket.frames), **numbers, "errors": errors(found)}


if __name__ == "__main__":
    run(main, show=True)
