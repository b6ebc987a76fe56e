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

from typing import Any

import numpy as np
import thin_cylinder
from command_line import run
from diagrams import COLOURS, diagram
from reference.compressed_cylinder import half_wave, koiter
from thin_cylinder import cell, outward

import fem_lie as fl

AMPLITUDES = (0.01, 0.03, 0.1, 0.3, 0.5)


def rings(thickness: float, amplitude: float) -> fl.stability.FieldImperfection:
    """Outward in the middle of the cell: there the square mode has its node."""
    wave = half_wave(thickness)

    return fl.stability.FieldImperfection(
        lambda x: -amplitude * np.cos(np.pi * x[2] / wave) * outward(x)
    )


def knock_down(thickness: float, mesh: int) -> dict[float, float]:
    """Load at the first critical point with ring imperfections, by their amplitude over t."""
    perfect, loads = cell(thickness, mesh), {}
    for amplitude in AMPLITUDES:
        wavy = fl.stability.apply_imperfections(perfect, rings(thickness, amplitude * thickness))
        path = fl.follow_path(wavy, fl.stability.PathEnds(critical_points=1))
        loads[amplitude] = path.critical[0].factor
    return loads


def random_waves(thickness: float, mesh: int, seed: int) -> float | None:
    """Load at the first critical point with random waves of 0.3 t."""
    wave = 2 * half_wave(thickness)
    random = fl.stability.RandomImperfection(0.3 * thickness, wave, seed, along=outward)
    until = fl.stability.PathEnds(critical_points=1, load_range=(-0.1, 1.2))
    path = fl.follow_path(fl.stability.apply_imperfections(cell(thickness, mesh), random), until)
    return path.critical[0].factor if path.critical else None


def main(
    mesh: int = 8, ratios: str = "100,200,500,1000", seed: int = 1, pictures: bool = True
) -> dict[str, Any]:
    """``mesh``: cells of a half wave; imperfections are those of the first of the ratios."""
    ratio = float(ratios.split(",")[0])
    loads = knock_down(1.0 / ratio, mesh)
    if pictures:
        with diagram("compressed_cylinder.png") as axes:
            axes.set(xlabel="amplitude of the rings over t", ylabel="load over the classical one")
            axes.set_ylim(0.0, 1.05)
            fine = np.linspace(0.0, max(loads), 200)
            axes.plot(fine, [koiter(d) for d in fine], color="black", label="Koiter 1963")
            label = f"R/t = {ratio:g}"
            axes.plot(loads.keys(), loads.values(), "o", color=COLOURS[0], label=label)
    return {
        **thin_cylinder.main(mesh, ratios, pictures),
        "knock_down": loads,
        "random": random_waves(1.0 / ratio, mesh, seed),
    }


if __name__ == "__main__":
    run(main, show=True)
