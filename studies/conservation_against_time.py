"""Speed against error of the schemes in time: error of the motion and of the invariants.

The double pendulum of soft bars of speed_against_error.py falls under gravity; the mesh is the same
in all runs. Generalised-alpha with the spectral radii 0.8 and 1, energy-momentum (iterated until
only round-off changes, and with the tolerance of generalised-alpha) and energy-decaying with radius
0.8. Errors: distance of the tip over the length of both bars, against the extrapolation of two much
smaller steps; largest change of the total energy over the energy in play. Seconds are those of the
time loop, the best of several runs.

An invariant that is kept is not a motion that is right: all schemes are of second order, and their
errors of motion at equal steps are close to each other. What conservation buys is that nothing of
it is lost or gained in the long run, at two to three times the iterations.
"""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np

import fem_lie as fl

RESULTS = Path(__file__).parents[1] / "results"
SCHEMES = {
    "generalised-alpha, radius 0.8": fl.GeneralisedAlpha(radius=0.8),
    "generalised-alpha, radius 1": fl.GeneralisedAlpha(radius=1.0),
    "energy-momentum": fl.EnergyMomentum(),
    "energy-momentum, tolerance 2e-8": fl.EnergyMomentum(tolerance=2e-8),
    "energy-decaying, radius 0.8": fl.EnergyDecaying(radius=0.8),
}
STEPS = (8e-3, 4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4)
DURATION, FINE, LENGTH = 0.4, 2.5e-5, 1.0


def falling() -> tuple[fl.Scene, fl.Beam]:
    """The scene and its second bar."""
    soft = fl.Section.rectangle(0.02, 0.02, fl.Material(E=2e7, nu=0.3, density=1200.0))
    scene = fl.Scene(gravity=(0, 0, -9.81))
    one, two = (
        scene.add(fl.Beam.straight((a, 0, 0), (b, 0, 0), soft, cells=4))
        for a, b in ((0.0, 0.4), (0.4, 1.0))
    )
    scene.add(fl.joints.Spherical(fl.ground(), one.point("start")))
    scene.add(fl.joints.Revolute(one.point("end"), two.point("start"), axis=(0, 1, 0.3)))
    return scene, two


def main(repeats: int = 3, steps: int = len(STEPS), pictures: bool = True) -> dict[str, Any]:
    if not 2 <= steps <= len(STEPS):
        raise ValueError(f"steps must be between 2 and {len(STEPS)}, got {steps}")
    coarse, fine = (tip(fl.EnergyMomentum(), h)[0] for h in (2 * FINE, FINE))
    exact = (4 * fine - coarse) / 3
    record: dict[str, Any] = {}
    rows = []
    print(f"{'':34}{'h, s':>10}{'motion':>10}{'energy':>10}{'ms':>9}")
    for name, scheme in SCHEMES.items():
        errors = []
        for h in STEPS[:steps]:
            runs = [tip(scheme, h) for _ in range(repeats)]
            error = float(np.linalg.norm(runs[0][0] - exact) / LENGTH)
            seconds = min(run[2] for run in runs)
            errors.append(error)
            rows.append((name, h, error, runs[0][1], seconds))
            print(f"{name:34}{h:10.3g}{error:10.1e}{runs[0][1]:10.1e}{1e3 * seconds:9.1f}")
        key = name.replace(" ", "_").replace(",", "").replace("-", "_").replace(".", "")
        record[f"{key}_order"] = float(np.log2(errors[-2] / errors[-1]))
        record[f"{key}_energy_error"] = max(row[3] for row in rows if row[0] == name)
    if pictures:
        draw(rows)
    return record


def tip(
    scheme: fl.GeneralisedAlpha | fl.EnergyMomentum, h: float
) -> tuple[np.ndarray, float, float]:
    """Tip at the end, error of the energy, seconds."""
    scene, two = falling()
    result = scheme.run(scene, duration=DURATION, step=h, save_every=max(1, round(8e-3 / h)))
    return result.position(two.point("end"))[-1], result.energy_error, result.seconds


def draw(rows: list[tuple[str, float, float, float, float]]) -> None:
    """Leave a table and two diagrams."""
    from matplotlib.figure import Figure

    from fem_lie.extend import COLOURS

    RESULTS.mkdir(exist_ok=True)
    with (RESULTS / "conservation_against_time.csv").open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["scheme", "step", "motion", "energy", "seconds"])
        writer.writerows(rows)
    figure = Figure(figsize=(9, 4), layout="constrained")
    left, right = figure.subplots(1, 2)
    for name, colour in zip(SCHEMES, COLOURS, strict=False):
        mine = np.array([row[1:] for row in rows if row[0] == name])
        left.loglog(1e3 * mine[:, 3], mine[:, 1], "o-", ms=3, label=name, color=colour)
        right.loglog(1e3 * mine[:, 3], np.maximum(mine[:, 2], 1e-17), "o-", ms=3, color=colour)
    left.set_ylabel("error of the tip / length")
    right.set_ylabel("error of the energy, relative")
    for axes in (left, right):
        axes.set_xlabel("milliseconds")
    left.legend(fontsize=7)
    figure.savefig(RESULTS / "conservation_against_time.png", dpi=150)
    print(f"picture: {RESULTS / 'conservation_against_time.png'}")


if __name__ == "__main__":
    from demos.command_line import run

    run(main)
