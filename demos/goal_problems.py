"""Scenes, first meshes and goals of adaptive_goals.py: an arch, a plate with a hole, a frame."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from deep_arch import ANGLE, BENDING, FORCE, RADIUS, VARIANTS

import fem_lie as fl

HOLE = 0.5
PLAIN = fl.elements.GeodesicBeam(bending_flexibility=False)


def arch(mesh: fl.mesh.LineMesh) -> fl.Scene:
    """The stretchable arch, a hundred times as stiff across its plane."""
    EA, GA, _ = VARIANTS["stretchable"]
    section = fl.Section.from_stiffness([EA, GA, GA, 100 * BENDING, 100 * BENDING, BENDING])
    scene = fl.Scene()
    beam = scene.add(fl.Beam(mesh, section, up=(0, 0, 1), formulation=PLAIN, name="arch"))
    scene.add(fl.joints.Revolute(fl.ground(), beam.point("start"), axis=(0, 0, 1)))
    scene.add(fl.Clamp(beam.point("end")))
    scene.add(fl.PointLoad(beam.point("crown"), force=(0, -FORCE, 0)))
    return scene


def arch_line() -> fl.mesh.LineMesh:
    """Eight cells, and the name of the crown."""

    def position(s: float) -> tuple[float, float, float]:
        angle = ANGLE * (s - 0.5)
        return RADIUS * np.sin(angle), RADIUS * np.cos(angle), 0.0

    mesh = fl.mesh.curve(position, 8)
    return replace(mesh, named_points={**mesh.named_points, "crown": 4})


def plate(mesh: fl.mesh.SurfaceMesh) -> fl.Scene:
    """A quarter, of thickness 0.05."""
    section = fl.ShellSection.layer(0.05, fl.Material(1e6, 0.3, 1.0))
    shell = fl.Shell(mesh, section, name="plate")
    shell.symmetry("a=0", (0, 1, 0))
    shell.symmetry("a=1", (1, 0, 0))
    shell.clamp("b=1")
    scene = fl.Scene()
    scene.add(shell)
    return scene


def quarter() -> fl.mesh.SurfaceMesh:
    """From the hole to the sides of the square."""

    def position(a: float, b: float) -> np.ndarray:
        along = np.array([np.cos(a * np.pi / 2), np.sin(a * np.pi / 2), 0.0])
        return HOLE * (1 - b) * along + b * along / np.abs(along).max()

    return fl.mesh.parametric_surface(position, (4, 4), cell="triangle")


def out_of_hole(x: np.ndarray) -> np.ndarray:
    """Middles of edges of the rim lie within the hole; to its edge with them."""
    return x * max(1.0, HOLE / np.hypot(*x[:2]))


def frame(mesh: fl.mesh.LineMesh) -> fl.Scene:
    """Two arms and a stiff corner."""
    arm = fl.Section.rectangle(0.1, 0.1, fl.Material(1e9, 0.3, 1e3))
    corner = fl.Section.rectangle(0.1, 0.1, fl.Material(1e11, 0.3, 1e3))
    sections = {"arms": arm, "corner": corner}
    scene = fl.Scene()
    beam = scene.add(fl.Beam(mesh, sections, up=(0, 1, 0), formulation=PLAIN, name="frame"))
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), force=(0, 0, -300.0)))
    return scene


def frame_line() -> fl.mesh.LineMesh:
    """Two metres up and two across, a quarter of a metre of each belonging to the corner."""
    mesh = fl.mesh.polyline(
        [(0, 0, 0), (0, 0, 1.75), (0, 0, 2), (0.25, 0, 2), (2, 0, 2)], [2, 1, 1, 2]
    )
    return replace(mesh, groups={"arms": np.array([0, 1, 4, 5]), "corner": np.array([2, 3])})


class Case(NamedTuple):
    """What is refined, and for which number."""

    mesh: Callable[[], Any]
    build: Callable[[Any], fl.Scene]
    goal: (
        fl.adaptivity.LimitLoadGoal
        | fl.adaptivity.FrequencyGoal
        | fl.adaptivity.PointDisplacementGoal
    )
    onto: Callable[[np.ndarray], np.ndarray] | None = None
    part: float = 0.5


CASES = {
    "arch": Case(arch_line, arch, fl.adaptivity.LimitLoadGoal()),
    "plate": Case(quarter, plate, fl.adaptivity.FrequencyGoal(1), out_of_hole, 0.9),
    "frame": Case(frame_line, frame, fl.adaptivity.PointDisplacementGoal("frame.end", (0, 0, -1))),
}
