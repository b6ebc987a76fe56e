"""A flat cantilever is bent by a shear force at its end: the elastica, as a shell.

Length 10, width 1, thickness 0.1, E = 1.2e6, no Poisson's ratio, so that EI = 100. The force 4,
fixed in space, is spread over the end. K. Y. Sze, X. H. Liu & S. H. Lo, Finite Elem. Anal. Des. 40
(2004) 1551. The deflection is two thirds of the length; without Poisson's ratio the solution is the
elastica but for stretch and shear, which are of the order (thickness/length)^2.

References at quarters of the load: displacement elements of degree 3 for the same shell, all digits
converged: shortening and deflection of the end.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from command_line import in_results, run

import fem_lie as fl

HERE = Path(__file__).parent
LENGTH, WIDTH, THICKNESS, FORCE = 10.0, 1.0, 0.1, 4.0
REFERENCE = {
    0.25: (0.564387, 3.017388),
    0.5: (1.606563, 4.934876),
    0.75: (2.544419, 6.032923),
    1.0: (3.289678, 6.700108),
}
UNITS = fl.post.Units(length="length")


def strip(cells: int) -> fl.Scene:
    """The cantilever, one cell wide."""
    shell = fl.Shell(
        fl.mesh.parametric_surface(lambda a, b: (LENGTH * a, WIDTH * b, 0.0), (cells, 1)),
        fl.ShellSection.layer(THICKNESS, fl.Material(1.2e6, 0.0, 1.0)),
        name="strip",
    )
    shell.clamp("a=0")
    scene = fl.Scene()
    scene.add(shell)
    scene.add(fl.loads.EdgeLoad(shell, "a=1", force=(0, 0, FORCE / WIDTH)))
    return scene


def main(cells: int = 16, pictures: bool = True) -> dict[str, Any]:
    result = fl.follow_loads(strip(cells), list(REFERENCE))
    moved = result.position("strip.10") - [LENGTH, 0.0, 0.0]
    found = moved[:, [0, 2]] * [-1.0, 1.0]
    errors = found / np.array(list(REFERENCE.values())) - 1.0
    record = {
        "cells": cells,
        "shortening": float(found[-1, 0]),
        "deflection": float(found[-1, 1]),
        "path_error": float(np.abs(errors).max()),
        "load_steps": result.load_steps,
        "iterations": result.total_iterations,
        "failed_iterations": result.failed_iterations,
        "seconds": result.seconds,
    }
    if pictures:
        picture = in_results("cantilever_shear.png")
        result.picture(picture, title="Cantilever under end shear", units=UNITS)
    return record


if __name__ == "__main__":
    run(main, show=True)
