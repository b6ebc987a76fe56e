"""Contact pairs of shells, which touch each other, themselves, balls and planes."""

from __future__ import annotations

import numpy as np

from fem_lie.contact.pairs.pair import PenaltyPair
from fem_lie.contact.pairs.patch_sides import Facing
from fem_lie.contact.pairs.skins import Skin
from fem_lie.contact.sides.meeting import Balls, Sides
from fem_lie.contact.sides.surfaces import PlaneSurface, PointSurface
from fem_lie.contact.sides.table import Nodes, balls_side, planes_side

_NONE = np.empty((0, 2), dtype=np.int64)


class _SkinPair(PenaltyPair):
    """A shell, and what touches it."""

    what = "skins of shells"


class SkinPair(_SkinPair):
    """Two shells, or one that touches itself; forces are integrated over the first."""

    a: Skin
    b: Skin

    power = 2

    def check(self) -> None:
        """See the base class."""
        if self.a is not self.b and self.a.shell is self.b.shell:
            raise ValueError(f"{self.label}: a shell touches itself by one skin, given twice")
        super().check()

    def meeting(self, nodes: Nodes) -> Sides:
        """See the base class."""
        patches = self.b.patches(nodes)
        if self.a is not self.b:
            return Facing(*self.a.places(self.a.patches(nodes)), patches, _NONE)
        places, fixed, areas = self.a.places(patches)
        # each pair of faces is seen from both of them
        g = len(areas) // len(patches.nodes)
        pairs = self.b.neighbours(patches)
        first = (g * pairs[:, :1] + np.arange(g)).ravel()
        left_out = np.stack([first, np.repeat(pairs[:, 1], g)], axis=1)
        return Facing(places, fixed, 0.5 * areas, patches, left_out)

    def contents(self, nodes: Nodes) -> tuple[object, ...]:
        """See the base class."""
        both = *self.a.contents(nodes), *self.b.contents(nodes)
        return *both, self.a is self.b, repr(self.law)


class BallSkinPair(_SkinPair):
    """Balls and a shell."""

    a: PointSurface
    b: Skin

    def check(self) -> None:
        """See the base class."""
        if any(ball.radius < 0.0 for ball in self.a.balls()):
            raise ValueError(f"{self.label}: skins do not touch what is around a hollow")
        super().check()

    def meeting(self, nodes: Nodes) -> Sides:
        """See the base class."""
        balls = balls_side(self.a.balls(), nodes)
        return Facing(balls, balls, np.ones(len(balls.radii)), self.b.patches(nodes), _NONE)

    def contents(self, nodes: Nodes) -> tuple[object, ...]:
        """See the base class."""
        balls = balls_side(self.a.balls(), nodes)
        return *balls.arrays, *self.b.contents(nodes), repr(self.law)


class SkinPlanePair(_SkinPair):
    """A shell and planes."""

    a: Skin
    b: PlaneSurface

    power = 2

    def meeting(self, nodes: Nodes) -> Sides:
        """See the base class."""
        places, fixed, areas = self.a.places(self.a.patches(nodes))
        planes = planes_side(self.b.faces(), nodes)
        return Balls(places, planes, flat=True, same=False, areas=areas, fixed=fixed)

    def contents(self, nodes: Nodes) -> tuple[object, ...]:
        """See the base class."""
        return *self.a.contents(nodes), *planes_side(self.b.faces(), nodes).arrays, repr(self.law)
