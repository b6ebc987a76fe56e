"""Statics of ever larger shells: the pinched hemisphere of thickness 0.04 in one load step.

    python3 -m benchmarks.shell_sizes                      32, 64, 128 and 256 cells along each side
    python3 -m benchmarks.shell_sizes --meshes 32 64

Each mesh in a process of its own, after a small one that compiles. Solutions are those of linear
equations, seconds those of the search for equilibrium, without the scene and its mesh; the exponent
is that of seconds over unknowns from one row to the next.
"""

from __future__ import annotations

import argparse
import math
import multiprocessing
import resource
from typing import NamedTuple

import fem_lie as fl
from demos.hemisphere import CASES, RADIUS, pinched, quarter

THICKNESS = 0.04


class Row(NamedTuple):
    """Figures of one mesh.

    Attributes:
        mesh: Cells along a side.
        unknowns: Six of each node.
        solutions: Of linear equations, those of failed steps included.
        failed: Of these.
        seconds: Of the search for equilibrium.
        memory: The most of the process, GB.
        error: Of the deflection outward.
    """

    mesh: int
    unknowns: int
    solutions: int
    failed: int
    seconds: float
    memory: float
    error: float


def measured(mesh: int) -> Row:
    """One mesh."""
    fl.follow_loads(pinched(THICKNESS, quarter(4)))
    scene = pinched(THICKNESS, quarter(mesh))
    result = fl.follow_loads(scene)
    moved = float(result.position("hemisphere.00")[-1, 0] - RADIUS)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    return Row(
        mesh,
        6 * len(scene.bodies[0].frames),
        result.total_iterations,
        result.failed_iterations,
        result.seconds,
        memory,
        moved / CASES[THICKNESS][1] - 1.0,
    )


def main() -> None:
    """Print the table in Markdown."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--meshes", type=int, nargs="+", default=[32, 64, 128, 256])
    given = parser.parse_args()
    print("| cells | unknowns | solutions | of these failed | s | exponent | GB | error |")
    print("|---|---|---|---|---|---|---|---|")
    before: Row | None = None
    for mesh in given.meshes:
        with multiprocessing.get_context("spawn").Pool(1) as pool:
            row = pool.apply(measured, (mesh,))
        exponent = ""
        if before is not None:
            ratio = math.log(row.seconds / before.seconds)
            exponent = f"{ratio / math.log(row.unknowns / before.unknowns):.2f}"
        print(
            f"| {row.mesh}² | {row.unknowns} | {row.solutions} | {row.failed} | {row.seconds:.2f} "
            f"| {exponent} | {row.memory:.2f} | {row.error:.1e} |",
            flush=True,
        )
        before = row


if __name__ == "__main__":
    main()
