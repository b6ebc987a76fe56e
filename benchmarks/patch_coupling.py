"""Thin shells of several patches sewn together, whose parametrisations do not agree along edges.

``python -m benchmarks.patch_coupling``: the pinched hemisphere of two and of four patches, the
pulled cylinder of two, and the roof of Scordelis & Lo of two, against the references of the demos.
Along the coupling the parameter of the second patch has up to half the speed of the first or half
as much again, or the second patch has two cells where the first has three. Results of one patch
with as many cells are given for comparison.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

import fem_lie as fl
from demos import hemisphere, pulled_cylinder

Place = Callable[[float, float], np.ndarray]
Solve = Callable[[dict[str, Any]], tuple[list[float], int]]
THIN = 0.04
_SMALL = 1e-6  # of the load, where all is linear


def piece(
    position: Place,
    a: tuple[float, float],
    b: tuple[float, float],
    cells: tuple[int, int],
    skew: float,
) -> fl.mesh.SmoothPatch:
    """A part of a surface; ``skew`` makes its parameter b of uneven speed, from 1 ± skew."""

    def part(x: float, y: float) -> np.ndarray:
        uneven = y + skew * np.sin(np.pi * y) / np.pi
        return position(a[0] + (a[1] - a[0]) * x, b[0] + (b[1] - b[0]) * uneven)

    return fl.mesh.smooth_patch(part, cells)


def halves(position: Place, first: tuple[int, int], second: tuple[int, int]) -> dict[str, Any]:
    """Two patches, side by side along a, and their coupling."""
    return {
        "patches": {
            "left": piece(position, (0, 0.5), (0, 1), first, 0.0),
            "right": piece(position, (0.5, 1), (0, 1), second, 0.5),
        },
        "couplings": [fl.mesh.PatchCoupling("left.a=1", "right.a=0")],
    }


def quarters(position: Place, n: int) -> dict[str, Any]:
    """Four patches, of other speeds and numbers of cells, around a point."""
    return {
        "patches": {
            "left": piece(position, (0, 0.4), (0, 0.6), (n // 2, n // 2), 0.0),
            "right": piece(position, (0.4, 1), (0, 0.6), (n // 2, n // 2), 0.4),
            "left top": piece(position, (0, 0.4), (0.6, 1), (n // 2 + 1, n // 2), -0.3),
            "right top": piece(position, (0.4, 1), (0.6, 1), (n // 2, n // 2), 0.3),
        },
        "couplings": [
            fl.mesh.PatchCoupling("left.a=1", "right.a=0"),
            fl.mesh.PatchCoupling("left top.a=1", "right top.a=0"),
            fl.mesh.PatchCoupling("left.b=1", "left top.b=0"),
            fl.mesh.PatchCoupling("right.b=1", "right top.b=0"),
        ],
    }


def _held(shell: fl.ThinShell, names: Mapping[str, str]) -> None:
    """Planes of symmetry, y = 0 where a is 0 and x = 0 where it is 1."""
    for name in names:
        if name.startswith("left"):
            shell.symmetry(f"{name}.a=0", (0, 1, 0))
        else:
            shell.symmetry(f"{name}.a=1", (1, 0, 0))


def pinched(made: dict[str, Any], thickness: float = THIN) -> tuple[list[float], int]:
    """Errors of both deflections of the hemisphere, and linear solutions."""
    section = fl.ShellSection.layer(thickness, fl.Material(6.825e7, 0.3, 1.0))
    shell = fl.ThinShell(made["patches"], section, couplings=made["couplings"], name="hemisphere")
    _held(shell, made["patches"])
    shell.roller("left.00", (0, 0, 1))
    force, *wanted = hemisphere.CASES[thickness]
    scene = fl.Scene()
    scene.add(shell)
    scene.add(fl.PointLoad(shell.point("left.00"), force=(force / 2, 0, 0)))
    scene.add(fl.PointLoad(shell.point("right.10"), force=(0, -force / 2, 0)))
    result = fl.follow_loads(scene)
    a, b = (result.position(shell.point(name))[-1] for name in ("left.00", "right.10"))
    found = a[0] - hemisphere.RADIUS, hemisphere.RADIUS - b[1]
    return [f / w - 1 for f, w in zip(found, wanted, strict=True)], result.total_iterations


def pulled(made: dict[str, Any]) -> tuple[list[float], int]:
    """Errors of three deflections of the cylinder, and linear solutions."""
    d = pulled_cylinder
    section = fl.ShellSection.layer(d.THICKNESS, fl.Material(10.5e6, 0.3125, 1.0))
    shell = fl.ThinShell(made["patches"], section, couplings=made["couplings"], name="cylinder")
    _held(shell, made["patches"])
    for name in made["patches"]:
        shell.symmetry(f"{name}.b=0", (0, 0, 1))
    scene = fl.Scene()
    scene.add(shell)
    scene.add(fl.PointLoad(shell.point("left.00"), force=(d.FORCE / 4, 0, 0)))
    result = fl.follow_loads(scene)
    a, b, c = (result.position(shell.point(k))[-1] for k in ("left.00", "right.10", "right.11"))
    found = {"a": a[0] - d.RADIUS, "b": d.RADIUS - b[1], "c": d.RADIUS - c[1]}
    return [found[k] / d.REFERENCE[k] - 1 for k in "abc"], result.total_iterations


def roof(made: dict[str, Any]) -> tuple[list[float], int]:
    """Error of the sag in the middle of the free edge, small, and linear solutions."""
    section = fl.ShellSection.layer(0.25, fl.Material(4.32e8, 0.0, 1.0))
    shell = fl.ThinShell(made["patches"], section, couplings=made["couplings"], name="roof")
    shell.symmetry("left.a=0", (0, 1, 0))
    for name in made["patches"]:
        shell.symmetry(f"{name}.b=0", (1, 0, 0))
        for direction in ((0, 1, 0), (0, 0, 1)):
            shell.roller(f"{name}.b=1", direction)
    scene = fl.Scene()
    scene.add(shell)
    scene.add(fl.AreaLoad(shell, force=(0, 0, -90.0)))
    result = fl.follow_loads(scene, [_SMALL])
    moved = result.position(shell.point("right.10"))[-1] - shell.point("right.10").position
    return [-moved[2] / _SMALL / 0.3024 - 1], result.total_iterations


def vault(a: float, b: float) -> np.ndarray:
    """Of the roof: a quarter."""
    angle = np.radians(40.0 * a)
    return np.array([25.0 * b, -25.0 * np.sin(angle), 25.0 * np.cos(angle)])


def main() -> None:
    scenes: dict[str, tuple[Solve, Place]] = {
        "hemisphere": (pinched, hemisphere.position),
        "cylinder": (pulled, pulled_cylinder.position),
        "roof": (roof, vault),
    }
    for name, (solve, position) in scenes.items():
        for n in (8, 16):
            cases = {"two, other speed": halves(position, (n // 2, n), (n // 2, n))}
            cases["two, 3 cells to 2"] = halves(position, (n // 2, n), (n // 2, 2 * n // 3))
            if name == "hemisphere":
                cases["four"] = quarters(position, n)
            for case, made in cases.items():
                errors, iterations = solve(made)
                reported = ", ".join(f"{error:+.2%}" for error in errors)
                print(f"{name:10} {n:3}  {case:18} {reported}; {iterations}", flush=True)


if __name__ == "__main__":
    main()
