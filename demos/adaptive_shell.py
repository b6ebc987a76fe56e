"""Meshes that follow the error: an L-shaped plate, and a pinched cylinder.

Where a solution is singular, equal elements waste nearly all of themselves. Two such problems:

- ``l_plate``: three unit squares around a corner of 270 degrees, thickness 0.1, E = 1e6, nu = 0.3,
  clamped all around, under pressure. Bending moments at the corner are unbounded. The goal is the
  deflection in the middle of the corner square.
- ``pinched_cylinder``: between two diaphragms by two unit forces, R = 300, L = 600, t = 3, E = 3e6,
  nu = 0.3 (T. Belytschko et al., CMAME 51 (1985) 221), an eighth. Under a force on one point a
  shell with shear moves ever further as its mesh is refined, so it is spread over a pad of 60 x 94.
  The goal is the deflection in the middle of the pad.

The goal J has a dual solution z, the motion under a unit force at its place. What an element adds
to the error of J is the product of two errors of its stress, in the solution and in z (R. Becker &
R. Rannacher, Acta Numerica 10 (2001) 1), each estimated by the difference from a stress that is
averaged over the patch around each node, in local frames. The fewest triangles with half of the
sum are cut, and the next mesh is solved. Their sum has a sign and corrects J.

Both problems are solved on equal triangles as well, each cut in four, for comparison. Reference is
the corrected deflection of the finest of all meshes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import fem_lie as fl

HERE = Path(__file__).parent
RESULTS = HERE.parent / "results"
RADIUS, CELLS = 300.0, 10
MOST = 60_000
"""Unknowns; where equal triangles need more, their number is extrapolated."""
FINER = 0.25
"""Tolerance of the reference, over that which is asked for."""


class Case(NamedTuple):
    """A problem: its first mesh, a scene on any mesh, the goal, and the true surface."""

    mesh: Callable[[], fl.SurfaceMesh]
    build: Callable[[fl.SurfaceMesh], fl.Scene]
    goal: fl.PointDisplacement
    onto: Callable[[np.ndarray], np.ndarray] | None


def l_plate(mesh: fl.SurfaceMesh) -> fl.Scene:
    """The clamped plate."""
    section = fl.ShellSection.layer(0.1, fl.Material(1e6, 0.3, 1.0))
    scene = fl.Scene()
    shell = scene.add(fl.Shell(mesh, section, name="plate"))
    shell.clamp("rim")
    scene.add(fl.SurfacePressure(shell, -1e-3))
    return scene


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


CASES = {
    "l_plate": Case(
        lambda: fl.read_gmsh_surface(HERE.parent / "meshes" / "l_plate.geo"),
        l_plate,
        fl.PointDisplacement("plate.middle", (0, 0, -1)),
        None,
    ),
    "pinched_cylinder": Case(
        eighth, pinched_cylinder, fl.PointDisplacement("cylinder.00", (0, 0, -1)), on_cylinder
    ),
}


def refined(case: Case, tolerance: float, part: float) -> fl.Adapted[fl.SurfaceMesh]:
    """Meshes down to a tolerance, or as far as it goes; with ``part`` 1 all triangles are cut."""
    try:
        return fl.adapt(
            case.build,
            case.mesh(),
            tolerance=tolerance,
            goal=case.goal,
            solve=fl.statics,
            part=part,
            most=MOST,
            onto=case.onto,
        )
    except fl.ConvergenceError as error:
        return error.result


def unknowns_at(found: fl.Adapted[fl.SurfaceMesh], tolerance: float) -> float:
    """Where the estimated error has this size, on the line through the two meshes beside it."""
    x, y = np.log(found.unknowns), np.log(found.relative)
    k = min(int((found.relative > tolerance).sum()), len(x) - 1)
    slope = (y[k] - y[k - 1]) / (x[k] - x[k - 1])
    return float(np.exp(x[k] + (np.log(tolerance) - y[k]) / slope))


def main(case: str = "l_plate", tolerance: float = 0.01, pictures: bool = True) -> dict[str, Any]:
    if case not in CASES:
        raise ValueError(f"case must be one of {', '.join(CASES)}, got {case}")
    given = CASES[case]
    found = refined(given, tolerance, 0.5)
    uniform = refined(given, tolerance, 1.0)
    finest = refined(given, FINER * tolerance, 0.5).error
    reference = finest.value + finest.estimate
    error = reference - found.error.value
    record = {
        "case": case,
        "value": found.error.value,
        "reference": reference,
        "estimate": found.error.estimate,
        "error": error / reference,
        "effectivity": found.error.estimate / error,
        "meshes": len(found.meshes),
        "unknowns": unknowns_at(found, tolerance),
        "unknowns_uniform": unknowns_at(uniform, tolerance),
    }
    print(found)
    print("equal triangles:")
    print(uniform)
    print(
        "deflection {value:.5g}, error {error:.2%}, {effectivity:.2f} of it estimated".format(
            **record
        )
    )
    print("{unknowns:.0f} unknowns, {unknowns_uniform:.0f} with equal triangles".format(**record))
    if pictures:
        RESULTS.mkdir(exist_ok=True)
        picture = RESULTS / f"adaptive_shell_{case}.png"
        found.error.picture(picture)
        print(f"picture: {picture}")
    return record


if __name__ == "__main__":
    from command_line import run

    run(main)
