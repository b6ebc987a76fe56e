"""A thin cylinder under axial compression: the classical load, and how little of it is left.

A perfect cylinder of radius R and thickness t, free to expand, buckles at

    N = E t^2 / (R sqrt(3 (1 - nu^2))) = 0.605 E t^2/R    per length of its circumference (nu = 0.3)

in many modes at once (Koiter's circle): rings, whose half wave is
l = pi sqrt(R t)/(12 (1 - nu^2))^(1/4), and chequered ones, of which the square one has half waves
of 2 l both ways. They feed each other. With an imperfection in the shape of the rings, of amplitude
d, W. T. Koiter (Proc. Kon. Ned. Akad. Wet. B66 (1963) 265) found that the cylinder bifurcates into
the square pattern at the part x of the classical load with

    (1 - x)^2 = (3/2) sqrt(3 (1 - nu^2)) (d/t) x

to first order: a tenth of the thickness costs two fifths of the load, a half of it two thirds; with
more, patterns buckle that a cell of this size does not hold. That curve is drawn in a loop of ten
lines: imperfection, path to its first critical point, load.

A long cylinder repeats itself, so a cell of it is enough: two half waves l each way, all four edges
on planes of symmetry, the loaded one moving as a whole. Its size follows sqrt(R t), so that
R/t = 100 and R/t = 1000 need the same mesh.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.optimize import brentq

import fem_lie as fl
from fem_lie.pictures.diagrams import COLOURS
from fem_lie.pictures.units import Units

RESULTS = Path(__file__).parents[1] / "results"
MATERIAL = fl.Material(1.0, 0.3, 1.0)
AMPLITUDES = (0.01, 0.03, 0.1, 0.3, 0.5)
KOITER = np.sqrt(3 * (1 - MATERIAL.nu**2))
UNITS = Units(length="R")


def half_wave(thickness: float) -> float:
    """Of the ring mode; the radius is 1."""
    return float(np.pi * np.sqrt(thickness) / (12 * (1 - MATERIAL.nu**2)) ** 0.25)


def outward(x: np.ndarray) -> np.ndarray:
    """Unit vector from the axis."""
    return np.array([x[0], x[1], 0.0]) / np.hypot(x[0], x[1])


def cell(thickness: float, mesh: int, slimness: float = 1.0) -> fl.Scene:
    """Two half waves of the ring mode each way, under the classical load; radius 1.

    ``slimness``: by how much it is narrower around than along.
    """
    length = 2 * half_wave(thickness)
    width = length / slimness

    def place(a: float, b: float) -> np.ndarray:
        return np.array([np.cos(a * width), np.sin(a * width), b * length])

    wall = fl.Shell(
        fl.surface(place, (2 * mesh, 2 * mesh)),
        fl.ShellSection.layer(thickness, MATERIAL),
        director=outward,
        name="wall",
    )
    wall.symmetry("b=1", (0, 0, 1))
    top = wall.points("b=1")
    for point in top:
        wall.held[point.node, 0] = False  # along the axis, which is e1 there: the ring holds it
    wall.symmetry("b=0", (0, 0, 1))
    wall.symmetry("a=0", (0, 1, 0))
    wall.symmetry("a=1", (-np.sin(width), np.cos(width), 0))
    scene = fl.Scene()
    scene.add(wall)
    press = scene.add(fl.RigidBody(1.0, 3 * [length**2], place(0.5, 1), name="press"))
    scene.add(fl.Prismatic(fl.ground(), press.centre, axis=(0, 0, 1)))
    for point in top:
        scene.add(fl.InPlane(press.centre, point, at=point.position, axis=(0, 0, 1)))
    load = MATERIAL.E * thickness**2 / KOITER
    scene.add(fl.PointLoad(press.centre, force=(0, 0, -load * width)))
    return scene


def rings(thickness: float, amplitude: float) -> fl.FieldImperfection:
    """Outward in the middle of the cell: there the square mode has its node."""
    wave = half_wave(thickness)

    return fl.FieldImperfection(lambda x: -amplitude * np.cos(np.pi * x[2] / wave) * outward(x))


def koiter(relative: float) -> float:
    """Part of the classical load that is left with ring imperfections, over the thickness."""
    return float(brentq(lambda x: (1 - x) ** 2 - 1.5 * KOITER * relative * x, 0.0, 1.0))


def knock_down(thickness: float, mesh: int) -> list[fl.EquilibriumPath]:
    """Paths to the first critical point with ring imperfections."""
    perfect = cell(thickness, mesh)
    return [
        fl.follow_path(
            fl.imperfect(perfect, rings(thickness, amplitude * thickness)),
            fl.PathEnds(critical_points=1),
        )
        for amplitude in AMPLITUDES
    ]


def main(
    mesh: int = 8, ratios: str = "100,200,500,1000", seed: int = 1, pictures: bool = True
) -> dict[str, Any]:
    """``mesh``: cells of a half wave."""
    slender = [float(ratio) for ratio in ratios.split(",")]
    record: dict[str, Any] = {"mesh": mesh, "perfect": {}, "knock_down": {}}
    print("perfect: load over the classical one     negative pivots")
    print("R/t     linear    path       error       before, after  iterations  seconds")
    for ratio in slender:
        scene = cell(1.0 / ratio, mesh)
        modes = fl.buckling(scene, 2)
        path = fl.follow_path(scene, fl.PathEnds(1.1, critical_points=1))
        point = path.critical[0]
        found = {
            "linear": float(modes.factors[0]),
            "path": point.factor,
            "error": max(abs(modes.factors[0] - 1.0), abs(point.factor - 1.0)),
            "negative_pivots": point.negative_pivots,
            "load_steps": int((path.iterations > 0).sum()) - 1,
            "iterations": path.total_iterations,
            "seconds": path.seconds,
        }
        record["perfect"][ratio] = found
        print(
            f"{ratio:5g}   {found['linear']:.4f}    {found['path']:.4f}     {found['error']:.2%}"
            f"       {point.negative_pivots}   {found['iterations']:10}  {found['seconds']:8.1f}"
        )
        if pictures:
            RESULTS.mkdir(exist_ok=True)
            for mode in (1, 2):
                picture = RESULTS / f"compressed_cylinder_{ratio:g}_mode{mode}.png"
                modes.picture(picture, mode, amplitude=2 / ratio, units=UNITS)
    thickness = 1.0 / slender[0]
    paths = knock_down(thickness, mesh)
    print(f"with rings, R/t = {slender[0]:g}: amplitude over t, load, Koiter, kind, iterations")
    for amplitude, path in zip(AMPLITUDES, paths, strict=True):
        point = path.critical[0]
        record["knock_down"][amplitude] = point.factor
        print(
            f"{amplitude:5g}  {point.factor:.4f}  {koiter(amplitude):.4f}  {point.kind.value}, "
            f"{path.total_iterations} iterations in {path.seconds:.1f} s"
        )
    wave = 2 * half_wave(thickness)
    random = fl.RandomImperfection(0.3 * thickness, wave, seed, along=outward)
    path = fl.follow_path(
        fl.imperfect(cell(thickness, mesh), random),
        fl.PathEnds(critical_points=1, load_range=(-0.1, 1.2)),
    )
    record["random"] = path.critical[0].factor if path.critical else None
    print(f"random waves of 0.3 t, seed {seed}: {record['random']}")
    record["max_error"] = max(found["error"] for found in record["perfect"].values())
    print("largest error of the classical load {max_error:.2%}".format(**record))
    if pictures:
        diagram = RESULTS / "compressed_cylinder.png"
        plot(record["knock_down"], slender[0], diagram)
        print(f"pictures: {diagram}, {RESULTS / 'compressed_cylinder_*_mode*.png'}")
    return record


def knock_down_diagram() -> tuple[Figure, Axes]:
    """Empty, for loads over amplitudes."""
    figure = Figure(figsize=(6.0, 4.0), dpi=150, layout="constrained")
    axes = figure.subplots()
    axes.set(xlabel="amplitude of the rings over t", ylabel="load over the classical one")
    axes.set_ylim(0.0, 1.05)
    axes.grid(color="#DDDDDD", linewidth=0.6)
    return figure, axes


def plot(loads: dict[float, float], ratio: float, path: Path) -> None:
    """The knock-down curve."""
    figure, axes = knock_down_diagram()
    fine = np.linspace(0.0, max(loads), 200)
    axes.plot(fine, [koiter(d) for d in fine], color="black", label="Koiter 1963")
    axes.plot(loads.keys(), loads.values(), "o", color=COLOURS[0], label=f"R/t = {ratio:g}")
    axes.legend(frameon=False)
    figure.savefig(path)


if __name__ == "__main__":
    from command_line import run

    run(main)
