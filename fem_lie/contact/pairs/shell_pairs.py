"""Contact pairs of shells with each other, with themselves, with balls and with planes."""

from __future__ import annotations

import numpy as np

from fem_lie.contact.pairs.pair import PenaltyPair
from fem_lie.contact.pairs.patch_sides import PatchSides
from fem_lie.contact.pairs.shell_surfaces import ShellSurface
from fem_lie.contact.sides.surfaces import PlaneSurface, PointSurface
from fem_lie.contact.sides.table import Nodes, balls_side, planes_side
from fem_lie.contact.sides.two_sides import Balls, Sides

_NONE = np.empty((0, 2), dtype=np.int64)


class _ShellContactPair(PenaltyPair):
    """A contact pair with the surface of a shell."""

    what = "surfaces of shells"


class ShellPair(_ShellContactPair):
    """Two shells, or a shell that touches itself; contact forces are integrated over the first."""

    a: ShellSurface
    b: ShellSurface

    power = 2

    def check(self) -> None:
        """Raise ``ValueError`` for two surfaces of one shell, or for an overlap at the start."""
        if self.a is not self.b and self.a.shell is self.b.shell:
            raise ValueError(f"{self.label}: a shell touches itself by one surface, given twice")
        super().check()

    def meeting(self, nodes: Nodes) -> Sides:
        """Both sides, for the evaluation of contact points."""
        patches = self.b.patches(nodes)
        if self.a is not self.b:
            return PatchSides(*self.a.positions(self.a.patches(nodes)), patches, _NONE)
        positions, fixed, areas = self.a.positions(patches)
        # each pair of faces has contact points on both of them
        g = len(areas) // len(patches.nodes)
        pairs = self.b.neighbours(patches)
        first = (g * pairs[:, :1] + np.arange(g)).ravel()
        left_out = np.stack([first, np.repeat(pairs[:, 1], g)], axis=1)
        return PatchSides(positions, fixed, 0.5 * areas, patches, left_out)

    def contents(self, nodes: Nodes) -> tuple[object, ...]:
        """All that the contact forces depend on."""
        both = *self.a.contents(nodes), *self.b.contents(nodes)
        return *both, self.a is self.b, repr(self.law)


class BallShellPair(_ShellContactPair):
    """Balls and a shell."""

    a: PointSurface
    b: ShellSurface

    def check(self) -> None:
        """Raise ``ValueError`` for hollow spheres, or for an overlap at the start."""
        if any(ball.radius < 0.0 for ball in self.a.balls()):
            raise ValueError(f"{self.label}: shells do not touch hollow spheres")
        super().check()

    def meeting(self, nodes: Nodes) -> Sides:
        """Both sides, for the evaluation of contact points."""
        balls = balls_side(self.a.balls(), nodes)
        return PatchSides(balls, balls, np.ones(len(balls.radii)), self.b.patches(nodes), _NONE)

    def contents(self, nodes: Nodes) -> tuple[object, ...]:
        """All that the contact forces depend on."""
        balls = balls_side(self.a.balls(), nodes)
        return *balls.arrays, *self.b.contents(nodes), repr(self.law)


class ShellPlanePair(_ShellContactPair):
    """A shell and planes."""

    a: ShellSurface
    b: PlaneSurface

    power = 2

    def meeting(self, nodes: Nodes) -> Sides:
        """Both sides, for the evaluation of contact points."""
        positions, fixed, areas = self.a.positions(self.a.patches(nodes))
        planes = planes_side(self.b.faces(), nodes)
        return Balls(positions, planes, flat=True, same=False, areas=areas, fixed=fixed)

    def contents(self, nodes: Nodes) -> tuple[object, ...]:
        """All that the contact forces depend on."""
        return *self.a.contents(nodes), *planes_side(self.b.faces(), nodes).arrays, repr(self.law)
