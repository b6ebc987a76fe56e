"""Frames merged and split while running: a tumbling net of beams that is struck at one corner.

10 x 10 cables of plastic, 1 cm square in section and rigidly joined where they cross, tumble
freely over one metre; a force at a corner lasts 20 ms. Merged frames against all of them, by the
same scheme and step: deflection is the distance of a node from its position in the mean axes, in
these axes.
"""

from __future__ import annotations

import argparse
import time
from math import pi, sin

import numpy as np

import fem_lie as fl
from fem_lie import lie
from fem_lie.reduction.axes import expanded, local_motion

PLASTIC = fl.Material(E=2e9, nu=0.3, density=1100.0)
STRUCK, LASTS = 0.5, 0.02
STEP = 2e-3


def cables(count: int) -> fl.mesh.LineMesh:
    """So many in each direction over a square of 1 m, one element from crossing to crossing."""
    number = np.arange(count * count).reshape(count, count)
    positions = np.linspace(0.0, 1.0, count)
    points = np.array([(x, y, 0.0) for x in positions for y in positions])
    both = [(number[:-1], number[1:], (1.0, 0.0, 0.0)), (number[:, :-1], number[:, 1:], (0, 1, 0))]
    cells = np.concatenate([np.column_stack([a.ravel(), b.ravel()]) for a, b, _ in both])
    along = [np.tile(direction, (a.size, 2, 1)) for a, _, direction in both]
    corner = {"corner": np.array([number[-1, -1]])}
    return fl.mesh.LineMesh(points, cells, np.concatenate(along), named_points=corner)


def net(count: int, force: float) -> fl.Scene:
    """It, and what strikes it."""
    scene = fl.Scene()
    section = fl.Section.rectangle(0.01, 0.01, PLASTIC)
    damping = fl.sections.Damping(stiffness=0.05)
    body = fl.Beam(cables(count), section, up=(0, 0, 1), damping=damping, name="net")
    scene.add(body)
    body.add_velocity(omega=(1.0, 0.3, 2.0), about=(0.5, 0.5, 0.0))
    body.add_velocity((0.2, 0.1, 0.3))

    def pulse(t: float) -> float:
        since = (t - STRUCK) / LASTS
        return sin(pi * since) if 0.0 < since < 1.0 else 0.0

    scene.add(fl.PointLoad(body.point("corner"), force=(0.0, 0.0, force), history=pulse))
    return scene


def deflections(body: fl.extend.Body, frames: np.ndarray) -> np.ndarray:
    """Of all nodes from their positions in the mean axes, in these, (k, n, 3)."""
    motion = local_motion(body, frames, fl.reduction.MeanAxes())
    still = expanded(body, motion._replace(increments=np.zeros_like(motion.increments)))
    away = (frames - still)[:, :, 0]
    return np.einsum("kij,kni->knj", lie.rotation(motion.rigid), away)


def main(
    count: int = 10, duration: float = 5.0, force: float = 50.0, tolerance: float = 1e-4
) -> dict[str, float]:
    """Figures, printed."""
    scheme = fl.GeneralisedAlpha()
    scheme.run(net(2, force), duration=STEP, step=STEP)  # compiled code is loaded
    began = time.process_time()
    merged = fl.reduction.merged_motion(
        lambda: net(count, force), duration=duration, step=STEP, every=10 * STEP,
        tolerance=tolerance,
    )  # fmt: skip
    middle = time.process_time()
    full = scheme.run(net(count, force), duration=duration, step=STEP)
    end = time.process_time()
    body, nodes = net(count, force).bodies[0], full.info.body("net").nodes
    rows = np.rint(merged.times / STEP).astype(int)
    wanted = deflections(body, full.frames[:, nodes])[rows]
    error = np.linalg.norm(deflections(body, merged.frames[:, nodes]) - wanted, axis=2)
    positions = np.linalg.norm((merged.frames - full.frames[rows])[:, nodes, 0], axis=2)
    largest = float(np.linalg.norm(wanted, axis=2).max())
    stretches = merged.segments
    record = {
        "frames": float(merged.nodes),
        "share": merged.active_fraction,
        "deflection": largest,
        "deflection_error": float(error.max()) / largest,
        "place_error": float(positions.max()) / largest,
        "momentum_error": merged.momentum_error,
        "energy_change": abs(merged.energy_change) / float(stretches[-1].result.kinetic[-1]),
        "stretches": float(len(stretches)),
        "again": float(merged.repeated),
        "seconds": middle - began,
        "full_seconds": end - middle,
    }
    for part in stretches:
        print(f"from {part.begin:.3f} s: {part.frames} frames")
    for key, value in record.items():
        print(f"{key:20}{value:.3g}")
    return record


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--duration", type=float, default=5.0)
    parser.add_argument("--force", type=float, default=50.0)
    parser.add_argument("--tolerance", type=float, default=1e-4)
    main(**vars(parser.parse_args()))
