"""A shell of any formulation on a map of the unit square, by its name."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import fem_lie as fl

AnyShell = fl.Shell | fl.ThinShell | fl.AncfShell
FORMULATIONS: dict[str, fl.elements.ShellFormulation] = {
    "HR": fl.elements.HellingerReissner(),
    "HW": fl.elements.HuWashizu(),
    "MITC4": fl.elements.DisplacementBased(),
    "geodesic": fl.elements.GeodesicShell(),
    "HR+": fl.elements.HellingerReissner(fl.elements.MITC4_PLUS),
}
PATCHES = {
    "thin": fl.mesh.smooth_patch,
    "spline": fl.mesh.spline_patch,
    "ancf": fl.mesh.smooth_patch,
}
"""What thin shells, without shear, lie on: the surface itself, or a spline through its nodes; and
plates of positions and three slopes."""
KNOWN = [*FORMULATIONS, *PATCHES]


def any_shell(
    formulation: str,
    position: Callable[[float, float], np.ndarray],
    cells: tuple[int, int],
    section: fl.ShellSection,
    director: Callable[[np.ndarray], np.ndarray],
    *,
    along: tuple[float, float, float] | None = None,
    name: str = "shell",
) -> AnyShell:
    """On a mesh, or a thin one on a patch; edges and corners have the same names."""
    if formulation in PATCHES:
        patch = PATCHES[formulation](position, cells)
        make = fl.AncfShell if formulation == "ancf" else fl.ThinShell
        return make(patch, section, along=along, name=name)
    return fl.Shell(
        fl.mesh.parametric_surface(position, cells),
        section,
        director=director,
        along=along,
        formulation=FORMULATIONS[formulation],
        name=name,
    )


def about_x(x: np.ndarray) -> np.ndarray:
    """Normal of a cylinder about the axis x."""
    return np.array([0.0, x[1], x[2]]) / np.hypot(x[1], x[2])
