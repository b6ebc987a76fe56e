"""A rod falls within a hollow box that floats: impacts, sliding and sticking of rigid bodies.

A steel rod from (0, -0.2, 1) to (1, 0.2, 0) m with a square section of 0.2 m, one axis of which is
horizontal, falls in a box with outer edges 1.8, 1.6, 1.4 m and walls of 0.1 m about (0.5, 0, 0.5),
axes along X, Y, Z. Gravity acts on the rod alone; the box is free, so all momentum there is comes
from gravity. (That the box is centred there, and how the section lies, are our assumptions.) The
eight corners of the rod against the six inner faces are all that can touch, as the cavity is
convex; with --ends spheres two balls of 0.1 m at the ends touch instead.

They touch by Coulomb's cone, exactly, with --friction and --restitution; steps go over impacts and
do not resolve them. With --law penalty they push each other off by 1e9 N/m, damped critically;
steps have to resolve that (--step 1e-4). Springs of friction are a hundred times as stiff: with
springs as soft as the contact a corner sticks at first where Coulomb's law has it slip.

References are the height of the rod's first end after 2 s: for e = 0, converged in time (h = 1e-2,
1e-3, 1e-4 s, another implementation of the same laws). Where spheres wedge between walls, and with
restitution, motions part after the first impacts.
"""

from __future__ import annotations

from time import process_time
from typing import Any

import numpy as np
from command_line import in_results, one_of, run
from rigid import axes_along, box_inertia

import fem_lie as fl
from fem_lie.contact import Box, Contact, Impact, Penalty, Vertices

FIRST, SECOND = np.array([0, -0.2, 1.0]), np.array([1, 0.2, 0])
SIDE, DENSITY, GRAVITY = 0.2, 7850, 9.81
OUTER, INNER, CENTRE = np.array([1.8, 1.6, 1.4]), np.array([1.6, 1.4, 1.2]), (0.5, 0, 0.5)
LENGTH = float(np.linalg.norm(SECOND - FIRST))
MASS = DENSITY * SIDE**2 * LENGTH

STIFFNESS, RAMP, HOLDING = 1e9, 3e-6, 1e11

REFERENCES = {
    "square": {0.0: -0.7755, 0.2: -0.8419, 0.4: -0.8758, 0.6: -0.9279},
    "spheres": {0.0: -0.7808, 0.2: -0.8274, 0.4: -0.8838, 0.6: -0.5776},
}


def rod_in_box(ends: str, law: Impact | Penalty) -> tuple[fl.Scene, fl.RigidBody, Contact]:
    """The scene, the rod, and what touches."""
    edges, middle = np.array([LENGTH, SIDE, SIDE]), (FIRST + SECOND) / 2
    outer, inner = (DENSITY * float(box.prod()) for box in (OUTER, INNER))
    moments = box_inertia(outer, OUTER) - box_inertia(inner, INNER)
    scene = fl.Scene()
    axes = axes_along(SECOND - FIRST)
    rod = scene.add(fl.RigidBody.box(MASS, edges, middle, axes, name="rod"))
    box = scene.add(fl.RigidBody(outer - inner, moments, CENTRE, name="box"))
    scene.add(fl.PointLoad(rod.point("centre"), (0, 0, -GRAVITY * MASS)))
    balls = Vertices([rod.point(FIRST), rod.point(SECOND)], SIDE / 2)
    surface = Box(rod.point("centre"), edges) if ends == "square" else balls
    walls = Box(box.point("centre"), INNER, inside=True)
    return scene, rod, scene.add(Contact(surface, walls, law, name="rod in box"))


def law_of(law: str, friction: float, restitution: float) -> Impact | Penalty:
    """By its name."""
    one_of("--law", law, ("impact", "penalty"))
    if law == "impact":
        return Impact(friction, restitution)
    if restitution:
        raise ValueError("--law penalty has damping, not restitution; give --restitution 0")
    return Penalty(STIFFNESS, 2 * np.sqrt(STIFFNESS * MASS / 2), RAMP, friction, HOLDING)


def in_contact(result: fl.Result, contact: Contact) -> tuple[int, float, float]:
    """Steps in which something touches, largest overlap and residual of the cones."""
    contacts = result.contacts
    if contacts is not None:
        count = int((contacts.contacts > 0).sum())
        return count, float(contacts.penetration.max()), float(contacts.cone_residual.max())
    forces = fl.post.contact_forces(result, contact)
    return int((forces.touching > 0).sum()), float(forces.penetration.max()), 0.0


def main(
    friction: float = 0.2,
    ends: str = "square",
    law: str = "impact",
    restitution: float = 0.0,
    step: float = 1e-3,
    duration: float = 2.0,
    pictures: bool = True,
) -> dict[str, Any]:
    """Friction and restitution, what the rod's ends are, and how they touch."""
    one_of("--ends", ends, REFERENCES)
    scene, rod, contact = rod_in_box(ends, law_of(law, friction, restitution))
    scheme = fl.GeneralisedAlpha(radius=0.8, tolerance=1e-10)
    scheme.run(scene, duration=step, step=step, progress=False)  # what is compiled is there then
    before = process_time()
    result = scheme.run(scene, duration=duration, step=step)
    seconds = process_time() - before
    steps, given = len(result.times) - 1, MASS * GRAVITY * duration
    touching, overlap, residual = in_contact(result, contact)
    if pictures:
        file, title = in_results("rod_in_box.png"), "Rod in a box, at the end, and its way"
        # with frames bodies are drawn see-through
        result.picture(file, (duration,), trace=["rod.centre"], frames=True, title=title)
    return {
        "rod_end_z": float(result.position(rod.point(FIRST))[-1][2]),
        "momentum_error": float(np.abs(result.momentum[-1] + [0, 0, given]).max()) / given,
        "energy_gain": float(np.diff(result.total_energy).max()) / (MASS * GRAVITY),
        "penetration": overlap,
        "steps": steps,
        "steps_cut": result.divided,
        "microseconds_per_contact_step": 1e6 * seconds / max(touching, 1),
        "cone_residual": residual,
        "iterations_per_step": float(result.iterations[-1]) / steps,
    }


if __name__ == "__main__":
    run(main, show=True)
