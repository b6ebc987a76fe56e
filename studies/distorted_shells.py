"""What a drilling rotation in the element gains on distorted meshes.

A slender cantilever (6 × 0.2 × 0.1) of six cells in a row, under a unit force at its end, within
its plane and across it (MacNeal & Harder, Finite Elem. Anal. Des. 1 (1985) 3). Cells are
rectangles, trapezoids or parallelograms, whose cuts are at 45 degrees. The elements are the mixed
one with five parameters, the same with a drilling rotation that a term of its own ties to the
surface, and the one of geodesic edges, whose membrane strains use the drilling rotation. Values are
deflections over those of beam theory.
"""

from __future__ import annotations

from typing import Any

import numpy as np

import fem_lie as fl
from demos.command_line import run

LENGTH, WIDTH, THICKNESS, E, NU = 6.0, 0.2, 0.1, 1e7, 0.3
CELLS = 6
ELEMENTS: dict[str, dict[str, Any]] = {
    "five": {"formulation": fl.elements.HellingerReissner(), "drilling": False},
    "drilling_term": {"formulation": fl.elements.HellingerReissner(), "drilling": True},
    "geodesic": {"formulation": fl.elements.GeodesicShell()},
}
CUTS = {"rectangles": (0.0, 0.0), "trapezoids": (1.0, -1.0), "parallelograms": (1.0, 1.0)}
"""Slopes of the cuts between cells, in turns."""


def cantilever(cells: str, element: dict[str, Any]) -> fl.Shell:
    """The strip, clamped at its start."""
    slopes = CUTS[cells]

    def position(a: float, b: float) -> tuple[float, float, float]:
        cut = round(a * CELLS)
        slope = slopes[cut % 2] if 0 < cut < CELLS else 0.0
        return LENGTH * a + slope * WIDTH * (b - 0.5), WIDTH * b, 0.0

    layer = fl.ShellSection.layer(THICKNESS, fl.Material(E, NU, 1.0))
    mesh = fl.mesh.parametric_surface(position, (CELLS, 1))
    shell = fl.Shell(mesh, layer, along=(1, 0, 0), **element)
    shell.clamp("a=0")
    return shell


def deflection(cells: str, element: dict[str, Any], direction: int) -> float:
    """Deflection at the end along a global axis, over that of beam theory."""
    scene = fl.Scene()
    shell = scene.add(cantilever(cells, element))
    force = 1e-6 * np.eye(3)[direction]
    for corner in "10", "11":
        scene.add(fl.PointLoad(shell.point(corner), force=force / 2))
    found = fl.statics(scene).displacement(shell.point("10"))[-1, direction]
    side, other = (WIDTH, THICKNESS) if direction == 1 else (THICKNESS, WIDTH)
    bending = LENGTH**3 / (3 * E * other * side**3 / 12)
    shear = LENGTH / (5 / 6 * E / (2 + 2 * NU) * WIDTH * THICKNESS)
    return float(found / (1e-6 * (bending + shear)))


def main() -> dict[str, Any]:
    """Deflections by cells and element."""
    return {
        cells: {
            f"{name}_{plane}": deflection(cells, element, direction)
            for name, element in ELEMENTS.items()
            for plane, direction in (("in_plane", 1), ("across", 2))
        }
        for cells in CUTS
    }


if __name__ == "__main__":
    run(main, show=True)
