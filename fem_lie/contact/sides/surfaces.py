"""Base classes of contact surfaces, and their parts: balls, faces and segments of curves.

A contact point is linear in the nodal coordinates ``q = (x, d₁, d₂, d₃)`` of at most four nodes,
``P = Σ (wᵢ xᵢ + Rᵢ cᵢ)`` with constant ``wᵢ`` and ``cᵢ``. A point that is fixed to one frame
depends on one node, with ``w = 1``.
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
"""Largest number of nodes that a contact point depends on."""

Owner: TypeAlias = tuple[Body | None, int]
"""Body and node of a frame; ``None``: ground."""


class Ball(NamedTuple):
    """A ball about a contact point.

    Attributes:
        owners: Body and node of each frame, at most :data:`MOST_NODES`; ``None``: ground.
        weights: ``w`` of each, shape (k,).
        arms: ``c`` of each, shape (k, 3).
        radius: Zero for a point, negative for a hollow sphere.
    """

    owners: tuple[Owner, ...]
    weights: Array
    arms: Array
    radius: float

    @property
    def position(self) -> Array:
        """Initial position, shape (3,)."""
        found = np.zeros(3)
        for owner, w, c in zip(self.owners, self.weights, self.arms, strict=True):
            H = initial_frame(*owner)
            found += w * H[0] + c @ H[1:]
        return found


class Piece(NamedTuple):
    """A segment of a line: a cubic with two ends and two tangents, in a parameter from 0 to 1.

    Each of these four vectors is linear in the nodal coordinates, ``Σ (w x + R c)``.

    Attributes:
        owners: Body and node of each frame, at most :data:`MOST_NODES`; ``None``: ground.
        weights: ``w`` of each in the ends and in the tangents, shape (k, 4).
        arms: ``c`` of each in the ends and in the tangents, shape (k, 4, 3).
        length: Undeformed arc length.
        chord: Undeformed distance of the ends, if the tangents must be multiplied by the stretch of
            the chord, as those of frames; else zero.
        radius: Radius.
        following: Index of the segment that starts at the end of this one, with the same tangent;
            −1: none.
    """

    owners: tuple[Owner, ...]
    weights: Array
    arms: Array
    length: float
    chord: float
    radius: float
    following: int

    @property
    def ends(self) -> tuple[Owner | None, Owner | None]:
        """Nodes at the ends; ``None`` for an end that is no node."""
        found: list[Owner | None] = [None, None]
        for k, owner in enumerate(self.owners):
            for end in range(2):
                if self.weights[k, end] == 1.0 and not self.arms[k, end].any():
                    found[end] = owner
        return found[0], found[1]


class Face(NamedTuple):
    """A half-space bounded by a plane.

    Attributes:
        owner: Body and node of the frame.
        origin: A point in the plane, in the frame, shape (3,).
        normal: Unit normal out of the solid, in the frame, shape (3,).
    """

    owner: Owner
    origin: Array
    normal: Array


class Polyhedron(NamedTuple):
    """A convex polyhedron.

    Attributes:
        owner: Body and node of the frame that it is fixed to; ``None``: ground.
        corners: Corners in this frame, shape (n, 3).
    """

    owner: Owner
    corners: Array


def initial_frame(body: Body | None, node: int) -> Array:
    """Initial frame of a node or of ground, shape (4, 3)."""
    return np.vstack([np.zeros(3), np.eye(3)]) if body is None else body.frames[node]


def owner_of(point: Point) -> Owner:
    """Body and node of a point."""
    return point.body, point.node


def fixed_ball(point: Point, radius: float, offset: Array | None = None) -> Ball:
    """A ball about a point, or about a position with the ``offset`` (3,) in its frame."""
    H = initial_frame(*owner_of(point))
    position = point.position if offset is None else point.frame[0] + offset @ point.frame[1:]
    arm = H[1:] @ (position - H[0])
    return Ball((owner_of(point),), np.ones(1), arm[np.newaxis], radius)


def polyhedron_at(point: Point, positions: Sequence[Array]) -> Polyhedron:
    """A polyhedron that is fixed to a point, from the initial positions (3,) of its corners."""
    H = initial_frame(*owner_of(point))
    return Polyhedron(owner_of(point), (np.array(positions) - H[0]) @ H[1:].T)


class ContactSurface(ABC):
    """Base class of contact surfaces."""

    @property
    @abstractmethod
    def points(self) -> Sequence[Point]:
        """Points that the surface is fixed to."""

    @property
    def kind(self) -> type[ContactSurface]:
        """Class by which the contact pair of two surfaces is chosen; default: its own class."""
        return type(self)

    @property
    def label(self) -> str:
        """Label for messages."""
        names = dict.fromkeys(p.label if p.is_ground else _name(p) for p in self.points)
        return f"{type(self).__name__} on {', '.join(names)}"

    def check(self) -> None:
        """Raise an error if the surface cannot be fixed to its points.

        Raises:
            ValueError: A node has no frame, or a point is not a node.
        """
        label = self.label  # names all points
        for point in self.points:
            require_node(point, label)
            if point.body is not None and not (self.rotation_invariant and _has_position(point)):
                point.body.model.require_frames(label)

    @property
    def rotation_invariant(self) -> bool:
        """Whether rotations of its points do not change the surface, so that it needs no frames."""
        return False

    def moments(self, friction: bool) -> Sequence[Owner]:
        """Frames about which contact forces have a moment, on bodies that may lack some rotations.

        Args:
            friction: Whether there is friction.
        """
        return ()

    def rotating(self, friction: bool) -> Sequence[Body]:
        """Bodies all of whose nodes need all rotations, because of moments; default: none.

        Args:
            friction: Coefficient of friction.
        """
        return ()


class PointSurface(ContactSurface):
    """Points, or balls about them."""

    @abstractmethod
    def balls(self) -> list[Ball]:
        """All balls."""

    def moments(self, friction: bool) -> Sequence[Owner]:
        """Frames about which contact forces have a moment."""
        return _with_moments(self.balls(), friction)


class HollowSurface(PointSurface):
    """Hollow spheres, which are touched from within: balls with negative radius."""


class PlaneSurface(ContactSurface):
    """Half-spaces bounded by planes."""

    @abstractmethod
    def faces(self) -> list[Face]:
        """All planes."""

    def moments(self, friction: bool) -> Sequence[Owner]:
        """The frames of all planes."""
        return [face.owner for face in self.faces()]


class LineSurface(ContactSurface):
    """Round lines."""

    @abstractmethod
    def pieces(self) -> Sequence[Piece]:
        """Segments of the lines, one line after the other."""


class PolyhedralSurface(ContactSurface):
    """A convex polyhedron."""

    @abstractmethod
    def balls(self) -> list[Ball]:
        """The vertices, as balls with zero radius."""

    @abstractmethod
    def polyhedron(self) -> Polyhedron:
        """The polyhedron."""

    def moments(self, friction: bool) -> Sequence[Owner]:
        """Frames about which contact forces have a moment."""
        return _with_moments(self.balls(), friction)


class GapSurface(ContactSurface):
    """A surface that is defined by a gap function of the position in the frame of a point.

    Attributes:
        point: Origin of positions; the axes are those of the frame of its body or node.
        gap: Compiled gap function, see :mod:`.gap_functions`.
        parameters: Parameters of the gap function; default: none.
    """

    point: Point
    gap: ClassVar[Callback]
    parameters: Sequence[float] = ()

    @property
    def points(self) -> Sequence[Point]:
        """The point."""
        return [self.point]

    def moments(self, friction: bool) -> Sequence[Owner]:
        """The frame of the point."""
        return [owner_of(self.point)]


def _with_moments(balls: Sequence[Ball], friction: bool) -> list[Owner]:
    """Frames of balls with an offset, or of balls with a radius if there is friction."""
    chosen = (ball for ball in balls if ball.arms.any() or (friction and ball.radius != 0.0))
    return [owner for ball in chosen for owner in ball.owners]


_WITH_POSITION = (NodeType.POSITION, NodeType.POSITION_GRADIENT, NodeType.SURFACE_GRADIENT)


def _has_position(point: Point) -> bool:
    """Whether a point is a node with vector coordinates that include its position."""
    return point.body is not None and int(point.body.model.node_types[point.node]) in _WITH_POSITION


def _name(point: Point) -> str:
    assert point.body is not None
    return point.body.label
