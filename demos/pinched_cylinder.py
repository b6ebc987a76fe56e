"""A cylinder between two diaphragms is pinched by two opposite forces: folds, and snaps on the way.

Radius 100, length 200, thickness 1, E = 30e3, nu = 0.3. At both ends a rigid diaphragm holds all
displacements in its plane and leaves those along the axis, and the directors, free. The forces,
12000 each at full load, push two opposite points at mid-length inward until they nearly meet.
Symmetry leaves an eighth. K. Y. Sze, X. H. Liu & S. H. Lo, Finite Elem. Anal. Des. 40 (2004) 1551,
with 48 x 48 elements.

Between a tenth and a fifth of the load the cylinder snaps more than once. There the deflections
depend on the mesh, and different solutions differ by 20 %; the errors are taken beyond. Where the
load falls the path is followed all the same.

The published values are not the limit of fine meshes. At full load the deflection at a right angle
is 35.419, 35.590, 35.712 with 48, 64 and 96 cells along an edge, which is 35.81 less 900/mesh^2,
and the published 34.27 is 4.3 % below that; at 0.3 of the load it is 8 % below. Under the force,
where the deflection grows with the logarithm of the mesh, it is 1 % below. Elements of degree 4 on
14 x 18 cells, not converged either, are 0.4 % and 1.4 % above the limits. So more cells go away
from the published values: "others" below is the better measure.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from any_shell import KNOWN, about_x, any_shell
from command_line import in_results, one_of, run
from records import of_loading

import fem_lie as fl

HERE = Path(__file__).parent
RADIUS, HALF_LENGTH, THICKNESS, FORCE = 100.0, 100.0, 1.0, 12000.0
UNITS = fl.post.Units(length="length")
# load factor: deflections inward under the force, and outward at a right angle from it
PUBLISHED = {
    0.05: (9.561, -0.233),
    0.1: (23.164, -2.391),
    0.3: (65.498, 17.979),
    0.5: (73.79, 25.381),
    0.75: (79.339, 30.604),
    1.0: (83.102, 34.272),
}
# displacement elements of degree 4 on 14 x 18 cells, not converged
OTHER = {
    0.05: (9.630, -0.2377),
    0.1: (23.734, -2.467),
    0.3: (66.732, 19.561),
    0.5: (75.144, 27.406),
    0.75: (80.043, 31.832),
    1.0: (84.244, 36.310),
}
COMPARED = 0.25  # errors are taken from this load factor on


def position(a: float, b: float) -> np.ndarray:
    """From the loaded line to the one at a right angle, and from the middle to the end."""
    angle = a * np.pi / 2
    return np.array([HALF_LENGTH * b, -RADIUS * np.sin(angle), RADIUS * np.cos(angle)])


def pinched(mesh: int, formulation: str) -> fl.Scene:
    """An eighth with its supports and its load."""
    section = fl.ShellSection.layer(THICKNESS, fl.Material(30e3, 0.3, 1.0))
    shell = any_shell(formulation, position, (mesh, mesh), section, about_x, name="cylinder")
    shell.symmetry("b=0", (1, 0, 0))
    shell.symmetry("a=0", (0, 1, 0))
    shell.symmetry("a=1", (0, 0, 1))
    shell.roller("b=1", (0, 1, 0))
    shell.roller("b=1", (0, 0, 1))
    scene = fl.Scene()
    scene.add(shell)
    scene.add(fl.PointLoad(shell.point("00"), force=(0, 0, -FORCE / 4)))
    return scene


def main(mesh: int = 40, formulation: str = "HR", pictures: bool = True) -> dict[str, Any]:
    one_of("formulation", formulation, KNOWN)
    result = fl.follow_loads(pinched(mesh, formulation), list(PUBLISHED))
    inward = RADIUS - result.position("cylinder.00")[:, 2]
    outward = -RADIUS - result.position("cylinder.10")[:, 1]
    found = np.column_stack([inward, outward])
    errors = found / np.array(list(PUBLISHED.values())) - 1.0
    others = found / np.array(list(OTHER.values())) - 1.0
    late = np.array([factor >= COMPARED for factor in PUBLISHED])
    if pictures:
        file = in_results("pinched_cylinder.png")
        result.picture(file, title="Pinched cylinder, an eighth", units=UNITS)
    return {
        "mesh": mesh,
        "formulation": formulation,
        "deflection_a": float(found[-1, 0]),
        "deflection_b": float(found[-1, 1]),
        "error_a": float(errors[-1, 0]),
        "error_b": float(errors[-1, 1]),
        "late_error_a": float(np.abs(errors[late, 0]).max()),
        "late_error_b": float(np.abs(errors[late, 1]).max()),
        "other_error_a": float(others[-1, 0]),
        "other_error_b": float(others[-1, 1]),
        **of_loading(result),
    }


if __name__ == "__main__":
    run(main, show=True)
