"""Whether statics reaches any requested load levels: a table of docs/measured/decisions.md.

    python3 -m benchmarks.levels [sets of levels] [problem ...]

Ten problems that bend, roll up, coil and snap. Sets have 1 to 12 levels at random, those of
every second set even in the logarithm, and end at 1. A state is the same as that of the first set
if no node is farther than 1e-6 of the diameter from its position there.
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

import fem_lie as fl
from demos.deep_arch import arch
from demos.hemisphere import pinched, quarter
from demos.hinged_roof import roof
from demos.slit_annulus import ring

_SAME = 1e-6


def cantilever(
    cells: int,
    stiffness: list[float],
    *,
    force: tuple[float, float, float] = (0, 0, 0),
    moment: tuple[float, float, float] = (0, 0, 0),
    following: bool = False,
    formulation: fl.elements.BeamFormulation | None = None,
) -> fl.Scene:
    """A straight beam of length 10 along x, loaded at its tip."""
    scene, section = fl.Scene(), fl.Section.from_stiffness(stiffness)
    beam = scene.add(
        fl.Beam.straight((0, 0, 0), (10, 0, 0), section, cells=cells, formulation=formulation)
    )
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), force=force, moment=moment, following=following))
    return scene


def helix(formulation: fl.elements.BeamFormulation | None = None) -> fl.Scene:
    """Ten turns, coiled by a moment about z and drawn out by a force along it."""
    return cantilever(
        80,
        [1e4] * 3 + [1e2] * 3,
        force=(0, 0, 50),
        moment=(0, 0, 200 * np.pi),
        formulation=formulation,
    )


def frame(load: float) -> fl.Scene:
    """Lee's frame, two bars of 120, hinged at both ends; its limit load is 18557."""
    E, nu, area, second = 7.2e6, 0.3, 6.0, 2.0
    shear = 5 / 6 * area * E / (2 * (1 + nu))
    section = fl.Section.from_stiffness(
        [E * area, shear, shear, 100 * E * second, 100 * E * second, E * second]
    )
    column = [(0.0, 12.0 * k, 0.0) for k in range(11)]
    points = column + [(12.0 * k, 120.0, 0.0) for k in range(1, 11)]
    cells = [(k, k + 1) for k in range(20)]
    ends = {"foot": [0], "loaded": [12], "far": [20]}
    mesh = fl.mesh.LineMesh.from_cells(points, cells, named_points=ends)
    scene = fl.Scene()
    beam = scene.add(fl.Beam(mesh, section, up=(0, 0, 1), name="frame"))
    for name in ("foot", "far"):
        scene.add(fl.joints.Revolute(fl.ground(), beam.point(name), axis=(0, 0, 1)))
    scene.add(fl.PointLoad(beam.point("loaded"), force=(0, -load, 0)))
    return scene


PROBLEMS: dict[str, Callable[[], fl.Scene]] = {
    "helix of ten turns": helix,
    "the same of directors": lambda: helix(fl.elements.DirectorBeam(1)),
    "three turns by a moment": lambda: cantilever(
        40, [1e6] * 3 + [1e2] * 3, moment=(0, 0, 60 * np.pi)
    ),
    "elastica, 40 EI/L²": lambda: cantilever(20, [1e6] * 3 + [1e2] * 3, force=(0, 0, 40)),
    "following force, 25 EI/L²": lambda: cantilever(
        40, [1e6] * 3 + [1e2] * 3, force=(0, 0, 25), following=True
    ),
    "Lee's frame, 1.08 of its limit": lambda: frame(20000.0),
    "deep arch, 1.1 of its limit": lambda: arch(40, "stretchable")[0],
    "hinged roof, 4 times its limit": lambda: roof(12.7, 4)[0],
    "hemisphere, R/t = 1000": lambda: pinched(0.01, quarter(8), fl.elements.HellingerReissner()),
    "slit annulus": lambda: ring(4, 32),
}


def levels(number: int) -> list[float]:
    """Load factors of one set."""
    random = np.random.default_rng(number)
    positions = np.sort(random.uniform(0.0, 1.0, random.integers(0, 12)))
    return [*(positions if number % 2 else 10.0 ** (2.0 * positions - 2.0)), 1.0]


@dataclass
class Tally:
    """What became of the sets of one problem."""

    arrived: int = 0
    same: int = 0
    least: int = 10**9
    most: int = 0
    failed: list[int] | None = None


def study(build: Callable[[], fl.Scene], sets: int) -> Tally:
    """Solve a problem with all sets of levels."""
    tally, first = Tally(failed=[]), None
    for number in range(sets):
        try:
            result = fl.statics(build(), levels=levels(number))
        except fl.ConvergenceError:
            tally.failed.append(number)
            continue
        positions = result.frames[-1, :, 0]
        first = positions if first is None else first
        size = np.linalg.norm(np.ptp(result.info.undeformed[:, 0], axis=0))
        tally.arrived += 1
        tally.same += bool(np.linalg.norm(positions - first, axis=1).max() <= _SAME * size)
        tally.least = min(tally.least, result.total_iterations)
        tally.most = max(tally.most, result.total_iterations)
    return tally


def main(sets: int = 50, *wanted: str) -> None:
    print("| problem | arrived | at the same state | linear solutions |")
    print("| --- | --- | --- | --- |")
    for name, build in PROBLEMS.items():
        if wanted and not any(word in name for word in wanted):
            continue
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            tally = study(build, sets)
        counts = f"{tally.least} … {tally.most}"
        print(
            f"| {name} | {tally.arrived} of {sets} | {tally.same} | {counts} |"
            + (f" failed: {tally.failed}" if tally.failed else ""),
            flush=True,
        )


if __name__ == "__main__":
    main(*map(int, sys.argv[1:2]), *sys.argv[2:])
