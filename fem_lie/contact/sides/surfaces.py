"""Surfaces that may touch: points with a radius, and faces, each fixed to a frame.

A place of a surface is linear in the rows ``q = (x, d₁, d₂, d₃)`` of at most four nodes,
``P = Σ (wᵢ xᵢ + Rᵢ cᵢ)`` with constant ``wᵢ`` and ``cᵢ``; of what is fixed to one frame it is that
of one node, with ``w = 1``.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import ClassVar, NamedTuple, TypeAlias

import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit.decorators import Callback
from fem_lie.bodies.body import Body, Point
from fem_lie.bodies.points import require_node
from fem_lie.lie.node_types import NodeType

MOST_NODES = 4
"""Nodes in whose rows a place is linear."""

Owner: TypeAlias = tuple[Body | None, int]
"""Body and node of a frame; ``None``: ground."""


class Ball(NamedTuple):
    """Points within a radius of a place.

    Attributes:
        owners: Body and node of each frame, at most :data:`MOST_NODES`; ``None``: ground.
        weights: ``w`` of each, shape (k,).
        levers: ``c`` of each, shape (k, 3).
        radius: Zero for a point, negative for what is around a hollow.
    """

    owners: tuple[Owner, ...]
    weights: Array
    levers: Array
    radius: float

    @property
    def place(self) -> Array:
        """Initial place, shape (3,)."""
        found = np.zeros(3)
        for owner, w, c in zip(self.owners, self.weights, self.levers, strict=True):
            H = initial_frame(*owner)
            found += w * H[0] + c @ H[1:]
        return found


class Piece(NamedTuple):
    """Of a line.

    Attributes:
        owners: Body and node at both ends; ``None``: ground.
        ends: ``p`` in these frames, shape (2, 3).
        tangents: ``t`` in these frames, shape (2, 3).
        length: Arc length.
        chord: From end to end, where nothing is stretched.
        radius: Of what is round.
        goes_on: Whether the next piece begins where this one ends, with its tangent.
    """

    owners: tuple[Owner, Owner]
    ends: Array
    tangents: Array
    length: float
    chord: float
    radius: float
    goes_on: bool


class Face(NamedTuple):
    """All on one side of a plane.

    Attributes:
        owner: Body and node of the frame.
        origin: A place in the plane, in the frame, shape (3,).
        normal: Unit vector out of what is solid, in the frame, shape (3,).
    """

    owner: Owner
    origin: Array
    normal: Array


class Polyhedron(NamedTuple):
    """A convex polyhedron.

    Attributes:
        owner: Body and node of the frame that it is fixed to; ``None``: ground.
        corners: In this frame, shape (n, 3).
    """

    owner: Owner
    corners: Array


def initial_frame(body: Body | None, node: int) -> Array:
    """Of a node or of ground, shape (4, 3)."""
    return np.vstack([np.zeros(3), np.eye(3)]) if body is None else body.frames[node]


def owner_of(point: Point) -> Owner:
    """Body and node of a point."""
    return point.body, point.node


def fixed_ball(point: Point, radius: float, offset: Array | None = None) -> Ball:
    """A ball about a point, or about a place that has the ``offset`` (3,) in its frame."""
    H = initial_frame(*owner_of(point))
    place = point.position if offset is None else point.frame[0] + offset @ point.frame[1:]
    lever = H[1:] @ (place - H[0])
    return Ball((owner_of(point),), np.ones(1), lever[np.newaxis], radius)


def polyhedron_at(point: Point, places: Sequence[Array]) -> Polyhedron:
    """A polyhedron that is fixed to a point, by the initial places of its corners (3,)."""
    H = initial_frame(*owner_of(point))
    return Polyhedron(owner_of(point), (np.array(places) - H[0]) @ H[1:].T)


class Surface(ABC):
    """A contact surface: what may touch."""

    @property
    @abstractmethod
    def points(self) -> Sequence[Point]:
        """What it is fixed to."""

    @property
    def kind(self) -> type[Surface]:
        """Class by which the contact pair of two surfaces is chosen; default: its own."""
        return type(self)

    @property
    def label(self) -> str:
        """For messages."""
        names = dict.fromkeys(p.label if p.is_ground else _name(p) for p in self.points)
        return f"{type(self).__name__} on {', '.join(names)}"

    def check(self) -> None:
        """Refuse what it cannot be fixed to.

        Raises:
            ValueError: A node has no frame, or a point is no node.
        """
        for point in self.points:
            require_node(point, self.label)
            if point.body is not None and not (self.turns_alike and _has_position(point)):
                point.body.require_frames(self.label)

    @property
    def turns_alike(self) -> bool:
        """Whether it is the same however its points rotate, so that these need no axes."""
        return False

    def moments(self, friction: bool) -> Sequence[Owner]:
        """Frames about which contact forces have a moment, of bodies that may lack some rotation.

        Args:
            friction: Whether there are tractions.
        """
        return ()

    def rotating(self, friction: bool) -> Sequence[Body]:
        """Bodies all of whose nodes contact forces rotate about all axes; default: none."""
        return ()


class PointSurface(Surface):
    """Points, or balls about them."""

    @abstractmethod
    def balls(self) -> list[Ball]:
        """All of them."""

    def moments(self, friction: bool) -> Sequence[Owner]:
        """See the base class."""
        return _with_moments(self.balls(), friction)


class PlaneSurface(Surface):
    """Planes, with all that is behind them."""

    @abstractmethod
    def faces(self) -> list[Face]:
        """All of them."""

    def moments(self, friction: bool) -> Sequence[Owner]:
        """See the base class."""
        return [face.owner for face in self.faces()]


class LineSurface(Surface):
    """What is round about lines."""

    @abstractmethod
    def pieces(self) -> Sequence[Piece]:
        """Pieces of the lines, one line after the other."""


class PolyhedralSurface(Surface):
    """A convex polyhedron."""

    @abstractmethod
    def balls(self) -> list[Ball]:
        """Its vertices."""

    @abstractmethod
    def polyhedron(self) -> Polyhedron:
        """All of it."""

    def moments(self, friction: bool) -> Sequence[Owner]:
        """See the base class."""
        return _with_moments(self.balls(), friction)


class GapSurface(Surface):
    """A surface that is given by the gap of points to it, in the axes of the frame of a point.

    Attributes:
        point: What it is fixed to; positions count from it, along the axes of its body's frame.
        gap: Compiled gap function, see :mod:`.gap_functions`.
        parameters: Numbers that it takes; default: none.
    """

    point: Point
    gap: ClassVar[Callback]
    parameters: Sequence[float] = ()

    @property
    def points(self) -> Sequence[Point]:
        """The point."""
        return [self.point]

    def moments(self, friction: bool) -> Sequence[Owner]:
        """See the base class."""
        return [owner_of(self.point)]


def _with_moments(balls: Sequence[Ball], friction: bool) -> list[Owner]:
    """Frames of balls beside them, or of round ones with tractions."""
    beside = (ball for ball in balls if ball.levers.any() or (friction and ball.radius != 0.0))
    return [owner for ball in beside for owner in ball.owners]


_WITH_POSITION = (NodeType.POSITION, NodeType.POSITION_GRADIENT, NodeType.SURFACE_GRADIENT)


def _has_position(point: Point) -> bool:
    """Whether a point is a node with vector coordinates, of which one is its position."""
    return point.body is not None and int(point.body.node_types[point.node]) in _WITH_POSITION


def _name(point: Point) -> str:
    assert point.body is not None
    return point.body.label
