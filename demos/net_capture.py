"""A net catches a ball, and its rope closes it.

A hexagonal net of threads without torsion has masses at its corners and flies towards a fixed rigid
ball. A rope runs through rings at the points of its edge; both ends of it are pulled after the
ball is wrapped, and the edge is drawn together. Threads and rope are discrete cables, which touch
the ball with balls about their nodes, by penalty; rings hold the rope by springs without length
that slide along it, without friction.

Steps are those of the energy-momentum scheme. Until the rope is pulled nothing acts from outside
but the ball, which holds by its reaction: energy is that of the start, and momenta are what the
reaction has taken. --rings is the number of hexagons of threads about the middle, --cells that of
elements between knots.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import run
from net_scene import capture, motion

import fem_lie as fl


def main(
    rings: int = 3,
    cells: int = 6,
    step: float = 2e-4,
    time: float = 0.08,
    pictures: bool = True,
) -> dict[str, Any]:
    start = 0.6 * time
    scene, elements = capture(rings, cells, start)
    result = fl.EnergyMomentum().run(scene, duration=time, step=step, progress=False)
    if pictures:
        motion(result, scene, "net_capture")
    free = result.times <= start
    energy = result.total_energy[free]
    return {
        "elements": elements,
        "steps": len(result.times) - 1,
        "energy_error": float(np.abs(energy / energy[0] - 1.0).max()),
        "momentum_error": result.momentum_error,
        "angular_momentum_error": result.angular_momentum_error,
        "balance_error": result.balance_error,
        "touching": int(fl.contact_forces(result, scene.contacts[1]).touching[-1]),
        "milliseconds_per_step": 1e3 * result.seconds / (len(result.times) - 1),
        "iterations_per_step": float(result.iterations[-1]) / (len(result.times) - 1),
    }


if __name__ == "__main__":
    run(main, show=True)
