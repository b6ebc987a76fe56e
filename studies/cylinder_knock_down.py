"""Knock-down of a compressed cylinder whose imperfection is a buckling mode: rings.

The cell of `compressed_cylinder.py`, R/t = 100 and 500. Its rings are found among the modes of
linear buckling, given as `fl.stability.ModeImperfection` with amplitudes of 0.1, 0.5 and 1
thickness, and the path is followed to its first critical point.

W. T. Koiter (The effect of axisymmetric imperfections on the buckling of cylindrical shells under
axial compression, Proc. Kon. Ned. Akad. Wet. B66 (1963) 265) lets the rings, whose amplitude d
grows to d/(1 - x) at the part x of the classical load, bifurcate into a pattern of twice their
length, and found (1 - x)^2 = (3/2) sqrt(3 (1 - nu^2)) (d/t) x for small d. Larger ones want the
pattern's width to be free: with tau the ratio of its wave numbers around and along, Galerkin's
method with one term of it, cos(p x) cos(tau p y), in Donnell's equations (the stress function
solved for exactly) gives, for z = sqrt(3 (1 - nu^2)) (d/t)/(1 - x),

    (1 + tau^2)^2/16 + (1 - z tau^2)^2/(1 + tau^2)^2 + z^2 tau^4/(9 + tau^2)^2
        = x/2 + x z tau^2/4,

and the lowest x over all tau is the curve. For small d that is tau = 1 and Koiter's formula; then
the pattern becomes wider around (tau < 1). The cell is as wide as half a wave of it, and the lowest
load of several widths counts.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.optimize import brentq, minimize_scalar

import fem_lie as fl
from demos.command_line import RESULTS, run
from demos.compressed_cylinder import cell, outward
from demos.diagrams import diagram
from demos.reference.compressed_cylinder import KOITER, koiter
from fem_lie.extend import COLOURS

AMPLITUDES = (0.1, 0.5, 1.0)
SLIMNESS = (0.85, 1.0, 1.15)  # times that of the formula
MODES = 6


def load_of_pattern(relative: float, tau: float) -> float:
    """Part of the classical load at which rings of this amplitude over t bifurcate."""

    def balance(x: float) -> float:
        z = KOITER * relative / (1 - x)
        inner = (1 - z * tau**2) ** 2 / (1 + tau**2) ** 2 + z**2 * tau**4 / (9 + tau**2) ** 2
        return (1 + tau**2) ** 2 / 16 + inner - x / 2 - x * z * tau**2 / 4

    fine = np.linspace(1e-6, 1 - 1e-6, 2001)
    below = np.flatnonzero(np.array([balance(x) for x in fine]) < 0)
    if not len(below):
        return 1.0
    first = below[0]
    return float(brentq(balance, fine[max(first - 1, 0)], fine[first])) if first else 0.0


def koiter_pattern(relative: float) -> tuple[float, float]:
    """The lowest load over all patterns, and its tau."""
    found = minimize_scalar(
        lambda tau: load_of_pattern(relative, tau), bounds=(0.2, 1.5), method="bounded"
    )
    return float(found.fun), float(found.x)


def ring_mode(modes: fl.stability.BucklingModes) -> tuple[int, int]:
    """The first mode that does not vary around, and the sign with which edges are inward."""
    wall = modes.info.body("wall").nodes
    x = modes.frames[wall, 0]
    moved = np.stack([modes.displacement(node) for node in wall], axis=1)
    radial = np.sum(moved * _outward(x), axis=2)
    heights = np.round(x[:, 2], 9)
    varies = []
    for w in radial:
        around = [np.ptp(w[heights == height]) for height in np.unique(heights)]
        varies.append(max(around) / np.abs(w).max())
    rings = np.flatnonzero(np.array(varies) < 0.05)
    if not len(rings):
        raise ArithmeticError(f"no mode is one of rings: they vary by {varies} around")
    number = int(rings[0])
    return 1 + number, -int(np.sign(radial[number][x[:, 2].argmin()]))


def _outward(x: np.ndarray) -> np.ndarray:
    return np.array([outward(position) for position in x])


def found_amplitude(perfect: fl.Scene, imperfect: fl.Scene) -> float:
    """Largest displacement of a node."""
    pairs = zip(perfect.bodies, imperfect.bodies, strict=True)
    moved = [b.frames[:, 0] - a.frames[:, 0] for a, b in pairs]
    return max(float(np.linalg.norm(u, axis=1).max()) for u in moved)


def knock_down(ratio: float, mesh: int, relative: float, slimness: float) -> dict[str, Any]:
    """First critical point with rings in a cell of one width."""
    thickness = 1.0 / ratio
    perfect = cell(thickness, mesh, slimness)
    modes = fl.buckling(perfect, MODES)
    mode, sign = ring_mode(modes)
    wanted = relative * thickness
    rings = fl.stability.apply_imperfections(
        perfect, fl.stability.ModeImperfection(modes, mode, sign * wanted)
    )
    path = fl.follow_path(rings, fl.stability.PathEnds(critical_points=1, load_range=(-0.1, 1.2)))
    point = path.critical[0] if path.critical else None
    return {
        "slimness": slimness,
        "mode": mode,
        "amplitude_error": abs(found_amplitude(perfect, rings) / wanted - 1.0),
        "load": point.factor if point else None,
        "kind": point.kind.value if point else path.reason,
        "iterations": path.total_iterations,
        "seconds": path.seconds,
    }


def main(mesh: int = 6, ratios: str = "100,500", pictures: bool = True) -> dict[str, Any]:
    """``mesh``: cells of a half wave of the rings."""
    record: dict[str, Any] = {"mesh": mesh, "loads": {}}
    print("R/t   d/t   load    Koiter  asymptotic  tau    amplitude − 1  kind, iterations, seconds")
    for ratio in (float(ratio) for ratio in ratios.split(",")):
        loads = record["loads"][ratio] = {}
        for relative in AMPLITUDES:
            theory, tau = koiter_pattern(relative)
            tries = [knock_down(ratio, mesh, relative, part * tau) for part in SLIMNESS]
            lowest = min(
                (found for found in tries if found["load"] is not None),
                key=lambda found: found["load"],
            )
            loads[relative] = lowest | {"koiter": theory, "tau": tau, "tries": tries}
            print(
                f"{ratio:4g}  {relative:4g}  {lowest['load']:.4f}  {theory:.4f}  "
                f"{koiter(relative):.4f}      {lowest['slimness']:.3f}  "
                f"{lowest['amplitude_error']:.1e}        {lowest['kind']}, "
                f"{sum(found['iterations'] for found in tries)}, "
                f"{sum(found['seconds'] for found in tries):.0f}",
                flush=True,
            )
    every = [found for loads in record["loads"].values() for found in loads.values()]
    record["amplitude_error"] = max(t["amplitude_error"] for found in every for t in found["tries"])
    record["from_koiter"] = max(abs(found["load"] - found["koiter"]) for found in every)
    print(
        "largest error of an amplitude {amplitude_error:.1e}; farthest from Koiter's curve "
        "{from_koiter:.3f} of the classical load".format(**record)
    )
    if pictures:
        plot(record["loads"])
        print(f"picture: {RESULTS / 'cylinder_knock_down.png'}")
    return record


def plot(loads: dict[float, dict[float, Any]]) -> None:
    """Loads over amplitude beside Koiter's curve."""
    fine = 1.05 * np.linspace(0.0, 1.0, 60) ** 2
    curve = [1.0] + [koiter_pattern(d)[0] for d in fine[1:]]
    small = [koiter(d) for d in fine]
    with diagram("cylinder_knock_down.png") as axes:
        axes.set(xlabel="amplitude of the rings over t", ylabel="load over the classical one")
        axes.set_ylim(0.0, 1.05)
        axes.plot(fine, small, "--", color="#777777", label="Koiter 1963, small d")
        axes.plot(fine, curve, color="black", label="one term, any pattern")
        for (ratio, found), colour, mark in zip(loads.items(), COLOURS, "os^", strict=False):
            values = [of["load"] for of in found.values()]
            axes.plot(found.keys(), values, mark, color=colour, label=f"R/t = {ratio:g}")


if __name__ == "__main__":
    run(main)
