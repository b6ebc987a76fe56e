"""A convex polyhedron as a surface that may touch."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, numbers
from fem_lie.bodies.body import Point
from fem_lie.bodies.points import require_point
from fem_lie.contact.convex.hulls import hull_of
from fem_lie.contact.sides.surfaces import (
    Ball,
    PolyhedralSurface,
    Polyhedron,
    fixed_ball,
    polyhedron_at,
)


@dataclass(frozen=True, eq=False)
class ConvexPolyhedron(PolyhedralSurface):
    """A convex polyhedron that is fixed to a point: the convex hull of its corners.

    Attributes:
        point: What it is fixed to.
        corners: In the axes of the point's frame, from the point, shape (n, 3), n ≥ 4; those within
            the hull of the others are left out.

    Example:
        >>> wedge = fl.RigidBody(1.0, (0.1, 0.1, 0.1), position=(0, 0, 1))
        >>> corners = [(x, y, 0) for x in (0, 1) for y in (0, 1)] + [(0, 0, 1), (0, 1, 1)]
        >>> fl.ConvexPolyhedron(wedge.point("centre"), corners).label
        'ConvexPolyhedron on RigidBody'
    """

    point: Point
    corners: npt.ArrayLike

    def __post_init__(self) -> None:
        """Raise ``TypeError`` or ``ValueError`` for what is no point or polyhedron."""
        require_point(self.point, "ConvexPolyhedron: point")
        given = numbers(self.corners, "ConvexPolyhedron: corners")
        if given.ndim != 2 or given.shape[1] != 3 or len(given) < 4 or not np.isfinite(given).all():
            raise ValueError(
                "ConvexPolyhedron: corners must be at least four finite points, shape (n, 3), got "
                f"shape {given.shape}"
            )
        try:
            hull_of(given)
        except ValueError as error:
            raise ValueError(f"ConvexPolyhedron: {error}") from error

    @property
    def points(self) -> Sequence[Point]:
        """One."""
        return [self.point]

    @cached_property
    def _offsets(self) -> Array:
        return hull_of(numbers(self.corners, "ConvexPolyhedron: corners")).corners

    def balls(self) -> list[Ball]:
        """Its corners, which touch planes."""
        return [fixed_ball(self.point, 0.0, offset) for offset in self._offsets]

    def polyhedron(self) -> Polyhedron:
        """Itself."""
        return polyhedron_at(self.point, [ball.place for ball in self.balls()])
