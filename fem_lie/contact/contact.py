"""A contact: two surfaces and the contact law between them."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from zlib import crc32

import numpy as np

from fem_lie._arrays import flag, instance, text
from fem_lie.bodies.body import Body
from fem_lie.bodies.model import HeldRotation
from fem_lie.contact.laws.law import ContactLaw, ContactTerm
from fem_lie.contact.mortar import pairs as mortar  # noqa: F401  (registers its pairs)
from fem_lie.contact.pairs import known  # noqa: F401  (registers the pairs of the package)
from fem_lie.contact.pairs.pair import ContactPair, bodies_of, pair_class, pair_of
from fem_lie.contact.sides.surfaces import ContactSurface
from fem_lie.contact.sides.table import Nodes
from fem_lie.contact.stiffness import chosen_stiffness

_log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class Contact:
    """Contact of two surfaces, or of a surface with itself.

    Attributes:
        a: First surface.
        b: Second surface. If it is the same object as ``a``, the surface touches itself.
        law: Contact law: :class:`~fem_lie.contact.Penalty` or :class:`~fem_lie.contact.Impact`.
        name: Name for messages and results.
        ignore_initial: Whether pairs of points that overlap at the start are ignored until they
            have separated. For points, balls, corners and planes.

    Example:
        >>> ball = fl.RigidBody(1.0, (0.1, 0.1, 0.1), position=(0, 0, 1))
        >>> scene = fl.Scene(gravity=(0, 0, -9.81))
        >>> _ = scene.add(ball)
        >>> floor = fl.contact.Plane(fl.ground(), (0, 0, 1))
        >>> sphere = fl.contact.Sphere(ball.point("centre"), 0.2)
        >>> _ = scene.add(fl.contact.Contact(sphere, floor, fl.contact.Impact(restitution=0.5)))
        >>> len(scene.contacts)
        1
    """

    a: ContactSurface
    b: ContactSurface
    law: ContactLaw
    name: str = ""
    ignore_initial: bool = False

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if an argument has the wrong type."""
        for side, given in (("a", self.a), ("b", self.b)):
            instance(given, ContactSurface, f"Contact: {side}", "a surface such as Plane or Sphere")
        instance(self.law, ContactLaw, "Contact: law", "a law such as Penalty(1e6) or Impact()")
        text(self.name, "Contact: name")
        flag(self.ignore_initial, "Contact: ignore_initial")
        object.__setattr__(self, "law", self.law.with_stiffness(self._chosen_stiffness))

    def _chosen_stiffness(self) -> float:
        """Stiffness of a penalty for these bodies and kinds of surfaces."""
        power = pair_class(self.a, self.b, self.law, self.label)[0].power
        k = chosen_stiffness(self.bodies, power, self.label)
        _log.info("%s: stiffness %g was chosen", self.label, k)
        return k

    @property
    def label(self) -> str:
        """The name, or a description of both surfaces."""
        return self.name or f"Contact({self.a.label}; {self.b.label})"

    @property
    def bodies(self) -> list[Body]:
        """Bodies on which contact forces act."""
        return bodies_of(self.a, self.b)

    @cached_property
    def pair(self) -> ContactPair:
        """The contact pair: the class that knows how these two kinds of surfaces touch.

        Raises:
            ValueError: Such surfaces cannot touch; the message says why.
        """
        return pair_of(self.a, self.b, self.law, self.label, self.ignore_initial)

    @property
    def has_friction(self) -> bool:
        """Whether contact forces depend on the path, by friction of a penalty."""
        return self.pair.has_friction

    @property
    def held_rotations(self) -> Iterator[tuple[Body, HeldRotation]]:
        """Nodes that need all rotations, because contact forces have moments about them."""
        return self.pair.held_rotations(self)

    def check(self) -> None:
        """Raise an error for surfaces that cannot touch or that overlap at the start.

        Raises:
            ValueError: No points of the two surfaces can touch, or all that could touch are fixed
                to the same frame, or the surfaces overlap by more than a twentieth of their size.
        """
        self.a.check()
        self.b.check()
        if self.ignore_initial and not self.pair.ignores_initial:
            raise ValueError(f"{self.label}: ignore_initial is for points, balls, boxes and planes")
        if self.law.impulsive:
            _ = self.pair.impact
        self.pair.check()

    def contents(self, nodes: Nodes) -> tuple[object, ...]:
        """All that contact forces depend on, for the fingerprint of the scene.

        Args:
            nodes: Gives the numbers of the nodes of a body in the scene.
        """
        return self.pair.contents(nodes)

    def key(self, nodes: Nodes) -> int:
        """Checksum of :meth:`contents`, which distinguishes the contacts of a scene.

        Args:
            nodes: Numbers of the first node of each body.
        """
        found = 0
        for part in self.contents(nodes):
            data = part.tobytes() if isinstance(part, np.ndarray) else repr(part).encode()
            found = crc32(data, found)
        return found

    def term(self, nodes: Nodes) -> ContactTerm:
        """Contact forces of a penalty, as a term of the equations.

        Args:
            nodes: Gives the numbers of the nodes of a body in the scene.

        Raises:
            ValueError: The contact law is :class:`~fem_lie.contact.Impact`, which has impulses
                instead.
        """
        term = self.pair.term(nodes)
        term.key = self.key(nodes)
        return term
