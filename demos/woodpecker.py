"""The woodpecker toy: a bird on a sleeve swings, jams on its pole, pecks, and slides down.

The sleeve moves along the pole and tilts in its play; the bird hangs on it by a spiral spring. Two
edges of the sleeve (restitution 0) and the beak (0.5) strike the pole with Coulomb friction 0.3.
Published is the motion of small angles: gaps and their rates are linear in the coordinates. It is
the limit of small gaps and small gravity at given lengths, so these are divided by 10 000 here, and
results are multiplied by it: whatever is left of larger angles is below 1e-4. Times are the same.

Reference: the limit cycle of R. I. Leine, C. Glocker & D. H. van Campen, ASME DETC2001/VIB-21608,
where the bird passes -0.2788 rad on its way down; and Moreau's time-stepping of their equations.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from command_line import run
from diagrams import COLOURS, diagram
from reference import woodpecker as published
from reference.woodpecker import Toy

import fem_lie as fl

TOY, SMALL, Z = Toy(), 1e-4, (0, 0, 1)


def rotated(angle: float) -> np.ndarray:
    """Rotation about Z by an angle of the published model."""
    c, s = np.cos(SMALL * angle), np.sin(SMALL * angle)
    return np.array([(c, -s, 0), (s, c, 0), Z])


def woodpecker() -> tuple[fl.Scene, fl.RigidBody, fl.RigidBody]:
    """The scene, in the published state; the pole is along Y, the bird at larger X."""
    scene, ground, impact = fl.Scene(gravity=(0, -SMALL * 9.81, 0)), fl.ground(), fl.contact.Impact
    tilts, rates = TOY.start[1:3], TOY.start[4:6]
    R, Q = map(rotated, tilts)
    pivot = TOY.l_M * R[:, 0]
    centre = pivot + TOY.l_G * Q[:, 0]
    sleeve = scene.add(fl.RigidBody(TOY.m_M, 3 * (TOY.J_M,), (0, 0, 0), R, name="sleeve"))
    bird = scene.add(fl.RigidBody(TOY.m_S, 3 * (TOY.J_S,), centre, Q, name="bird"))
    for body, rate, about in ((sleeve, rates[0], (0, 0, 0)), (bird, rates[1], pivot)):
        body.add_velocity((0, SMALL * TOY.start[3], 0))
        body.add_velocity(omega=(0, 0, SMALL * rate), about=about)
    plane = fl.joints.Planar(ground, sleeve.point("centre"), axis=Z, second=(1, 0, 0))
    scene.add(plane)
    scene.add(fl.joints.Drive(plane.displacements[0]))
    hinge = fl.joints.Revolute(sleeve.point("centre"), bird.point("centre"), at=pivot, axis=Z)
    scene.add(hinge)
    bent = SMALL * (tilts[1] - tilts[0])
    scene.add(fl.joints.Spring(hinge.angle, TOY.c, rest=-bent))
    edges = [sleeve.point(R @ (TOY.r_M, side * TOY.h_M, 0)) for side in (-1, 1)]
    beak = bird.point(centre + Q @ (-TOY.l_S, TOY.h_S, 0))
    beak_at = TOY.l_M + TOY.l_G - TOY.l_S
    for points, at, restitution in ((edges, TOY.r_M, 0.0), ([beak], beak_at, 0.5)):
        wall = at - SMALL * (at - TOY.r_0)
        pole = fl.contact.Plane(ground, (1, 0, 0), at=(wall, 0, 0))
        touching = fl.contact.Vertices(points), pole, impact(TOY.friction, restitution)
        scene.add(fl.contact.Contact(*touching))
    return scene, sleeve, bird


def main(step: float = 1e-4, duration: float = 0.45, pictures: bool = True) -> dict[str, Any]:
    """Times and states of passages, and the limit cycle: speed of the sleeve, rate of the bird."""
    scene, sleeve, bird = woodpecker()
    result = fl.GeneralisedAlpha(radius=0.8).run(scene, duration=duration, step=step)
    axes = [result.rotation(body.point("centre"))[:, 1, 0] / SMALL for body in (sleeve, bird)]
    speed = result.velocity(sleeve.point("centre"))[:, 1] / SMALL
    rate = result.velocity(bird.point("centre"))[:, 5] / SMALL
    # the first passage is the start, on either side of the angle
    found = published.passages(np.stack([result.times, axes[1], speed, rate], axis=1)[1:])
    exact = published.passages(TOY.moreau(duration, 2e-6))
    if pictures:
        with diagram("woodpecker.png") as chart:
            for angle, name, colour in zip(axes, ("sleeve", "bird"), COLOURS, strict=False):
                chart.plot(result.times, angle, color=colour, label=name)
            chart.set(xlabel="time in s", ylabel="angle in rad", title="The woodpecker toy")
    return {
        "passages": found.tolist(),
        "moreau": exact.tolist(),
        "limit_cycle": published.limit(found) if len(found) > 2 else [],
        "published": [TOY.start[3], TOY.start[5]],
        "cone_residual": float(result.contacts.cone_residual.max()),
    }


if __name__ == "__main__":
    run(main, show=True)
