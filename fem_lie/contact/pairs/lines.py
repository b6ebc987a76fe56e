"""Contact surfaces of round lines and bars, segments of cubic curves with a radius; their pairs.

A segment is a Hermite cubic between two ends, see :mod:`fem_lie.contact.rings.cubics`. A straight
bar is a segment that is fixed to one frame.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from heapq import heappop, heappush

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices, instance, positive, vector
from fem_lie.bodies.beams.line_body import LineBody, SmoothLine
from fem_lie.bodies.body import Point
from fem_lie.bodies.points import require_point
from fem_lie.contact.pairs.pair import PenaltyPair
from fem_lie.contact.rings.cubics import WITH_TANGENTS, cubics
from fem_lie.contact.sides.surfaces import (
    LineSurface,
    Owner,
    Piece,
    PlaneSurface,
    initial_frame,
)
from fem_lie.contact.sides.table import Nodes, number_of, planes_side
from fem_lie.contact.sides.two_sides import Lines
from fem_lie.lie.node_types import NodeType

_KINK = np.cos(np.radians(10.0))
"""Cosine of the largest angle between e₁ at a node and the chord."""

_CURVED = 0.9
"""Largest ratio of the radius to the radius of curvature; closest points are not unique beyond
1."""


@dataclass(frozen=True, eq=False)
class Line(LineSurface):
    """Contact surface of a beam, rod, cable or net: all points within a radius of the axes.

    Contact forces are per length of the undeformed axis. They are integrated along the first of two
    lines, which should have the finer mesh. The ends are round. A line that is given twice touches
    itself. Between nodes that have positions only the axis is a smooth cubic, too.

    Attributes:
        body: A beam, a rod, a cable or a net.
        radius: Radius of the cross-section.

    Example:
        A ball that falls onto a beam.

        >>> rubber = fl.Material(E=1e7, nu=0.3, density=1000.0)
        >>> scene = fl.Scene(gravity=(0, 0, -9.81))
        >>> section = fl.Section.circle(0.02, rubber)
        >>> beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=4))
        >>> ends = [scene.add(fl.Clamp(beam.point(end))) for end in ("start", "end")]
        >>> ball = scene.add(fl.RigidBody(0.1, (1e-4, 1e-4, 1e-4), position=(0.5, 0, 0.08)))
        >>> line = fl.contact.Line(beam, 0.02)
        >>> sphere = fl.contact.Sphere(ball.point("centre"), 0.05)
        >>> touch = scene.add(fl.contact.Contact(line, sphere, fl.contact.Penalty(1e4)))
        >>> result = fl.GeneralisedAlpha().run(scene, duration=0.1, step=5e-4)
        >>> bool(fl.post.contact_forces(result, touch).total[:, 2].max() > 1.0)  # on the ball
        True
    """

    body: LineBody
    radius: float

    def __post_init__(self) -> None:
        """Raise ``TypeError`` or ``ValueError`` if an argument has a wrong type or value."""
        instance(self.body, LineBody, "Line: body", "a Beam, Rod, Cable, SplineCable or Net")
        positive(self.radius, "Line: radius")

    @property
    def points(self) -> Sequence[Point]:
        """First and last node of the body."""
        return [Point(self.body, 0), Point(self.body, len(self.body.frames) - 1)]

    def pieces(self) -> list[Piece]:
        """One cubic segment for each element, line by line."""
        found: list[Piece] = []
        for line in self.body.model.smooth_lines:
            found += self._pieces_of(line, len(found))
        return found

    def _pieces_of(self, line: SmoothLine, first: int) -> list[Piece]:
        """Segments of one line, with the index of its first one."""
        model, frames, m = self.body.model, self.body.frames, len(line.elements)
        types, lengths = model.node_types[line.nodes], model.lengths[line.elements]
        made = cubics(frames[line.nodes], types, lengths, closed=line.closed)
        chords = np.linalg.norm(np.diff(frames[line.nodes, 0], axis=0), axis=1)
        if (types != NodeType.FRAME).any():
            chords[:] = 0.0
        following = first + np.arange(1, m + 1)
        following[-1] = first if line.closed else -1
        found = []
        for k in range(m):
            own, w = made.slots[k] >= 0, made.weights[k]
            owners = tuple((self.body, int(node)) for node in line.nodes[made.slots[k, own]])
            arms = np.zeros((len(owners), 4, 3))
            arms[:, :, 0] = w[own, 1]
            sizes = float(lengths[k]), float(chords[k]), self.radius
            found.append(Piece(owners, w[own, 0], arms, *sizes, int(following[k])))
        return found

    def check(self) -> None:
        """Raise an error for an axis with kinks, or with a radius of curvature below the radius.

        Raises:
            ValueError: e₁ is not along the chord of an element, or rotates too much along it; or
                the nodes of the body have an unexpected type.
        """
        if not np.isin(self.body.model.node_types, (*WITH_TANGENTS, NodeType.POSITION)).all():
            self.body.model.require_frames(self.label)
        for line in self.body.model.smooth_lines:
            self._check_line(line)

    def _check_line(self, line: SmoothLine) -> None:
        frames, lengths = self.body.frames[line.nodes], self.body.model.lengths[line.elements]
        chords = np.diff(frames[:, 0], axis=0)
        chords /= np.linalg.norm(chords, axis=1, keepdims=True)
        if (self.body.model.node_types[line.nodes] == NodeType.FRAME).all():
            along = np.einsum("kj,kej->ke", chords, np.stack([frames[:-1, 1], frames[1:, 1]], 1))
            for k, end in np.argwhere(along < _KINK)[:1]:
                raise ValueError(
                    f"{self.label}: e₁ of node {line.nodes[k + end]} is more than 10° off the "
                    "chord of an element there; use more elements"
                )
            tangents = frames[:, 1]
            turns, spans = np.linalg.norm(np.diff(tangents, axis=0), axis=1), lengths
        else:
            turns = np.linalg.norm(np.diff(chords, axis=0), axis=1)
            spans = 0.5 * (lengths[1:] + lengths[:-1])
        turns = 2.0 * np.arcsin(np.minimum(0.5 * turns, 1.0))
        for k in np.flatnonzero(turns * self.radius > _CURVED * spans)[:1]:
            a, b = line.nodes[k], line.nodes[k + 1]
            raise ValueError(
                f"{self.label}: between nodes {a} and {b} the axis has a radius of curvature "
                f"of {spans[k] / turns[k]:.3g}, and the line one of {self.radius:g}: closest "
                "points on it are not unique"
            )


@dataclass(frozen=True, eq=False)
class Cylinder(LineSurface):
    """Contact surface of a straight round bar with round ends, fixed to one frame.

    Attributes:
        point: Midpoint of the axis: of a rigid body, a node, or of ground,
            ``fl.ground((x, y, z))``.
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
        vectors = np.array([middle - half, middle + half, along, along])
        owner, w = (self.point.body, self.point.node), np.array([[1.0, 1.0, 0.0, 0.0]])
        length = float(np.linalg.norm(along))
        return [Piece((owner,), w, (vectors @ H[1:].T)[np.newaxis], length, 0.0, self.radius, -1)]


class _LinePair(PenaltyPair):
    """A line as first surface; contact forces are integrated along it."""

    a: LineSurface

    power = 1


class LinePair(_LinePair):
    """Two lines; contact forces are integrated along the first."""

    b: LineSurface

    def meeting(self, nodes: Nodes) -> Lines:
        """Both sides, for the evaluation of contact points."""
        a = self.a.pieces()
        if self.a is not self.b:
            return Lines(a, self.b.pieces(), None, nodes)
        return Lines(a, a, None, nodes, left_out=neighbours(a))

    def check(self) -> None:
        """Raise ``ValueError`` for two lines along one body, or for an overlap at the start."""
        if self.a is not self.b and isinstance(self.a, Line) and isinstance(self.b, Line):
            if self.a.body is self.b.body:
                raise ValueError(f"{self.label}: a line touches itself by one Line, given twice")
        super().check()

    def contents(self, nodes: Nodes) -> tuple[object, ...]:
        """All that the contact forces depend on."""
        both = (piece_arrays(each.pieces(), nodes) for each in (self.a, self.b))
        arrays = (array for each in both for array in each)
        return *arrays, self.a is self.b, repr(self.law)


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
        sizes = piece.length, piece.chord, piece.radius, float(piece.following)
        shapes.append(np.concatenate([piece.weights.ravel(), piece.arms.ravel(), sizes]))
    return [np.array(owners), np.concatenate(shapes)]


def neighbours(pieces: Sequence[Piece]) -> Indices:
    """Pairs of segments (k, 2) that are too near each other along the lines to touch.

    Their ends are no farther from each other along the lines than half the circumference, on which
    the line could touch itself at the earliest.
    """
    at: dict[Owner, list[int]] = {}
    for i, piece in enumerate(pieces):
        for end in piece.ends:
            if end is not None:
                at.setdefault(end, []).append(i)
    found = []
    for i, piece in enumerate(pieces):
        reach = np.pi * piece.radius
        way: dict[int, float] = {i: -piece.length}
        queue = [(-piece.length, i)]
        while queue:
            far, j = heappop(queue)
            for end in pieces[j].ends:
                for k in at.get(end, ()) if end is not None else ():
                    if (s := far + pieces[j].length) <= reach and s < way.get(k, np.inf):
                        way[k] = s
                        heappush(queue, (s, k))
        found += [(i, j) for j in way]
    return np.array(sorted(found), dtype=np.int64)
