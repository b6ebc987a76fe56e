"""Coarse steps: what a soft beam of many elements that falls costs with steps of 2, 4 and 8 ms.

    tools/run python3 -m benchmarks.whips [--cells 200] [--rounds 4]

Beams of 1 m, 0.02 m square, hang from a ball joint, fall from the horizontal and whip, by
generalised-α with radius 0.8. Printed are iterations per step, matrices of mass and stiffness and
of constraints, and the processor time of the run, the least of all rounds.
"""

from __future__ import annotations

import argparse
from time import process_time

import fem_lie as fl

MODULI = {2e6: 2.0, 2e7: 3.0}
"""Young's moduli, N/m², and how long each beam falls, s."""

STEPS = (2e-3, 4e-3, 8e-3)


def whip(modulus: float, cells: int) -> fl.Scene:
    """A beam that hangs from ground, in the horizontal."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    material = fl.Material(E=modulus, nu=0.3, density=1200.0)
    section = fl.Section.rectangle(0.02, 0.02, material)
    beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=cells))
    scene.add(fl.joints.Spherical(fl.ground(), beam.point("start")))
    return scene


def main() -> None:
    """Print a row for each beam and step."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--cells", type=int, default=200)
    parser.add_argument("--rounds", type=int, default=4)
    given = parser.parse_args()
    for modulus, duration in MODULI.items():
        for step in STEPS:
            least, steps = float("inf"), round(duration / step)
            for _ in range(given.rounds):
                scene, before = whip(modulus, given.cells), process_time()
                result = fl.GeneralisedAlpha(radius=0.8).run(
                    scene, duration=duration, step=step, save_every=steps, progress=False
                )
                least = min(least, process_time() - before)
            print(
                f"E = {modulus:g}, step {step:g}: {result.iterations[-1] / steps:.2f} iterations "
                f"per step, {result.k_updates} and {result.phi_updates} matrices, {least:.3f} s",
                flush=True,
            )


if __name__ == "__main__":
    main()
