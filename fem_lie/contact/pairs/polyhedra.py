"""Contact pairs of convex polyhedra, which touch each other and balls by impacts."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence

from fem_lie.contact.convex.overlaps import overlap_of
from fem_lie.contact.convex.table import PolyhedronPair, slots_of
from fem_lie.contact.laws.law import ContactTerm, Impact
from fem_lie.contact.pairs.pair import OVERLAP, ContactPair, ImpactPair
from fem_lie.contact.sides.surfaces import Ball, PointSurface, PolyhedralSurface
from fem_lie.contact.sides.table import BothSides, Nodes, joined_sides

NO_PENALTY = (
    "polyhedra touch each other and balls by Impact; the force of a Penalty would jump where a "
    "corner gets over an edge"
)
"""Why there is no force by penalty: that of the least translation out of an overlap has a
potential, the gradient of which jumps where the direction of that translation does."""


class _PolyhedralPair(ContactPair, ImpactPair):
    """A polyhedron, and what touches it by a contact manifold."""

    what = "polyhedra"

    @property
    def impact(self) -> ImpactPair:
        """Itself."""
        return self

    @property
    @abstractmethod
    def manifolds(self) -> Sequence[PolyhedronPair]:
        """See the base class."""

    def sides(self, nodes: Nodes) -> BothSides:
        """See the base class."""
        first, second = zip(*(slots_of(pair, nodes) for pair in self.manifolds), strict=True)
        return BothSides(joined_sides(first), joined_sides(second), False, False)

    def check(self) -> None:
        """See the base class."""
        if not isinstance(self.law, Impact):
            raise ValueError(f"{self.label}: {NO_PENALTY}")
        for pair in self.manifolds:
            owners = pair.first.owners if isinstance(pair.first, Ball) else (pair.first.owner,)
            if any(body is pair.second.owner[0] for body, _ in owners):
                raise ValueError(f"{self.label}: they never move against each other")
        overlap, size = overlap_of(self.manifolds, *self.numbered())
        if overlap > OVERLAP * size:
            raise ValueError(f"{self.label}: they overlap by {overlap:.3g}; start apart")

    def term(self, nodes: Nodes) -> ContactTerm:
        """There is none.

        Raises:
            ValueError: Always.
        """
        _ = self.penalty
        raise ValueError(f"{self.label}: {NO_PENALTY}")


class PolyhedronPolyhedronPair(_PolyhedralPair):
    """Two polyhedra."""

    a: PolyhedralSurface
    b: PolyhedralSurface

    @property
    def manifolds(self) -> Sequence[PolyhedronPair]:
        """See the base class."""
        return [PolyhedronPair(self.a.polyhedron(), self.b.polyhedron())]

    def contents(self, nodes: Nodes) -> tuple[object, ...]:
        """See the base class."""
        a, b, flat, same = self.sides(nodes)
        corners = self.a.polyhedron().corners, self.b.polyhedron().corners
        return *a.arrays, *b.arrays, flat, same, repr(self.law), *corners


class BallPolyhedronPair(_PolyhedralPair):
    """Balls and a polyhedron."""

    a: PointSurface
    b: PolyhedralSurface

    @property
    def manifolds(self) -> Sequence[PolyhedronPair]:
        """See the base class."""
        polyhedron = self.b.polyhedron()
        return [PolyhedronPair(ball, polyhedron) for ball in self.a.balls()]

    def contents(self, nodes: Nodes) -> tuple[object, ...]:
        """See the base class."""
        a, b, flat, same = self.sides(nodes)
        return *a.arrays, *b.arrays, flat, same, repr(self.law), self.b.polyhedron().corners

    def check(self) -> None:
        """See the base class."""
        if any(ball.radius <= 0.0 for ball in self.a.balls()):
            raise ValueError(
                f"{self.label}: points do not touch polyhedra, and neither does what is around a "
                "hollow; give balls, boxes or planes"
            )
        super().check()
