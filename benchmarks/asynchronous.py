"""A net with short elements: steps of each cell by itself against equal ones.

One edge in the middle of a square net begins with pieces of a hundredth of its length. One piece
hangs between two knots with the mass of whole edges and takes a step of a tenth; two have a knot of
their own mass between them, and take a hundredth, as elements of a continuum would. Explicit steps
are all as small as the short pieces want; those of Asynchronous only around them.

Work is counted in cells whose forces are found (edges and bends) per second of the motion; errors
are those of all positions, over the largest way, against explicit steps a quarter as long.

    python -m benchmarks.asynchronous [--cells 20] [--pieces 2] [--duration 0.02]
    python -m benchmarks.asynchronous --cells 4 --events 10000000

With contact the net falls on a ball, with all of its knots or with those of the regular net alone.

    python -m benchmarks.asynchronous --contact all
    python -m benchmarks.asynchronous --contact regular
"""

from __future__ import annotations

import argparse
from time import process_time

import numpy as np

import fem_lie as fl

CABLE = fl.Section.from_stiffness([100.0] * 3 + [1e-6] * 3, mass=0.01)


def net(cells: int, pieces: int, short: float = 0.01) -> fl.Scene:
    """A pinned and stretched net of side 1 m, hit in the middle."""
    x = np.linspace(0, 1, cells + 1)
    positions = [(a, b, 0.0) for a in x for b in x]
    grid = np.arange(len(positions)).reshape(cells + 1, cells + 1)
    cables = [[int(k) for k in line] for line in [*grid, *grid.T]]
    middle = cells // 2
    one, two = np.array(positions)[cables[middle][middle : middle + 2]]
    for k in range(1, pieces + 1):
        cables[middle].insert(middle + k, len(positions))
        positions.append(tuple(one + k * short * (two - one)))
    body = fl.Net(positions, cables, CABLE, stretch=1.05)
    edge = np.unique([*grid[[0, -1]].ravel(), *grid[:, [0, -1]].ravel()])
    body.pin(*(body.point(int(k)) for k in edge))
    far = ((body.frames[:, 0, :2] - 0.5) ** 2).sum(axis=1)
    blow = 2.0 * np.exp(-far / 0.2**2)
    body.velocities[:, :3] = blow[:, np.newaxis] * body.frames[:, 1:, 2]
    body.velocities[edge] = 0.0
    scene = fl.Scene()
    scene.add(body)
    return scene


def touching(cells: int, pieces: int, knots: str) -> fl.Scene:
    """The net on a fixed ball, which ``knots`` touch: "all", or those of "regular" cells alone."""
    scene = net(cells, pieces)
    (body,) = scene.bodies
    short, middle = range((cells + 1) ** 2, len(body.frames)), cells // 2 * (cells + 2)
    without = {*short, middle, middle + 1} if knots == "regular" else set()
    chosen = [body.point(k) for k in range(len(body.frames)) if k not in without]
    ball = fl.contact.Sphere(fl.ground((0.3, 0.3, 0.11)), 0.1)
    knot = fl.contact.Vertices(chosen, 1e-3)
    scene.add(fl.contact.Contact(knot, ball, fl.contact.Penalty(100.0)))
    return scene


def cells_of(cells: int, pieces: int) -> int:
    """Edges and bends of the net."""
    return 2 * cells * (cells + 1) + 2 * (cells - 1) * (cells + 1) + 2 * pieces


def against_explicit(cells: int, pieces: int, duration: float) -> dict[str, float]:
    """Work and errors of both."""
    limit = fl.Explicit().stable_step(net(cells, pieces))
    steps = int(np.ceil(duration / (0.8 * limit)))
    runs: dict[str, fl.Result] = {}
    seconds = {}
    plans = {
        "fine": (fl.Explicit(), 4 * steps),
        "explicit": (fl.Explicit(), steps),
        "asynchronous": (fl.schemes.Asynchronous(), 2),
        "half": (fl.schemes.Asynchronous(0.4), 2),
        "quarter": (fl.schemes.Asynchronous(0.2), 2),
    }
    for name, (scheme, count) in plans.items():
        start = process_time()
        runs[name] = scheme.run(
            net(cells, pieces), duration=duration, step=duration / count, save_every=count
        )
        seconds[name] = process_time() - start
    exact = runs["fine"].frames[-1, :, 0]
    way = float(np.abs(exact - runs["fine"].frames[0, :, 0]).max())
    record = {"steps of the explicit scheme": float(steps)}
    work = {name: float(runs[name].iterations[-1]) for name in plans}
    for name in ("fine", "explicit"):
        work[name] *= cells_of(cells, pieces)
    for name in ("explicit", "asynchronous", "half", "quarter"):
        error = np.abs(runs[name].frames[-1, :, 0] - exact).max() / way
        record[f"{name}: error"] = float(error)
        record[f"{name}: cells per second of motion"] = work[name] / duration
        record[f"{name}: less work than explicit"] = work["explicit"] / work[name]
        record[f"{name}: seconds"] = seconds[name]
    return record


def with_contact(cells: int, pieces: int, knots: str, duration: float) -> dict[str, float]:
    """Processor time of both, and errors over the largest way."""
    limit = fl.Explicit().stable_step(touching(cells, pieces, knots))
    steps = int(np.ceil(duration / (0.8 * limit)))
    plans = {
        "explicit": (fl.Explicit(), steps),
        "asynchronous": (fl.schemes.Asynchronous(), 20),
        "quarter": (fl.schemes.Asynchronous(0.2), 20),
    }
    ends, record = {}, {}
    for name, (scheme, count) in plans.items():
        step = duration / count
        scheme.run(touching(cells, pieces, knots), duration=step, step=step)  # compiles
        start = process_time()
        run = scheme.run(
            touching(cells, pieces, knots), duration=duration, step=step, save_every=count
        )
        record[f"{name}: seconds"] = process_time() - start
        ends[name], way = run.frames[-1, :, 0], np.ptp(run.frames[:, :, 0], axis=0).max()
        record[f"{name}: error"] = float(np.abs(ends[name] - ends["explicit"]).max() / way)
    return record


def long_run(cells: int, pieces: int, events: int) -> dict[str, float]:
    """The energy over so many steps of cells."""
    trial = fl.schemes.Asynchronous().run(net(cells, pieces), duration=0.01, step=1e-3)
    duration = 1e-3 * round(10 * events / float(trial.iterations[-1]))
    steps = round(duration / 1e-3)
    start = process_time()
    result = fl.schemes.Asynchronous().run(
        net(cells, pieces), duration=steps * 1e-3, step=1e-3, save_every=max(1, steps // 1000)
    )
    seconds = process_time() - start
    energy = result.total_energy / result.total_energy[0] - 1.0
    third = len(energy) // 3
    return {
        "steps of cells": float(result.iterations[-1]),
        "energy, largest change": float(np.abs(energy).max()),
        "energy, first third": float(np.ptp(energy[:third])),
        "energy, last third": float(np.ptp(energy[-third:])),
        "energy, drift": float(abs(energy[-third:].mean() - energy[:third].mean())),
        "ns per step of a cell": 1e9 * seconds / float(result.iterations[-1]),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cells", type=int, default=20)
    parser.add_argument("--pieces", type=int, default=2)
    parser.add_argument("--duration", type=float, default=0.02)
    parser.add_argument("--events", type=int, default=0)
    parser.add_argument("--contact", choices=("all", "regular"))
    options = parser.parse_args()
    if options.contact:
        record = with_contact(options.cells, options.pieces, options.contact, options.duration)
    elif options.events:
        record = long_run(options.cells, options.pieces, options.events)
    else:
        record = against_explicit(options.cells, options.pieces, options.duration)
    for name, value in record.items():
        print(f"{name:44}{value:.4g}")


if __name__ == "__main__":
    main()
