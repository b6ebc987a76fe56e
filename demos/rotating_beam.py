"""A beam on a turning hub: its frequencies over the angular velocity.

Centrifugal force stretches a beam that turns, and a stretched beam is stiffer. Across the plane of
rotation (flap) and within it (lag) a slender beam vibrates as

    EI w'''' - (N w')' = rho A (omega^2 + s W^2) w,    N = rho A W^2 (L^2 - x^2) / 2,

with W the angular velocity of the hub, s = 0 for flap and 1 for lag: the lag frequencies follow
from those of a flap by omega^2 - W^2. The reference is a Chebyshev collocation of this equation;
A. D. Wright, C. E. Smith, R. W. Thresher & J. L. C. Wang (J. Appl. Mech. 49 (1982) 197) give the
same figures by power series. Here nothing of the kind is derived: the beam is clamped to the hub,
`vibrations(scene, spin=...)` finds its equilibrium in the turning frame and linearises there, with
all centrifugal and Coriolis forces.

The record has the numbers of spin_up.py, too, where the hub gets up to speed.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import spin_up
from command_line import in_results, run
from diagrams import COLOURS, diagram
from reference.rotating_beam import flapping
from spin_up import LENGTH

import fem_lie as fl

STEEL = fl.Material(E=2e11, nu=0.3, density=7800.0)
WIDTH, HEIGHT = 0.02, 0.04


def blade(elements: int) -> tuple[fl.Scene, fl.Beam]:
    """A slender steel beam along x, clamped at the origin."""
    scene = fl.Scene()
    section = fl.Section.rectangle(WIDTH, HEIGHT, STEEL)
    beam = scene.add(fl.Beam.straight((0, 0, 0), (LENGTH, 0, 0), section, cells=elements))
    scene.add(fl.Clamp(beam.point("start")))
    return scene, beam


def campbell(
    elements: int, speeds: np.ndarray
) -> tuple[np.ndarray, np.ndarray, fl.stability.Modes]:
    """First six frequencies at each speed over the first lag frequency scale, and references."""
    scene, beam = blade(elements)
    D, mass = np.diag(beam.model.stiffness[0]), beam.model.density[0, 0, 0]
    flap, lag = (np.sqrt(D[k] / mass) / LENGTH**2 for k in (4, 5))
    found, expected = [], []
    for speed in speeds:
        spin = speed * lag
        modes = fl.vibrations(scene, 6, spin=(0, 0, spin))
        within = np.sqrt((lag * flapping(speed, 6)) ** 2 - spin**2)
        both = np.concatenate([flap * flapping(spin / flap, 6), within])
        found.append(modes.frequencies / lag)
        expected.append(np.sort(both)[:6] / lag)
    return np.array(found), np.array(expected), modes


def main(
    elements: int = 16,
    fastest: float = 10.0,
    step: float = 0.025,
    duration: float = 20.0,
    pictures: bool = True,
) -> dict[str, Any]:
    speeds = np.linspace(0.0, fastest, 6)
    found, expected, modes = campbell(elements, speeds)
    if pictures:
        draw(speeds, found)
        modes.animate(in_results("rotating_beam_mode.gif"), 3)
    return {
        "elements": elements,
        "fastest": fastest,
        "frequency_error": float(np.abs(found / expected - 1).max()),
        **{f"frequency_{k}": float(value) for k, value in enumerate(found[-1], start=1)},
        **spin_up.main(elements, step, duration, pictures),
    }


def draw(speeds: np.ndarray, found: np.ndarray) -> None:
    """Campbell diagram."""
    fine = np.linspace(speeds[0], speeds[-1], 60)
    ratio = HEIGHT / WIDTH  # of flap to lag
    lag = np.array([np.sqrt(flapping(w, 4) ** 2 - w**2) for w in fine])
    flap = np.array([ratio * flapping(w / ratio, 4) for w in fine])
    with diagram("rotating_beam.png") as axes:
        axes.plot(fine, lag, color=COLOURS[0])
        axes.plot(fine, flap, color=COLOURS[1])
        axes.plot(speeds, found, "o", color="black", markersize=4)
        axes.plot([], [], color=COLOURS[0], label="lag, collocation")
        axes.plot([], [], color=COLOURS[1], label="flap, collocation")
        axes.plot([], [], "o", color="black", markersize=4, label="vibrations()")
        axes.plot(fine, fine, ":", color="#777777", label="once per turn")
        axes.set(xlabel="angular velocity", ylabel="frequency", title="Campbell diagram")
        axes.set_ylim(0.0, 1.08 * found.max())
        axes.legend(frameon=False, loc="center left", bbox_to_anchor=(0.0, 0.7))


if __name__ == "__main__":
    run(main, show=True)
