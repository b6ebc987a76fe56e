"""Contact pair of a rope and the rings that it runs through."""

from __future__ import annotations

import numpy as np

from fem_lie.contact.pairs.pair import OVERLAP, ContactPair, ImpactPair
from fem_lie.contact.rings.forces import RingForces
from fem_lie.contact.rings.surfaces import Rings, Rope
from fem_lie.contact.sides.table import Nodes

ALONE = "ropes touch rings only: expected Contact(Rope(...), Rings(...))"
"""Why a rope and rings touch nothing else."""

_LAW = "ropes run through rings by Penalty without damping"


class RopeRingPair(ContactPair):
    """A rope and rings."""

    a: Rope
    b: Rings

    @property
    def impact(self) -> ImpactPair:
        """Not available.

        Raises:
            ValueError: Always: ropes run through rings by :class:`~fem_lie.contact.Penalty` only.
        """
        raise ValueError(f"{self.label}: {_LAW}")

    def check(self) -> None:
        """Raise ``ValueError`` for an unsupported law, or for a ring that is not on the rope."""
        if self.penalty.damping > 0.0:
            raise ValueError(f"{self.label}: {_LAW}")
        own = {(self.a.body, int(node)) for node in self.a.path}
        if any((point.body, point.node) in own for point in self.b.of):
            raise ValueError(f"{self.label}: a ring is fixed to a node of its rope")
        nodes, H = self.numbered()
        distance = -self.term(nodes).touching(H, np.empty((0, 6)))[1]
        spacing = self.a.lengths.mean()
        if distance.max() > OVERLAP * spacing:
            k = int(distance.argmax())
            raise ValueError(
                f"{self.label}: ring {k} is {distance[k]:.3g} off the rope, whose nodes are "
                f"{spacing:.3g} apart; let it start on the rope"
            )

    def contents(self, nodes: Nodes) -> tuple[object, ...]:
        """All that the contact forces depend on."""
        return *self.term(nodes).contents, repr(self.law)

    def term(self, nodes: Nodes) -> RingForces:
        """Contact forces of the rings."""
        types, H = self.node_types(nodes), self.initial_frames(nodes)
        return RingForces(self.a, self.b, self.penalty.coulomb, nodes, types, H)
