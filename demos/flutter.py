"""Columns and a cantilever that flutter, and one that buckles under its own weight.

A cantilever under a force at its end that follows the tangent (Beck's column) has no other
equilibrium than the straight one at any load: it does not buckle. At 20.05 EI/L^2 its two slowest
frequencies become one, and beyond an oscillation grows. The same happens under a compression that
follows along the whole length (Leipholz's column) at 40.05 EI/L^2 in all, and under an end torque
that follows, of a cantilever whose bending stiffnesses differ by a factor of two; the reference of
that is a transfer matrix. `fl.stability.flutter` finds the load of each from the scene only.

A column under its own weight has a potential, and `fl.buckling` its load: 7.837 EI/L^3 per length
(A. G. Greenhill 1881).

M. Beck, Z. angew. Math. Phys. 3 (1952) 225; H. Leipholz, Stability Theory (1970).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import run
from diagrams import COLOURS, diagram
from reference.twisted_cantilever import flutter_torque

import fem_lie as fl

EXACT = {"beck": 20.05095, "leipholz": 40.05372, "greenhill": 7.837347}


def column(cells: int, other: float, weight: float = 0.0) -> tuple[fl.Scene, fl.Rod]:
    """A shear-rigid cantilever along z with unit length, mass and bending stiffness."""
    section = fl.Section.from_stiffness([1e6] * 4 + [1.0, other], mass=1.0, polar=1e-6)
    rod = fl.Rod.straight((0, 0, 0), (0, 0, 1), section, cells=cells, name="column")
    scene = fl.Scene(gravity=(0, 0, -weight))
    scene.add(rod)
    scene.add(fl.Clamp(rod.point("start")))
    return scene, rod


def limit(name: str, cells: int) -> fl.stability.StabilityLimit:
    """Flutter under a unit load."""
    scene, rod = column(cells, 2.0 if name == "torque" else 4.0)
    end, along = rod.point("end"), (-1.0, 0.0, 0.0)
    load = {
        "beck": fl.PointLoad(end, force=along, following=True),
        "leipholz": fl.LineLoad(rod, force=along, following=True),
        "torque": fl.PointLoad(end, moment=(1.0, 0.0, 0.0), following=True),
    }
    return fl.stability.flutter(scene.with_loads(load[name]))


def main(cells: int = 16, pictures: bool = True) -> dict[str, Any]:
    found = {name: limit(name, cells) for name in ("beck", "leipholz", "torque")}
    exact = EXACT | {"torque": flutter_torque((1.0, 2.0))}
    if pictures:
        draw(found["beck"])
    record: dict[str, Any] = {}
    for name, one in found.items():
        error = abs(one.factor / exact[name] - 1)
        record[name] = {"kind": one.kind, "load": one.factor, "exact": exact[name], "error": error}
    weight = float(fl.buckling(column(cells, 4.0, 1.0)[0], 1).factors[0])
    return record | {"greenhill": weight, "greenhill_error": abs(weight / EXACT["greenhill"] - 1)}


def draw(beck: fl.stability.StabilityLimit) -> None:
    """Frequencies over the load."""
    with diagram("flutter.png") as axes:
        order = np.sort(beck.eigenvalues.imag, axis=1)[:, :4]
        axes.plot(beck.factors, order, "o-", color=COLOURS[0], markersize=3)
        axes.axvline(beck.factor, linestyle=":", color=COLOURS[1], label="flutter")
        axes.set(xlabel="load L^2/EI", ylabel="frequency", title="Beck's column")


if __name__ == "__main__":
    run(main, show=True)
