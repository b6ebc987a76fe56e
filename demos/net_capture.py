"""A net catches a ball, and its rope closes it.

A hexagonal net of cables without torsion has masses at its corners and flies towards a fixed rigid
ball. A rope runs through rings at the points of its edge; both its ends are tied to a mass beside
the net, which is pulled after the ball is met, and the edge is drawn together below the ball:
within its outline in the end, so that it does not come out. Cables and rope are discrete cables,
which touch the ball with balls about their nodes, by penalty; rings hold the rope by springs
without length that slide along it, without friction.

Steps are those of the energy-momentum scheme. Until the rope is pulled nothing acts from outside
but the ball, which holds by its reaction: energy is that of the start, and momenta are what the
reaction has taken. --rings is the number of hexagons of cables about the middle, --cells that of
elements between knots, --pull-from when the rope begins to be pulled, --secants how many of the
last corrections of a step the next one learns from. The mouth is the largest distance of the edge
from the axis, over the radius of the ball, and its height that of the edge above the lowest point
of the ball.
"""

from __future__ import annotations

from time import process_time
from typing import Any

import numpy as np
from command_line import in_results, run
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from net_scene import BALL, capture, mouth

import fem_lie as fl

VIEW = np.array([[1.0, 0.0], [0.35, 0.3], [0.0, 1.0]])
"""Oblique: x to the right, z upwards, y away."""


def picture(result: fl.Result, scene: fl.Scene) -> None:
    """Six times, from the start to the end."""
    figure = Figure(figsize=(13.0, 5.0), layout="constrained")
    panels = figure.subplots(1, 6, sharex=True, sharey=True)
    net, rope, *masses = scene.bodies
    assert isinstance(net, fl.Net)
    assert isinstance(rope, fl.Net)
    for panel, part in zip(panels, np.linspace(0.0, 1.0, 6), strict=True):
        row = result.index(part * result.times[-1])
        positions, nodes = result.frames[row, :, 0] @ VIEW, result.info.body
        panel.add_patch(Circle((0.0, 0.0), BALL, color="#dddddd"))
        for body, colour, width in ((net, "#0072B2", 0.7), (rope, "#D55E00", 1.4)):
            cables = list(positions[nodes(body.name).nodes[body.model.elements]])
            panel.add_collection(LineCollection(cables, colors=colour, linewidths=width))
        at = np.array([positions[nodes(mass.name).nodes[0]] for mass in masses])
        panel.plot(*at.T, "ko", ms=4)
        panel.set(title=f"t = {1e3 * result.times[row]:.0f} ms", aspect="equal")
    figure.savefig(in_results("net_capture.png"), dpi=110)


def main(
    rings: int = 3,
    cells: int = 4,
    step: float = 4e-4,
    time: float = 0.15,
    pull_from: float = 0.04,
    secants: int = 0,
    pictures: bool = True,
) -> dict[str, Any]:
    scene, elements = capture(rings, cells, pull_from)
    started = process_time()
    scheme = fl.EnergyMomentum(policy=fl.schemes.Automatic(secants=secants))
    result = scheme.run(scene, duration=time, step=step, progress=False)
    used = process_time() - started
    if pictures:
        picture(result, scene)
    free, (wide, height) = result.times <= pull_from, mouth(result, rings, cells)
    energy = result.total_energy[free]
    return {
        "elements": elements,
        "steps": len(result.times) - 1,
        "energy_error": float(np.abs(energy / energy[0] - 1.0).max()),
        "momentum_error": result.momentum_error,
        "angular_momentum_error": result.angular_momentum_error,
        "balance_error": result.balance_error,
        "touching": int(fl.post.contact_forces(result, scene.contacts[1]).touching[-1]),
        "mouth": wide,
        "height": height,
        "steps_in_parts": result.divided,
        "milliseconds_per_step": 1e3 * used / (len(result.times) - 1),
        "iterations_per_step": float(result.iterations[-1]) / (len(result.times) - 1),
    }


if __name__ == "__main__":
    run(main, show=True)
