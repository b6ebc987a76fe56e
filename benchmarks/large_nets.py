"""A large net of cables stage by stage: processor seconds, and the most memory there was by then.

The net of demos/space_net.py, of so many unknowns; stages are the scene, its equations, what a run
finds before its first step, and steps. Processor seconds of the first rank are printed, as the
machine may have other things to do, and the most memory that a rank has beyond an interpreter that
has run a small net.

    python3 -m benchmarks.large_nets --unknowns 5e5 --steps 5
    tools/run mpirun --oversubscribe -n 4 python3 -m benchmarks.large_nets --unknowns 2.02e6
"""

from __future__ import annotations

import argparse
import resource
import sys
from pathlib import Path

from mpi4py import MPI

import fem_lie as fl
from benchmarks.two_ranks import Clock
from fem_lie.solve.alpha.run import Run
from fem_lie.system.equations import Equations

sys.path.insert(0, str(Path(__file__).parents[1] / "demos"))


def peak() -> float:
    """The most memory that the process ever had, bytes."""
    return 1024.0 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def main() -> None:
    """Measure one net."""
    from demos.space_net import CELLS, STEP, square_net

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--unknowns", type=float, default=1e5)
    parser.add_argument("--steps", type=int, default=5)
    given = parser.parse_args()
    scheme, options = fl.GeneralisedAlpha(radius=0.8), {"step": STEP, "progress": False}
    scheme.run(square_net(1, 4), duration=STEP, **options)
    begin, clock = peak(), Clock()
    for name, owner, function in (
        ("scene", sys.modules["demos.space_net"], "square_net"),
        ("equations", Equations, "__init__"),
        ("start", Run, "start"),
        ("steps", Run, "_advance"),
    ):
        clock.watch(name, owner, function)
    scene = sys.modules["demos.space_net"].square_net(
        max(1, round((given.unknowns / (6.0 * (CELLS - 1))) ** 0.5 - 0.5))
    )
    after, nodes = peak(), len(scene.bodies[0].frames)
    result = scheme.run(scene, duration=given.steps * STEP, save_every=given.steps, **options)
    clock.turn()
    world = MPI.COMM_WORLD
    most = world.allreduce(peak() - begin, op=MPI.MAX)
    whole = world.allreduce(peak())
    if world.rank > 0:
        return
    print(f"unknowns {3 * nodes + 24}, ranks {world.size}: a rank has at most")
    print(f"{(after - begin) / nodes:.0f} bytes a node by the scene, {most / nodes:.0f} in all,")
    print(f"{most / 2**30:.2f} GB; all ranks with interpreters {whole / 2**30:.2f} GB")
    per_step, iterations = clock.spent.pop("steps") / given.steps, float(result.iterations[-1])
    print(", ".join(f"{name} {seconds:.2f} s" for name, seconds in clock.spent.items()))
    print(f"a step {per_step:.3f} s, {iterations / given.steps:.1f} iterations")


if __name__ == "__main__":
    main()
