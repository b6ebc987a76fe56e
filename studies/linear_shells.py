"""The linear problems on which shell elements have been measured for forty years.

- ``scordelis_lo``: a cylindrical roof on two diaphragms under its weight. R = 25, L = 50, 40
  degrees to each side, t = 0.25, E = 4.32e8, nu = 0, 90 per area; deflection in the middle of a
  straight edge 0.3024 (converged with shear: 0.302). A quarter.
- ``twisted_in``, ``twisted_out``: a cantilever of 12 x 1.1, twisted by 90 degrees, under a unit
  force at its end in the plane of its root or out of it; t = 0.32, E = 29e6, nu = 0.22. Its cells
  are warped. ``thin_in``, ``thin_out``: t = 0.0032 and a force of 1e-6.
- ``hemisphere``: with a hole of 18 degrees, as in hemisphere.py, P = 2; 0.094 (converged: 0.0937).
- ``cylinder``: pinched between two diaphragms by unit forces. R = 300, L = 600, t = 3, E = 3e6,
  nu = 0.3; 1.82488e-5 without shear, and with shear growing by 0.0055e-5 per factor e of the mesh.
  An eighth.

R. H. MacNeal & R. L. Harder, Finite Elem. Anal. Des. 1 (1985) 3; T. Belytschko et al., CMAME 51
(1985) 221. The equations here are the nonlinear ones, under a millionth of the load.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import fem_lie as fl
from demos.any_shell import KNOWN, AnyShell, about_x, any_shell
from demos.command_line import in_results, one_of, run

HERE = Path(__file__).parent
SMALL = 1e-6
UNITS = fl.post.Units(length="length")


class Case(NamedTuple):
    """A problem: its scene, where and along what the deflection is taken, and how large it is."""

    build: Callable[[int, str], fl.Scene]
    point: str
    direction: tuple[float, float, float]
    value: float


def part(
    mesh: int,
    length: float,
    radius: float,
    angles: tuple[float, float],
    section: fl.ShellSection,
    formulation: str,
) -> AnyShell:
    """Curves a=0 and a=1 at the two angles from z, b=0 in the middle, b=1 with a diaphragm."""

    def position(a: float, b: float) -> np.ndarray:
        angle = np.radians(angles[0] + a * (angles[1] - angles[0]))
        return np.array([length * b, -radius * np.sin(angle), radius * np.cos(angle)])

    shell = any_shell(formulation, position, (mesh, mesh), section, about_x)
    shell.symmetry("b=0", (1, 0, 0))
    shell.symmetry("a=0", (0, 1, 0))
    for direction in ((0, 1, 0), (0, 0, 1)):
        shell.roller("b=1", direction)
    return shell


def scordelis_lo(mesh: int, formulation: str) -> fl.Scene:
    section = fl.ShellSection.layer(0.25, fl.Material(4.32e8, 0.0, 1.0))
    shell = part(mesh, 25.0, 25.0, (0.0, 40.0), section, formulation)
    return scene_of(shell, fl.AreaLoad(shell, force=(0, 0, -90.0)))


def cylinder(mesh: int, formulation: str) -> fl.Scene:
    section = fl.ShellSection.layer(3.0, fl.Material(3e6, 0.3, 1.0))
    shell = part(mesh, 300.0, 300.0, (0.0, 90.0), section, formulation)
    shell.symmetry("a=1", (0, 0, 1))
    return scene_of(shell, fl.PointLoad(shell.point("00"), force=(0, 0, -0.25)))


def hemisphere(mesh: int, formulation: str) -> fl.Scene:
    def position(a: float, b: float) -> np.ndarray:
        azimuth, height = a * np.pi / 2, b * np.radians(72)
        level = np.cos(height)
        return 10 * np.array([level * np.cos(azimuth), level * np.sin(azimuth), np.sin(height)])

    section = fl.ShellSection.layer(0.04, fl.Material(6.825e7, 0.3, 1.0))
    shell = any_shell(formulation, position, (mesh, mesh), section, lambda x: x / 10)
    shell.symmetry("a=0", (0, 1, 0))
    shell.symmetry("a=1", (1, 0, 0))
    shell.roller("00", (0, 0, 1))
    outward = fl.PointLoad(shell.point("00"), force=(1, 0, 0))
    return scene_of(shell, outward, fl.PointLoad(shell.point("10"), force=(0, -1, 0)))


def twisted(thickness: float, force: tuple[float, float, float]) -> Callable[[int, str], fl.Scene]:
    """At the end the width is along z, at the root along y; ``mesh`` cells across, six along."""

    def position(a: float, b: float) -> np.ndarray:
        angle, height = a * np.pi / 2, 1.1 * (b - 0.5)
        return np.array([12.0 * a, height * np.cos(angle), height * np.sin(angle)])

    def normal(x: np.ndarray) -> np.ndarray:
        angle = x[0] / 12 * np.pi / 2
        across = np.array([0.0, np.cos(angle), np.sin(angle)])
        turn = (across @ x) * np.pi / 24 * np.array([0.0, -np.sin(angle), np.cos(angle)])
        n = np.cross(turn + np.array([1.0, 0.0, 0.0]), across)
        return n / np.linalg.norm(n)

    def build(mesh: int, formulation: str) -> fl.Scene:
        section = fl.ShellSection.layer(thickness, fl.Material(29e6, 0.22, 1.0))
        shell = any_shell(formulation, position, (6 * mesh, mesh), section, normal)
        shell.clamp("a=0")
        return scene_of(shell, fl.loads.EdgeLoad(shell, "a=1", force=np.array(force) / 1.1))

    return build


def scene_of(*things: Any) -> fl.Scene:
    """With all of them."""
    scene = fl.Scene()
    for thing in things:
        scene.add(thing)
    return scene


# the end of the twisted strip stays straight: its corner moves as its middle does
CASES = {
    "scordelis_lo": Case(scordelis_lo, "10", (0, 0, -1), 0.3024),
    "twisted_in": Case(twisted(0.32, (0, 0, 1)), "middle", (0, 0, 1), 0.005424),
    "twisted_out": Case(twisted(0.32, (0, 1, 0)), "middle", (0, 1, 0), 0.001754),
    "thin_in": Case(twisted(0.0032, (0, 0, 1e-6)), "middle", (0, 0, 1), 0.005256),
    "thin_out": Case(twisted(0.0032, (0, 1e-6, 0)), "middle", (0, 1, 0), 0.001294),
    "hemisphere": Case(hemisphere, "00", (1, 0, 0), 0.094),
    "cylinder": Case(cylinder, "00", (0, 0, -1), 1.82488e-5),
}


def deflection(case: Case, mesh: int, formulation: str) -> float:
    """Under the full load, if everything stayed linear."""
    result = fl.follow_loads(case.build(mesh, formulation), [SMALL])
    (shell,) = result.info.bodies
    corners = ("10", "11") if case.point == "middle" else (case.point,)
    moved = [
        result.position(f"{shell.name}.{point}")[-1]
        - result.info.undeformed[result.info.node(f"{shell.name}.{point}"), 0]
        for point in corners
    ]
    return float(np.mean(moved, axis=0) @ case.direction / SMALL)


def main(
    case: str = "all", mesh: int = 16, formulation: str = "HR", pictures: bool = True
) -> dict[str, Any]:
    one_of("case", case, ["all", *CASES])
    one_of("formulation", formulation, KNOWN)
    record: dict[str, Any] = {"mesh": mesh, "formulation": formulation}
    for name in CASES if case == "all" else (case,):
        # the twisted strip is narrow, and has six times as many cells along
        count = max(1, mesh // 8) if CASES[name].point == "middle" else mesh
        value = deflection(CASES[name], count, formulation)
        record[name] = value
        record[f"ratio_{name}"] = value / CASES[name].value
    if pictures:
        roof = fl.follow_loads(scordelis_lo(mesh, formulation), [10.0])
        title = "Scordelis-Lo roof under ten times its load"
        roof.picture(in_results("linear_shells.png"), title=title, units=UNITS)
    return record


if __name__ == "__main__":
    run(main, show=True)
