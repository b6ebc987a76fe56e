"""A row of dominoes falls: boxes that strike, push and slide along each other.

Dominoes of height h and thickness d stand s apart on a floor on which their feet do not slide;
between them there is no friction. The first is pushed over. Each turns about its lower front edge
until its upper one strikes the next; impacts do not bounce, and those behind lean on those in
front. The front goes along the row with a speed that soon changes no more.

Nothing of that is put in: boxes get the contact manifold of each step from a separating axis, here
corners on faces, and impulses satisfy Coulomb's law. The reference is the row as a mechanism of one
degree of freedom between collisions, integrated in the tilt of the foremost domino.
"""

from __future__ import annotations

from itertools import pairwise
from time import process_time
from typing import Any

import numpy as np
from command_line import in_results, run
from reference.dominoes import Row

import fem_lie as fl

ROW = Row(height=0.048, thickness=0.0075, spacing=0.02, gravity=9.81)
WIDTH, PUSH = 0.024, 5.0


def dominoes(count: int, floor_friction: float) -> tuple[fl.Scene, list[fl.RigidBody]]:
    """The scene and the dominoes along X, the lower front edge of the first at the origin."""
    scene = fl.Scene(gravity=(0, 0, -ROW.gravity))
    edges = np.array([ROW.thickness, WIDTH, ROW.height])
    floor = fl.contact.Plane(fl.ground(), (0, 0, 1))
    bodies, surfaces = [], []
    for k in range(count):
        position = k * (ROW.spacing + ROW.thickness) - ROW.thickness / 2, 0, ROW.height / 2
        body = scene.add(fl.RigidBody.box(1.0, edges, position, name=f"domino {k + 1}"))
        surfaces.append(fl.contact.Box(body.point("centre"), edges))
        scene.add(fl.contact.Contact(surfaces[-1], floor, fl.contact.Impact(floor_friction)))
        bodies.append(body)
    for behind, front in pairwise(surfaces):
        scene.add(fl.contact.Contact(behind, front, fl.contact.Impact()))
    bodies[0].add_velocity(omega=(0, PUSH, 0), about=bodies[0].point((0, 0, 0)))
    return scene, bodies


def times_of_impact(result: fl.Result, bodies: list[fl.RigidBody]) -> np.ndarray:
    """When each but the first begins to turn, from its tilt and rate in the first step after."""
    found = []
    for body in bodies[1:]:
        rates = result.velocity(body.point("centre"))[:, 4]
        k = int(np.flatnonzero(np.abs(rates) > 1e-3 * PUSH)[0])
        found.append(result.times[k] - result.rotation(body.point("centre"))[k, 0, 2] / rates[k])
    return np.array(found)


def front_speed(times: np.ndarray) -> float:
    """Over the last three dominoes, over √(g h)."""
    pitch = ROW.spacing + ROW.thickness
    return float(3 * pitch / (times[-1] - times[-4]) / np.sqrt(ROW.gravity * ROW.height))


def main(
    count: int = 8,
    step: float = 2e-4,
    floor_friction: float = 2.0,
    pictures: bool = True,
) -> dict[str, Any]:
    """How many there are, and the friction of the floor."""
    reference = ROW.times(PUSH, count)
    scene, bodies = dominoes(count, floor_friction)
    duration = step * np.ceil(1.1 * reference[-1] / step)
    before = process_time()
    result = fl.GeneralisedAlpha().run(scene, duration=duration, step=step)
    seconds = process_time() - before
    times = times_of_impact(result, bodies)
    contacts = result.contacts
    assert contacts is not None
    if pictures:
        result.picture(in_results("dominoes.png"), (duration,), title="Dominoes")
    return {
        "front_speed": front_speed(times),
        "reference_speed": front_speed(reference),
        "largest_time_error": float(np.abs(times / reference - 1).max()),
        "penetration": float(contacts.penetration.max()),
        "cone_residual": float(contacts.cone_residual.max()),
        "steps": len(result.times) - 1,
        "microseconds_per_step": 1e6 * seconds / (len(result.times) - 1),
    }


if __name__ == "__main__":
    run(main, show=True)
