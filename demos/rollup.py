"""A straight cantilever is rolled up to a full circle by a moment at its tip.

Length L = 10, EI = GJ = 100, tip moment M = 2 pi EI / L about e_3, fixed in space. The moment is
the same everywhere, so the curvature is kappa = M / EI, a circle of circumference L: the tip comes
back to the clamp. Two-node elements along geodesics of SE(3) hold any helix, hence any circle:

    d = log(inv(H_A) H_B),     strain (d - d_0) / length,     N = D strain,

so the only error is that of the iteration. The difficulty is another one. The stiffness ratio

    R = EA L^2 / EI

is 12 (L / thickness)^2 for a rectangle. An iteration of Newton's method leaves false stretches of
second order in the turn it makes; they are answered by EA, so their forces are R times as large as
those of bending, and the geometric stiffness of these false forces spoils the next matrix. The
remedy is to make the stress an iterate of its own (D. Magisano, L. Leonetti & G. Garcea, CMAME 313
(2017) 986): the matrix takes

    N <- D (strain(q) + B dq),

carried on from the last iteration, in which the false stretch is not, while the residual takes the
true stress. It has the same solutions and costs six numbers per element. --plain-newton runs
Newton's method beside it.
"""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np
from command_line import in_results, run

import fem_lie as fl

LENGTH, BENDING = 10.0, 100.0
UNITS = fl.post.Units(length="length")


def cantilever(elements: int, stiffness_ratio: float) -> tuple[fl.Scene, fl.Beam]:
    """The scene and its beam."""
    EA = stiffness_ratio * BENDING / LENGTH**2
    stiffness = np.diag([EA, EA / 2, EA / 2, BENDING, BENDING, BENDING])
    outline = [(-0.04, -0.4), (0.04, -0.4), (0.04, 0.4), (-0.04, 0.4)]  # for the picture only
    section = fl.Section.from_stiffness(stiffness, outline=outline)
    scene = fl.Scene()
    beam = scene.add(fl.Beam.straight((0, 0, 0), (LENGTH, 0, 0), section, cells=elements))
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), moment=(0, 0, 2 * pi * BENDING / LENGTH)))
    return scene, beam


def main(
    elements: int = 8,
    load_steps: int = 6,
    stiffness_ratio: float = 1e8,
    plain_newton: bool = False,
    pictures: bool = True,
) -> dict[str, Any]:
    scene, beam = cantilever(elements, stiffness_ratio)
    result = fl.statics(scene, load_steps=load_steps)
    tip = result.position(beam.point("end"))[-1]
    iterations = result.total_iterations
    record: dict[str, Any] = {
        "elements": elements,
        "load_steps": load_steps,
        "stiffness_ratio": stiffness_ratio,
        **{f"tip_{axis}": float(value) for axis, value in zip("xyz", tip, strict=True)},
        "tip_error": float(np.linalg.norm(tip) / LENGTH),
        "steps": len(result.factors),
        "iterations": iterations,
        "failed_iterations": result.failed_iterations,
        "iterations_per_step": iterations / load_steps,
    }
    if plain_newton:
        record |= plain(elements, load_steps, stiffness_ratio)
    if pictures:
        path = in_results("rollup.png")
        result.picture(path, title="Cantilever rolled up to a circle", units=UNITS)
    return record


def plain(elements: int, load_steps: int, stiffness_ratio: float) -> dict[str, Any]:
    """The same by Newton's method, step halving included."""
    scene, _ = cantilever(elements, stiffness_ratio)
    try:
        result = fl.statics(
            scene, load_steps=load_steps, newton=fl.schemes.Newton(linearised_stress=False)
        )
    except fl.ConvergenceError:
        return {"plain_converged": False}
    iterations = result.total_iterations
    return {
        "plain_converged": True,
        "plain_steps": len(result.factors),
        "plain_iterations": iterations,
        "plain_failed_iterations": result.failed_iterations,
    }


if __name__ == "__main__":
    run(main, show=True)
