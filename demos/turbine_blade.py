"""A blade of a wind turbine of 15 MW: frequencies while it turns, start without transient.

The blade of the IEA 15 MW reference turbine is 117 m long, bent against the wind by 4 m at its tip,
twisted by 17 degrees, and each section has a full 6 x 6 stiffness: it twists when it bends. Tables
are those that BeamDyn reads, linear between stations. Clamped to the hub, without pitch, gravity
and wind, it turns with 7.56 revolutions per minute.

Centrifugal forces straighten the blade; `vibrations(..., spin=...)` finds this steady state and
linearises there. The reference needs neither displacements nor elements: intrinsic equations along
the blade, steady by a boundary value problem, then by a transfer matrix. Motion starts from the
steady state: seen from the hub nothing moves.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import run
from diagrams import COLOURS, diagram
from reference.blade_tables import LENGTH, G, K, eigenvalues, position, twist

import fem_lie as fl
from fem_lie import lie

HUB, SPIN = np.array([0.0, 0.0, 3.97]), np.array([7.56 * np.pi / 30, 0.0, 0.0])


def blade(cells: int) -> tuple[fl.Scene, fl.Beam]:
    """The blade along z, clamped to a hub that turns about x."""
    line = fl.Beam.curve(
        lambda part: HUB + position(part * LENGTH),
        lambda s: fl.Section.from_stiffness(K(s), G(s)),
        cells=cells,
        up=fl.sections.Twisted(twist, up=(0, 1, 0)),
    )
    scene = fl.Scene()
    scene.add(line)
    return scene, line


def frequencies(cells: int, spin: np.ndarray, count: int = 8) -> tuple[np.ndarray, fl.Beam]:
    """Of the turning blade, rad/s."""
    scene, line = blade(cells)
    scene.add(fl.Clamp(line.point("start")))
    return fl.vibrations(scene, count, spin=spin).frequencies, line


def seen_from_hub(cells: int, duration: float, step: float) -> float:
    """Largest motion of any node, over the length, that starts in the steady state."""
    (still, line), (scene, moving) = blade(cells), blade(cells)
    still.add(fl.Clamp(line.point("start")))
    fl.adaptivity.transfer(fl.statics(still, spin=SPIN), still, scene)
    root = moving.frames[0]

    def hub(time: float) -> np.ndarray:
        return lie.se3_compose(lie.frame(np.zeros(3), lie.so3_exp(time * SPIN)), root)

    scene.add(fl.PrescribedMotion(moving.point("start"), hub))
    result = fl.GeneralisedAlpha().run(scene, duration=duration, step=step)
    turn = lie.so3_exp(result.times[:, np.newaxis] * SPIN)
    nodes = result.info.body(moving.name).nodes
    seen = np.einsum("tji,tnj->tni", turn, result.frames[:, nodes, 0])
    return float(np.abs(seen - seen[0]).max() / LENGTH)


def main(
    cells: int = 256, duration: float = 20.0, step: float = 0.02, pictures: bool = True
) -> dict[str, Any]:
    found, line = frequencies(cells, SPIN)
    reference = eigenvalues(line.frames[0], SPIN, found)
    if pictures:
        speeds = np.linspace(0.0, 12.0, 7)
        over = [frequencies(64, each / 7.56 * SPIN)[0] / (2 * np.pi) for each in speeds]
        with diagram("turbine_blade.png") as axes:
            axes.plot(speeds, over, color=COLOURS[0])
            axes.set(xlabel="revolutions per minute", ylabel="frequency [Hz]", title="Blade, 117 m")
    return {
        "cells": cells,
        **{f"hertz_{k}": each / (2 * np.pi) for k, each in enumerate(found, start=1)},
        "frequency_error": float(np.abs(found / reference.imag - 1).max()),
        "growth": float(np.abs(reference.real / reference.imag).max()),
        "seen_from_hub": seen_from_hub(cells // 4, duration, step),
    }


if __name__ == "__main__":
    run(main, show=True)
