"""A beam of 100 elements, half of which makes steps ten times smaller.

A soft beam hangs from a joint with the ground, turns, swings and bends in space. Its halves are
joined by a fixed joint, over which the multipliers of fem_lie.schemes.MultiRate act. Printed are
the work that these multipliers did, at most, over the largest kinetic energy; the error of all
energy; and seconds against energy-momentum with the small steps everywhere. Then the beam flies and
bends
smoothly, and whole steps are halved: the observed order of frames and velocities.
"""

from __future__ import annotations

import argparse
from itertools import pairwise

import numpy as np

import fem_lie as fl

SOFT = fl.Section.rectangle(0.02, 0.02, fl.Material(E=2e7, nu=0.3, density=1200.0))
LENGTH = 1.0


def beams(elements: int, weight: float) -> tuple[fl.Scene, fl.Beam, fl.Beam]:
    """Both halves, which turn, with a fixed joint between them."""
    scene, half = fl.Scene(gravity=(0, 0, -weight)), 0.5 * LENGTH
    upper, lower = (
        scene.add(fl.Beam.straight((a, 0, 0), (b, 0, 0), SOFT, cells=elements // 2))
        for a, b in ((0.0, half), (half, LENGTH))
    )
    for beam in (upper, lower):
        beam.add_velocity(omega=(0.5, 1.0, -2.0), about=(0, 0, 0))
    scene.add(fl.joints.Fixed(upper.point("end"), lower.point("start")))
    return scene, upper, lower


def swinging(elements: int) -> tuple[fl.Scene, fl.Beam]:
    """The scene under gravity, held at one end, and its lower half."""
    scene, upper, lower = beams(elements, 9.81)
    scene.add(fl.joints.Spherical(fl.ground(), upper.point("start")))
    return scene, lower


def flying(elements: int) -> tuple[fl.Scene, fl.Beam]:
    """The scene without gravity, whose beam begins to bend, and its lower half."""
    scene, upper, lower = beams(elements, 0.0)
    for beam in (upper, lower):
        s = beam.frames[:, 0, 0] / LENGTH
        beam.velocities[:, 2] += np.cos(2.0 * np.pi * s)
        beam.velocities[:, 4] += 2.0 * np.pi / LENGTH * np.sin(2.0 * np.pi * s)
    return scene, lower


def orders(elements: int, count: int, duration: float, numbers: tuple[int, ...]) -> list[float]:
    """Of frames and velocities, from so many steps: the mean of all pairs."""
    ends = []
    for steps in numbers:
        scene, lower = flying(elements)
        given = {"duration": duration, "step": duration / steps, "save_every": steps}
        result = fl.schemes.MultiRate({lower: count}).run(scene, **given)
        ends.append((result.frames[-1], result.velocities[-1]))
    found = []
    for k in range(2):
        changes = [np.abs(a[k] - b[k]).max() for a, b in pairwise(ends)]
        found.append(float(np.log2(changes[0] / changes[-1]) / (len(changes) - 1)))
    return found


def main(
    elements: int = 100, count: int = 10, steps: int = 1000, step: float = 1e-3
) -> dict[str, float]:
    """Figures, printed."""
    scene, lower = swinging(elements)
    scheme = fl.schemes.MultiRate({lower: count})
    result = scheme.run(scene, duration=steps * step, step=step, save_every=10)
    energy = float(result.kinetic.max())
    record: dict[str, float] = {
        "interface_work": float(np.abs(result.balance[:, 0]).max() / energy),
        "energy_error": result.energy_error,
        "joint_violation": float(result.joint_violations.max()),
        "tries_per_step": result.iterations[-1] / steps,
        "matrices": result.factorisations,
        "ms_per_step": 1e3 * result.seconds / steps,
    }
    frames, velocities = orders(elements, count, 2e-3, (40, 80, 160, 320))
    record |= {"order_frames": frames, "order_velocities": velocities}
    scene, _ = swinging(elements)
    small = fl.EnergyMomentum().run(
        scene, duration=steps * step / 10, step=step / count, save_every=count
    )
    record["over_small_steps"] = 0.1 * result.seconds / small.seconds
    for name, value in record.items():
        print(f"{name:20}{value:.4g}")
    return record


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--elements", type=int, default=100)
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--steps", type=int, default=1000)
    parser.add_argument("--step", type=float, default=1e-3)
    main(**vars(parser.parse_args()))
