"""Round beams and round bars: pieces of cubic curves with a radius, and their contact pairs.

A piece is Hermite's cubic in the ends and the tangents there, ``P = Σ Nₖ (xₖ + Rₖ pₖ) + Mₖ Rₖ tₖ``:
of a beam ``p = 0`` and ``t = ℓ e₁``, so that its axis has no kinks at nodes; of a straight bar in
one frame both ends have the same node.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, instance, positive, vector
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.body import Point
from fem_lie.bodies.points import require_point
from fem_lie.contact.pairs.pair import PenaltyPair
from fem_lie.contact.sides.meeting import Lines
from fem_lie.contact.sides.surfaces import (
    LineSurface,
    Piece,
    PlaneSurface,
    initial_frame,
)
from fem_lie.contact.sides.table import Nodes, number_of, planes_side

_KINK = np.cos(np.radians(10.0))
"""Of the largest angle between e₁ at a node and the chord."""

_CURVED = 0.9
"""Of the largest radius over the radius of curvature: nearest places are not unique beyond."""


@dataclass(frozen=True, eq=False)
class Line(LineSurface):
    """A round beam: all within a radius of its axis, with round ends.

    Forces are per length of the unloaded axis. The first of two lines is the one along which they
    are integrated; that should be the finer one.

    Attributes:
        beam: With the axis.
        radius: Of what is round.
    """

    beam: Beam
    radius: float

    def __post_init__(self) -> None:
        """Raise ``TypeError`` or ``ValueError`` for what is no beam or radius."""
        instance(self.beam, Beam, "Line: beam", "a Beam")
        positive(self.radius, "Line: radius")

    @property
    def points(self) -> Sequence[Point]:
        """Two, at its first and last node."""
        return [Point(self.beam, 0), Point(self.beam, len(self.beam.frames) - 1)]

    def pieces(self) -> list[Piece]:
        """Its elements, one chain after the other."""
        chains, elements, lengths = self.beam.chains, self.beam.elements, self.beam.lengths
        places = self.beam.frames[:, 0]
        last = {*(np.array(chains.first[1:]) - 1), len(chains.order) - 1}
        found = []
        for k, cell in enumerate(chains.order):
            a, b = (int(node) for node in elements[cell, :2])
            tangents = np.tile([float(lengths[cell]), 0.0, 0.0], (2, 1))
            owners = (self.beam, a), (self.beam, b)
            ends = np.zeros((2, 3))
            chord = float(np.linalg.norm(places[b] - places[a]))
            length, goes_on = float(lengths[cell]), k not in last
            found.append(Piece(owners, ends, tangents, length, chord, self.radius, goes_on))
        return found

    def check(self) -> None:
        """Refuse axes with kinks, and axes that are curved more than what is round about them.

        Raises:
            ValueError: Somewhere e₁ is not along the chord, or turns too much along an element.
        """
        for piece in self.pieces():
            (_, a), (_, b) = piece.owners
            frames = self.beam.frames[[a, b]]
            chord = frames[1, 0] - frames[0, 0]
            along = frames[:, 1] @ chord / np.linalg.norm(chord)
            for node in np.array([a, b])[along < _KINK][:1]:
                raise ValueError(
                    f"{self.label}: e₁ of node {node} is more than 10° off the chord of an element "
                    "there; take more elements"
                )
            turn = 2.0 * float(np.arcsin(0.5 * np.linalg.norm(frames[1, 1] - frames[0, 1])))
            if turn * self.radius > _CURVED * piece.length:
                raise ValueError(
                    f"{self.label}: between nodes {a} and {b} the axis has a radius of curvature "
                    f"of {piece.length / turn:.3g}, and the line one of {self.radius:g}: places on "
                    "it that are nearest are not unique"
                )


@dataclass(frozen=True, eq=False)
class Cylinder(LineSurface):
    """A straight round bar with round ends, fixed to ground, a rigid body or a node.

    Attributes:
        point: In its middle.
        along: From end to end of its axis, global components in the beginning.
        radius: Of what is round.
    """

    point: Point
    along: npt.ArrayLike
    radius: float

    def __post_init__(self) -> None:
        """Raise ``TypeError`` or ``ValueError`` for what is no point, axis or radius."""
        require_point(self.point, "Cylinder: point")
        positive(self.radius, "Cylinder: radius")
        if not np.linalg.norm(vector(self.along, 3, "Cylinder: along")) > 0.0:
            raise ValueError("Cylinder: along must have a length, got none")

    @property
    def points(self) -> Sequence[Point]:
        """One."""
        return [self.point]

    def pieces(self) -> list[Piece]:
        """One."""
        H = initial_frame(self.point.body, self.point.node)
        along = vector(self.along, 3, "Cylinder: along")
        middle, half = self.point.position - H[0], 0.5 * along
        owner = self.point.body, self.point.node
        ends = np.stack([H[1:] @ (middle - half), H[1:] @ (middle + half)])
        tangents = np.tile(H[1:] @ along, (2, 1))
        length = float(np.linalg.norm(along))
        return [Piece((owner, owner), ends, tangents, length, length, self.radius, False)]


class _LinePair(PenaltyPair):
    """A line, and what is near along it."""

    a: LineSurface

    what = "lines"
    power = 1


class LinePair(_LinePair):
    """Two lines; forces are integrated along the first."""

    b: LineSurface

    def meeting(self, nodes: Nodes) -> Lines:
        """See the base class."""
        return Lines(self.a.pieces(), self.b.pieces(), None, nodes)

    def check(self) -> None:
        """See the base class."""
        if self.a is self.b:
            raise ValueError(f"{self.label}: a line does not touch itself; give two lines")
        super().check()

    def contents(self, nodes: Nodes) -> tuple[object, ...]:
        """See the base class."""
        return *_arrays_of(self.a, nodes), *_arrays_of(self.b, nodes), repr(self.law)


class LinePlanePair(_LinePair):
    """A line and planes."""

    b: PlaneSurface

    def meeting(self, nodes: Nodes) -> Lines:
        """See the base class."""
        return Lines(self.a.pieces(), [], planes_side(self.b.faces(), nodes), nodes)

    def contents(self, nodes: Nodes) -> tuple[object, ...]:
        """See the base class."""
        faces = self.b.faces()
        owners = np.array([number_of(*face.owner, nodes) for face in faces])
        planes = owners, np.array([np.append(face.origin, face.normal) for face in faces])
        return *_arrays_of(self.a, nodes), *planes, repr(self.law)


def _arrays_of(line: LineSurface, nodes: Nodes) -> list[Array]:
    """All that a line consists of: numbers of nodes, and the shapes of its pieces."""
    pieces = line.pieces()
    owners = [number_of(*owner, nodes) for piece in pieces for owner in piece.owners]
    shapes = []
    for piece in pieces:
        sizes = piece.length, piece.chord, piece.radius, float(piece.goes_on)
        shapes.append(np.concatenate([piece.ends.ravel(), piece.tangents.ravel(), sizes]))
    return [np.array(owners), np.array(shapes)]
