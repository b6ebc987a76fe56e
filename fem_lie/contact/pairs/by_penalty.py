"""Contact pairs whose points meet where the gap is negative, and push each other by penalty."""

from __future__ import annotations

from abc import abstractmethod

import numpy as np

from fem_lie.contact.friction.forces import Friction
from fem_lie.contact.laws.law import Penalty
from fem_lie.contact.laws.node_axes import NodeAxes
from fem_lie.contact.laws.penalty import PenaltyForces
from fem_lie.contact.pairs.pair import ContactPair
from fem_lie.contact.sides.meeting import Sides
from fem_lie.contact.sides.table import Nodes


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
