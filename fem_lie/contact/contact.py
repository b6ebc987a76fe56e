"""A pair of surfaces that may touch, and the law of what happens then."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple, TypeAlias
from zlib import crc32

import numpy as np

from fem_lie._arrays import Array, flag, instance, text
from fem_lie.bodies.body import Body
from fem_lie.bodies.held import HeldRotation
from fem_lie.contact.chosen import chosen_stiffness
from fem_lie.contact.convex.overlaps import overlap_of
from fem_lie.contact.convex.table import PolyhedronPair, slots_of
from fem_lie.contact.laws import Impact, Penalty
from fem_lie.contact.penalty import PenaltyForces
from fem_lie.contact.rings.forces import RingForces
from fem_lie.contact.rings.kernels import Law as RingLaw
from fem_lie.contact.rings.surfaces import Rings, Rope
from fem_lie.contact.rubbing import Friction
from fem_lie.contact.sides.kinematics import gaps
from fem_lie.contact.sides.meeting import Balls, Lines
from fem_lie.contact.sides.meeting import Sides as MeetingSides
from fem_lie.contact.sides.pairs import NearPairs
from fem_lie.contact.sides.surfaces import Ball, Surface
from fem_lie.contact.sides.table import (
    Nodes,
    Side,
    balls_side,
    joined_sides,
    number_of,
    planes_side,
)
from fem_lie.contact.skins import Skin, meeting_of, numbers_of

Law: TypeAlias = Penalty | Impact

_log = logging.getLogger(__name__)

OVERLAP = 0.05
"""Part of a size by which surfaces may overlap in the beginning."""


class Sides(NamedTuple):
    """The two sides of a contact.

    Attributes:
        a: Places with a radius.
        b: Planes, or places with a radius.
        flat: Whether it is planes.
        same: Whether it is the first side again.
    """

    a: Side
    b: Side
    flat: bool
    same: bool


@dataclass(frozen=True, eq=False)
class Contact:
    """Two surfaces that push each other off, or one whose points do.

    Attributes:
        a: One of them.
        b: The other; the same one: its balls touch each other.
        law: Of the forces.
        name: For messages and results.
        ignore_initial: Whether pairs of places that overlap in the beginning are left out until
            they have parted; of points, balls, corners and planes.

    Example:
        >>> ball = fl.RigidBody(1.0, (0.1, 0.1, 0.1), position=(0, 0, 1))
        >>> scene = fl.Scene(gravity=(0, 0, -9.81))
        >>> _ = scene.add(ball)
        >>> floor, skin = fl.Plane(fl.ground(), (0, 0, 1)), fl.Sphere(ball.centre, 0.2)
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
        """Raise ``TypeError`` if an argument is of another kind than wanted."""
        for side, given in (("a", self.a), ("b", self.b)):
            instance(given, Surface, f"Contact: {side}", "a surface such as Plane or Sphere")
        instance(self.law, Law, "Contact: law", "a law such as Penalty(1e6) or Impact()")
        text(self.name, "Contact: name")
        flag(self.ignore_initial, "Contact: ignore_initial")
        if isinstance(self.law, Penalty) and self.law.stiffness is None:
            k = chosen_stiffness(self.a, self.b, self.label)
            object.__setattr__(self, "law", replace(self.law, stiffness=k))
            _log.info("%s: stiffness %g was chosen", self.label, k)

    @property
    def label(self) -> str:
        """The name, or what touches."""
        return self.name or f"Contact({self.a.label}; {self.b.label})"

    @property
    def bodies(self) -> list[Body]:
        """Those it acts on."""
        points = [*self.a.points, *self.b.points]
        return list(dict.fromkeys(p.body for p in points if p.body is not None))

    def check(self) -> None:
        """Refuse surfaces that cannot touch, or overlap already.

        Raises:
            ValueError: Nothing of them can touch each other, or all that can never moves against
                each other, or they overlap by more than a twentieth of their size.
        """
        self.a.check()
        self.b.check()
        if self.ignore_initial and not self._of_balls:
            raise ValueError(f"{self.label}: ignore_initial is for points, balls, boxes and planes")
        if isinstance(self.a, Rope | Rings) or isinstance(self.b, Rope | Rings):
            self._check_rings()
            return
        self._check_places()
        if self._lines or self._skins:
            self._check_skins() if self._skins else self._check_lines()
            self._check_meeting()
            return
        if self.polyhedron_pairs:
            self._check_polyhedra()
            return
        self._check_sorts()
        self._check_overlap()

    def _check_polyhedra(self) -> None:
        if not isinstance(self.law, Impact):
            raise ValueError(
                f"{self.label}: polyhedra touch each other and balls by Impact; the force of a "
                "Penalty would jump where a corner gets over an edge"
            )
        if self.ignore_initial:
            raise ValueError(f"{self.label}: ignore_initial is for points, balls and planes")
        for pair in self.polyhedron_pairs:
            owners = pair.first.owners if isinstance(pair.first, Ball) else (pair.first.owner,)
            if any(body is pair.second.owner[0] for body, _ in owners):
                raise ValueError(f"{self.label}: they never move against each other")
        numbers, H = self._numbered()
        overlap, size = overlap_of(self.polyhedron_pairs, numbers, H)
        if overlap > OVERLAP * size:
            raise ValueError(f"{self.label}: they overlap by {overlap:.3g}; start apart")

    def _check_rings(self) -> None:
        rope, rings, law = self.a, self.b, self.law
        if not (isinstance(rope, Rope) and isinstance(rings, Rings)):
            raise ValueError(
                f"{self.label}: Contact(Rope(...), Rings(...)) is what there is of both"
            )
        if not isinstance(law, Penalty) or law.damping > 0.0:
            raise ValueError(f"{self.label}: ropes run through rings by Penalty without damping")
        own = {(rope.body, int(node)) for node in rope.path}
        if any((point.body, point.node) in own for point in rings.of):
            raise ValueError(f"{self.label}: a ring is fixed to a node of its rope")
        term = self.term(self._numbered()[0])
        apart = -term.touching(self._numbered()[1], np.empty((0, 6)))[1]
        if apart.max() > OVERLAP * rope.lengths.mean():
            k = int(apart.argmax())
            raise ValueError(
                f"{self.label}: ring {k} is {apart[k]:.3g} off the rope, whose nodes are "
                f"{rope.lengths.mean():.3g} apart; let it start on the rope"
            )

    def _check_places(self) -> None:
        """Refuse friction on nodes that do not turn, whose anchors would have a lever there."""
        for point in [*self.a.points, *self.b.points] if self.rubs else ():
            if point.body is not None:
                point.body.require_frames(f"{self.label}: friction")

    def _check_lines(self) -> None:
        if isinstance(self.law, Impact):
            raise ValueError(f"{self.label}: lines touch by Penalty, not by Impact")
        if self.a.balls() or self.b.balls():
            raise ValueError(f"{self.label}: lines touch lines, bars and planes, not balls")
        if self.a is self.b:
            raise ValueError(f"{self.label}: a line does not touch itself; give two lines")

    def _check_skins(self) -> None:
        if isinstance(self.law, Impact):
            raise ValueError(f"{self.label}: skins of shells touch by Penalty, not by Impact")
        if self._lines:
            raise ValueError(f"{self.label}: skins touch skins, balls and planes, not lines")
        if self.a is not self.b and len({each.shell for each in self._skins}) < len(self._skins):
            raise ValueError(f"{self.label}: a shell touches itself by one skin, given twice")
        for each in (self.a, self.b):
            if not each.whole and each.balls():
                raise ValueError(f"{self.label}: the corners of a box do not touch skins")
            if any(ball.radius < 0.0 for ball in each.balls()):
                raise ValueError(f"{self.label}: skins do not touch what is around a hollow")

    def _check_meeting(self) -> None:
        """Refuse what overlaps, of lines and skins."""
        numbers, H = self._numbered()
        sides = self._meeting(numbers)
        g = PenaltyForces(sides, Penalty(1.0)).touching(H, np.zeros((len(H), 6)))
        self._refuse(g[1], g[2], np.full(len(g[1]), sides.radius))

    def _check_sorts(self) -> None:
        a, b = self.a.balls(), self.b.balls()
        if not a and not b:
            raise ValueError(
                f"{self.label}: planes touch points, not each other; give the corners of one of "
                "them as Box or Vertices"
            )
        if not (a and b):
            return
        if not (self.a.whole and self.b.whole):
            raise ValueError(
                f"{self.label}: points do not touch polyhedra, and neither does what is around a "
                "hollow; give balls, boxes or planes"
            )
        radii = [min(ball.radius for ball in side) for side in (a, b)]
        if min(radii) < 0.0 and (max(radii) < 0.0 or min(radii) + _largest(a, b) >= 0.0):
            raise ValueError(f"{self.label}: what is in a hollow must be smaller, and no hollow")
        if radii[0] == radii[1] == 0.0:
            raise ValueError(f"{self.label}: points never touch points; give one of them a radius")

    def sides(self, nodes: Nodes) -> Sides:
        """Both sides as tables; planes and hollows come second.

        Args:
            nodes: Numbers of a body's nodes.
        """
        if self.polyhedron_pairs:
            slots = [slots_of(pair, nodes) for pair in self.polyhedron_pairs]
            first, second = zip(*slots, strict=True)
            return Sides(joined_sides(first), joined_sides(second), False, False)
        a, b = self.a.balls(), self.b.balls()
        if not a:
            return Sides(balls_side(b, nodes), planes_side(self.a.faces(), nodes), True, False)
        if not b:
            return Sides(balls_side(a, nodes), planes_side(self.b.faces(), nodes), True, False)
        if min(ball.radius for ball in a) < 0.0:
            a, b = b, a
        return Sides(balls_side(a, nodes), balls_side(b, nodes), False, self.a is self.b)

    def contents(self, nodes: Nodes) -> tuple[object, ...]:
        """All that its forces are made of."""
        if self._skins:
            both = [*numbers_of(self.a, nodes), *numbers_of(self.b, nodes)]
            return *both, self.a is self.b, repr(self.law)
        if isinstance(self.a, Rope) and isinstance(self.b, Rings):
            found = self._rings(self.a, self.b, nodes).contents
            return *found, repr(self.law)
        if self._lines:
            first, second = (_numbers_of(each, nodes) for each in (self.a, self.b))
            return *first, *second, repr(self.law)
        a, b, flat, same = self.sides(nodes)
        corners = [
            each.corners for each in (self.a.polyhedron(), self.b.polyhedron()) if each is not None
        ]
        ignores = ("ignore_initial",) if self.ignore_initial else ()
        return *a, *b, flat, same, repr(self.law), *ignores, *corners

    def key(self, nodes: Nodes) -> int:
        """A number that tells it from others of its scene, of :meth:`contents`."""
        found = 0
        for part in self.contents(nodes):
            data = part.tobytes() if isinstance(part, np.ndarray) else repr(part).encode()
            found = crc32(data, found)
        return found

    def _rings(self, rope: Rope, rings: Rings, nodes: Nodes) -> RingForces:
        assert isinstance(self.law, Penalty)
        numbers = self.law.k, self.law.friction, self.law.holds
        return RingForces(rope, rings, RingLaw(*(float(n) for n in numbers)), nodes)

    def term(self, nodes: Nodes) -> PenaltyForces | RingForces:
        """Its forces.

        Args:
            nodes: Numbers of a body's nodes.

        Raises:
            ValueError: Its law has none, but impulses.
        """
        if not isinstance(self.law, Penalty):
            raise ValueError(
                f"{self.label}: Impact is for GeneralisedAlpha and Variational with constant "
                "steps; give Penalty elsewhere"
            )
        if isinstance(self.a, Rope) and isinstance(self.b, Rings):
            return self._rings(self.a, self.b, nodes)
        sides, friction = self._meeting(nodes), None
        if self.ignore_initial:
            sides.near.ignore(self._frames(nodes))
        if self.law.friction > 0.0:
            friction = Friction(sides, self.law, self._frames(nodes))
        return PenaltyForces(sides, self.law, self.label, friction, parts=self.ignore_initial)

    @property
    def rubs(self) -> bool:
        """Whether forces depend on how surfaces came to where they are."""
        return isinstance(self.law, Penalty) and self.law.friction > 0.0

    @cached_property
    def polyhedron_pairs(self) -> list[PolyhedronPair]:
        """Polyhedra that touch each other, or balls; none: it is of other surfaces."""
        a, b = self.a.polyhedron(), self.b.polyhedron()
        if a is not None and b is not None:
            return [PolyhedronPair(a, b)]
        polyhedron, other = (b, self.a) if a is None else (a, self.b)
        balls = other.balls() if other.whole else []
        if polyhedron is None or any(ball.radius <= 0.0 for ball in balls):
            return []
        return [PolyhedronPair(ball, polyhedron) for ball in balls]

    @property
    def _lines(self) -> bool:
        return bool(self.a.pieces() or self.b.pieces())

    @property
    def _of_balls(self) -> bool:
        rings = isinstance(self.a, Rope | Rings) or isinstance(self.b, Rope | Rings)
        return not (rings or self._lines or self._skins)

    @property
    def _skins(self) -> list[Skin]:
        return [each for each in (self.a, self.b) if isinstance(each, Skin)]

    @property
    def holds(self) -> list[tuple[Body, HeldRotation]]:
        """Nodes of shells that its forces rotate about all axes."""
        what = f"the surface of {self.label}"
        # tractions act on faces, with levers that are not along directors
        turned = (each for each in self._skins if each.smooth or self.rubs)
        shells = dict.fromkeys(each.shell for each in turned)
        found: list[tuple[Body, HeldRotation]] = [
            (shell, HeldRotation(node, self, what))
            for shell in shells
            for node in range(len(shell.frames))
        ]
        for surface in dict.fromkeys((self.a, self.b)):
            if any(point.body is not None and point.body.uncoupled for point in surface.points):
                found += self._pushed(surface, what)
        return found

    def _pushed(self, surface: Surface, what: str) -> Iterator[tuple[Body, HeldRotation]]:
        """Nodes of a surface about which its forces have moments, each by itself."""
        owners = [face.owner for face in surface.faces()]
        if surface not in self._skins:
            for ball in surface.balls():
                if ball.levers.any() or (self.law.friction > 0.0 and ball.radius != 0.0):
                    owners += ball.owners
        for body, node in owners:
            if body is not None and body.uncoupled:
                yield body, HeldRotation(node, (self, node), what, needed=False)

    def _meeting(self, nodes: Nodes) -> MeetingSides:
        if self._skins:
            return meeting_of(self.a, self.b, nodes)
        if not self._lines:
            a, b, flat, same = self.sides(nodes)
            return Balls(a, b, flat=flat, same=same)
        first, second = (self.a, self.b) if self.a.pieces() else (self.b, self.a)
        planes = None if second.pieces() else planes_side(second.faces(), nodes)
        return Lines(first.pieces(), second.pieces(), planes, nodes)

    def _frames(self, nodes: Nodes) -> Array:
        """Initial frames of nodes, of other bodies' anything."""
        numbers = [nodes(body) for body in self.bodies]
        H = np.zeros((1 + max(int(each.max()) for each in numbers), 4, 3))
        for body, each in zip(self.bodies, numbers, strict=True):
            H[each] = body.frames
        return H

    def _numbered(self) -> tuple[Nodes, Array]:
        """Numbers and initial frames of the nodes of its bodies alone."""
        first = np.cumsum([0, *(len(body.frames) for body in self.bodies)])
        numbers = {
            body: np.arange(len(body.frames)) + k
            for body, k in zip(self.bodies, first, strict=False)
        }
        return numbers.__getitem__, np.concatenate([body.frames for body in self.bodies])

    def _check_overlap(self) -> None:
        numbers, H = self._numbered()
        a, b, flat, same = self.sides(numbers)
        if not (a.owners[:, np.newaxis] != b.owners).any():
            raise ValueError(f"{self.label}: they never move against each other")
        near = NearPairs(a, b, flat=flat, same=same)
        near.update(H)
        sizes = np.where(a.radii > 0.0, a.radii, max(body.size for body in self.bodies))
        g, place = gaps(H, a, b, near.now, flat)
        self._refuse(g, place, sizes[near.now[:, 0]])

    def _refuse(self, g: Array, places: Array, sizes: Array) -> None:
        """Overlaps by more than a part of sizes: the largest one."""
        if self.ignore_initial:
            return
        instead = ", or give ignore_initial=True" if self._of_balls else ""
        too_deep = np.flatnonzero(g < -OVERLAP * sizes)
        for e in too_deep[np.argsort(g[too_deep], kind="stable")][:1]:
            at = ", ".join(f"{x:g}" for x in places[e])
            raise ValueError(
                f"{self.label}: they overlap by {-g[e]:.3g} at ({at}); start apart{instead}"
            )


def _numbers_of(surface: Surface, nodes: Nodes) -> list[Array]:
    """All that lines, or planes, consist of."""
    pieces, faces = surface.pieces(), surface.faces()
    owners = [number_of(*owner, nodes) for piece in pieces for owner in piece.owners]
    owners += [number_of(*face.owner, nodes) for face in faces]
    shapes = [np.append(each.origin, each.normal) for each in faces]
    for piece in pieces:
        sizes = piece.length, piece.chord, piece.radius, float(piece.goes_on)
        shapes.append(np.concatenate([piece.ends.ravel(), piece.tangents.ravel(), sizes]))
    return [np.array(owners), np.array(shapes)]


def _largest(*sides: list[Ball]) -> float:
    return max(ball.radius for side in sides for ball in side)
