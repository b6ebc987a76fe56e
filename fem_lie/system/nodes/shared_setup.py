"""What scenes that differ in loads and drives alone have in common: set up once.

The nodes' numbering, the assembled forms of all elements and their inertia do not depend on what
acts. They are kept by the family of scenes and used by one set of equations after the other, reset
to what they were when they were made.
"""

from __future__ import annotations

import weakref
from collections import Counter
from typing import Any

from fem_lie._arrays import Array
from fem_lie.bodies.told import Told, told_of_body
from fem_lie.scene import Scene
from fem_lie.system.nodes.numbering import Numbering


def numbering_for(scene: Scene, user: object) -> Numbering:
    """The numbering of a scene's nodes, with the assembled forms of the elements, for ``user``.

    It is shared with scenes that differ in loads and drives alone, if there are any.

    Raises:
        ValueError: Two bodies were given the same name after they were added.
    """
    if scene.family is None:
        return numbered(scene)
    if scene.family.setup is None:
        scene.family.setup = SharedSetup()
    found: SharedSetup = scene.family.setup
    return found.numbering(scene, user)


class SharedSetup:
    """Of a family of scenes, which change nothing else between them.

    Attributes:
        made: How often all was set up.
    """

    def __init__(self) -> None:
        """Nothing is set up yet."""
        self.made = 0
        self._numbering: Numbering | None = None
        self._carried: list[Array] = []
        self._mark = b""
        self._user: weakref.ref[Any] | None = None

    def numbering(self, scene: Scene, user: object) -> Numbering:
        """That of a scene of the family, for ``user`` alone as long as it lives.

        It is made anew where bodies or links have changed since, and for a second user beside one
        that still lives.
        """
        mark, used = _mark(scene), self._user is not None and self._user() is not None
        if used:
            return numbered(scene)
        if self._numbering is None or mark != self._mark:
            self._numbering, self._mark = numbered(scene), mark
            self._carried = [assembly.carried_stress for _, assembly in self._numbering.assemblies]
            self.made += 1
        else:
            for (_, assembly), carried in zip(
                self._numbering.assemblies, self._carried, strict=True
            ):
                assembly.reset(carried)
        self._user = weakref.ref(user)
        return self._numbering


def numbered(scene: Scene) -> Numbering:
    """The numbering of its nodes, with the assembled forms of the elements, made anew.

    Raises:
        ValueError: Two bodies were given the same name after they were added.
    """
    twice = [name for name, count in Counter(b.name for b in scene.bodies).items() if count > 1]
    if twice:
        raise ValueError(f"the scene has several bodies named {twice[0]!r}")
    return Numbering(scene.bodies, scene.links, scene.held_rotations())


def _mark(scene: Scene) -> bytes:
    """All on which numbering and assemblies depend."""
    told, holds = Told(scene.bodies), scene.held_rotations()
    bodies = [
        (type(body), told_of_body(body), body.drilling_told(holds.get(body, ())))
        for body in scene.bodies
    ]
    return told.of((bodies, scene.links))
