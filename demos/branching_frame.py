"""A space frame that branches, in one mesh: against the same frame of beams with joints.

meshes/frame.geo has two columns, a girder with a kink at both ends, and an outrigger that branches
off its middle; three sections belong to its named groups. A heavy body is linked to the end of the
outrigger, beside and below it. It hangs there while the girder is warmed, more at its top than at
its bottom, and wind presses on the columns.

In one mesh all that meets at a point is rigidly connected. Each direction has a node with frames of
its own, e1 along the line, but only the first node of a point has unknowns; the others have the
frame H C with a constant C. The same goes for both sides of a RigidLink. Nothing is linearised, and
there are no constraints. Made of separate beams, each of these connections is a Fixed joint: six
unknowns more at each node, and six multipliers. The solutions are the same.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from command_line import in_results, run

import fem_lie as fl

HERE = Path(__file__).parent
STEEL = fl.Material(E=2.1e11, nu=0.3, density=7850.0)
SECTIONS = {
    "columns": fl.Section.tube(0.04, 0.05, STEEL),
    "girder": fl.Section.rectangle(0.06, 0.12, STEEL),
    "outrigger": fl.Section.rectangle(0.06, 0.08, STEEL),
}
UP = {"columns": (1, 0, 0), "girder": (0, 0, 1), "outrigger": (0, 0, 1)}
JOINTS = [
    ("left corner", "columns", "girder"),
    ("right corner", "columns", "girder"),
    ("middle", "girder", "outrigger"),
]


def frame(elements: int, joints: bool) -> tuple[fl.Scene, fl.extend.Point]:
    """The scene and the end of the outrigger; of one mesh, or of parts with ``joints``."""
    mesh = fl.mesh.read_gmsh_lines(
        fl.mesh.run_gmsh_script(HERE.parent / "meshes" / "frame.geo", {"cells": elements})
    )
    scene = fl.Scene(gravity=(0, 0, -9.81))
    if joints:
        parts = {
            group: scene.add(fl.Beam(mesh.part(group), section, up=UP[group], name=group))
            for group, section in SECTIONS.items()
        }
        for point, first, second in JOINTS:
            scene.add(
                fl.joints.Fixed(parts[first].point(point), parts[second].point(point), name=point)
            )
    else:
        parts = dict.fromkeys(SECTIONS, scene.add(fl.Beam(mesh, SECTIONS, up=UP, name="frame")))
    end = parts["outrigger"].point("end")
    position = end.position + np.array([0.3, 0.3, -0.5])
    weight = scene.add(fl.RigidBody(300.0, (10, 10, 10), position))
    if joints:
        scene.add(fl.joints.Fixed(end, weight.point("centre"), at=end.position, name="weight"))
    else:
        scene.add(fl.joints.RigidLink(end, weight.point("centre")))
    for foot in ("left foot", "right foot"):
        scene.add(fl.Clamp(parts["columns"].point(foot)))
    scene.add(
        fl.loads.Temperature(parts["girder"], 40.0, 1.2e-5, gradient=(0.0, 300.0), cells="girder")
    )
    scene.add(fl.loads.PressureLoad(parts["columns"], 800.0, (0, 1, 0), cells="columns"))
    return scene, end


def main(elements: int = 4, load_steps: int = 1, pictures: bool = True) -> dict[str, Any]:
    tips, rounds = [], []
    for joints in (False, True):
        scene, end = frame(elements, joints)
        result = fl.statics(scene, load_steps=load_steps)
        tips.append(result.position(end)[-1] - end.position)
        rounds.append(result.total_iterations)
        if not joints:
            drawn, bent = scene, result
    gap = float(np.linalg.norm(tips[1] - tips[0]) / np.linalg.norm(tips[0]))
    if pictures:
        names = in_results("branching_frame.png"), in_results("branching_frame_frames.png")
        bent.picture(names[0], title="Frame with a branch and a weight")
        drawn.picture(names[1], frames=True, title="Nodal frames at kinks and branches")
    return {
        "elements": elements,
        "load_steps": load_steps,
        **{f"tip_{axis}": float(u) for axis, u in zip("xyz", tips[0], strict=True)},
        "difference": gap,
        "iterations": rounds[0],
        "iterations_with_joints": rounds[1],
    }


if __name__ == "__main__":
    run(main, show=True)
