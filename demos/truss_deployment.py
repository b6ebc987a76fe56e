r"""Deployable truss: with local frames the iteration matrix of a large motion hardly changes.

The example of Figure 23 and Table 1 of the paper on local frames. The layout of its cell is not
published; this one has the same size, count of bars, kinds of joints and law of deployment, and is
stated here in full.

The scene is that of truss_scene.py.

Hollow round steel bars, inner and outer diameter 0.055/0.08 m (stiff) or 0.023/0.024 m (thin). With
the stiff ones geometric stiffness is left out of the iteration matrix.

The numbers: k_updates and phi_updates count every matrix of mass and stiffness and every Jacobian
of the constraints, the first included; max_deflection is the largest distance of a bar's axis from
its chord over the bar's length, max_strain that of a fibre; posture_error is the largest distance
of a corner from where rigid bars have it, in the equilibrium at the end of the law (statics along
the law, without inertia), off_at_end the same at the end of the motion, while the truss swings.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import in_results, one_of, run
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from reference.truss import DEPLOYMENT, bending, off_posture
from truss_scene import Truss

import fem_lie as fl

OBLIQUE = np.array([[1.0, 0.0], [0.4, 0.25], [0.0, 1.0]])  # side view, y into the depth
COLOURS = 8 * ["#888888"] + 4 * ["#D55E00"] + 16 * ["#56B4E9"]  # of the bars of a cell
STEEL = fl.Material(E=2.1e11, nu=0.3, density=7850.0)
DIAMETERS = {"stiff": (0.055, 0.08), "thin": (0.023, 0.024)}
POLICIES: dict[str, fl.schemes.RefactorisationPolicy] = {
    "full": fl.schemes.EveryIteration(),
    "nni4": fl.schemes.IterationLimit(4),
    "frozen": fl.schemes.ConstraintsOnly(4),
    "auto": fl.schemes.Automatic(),
}


def main(
    cells: int = 2,
    tubes: str = "stiff",
    step: float = 2e-3,
    policy: str = "auto",
    elements: int = 10,
    driven: int | None = None,
    duration: float = DEPLOYMENT,
    tolerance: float = fl.GeneralisedAlpha.tolerance,
    inertial: bool = False,
    pictures: bool = True,
) -> dict[str, Any]:
    one_of("tubes", tubes, DIAMETERS)
    one_of("policy", policy, POLICIES)
    inner, outer = (0.5 * diameter for diameter in DIAMETERS[tubes])
    matrix_terms = fl.schemes.MatrixTerms(geometric=tubes == "thin")
    driven = (1 if cells <= 2 else 4) if driven is None else driven
    truss = Truss(cells, fl.Section.tube(inner, outer, STEEL), elements, driven, matrix_terms)
    axes, kept = fl.schemes.MatrixFrame(int(inertial)), POLICIES[policy]
    scheme = fl.GeneralisedAlpha(radius=0.8, tolerance=tolerance, policy=kept, matrix_frame=axes)
    steps, every = round(duration / step), max(1, round(duration / step) // 500)
    result = scheme.run(truss.scene, duration=steps * step, step=step, save_every=every)
    deflection, strain = bending(result, truss.bars, outer)
    if pictures:
        picture(result, truss, f"truss_deployment_{tubes}")
    return {
        "cells": cells,
        "tubes": tubes,
        "policy": policy,
        "inertial": inertial,
        "step": step,
        "steps": steps,
        "bars": len(truss.bars),
        "iterations": int(result.iterations[-1]),
        "k_updates": result.k_updates,
        "phi_updates": result.phi_updates,
        "ms_per_step": 1e3 * result.seconds / steps,
        "max_deflection": deflection,
        "max_strain": strain,
        "off_at_end": off_posture(result, truss.frames, steps * step),
        "posture_error": posture_error(truss, steps * step),
        "violation": float(result.joint_violations.max()),
    }


def posture_error(truss: Truss, time: float) -> float:
    """How far corners are off in the equilibrium that statics along the law reaches."""
    found = fl.statics(truss.scene, levels=np.linspace(0.0, time, 21)[1:])
    return off_posture(found, truss.frames, time)


def picture(result: fl.Result, truss: Truss, name: str) -> None:
    """Figure 23: the truss at six times, longerons, battens and telescopes in a colour each."""
    figure = Figure(figsize=(15.0, 4.5), layout="constrained")
    panels = figure.subplots(1, 6, sharex=True, sharey=True)
    nodes = np.array([result.info.body(bar.name).nodes for bar in truss.bars])
    for panel, time in zip(panels, np.linspace(0.0, result.times[-1], 6), strict=True):
        axes = result.frames[result.index(time), nodes, 0] @ OBLIQUE
        colours = COLOURS * (len(axes) // len(COLOURS))
        panel.add_collection(LineCollection(list(axes), colors=colours, linewidths=1.2))
        panel.set(title=f"t = {time:g} s", aspect="equal", xlabel="x [m]")
        panel.autoscale_view()
    panels[0].set_ylabel("z [m]")
    figure.savefig(in_results(f"{name}.png"), dpi=120)
    result.animate(in_results(f"{name}.gif"), title="Deployable truss")


if __name__ == "__main__":
    run(main, show=True)
