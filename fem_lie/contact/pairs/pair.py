"""Contact pairs: what two surfaces of given kinds do together, and which pair is which.

Each pair of kinds is one class, which owns its checks, its initial overlap, its contents for
fingerprints and its forces. Pairs are registered by the classes of both surfaces, in one order;
the class of a surface or the closest of its bases counts, and so do pairs registered elsewhere.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar, TypeAlias

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.bodies.body import Body
from fem_lie.bodies.nodes import HeldRotation
from fem_lie.contact.convex.table import PolyhedronPair
from fem_lie.contact.friction.forces import Friction
from fem_lie.contact.laws.law import ContactTerm, Impact, Penalty
from fem_lie.contact.laws.node_axes import NodeAxes
from fem_lie.contact.laws.penalty import PenaltyForces
from fem_lie.contact.sides.meeting import Sides
from fem_lie.contact.sides.surfaces import Surface
from fem_lie.contact.sides.table import BothSides, Nodes

Law: TypeAlias = Penalty | Impact

OVERLAP = 0.05
"""Fraction of a size by which surfaces may overlap at the start."""


def bodies_of(*surfaces: Surface) -> list[Body]:
    """Bodies that surfaces are fixed to, each once."""
    points = (point for surface in surfaces for point in surface.points)
    return list(dict.fromkeys(point.body for point in points if point.body is not None))


class ImpactPair(ABC):
    """What impacts see of a contact pair."""

    @property
    def manifolds(self) -> Sequence[PolyhedronPair]:
        """Polyhedra, and what touches them by a contact manifold; default: none."""
        return ()

    @abstractmethod
    def sides(self, nodes: Nodes) -> BothSides:
        """Both sides as tables, planes and hollows on the second one; of manifolds their points.

        Args:
            nodes: Numbers of a body's nodes.
        """


@dataclass(frozen=True, eq=False)
class ContactPair(ABC):
    """Two contact surfaces of the kinds that a class of pairs is registered for.

    Attributes:
        a: Surface of the first kind.
        b: Surface of the second kind; the same one: it touches itself.
        law: Contact law.
        label: For messages.
        ignore_initial: Whether pairs of points that overlap at the start are ignored until they
            part.
        what: What touches, for messages.
        power: Forces are per length to this power: 0 of points, 1 along lines, 2 over areas.
        ignores_initial: Whether ``ignore_initial`` may be given.
    """

    a: Surface
    b: Surface
    law: Law
    label: str
    ignore_initial: bool = False

    what: ClassVar[str] = "surfaces"
    power: ClassVar[int] = 0
    ignores_initial: ClassVar[bool] = False

    @abstractmethod
    def check(self) -> None:
        """Refuse surfaces that cannot touch, or overlap at the start.

        Raises:
            ValueError: They do, or a law or a node is not for this pair.
        """

    @abstractmethod
    def contents(self, nodes: Nodes) -> tuple[object, ...]:
        """All that the forces depend on.

        Args:
            nodes: Numbers of a body's nodes.
        """

    @abstractmethod
    def term(self, nodes: Nodes) -> ContactTerm:
        """Forces by penalty.

        Args:
            nodes: Numbers of a body's nodes.
        """

    @property
    def impact(self) -> ImpactPair:
        """The pair as impacts see it.

        Raises:
            ValueError: It touches by penalty alone; default.
        """
        raise ValueError(f"{self.label}: {self.what} touch by Penalty, not by Impact")

    # --- for pairs ---

    @property
    def penalty(self) -> Penalty:
        """The law, of forces.

        Raises:
            ValueError: It has none, but impulses.
        """
        if isinstance(self.law, Penalty):
            return self.law
        raise ValueError(
            f"{self.label}: Impact is for GeneralisedAlpha and Variational with constant steps; "
            "give Penalty elsewhere"
        )

    @property
    def has_friction(self) -> bool:
        """Whether forces depend on the path of the surfaces."""
        return isinstance(self.law, Penalty) and self.law.friction > 0.0

    @property
    def bodies(self) -> list[Body]:
        """Bodies that forces act on."""
        return bodies_of(self.a, self.b)

    @property
    def rotated(self) -> list[Body]:
        """Bodies on whose nodes forces have moments."""
        found = [body for each in (self.a, self.b) for body in each.rotating(self.has_friction)]
        owners = [owner for each in (self.a, self.b) for owner in each.moments(self.has_friction)]
        found += [body for body, _ in owners if body is not None]
        return list(dict.fromkeys(found))

    def check_friction(self) -> None:
        """Refuse friction on nodes that do not rotate, whose anchors would have a moment arm.

        Raises:
            ValueError: There is one.
        """
        for body in self.bodies if self.has_friction else ():
            body.require_frames(f"{self.label}: friction")

    def initial_frames(self, nodes: Nodes) -> Array:
        """Frames of the bodies' nodes at the start, in the order of their numbers."""
        numbers = [nodes(body) for body in self.bodies]
        H = np.zeros((1 + max(int(each.max()) for each in numbers), 4, 3))
        for body, each in zip(self.bodies, numbers, strict=True):
            H[each] = body.frames
        return H

    def node_types(self, nodes: Nodes) -> Indices:
        """Types of the bodies' nodes, in the order of their numbers; of others frames."""
        numbers = [nodes(body) for body in self.bodies]
        found = np.zeros(1 + max(int(each.max()) for each in numbers), dtype=np.int64)
        for body, each in zip(self.bodies, numbers, strict=True):
            found[each] = body.node_types
        return found

    def numbered(self) -> tuple[Nodes, Array]:
        """Numbers and initial frames of the nodes of these bodies alone."""
        first = np.cumsum([0, *(len(body.frames) for body in self.bodies)])
        numbers = {
            body: np.arange(len(body.frames)) + k
            for body, k in zip(self.bodies, first, strict=False)
        }
        return numbers.__getitem__, np.concatenate([body.frames for body in self.bodies])

    def refuse_overlap(self, g: Array, positions: Array, sizes: Array) -> None:
        """Refuse gaps that are negative by more than :data:`OVERLAP` of sizes.

        Args:
            g: Gaps, shape (m,).
            positions: Where they are, shape (m, 3).
            sizes: Shape (m,).

        Raises:
            ValueError: There are some; it names the largest overlap.
        """
        if self.ignore_initial:
            return
        instead = ", or give ignore_initial=True" if self.ignores_initial else ""
        too_deep = np.flatnonzero(g < -OVERLAP * sizes)
        for e in too_deep[np.argsort(g[too_deep], kind="stable")][:1]:
            at = ", ".join(f"{x:g}" for x in positions[e])
            raise ValueError(
                f"{self.label}: they overlap by {-g[e]:.3g} at ({at}); start apart{instead}"
            )

    def held_rotations(self, by: object) -> Iterator[tuple[Body, HeldRotation]]:
        """Nodes that forces rotate about all axes, or about which they have moments.

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
            if not any(body.uncoupled for body in bodies_of(surface)):
                continue
            for owner, node in surface.moments(self.law.friction > 0.0):
                if owner is not None and owner.uncoupled:
                    yield owner, HeldRotation(node, (by, node), what, needed=False)


_Kinds: TypeAlias = tuple[type[Surface], type[Surface]]

_PAIRS: dict[_Kinds, type[ContactPair] | str] = {}
"""Classes of pairs by both kinds of surfaces, or the reason why there is none."""


def register_contact_pair(
    a: type[Surface], b: type[Surface], pair: type[ContactPair] | str
) -> None:
    """Register the class of contact pairs of two kinds of surfaces, in whatever order these come.

    Args:
        a: Kind of the first surface of the pair.
        b: Kind of the second surface.
        pair: Class of the pairs, or the reason why such surfaces do not touch.

    Raises:
        ValueError: There is one for these kinds.
    """
    if (a, b) in _PAIRS or (b, a) in _PAIRS:
        raise ValueError(f"a contact pair of {a.__name__} and {b.__name__} is registered already")
    _PAIRS[a, b] = pair


def pair_class(a: Surface, b: Surface, label: str) -> tuple[type[ContactPair], bool]:
    """Class of the contact pair of two surfaces, and whether their order is reversed in it.

    Args:
        a: First surface.
        b: Second surface.
        label: For messages.

    Raises:
        ValueError: There is none; it says why.
    """
    for one in a.kind.__mro__:
        for other in b.kind.__mro__:
            for kinds, reversed_ in (((one, other), False), ((other, one), True)):
                found = _PAIRS.get(kinds)
                if isinstance(found, str):
                    raise ValueError(f"{label}: {found}")
                if found is not None:
                    return found, reversed_ and one is not other
    raise ValueError(
        f"{label}: there is no contact pair of {a.kind.__name__} and {b.kind.__name__}; "
        "register_contact_pair adds one"
    )


def pair_of(a: Surface, b: Surface, law: Law, label: str, ignore_initial: bool) -> ContactPair:
    """The contact pair of two surfaces; arguments and errors as of :func:`pair_class`."""
    made, is_reversed = pair_class(a, b, label)
    first, second = (b, a) if is_reversed else (a, b)
    return made(first, second, law, label, ignore_initial)


class PenaltyPair(ContactPair):
    """Two surfaces that are said by where their points meet."""

    @abstractmethod
    def meeting(self, nodes: Nodes) -> Sides:
        """Where points of both surfaces meet, for compiled code.

        Args:
            nodes: Numbers of a body's nodes.
        """

    def check(self) -> None:
        """See the base class."""
        self.check_friction()
        nodes, H = self.numbered()
        sides = self.meeting(nodes)
        _, g, positions, _ = PenaltyForces(sides, Penalty(1.0)).touching(H, np.zeros((len(H), 6)))
        self.refuse_overlap(g, positions, np.full(len(g), sides.radius))

    def term(self, nodes: Nodes) -> PenaltyForces:
        """See the base class."""
        sides, friction, law = self.meeting(nodes), None, self.penalty
        if self.ignore_initial:
            sides.near.ignore(self.initial_frames(nodes))
        if law.friction > 0.0:
            friction = Friction(sides, law.coulomb, self.initial_frames(nodes))
        axes, parts = NodeAxes(self.node_types(nodes)), self.ignore_initial
        return PenaltyForces(sides, law, self.label, friction, axes=axes, parts=parts)
