"""A flat cantilever is rolled up by a moment at its end, to a full circle: a shell that bends only.

Length 12, width 1, thickness 0.1, E = 1.2e6, no Poisson's ratio, so that EI = 100. The moment
50 pi/3, fixed in space, is spread over the end. K. Y. Sze, X. H. Liu & S. H. Lo, Finite Elem. Anal.
Des. 40 (2004) 1551, with 16 x 1 elements.

Exact: the curvature is kappa = M/EI everywhere, so the end moves by sin(kappa L)/kappa - L along
the strip and by (1 - cos(kappa L))/kappa across it.

The full bending strain x,a . t,b of ``HR``, ``HW`` and ``MITC4`` feels that chords are shorter than
arcs: 16 elements are 0.18 rad behind at the full circle. The decoupled one turns each element by
the exact angle, and what is left, where the circle is not closed, is the chords. With ``geodesic``
edges are arcs, and the circle is exact.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from command_line import in_results, run

import fem_lie as fl

HERE = Path(__file__).parent
LENGTH, WIDTH, THICKNESS, E = 12.0, 1.0, 0.1, 1.2e6
STIFFNESS = E * WIDTH * THICKNESS**3 / 12
CIRCLE = 2 * np.pi * STIFFNESS / LENGTH
UNITS = fl.post.Units(length="length")
FORMULATIONS: dict[str, fl.elements.ShellFormulation] = {
    "HR": fl.elements.HellingerReissner(),
    "HW": fl.elements.HuWashizu(),
    "MITC4": fl.elements.DisplacementBased(),
    "geodesic": fl.elements.GeodesicShell(),
    "decoupled": fl.elements.HellingerReissner(fl.elements.DECOUPLED),
}


def strip(cells: int, formulation: fl.elements.ShellFormulation) -> fl.Scene:
    """The cantilever, one cell wide."""
    shell = fl.Shell(
        fl.mesh.parametric_surface(lambda a, b: (LENGTH * a, WIDTH * b, 0.0), (cells, 1)),
        fl.ShellSection.layer(THICKNESS, fl.Material(E, 0.0, 1.0)),
        formulation=formulation,
        name="strip",
    )
    shell.clamp("a=0")
    scene = fl.Scene()
    scene.add(shell)
    scene.add(fl.loads.EdgeLoad(shell, "a=1", moment=(0, -CIRCLE / WIDTH, 0)))
    return scene


def exact(levels: np.ndarray) -> np.ndarray:
    """Shortening and deflection of the end."""
    angle = 2 * np.pi * levels
    radius = LENGTH / angle
    return np.column_stack([LENGTH - radius * np.sin(angle), radius * (1 - np.cos(angle))])


def main(
    mesh: int = 16, formulation: str = "decoupled", levels: int = 8, pictures: bool = True
) -> dict[str, Any]:
    if formulation not in FORMULATIONS:
        raise ValueError(f"formulation must be one of {', '.join(FORMULATIONS)}, got {formulation}")
    if levels < 1:
        raise ValueError(f"levels must be at least 1, got {levels}")
    factors = np.arange(1, levels + 1) / levels
    result = fl.follow_loads(strip(mesh, FORMULATIONS[formulation]), factors.tolist())
    moved = result.position("strip.10") - [LENGTH, 0.0, 0.0]
    found, wanted = moved[:, [0, 2]] * [-1.0, 1.0], exact(factors)
    errors = np.abs(found - wanted) / LENGTH
    record = {
        "mesh": mesh,
        "formulation": formulation,
        "shortening": float(found[-1, 0]),
        "deflection": float(found[-1, 1]),
        "path_error": float(errors.max()),
        "turning_error": turning_error(result, factors),
        "load_steps": result.load_steps,
        "iterations": result.total_iterations,
        "failed_iterations": result.failed_iterations,
        "seconds": result.seconds,
    }
    if pictures:
        picture = in_results("cantilever_moment.png")
        result.picture(picture, title="Cantilever under an end moment", units=UNITS)
    return record


def turning_error(result: fl.StaticResult, factors: np.ndarray) -> float:
    """Largest difference between the end's rotation and M L/EI, rad."""
    director = result.rotation("strip.10")[:, :, 2]
    angle = np.arctan2(-director[:, 0], director[:, 2])
    return float(np.abs(np.angle(np.exp(1j * (angle - 2 * np.pi * factors)))).max())


if __name__ == "__main__":
    run(main, show=True)
