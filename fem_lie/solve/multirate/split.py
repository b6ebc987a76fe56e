"""A scene in parts: one for each size of steps, and what is between them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from fem_lie._arrays import Indices
from fem_lie.bodies.body import Body
from fem_lie.joints import Joint
from fem_lie.scene import Scene
from fem_lie.system.equations import Equations


def domains(scene: Scene, counts: Mapping[Body, int]) -> tuple[dict[int, Scene], Scene]:
    """The scene of the bodies of each number of steps, and that of the joints between these.

    Args:
        scene: The whole.
        counts: Steps of bodies in a whole one; of others it is one.

    Raises:
        ValueError: What is between two of them is no joint.
    """
    of = {body: counts.get(body, 1) for body in scene.bodies}
    parts = {count: _empty(scene) for count in sorted(set(of.values()))}
    between = _empty(scene)
    for body in scene.bodies:
        parts[of[body]].add(body)
        between.add(body)
    for item, bodies in _items(scene):
        touched = {of[body] for body in bodies if body is not None}
        if len(touched) == 1:
            parts[touched.pop()].add(item)
        elif isinstance(item, Joint):
            between.add(item)
        else:
            named = ", ".join(body.label for body in bodies if body is not None)
            raise ValueError(
                f"MultiRate: between bodies with steps of their own there may be joints alone, got "
                f"{type(item).__name__} between {named}; give these steps of one size"
            )
    for item in scene.links:
        between.add(item)
    return parts, between


def _empty(scene: Scene) -> Scene:
    part = Scene(scene.gravity, choices=scene.choices, redundant=scene.redundant)
    part.began = scene.began._replace(turned=None)
    return part


def _items(scene: Scene) -> Iterable[tuple[Any, Iterable[Body | None]]]:
    """All but the bodies, with those that it is between; links first, which joints may sit on."""
    yield from ((link, [link.a.body, link.b.body]) for link in scene.links)
    yield from ((item, item.bodies) for item in (*scene.joints, *scene.connections))
    yield from ((contact, contact.bodies) for contact in scene.contacts)
    yield from ((load, [load.body]) for load in scene.loads)
    yield from ((clamp, [clamp.point.body]) for clamp in scene.clamps)
    yield from ((motion, [motion.point.body]) for motion in scene.motions)


def rows_of(part: Equations, whole: Equations) -> Indices:
    """Which of the moving nodes of the whole are those of a part."""
    node = np.empty(part.unknowns.total, dtype=np.int64)
    for body, own in part.unknowns.bodies.items():
        node[own] = whole.unknowns.bodies[body]
    place = np.full(whole.unknowns.total, -1, dtype=np.int64)
    place[whole.unknowns.leaders] = np.arange(whole.unknowns.moving)
    return np.asarray(place[node[part.unknowns.leaders]])
