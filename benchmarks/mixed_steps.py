"""A net on steel masts: explicit steps of the net, implicit ones of the masts, in one scene.

A stretched square net hangs with its corners on four masts and is hit in its middle, as in
demos/wave_in_a_net.py; with --ball it catches a heavy ball. Its own stable step is a hundred times
that of the masts, whose elements are stiff. Compared are
fem_lie.schemes.MultiRate with explicit steps of the net and one implicit step of the masts in each
whole step, the energy-momentum scheme for all, and the explicit scheme for all. Errors are those of
time alone: the largest distance of positions at the end from the same scheme with an eighth of the
given step, over the largest way; that of the explicit scheme is from half of its step. Printed are
step, error, error of the energy balance, tries or iterations per step, and seconds of processor
time, set-up included.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from time import process_time
from typing import Any

import numpy as np

import fem_lie as fl
from fem_lie.bodies.body import Body

CABLE = fl.Section.from_stiffness([100.0] * 3 + [1e-6] * 3, mass=0.01)
STEEL = fl.Section.circle(0.005, fl.Material(E=2.1e11, nu=0.3, density=7850.0))
STRETCH, BLOW, HEIGHT = 1.05, 2.0, 0.5
RADIUS, SPEED, MASS = 0.1, 2.0, 0.2


def masts(cells: int, parts: int, ball: bool) -> tuple[fl.Scene, list[Body]]:
    """The scene, and its bodies with explicit steps."""
    x = np.linspace(0, 1, cells + 1)
    positions = np.array([(a, b, 0) for a in x for b in x])
    grid = np.arange(len(positions)).reshape(cells + 1, cells + 1)
    cables = [list(row) for row in grid] + [list(column) for column in grid.T]
    scene = fl.Scene()
    net = scene.add(fl.Net(positions, cables, CABLE, stretch=STRETCH))
    for corner in grid[[0, 0, -1, -1], [0, -1, 0, -1]]:
        x, y, _ = positions[corner]
        mast = scene.add(fl.Beam.straight((x, y, -HEIGHT), (x, y, 0), STEEL, cells=parts))
        scene.add(fl.Clamp(mast.point("start")))
        scene.add(fl.joints.Spherical(net.point(int(corner)), mast.point("end")))
    bodies: list[Body] = [net]
    if ball:
        weight = scene.add(
            fl.RigidBody(
                MASS, np.full(3, 0.4 * MASS * RADIUS**2), position=(0.5, 0.5, 1.05 * RADIUS)
            )
        )
        weight.add_velocity((0, 0, -SPEED))
        touching = fl.contact.Sphere(weight.point("centre"), RADIUS), fl.contact.Line(net, 4e-3)
        scene.add(fl.contact.Contact(*touching, fl.contact.Penalty(1e4)))
        return scene, [*bodies, weight]
    far = ((positions[:, :2] - 0.5) ** 2).sum(axis=1)
    blow = BLOW * np.exp(-far / 0.1**2)
    net.velocities[:, :3] = blow[:, np.newaxis] * net.frames[:, 1:, 2]
    return scene, bodies


def mixed(bodies: list[Body]) -> fl.schemes.MultiRate:
    """Explicit steps of some bodies, one in each implicit step of the others."""
    return fl.schemes.MultiRate({}, schemes=dict.fromkeys(bodies, fl.Explicit()))


def all_implicit(bodies: list[Body]) -> fl.EnergyMomentum:
    """One scheme for all."""
    return fl.EnergyMomentum()


def all_explicit(bodies: list[Body]) -> fl.Explicit:
    """The other one."""
    return fl.Explicit()


def main(
    cells: int = 20, parts: int = 20, duration: float = 0.02, step: float = 2e-4, ball: bool = False
) -> dict[str, Any]:
    """Figures, printed."""
    stable = fl.Explicit().stable_step(masts(cells, parts, ball)[0])

    def run(scheme: Callable[[list[Body]], Any], size: float) -> tuple[fl.Result, float]:
        scene, bodies = masts(cells, parts, ball)
        steps = max(1, round(duration / size))
        start = process_time()
        given = {"duration": duration, "step": duration / steps, "save_every": max(1, steps // 20)}
        result = scheme(bodies).run(scene, **given, progress=False)
        return result, process_time() - start

    record: dict[str, Any] = {"stable_step": stable}
    sizes = [2.0 * step, step, 0.5 * step]
    chosen = {
        "mixed": (mixed, sizes[1:]),
        "implicit": (all_implicit, sizes),
        "explicit": (all_explicit, [0.9 * stable]),
    }
    for scheme, some in chosen.values():
        run(scheme, some[-1])  # machine code
    for name, (scheme, some) in chosen.items():
        finest = some[-1] / 2.0 if name == "explicit" else step / 8.0
        end = run(scheme, finest)[0].frames[-1, :, 0]
        for size in some:
            result, seconds = run(scheme, size)
            x = result.frames[:, :, 0]
            way = np.linalg.norm(x - x[0], axis=2).max()
            error = float(np.linalg.norm(x[-1] - end, axis=1).max() / way)
            tries = float(result.iterations[-1] / round(duration / size))
            found = (size, error, result.balance_error, tries, seconds)
            record[f"{name} {size:.3g}"] = found
            print(f"{name:10}{size:10.3g}{error:10.2g}{found[2]:10.2g}{tries:8.2f}{seconds:10.3g}")
    return record


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cells", type=int, default=20)
    parser.add_argument("--parts", type=int, default=20)
    parser.add_argument("--duration", type=float, default=0.02)
    parser.add_argument("--step", type=float, default=2e-4)
    parser.add_argument("--ball", action="store_true")
    main(**vars(parser.parse_args()))
