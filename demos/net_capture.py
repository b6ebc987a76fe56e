"""A net catches a ball, and its winch closes it; nothing acts from outside.

A hexagonal net of cables without torsion has masses at its corners and flies to a free rigid ball.
A rope runs through rings at the ends of short tabs around its edge, then through two eyes of a
winch, which hangs on the edge itself, to a hook. A drive slides the hook along the boom of the
winch away from it, so that the rope draws the edge together below the ball, within its outline.

Threads of net and rope touch the ball, each other and themselves along their length, by penalty;
rings hold the rope by springs without length that slide along it, without friction. Tabs touch
nothing: they are fittings that keep the rope clear of the edge.

Steps are those of the energy-momentum scheme. Momenta are those of the start, energy is that of the
start and the work of the drive. --rings is the number of hexagons of cables about the middle,
--cells that of elements between knots, which is even, --pull-from when the winch begins to pull.
The mouth is the largest distance of the edge from the axis of the ball, over its radius, and its
height that of the edge above the lowest point of the ball. Passages counts how often two threads
went through each other between two steps.
"""

from __future__ import annotations

from time import process_time
from typing import Any

import numpy as np
from command_line import in_results, run
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from net_contacts import BALL, THREAD
from net_passages import passages
from net_scene import capture, hexagons

import fem_lie as fl

VIEW = np.array([[1.0, 0.0], [0.35, 0.3], [0.0, 1.0]])
"""Oblique: x to the right, z upwards, y away."""


def picture(result: fl.Result, scene: fl.Scene) -> None:
    """Six times, from the start to the end, about the ball."""
    figure = Figure(figsize=(13.0, 3.6), layout="constrained")
    panels = figure.subplots(1, 6, sharex=True, sharey=True)
    body = {each.label: each for each in scene.bodies}
    for panel, part in zip(panels, np.linspace(0.0, 1.0, 6), strict=True):
        row = result.index(part * result.times[-1])
        own = {name: result.info.body(name).nodes for name in body}
        positions = (result.frames[row, :, 0] - result.frames[row, own["ball"], 0]) @ VIEW
        panel.add_patch(Circle((0.0, 0.0), BALL, color="#dddddd"))
        for name, colour, width in (("net", "#0072B2", 0.7), ("rope", "#D55E00", 1.4)):
            line = body[name]
            assert isinstance(line, fl.Net)
            cables = list(positions[own[name][line.model.elements]])
            panel.add_collection(LineCollection(cables, colors=colour, linewidths=width))
        boom = positions[np.concatenate([own["winch"], own["hook"]])]
        panel.plot(*boom.T, "ko-", ms=3, lw=0.7)
        panel.set(title=f"t = {1e3 * result.times[row]:.0f} ms", aspect="equal")
    figure.savefig(in_results("net_capture.png"), dpi=110)


def mouth(result: fl.Result, rings: int, cells: int) -> tuple[float, float]:
    """Radius of the edge about the ball's axis, over its own, and height above its lowest point."""
    _, _, edge = hexagons(rings, cells)
    nodes = result.info.body("net").nodes[edge], result.info.body("ball").nodes
    rim = result.frames[-1, nodes[0], 0] - result.frames[-1, nodes[1], 0]
    return float(np.hypot(*rim.T[:2]).max() / BALL), float(rim[:, 2].max() + BALL)


def main(
    rings: int = 2,
    cells: int = 6,
    step: float = 2.5e-4,
    time: float = 0.38,
    pull_from: float = 0.08,
    pictures: bool = True,
) -> dict[str, Any]:
    scene, elements = capture(rings, cells, pull_from)
    started = process_time()
    result = fl.EnergyMomentum().run(scene, duration=time, step=step, progress=False)
    used = process_time() - started
    if pictures:
        picture(result, scene)
    threads = [body for body in scene.bodies if body.label in ("net", "rope")]
    on_ball, *on_threads = (
        fl.post.contact_forces(result, contact)
        for contact in scene.contacts
        if contact.name in ("net-ball", "net-itself", "rope-itself", "net-rope")
    )
    wide, height = mouth(result, rings, cells)
    return {
        "elements": elements,
        "steps": len(result.times) - 1,
        "balance_error": result.balance_error,
        "momentum_error": result.momentum_error,
        "angular_momentum_error": result.angular_momentum_error,
        "work_over_energy": float(result.total_energy[-1] / result.total_energy[0] - 1.0),
        "touching_ball": int(on_ball.touching.max()),
        "touching_threads": int(sum(each.touching for each in on_threads).max()),
        "overlap": max(float(each.penetration.max()) for each in on_threads) / (2.0 * THREAD),
        "mouth": wide,
        "height": height,
        "passages": passages(result, threads),
        "steps_in_parts": result.divided,
        "milliseconds_per_step": 1e3 * used / (len(result.times) - 1),
        "iterations_per_step": float(result.iterations[-1]) / (len(result.times) - 1),
    }


if __name__ == "__main__":
    run(main, show=True)
