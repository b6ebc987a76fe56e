"""Contact pairs of points and balls, which touch planes, hollows and each other."""

from __future__ import annotations

from abc import abstractmethod

import numpy as np

from fem_lie.contact.pairs.pair import ImpactPair, PenaltyPair
from fem_lie.contact.sides.kinematics import gaps
from fem_lie.contact.sides.meeting import Balls, Sides
from fem_lie.contact.sides.pairs import NearPairs
from fem_lie.contact.sides.surfaces import (
    Ball,
    GapSurface,
    PlaneSurface,
    PointSurface,
    PolyhedralSurface,
)
from fem_lie.contact.sides.table import BothSides, Nodes, balls_side, level_side, planes_side


class _PointPair(PenaltyPair, ImpactPair):
    """Points with a radius on one side, planes or points on the other."""

    what = "points and balls"
    ignores_initial = True

    @property
    def impact(self) -> ImpactPair:
        """Itself."""
        return self

    @abstractmethod
    def sides(self, nodes: Nodes) -> BothSides:
        """See the base class."""

    def check(self) -> None:
        """See the base class."""
        self.check_friction()
        nodes, H = self.numbered()
        a, b, flat, same = self.sides(nodes)
        if not (a.owners[:, np.newaxis] != b.owners).any():
            raise ValueError(f"{self.label}: they never move against each other")
        near = NearPairs(a, b, flat=flat, same=same)
        near.update(H)
        sizes = np.where(a.radii > 0.0, a.radii, max(body.size for body in self.bodies))
        g, positions = gaps(H, a, b, near.now, flat)
        self.refuse_overlap(g, positions, sizes[near.now[:, 0]])

    def contents(self, nodes: Nodes) -> tuple[object, ...]:
        """See the base class."""
        a, b, flat, same = self.sides(nodes)
        ignores = ("ignore_initial",) if self.ignore_initial else ()
        return *a.arrays, *b.arrays, flat, same, repr(self.law), *ignores

    def meeting(self, nodes: Nodes) -> Sides:
        """See the base class."""
        a, b, flat, same = self.sides(nodes)
        return Balls(a, b, flat=flat, same=same)


class BallPlanePair(_PointPair):
    """Points and balls, which touch planes."""

    a: PointSurface | PolyhedralSurface
    b: PlaneSurface

    def sides(self, nodes: Nodes) -> BothSides:
        """See the base class."""
        a, b = balls_side(self.a.balls(), nodes), planes_side(self.b.faces(), nodes)
        return BothSides(a, b, True, False)


class PolyhedronPlanePair(BallPlanePair):
    """The vertices of a polyhedron, which touch planes."""

    a: PolyhedralSurface

    def contents(self, nodes: Nodes) -> tuple[object, ...]:
        """See the base class."""
        return *super().contents(nodes), self.a.polyhedron().corners


class BallGapPair(_PointPair):
    """Points and balls, which touch a surface that has a gap function."""

    a: PointSurface | PolyhedralSurface
    b: GapSurface

    @property
    def impact(self) -> ImpactPair:
        """There is none.

        Raises:
            ValueError: Always.
        """
        raise ValueError(f"{self.label}: surfaces with a gap function touch by Penalty, not Impact")

    def sides(self, nodes: Nodes) -> BothSides:
        """See the base class."""
        return BothSides(balls_side(self.a.balls(), nodes), level_side(self.b, nodes), True, False)

    def contents(self, nodes: Nodes) -> tuple[object, ...]:
        """See the base class."""
        surface = type(self.b).__qualname__, tuple(float(each) for each in self.b.parameters)
        return *super().contents(nodes), *surface


class BallPair(_PointPair):
    """Points and balls, which touch points, balls, and what is around hollows."""

    a: PointSurface
    b: PointSurface

    def sides(self, nodes: Nodes) -> BothSides:
        """See the base class."""
        a, b = self.a.balls(), self.b.balls()
        if min(ball.radius for ball in a) < 0.0:
            a, b = b, a
        return BothSides(balls_side(a, nodes), balls_side(b, nodes), False, self.a is self.b)

    def check(self) -> None:
        """See the base class."""
        a, b = self.a.balls(), self.b.balls()
        radii = [min(ball.radius for ball in side) for side in (a, b)]
        if min(radii) < 0.0 and (max(radii) < 0.0 or min(radii) + _largest(a, b) >= 0.0):
            raise ValueError(f"{self.label}: what is in a hollow must be smaller, and no hollow")
        if radii[0] == radii[1] == 0.0:
            raise ValueError(f"{self.label}: points never touch points; give one of them a radius")
        super().check()


def _largest(*sides: list[Ball]) -> float:
    return max(ball.radius for side in sides for ball in side)
