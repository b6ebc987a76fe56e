"""A contact: two surfaces, and the law between them."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from zlib import crc32

import numpy as np

from fem_lie._arrays import flag, instance, text
from fem_lie.bodies.body import Body
from fem_lie.bodies.nodes import HeldRotation
from fem_lie.contact.laws.law import ContactTerm, Impact, Penalty
from fem_lie.contact.pairs import known  # noqa: F401  (registers the pairs of the package)
from fem_lie.contact.pairs.pair import ContactPair, Law, bodies_of, pair_class, pair_of
from fem_lie.contact.sides.surfaces import Surface
from fem_lie.contact.sides.table import Nodes
from fem_lie.contact.stiffness import chosen_stiffness

_log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class Contact:
    """Two surfaces that push each other apart, or one that touches itself.

    Attributes:
        a: One of them.
        b: The other; the same one: its balls touch each other.
        law: Contact law.
        name: For messages and results.
        ignore_initial: Whether pairs of points that overlap at the start are ignored until they
            have parted; of points, balls, corners and planes.

    Example:
        >>> ball = fl.RigidBody(1.0, (0.1, 0.1, 0.1), position=(0, 0, 1))
        >>> scene = fl.Scene(gravity=(0, 0, -9.81))
        >>> _ = scene.add(ball)
        >>> floor, skin = fl.Plane(fl.ground(), (0, 0, 1)), fl.Sphere(ball.point("centre"), 0.2)
        >>> _ = scene.add(fl.Contact(skin, floor, fl.Impact(restitution=0.5)))
        >>> len(scene.contacts)
        1
    """

    a: Surface
    b: Surface
    law: Law
    name: str = ""
    ignore_initial: bool = False

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if an argument is of another type than expected."""
        for side, given in (("a", self.a), ("b", self.b)):
            instance(given, Surface, f"Contact: {side}", "a surface such as Plane or Sphere")
        instance(self.law, Law, "Contact: law", "a law such as Penalty(1e6) or Impact()")
        text(self.name, "Contact: name")
        flag(self.ignore_initial, "Contact: ignore_initial")
        if isinstance(self.law, Penalty) and self.law.stiffness is None:
            power = pair_class(self.a, self.b, self.label)[0].power
            k = chosen_stiffness(self.bodies, power, self.label)
            object.__setattr__(self, "law", replace(self.law, stiffness=k))
            _log.info("%s: stiffness %g was chosen", self.label, k)

    @property
    def label(self) -> str:
        """The name, or what touches."""
        return self.name or f"Contact({self.a.label}; {self.b.label})"

    @property
    def bodies(self) -> list[Body]:
        """Bodies that it acts on."""
        return bodies_of(self.a, self.b)

    @cached_property
    def pair(self) -> ContactPair:
        """The contact pair of both surfaces.

        Raises:
            ValueError: Such surfaces do not touch; it says why.
        """
        return pair_of(self.a, self.b, self.law, self.label, self.ignore_initial)

    @property
    def has_friction(self) -> bool:
        """Whether forces depend on the path of the surfaces."""
        return self.pair.has_friction

    @property
    def held_rotations(self) -> Iterator[tuple[Body, HeldRotation]]:
        """Nodes that its forces rotate about all axes, or about which they have moments."""
        return self.pair.held_rotations(self)

    def check(self) -> None:
        """Refuse surfaces that cannot touch, or overlap at the start.

        Raises:
            ValueError: Nothing of them can touch each other, or all that can never moves against
                each other, or they overlap by more than a twentieth of their size.
        """
        self.a.check()
        self.b.check()
        if self.ignore_initial and not self.pair.ignores_initial:
            raise ValueError(f"{self.label}: ignore_initial is for points, balls, boxes and planes")
        if isinstance(self.law, Impact):
            _ = self.pair.impact
        self.pair.check()

    def contents(self, nodes: Nodes) -> tuple[object, ...]:
        """All that its forces depend on.

        Args:
            nodes: Numbers of a body's nodes.
        """
        return self.pair.contents(nodes)

    def key(self, nodes: Nodes) -> int:
        """A number that distinguishes it from other contacts of its scene, of :meth:`contents`."""
        found = 0
        for part in self.contents(nodes):
            data = part.tobytes() if isinstance(part, np.ndarray) else repr(part).encode()
            found = crc32(data, found)
        return found

    def term(self, nodes: Nodes) -> ContactTerm:
        """Its forces.

        Args:
            nodes: Numbers of a body's nodes.

        Raises:
            ValueError: Its law has none, but impulses.
        """
        return self.pair.term(nodes)
