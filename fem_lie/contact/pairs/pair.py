"""Contact pairs: what two surfaces of given kinds do together, and the registry of pairs.

Each combination of two kinds of surfaces is one class. It has the checks, the initial overlap, the
contents for fingerprints and the contact forces. Pairs are registered by the classes of both
surfaces, in one order. A subclass of a surface uses the pair of its closest base class that is
registered. Other packages may register pairs, too.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar, TypeAlias

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.bodies.body import Body
from fem_lie.bodies.model import HeldRotation
from fem_lie.contact.convex.table import PolyhedronPair
from fem_lie.contact.laws.friction import Friction
from fem_lie.contact.laws.law import ContactLaw, ContactTerm, Impact, Penalty
from fem_lie.contact.laws.penalty import PenaltyForces
from fem_lie.contact.sides.surfaces import ContactSurface
from fem_lie.contact.sides.table import BothSides, Nodes
from fem_lie.contact.sides.two_sides import Sides
from fem_lie.lie.node_types import NodeType

OVERLAP = 0.05
"""Overlap over the characteristic size up to which surfaces may overlap at the start."""


def bodies_of(*surfaces: ContactSurface) -> list[Body]:
    """Bodies that surfaces are fixed to, without duplicates."""
    points = (point for surface in surfaces for point in surface.points)
    return list(dict.fromkeys(point.body for point in points if point.body is not None))


class ImpactPair(ABC):
    """A contact pair as the solver of impacts uses it."""

    @property
    def manifolds(self) -> Sequence[PolyhedronPair]:
        """Polyhedra and the bodies that touch them, which have contact manifolds; default: none."""
        return ()

    @abstractmethod
    def sides(self, nodes: Nodes) -> BothSides:
        """Both sides as packed arrays, with planes and hollow spheres as the second side.

        Args:
            nodes: Gives the numbers of the nodes of a body in the scene.
        """


@dataclass(frozen=True, eq=False)
class ContactPair(ABC):
    """Two contact surfaces of the kinds that a class of pairs is registered for.

    Attributes:
        a: Surface of the first kind.
        b: Surface of the second kind; the same object as ``a`` if a surface touches itself.
        law: Contact law.
        label: Label of the contact for messages.
        ignore_initial: Whether pairs of points that overlap at the start are ignored until they
            separate.
        power: Contact forces are per length to this power: 0 of points, 1 along lines, 2 over
            areas.
        ignores_initial: Whether ``ignore_initial`` is supported.
    """

    a: ContactSurface
    b: ContactSurface
    law: ContactLaw
    label: str
    ignore_initial: bool = False

    power: ClassVar[int] = 0
    ignores_initial: ClassVar[bool] = False

    @abstractmethod
    def check(self) -> None:
        """Raise an error for surfaces that cannot touch or that overlap at the start.

        Raises:
            ValueError: The surfaces overlap, or the contact law or a node type is not supported.
        """

    @abstractmethod
    def contents(self, nodes: Nodes) -> tuple[object, ...]:
        """All that the contact forces depend on, for the fingerprint of the scene.

        Args:
            nodes: Gives the numbers of the nodes of a body in the scene.
        """

    @abstractmethod
    def term(self, nodes: Nodes) -> ContactTerm:
        """Contact forces of a penalty, as a term of the equations.

        Args:
            nodes: Gives the numbers of the nodes of a body in the scene.
        """

    @property
    def impact(self) -> ImpactPair:
        """The pair as the solver of impacts uses it.

        Raises:
            ValueError: The pair supports :class:`~fem_lie.contact.Penalty` only; this is the
                default.
        """
        kinds = " and ".join(type(side).__name__ for side in (self.a, self.b))
        raise ValueError(
            f"{self.label}: {kinds} touch by Penalty, not by Impact, which acts at points: "
            "Vertices(body.points(...)) with planes, balls, boxes and polyhedra"
        )

    # --- for derived classes ---

    @property
    def penalty(self) -> Penalty:
        """The contact law, if it is a penalty.

        Raises:
            ValueError: The contact law is :class:`~fem_lie.contact.Impact`.
        """
        return self.law.penalty(self.label)

    @property
    def has_friction(self) -> bool:
        """Whether contact forces depend on the path, by friction of a penalty."""
        return self.law.path_dependent

    @property
    def bodies(self) -> list[Body]:
        """Bodies on which contact forces act."""
        return bodies_of(self.a, self.b)

    def check_friction(self) -> None:
        """Refuse friction of two surfaces that both take no moment.

        Raises:
            ValueError: The nodes of both have no rotations.
        """
        each = [bodies_of(side) for side in (self.a, self.b)]
        takes_none = (any(b.model.node_type != NodeType.FRAME for b in side) for side in each)
        if self.has_friction and all(takes_none):
            raise ValueError(
                f"{self.label}: friction acts on surfaces, at a distance from both axes, and has a "
                "moment that nodes without rotations do not take; one of the two surfaces must be "
                "on ground or on a body whose nodes have frames, such as a beam"
            )

    def initial_frames(self, nodes: Nodes) -> Array:
        """Initial frames of the nodes of the bodies, in the order of their numbers.

        Args:
            nodes: Numbers of the first node of each body.
        """
        numbers = [nodes(body) for body in self.bodies]
        H = np.zeros((1 + max(int(each.max()) for each in numbers), 4, 3))
        for body, each in zip(self.bodies, numbers, strict=True):
            H[each] = body.frames
        return H

    def node_types(self, nodes: Nodes) -> Indices:
        """Types of the nodes of the bodies, in the order of their numbers.

        Args:
            nodes: Numbers of the first node of each body.
        """
        numbers = [nodes(body) for body in self.bodies]
        found = np.zeros(1 + max(int(each.max()) for each in numbers), dtype=np.int64)
        for body, each in zip(self.bodies, numbers, strict=True):
            found[each] = body.model.node_types
        return found

    def numbered(self) -> tuple[Nodes, Array]:
        """Numbers and initial frames of the nodes of these bodies only."""
        first = np.cumsum([0, *(len(body.frames) for body in self.bodies)])
        numbers = {
            body: np.arange(len(body.frames)) + k
            for body, k in zip(self.bodies, first, strict=False)
        }
        return numbers.__getitem__, np.concatenate([body.frames for body in self.bodies])

    def refuse_overlap(self, g: Array, positions: Array, sizes: Array) -> None:
        """Raise an error for gaps below minus :data:`OVERLAP` times the size.

        Args:
            g: Gaps, shape (m,).
            positions: Positions of the contact points, shape (m, 3).
            sizes: Characteristic sizes, such as radii, shape (m,).

        Raises:
            ValueError: There are such gaps; the message has the largest overlap.
        """
        if self.ignore_initial:
            return
        instead = ", or give ignore_initial=True" if self.ignores_initial else ""
        too_deep = np.flatnonzero(g < -OVERLAP * sizes)
        for e in too_deep[np.argsort(g[too_deep], kind="stable")][:1]:
            at = ", ".join(f"{x:g}" for x in positions[e])
            raise ValueError(
                f"{self.label}: they overlap by {-g[e]:.3g} at ({at}); start with a gap{instead}"
            )

    def held_rotations(self, by: object) -> Iterator[tuple[Body, HeldRotation]]:
        """Nodes that need all rotations, because contact forces have moments about them.

        Args:
            by: The contact.
        """
        what = f"the surface of {self.label}"
        surfaces = list(dict.fromkeys((self.a, self.b)))
        rotating = [body for each in surfaces for body in each.rotating(self.has_friction)]
        for body in dict.fromkeys(rotating):
            for node in range(len(body.frames)):
                yield body, HeldRotation(node, by, what)
        for surface in surfaces:
            if not any(body.model.separates_director for body in bodies_of(surface)):
                continue
            for owner, node in surface.moments(self.law.friction > 0.0):
                if owner is not None and owner.model.separates_director:
                    yield owner, HeldRotation(node, (by, node), what, needed=False)


_Kinds: TypeAlias = tuple[type[ContactSurface], type[ContactSurface]]


_PAIRS: dict[tuple[_Kinds, type[ContactLaw]], type[ContactPair] | str] = {}
"""Classes of pairs by both kinds of surfaces and contact law, or the reason why there is none."""


def register_contact_pair(
    a: type[ContactSurface],
    b: type[ContactSurface],
    pair: type[ContactPair] | str,
    law: type[ContactLaw] | None = None,
) -> None:
    """Register the class of contact pairs of two kinds of surfaces, in either order.

    Args:
        a: Kind of the first surface of the pair.
        b: Kind of the second surface of the pair.
        pair: Class of the pairs, or the reason why such surfaces cannot touch.
        law: Contact law that it is for; default: both.

    Raises:
        ValueError: A pair of these kinds is already registered.
    """
    for each in (Penalty, Impact) if law is None else (law,):
        if ((a, b), each) in _PAIRS or ((b, a), each) in _PAIRS:
            raise ValueError(
                f"a contact pair of {a.__name__} and {b.__name__} is registered already"
            )
        _PAIRS[(a, b), each] = pair


def pair_class(
    a: ContactSurface, b: ContactSurface, law: ContactLaw, label: str
) -> tuple[type[ContactPair], bool]:
    """Class of the contact pair of two surfaces, and whether the pair has them in reverse order.

    Args:
        a: First surface.
        b: Second surface.
        law: Contact law.
        label: Label of the contact for messages.

    Raises:
        ValueError: There is no such pair; the message says why.
    """
    for one in a.kind.__mro__:
        for other in b.kind.__mro__:
            for kinds, reversed_ in (((one, other), False), ((other, one), True)):
                found = _PAIRS.get((kinds, type(law)))
                if isinstance(found, str):
                    raise ValueError(f"{label}: {found}")
                if found is not None:
                    return found, reversed_ and one is not other
    raise ValueError(
        f"{label}: there is no contact pair of {a.kind.__name__} and {b.kind.__name__}; "
        "register_contact_pair adds one"
    )


def pair_of(
    a: ContactSurface, b: ContactSurface, law: ContactLaw, label: str, ignore_initial: bool
) -> ContactPair:
    """Contact pair of two surfaces; arguments and errors as in :func:`pair_class`."""
    made, is_reversed = pair_class(a, b, law, label)
    first, second = (b, a) if is_reversed else (a, b)
    return made(first, second, law, label, ignore_initial)


class PenaltyPair(ContactPair):
    """A contact pair that is defined by its contact points; the penalty provides the forces."""

    @abstractmethod
    def meeting(self, nodes: Nodes) -> Sides:
        """Both sides, for the evaluation of contact points in compiled code.

        Args:
            nodes: Gives the numbers of the nodes of a body in the scene.
        """

    def check(self) -> None:
        """Raise ``ValueError`` if the surfaces overlap at the start."""
        self.check_friction()
        nodes, H = self.numbered()
        sides = self.meeting(nodes)
        forces = PenaltyForces(sides, Penalty(1.0), self.node_types(nodes))
        _, g, positions, _ = forces.touching(H, np.zeros((len(H), 6)))
        self.refuse_overlap(g, positions, np.full(len(g), sides.radius))

    def term(self, nodes: Nodes) -> PenaltyForces:
        """Contact forces of the penalty."""
        sides, friction, law = self.meeting(nodes), None, self.penalty
        types = self.node_types(nodes)
        if self.ignore_initial:
            sides.near.ignore(self.initial_frames(nodes))
        if law.friction > 0.0:
            friction = Friction(sides, law.coulomb, types, self.initial_frames(nodes))
        return PenaltyForces(sides, law, types, self.label, friction, parts=self.ignore_initial)
