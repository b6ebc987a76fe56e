"""Contact surfaces of round beams and bars, segments of cubic curves with a radius; their pairs.

A segment is a Hermite cubic between two ends, ``P = Σ Nₖ (xₖ + Rₖ pₖ) + Mₖ Rₖ tₖ``. On a beam
``p = 0`` and ``t = ℓ e₁``, so that the axis has no kinks at nodes. On a straight bar, which is
fixed to one frame, both ends belong to the same node.
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
from fem_lie.contact.sides.surfaces import (
    LineSurface,
    Piece,
    PlaneSurface,
    initial_frame,
)
from fem_lie.contact.sides.table import Nodes, number_of, planes_side
from fem_lie.contact.sides.two_sides import Lines

_KINK = np.cos(np.radians(10.0))
"""Cosine of the largest angle between e₁ at a node and the chord."""

_CURVED = 0.9
"""Largest ratio of the radius to the radius of curvature; closest points are not unique beyond
1."""


@dataclass(frozen=True, eq=False)
class Line(LineSurface):
    """Contact surface of a beam with a round cross-section: all points within a radius of the axis.

    Contact forces are per length of the undeformed axis. They are integrated along the first of two
    lines, which should have the finer mesh. The ends are round.

    Attributes:
        beam: The beam.
        radius: Radius of the cross-section.
    """

    beam: Beam
    radius: float

    def __post_init__(self) -> None:
        """Raise ``TypeError`` or ``ValueError`` if an argument has a wrong type or value."""
        instance(self.beam, Beam, "Line: beam", "a Beam")
        positive(self.radius, "Line: radius")

    @property
    def points(self) -> Sequence[Point]:
        """First and last node of the beam."""
        return [Point(self.beam, 0), Point(self.beam, len(self.beam.frames) - 1)]

    def pieces(self) -> list[Piece]:
        """One cubic segment for each element, chain by chain."""
        chains, elements, lengths = (
            self.beam.model.chains,
            self.beam.model.elements,
            self.beam.model.lengths,
        )
        positions = self.beam.frames[:, 0]
        last = {*(np.array(chains.first[1:]) - 1), len(chains.order) - 1}
        found = []
        for k, cell in enumerate(chains.order):
            a, b = (int(node) for node in elements[cell, :2])
            tangents = np.tile([float(lengths[cell]), 0.0, 0.0], (2, 1))
            owners = (self.beam, a), (self.beam, b)
            ends = np.zeros((2, 3))
            chord = float(np.linalg.norm(positions[b] - positions[a]))
            length, continues = float(lengths[cell]), k not in last
            found.append(Piece(owners, ends, tangents, length, chord, self.radius, continues))
        return found

    def check(self) -> None:
        """Raise an error for an axis with kinks, or with a radius of curvature below the radius.

        Raises:
            ValueError: e₁ is not along the chord of an element, or rotates too much along it.
        """
        for piece in self.pieces():
            (_, a), (_, b) = piece.owners
            frames = self.beam.frames[[a, b]]
            chord = frames[1, 0] - frames[0, 0]
            along = frames[:, 1] @ chord / np.linalg.norm(chord)
            for node in np.array([a, b])[along < _KINK][:1]:
                raise ValueError(
                    f"{self.label}: e₁ of node {node} is more than 10° off the chord of an element "
                    "there; use more elements"
                )
            turn = 2.0 * float(np.arcsin(0.5 * np.linalg.norm(frames[1, 1] - frames[0, 1])))
            if turn * self.radius > _CURVED * piece.length:
                raise ValueError(
                    f"{self.label}: between nodes {a} and {b} the axis has a radius of curvature "
                    f"of {piece.length / turn:.3g}, and the line one of {self.radius:g}: closest "
                    "points on it are not unique"
                )


@dataclass(frozen=True, eq=False)
class Cylinder(LineSurface):
    """Contact surface of a straight round bar with round ends, fixed to one frame.

    Attributes:
        point: Midpoint of the axis: on ground, a rigid body or a node.
        along: Vector from one end of the axis to the other, initial global components.
        radius: Radius of the bar.
    """

    point: Point
    along: npt.ArrayLike
    radius: float

    def __post_init__(self) -> None:
        """Raise ``TypeError`` or ``ValueError`` if an argument has a wrong type or value."""
        require_point(self.point, "Cylinder: point")
        positive(self.radius, "Cylinder: radius")
        if not np.linalg.norm(vector(self.along, 3, "Cylinder: along")) > 0.0:
            raise ValueError("Cylinder: along must have a length, got none")

    @property
    def points(self) -> Sequence[Point]:
        """The midpoint."""
        return [self.point]

    def pieces(self) -> list[Piece]:
        """One straight segment."""
        H = initial_frame(self.point.body, self.point.node)
        along = vector(self.along, 3, "Cylinder: along")
        middle, half = self.point.position - H[0], 0.5 * along
        owner = self.point.body, self.point.node
        ends = np.stack([H[1:] @ (middle - half), H[1:] @ (middle + half)])
        tangents = np.tile(H[1:] @ along, (2, 1))
        length = float(np.linalg.norm(along))
        return [Piece((owner, owner), ends, tangents, length, length, self.radius, False)]


class _LinePair(PenaltyPair):
    """A line as first surface; contact forces are integrated along it."""

    a: LineSurface

    what = "lines"
    power = 1


class LinePair(_LinePair):
    """Two lines; contact forces are integrated along the first."""

    b: LineSurface

    def meeting(self, nodes: Nodes) -> Lines:
        """Both sides, for the evaluation of contact points."""
        return Lines(self.a.pieces(), self.b.pieces(), None, nodes)

    def check(self) -> None:
        """Raise ``ValueError`` if a line would touch itself, or lines overlap at the start."""
        if self.a is self.b:
            raise ValueError(f"{self.label}: a line does not touch itself; give two lines")
        super().check()

    def contents(self, nodes: Nodes) -> tuple[object, ...]:
        """All that the contact forces depend on."""
        both = (piece_arrays(each.pieces(), nodes) for each in (self.a, self.b))
        return *(array for arrays in both for array in arrays), repr(self.law)


class LinePlanePair(_LinePair):
    """A line and planes."""

    b: PlaneSurface

    def meeting(self, nodes: Nodes) -> Lines:
        """Both sides, for the evaluation of contact points."""
        return Lines(self.a.pieces(), [], planes_side(self.b.faces(), nodes), nodes)

    def contents(self, nodes: Nodes) -> tuple[object, ...]:
        """All that the contact forces depend on."""
        faces = self.b.faces()
        owners = np.array([number_of(*face.owner, nodes) for face in faces])
        planes = owners, np.array([np.append(face.origin, face.normal) for face in faces])
        return *piece_arrays(self.a.pieces(), nodes), *planes, repr(self.law)


def piece_arrays(pieces: Sequence[Piece], nodes: Nodes) -> list[Array]:
    """Numbers of the nodes of segments of lines, and their geometry."""
    owners = [number_of(*owner, nodes) for piece in pieces for owner in piece.owners]
    shapes = []
    for piece in pieces:
        sizes = piece.length, piece.chord, piece.radius, float(piece.continues)
        shapes.append(np.concatenate([piece.ends.ravel(), piece.tangents.ravel(), sizes]))
    return [np.array(owners), np.array(shapes)]
