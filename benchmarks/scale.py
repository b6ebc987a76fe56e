"""Large scenes: how the time of set-up and of a step grows.

A chain of rigid bodies with spherical joints hangs between ground and nothing, and swings down
under gravity by generalised-α. Set-up is all that comes before the first step: bodies and joints,
the equations, the search for redundant constraints, initial accelerations.

    python3 -m benchmarks.scale --scene chain --bodies 1000 --json chain.json
"""

from __future__ import annotations

import argparse
import json
import logging
import time
from collections.abc import Callable
from pathlib import Path

import fem_lie as fl

LINK, RADIUS, MASS = 0.1, 0.01, 0.25
STEP = 1e-3


def chain(bodies: int) -> fl.Scene:
    """Rods of mass ``MASS`` in a row along x, the first hung from the origin."""
    scene = fl.Scene(gravity=(0.0, 0.0, -9.81))
    thick, thin = MASS * (LINK**2 / 12.0 + RADIUS**2 / 4.0), MASS * RADIUS**2 / 2.0
    before = fl.ground()
    for k in range(bodies):
        rod = fl.RigidBody(MASS, (thin, thick, thick), ((k + 0.5) * LINK, 0.0, 0.0))
        scene.add(rod)
        scene.add(fl.Spherical(before, rod.centre, at=(k * LINK, 0.0, 0.0)))
        before = rod.centre
    return scene


SCENES: dict[str, Callable[[int], fl.Scene]] = {"chain": chain}


def measure(name: str, bodies: int, steps: int) -> dict[str, float]:
    """Seconds of set-up and milliseconds of a step, compiled beforehand."""
    scheme = fl.GeneralisedAlpha(radius=0.8)

    def run(count: int, made: int) -> tuple[float, fl.Result]:
        start = time.perf_counter()
        scene = SCENES[name](count)
        result = scheme.run(scene, duration=made * STEP, step=STEP, save_every=made, progress=False)
        return time.perf_counter() - start, result

    run(3, 2)
    total, result = run(bodies, steps)
    return {
        "bodies": bodies,
        "set_up_seconds": total - result.seconds,
        "ms_per_step": 1e3 * result.seconds / steps,
        "iterations_per_step": float(result.iterations[-1]) / steps,
        "factorisations": result.factorisations,
        "energy_error": result.balance_error,
    }


def main() -> None:
    """Measure one scene of one size."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scene", choices=SCENES, default="chain")
    parser.add_argument("--bodies", type=int, default=1000)
    parser.add_argument("--steps", type=int, default=100)
    parser.add_argument("--json", type=Path, help="file for the figures")
    given = parser.parse_args()
    logging.disable(logging.WARNING)
    figures = measure(given.scene, given.bodies, given.steps)
    for key, value in figures.items():
        print(f"{key:20} {value:.6g}")
    if given.json:
        given.json.write_text(json.dumps(figures, indent=1) + "\n")


if __name__ == "__main__":
    main()
