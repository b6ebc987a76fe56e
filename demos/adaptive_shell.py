"""A mesh that follows the error: an L-shaped plate.

Where a solution is singular, equal elements waste nearly all of themselves. Here three unit
squares lie around a corner of 270 degrees, thickness 0.1, E = 1e6, nu = 0.3, clamped all around,
under pressure. Bending moments at the corner are unbounded. The goal is the deflection in the
middle of the corner square.

The goal J has a dual solution z, the motion under a unit force at its place. What an element adds
to the error of J is the product of two errors of its stress, in the solution and in z (R. Becker &
R. Rannacher, Acta Numerica 10 (2001) 1), each estimated by the difference from a stress that is
averaged over the patch around each node, in local frames. The fewest triangles with half of the
sum are cut, and the next mesh is solved. Their sum has a sign and corrects J.

The problem is solved on equal triangles as well, each cut in four, for comparison. Reference is
the corrected deflection of the finest of all meshes.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from command_line import in_results, run

import fem_lie as fl

MESHES = Path(__file__).parents[1] / "meshes"
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


PLATE = Case(
    lambda: fl.read_gmsh_surface(MESHES / "l_plate.geo"),
    l_plate,
    fl.PointDisplacement("plate.middle", (0, 0, -1)),
    None,
)


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


def study(name: str, given: Case, tolerance: float, picture: str) -> dict[str, Any]:
    """A problem on meshes that follow the error, and on equal triangles."""
    found = refined(given, tolerance, 0.5)
    uniform = refined(given, tolerance, 1.0)
    finest = refined(given, FINER * tolerance, 0.5).error
    reference = finest.value + finest.estimate
    error = reference - found.error.value
    if picture:
        found.error.picture(in_results(picture))
    return {
        "case": name,
        "value": found.error.value,
        "reference": reference,
        "estimate": found.error.estimate,
        "error": error / reference,
        "effectivity": found.error.estimate / error,
        "meshes": len(found.meshes),
        "unknowns": unknowns_at(found, tolerance),
        "unknowns_uniform": unknowns_at(uniform, tolerance),
    }


def main(tolerance: float = 0.01, pictures: bool = True) -> dict[str, Any]:
    return study("l_plate", PLATE, tolerance, "adaptive_shell.png" if pictures else "")


if __name__ == "__main__":
    run(main, show=True)
