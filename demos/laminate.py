"""A cross-ply laminate under load: deflection and resultants against Navier's double series.

A square plate of side a and thickness h, plies 0/90/90/0 of a fibre composite (E₁ = 25 E₂,
G₁₂ = G₁₃ = 0.5 E₂, G₂₃ = 0.2 E₂, ν₁₂ = 0.25), simply supported, carries a uniform load q normal to
it. A section without coupling of extension and bending or of bending and twist (specially
orthotropic) lets Navier's series separate. With the deflection w and the tilts φ of the director::

    w  = Σ W sin αx sin βy,   φ₁ = Σ X cos αx sin βy,   φ₂ = Σ Y sin αx cos βy,
    α = mπ/a,  β = nπ/a,      q = Σ q_mn sin αx sin βy,  q_mn = 16 q/(π² m n) for odd m, n,

the first-order theory of plates with transverse shear (Reissner & Mindlin) is a system of three
equations for each pair m, n (S is the shear stiffness)::

    ⎡ S₅₅α² + S₄₄β²   S₅₅α                   S₄₄β                 ⎤ ⎡W⎤   ⎡q_mn⎤
    ⎢                 D₁₁α² + D₆₆β² + S₅₅    (D₁₂ + D₆₆) αβ       ⎥ ⎢X⎥ = ⎢ 0  ⎥
    ⎣ symmetric                              D₆₆α² + D₂₂β² + S₄₄  ⎦ ⎣Y⎦   ⎣ 0  ⎦

    M₁₁ = −Σ (D₁₁ α X + D₁₂ β Y) sin αx sin βy,    M₂₂ alike,
    M₁₂ = Σ D₆₆ (β X + α Y) cos αx cos βy,         Q₁ = Σ S₅₅ (X + α W) cos αx sin βy.

J. N. Reddy, Mechanics of Laminated Composite Plates and Shells, 2nd ed. (2004), ch. 7. Without
transverse shear (S → ∞) it is the classical theory; for an isotropic plate of ν = 0.3 then
w = 0.00406 q a⁴/D and M = 0.0479 q a² at the centre (Timoshenko & Woinowsky-Krieger, art. 30).

The element has the same theory, so that nothing but its mesh is between it and the series. The
support is "hard": no deflection and no tilt along the edge, as in the series. The load is so small
that the deflection is about 1e-4 of the thickness, and the plate is as good as linear. Compared are
values at nodes: at the centre, the twisting moment at a corner, the shear at the middle of an edge.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from command_line import in_results, run
from reference.navier import SIDE, navier

import fem_lie as fl

HERE = Path(__file__).parent
E2 = 1.0
FIBRES = fl.sections.Orthotropic(25 * E2, E2, 0.25, 0.5 * E2, 0.5 * E2, 0.2 * E2, 1.0)
CENTRE = (SIDE / 2, SIDE / 2)
PLACES = {"w": CENTRE, "M11": CENTRE, "M22": CENTRE, "M12": (0.0, 0.0), "Q1": (0.0, SIDE / 2)}
UNITS = fl.post.Units(length="a", force="E2 a²")


def cross_ply(thickness: float) -> fl.ShellSection:
    """Four equal plies, 0/90/90/0, with the shear factor of the tables of the book."""
    plies = [fl.sections.Ply(thickness / 4, FIBRES, angle) for angle in (0.0, 90.0, 90.0, 0.0)]
    return fl.ShellSection.laminate(plies, shear_factor=5 / 6)


def plate(
    section: fl.ShellSection,
    cells: int,
    load: float,
    formulation: fl.elements.ShellFormulation | None = None,
) -> tuple[fl.Scene, fl.Shell]:
    """The simply supported square under a uniform load along its director."""
    shell = fl.Shell(
        fl.mesh.parametric_surface(lambda a, b: (SIDE * a, SIDE * b, 0.0), (cells, cells)),
        section,
        along=(1, 0, 0),
        formulation=formulation,
        name="plate",
    )
    for side in ("a=0", "a=1"):
        shell.hinge(side, axis=(0, 1, 0))
    for side in ("b=0", "b=1"):
        shell.hinge(side, axis=(1, 0, 0))
    scene = fl.Scene()
    scene.add(shell)
    scene.add(fl.AreaLoad(shell, force=(0, 0, load)))
    return scene, shell


def compare(
    result: fl.StaticResult, shell: fl.Shell, section: fl.ShellSection, load: float
) -> tuple[fl.post.Resultants, dict[str, tuple[float, float]]]:
    """Resultants, and found and exact values of each quantity."""
    found = fl.post.resultants(result, shell)
    info, pairs = result.info.body(shell.name), {}
    for name, (x, y) in PLACES.items():
        node = int(np.linalg.norm(shell.model.mesh.points[:, :2] - [x, y], axis=1).argmin())
        height = result.frames[-1][info.nodes[node], 0, 2]
        value = height if name == "w" else found.smooth(name)[node]
        pairs[name] = (float(value), navier(section, load, x, y)[name])
    return found, pairs


def main(cells: int = 32, slenderness: float = 10.0, pictures: bool = True) -> dict[str, Any]:
    if cells % 2:
        raise ValueError(f"cells must be even, so that a node is at the centre, got {cells}")
    section = cross_ply(SIDE / slenderness)
    load = 1e-4 * E2 / slenderness**4
    scene, shell = plate(section, cells, load)
    result = fl.follow_loads(scene)
    found, pairs = compare(result, shell, section, load)
    if pictures:
        magnified = 0.2 * SIDE / result.frames[-1, :, 0, 2].max()
        title = "Cross-ply laminate under uniform load"
        file = in_results("laminate.png")
        found.picture(file, "M11", magnified=magnified, title=title, units=UNITS)
        found.write_vtk(in_results("laminate.vtu"))
    return {
        "cells": cells,
        "slenderness": slenderness,
        "deflection": pairs["w"][0] * 100 * E2 / (load * SIDE**4 * slenderness**3),
        **{f"{name}_error": value / exact - 1 for name, (value, exact) in pairs.items()},
        "iterations": int(result.iterations[-1]),
        "seconds": result.seconds,
    }


if __name__ == "__main__":
    run(main, show=True)
