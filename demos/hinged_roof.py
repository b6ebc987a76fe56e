"""A shallow cylindrical roof under a force at its centre: snap-through, and snap-back if thin.

Radius 2540, length 508, half opening angle 0.1 rad, E = 3102.75, nu = 0.3, thickness 12.7 or 6.35.
The straight edges are hinged, the curved ones are free, the force P = 3000 is fixed in space. A
quarter is modelled. (K. Y. Sze, X. H. Liu & S. H. Lo, Finite Elem. Anal. Des. 40 (2004) 1551.)

The load rises to a limit point, falls to a second one and rises again when the roof has snapped
through. With thickness 6.35 the load falls below zero, and on the way the deflection turns back,
too: neither load nor displacement control can follow. `fl.follow_path` does, with the settings that
it has for everything; between the limit points the tangent has one negative pivot.

The reference for the limit loads is a displacement element of degree 4 on 8x8 cells.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import in_results, run

import fem_lie as fl

RADIUS, HALF_LENGTH, HALF_ANGLE, FORCE = 2540.0, 254.0, 0.1, 3000.0
LIMITS = {12.7: (0.7399762442, 0.1690852467), 6.35: (0.1948567713, -0.1283840308)}
PUBLISHED = {  # deflections and load factors of Sze, Liu & Lo, some of them
    12.7: [(3.087, 0.3473), (7.057, 0.6381), (10.358, 0.7412), (13.583, 0.6649), (15.676, 0.4442),
           (17.657, 0.2272), (19.852, 0.1729), (22.875, 0.295), (25.94, 0.5826), (28.663, 0.9643)],
    6.35: [(8.257, 0.1583), (13.752, 0.195), (16.145, 0.1323), (16.697, -0.0312),
           (14.52, -0.1001), (16.961, -0.1271), (23.1, -0.0484), (30.023, 0.2403),
           (36.626, 0.8114)],
}  # fmt: skip
UNITS = fl.post.Units(length="mm")


def position(a: float, b: float) -> np.ndarray:
    """From the crown (a = 0) to the hinged edge, from the middle (b = 0) to the free edge."""
    angle = HALF_ANGLE * a
    return np.array([RADIUS * np.sin(angle), HALF_LENGTH * b, RADIUS * (np.cos(angle) - 1.0)])


def roof(thickness: float, mesh: int) -> tuple[fl.Scene, fl.extend.Point]:
    """A quarter with its supports and a quarter of the load, and the centre."""
    shell = fl.Shell(
        fl.mesh.parametric_surface(position, (mesh, mesh)),
        fl.ShellSection.layer(thickness, fl.Material(3102.75, 0.3, 1.0)),
        director=lambda x: np.array([x[0], 0.0, x[2] + RADIUS]) / RADIUS,
        name="roof",
    )
    shell.symmetry("a=0", (1, 0, 0))
    shell.symmetry("b=0", (0, 1, 0))
    shell.hinge("a=1")
    scene = fl.Scene()
    scene.add(shell)
    scene.add(fl.PointLoad(shell.point("00"), force=(0, 0, -FORCE / 4)))
    return scene, shell.point("00")


def turns(values: np.ndarray) -> bool:
    """Whether a quantity goes back somewhere."""
    return bool((np.diff(values) < 0).any())


def main(thickness: float = 6.35, mesh: int = 16, pictures: bool = True) -> dict[str, Any]:
    if thickness not in LIMITS:
        raise ValueError(f"thickness must be one of {list(LIMITS)}, got {thickness}")
    fl.follow_path(roof(thickness, 2)[0], fl.stability.PathEnds(steps=1))  # compiles
    scene, centre = roof(thickness, mesh)
    path = fl.follow_path(scene, observe={"deflection": lambda s: -s.displacement(centre)[2]})
    upper, lower = path.limits
    deflection = path.observed["deflection"]
    record = {
        "thickness": thickness,
        "mesh": mesh,
        "limit_load": upper.factor,
        "lower_limit_load": lower.factor,
        "limit_error": upper.factor / LIMITS[thickness][0] - 1.0,
        "lower_limit_error": lower.factor / LIMITS[thickness][1] - 1.0,
        "negative_pivots": [*upper.negative_pivots, *lower.negative_pivots],
        "snap_back": turns(path.factors) and turns(deflection),
        "deflection": float(deflection[-1]),
        "load_steps": path.load_steps,
        "rejected_steps": path.failed_steps,
        "iterations": path.total_iterations,
        "seconds": path.seconds,
    }
    if pictures:
        name = f"hinged_roof_{thickness:g}"
        diagram, moving = in_results(f"{name}.png"), in_results(f"{name}.gif")
        published = np.array(PUBLISHED[thickness]).reshape(-1, 2).T
        path.plot_path(
            "deflection",
            diagram,
            label="deflection of the centre [mm]",
            load=(FORCE, "P [N]"),
            reference=(published[0], FORCE * published[1], "Sze et al. 2004"),
            units=UNITS,
        )
        path.animate(moving, title="Hinged roof, a quarter", units=UNITS)
    return record


if __name__ == "__main__":
    run(main, show=True)
