"""Whirl of an overhung rotor and of a Jeffcott rotor: Campbell diagram, critical speed, unbalance.

A light shaft carries a heavy disc at its free end, or in the middle between two bearings. The disc
tilts when the shaft bends, and its spin turns that into forward and backward whirl with different
frequencies: they are those in the frame that does not rotate. The reference is the transfer matrix
of the shaft with its mass: the formulas for a shaft without mass are 1e-4 off. In the last part the
shaft is damped in space, and the disc has an unbalance.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import in_results, run
from reference.whirling_shaft import Shaft

import fem_lie as fl
from fem_lie.joints import InPlane, RigidLink, Universal
from fem_lie.stability import Unbalance, campbell, unbalance_response

X, EI, MASS, RADIUS = (1.0, 0.0, 0.0), 100.0, 1.0, 0.3
POLAR, ACROSS = MASS * RADIUS**2 / 2, MASS * RADIUS**2 / 4
SPEEDS = np.array([0.0, 0.45, 0.9, 1.8, 4.5])
"""Over the slowest frequency at rest."""


def rotor(name: str, ratio: float, cells: int, friction: float = 0.0):
    """Scene, disc, and reference, for a ratio of masses."""
    line, overhung = ratio * MASS, name == "overhung"
    section = fl.Section.from_stiffness([1e7] * 3 + [EI] * 3, mass=line, polar=2e-6 * line)
    damping, scene = fl.sections.Damping(mass=friction), fl.Scene()
    shaft = fl.Rod.straight((0, 0, 0), X, section, cells=cells, damping=damping)
    start, end = shaft.point("start"), shaft.point("end")
    middle = end if overhung else shaft.point(cells // 2)
    disc = fl.RigidBody(MASS, (POLAR, ACROSS, ACROSS), position=middle.position, name="disc")
    held = [fl.Clamp(start)]
    if not overhung:
        held = [InPlane(fl.ground(), end, axis=across) for across in np.eye(3)[1:]]
        held.append(Universal(fl.ground(), start, axis=(0, 1, 0), second=(0, 0, 1)))
    for item in (shaft, disc, RigidLink(middle, disc.point("centre")), *held):
        scene.add(item)
    return scene, disc, Shaft(EI, line, 1e-6 * line, (MASS, POLAR, ACROSS), overhung, friction)


def errors(name: str, ratio: float, cells: int, pictures: bool) -> dict[str, float]:
    """Largest relative errors of the first two whirl modes each way, and of the critical speed."""
    scene, _, exact = rotor(name, ratio, cells)
    speeds = SPEEDS * exact.whirl([0.0], 1, 1)[0, 0]
    found, record = campbell(scene, X, speeds, pairs=2), {}
    for way, sense in (("forward", 1), ("backward", -1)):
        whirl = getattr(found, way).imag / exact.whirl(speeds, 2, sense)
        record |= {f"{way}_{k + 1}": float(np.abs(whirl[:, k] - 1).max()) for k in range(2)}
    if pictures:
        found.picture(in_results(f"whirl_{name}.png"))
    return record | {"critical": float(abs(found.critical_speeds / exact.critical_speed() - 1)[0])}


def main(cells: str = "4,16,64,200", ratio: float = 1e-3, pictures: bool = True) -> dict[str, Any]:
    meshes, scenes = [int(count) for count in cells.split(",")], ("overhung", "jeffcott")
    found = {name: {n: errors(name, ratio, n, pictures) for n in meshes} for name in scenes}
    scene, disc, exact = rotor("overhung", ratio, 64, friction=200.0)
    speeds = np.linspace(0.0, 3.0, 31) * exact.whirl([0.0], 1, 1)[0, 0]
    bent = unbalance_response(scene, X, Unbalance(disc.point("centre"), (0, 1e-5, 0)), speeds)
    expected = np.array([exact.unbalanced(speed, 1e-5) for speed in speeds])
    gap = np.abs(bent.displacement("disc.centre")[:, 1] - expected).max()
    return {"ratio": ratio, **found, "unbalance_error": float(gap / np.abs(expected).max())}


if __name__ == "__main__":
    run(main, show=True)
