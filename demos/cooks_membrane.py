"""A tapered panel of nearly incompressible rubber is sheared: Cook's membrane, in large strains.

R. D. Cook, J. Struct. Div. ASCE 100 (1974) 1851; as a test of volumetric locking at large strains:
J. C. Simo & F. Armero, IJNME 33 (1992) 1413. The panel in plane strain has the corners (0, 0),
(48, 44), (48, 60) and (0, 44), thickness 1, and is clamped at x = 0; a dead load of 100 along y is
spread over the side x = 48. The material is

    W = K/2 ((J^2 - 1)/2 - ln J) + mu/2 (J^(-2/3) tr C - 3),    mu = 80.1938,  K = 400889.8

a UFL function of C = F^T F, with J^2 = det C; Poisson's ratio is 0.4999. What counts is how far the
upper right corner rises. The reference, 6.932, is that of another method: quadratic displacements
with linear pressures (Taylor & Hood) in two dimensions, by DOLFINx's own assembly, 6.9268, 6.9307,
6.9315, 6.9321 on meshes of 8, 16, 32, 64. The clamped upper corner is singular, so that the last
digit comes slowly.

With --small strains are small and the material is compressible: E = 0.07, nu = 1/3, a load of 0.1,
all in N and mm. The project CoFEA, as quoted in the tutorials of solids4foam, has on very fine
quadratic meshes that the corner rises by 32.27 (CalculiX), 32.20 (Code_Aster), 32.28 (Elmer). A
millionth of the load is taken here, and the rise times a million.

One layer of bricks is held in the plane on both faces. The element can be chosen by --element:

- mean is of degree 1 with the mean dilatation of each cell, and does not lock,
- plain is of degree 1 as it is interpolated, and locks: it rises a third as far,
- quadratic is of degree 2, and does not lock as long as cells are small.
"""

from __future__ import annotations

from typing import Any

import ufl
from command_line import in_results, run

import fem_lie as fl

REFERENCE, LOAD = 6.932, 100.0
SHEAR, BULK = 80.1938, 400889.8
PUBLISHED, SOFT = 32.25, fl.sections.SaintVenantKirchhoff(0.07, 1 / 3)
"""Mean of those of small strains, and its material."""
SMALL, SMALL_LOAD = 1e-6, 0.1
ELEMENTS: dict[str, tuple[int, fl.elements.SolidFormulation]] = {
    "mean": (1, fl.elements.MeanDilatation()),
    "plain": (1, fl.elements.Isoparametric()),
    "quadratic": (2, fl.elements.Isoparametric()),
}


def rubber(C: Any, shear: Any, bulk: Any) -> Any:
    """Stored energy."""
    J = ufl.sqrt(ufl.det(C))
    volumetric = 0.5 * bulk * (0.5 * (J**2 - 1) - ufl.ln(J))
    return volumetric + 0.5 * shear * (J ** (-2 / 3) * ufl.tr(C) - 3)


def position(a: float, b: float, c: float) -> tuple[float, float, float]:
    """Of the panel, a and b from 0 to 1 along and up, c across."""
    low, high = 44 * a, 44 + 16 * a
    return 48 * a, low + b * (high - low), c


def solve(
    element: str, mesh: int, load_steps: int, small: bool
) -> tuple[dict[str, Any], fl.post.SolidStresses]:
    """Load it; a record of numbers, and the stress in the end."""
    degree, formulation = ELEMENTS[element]
    material = SOFT if small else fl.sections.Hyperelastic(rubber, parameters=(SHEAR, BULK))
    load, unit, reference = (
        (SMALL * SMALL_LOAD, SMALL, PUBLISHED) if small else (LOAD, 1, REFERENCE)
    )
    cells = fl.mesh.parametric_volume(position, (mesh, mesh, 1))
    panel = fl.Solid(cells, material, degree=degree, formulation=formulation, name="panel")
    panel.clamp("a=0")
    panel.model.held[:, 2] = True
    scene = fl.Scene()
    scene.add(panel)
    scene.add(fl.loads.FaceLoad(panel, "a=1", (0, load / 16, 0)))
    result = fl.statics(scene, load_steps=load_steps)
    corner = panel.point("110")
    rise = float(result.displacement(corner)[-1, 1]) / unit
    stresses = fl.post.solid_stresses(result, panel)
    record = {
        "element": element,
        "mesh": mesh,
        "rise": rise,
        "error": abs(rise / reference - 1),
        "iterations": result.total_iterations,
        "failed_iterations": result.failed_iterations,
        "von_mises": float(stresses.smooth("von Mises").max()),
    }
    return record, stresses


def main(
    element: str = "mean",
    mesh: int = 16,
    load_steps: int = 1,
    small: bool = False,
    pictures: bool = True,
) -> dict[str, Any]:
    if element not in ELEMENTS:
        raise ValueError(f"element must be one of {', '.join(ELEMENTS)}, got {element}")
    record, stresses = solve(element, mesh, load_steps, small)
    if pictures:
        path = in_results("cooks_membrane.png")
        stresses.picture(
            path, title="Cook's membrane", units=fl.post.Units(length="length", force="force")
        )
    return record


if __name__ == "__main__":
    run(main, show=True)
