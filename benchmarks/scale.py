"""Large scenes: how the time of set-up and of a step grows.

A chain of rigid bodies with spherical joints hangs between ground and nothing, and swings down
under gravity by generalised-α. Set-up is all that comes before the first step: bodies and joints,
the equations, the search for redundant constraints, initial accelerations.

A weave is of rods along both directions of a plane, each across twenty others, to which spherical
joints bind it: ten joints for each body. Neighbours in a row are shifted, so that all is
connected. Without steps (--steps 0) it prints the time of bodies and joints, and of the equations.

    python3 -m benchmarks.scale --scene chain --bodies 1000 --json chain.json
    python3 -m benchmarks.scale --scene weave --bodies 10000 --steps 0
"""

from __future__ import annotations

import argparse
import json
import logging
import resource
import time
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import fem_lie as fl
from fem_lie.system.equations import Equations

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
        scene.add(fl.joints.Spherical(before, rod.point("centre"), at=(k * LINK, 0.0, 0.0)))
        before = rod.point("centre")
    return scene


ACROSS = 20
"""Rods that one of a weave crosses."""


def weave(bodies: int) -> fl.Scene:
    """About so many rods of which each is bound to ``ACROSS`` others where it crosses them."""
    scene = fl.Scene(gravity=(0.0, 0.0, -9.81))
    tube = fl.Section.circle(RADIUS, fl.Material(E=2.1e11, nu=0.3, density=7850.0))
    side = max(1, round((bodies / 2 * ACROSS) ** 0.5 / ACROSS)) * ACROSS
    crossing: list[dict[tuple[int, int], fl.extend.Point]] = [{}, {}]
    for way, found in enumerate(crossing):
        for row in range(side):
            # in a row the first is shorter, by an amount that changes from row to row
            starts = {0, *range((7 * row) % ACROSS, side, ACROSS)}
            bounds = sorted({start for start in starts if start < side} | {side})
            for begin, end in pairwise(bounds):
                if end - begin < 2:
                    continue
                ends = [(LINK * begin, LINK * row, 0.0), (LINK * (end - 1), LINK * row, 0.0)]
                if way:
                    ends = [(y, x, z) for x, y, z in ends]
                rod = fl.Beam.straight(*ends, tube, cells=end - begin - 1, up=(0.0, 0.0, 1.0))
                scene.add(rod)
                for k in range(begin, end):
                    found[(row, k) if way else (k, row)] = rod.point(k - begin)
    for position in crossing[0].keys() & crossing[1].keys():
        scene.add(fl.joints.Spherical(crossing[0][position], crossing[1][position]))
    return scene


SCENES: dict[str, Callable[[int], fl.Scene]] = {"chain": chain, "weave": weave}


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


def set_up(name: str, bodies: int) -> dict[str, float]:
    """Seconds of bodies and joints, and of the equations, by the clock and of the processor."""
    Equations(SCENES[name](bodies // 50 + 10), dynamics=True)
    times = [(time.perf_counter(), time.process_time())]
    scene = SCENES[name](bodies)
    times.append((time.perf_counter(), time.process_time()))
    equations = Equations(scene, dynamics=True)
    times.append((time.perf_counter(), time.process_time()))
    (scene_seconds, scene_cpu), (seconds, cpu) = (
        (later[0] - one[0], later[1] - one[1]) for one, later in pairwise(times)
    )
    return {
        "bodies": len(scene.bodies),
        "joints": len(scene.joints),
        "unknowns": 6 * equations.unknowns.moving,
        "constraints": equations.unknowns.m,
        "scene_seconds": scene_seconds,
        "scene_processor_seconds": scene_cpu,
        "equations_seconds": seconds,
        "equations_processor_seconds": cpu,
        "memory_gb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20,
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
    none = given.steps == 0
    figures = (
        set_up(given.scene, given.bodies)
        if none
        else measure(given.scene, given.bodies, given.steps)
    )
    for key, value in figures.items():
        print(f"{key:20} {value:.6g}")
    if given.json:
        given.json.write_text(json.dumps(figures, indent=1) + "\n")


if __name__ == "__main__":
    main()
