"""Deployment of a space net: masses at its corners pull it open.

A square net of meshes of 0.25 m, 80 cable elements per cable from knot to knot. Cables are laid
in waves, and masses at the corners, which hang on joints, fly outwards; nothing else acts, so that
momenta stay. Steps are those of generalised-α.

--unknowns is how many there are, nearly: the number of meshes along a side is whole. set_up_seconds
is all that comes before the first step but for the compilation, memory_gb the most that the process
ever had, energy_error the difference of energy and its balance, which is what the scheme damps.
"""

from __future__ import annotations

import resource
import time
from typing import Any

import numpy as np
from command_line import run

import fem_lie as fl

MESH, CELLS, WAVE, RATE, RADIUS = 0.25, 80, 0.05, 0.05, 2e-4
CABLE = fl.Section.circle(RADIUS, fl.Material(E=7e10, nu=0.3, density=1440.0))
WEIGHT = 1.0
STEP = 2e-4


def square_net(meshes: int, cells: int = CELLS) -> fl.Scene:
    """A net of ``meshes`` by ``meshes``, with masses at its corners that fly apart."""
    count, knots = meshes * cells + 1, np.arange(meshes + 1) * cells
    along = np.arange(count) / cells
    wave = WAVE * np.sin(np.pi * along)
    numbers = np.full((count, count), -1, dtype=np.int64)
    on_line = np.zeros((count, count), dtype=bool)
    on_line[knots], on_line[:, knots] = True, True
    numbers[on_line] = np.arange(on_line.sum())
    i, j = np.nonzero(on_line)
    positions = MESH * np.stack([along[i], along[j], wave[i] + wave[j]], axis=1)
    cables = [numbers[k] for k in knots] + [numbers[:, k] for k in knots]
    scene = fl.Scene()
    net = scene.add(fl.Net(positions, cables, CABLE))
    middle = positions.mean(axis=0)
    velocities = RATE * (positions - middle) * [1.0, 1.0, 0.0]
    net.velocities[:, :3] = np.einsum("nij,nj->ni", net.frames[:, 1:], velocities)
    mass = WEIGHT * meshes
    for corner in numbers[[0, 0, -1, -1], [0, -1, 0, -1]]:
        weight = fl.RigidBody(mass, np.full(3, 1e-3 * mass), positions[corner])
        weight.velocities[:, :3] = velocities[corner]
        scene.add(weight)
        scene.add(fl.joints.Spherical(net.point(int(corner)), weight.point("centre")))
    return scene


def main(unknowns: float = 1e4, steps: int = 100, cells: int = CELLS) -> dict[str, Any]:
    meshes = max(1, round(np.sqrt(unknowns / (6.0 * (cells - 1))) - 0.5))
    scheme = fl.GeneralisedAlpha(radius=0.8)

    def run(size: int, length: int, made: int) -> tuple[float, fl.Scene, fl.Result]:
        start = time.perf_counter()
        scene = square_net(size, length)
        result = scheme.run(scene, duration=made * STEP, step=STEP, save_every=made, progress=False)
        return time.perf_counter() - start, scene, result

    run(1, 4, 1)  # compiled
    seconds, scene, result = run(meshes, cells, steps)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    record: dict[str, Any] = {
        "meshes": meshes,
        "unknowns": 3 * len(scene.bodies[0].frames) + 24,
        "steps": steps,
        "set_up_seconds": seconds - result.seconds,
        "seconds_per_step": result.seconds / steps,
        "iterations_per_step": float(result.iterations[-1]) / steps,
        "factorisations": result.factorisations,
        "memory_gb": memory,
        "energy_error": result.balance_error,
        "momentum_error": result.momentum_error,
        "angular_momentum_error": result.angular_momentum_error,
    }
    return record


if __name__ == "__main__":
    run(main, show=True)
