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
    ContactSurface,
    Face,
    HollowSurface,
    Owner,
    PlaneSurface,
    PointSurface,
    PolyhedralSurface,
    Polyhedron,
    fixed_ball,
    initial_frame,
    owner_of,
    polyhedron_at,
)


@dataclass(frozen=True, eq=False)
class Plane(PlaneSurface):
    """Contact surface: a half-space bounded by a plane, fixed to ground, a rigid body or a node.

    Attributes:
        point: The point that the plane is fixed to.
        normal: Normal out of the solid half-space, initial global components, of any length.
        at: A point in the plane, initial global coordinates; default: the position of ``point``.
    """

    point: Point
    normal: npt.ArrayLike
    at: npt.ArrayLike | None = None

    def __post_init__(self) -> None:
        """Raise ``TypeError`` or ``ValueError`` if an argument has a wrong type or value."""
        require_point(self.point, "Plane: point")
        direction(self.normal, "Plane: normal")
        if self.at is not None:
            vector(self.at, 3, "Plane: at")

    @property
    def points(self) -> Sequence[Point]:
        """The point that the plane is fixed to."""
        return [self.point]

    def faces(self) -> list[Face]:
        """The plane."""
        H, normal = initial_frame(*owner_of(self.point)), direction(self.normal, "Plane: normal")
        position = self.point.position if self.at is None else vector(self.at, 3, "Plane: at")
        return [Face(owner_of(self.point), H[1:] @ (position - H[0]), H[1:] @ normal)]


@dataclass(frozen=True, eq=False)
class Sphere(PointSurface):
    """Contact surface: a ball about a point, or a hollow sphere about it.

    Attributes:
        point: Centre.
        radius: Radius of the ball or of the hollow.
        hollow: Whether the material is outside, so that other bodies touch from the inside.
    """

    point: Point
    radius: float
    hollow: bool = False

    def __post_init__(self) -> None:
        """Raise ``TypeError`` or ``ValueError`` if an argument has a wrong type or value."""
        require_point(self.point, "Sphere: point")
        positive(self.radius, "Sphere: radius")
        flag(self.hollow, "Sphere: hollow")

    @property
    def points(self) -> Sequence[Point]:
        """The centre."""
        return [self.point]

    @property
    def kind(self) -> type[ContactSurface]:
        """A hollow sphere, or the class of a ball."""
        return HollowSurface if self.hollow else type(self)

    @property
    def rotation_invariant(self) -> bool:
        """True: rotations of the point do not change a ball about it."""
        return True

    def balls(self) -> list[Ball]:
        """The ball."""
        return [fixed_ball(self.point, -self.radius if self.hollow else self.radius)]


@dataclass(frozen=True, eq=False)
class Vertices(PointSurface):
    """Contact surface: points, or balls of one radius, such as corners of a body.

    Attributes:
        of: The points, such as corners of a rigid body or nodes of a beam.
        radius: Radius of all balls; zero for points.
    """

    of: Sequence[Point]
    radius: float = 0.0

    def __post_init__(self) -> None:
        """Raise ``TypeError`` or ``ValueError`` if an argument has a wrong type or value."""
        instance(self.of, Sequence, "Vertices: of", "points in a list")
        for point in self.of:
            require_point(point, "Vertices: of")
        if not len(self.of):
            raise ValueError("Vertices: of: expected at least one point, got none")
        if number(self.radius, "Vertices: radius") < 0.0:
            raise ValueError(f"Vertices: radius must not be negative, got {self.radius}")

    @property
    def points(self) -> Sequence[Point]:
        """All points."""
        return self.of

    @property
    def rotation_invariant(self) -> bool:
        """True: rotations of the points do not change balls about them."""
        return True

    def balls(self) -> list[Ball]:
        """One ball about each point."""
        return [fixed_ball(point, self.radius) for point in self.of]


@dataclass(frozen=True, eq=False)
class Box(PolyhedralSurface, PlaneSurface):
    """Contact surface: a box about a point, along the axes of its frame; or its inside.

    Attributes:
        point: Centre.
        edges: Lengths of the edges along the axes, shape (3,).
        inside: Whether the material is outside, so that other bodies touch from the inside.
    """

    point: Point
    edges: npt.ArrayLike
    inside: bool = False

    def __post_init__(self) -> None:
        """Raise ``TypeError`` or ``ValueError`` if an argument has a wrong type or value."""
        require_point(self.point, "Box: point")
        given = numbers(self.edges, "Box: edges")
        if given.shape != (3,) or not np.isfinite(given).all() or not (given > 0.0).all():
            raise ValueError(f"Box: edges must be 3 positive finite lengths, got {self.edges!r}")
        flag(self.inside, "Box: inside")

    @property
    def points(self) -> Sequence[Point]:
        """The centre."""
        return [self.point]

    @property
    def _half(self) -> Array:
        return 0.5 * numbers(self.edges, "Box: edges")

    @property
    def kind(self) -> type[ContactSurface]:
        """Six planes if other bodies are inside, else a polyhedron."""
        return PlaneSurface if self.inside else PolyhedralSurface

    def moments(self, friction: bool) -> Sequence[Owner]:
        """Frames about which contact forces have a moment."""
        return self.kind.moments(self, friction)

    def balls(self) -> list[Ball]:
        """The vertices."""
        signs = product((-1.0, 1.0), repeat=3)
        return [fixed_ball(self.point, 0.0, self._half * np.array(sign)) for sign in signs]

    def polyhedron(self) -> Polyhedron:
        """The box as a polyhedron."""
        return polyhedron_at(self.point, [ball.position for ball in self.balls()])

    def faces(self) -> list[Face]:
        """Six planes with normals that point inwards."""
        H, frame = initial_frame(*owner_of(self.point)), self.point.frame
        found = []
        for k, sign in product(range(3), (-1.0, 1.0)):
            out = sign * frame[1 + k]
            position = frame[0] + self._half[k] * out
            found.append(Face(owner_of(self.point), H[1:] @ (position - H[0]), -(H[1:] @ out)))
        return found
