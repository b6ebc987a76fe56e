"""Pairs of surfaces for mortar contact, by multipliers or penalty."""

from __future__ import annotations

from abc import abstractmethod

import numpy as np

from fem_lie.contact.laws.law import ContactLaw, Mortar, MortarLaw, MortarPenalty
from fem_lie.contact.mortar.forces import MortarForces, MultiplierForces
from fem_lie.contact.mortar.sides import (
    LinesOnLines,
    LinesOnParts,
    LinesOnPatches,
    MortarSides,
)
from fem_lie.contact.pairs.lines import piece_arrays
from fem_lie.contact.pairs.pair import ContactPair, bodies_of, register_contact_pair
from fem_lie.contact.pairs.patch_surfaces import PatchSurface
from fem_lie.contact.pairs.sampled import InHollow, OnGap, OnPlanes, OnSide
from fem_lie.contact.sides.surfaces import (
    ContactSurface,
    GapSurface,
    HollowSurface,
    LineSurface,
    PlaneSurface,
)
from fem_lie.contact.sides.table import Nodes

_FORCES: dict[type[ContactLaw], type[MortarForces]] = {
    Mortar: MultiplierForces,
    MortarPenalty: MortarForces,
}


class MortarPair(ContactPair):
    """A line with pressures at its nodes, and a second surface."""

    a: LineSurface
    law: MortarLaw

    power = 1

    @abstractmethod
    def meeting(self, nodes: Nodes) -> MortarSides:
        """Both sides.

        Args:
            nodes: Gives the numbers of the nodes of a body in the scene.
        """

    @abstractmethod
    def second(self, nodes: Nodes) -> tuple[object, ...]:
        """All that the contact forces depend on, of the second surface."""

    def check(self) -> None:
        """Raise ``ValueError`` if the surfaces overlap at the start."""
        if self.law.friction > 0.0:
            self.check_friction()
        nodes, H = self.numbered()
        sides = self.meeting(nodes)
        term = MortarForces(sides, 1.0, self.node_types(nodes), self.label)
        _, g, positions, _ = term.touching(H, np.zeros((len(H), 6)))
        self.refuse_overlap(g, positions, np.full(len(g), sides.radius))

    def contents(self, nodes: Nodes) -> tuple[object, ...]:
        """All that the contact forces depend on."""
        return *piece_arrays(self.a.pieces(), nodes), *self.second(nodes), repr(self.law)

    def term(self, nodes: Nodes) -> MortarForces:
        """Contact forces of the law."""
        given = self.meeting(nodes), self.law.k, self.node_types(nodes), self.label
        term = _FORCES[type(self.law)](*given, self.law.coulomb)
        if self.law.friction > 0.0:
            term.accept(self.initial_frames(nodes))
        return term


class MortarLines(MortarPair):
    """Two lines, with pressures at the nodes of the first."""

    b: LineSurface

    def check(self) -> None:
        """Raise ``ValueError`` for a line that touches itself, or for an overlap at the start."""
        if set(bodies_of(self.a)) & set(bodies_of(self.b)):
            raise ValueError(
                f"{self.label}: a line touches itself by Penalty, not by {type(self.law).__name__}"
            )
        super().check()

    def meeting(self, nodes: Nodes) -> MortarSides:
        """Both lines."""
        return LinesOnLines(self.a.pieces(), self.b.pieces(), nodes)

    def second(self, nodes: Nodes) -> tuple[object, ...]:
        """The geometry of the second line."""
        return tuple(piece_arrays(self.b.pieces(), nodes))


class MortarLinePatches(MortarPair):
    """A line and a surface of patches."""

    b: PatchSurface

    def meeting(self, nodes: Nodes) -> MortarSides:
        """The line and the patches."""
        return LinesOnPatches(self.a.pieces(), self.b.patches(nodes), nodes)

    def second(self, nodes: Nodes) -> tuple[object, ...]:
        """The geometry of the patches."""
        b = self.b.patches(nodes)
        return b.nodes, b.offsets, b.tangents, b.radii, b.corners


class _OnParts(OnSide, MortarPair):
    """A line on a surface of parts without edges."""

    def meeting(self, nodes: Nodes) -> MortarSides:
        """Both sides."""
        return LinesOnParts(self.a.pieces(), self.side(nodes), nodes, self.touches)


class MortarLinePlane(OnPlanes, _OnParts):
    """A line and planes."""


class MortarLineHollow(InHollow, _OnParts):
    """A line in hollow spheres."""


class MortarLineGap(OnGap, _OnParts):
    """A line and a surface with a gap function."""


_PAIRS: tuple[tuple[type[ContactSurface], type[ContactSurface], type[MortarPair]], ...] = (
    (LineSurface, LineSurface, MortarLines),
    (LineSurface, PatchSurface, MortarLinePatches),
    (LineSurface, PlaneSurface, MortarLinePlane),
    (LineSurface, HollowSurface, MortarLineHollow),
    (LineSurface, GapSurface, MortarLineGap),
)
"""Kinds of both surfaces, and their pair."""

for _row in _PAIRS:
    for _law in _FORCES:
        register_contact_pair(*_row, _law)
