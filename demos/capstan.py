"""A rope around a drum that does not turn: how friction lets a small force hold a large one.

One end of a slender rope is pulled on, the other one is held by a force of 1 N; as the rope slips,

    T1 = T0 exp(mu phi)

with phi the angle along which it lies on the drum. Its tails are straight, and it is laid on
without stress. What is thick or stiff departs from this: forces act on its surface, not in its
axis, a part of radius/drum of them is carried across it.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import run

import fem_lie as fl

DRUM, RADIUS, HELD = 0.1, 2e-4, 1.0
EXTENSION, BENDING, PENALTY = 1e4, 1e-5, 1e6  # N, N m^2, N/m^2
TAILS = 3  # elements of each
ELEMENT = fl.elements.GeodesicBeam(bending_flexibility=False)


def laid(angle: float) -> fl.Beam:
    """Tails along the tangents at both ends of an arc, 40 elements per turn."""
    radius = DRUM + 0.97 * RADIUS  # it lies on the drum from the beginning
    cells = round(20 * angle / np.pi)
    tail = TAILS * angle * radius / cells
    length = angle * radius + 2 * tail

    def position(s: float) -> tuple[float, float, float]:
        along = s * length - tail
        turned = min(max(along / radius, 0.0), angle)
        beyond = along - turned * radius
        c, n = np.cos(turned), np.sin(turned)
        return radius * c - beyond * n, radius * n + beyond * c, 0.0

    stiffness = [EXTENSION, EXTENSION / 3, EXTENSION / 3, BENDING, BENDING, BENDING]
    section = fl.Section.from_stiffness(stiffness)
    return fl.Beam.curve(position, section, cells=cells + 2 * TAILS, formulation=ELEMENT)


def main(
    friction: float = 0.3, angle: float = 180.0, pull: float = 2e-3, load_steps: int = 10
) -> dict[str, Any]:
    """Coefficient, angle in degrees, by how much the rope is pulled, and steps."""
    phi = np.radians(angle)
    rope = laid(phi)
    start = rope.frames[-1]

    def pulled(part: float) -> np.ndarray:
        return start + part * pull * np.array([start[1], *np.zeros((3, 3))])

    scene = fl.Scene()
    scene.add(rope)
    motion = scene.add(fl.PrescribedMotion(rope.point("end"), pulled))
    scene.add(fl.PointLoad(rope.point("start"), force=-HELD * rope.frames[0, 1]))
    drum = fl.contact.Cylinder(fl.ground(), (0, 0, 0.4), DRUM)
    law = fl.contact.Penalty(PENALTY, friction=friction)
    scene.add(fl.contact.Contact(fl.contact.Line(rope, RADIUS), drum, law, name="rope"))
    result = fl.statics(scene, load_steps=load_steps)
    forces = result.reaction(motion)[:, :3] @ start[1]
    ratio, wanted = float(forces[-1] / HELD), float(np.exp(friction * phi))
    return {
        "ratio": ratio,
        "error": abs(ratio / wanted - 1),
        "elements": len(rope.model.elements),
        "iterations": int(result.iterations[-1]),
        "load_steps": len(result.factors),
    }


if __name__ == "__main__":
    run(main, show=True)
