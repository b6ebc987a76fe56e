"""An open cylinder pulled apart by two forces at mid-length: bending, a snap, then stretching.

Length 10.35, radius 4.953, thickness 0.094, E = 10.5e6, nu = 0.3125, ends free, two opposite radial
forces up to 40 kN (K. Y. Sze, X. H. Liu & S. H. Lo, Finite Elem. Anal. Des. 40 (2004) 1551; Y. Liu
& H. Hu, Chin. J. Theor. Appl. Mech. 53 (2021) 213). An eighth is modelled, with a quarter of the
force. Deflections at full load: A (under the force, outward) 2.750, B (mid-length, 90 degrees from
it, inward) 4.555, C (free end, there, inward) 3.275; that of A grows with the logarithm of the
mesh, as under any point force on a shell that shears.

Near 20 kN the wall under B snaps through: a limit point, and a minimum half a per cent lower. That
is why load steps fail here. The load-capped arc length (`fl.follow_loads`) passes it in a few long
steps whose ends need not be in equilibrium; `fl.follow_path` traces it (`--path`), with every state
polished, both limit points located, and one negative pivot between them. Loads of the two limit
points with the same element on meshes from 24x16 on are 0.5125 ... 0.5168 and 0.2-0.65 % less.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from any_shell import KNOWN, any_shell
from command_line import in_results, one_of, run

import fem_lie as fl

LENGTH, RADIUS, THICKNESS, FORCE = 10.35, 4.953, 0.094, 40000.0
REFERENCE = {"a": 2.750, "b": 4.555, "c": 3.275}
PUBLISHED = [(0.864, 0.025), (1.471, 0.05), (2.217, 0.1), (2.904, 0.2), (3.227, 0.3), (3.443, 0.4),
             (3.653, 0.5), (4.061, 0.525), (4.171, 0.55), (4.274, 0.6), (4.385, 0.7), (4.455, 0.8),
             (4.508, 0.9), (4.551, 1.0)]  # fmt: skip
UNITS = fl.post.Units(length="mm")


def position(a: float, b: float) -> np.ndarray:
    """From the force (a = 0) around the quarter, from mid-length (b = 0) to the free end."""
    angle = a * np.pi / 2
    return np.array([RADIUS * np.cos(angle), RADIUS * np.sin(angle), b * LENGTH / 2])


def cylinder(around: int, along: int, formulation: str = "HR") -> fl.Scene:
    """An eighth with a quarter of the force."""
    section = fl.ShellSection.layer(THICKNESS, fl.Material(10.5e6, 0.3125, 1.0))
    shell = any_shell(formulation, position, (around, along), section, outward, name="cylinder")
    shell.symmetry("a=0", (0, 1, 0))
    shell.symmetry("a=1", (1, 0, 0))
    shell.symmetry("b=0", (0, 0, 1))
    scene = fl.Scene()
    scene.add(shell)
    scene.add(fl.PointLoad(shell.point("00"), force=(FORCE / 4, 0, 0)))
    return scene


def outward(x: np.ndarray) -> np.ndarray:
    """Normal of the cylinder."""
    return np.array([x[0], x[1], 0.0]) / RADIUS


def deflections(result: fl.StaticResult) -> dict[str, np.ndarray]:
    """Outward at A, inward at B and C, at all states."""
    a, b, c = (result.position(f"cylinder.{name}") for name in ("00", "10", "11"))
    return {"a": a[:, 0] - RADIUS, "b": RADIUS - b[:, 1], "c": RADIUS - c[:, 1]}


def main(
    mesh: str = "24x16", formulation: str = "HR", path: bool = False, pictures: bool = True
) -> dict[str, Any]:
    """``formulation``: HR, or a thin shell without shear on the surface (thin) or a spline."""
    one_of("formulation", formulation, KNOWN)
    try:
        around, along = map(int, mesh.split("x"))
    except ValueError:
        raise ValueError(f"mesh must be cells around x cells along, as 24x16, got {mesh}") from None
    fl.follow_loads(cylinder(4, 4, formulation), [0.01])  # compiles
    result = fl.follow_loads(cylinder(around, along, formulation))
    moved = {name: float(values[-1]) for name, values in deflections(result).items()}
    record: dict[str, Any] = {
        "mesh": mesh,
        "formulation": formulation,
        **{f"deflection_{name}": value for name, value in moved.items()},
        "max_error": max(abs(moved[name] / REFERENCE[name] - 1.0) for name in moved),
        "load_steps": result.load_steps,
        "rejected_steps": result.failed_steps,
        "iterations": result.total_iterations,
        "seconds": result.seconds,
    }
    if pictures:
        file = in_results("pulled_cylinder.png")
        result.picture(file, title="Pulled cylinder, an eighth", units=UNITS)
    return record | (trace(around, along, formulation, pictures) if path else {})


def trace(around: int, along: int, formulation: str, pictures: bool) -> dict[str, Any]:
    """The whole path through the snap."""
    path = fl.follow_path(cylinder(around, along, formulation))
    if pictures:
        published = np.array(PUBLISHED).T
        path.plot_path(
            deflections(path)["b"],
            in_results("pulled_cylinder_path.png"),
            label="deflection of B [mm]",
            load=(FORCE / 1000, "force [kN]"),
            reference=(published[0], FORCE / 1000 * published[1], "Sze et al. 2004"),
            units=UNITS,
        )
        path.animate(in_results("pulled_cylinder.gif"), title="Pulled cylinder", units=UNITS)
    return {
        "limit_loads": [point.factor for point in path.limits],
        "negative_pivots": [point.negative_pivots for point in path.limits],
        "path_steps": path.load_steps,
        "path_iterations": path.total_iterations,
        "path_seconds": path.seconds,
    }


if __name__ == "__main__":
    run(main, show=True)
