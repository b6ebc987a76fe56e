"""Contact pairs of points and balls with planes, hollow spheres and each other."""

from __future__ import annotations

from abc import abstractmethod

import numpy as np

from fem_lie.contact.pairs.pair import ImpactPair, PenaltyPair
from fem_lie.contact.sides.kinematics import gaps
from fem_lie.contact.sides.pairs import NearPairs
from fem_lie.contact.sides.surfaces import (
    Ball,
    GapSurface,
    PlaneSurface,
    PointSurface,
    PolyhedralSurface,
)
from fem_lie.contact.sides.table import (
    LEVEL,
    PLANE,
    ROUND,
    BothSides,
    Nodes,
    balls_side,
    level_side,
    planes_side,
)
from fem_lie.contact.sides.two_sides import Balls, Sides


class _PointPair(PenaltyPair, ImpactPair):
    """Points or balls as first surface; planes, points or balls as second surface."""

    ignores_initial = True

    @property
    def impact(self) -> ImpactPair:
        """The pair itself."""
        return self

    @abstractmethod
    def sides(self, nodes: Nodes) -> BothSides:
        """Both sides as packed arrays."""

    def check(self) -> None:
        """Raise ``ValueError`` if the surfaces never touch or overlap at the start."""
        self.check_friction()
        nodes, H = self.numbered()
        a, b, kind, same = self.sides(nodes)
        if not (a.owners[:, np.newaxis] != b.owners).any():
            raise ValueError(f"{self.label}: expected surfaces on different frames, got one frame")
        near = NearPairs(a, b, kind=kind, same=same)
        near.update(H)
        sizes = np.where(a.radii > 0.0, a.radii, max(body.model.size for body in self.bodies))
        g, positions = gaps(H, a, b, near.now, kind)
        self.refuse_overlap(g, positions, sizes[near.now[:, 0]])

    def contents(self, nodes: Nodes) -> tuple[object, ...]:
        """All that the contact forces depend on."""
        a, b, kind, same = self.sides(nodes)
        ignores = ("ignore_initial",) if self.ignore_initial else ()
        return *a.arrays, *b.arrays, kind, same, repr(self.law), *ignores

    def meeting(self, nodes: Nodes) -> Sides:
        """Both sides, for the evaluation of contact points."""
        a, b, kind, same = self.sides(nodes)
        return Balls(a, b, kind=kind, same=same)


class BallPlanePair(_PointPair):
    """Points or balls and planes."""

    a: PointSurface | PolyhedralSurface
    b: PlaneSurface

    def sides(self, nodes: Nodes) -> BothSides:
        """Both sides as packed arrays."""
        a, b = balls_side(self.a.balls(), nodes), planes_side(self.b.faces(), nodes)
        return BothSides(a, b, PLANE, False)


class PolyhedronPlanePair(BallPlanePair):
    """The vertices of a polyhedron and planes."""

    a: PolyhedralSurface

    def contents(self, nodes: Nodes) -> tuple[object, ...]:
        """All that the contact forces depend on."""
        return *super().contents(nodes), self.a.polyhedron().corners


class BallGapPair(_PointPair):
    """Points or balls and a surface with a gap function."""

    a: PointSurface | PolyhedralSurface
    b: GapSurface

    @property
    def impact(self) -> ImpactPair:
        """Not available.

        Raises:
            ValueError: Always: such surfaces touch by :class:`~fem_lie.contact.Penalty` only.
        """
        raise ValueError(f"{self.label}: surfaces with a gap function touch by Penalty, not Impact")

    def sides(self, nodes: Nodes) -> BothSides:
        """Both sides as packed arrays."""
        return BothSides(balls_side(self.a.balls(), nodes), level_side(self.b, nodes), LEVEL, False)

    def contents(self, nodes: Nodes) -> tuple[object, ...]:
        """All that the contact forces depend on."""
        surface = type(self.b).__qualname__, tuple(float(each) for each in self.b.parameters)
        return *super().contents(nodes), *surface


class BallPair(_PointPair):
    """Points or balls on both sides, or a ball inside a hollow sphere."""

    a: PointSurface
    b: PointSurface

    def sides(self, nodes: Nodes) -> BothSides:
        """Both sides as packed arrays; a hollow sphere is the second one."""
        a, b = self.a.balls(), self.b.balls()
        if min(ball.radius for ball in a) < 0.0:
            a, b = b, a
        return BothSides(balls_side(a, nodes), balls_side(b, nodes), ROUND, self.a is self.b)

    def check(self) -> None:
        """Raise ``ValueError`` for points on both sides, or a ball larger than a hollow."""
        a, b = self.a.balls(), self.b.balls()
        radii = [min(ball.radius for ball in side) for side in (a, b)]
        if min(radii) < 0.0 and (max(radii) < 0.0 or min(radii) + _largest(a, b) >= 0.0):
            raise ValueError(
                f"{self.label}: a ball inside a hollow sphere must be smaller, and not hollow"
            )
        if radii[0] == radii[1] == 0.0:
            raise ValueError(f"{self.label}: points never touch points; give one surface a radius")
        super().check()


def _largest(*sides: list[Ball]) -> float:
    return max(ball.radius for side in sides for ball in side)
