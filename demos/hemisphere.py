"""A hemisphere with an 18 degree hole is pinched by four forces: a thin shell, almost inextensible.

Radius 10, E = 6.825e7, nu = 0.3, edges free, four radial forces P on the equator, inward and
outward in turn. It bends through more than half its radius. Symmetry leaves a quarter, with P/2 at
each of its two corners on the equator; one point is held vertically, without a force. K. Y. Sze,
X. H. Liu & S. H. Lo, Finite Elem. Anal. Des. 40 (2004) 1551, have thickness 0.04 and P = 400.
With thickness 0.01 and P = 5 (Y. Liu & H. Hu, 2021) the radius is a thousand times the thickness.

The references are those of displacement elements of degree 4 and 6, converged to about 1e-4.

Thin shells punish two things. An element that cannot bend without stretching locks: the four-node
element has assumed transverse shear (MITC4), and Hellinger-Reissner (HR) or Hu-Washizu (HW) stress
fields against membrane locking. And Newton's method with stresses taken from the displacements
needs steps as small as the ratio of bending to membrane stiffness: here the stress is carried as an
iterate in all of them. The load is applied by the load-capped arc length: one call, about a dozen
linear solutions. Thin shells have bicubic patches without shear, and assumed strains, too:
of the surface itself (thin) or of the smooth spline through its nodes (spline). Plates of positions
and three slopes have shear, without rotations (ancf).

``--gmsh`` meshes meshes/hemisphere.geo instead of making the same mesh by hand.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from any_shell import FORMULATIONS, KNOWN, PATCHES
from command_line import in_results, one_of, run
from records import of_loading

import fem_lie as fl

MODEL = Path(__file__).parents[1] / "meshes" / "hemisphere.geo"
RADIUS, HOLE = 10.0, np.radians(18)
# thickness: force, deflections outward and inward
CASES = {0.04: (400.0, 4.0753, 8.1524), 0.01: (5.0, 3.8267, 7.0991)}


def position(a: float, b: float) -> np.ndarray:
    """Point of the quarter: azimuth from x to y, height from the equator to the hole."""
    azimuth, height = a * np.pi / 2, b * (np.pi / 2 - HOLE)
    level = np.cos(height)
    return RADIUS * np.array([level * np.cos(azimuth), level * np.sin(azimuth), np.sin(height)])


def quarter(
    mesh: int, gmsh: bool = False, formulation: str = "HR"
) -> fl.mesh.SurfaceMesh | fl.mesh.SmoothPatch:
    """Mesh of the quarter, by gmsh or by hand, or a patch for thin shells."""
    if formulation in PATCHES:
        return PATCHES[formulation](position, (mesh, mesh))
    if gmsh:
        return fl.mesh.read_gmsh_surface(fl.mesh.run_gmsh_script(MODEL, {"cells": mesh}))
    return fl.mesh.parametric_surface(position, (mesh, mesh))


def pinched(
    thickness: float,
    mesh: fl.mesh.SurfaceMesh | fl.mesh.SmoothPatch | fl.mesh.SplineMesh,
    formulation: fl.elements.ShellFormulation | fl.elements.AncfPlate | None = None,
) -> fl.Scene:
    """A quarter with its supports and loads."""
    section = fl.ShellSection.layer(thickness, fl.Material(6.825e7, 0.3, 1.0))
    shell: fl.Shell | fl.ThinShell | fl.AncfShell
    if isinstance(mesh, fl.mesh.SmoothPatch | fl.mesh.SplineMesh):
        make = fl.AncfShell if isinstance(formulation, fl.elements.AncfPlate) else fl.ThinShell
        shell = make(mesh, section, name="hemisphere")
    else:
        shell = fl.Shell(
            mesh, section, director=lambda x: x / RADIUS, formulation=formulation, name="hemisphere"
        )
    shell.symmetry("a=0", (0, 1, 0))
    shell.symmetry("a=1", (1, 0, 0))
    shell.roller("00", (0, 0, 1))
    scene = fl.Scene()
    scene.add(shell)
    force = CASES[thickness][0]
    scene.add(fl.PointLoad(shell.point("00"), force=(force / 2, 0, 0)))
    scene.add(fl.PointLoad(shell.point("10"), force=(0, -force / 2, 0)))
    return scene


def main(
    thickness: float = 0.04,
    mesh: int = 16,
    formulation: str = "HR",
    gmsh: bool = False,
    pictures: bool = True,
) -> dict[str, Any]:
    one_of("thickness", thickness, CASES)
    one_of("formulation", formulation, KNOWN)
    if gmsh and formulation in PATCHES:
        raise ValueError("thin shells lie on patches, which are no meshes: leave out gmsh")
    element = fl.elements.AncfPlate() if formulation == "ancf" else FORMULATIONS.get(formulation)
    fl.follow_loads(pinched(thickness, quarter(4, formulation=formulation), element))  # compiles
    result = fl.follow_loads(pinched(thickness, quarter(mesh, gmsh, formulation), element))
    a = float(result.position("hemisphere.00")[-1, 0] - RADIUS)
    b = float(RADIUS - result.position("hemisphere.10")[-1, 1])
    if pictures:
        file = in_results("hemisphere.png")
        result.picture(
            file, title="Pinched hemisphere, a quarter", units=fl.post.Units(length="length")
        )
    return {
        "thickness": thickness,
        "mesh": mesh,
        "formulation": formulation,
        "deflection_a": a,
        "deflection_b": b,
        "error_a": a / CASES[thickness][1] - 1.0,
        "error_b": b / CASES[thickness][2] - 1.0,
        **of_loading(result),
    }


if __name__ == "__main__":
    run(main, show=True)
