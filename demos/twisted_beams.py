"""Two round beams that lie against each other are twisted to a double helix: line contact.

Beams of length L = 5, radius r = 0.01, E = 1e9, side by side along z, are stretched, and turned
about each other by a full turn, their ends along the tangents of the helix, on a circle of
R = 0.0095 at last: to a helix of 1.01 of their length. Everything is constant along it then, with
curvature k = R (2 pi/1.01 L)^2 and torsion tau, and what pushes the beams apart per length balances
tension and bending (case and figures are those of a test of 4C's beam contact):

    eps (2 r - 2 R) = 1.01 (N k + 1.01 EI k tau^2),   N = 0.01 EA

which holds for the penalty eps = 46845.28 per length and area. The node in the middle moves to the
other side, by -2 R across. error is that of its radius over R after a full turn.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import run

import fem_lie as fl

R, LENGTH, RADIUS, YOUNG = 0.0095, 5.0, 0.01, 1e9
AREA, BENDING = np.pi * RADIUS**2, np.pi * RADIUS**4 / 4
START, FIRST = 1.01 * RADIUS, 0.2  # radius at which they are laid, part in which they are stretched
# softer in shear, as elements are by default, they are unstable under a tension over 12 EI/l^2
ELEMENT = fl.elements.GeodesicBeam(bending_flexibility=False)
# the helix on a circle of R is 1.01 L long
HEIGHT = float(np.sqrt((1.01 * LENGTH) ** 2 - (2 * np.pi * R) ** 2))


def penalty() -> float:
    """Force per length and overlap for which the helix is in equilibrium."""
    stretch, turn = 1.01, 2 * np.pi / (1.01 * LENGTH)
    curvature, torsion = R * turn**2, HEIGHT / (2 * np.pi) * turn**2
    tension = YOUNG * AREA * (stretch - 1)
    pressed = tension * curvature + stretch * YOUNG * BENDING * curvature * torsion**2
    return float(stretch * pressed / (2 * RADIUS - 2 * R))


def end_motion(beam: fl.Beam, node: int, side: float) -> fl.PrescribedMotion:
    """An end goes up if it is the upper one, then round by a turn, and inwards."""
    point, start = fl.extend.Point(beam, node), beam.frames[node]
    upper = start[0, 2] > 0

    def frame(part: float) -> np.ndarray:
        stretched, twisted = min(1.0, part / FIRST), max(0.0, (part - FIRST) / (1 - FIRST))
        radius = side * (START + twisted * (R - START))
        height = LENGTH + stretched * (HEIGHT - LENGTH)
        angle = 2 * np.pi * twisted * upper
        c, s = np.cos(angle), np.sin(angle)
        turned = start[2] @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
        slope = 2 * np.pi * twisted / height
        along = np.array([-radius * s * slope, radius * c * slope, 1.0])
        along /= np.linalg.norm(along)
        across = turned - (turned @ along) * along
        across /= np.linalg.norm(across)
        position = np.array([radius * c, radius * s, height * upper])
        return np.stack([position, along, across, np.cross(along, across)])

    return fl.PrescribedMotion(point, frame)


def main(mesh: int = 16, load_steps: int = 30) -> dict[str, Any]:
    """Elements of each beam, and steps in which they are turned."""
    EA, EI = YOUNG * AREA, YOUNG * BENDING
    section = fl.Section.from_stiffness([EA, 0.4 * EA, 0.4 * EA, 1e-3 * EI, EI, EI])
    scene = fl.Scene()
    lines = []
    for side in (1.0, -1.0):
        x = side * START
        ends = (x, 0, 0), (x, 0, LENGTH)
        beam = scene.add(fl.Beam.straight(*ends, section, cells=mesh, formulation=ELEMENT))
        for node in (0, mesh):
            scene.add(end_motion(beam, node, side))
        lines.append(fl.contact.Line(beam, RADIUS))
    contact = scene.add(fl.contact.Contact(*lines, fl.contact.Penalty(penalty()), name="beams"))
    result = fl.statics(scene, load_steps=load_steps)
    beam = lines[0].body
    moved = result.position(fl.extend.Point(beam, mesh // 2))[-1] - beam.frames[mesh // 2, 0]
    overlap = fl.post.contact_forces(result, contact, [-1]).gaps
    record = {
        "error": float(abs(np.hypot(START + moved[0], moved[1]) / R - 1)),
        "across": float(START + moved[0] + R),
        "gap": float(overlap.mean()),
        "gap_spread": float(np.ptp(overlap)),
        "iterations": int(result.iterations[-1]),
        "most_iterations": int(np.diff(result.iterations, prepend=0).max()),
        "load_steps": len(result.factors),
    }
    return record


if __name__ == "__main__":
    run(main, show=True)
