"""A beam is driven down across another one, which it bends and slides along: line contact.

One beam lies in the plane z = 0, clamped at both ends, the other above it, all of its nodes led
along (-0.4, 0, -2.5) in one second. Both are round, r = 0.3, E = 1e5, G = 5e4, and so light that
they hardly swing. Case, data and reference are those of a test of 4C's beam contact (19 elements
with two nodes each, which touch in one point by 1e6 per length): displacement of the node number 8
after one second (-0.2353206, 0.0803793, -1.6414776). Along a line the penalty is per length.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import in_results, run

import fem_lie as fl

RADIUS, YOUNG, SHEAR, DENSITY = 0.3, 1e5, 5e4, 1e-3
HEIGHT = 1.32
LOWER = (-2.5, 0.0, 0.0), (-2.5 + 5.0 * np.cos(np.pi / 6), -2.5, 0.0)
END_X, END_Y = 2.5 * np.cos(np.radians(70)), 2.5 * np.sin(np.radians(70))
UPPER = (END_X, END_Y, HEIGHT), (-END_X, -END_Y, HEIGHT)
SPEED = np.array([-0.4, 0.0, -2.5])
REFERENCE = np.array([-0.2353206, 0.0803793, -1.6414776])
NODE, CELLS = 7, 19  # the node of the reference and its elements


def led(beam: fl.Beam, node: int) -> fl.PrescribedMotion:
    """A node goes down."""
    start = beam.frames[node]

    def frame(t: float) -> np.ndarray:
        return start + t * np.array([SPEED, *np.zeros((3, 3))])

    return fl.PrescribedMotion(fl.extend.Point(beam, node), frame)


def main(
    mesh: int = 1, stiffness: float = 1e6, step: float = 1e-2, pictures: bool = True
) -> dict[str, Any]:
    """How often each of the 19 elements is cut, penalty per length, and time step."""
    area, bending = np.pi * RADIUS**2, np.pi * RADIUS**4 / 4
    section = fl.Section.from_stiffness(
        [YOUNG * area, SHEAR * area / 1.1, SHEAR * area / 1.1, 2 * SHEAR * bending]
        + 2 * [YOUNG * bending],
        mass=DENSITY * area,
        polar=2 * DENSITY * bending,
    )
    scene = fl.Scene()
    cells = CELLS * mesh
    lower, upper = (
        scene.add(fl.Beam.straight(*ends, section, cells=cells)) for ends in (LOWER, UPPER)
    )
    for node in (0, cells):
        scene.add(fl.Clamp(fl.extend.Point(lower, node)))
    upper.add_velocity(SPEED)
    for node in range(cells + 1):
        scene.add(led(upper, node))
    lines = fl.contact.Line(lower, RADIUS), fl.contact.Line(upper, RADIUS)
    contact = scene.add(fl.contact.Contact(*lines, fl.contact.Penalty(stiffness), name="beams"))
    scheme = fl.GeneralisedAlpha(radius=0.5, tolerance=1e-8)
    result = scheme.run(scene, duration=1.0, step=step, progress=False)
    at = result.position(fl.extend.Point(lower, NODE * mesh))
    moved = at[-1] - at[0]
    forces = fl.post.contact_forces(result, contact)
    touching = np.flatnonzero(np.linalg.norm(forces.total, axis=1) > 0)
    if pictures:
        file, last = in_results("crossing_beams.png"), (0.0, 1.0)
        result.picture(file, last, arrows=forces.arrows(), title="Crossing beams, and forces")
    record = {
        "moved": moved.tolist(),
        "away": float(np.linalg.norm(moved - REFERENCE) / np.linalg.norm(REFERENCE)),
        "force": float(np.linalg.norm(forces.total[-1])),
        "penetration": float(forces.penetration[-1]),
        "first_touch": float(result.times[touching[0]]),
        "iterations_per_step": float(result.iterations[-1]) / (len(result.times) - 1),
    }
    return record


if __name__ == "__main__":
    run(main, show=True)
