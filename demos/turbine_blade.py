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

HUB, SPIN = np.array([0.0, 0.0, 3.97]), np.array([7.56 * np.pi / 30, 0.0, 0.0])


def blade(cells: int) -> fl.Scene:
    """The blade along z, clamped to a hub that turns about x."""
    scene = fl.Scene()
    line = fl.Beam.curve(
        lambda part: HUB + position(part * LENGTH),
        lambda s: fl.Section.from_stiffness(K(s), G(s)),
        cells=cells,
        up=fl.sections.Twisted(twist, up=(0, 1, 0)),
    )
    scene.add(fl.Clamp(scene.add(line).point("start")))
    return scene


def seen_from_hub(cells: int, duration: float, step: float) -> float:
    """Largest motion of any node, over the length, that starts in the steady state."""
    clamped, scene = blade(cells), fl.Scene()
    root = scene.add(clamped.bodies[0]).point("start")
    hub = scene.add(fl.joints.Revolute(fl.ground(), root, at=(0, 0, 0), axis=(1, 0, 0)))
    scene.add(fl.joints.Drive(hub.angle, lambda t: t * SPIN[0]))
    steady, scheme = fl.statics(clamped, spin=SPIN), fl.GeneralisedAlpha()
    result = scheme.run(scene, duration=duration, step=step, start=steady)
    turn = fl.lie.so3_exp(np.outer(result.times, SPIN))
    seen = np.einsum("tji,tnj->tni", turn, result.frames[:, :, 0])
    return float(np.abs(seen - seen[0]).max() / LENGTH)


def main(
    cells: int = 256, duration: float = 20.0, step: float = 0.02, pictures: bool = True
) -> dict[str, Any]:
    clamped = blade(cells)
    found = fl.vibrations(clamped, 8, spin=SPIN).frequencies
    reference = eigenvalues(clamped.bodies[0].frames[0], SPIN, found)
    if pictures:
        speeds, coarse = np.linspace(0.0, 12.0, 7), blade(64)
        over = [fl.vibrations(coarse, 8, spin=rpm / 7.56 * SPIN).hertz for rpm in speeds]
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
