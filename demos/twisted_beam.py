"""A cantilever with a pre-twist of 90 degrees bends out of the plane of its load.

The beam of the BeamDyn benchmark: straight along x, length 10, stiffnesses EA = 2.5e10,
GA = 8.26e9, GJ = 1.42e8 and EI2 = 5.2e8, EI3 = 1.3e8 about the section's axes. These axes are y and
z at the clamp and turn about x, evenly along the beam, by +90 degrees. A force of 4e6 against z,
fixed in space, acts on the tip. Where the weak axis lies askew to the force, the beam gives way
sideways: a third of its deflection is along y.

A twist is nothing but frames that turn along the line. In the element's relative motion
d_0 = log(inv(H_A) H_B) = length (1, 0, 0, pi/20, 0, 0) it is exact, as the edges of the bar are
helices, the geodesics of SE(3); and so is the flexibility of the element, for small deflections.
What is left is that curvature and twist change with the load and are constant in a cell: an error
of second order.

The reference is the solution of the differential equations of the same rod, by shooting, to nine
digits. tip_x, tip_y, tip_z are the *displacement* of the tip.
"""

from __future__ import annotations

from math import log2, pi
from typing import Any

import numpy as np
from command_line import in_results, run
from diagrams import COLOURS, diagram

import fem_lie as fl

REFERENCE = np.array([-1.141526, -1.718053346, -3.59321324])
LENGTH = 10.0
STIFFNESS = [2.5e10, 8.2604167e9, 8.2604167e9, 1.41872656e8, 5.20833e8, 1.30208333e8]


def solve(elements: int, load_steps: int) -> tuple[dict[str, Any], fl.StaticResult, fl.Scene]:
    """Load it; a record of numbers, the equilibrium states, and the scene."""
    outline = [(-0.25, -0.5), (0.25, -0.5), (0.25, 0.5), (-0.25, 0.5)]  # for the picture only
    scene = fl.Scene()
    beam = scene.add(
        fl.Beam.straight(
            (0, 0, 0),
            (LENGTH, 0, 0),
            fl.Section.from_stiffness(STIFFNESS, outline=outline),
            cells=elements,
            name="blade",
            up=fl.sections.Twisted(lambda s: 0.5 * pi * s / LENGTH, (0, 0, 1)),
        )
    )
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), force=(0, 0, -4e6)))
    result = fl.statics(scene, load_steps=load_steps)
    tip = result.position(beam.point("end"))[-1] - beam.point("end").position
    record = {
        "elements": elements,
        "load_steps": load_steps,
        **{f"tip_{axis}": float(value) for axis, value in zip("xyz", tip, strict=True)},
        "tip_error": float(np.linalg.norm(tip - REFERENCE) / np.linalg.norm(REFERENCE)),
        "iterations": result.total_iterations,
    }
    return record, result, scene


def main(elements: int = 16, load_steps: int = 2, pictures: bool = True) -> dict[str, Any]:
    errors = {}
    for count in sorted({4, 8, 16, 32, elements}):
        numbers, result, scene = solve(count, load_steps)
        errors[count] = numbers["tip_error"]
        if count == elements:
            record, chosen, shown = numbers, result, scene
    record["order"] = log2(errors[8] / errors[32]) / 2
    if pictures:
        bent, frames = in_results("twisted_beam.png"), in_results("twisted_beam_frames.png")
        chosen.picture(bent, trace=["blade.end"], title="Beam with a pre-twist of 90°")
        shown.picture(frames, frames=True, title="Nodal frames of a twisted beam")
        plot_errors(errors)
    return record


def plot_errors(errors: dict[int, float]) -> None:
    """Error over elements."""
    count, error = np.array(list(errors)), np.array(list(errors.values()))
    with diagram("twisted_beam_convergence.png") as axes:
        axes.loglog(count, error, "o-", color=COLOURS[0], label="geodesic element")
        axes.loglog(count, 0.5 * error[0] * (count[0] / count) ** 2, "k:", label="second order")
        axes.set(xlabel="elements", ylabel="error of the tip, relative", title="Twisted beam")
        axes.set_xticks(count, [str(n) for n in count])
        axes.minorticks_off()


if __name__ == "__main__":
    run(main, show=True)
