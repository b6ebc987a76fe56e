"""What a cable at rest beside a pendulum costs per step of the conserving scheme.

    RUN -m benchmarks.cable_at_rest [--rounds 9]

Both scenes run for two numbers of steps in turns, so that what is done once drops out; the ratio is
that of the medians.
"""

from __future__ import annotations

import argparse
from statistics import median
from time import process_time

import fem_lie as fl
from benchmarks.short_runs import pendulum, pendulum_beside

FEW, MANY, STEP = 1000, 5000, 1e-4


def seconds(scene: fl.Scene, steps: int) -> float:
    """Processor time of a run."""
    before = process_time()
    options = {"duration": steps * STEP, "step": STEP, "progress": False, "save_every": steps}
    fl.EnergyMomentum().run(scene, **options)
    return process_time() - before


def main() -> None:
    """Print times per step and their ratio."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--rounds", type=int, default=9)
    rounds = parser.parse_args().rounds
    scenes = {"pendulum": pendulum(1), "with a cable at rest": pendulum_beside("cable")}
    found: dict[str, list[float]] = {name: [] for name in scenes}
    for scene in scenes.values():
        seconds(scene, 10)  # what is compiled is there then
    for _ in range(rounds):
        for name, scene in scenes.items():
            difference = seconds(scene, MANY) - seconds(scene, FEW)
            found[name].append(1e6 * difference / (MANY - FEW))
    alone, beside = (median(times) for times in found.values())
    for name, times in found.items():
        print(f"{name:22} {median(times):7.1f} us / step")
    print(f"ratio {beside / alone:.2f}")


if __name__ == "__main__":
    main()
