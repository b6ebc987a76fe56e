"""A large net of cables stage by stage: processor seconds, and the most memory there was by then.

The net of demos/space_net.py, of so many unknowns; stages are the scene, its equations, what a run
finds before its first step, and steps. Processor seconds of the first rank are printed, as the
machine may have other things to do, and the most memory that a rank has beyond an interpreter that
has run a small net.

    python3 -m benchmarks.large_nets --unknowns 5e5 --steps 5
    tools/run mpirun --oversubscribe -n 4 python3 -m benchmarks.large_nets --unknowns 2.02e6

With ``--hexagonal`` the net has rings of threads of 80 elements, held by six radial threads, and
masses at its six corners are pulled outwards from rest: one that Liu & Hu (2021) deploy on 72
subdomains. Its corners are kinks, where axial waves of a start at speed need much smaller steps.
"""

from __future__ import annotations

import argparse
import logging
import resource
import sys
from pathlib import Path

from mpi4py import MPI

import numpy as np

import fem_lie as fl
from benchmarks.two_ranks import Clock
from fem_lie.solve.alpha.run import Run
from fem_lie.system.equations import Equations

sys.path.insert(0, str(Path(__file__).parents[1] / "demos"))


PULL = 0.1
"""Acceleration of the masses of the hexagonal net, m/s²."""


def hexagonal_net(unknowns: float) -> fl.Scene:
    """Net of rings, with masses at its corners that are pulled outwards."""
    from demos.net_scene import LAID, hexagons
    from demos.space_net import CABLE, CELLS, MESH, WAVE, WEIGHT

    rings = max(1, round((unknowns / (9.0 * (CELLS - 1))) ** 0.5 - 1.5))
    flat, cables, edge = hexagons(rings, CELLS)
    # threads have waves of one sign after the other, and their knots lie in a plane
    knots = 1 + 3 * rings * (rings + 1)
    wave = np.sin(np.pi * np.arange(1, CELLS) / CELLS)
    signs = (-1.0) ** np.arange((len(flat) - knots) // len(wave))
    height = np.append(np.zeros(knots), np.outer(signs, wave))
    positions = MESH * np.column_stack([rings * flat, WAVE * height])
    scene = fl.Scene()
    net = scene.add(fl.Net(positions, cables, CABLE, formulation=LAID))
    mass = WEIGHT * rings
    for corner in edge[::rings]:
        weight = fl.RigidBody(mass, np.full(3, 1e-3 * mass), positions[corner])
        scene.add(weight)
        scene.add(fl.joints.Spherical(net.point(int(corner)), weight.point("centre")))
        outwards = positions[corner] / np.linalg.norm(positions[corner])
        scene.add(fl.PointLoad(weight.point("centre"), force=PULL * mass * outwards))
    return scene


def squares(unknowns: float) -> fl.Scene:
    """Net of square meshes of demos/space_net.py."""
    from demos.space_net import CELLS, square_net

    return square_net(max(1, round((unknowns / (6.0 * (CELLS - 1))) ** 0.5 - 0.5)))


def peak() -> float:
    """The most memory that the process ever had, bytes."""
    return 1024.0 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def main() -> None:
    """Measure one net."""
    from demos.space_net import STEP, square_net

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--unknowns", type=float, default=1e5)
    parser.add_argument("--steps", type=int, default=5)
    parser.add_argument("--hexagonal", action="store_true")
    parser.add_argument("--log", action="store_true", help="what each rank has")
    given = parser.parse_args()
    if given.log:
        logging.basicConfig(format="%(message)s")
        logging.getLogger("fem_lie.parts").setLevel(logging.INFO)
    scheme, options = fl.GeneralisedAlpha(radius=0.8), {"step": STEP, "progress": False}
    scheme.run(square_net(1, 4), duration=STEP, **options)
    begin, clock = peak(), Clock()
    for name, owner, function in (
        ("scene", sys.modules[__name__], "hexagonal_net" if given.hexagonal else "squares"),
        ("equations", Equations, "__init__"),
        ("start", Run, "start"),
        ("steps", Run, "_advance"),
    ):
        clock.watch(name, owner, function)
    scene = (hexagonal_net if given.hexagonal else squares)(given.unknowns)
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
