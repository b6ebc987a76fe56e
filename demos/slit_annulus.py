"""A flat ring, slit along a radius, is lifted at one side of the slit and clamped at the other.

Inner radius 6, outer radius 10, thickness 0.03, E = 21e6, no Poisson's ratio. The force 0.8 per
length, upwards and fixed in space, lifts the free edge by almost twice the outer radius. Y. Başar &
Y. Ding, Comput. Mech. 10 (1992) 289; K. Y. Sze, X. H. Liu & S. H. Lo, Finite Elem. Anal. Des. 40
(2004) 1551, with 10 x 80 elements: 13.891 at the inner corner and 17.528 at the outer one. The
reference here is that of elements of degree 4 to 6, converged: 13.850 and 17.487.

Almost everything here is turning: cells turn by more than 120 degrees and hardly stretch.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from command_line import in_results, run

import fem_lie as fl

HERE = Path(__file__).parent
INNER, OUTER, THICKNESS, FORCE = 6.0, 10.0, 0.03, 0.8
REFERENCE = 13.850, 17.487
PATCHES = {"thin": fl.mesh.smooth_patch, "spline": fl.mesh.spline_patch}
"""What thin shells lie on."""
FORMULATIONS = "HR", *PATCHES
UNITS = fl.post.Units(length="length")


def position(a: float, b: float) -> np.ndarray:
    """Radius and angle from the loaded edge to the clamped one."""
    radius, angle = INNER + a * (OUTER - INNER), 2 * np.pi * b
    return np.array([radius * np.cos(angle), radius * np.sin(angle), 0.0])


def ring(radial: int, around: int, formulation: str = "HR") -> fl.Scene:
    """The ring with its clamp and its load."""
    section = fl.ShellSection.layer(THICKNESS, fl.Material(21e6, 0.0, 1.0))
    shell: fl.Shell | fl.ThinShell
    if formulation in PATCHES:
        # its edges are at one position, and not joined
        patch = PATCHES[formulation](position, (radial, around))
        shell = fl.ThinShell(patch, section, name="ring")
    else:
        shell = fl.Shell(
            fl.mesh.parametric_surface(position, (radial, around)), section, name="ring"
        )
    shell.clamp("b=1")
    scene = fl.Scene()
    scene.add(shell)
    scene.add(fl.loads.EdgeLoad(shell, "b=0", force=(0, 0, FORCE)))
    return scene


def main(
    radial: int = 10, around: int = 80, formulation: str = "HR", pictures: bool = True
) -> dict[str, Any]:
    """``formulation``: HR, or a thin shell without shear on the surface (thin) or a spline."""
    if formulation not in FORMULATIONS:
        raise ValueError(f"formulation must be one of {', '.join(FORMULATIONS)}, got {formulation}")
    result = fl.follow_loads(ring(radial, around, formulation))
    record = {
        "radial": radial,
        "around": around,
        "formulation": formulation,
        "deflection_a": float(result.position("ring.00")[-1, 2]),
        "deflection_b": float(result.position("ring.10")[-1, 2]),
        "load_steps": result.load_steps,
        "iterations": result.total_iterations,
        "failed_iterations": result.failed_iterations,
        "seconds": result.seconds,
    }
    for name, value in zip("ab", REFERENCE, strict=True):
        record[f"error_{name}"] = record[f"deflection_{name}"] / value - 1.0
    if pictures:
        picture = in_results("slit_annulus.png")
        result.picture(picture, title="Slit annular plate", units=UNITS)
    return record


if __name__ == "__main__":
    run(main, show=True)
