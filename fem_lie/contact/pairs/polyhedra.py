"""Contact pairs of convex polyhedra with each other and with balls, by impacts."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence

from fem_lie.contact.convex.overlaps import overlap_of
from fem_lie.contact.convex.table import (
    ConvexBall,
    ConvexPolyhedron,
    PolyhedronPair,
    slots_of,
)
from fem_lie.contact.laws.law import ContactTerm
from fem_lie.contact.pairs.pair import OVERLAP, ContactPair, ImpactPair
from fem_lie.contact.sides.surfaces import PointSurface, PolyhedralSurface
from fem_lie.contact.sides.table import INACTIVE, BothSides, Nodes, joined_sides

NO_PENALTY = (
    "polyhedra touch each other by Impact; the force of a Penalty would jump where a corner passes "
    "an edge. Vertices with a radius at the corners of one touch the other by Penalty"
)
"""Why polyhedra have no penalty: its potential is the least translation out of an overlap, and the
force jumps where the direction of this translation jumps."""


class _PolyhedralPair(ContactPair, ImpactPair):
    """A polyhedron, and surfaces that touch it by a contact manifold."""

    @property
    def impact(self) -> ImpactPair:
        """The pair itself."""
        return self

    @property
    @abstractmethod
    def manifolds(self) -> Sequence[PolyhedronPair]:
        """Pairs of bodies that have a contact manifold."""

    def sides(self, nodes: Nodes) -> BothSides:
        """Both sides as packed arrays."""
        first, second = zip(*(slots_of(pair, nodes) for pair in self.manifolds), strict=True)
        return BothSides(joined_sides(first), joined_sides(second), INACTIVE, False)

    def check(self) -> None:
        """Raise ``ValueError`` for surfaces on one frame, or for an overlap at the start."""
        for pair in self.manifolds:
            ((own, _),) = pair.second.owners
            if any(body is own for body, _ in pair.first.owners):
                raise ValueError(
                    f"{self.label}: expected surfaces on different frames, got one frame"
                )
        overlap, size = overlap_of(self.manifolds, *self.numbered())
        if overlap > OVERLAP * size:
            raise ValueError(f"{self.label}: they overlap by {overlap:.3g}; start with a gap")

    def term(self, nodes: Nodes) -> ContactTerm:
        """Not available.

        Raises:
            ValueError: Always: the law is :class:`~fem_lie.contact.Impact`.
        """
        _ = self.penalty
        raise AssertionError


class PolyhedronPolyhedronPair(_PolyhedralPair):
    """Two polyhedra."""

    a: PolyhedralSurface
    b: PolyhedralSurface

    @property
    def manifolds(self) -> Sequence[PolyhedronPair]:
        """The pair of both polyhedra."""
        return [
            PolyhedronPair(
                ConvexPolyhedron(self.a.polyhedron()), ConvexPolyhedron(self.b.polyhedron())
            )
        ]

    def contents(self, nodes: Nodes) -> tuple[object, ...]:
        """All that the impacts depend on."""
        a, b, kind, same = self.sides(nodes)
        corners = self.a.polyhedron().corners, self.b.polyhedron().corners
        return *a.arrays, *b.arrays, kind, same, repr(self.law), *corners


class BallPolyhedronPair(_PolyhedralPair):
    """Balls and a polyhedron."""

    a: PointSurface
    b: PolyhedralSurface

    @property
    def manifolds(self) -> Sequence[PolyhedronPair]:
        """One pair for each ball."""
        polyhedron = ConvexPolyhedron(self.b.polyhedron())
        return [PolyhedronPair(ConvexBall(ball), polyhedron) for ball in self.a.balls()]

    def contents(self, nodes: Nodes) -> tuple[object, ...]:
        """All that the impacts depend on."""
        a, b, kind, same = self.sides(nodes)
        return *a.arrays, *b.arrays, kind, same, repr(self.law), self.b.polyhedron().corners

    def check(self) -> None:
        """Raise ``ValueError`` for points or hollow spheres instead of balls, or for an overlap."""
        if any(ball.radius <= 0.0 for ball in self.a.balls()):
            raise ValueError(
                f"{self.label}: points and hollow spheres do not touch polyhedra; give balls, "
                "boxes or planes"
            )
        super().check()
