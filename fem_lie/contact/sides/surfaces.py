"""Surfaces that may touch: points with a radius, and faces, each fixed to a frame.

A place of a surface is linear in the rows ``q = (x, d₁, d₂, d₃)`` of at most four nodes,
``P = Σ (wᵢ xᵢ + Rᵢ cᵢ)`` with constant ``wᵢ`` and ``cᵢ``; of what is fixed to one frame it is that
of one node, with ``w = 1``.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, direction, flag, instance, number, numbers, positive, vector
from fem_lie.bodies.body import Body, Point
from fem_lie.bodies.points import require_node, require_point
from fem_lie.lie.kinds import NodeKind

MOST_NODES = 4
"""Nodes in whose rows a place is linear."""


class Ball(NamedTuple):
    """Points within a radius of a place.

    Attributes:
        owners: Body and node of each frame, at most :data:`MOST_NODES`; ``None``: ground.
        weights: ``w`` of each, shape (k,).
        levers: ``c`` of each, shape (k, 3).
        radius: Zero for a point, negative for what is around a hollow.
    """

    owners: tuple[tuple[Body | None, int], ...]
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

    owners: tuple[tuple[Body | None, int], tuple[Body | None, int]]
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

    owner: tuple[Body | None, int]
    origin: Array
    normal: Array


class Polyhedron(NamedTuple):
    """A convex polyhedron.

    Attributes:
        owner: Body and node of the frame that it is fixed to; ``None``: ground.
        corners: In this frame, shape (n, 3).
    """

    owner: tuple[Body | None, int]
    corners: Array


def initial_frame(body: Body | None, node: int) -> Array:
    """Of a node or of ground, shape (4, 3)."""
    return np.vstack([np.zeros(3), np.eye(3)]) if body is None else body.frames[node]


def _owner(point: Point) -> tuple[Body | None, int]:
    return point.body, point.node


def fixed_ball(point: Point, radius: float, offset: Array | None = None) -> Ball:
    """A ball about a point, or about a place that has the ``offset`` (3,) in its frame."""
    H = initial_frame(*_owner(point))
    place = point.position if offset is None else point.frame[0] + offset @ point.frame[1:]
    lever = H[1:] @ (place - H[0])
    return Ball((_owner(point),), np.ones(1), lever[np.newaxis], radius)


def polyhedron_at(point: Point, places: Sequence[Array]) -> Polyhedron:
    """A polyhedron that is fixed to a point, by the initial places of its corners (3,)."""
    H = initial_frame(*_owner(point))
    return Polyhedron(_owner(point), (np.array(places) - H[0]) @ H[1:].T)


class Surface(ABC):
    """What may touch.

    Attributes:
        whole: Whether its balls are all of it, and not the corners of something between them.
    """

    whole = True

    @property
    @abstractmethod
    def points(self) -> Sequence[Point]:
        """What it is fixed to."""

    def balls(self) -> list[Ball]:
        """Its points; default: none."""
        return []

    def pieces(self) -> Sequence[Piece]:
        """Its lines; default: none."""
        return []

    def faces(self) -> list[Face]:
        """Its planes; default: none."""
        return []

    def polyhedron(self) -> Polyhedron | None:
        """All of it, if it is a convex polyhedron; default: it is none."""
        return None

    @property
    def label(self) -> str:
        """For messages."""
        names = dict.fromkeys(p.label if p.is_ground else _name(p) for p in self.points)
        return f"{type(self).__name__} on {', '.join(names)}"

    def check(self) -> None:
        """Refuse what it cannot be fixed to.

        Raises:
            ValueError: A node has no frame, or a place is no node.
        """
        for point in self.points:
            require_node(point, self.label)
            if point.body is not None and not (self.turns_alike and _is_place(point)):
                point.body.require_frames(self.label)

    @property
    def turns_alike(self) -> bool:
        """Whether it is the same however its points turn, so that these need no axes."""
        return False


def _is_place(point: Point) -> bool:
    """Whether a point is a node that has a place and nothing else."""
    return point.body is not None and int(point.body.node_kinds[point.node]) == NodeKind.POINT


def _name(point: Point) -> str:
    assert point.body is not None
    return point.body.label


@dataclass(frozen=True, eq=False)
class Plane(Surface):
    """A plane that is fixed to ground, a rigid body or a node, with all that is behind it.

    Attributes:
        point: What it is fixed to.
        normal: Out of what is solid, global components in the beginning, of any length.
        at: A place in the plane, global components in the beginning; default: the point.
    """

    point: Point
    normal: npt.ArrayLike
    at: npt.ArrayLike | None = None

    def __post_init__(self) -> None:
        """Raise ``TypeError`` or ``ValueError`` for what is no point, direction or place."""
        require_point(self.point, "Plane: point")
        direction(self.normal, "Plane: normal")
        if self.at is not None:
            vector(self.at, 3, "Plane: at")

    @property
    def points(self) -> Sequence[Point]:
        """One."""
        return [self.point]

    def faces(self) -> list[Face]:
        """Itself."""
        H, normal = initial_frame(*_owner(self.point)), direction(self.normal, "Plane: normal")
        place = self.point.position if self.at is None else vector(self.at, 3, "Plane: at")
        return [Face(_owner(self.point), H[1:] @ (place - H[0]), H[1:] @ normal)]


@dataclass(frozen=True, eq=False)
class Sphere(Surface):
    """A ball about a point: a body, the round end of a beam; or what is around a hollow.

    Attributes:
        point: Its centre.
        radius: Of the ball or of the hollow.
        hollow: Whether what touches it is within.
    """

    point: Point
    radius: float
    hollow: bool = False

    def __post_init__(self) -> None:
        """Raise ``TypeError`` or ``ValueError`` for what is no point or radius."""
        require_point(self.point, "Sphere: point")
        positive(self.radius, "Sphere: radius")
        flag(self.hollow, "Sphere: hollow")

    @property
    def points(self) -> Sequence[Point]:
        """One."""
        return [self.point]

    @property
    def turns_alike(self) -> bool:
        """Yes: it is a ball about a point."""
        return True

    def balls(self) -> list[Ball]:
        """Itself."""
        return [fixed_ball(self.point, -self.radius if self.hollow else self.radius)]


@dataclass(frozen=True, eq=False)
class Vertices(Surface):
    """Points, or balls of one radius about them: corners of a body, nodes of a beam, a pile.

    Attributes:
        of: The points.
        radius: Of each.
    """

    of: Sequence[Point]
    radius: float = 0.0

    def __post_init__(self) -> None:
        """Raise ``TypeError`` or ``ValueError`` for what are no points, or no radius."""
        instance(self.of, Sequence, "Vertices: of", "points in a list")
        for point in self.of:
            require_point(point, "Vertices: of")
        if not len(self.of):
            raise ValueError("Vertices: of must have a point, got none")
        if number(self.radius, "Vertices: radius") < 0.0:
            raise ValueError(f"Vertices: radius must not be negative, got {self.radius}")

    @property
    def points(self) -> Sequence[Point]:
        """All of them."""
        return self.of

    @property
    def turns_alike(self) -> bool:
        """Yes: they are points, or balls about them."""
        return True

    def balls(self) -> list[Ball]:
        """One about each."""
        return [fixed_ball(point, self.radius) for point in self.of]


@dataclass(frozen=True, eq=False)
class Box(Surface):
    """A box with the axes of a point's frame about it, or a room of that shape.

    Attributes:
        point: In the middle.
        edges: Lengths along the axes, shape (3,).
        inside: Whether what touches it is within.
    """

    point: Point
    edges: npt.ArrayLike
    inside: bool = False

    whole = False

    def __post_init__(self) -> None:
        """Raise ``TypeError`` or ``ValueError`` for what is no point or box."""
        require_point(self.point, "Box: point")
        given = numbers(self.edges, "Box: edges")
        if given.shape != (3,) or not np.isfinite(given).all() or not (given > 0.0).all():
            raise ValueError(f"Box: edges must be 3 positive finite lengths, got {self.edges!r}")
        flag(self.inside, "Box: inside")

    @property
    def points(self) -> Sequence[Point]:
        """One."""
        return [self.point]

    @property
    def _half(self) -> Array:
        return 0.5 * numbers(self.edges, "Box: edges")

    def balls(self) -> list[Ball]:
        """Its corners."""
        if self.inside:
            return []
        signs = product((-1.0, 1.0), repeat=3)
        return [fixed_ball(self.point, 0.0, self._half * np.array(sign)) for sign in signs]

    def polyhedron(self) -> Polyhedron | None:
        """The box, if nothing is within it."""
        return (
            None
            if self.inside
            else polyhedron_at(self.point, [ball.place for ball in self.balls()])
        )

    def faces(self) -> list[Face]:
        """Six, whose normals point inwards."""
        if not self.inside:
            return []
        H, frame = initial_frame(*_owner(self.point)), self.point.frame
        found = []
        for k, sign in product(range(3), (-1.0, 1.0)):
            out = sign * frame[1 + k]
            place = frame[0] + self._half[k] * out
            found.append(Face(_owner(self.point), H[1:] @ (place - H[0]), -(H[1:] @ out)))
        return found
