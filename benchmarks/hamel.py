"""A sledge on an edge and a disc that rolls, by Hamel's form, over very many steps.

Chaplygin's sledge runs on an inclined plane, the disc of rolling_disc.py runs round on a level one.
Printed are, for each: how much the energy differs from the first at most, the drift of a line
fitted to it over the run, the slip or gap of the constraint at most, and microseconds per step.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

import fem_lie as fl
from demos.rolling_disc import disc

AHEAD = 0.3


def sledge() -> tuple[fl.Scene, fl.joints.Joint]:
    """Chaplygin's, on a plane whose gravity is along it."""
    scene = fl.Scene(gravity=(0.5, 0, 0))
    body = scene.add(fl.RigidBody(1.5, (0.05, 0.05, 0.05)))
    at = (-AHEAD, 0, 0)
    blade = scene.add(fl.joints.KnifeEdge(fl.ground(), body.point("centre"), at=at, axis=(0, 1, 0)))
    body.add_velocity(omega=(0, 0, 2.0), about=at)
    body.add_velocity((-0.5, 0, 0))
    return scene, blade


def rolling() -> tuple[fl.Scene, fl.joints.Joint]:
    """The disc of the demo."""
    scene, _, contact = disc(np.radians(20.0), 12.0, 1.0)
    return scene, contact


def main(steps: int = 1_000_000, step: float = 1e-3, states: int = 1000) -> dict[str, float]:
    """Figures, printed."""
    record: dict[str, float] = {}
    kept = fl.schemes.Record.ENERGIES | fl.schemes.Record.COORDINATES
    for name, build in (("sledge", sledge), ("disc", rolling)):
        scene, joint = build()
        every, clock = max(1, steps // states), time.process_time()
        result = fl.schemes.Hamel().run(
            scene, duration=steps * step, step=step, save_every=every, record=kept
        )
        seconds = time.process_time() - clock
        energy = result.total_energy
        scale = float(result.kinetic.max())
        slope, _ = np.polyfit(result.times, energy, 1)
        record[f"{name}_energy"] = float(np.abs(energy - energy[0]).max() / scale)
        record[f"{name}_drift"] = float(abs(slope) * result.times[-1] / scale)
        record[f"{name}_constraint"] = float(result.joint_violation(joint).max())
        record[f"{name}_us_per_step"] = 1e6 * seconds / steps
    for key, value in record.items():
        print(f"{key:24}{value:.3g}")
    return record


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=1_000_000)
    parser.add_argument("--step", type=float, default=1e-3)
    main(**vars(parser.parse_args()))
