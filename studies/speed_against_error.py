"""Speed against error: what accuracy costs, for every beam element and every scheme in time.

A figure of speed means nothing without its error. Two problems with references of nine digits or
by refinement, each at five resolutions or more:

Statics: the pre-twisted cantilever of twisted_beam.py, bent about both axes of its flat section and
twisted, over the number of elements. Reference: shooting. Error: that of the tip's displacement,
relative. Geodesic elements and director elements of degree 1 are of second order; the residual
bending flexibility takes most of the error, not the order. (Where a section is as stiff in all
directions, as in bend45.py, it takes the order, too, and leaves the fourth.) Directors of degree 2
are of fourth order in the tip.

Dynamics: a double pendulum of soft bars falls under gravity, over the step. Generalised-alpha with
three spectral radii at infinite frequency, on SE(3) and on R3 x SO(3): all of second order, once
the step resolves the bending waves. Error: distance of the tip over the length of both bars,
against the extrapolation of two much smaller steps. The mesh is the same in all runs, so this is
the error in time alone.

Seconds are those of the solution alone, without set-up (0.05 s for a scene, whatever its size) and
compilation, the best of several runs.
"""

from __future__ import annotations

import csv
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

import fem_lie as fl
from fem_lie.extend import COLOURS

RESULTS = Path(__file__).parents[1] / "results"
STIFFNESS = [2.5e10, 8.2604167e9, 8.2604167e9, 1.41872656e8, 5.20833e8, 1.30208333e8]
TIP = np.array([-1.141526, -1.718053346, -3.59321324])
ELEMENTS = (2, 4, 8, 16, 32, 64, 128, 256)
STEPS = (8e-3, 4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4, 1.25e-4, 6.25e-5)
DURATION, FINE = 0.4, 1e-5
LENGTH = 1.0  # both bars


class Row(NamedTuple):
    """One run."""

    method: str
    resolution: float
    error: float
    seconds: float


class Method(NamedTuple):
    """What is run, its order, and the errors between which the order is taken."""

    run: Callable[[float], tuple[np.ndarray, float]]
    order: float
    between: tuple[float, float]


def cantilever(
    formulation: fl.elements.BeamFormulation,
) -> Callable[[float], tuple[np.ndarray, float]]:
    """Displacement of the tip, and seconds, for a number of elements."""

    def solve(elements: float) -> tuple[np.ndarray, float]:
        section = fl.Section.from_stiffness(STIFFNESS)
        scene = fl.Scene()
        beam = scene.add(
            fl.Beam.straight(
                (0, 0, 0),
                (10, 0, 0),
                section,
                cells=int(elements),
                formulation=formulation,
                up=fl.sections.Twisted(lambda s: np.pi / 20 * s, (0, 0, 1)),
            )
        )
        scene.add(fl.Clamp(beam.point("start")))
        scene.add(fl.PointLoad(beam.point("end"), force=(0, 0, -4e6)))
        result = fl.statics(scene, load_steps=3)
        return result.position(beam.point("end"))[-1] - (10, 0, 0), result.seconds

    return solve


def pendulum(radius: float, group: fl.lie.Group) -> Callable[[float], tuple[np.ndarray, float]]:
    """Tip of the pendulum, and seconds, for a step."""

    def solve(step: float) -> tuple[np.ndarray, float]:
        soft = fl.Section.rectangle(0.02, 0.02, fl.Material(E=2e7, nu=0.3, density=1200.0))
        scene = fl.Scene(gravity=(0, 0, -9.81))
        one, two = (
            scene.add(fl.Beam.straight((a, 0, 0), (b, 0, 0), soft, cells=4).set_group(group))
            for a, b in ((0.0, 0.4), (0.4, 1.0))
        )
        scene.add(fl.joints.Spherical(fl.ground(), one.point("start")))
        scene.add(fl.joints.Revolute(one.point("end"), two.point("start"), axis=(0, 1, 0.3)))
        scheme = fl.GeneralisedAlpha(radius=radius, tolerance=1e-10)
        save = round(DURATION / step)
        result = scheme.run(scene, duration=DURATION, step=step, save_every=save)
        return result.position(two.point("end"))[-1], result.seconds

    return solve


STATICS = {
    "geodesic": Method(cantilever(fl.elements.GeodesicBeam()), 2, (1e-6, 5e-3)),
    "geodesic, without flexibility": Method(
        cantilever(fl.elements.GeodesicBeam(False)), 2, (1e-6, 1e-2)
    ),
    "director 1": Method(cantilever(fl.elements.DirectorBeam(1)), 2, (1e-6, 1e-2)),
    "director 2": Method(cantilever(fl.elements.DirectorBeam(2)), 4, (1e-8, 1e-3)),
}
DYNAMICS = {
    f"{group.name}, radius {radius:g}": Method(pendulum(radius, group), 2, (1e-8, 4e-5))
    for group in fl.lie.Group
    for radius in (0.0, 0.8, 1.0)
}


def main(
    coarsest: int = 2,
    finest: int = 256,
    smallest_step: float = 6.25e-5,
    repeats: int = 3,
    output: str = "results",
    pictures: bool = True,
) -> dict[str, Any]:
    elements = [n for n in ELEMENTS if coarsest <= n <= finest]
    steps = [h for h in STEPS if h >= smallest_step]
    fine, finer = (DYNAMICS["SE3, radius 1"].run(h)[0] for h in (2 * FINE, FINE))
    end = finer + (finer - fine) / 3  # both of second order
    statics = {
        name: [measure(name, method, n, TIP, np.linalg.norm(TIP), repeats) for n in elements]
        for name, method in STATICS.items()
    }
    dynamics = {
        name: [measure(name, method, h, end, LENGTH, repeats) for h in steps]
        for name, method in DYNAMICS.items()
    }
    record: dict[str, Any] = {}
    for title, methods, table in (
        ("elements", STATICS, statics),
        ("step [s]", DYNAMICS, dynamics),
    ):
        show(title, table)
        for name, method in methods.items():
            slope = observed_order(method, table[name])
            key = name.replace(", ", "_").replace(" ", "_")
            record |= {f"order_{key}": slope, f"expected_order_{key}": method.order}
            record[f"smallest_error_{key}"] = min(row.error for row in table[name])
            print(f"{name}: order {slope:.2f}, expected {method.order:g}")
    folder = RESULTS.parent / output
    folder.mkdir(exist_ok=True)
    with (folder / "speed_against_error.csv").open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["problem", *Row._fields])
        for problem, table in (("statics", statics), ("dynamics", dynamics)):
            writer.writerows([problem, *row] for rows in table.values() for row in rows)
    if pictures:
        draw(statics, dynamics, folder / "speed_against_error.png")
    return record


def measure(
    name: str, method: Method, resolution: float, end: np.ndarray, size: float, repeats: int
) -> Row:
    """Run it several times; the best time counts."""
    runs = [method.run(resolution) for _ in range(repeats + 1)][1:]
    error = float(np.linalg.norm(runs[0][0] - end) / size)
    return Row(name, resolution, error, min(seconds for _, seconds in runs))


def observed_order(method: Method, rows: list[Row]) -> float:
    """Slope of error over resolution, where the error is neither coarse nor round-off."""
    low, high = method.between
    kept = [row for row in rows if low < row.error < high]
    slope = np.polyfit(
        np.log([row.resolution for row in kept]), np.log([row.error for row in kept]), 1
    )[0]
    return float(abs(slope))


def show(title: str, table: dict[str, list[Row]]) -> None:
    """One line for each resolution; error and milliseconds of each method."""
    print("\n" + f"{title:>9} " + " ".join(f"{name:>30}" for name in table))
    for rows in zip(*table.values(), strict=True):
        cells = (f"{row.error:14.1e} {1e3 * row.seconds:11.2f} ms" for row in rows)
        print(f"{rows[0].resolution:9g} " + " ".join(f"{cell:>30}" for cell in cells))


def draw(statics: dict[str, list[Row]], dynamics: dict[str, list[Row]], path: Path) -> None:
    """Error over seconds, one diagram for each problem."""
    figure = Figure(figsize=(9.0, 4.2), dpi=150, layout="constrained")
    titles = ("Statics: pre-twisted cantilever", "Dynamics: soft double pendulum")
    for axes, title, table in zip(figure.subplots(1, 2), titles, (statics, dynamics), strict=True):
        for k, (name, rows) in enumerate(table.items()):
            axes.loglog(
                [row.seconds for row in rows],
                [row.error for row in rows],
                "o-" if k < 3 else "s--",
                color=COLOURS[k % len(COLOURS)],
                markersize=4,
                label=name,
            )
        axes.set(title=title, xlabel="seconds", ylabel="error of the tip, relative")
        axes.grid(color="#DDDDDD", linewidth=0.6)
        axes.legend(frameon=False, fontsize=8)
    figure.savefig(path)
    print(f"\npicture: {path}")


if __name__ == "__main__":
    from demos.command_line import run

    run(main)
