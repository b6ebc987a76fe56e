"""Steps of a user's forms beside those of the library's beam with the same strains.

    RUN -m benchmarks.own_forms [--cells 16 160 1666] [--steps 50] [--rounds 3]

A clamped rod swings under gravity. Its element is that of ``demos/forms/transient_element.py``, as
forms with an inertia in a ``FormBody``, and ``fl.elements.DirectorBeam`` without bending
flexibility as a ``Beam``; six unknowns per node, so that 1666 cells have 10⁴. Seconds are of
mesh, forms, body and run with outputs at every step, the least of all rounds, which take turns;
everything is compiled before. The difference is the largest of positions of all nodes at all
times, per length.
"""

from __future__ import annotations

import sys
from argparse import ArgumentParser
from collections.abc import Callable
from pathlib import Path
from time import perf_counter

import numpy as np

import fem_lie as fl

sys.path.insert(0, str(Path(__file__).parents[1] / "demos" / "forms"))
from transient_element import SECTION, rod

SCHEMES = {
    "generalised-α": fl.GeneralisedAlpha(radius=0.8),
    "energy-momentum": fl.EnergyMomentum(),
    "variational": fl.schemes.Variational(),
}
STEP = 0.005


def own(cells: int) -> tuple[fl.Scene, fl.extend.Body]:
    """The rod of forms."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    return scene, scene.add(rod(cells))


def library(cells: int) -> tuple[fl.Scene, fl.extend.Body]:
    """The rod of the library."""
    element = fl.elements.DirectorBeam(bending_flexibility=False)
    beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), SECTION, cells=cells, formulation=element)
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(beam)
    scene.add(fl.Clamp(beam.point("start")))
    return scene, beam


def measured(
    build: Callable[[int], tuple[fl.Scene, fl.extend.Body]],
    scheme: fl.extend.Integrator,
    cells: int,
    steps: int,
) -> tuple[float, np.ndarray]:
    """Seconds of a run, and the positions of its nodes along the rod, (T, cells + 1, 3)."""
    start = perf_counter()
    scene, body = build(cells)
    result = scheme.run(scene, duration=steps * STEP, step=STEP)
    seconds = perf_counter() - start
    positions = result.frames[:, result.info.body(body.name).nodes, 0]
    return seconds, positions[:, np.argsort(body.frames[:, 0, 0])]


def compare(
    scheme: fl.extend.Integrator, cells: int, steps: int, rounds: int
) -> tuple[float, float, float]:
    """Seconds of forms and of the library, and the difference of positions."""
    runs = [[measured(b, scheme, cells, steps) for b in (own, library)] for _ in range(rounds)]
    seconds = [min(pair[k][0] for pair in runs) for k in range(2)]
    return seconds[0], seconds[1], float(np.abs(runs[0][0][1] - runs[0][1][1]).max())


def main(cells: list[int], steps: int, rounds: int) -> None:
    """Print the table."""
    for scheme in SCHEMES.values():
        compare(scheme, min(cells), 2, 1)  # compiles
    print("| scheme | unknowns | forms, s | library, s | forms / library | difference |")
    print("|---|---|---|---|---|---|")
    for name, scheme in SCHEMES.items():
        for count in cells:
            ours, theirs, gap = compare(scheme, count, steps, rounds)
            row = f"| {name} | {6 * (count + 1)} | {ours:.3f} | {theirs:.3f} |"
            print(f"{row} {ours / theirs:.2f} | {gap:.0e} |")


if __name__ == "__main__":
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("--cells", type=int, nargs="+", default=[16, 160, 1666])
    parser.add_argument("--steps", type=int, default=50)
    parser.add_argument("--rounds", type=int, default=3)
    main(**vars(parser.parse_args()))
