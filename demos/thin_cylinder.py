"""A perfect thin cylinder under axial compression buckles at the classical load, in many modes.

A long cylinder repeats itself, so a cell of it is enough: two half waves l of the ring mode each
way, all four edges on planes of symmetry, the loaded one moving as a whole. Its size follows
sqrt(R t), so that R/t = 100 and R/t = 1000 need the same mesh. compressed_cylinder.py has the
theory, and what imperfections leave of the load.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import in_results, run
from records import of_path
from reference.compressed_cylinder import KOITER, MATERIAL, half_wave

import fem_lie as fl


def outward(x: np.ndarray) -> np.ndarray:
    """Unit vector from the axis."""
    return np.array([x[0], x[1], 0.0]) / np.hypot(x[0], x[1])


def cell(thickness: float, mesh: int, slimness: float = 1.0) -> fl.Scene:
    """Two half waves of the ring mode each way, under the classical load; radius 1.

    ``slimness``: by how much it is narrower around than along.
    """
    length = 2 * half_wave(thickness)
    width = length / slimness

    def position(a: float, b: float) -> np.ndarray:
        return np.array([np.cos(a * width), np.sin(a * width), b * length])

    wall = fl.Shell(
        fl.mesh.parametric_surface(position, (2 * mesh, 2 * mesh)),
        fl.ShellSection.layer(thickness, MATERIAL),
        director=outward,
        name="wall",
    )
    top = wall.guided("b=1", (0, 0, 1))
    wall.symmetry("b=0", (0, 0, 1))
    wall.symmetry("a=0", (0, 1, 0))
    wall.symmetry("a=1", (-np.sin(width), np.cos(width), 0))
    scene = fl.Scene()
    scene.add(wall)
    edges = 0.05 * length, width, 0.05 * length  # for the picture only
    press = scene.add(fl.RigidBody.box(1.0, edges, position(0.5, 1), name="press"))
    scene.add(fl.joints.Prismatic(fl.ground(), press.point("centre"), axis=(0, 0, 1)))
    for point in top:
        scene.add(
            fl.joints.InPlane(press.point("centre"), point, at=point.position, axis=(0, 0, 1))
        )
    load = MATERIAL.E * thickness**2 / KOITER
    scene.add(fl.PointLoad(press.point("centre"), force=(0, 0, -load * width)))
    return scene


def buckles(ratio: float, mesh: int, pictures: bool) -> dict[str, Any]:
    """The perfect cylinder: load over the classical one, linear and on the path."""
    scene = cell(1.0 / ratio, mesh)
    modes = fl.buckling(scene, 2)
    path = fl.follow_path(scene, fl.stability.PathEnds(1.1, critical_points=1))
    linear, point = float(modes.factors[0]), path.critical[0]
    for mode in (1, 2) if pictures else ():
        file = in_results(f"thin_cylinder_{ratio:g}_mode{mode}.png")
        modes.picture(file, mode, amplitude=2 / ratio, units=fl.post.Units(length="R"))
    effort = of_path(path)
    del effort["rejected_steps"]
    return {
        "linear": linear,
        "path": point.factor,
        "error": max(abs(linear - 1.0), abs(point.factor - 1.0)),
        "negative_pivots": point.negative_pivots,
        **effort,
    }


def main(mesh: int = 8, ratios: str = "100,200,500,1000", pictures: bool = True) -> dict[str, Any]:
    """``mesh``: cells of a half wave."""
    slender = [float(ratio) for ratio in ratios.split(",")]
    perfect = {ratio: buckles(ratio, mesh, pictures) for ratio in slender}
    largest = max(found["error"] for found in perfect.values())
    return {"mesh": mesh, "perfect": perfect, "max_error": largest}


if __name__ == "__main__":
    run(main, show=True)
