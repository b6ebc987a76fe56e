"""Planes, points, balls and boxes as contact surfaces, each fixed to a frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, direction, flag, instance, number, numbers, positive, vector
from fem_lie.bodies.body import Point
from fem_lie.bodies.points import require_point
from fem_lie.contact.sides.surfaces import (
    Ball,
    Face,
    Owner,
    PlaneSurface,
    PointSurface,
    PolyhedralSurface,
    Polyhedron,
    Surface,
    fixed_ball,
    initial_frame,
    owner_of,
    polyhedron_at,
)


@dataclass(frozen=True, eq=False)
class Plane(PlaneSurface):
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
        H, normal = initial_frame(*owner_of(self.point)), direction(self.normal, "Plane: normal")
        place = self.point.position if self.at is None else vector(self.at, 3, "Plane: at")
        return [Face(owner_of(self.point), H[1:] @ (place - H[0]), H[1:] @ normal)]


@dataclass(frozen=True, eq=False)
class Sphere(PointSurface):
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
class Vertices(PointSurface):
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
class Box(PolyhedralSurface, PlaneSurface):
    """A box with the axes of a point's frame about it, or a room of that shape.

    Attributes:
        point: In the middle.
        edges: Lengths along the axes, shape (3,).
        inside: Whether what touches it is within.
    """

    point: Point
    edges: npt.ArrayLike
    inside: bool = False

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

    @property
    def kind(self) -> type[Surface]:
        """Six planes, or a polyhedron."""
        return PlaneSurface if self.inside else PolyhedralSurface

    def moments(self, friction: bool) -> Sequence[Owner]:
        """See the base class."""
        return self.kind.moments(self, friction)

    def balls(self) -> list[Ball]:
        """Its vertices."""
        signs = product((-1.0, 1.0), repeat=3)
        return [fixed_ball(self.point, 0.0, self._half * np.array(sign)) for sign in signs]

    def polyhedron(self) -> Polyhedron:
        """The box."""
        return polyhedron_at(self.point, [ball.place for ball in self.balls()])

    def faces(self) -> list[Face]:
        """Six, whose normals point inwards."""
        H, frame = initial_frame(*owner_of(self.point)), self.point.frame
        found = []
        for k, sign in product(range(3), (-1.0, 1.0)):
            out = sign * frame[1 + k]
            place = frame[0] + self._half[k] * out
            found.append(Face(owner_of(self.point), H[1:] @ (place - H[0]), -(H[1:] @ out)))
        return found
