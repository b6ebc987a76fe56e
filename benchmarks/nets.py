"""A net of ten thousand elements without torsion: what a step costs, and how far it has converged.

A square net of a side of 1 m, of 12 by 12 meshes whose sides are divided into 1, 2, 4 … elements,
32 of which make 9984. Cables of 100 N and 10 g/m are stretched by 2 % and pinned at their ends;
the net is hit, off its middle and obliquely, with velocities up to 4 m/s that are smooth over it.

LowRankCorrection each refinement is the largest distance of any knot at any of ten times from where
the coarser net has it, over the side; as the element is of second order, a third of the last one is
left. The last lines halve the step of a net of 2496 elements. Seconds of the processor of all
steps, and of what a run takes to begin.

    python benchmarks/nets.py [--most 32] [--step 5e-4]
"""

from __future__ import annotations

import argparse
from itertools import pairwise
from time import process_time
from typing import NamedTuple

import numpy as np

import fem_lie as fl

MESHES = 12
STRETCH, DURATION = 1.02, 0.1
BLOW = (1.0, 0.0, 3.0)
CABLE = fl.Section.from_stiffness([100.0] * 3 + [1e-6] * 3, mass=0.01)


class Run(NamedTuple):
    """What one net did: knots at ten times, and what it took."""

    elements: int
    unknowns: int
    knots: np.ndarray
    seconds: float
    steps: int
    iterations: float
    matrices: int


def net(parts: int) -> fl.Net:
    """Each side of a mesh in so many elements."""
    x = np.linspace(0, 1, MESHES + 1)
    points = [(a, b, 0.0) for a in x for b in x]
    knots = np.arange(len(points)).reshape(MESHES + 1, MESHES + 1)
    cables = []
    for line in (*knots, *knots.T):
        cable = [int(line[0])]
        for a, b in pairwise(line):
            p, q = np.array(points[a]), np.array(points[b])
            inside = [tuple(p + k / parts * (q - p)) for k in range(1, parts)]
            cable += [*range(len(points), len(points) + len(inside)), int(b)]
            points += inside
        cables.append(cable)
    body = fl.Net(points, cables, CABLE, stretch=STRETCH)
    edge = np.unique([*knots[[0, -1]].ravel(), *knots[:, [0, -1]].ravel()])
    body.pin(*(body.point(int(k)) for k in edge))
    position = body.frames[:, 0]
    hill = np.sin(np.pi * position[:, 0]) ** 2 * np.sin(np.pi * position[:, 1]) ** 2
    blow = np.outer(hill * (0.5 + position[:, 0]), BLOW)
    body.velocities[:, :3] = np.einsum("nij,nj->ni", body.frames[:, 1:], blow)
    body.velocities[edge] = 0.0
    return body


def run(parts: int, step: float) -> Run:
    body, scene = net(parts), fl.Scene()
    scene.add(body)
    steps = round(DURATION / step)
    start = process_time()
    result = fl.GeneralisedAlpha(radius=0.8).run(scene, duration=DURATION, step=step)
    seconds = process_time() - start
    rows = np.rint(np.linspace(0, steps, 11)[1:]).astype(int)
    nodes = result.info.body(body.name).nodes[: (MESHES + 1) ** 2]
    knots = result.frames[rows][:, nodes, 0]
    count = 3 * len(body.frames) - int(body.model.held[:, :3].sum())
    per_step = int(result.iterations[-1]) / steps
    return Run(len(body.model.lengths), count, knots, seconds, steps, per_step, result.k_updates)


def row(found: Run, before: Run | None) -> str:
    """A line of the table."""
    moved = np.nan if before is None else distance(found, before)
    return (
        f"{found.elements:8}{found.unknowns:10}{found.steps:7}{moved:12.1e}"
        f"{1e3 * found.seconds / found.steps:14.2f}{found.iterations:12.1f}{found.matrices:10}"
    )


def distance(one: Run, other: Run) -> float:
    """Of any knot at any time, over the side."""
    return float(np.linalg.norm(one.knots - other.knots, axis=-1).max())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--most", type=int, default=32)
    parser.add_argument("--step", type=float, default=5e-4)
    options = parser.parse_args()
    print("elements  unknowns  steps    moved by  ms per step  iterations  matrices")
    before, parts = None, 1
    while parts <= options.most:
        found = run(parts, options.step)
        print(row(found, before), flush=True)
        before, parts = found, 2 * parts
    before = run(8, options.step)
    for k in (1, 2):
        found = run(8, options.step / 2**k)
        print(row(found, before), flush=True)
        before = found


if __name__ == "__main__":
    main()
