"""An elastic bar meets a rigid wall end on: its force is ρ c v A while a wave goes and comes back.

    python -m benchmarks.elastic_bar [--part 0.2] [--radius 0.8] [--impact]

Fifty elements, a penalty of EA/ℓ of an element, or a part of that, at the end that meets, and steps
of 0.5 … 10 times what a wave takes through an element; or an impact, in generalised-α. Energy is
relative to the start, the noise is the standard deviation of the force between 0.1 and 0.9 of
the contact, over ρ c v A, as its mean is.
"""

from __future__ import annotations

import argparse

import numpy as np

import fem_lie as fl

LENGTH, CELLS, SPEED, GAP = 1.0, 50, 1.0, 1e-3
MATERIAL = fl.Material(2e9, 0.0, 1000.0)
SECTION = fl.Section.circle(0.02, MATERIAL)
WAVE = np.sqrt(2e9 / 1000.0)
AREA = np.pi * 0.02**2
STIFFNESS = 2e9 * AREA * CELLS / LENGTH


def bar(part: float | None = 1.0) -> fl.Scene:
    """On its way to the wall, whose stiffness is a part of EA/ℓ; without one it is rigid."""
    beam = fl.Beam.straight((0, 0, 0), (-LENGTH, 0, 0), SECTION, cells=CELLS)
    beam.add_velocity((SPEED, 0, 0))
    wall = fl.contact.Plane(fl.ground(), (-1, 0, 0), at=(GAP, 0, 0))
    law = fl.contact.Impact() if part is None else fl.contact.Penalty(part * STIFFNESS)
    touch = fl.contact.Contact(fl.contact.Vertices([beam.point("start")]), wall, law)
    scene = fl.Scene()
    scene.add(beam)
    scene.add(touch)
    return scene


def run(
    scheme: fl.EnergyMomentum | fl.GeneralisedAlpha, courant: float, part: float | None = 1.0
) -> dict[str, float]:
    """Largest energy, noise of the force, length of the contact, rebound, impulse."""
    scene = bar(part)
    step, back = courant * LENGTH / CELLS / WAVE, 2 * LENGTH / WAVE
    end = GAP / SPEED + 1.5 * back
    steps = int(np.ceil(end / step))
    result = scheme.run(scene, duration=steps * step, step=step, progress=False)
    # over each step, from what the wall has given
    impulse = -result.impulses[:, 1, 0]
    force = np.diff(impulse) / step / (1000.0 * WAVE * SPEED * AREA)
    since = (result.times[1:] - 0.5 * step - GAP / SPEED) / back
    inside = force[(since > 0.1) & (since < 0.9)]
    return {
        "energy": float(result.total_energy.max() / result.total_energy[0]),
        "noise": float(inside.std()),
        "force": float(inside.mean()),
        "impulse": float(impulse[-1] / (2.0 * 1000.0 * AREA * LENGTH * SPEED)),
        "rebound": float(-result.momentum[-1, 0] / result.momentum[0, 0]),
        "iterations": float(result.iterations[-1] / steps),
    }


def main() -> None:
    """A row for each step size."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--courant", nargs="+", type=float, default=[0.5, 1, 2, 5, 10])
    parser.add_argument("--part", type=float, default=1.0)
    parser.add_argument("--radius", type=float, default=0.8)
    parser.add_argument("--impact", action="store_true")
    given = parser.parse_args()
    schemes: list[fl.EnergyMomentum | fl.GeneralisedAlpha]
    schemes = [fl.EnergyMomentum(), fl.EnergyDecaying(radius=given.radius)]
    if given.impact:
        schemes = [fl.GeneralisedAlpha(radius=given.radius)]
    for courant in given.courant:
        for scheme in schemes:
            found = run(scheme, courant, None if given.impact else given.part)
            shown = ", ".join(f"{name} {value:.4g}" for name, value in found.items())
            more = found["energy"] - 1.0
            print(f"Courant {courant:4g} {type(scheme).__name__:15s} {shown}, 1 + {more:.1e}")


if __name__ == "__main__":
    main()
