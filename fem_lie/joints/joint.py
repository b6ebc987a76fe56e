"""The base of joints: two points, a place, an axis, and the selection of what is forbidden."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, direction, text, vector
from fem_lie.bodies.body import Point
from fem_lie.bodies.points import require_point
from fem_lie.joints.connection import NO_ANGLE, Connection, ConstraintDefinition, Coordinate, rows
from fem_lie.joints.equations import functions as joint_functions

_COINCIDENT = 1e-9
"""Distance of the two points over the size of their bodies, below which they are one place."""

TURN = rows({6: 1.0, 4: -1.0}, {3: 1.0, 7: 1.0})
"""Sine and cosine, times 1 + Q₃₃, of the rotation about the axis: Q₂₁ − Q₁₂, Q₁₁ + Q₂₂."""


@dataclass(frozen=True, eq=False)
class Joint(Connection):
    """What all joints have in common; use one of the subclasses.

    A subclass states its ``selection`` of ``(Δ, Q)``. If it says that it is ``reversible``, that
    is, that it forbids the same with the two sides exchanged, a side that does not move by itself
    becomes B, because the Jacobian on A's side of what touches ``Δ`` alone is constant in local
    frames.

    Attributes:
        a: A point of a body, or :func:`~fem_lie.bodies.points.ground`.
        b: A point of another body, or ground.
        at: Where the joint is in the initial configuration (global, length); default: where the
            two points coincide. Given, the points are joined to it by rigid links.
        axis: Direction of the joint's e₃ in the initial configuration, global components.
        name: How errors and results call it; default: class name and number.
    """

    a: Point
    b: Point
    at: npt.ArrayLike | None = None
    axis: npt.ArrayLike = (0.0, 0.0, 1.0)
    name: str = ""

    selection: ClassVar[Array]
    reversible: ClassVar[bool] = False
    turn: ClassVar[Array] = TURN

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if what it joins are no points."""
        require_point(self.a, f"{type(self).__name__}: a")
        require_point(self.b, f"{type(self).__name__}: b")
        text(self.name, f"{type(self).__name__}: name")

    @property
    def functions(self) -> Array:
        """Factors of angle, distance and tilt in each constraint, shape (m, 3)."""
        return np.zeros((len(self.selection), 3))

    @property
    def size(self) -> int:
        """Number of constraints."""
        return len(self.selection)

    @property
    def label(self) -> str:
        """Name for messages: the user's, or the class and what is joined."""
        return self.name or f"{type(self).__name__}({self.a.label}, {self.b.label})"

    def check(self) -> None:
        """Raise ``ValueError`` if place or axis are bad, or it joins a point to itself."""
        self.frame()
        if self.a.same(self.b):
            raise ValueError(f"{self.label} joins a point to itself")

    @property
    def points(self) -> list[Point]:
        """Both sides."""
        return [self.a, self.b]

    def definitions(self) -> list[ConstraintDefinition]:
        """One pair of frames with all constraints."""
        return [self._tie(self.selection, self.functions, range(self.size), self.turn)]

    def frame(self) -> Array:
        """The joint's frame in the initial configuration, shape (4, 3).

        Raises:
            ValueError: The points do not coincide and ``at`` is not given, or the axis is zero.
        """
        e3 = self._direction(self.axis, "axis")
        e1 = self._first_axis(e3)
        # one by one, as np.cross takes its time
        (a, b, c), (x, y, z) = e3, e1
        return np.array([self._place(), e1, (b * z - c * y, c * x - a * z, a * y - b * x), e3])

    def frames(self) -> tuple[Array, Array]:
        """Frames A and B in the initial configuration."""
        frame = self.frame()
        return frame, frame

    def _first_axis(self, e3: Array) -> Array:
        """Some direction across the axis."""
        k = int(np.argmin(np.abs(e3)))
        i, j, e1 = (k + 1) % 3, (k + 2) % 3, np.zeros(3)
        e1[i], e1[j] = -e3[j], e3[i]
        return np.asarray(e1 / np.linalg.norm(e1))

    def _direction(self, given: npt.ArrayLike, what: str) -> Array:
        return direction(given, f"{self.label}: {what}")

    def _tie(
        self, selection: Array, functions: Array, of: Sequence[int], angle: Array
    ) -> ConstraintDefinition:
        pair = self.frames()
        return ConstraintDefinition(
            self.a, self.b, pair, selection, functions, of, angle, self.reversible
        )

    def _linear(self, name: str, index: int) -> Coordinate:
        """A component of ``Δ``."""
        definition = self._tie(rows({index: 1.0}), np.zeros((1, 3)), (0,), NO_ANGLE)
        return Coordinate(definition, name, self)

    def _function(self, name: str, number: int, angle: Array = NO_ANGLE) -> Coordinate:
        """One of the functions."""
        factors = np.zeros((1, 3))
        factors[0, number] = 1.0
        return Coordinate(self._tie(np.zeros((1, 12)), factors, (0,), angle), name, self)

    def _angle(self, name: str, angle: Array) -> Coordinate:
        return self._function(name, joint_functions.ANGLE, angle)

    def _given_place(self, at: npt.ArrayLike, what: str) -> Array:
        return vector(at, 3, f"{self.label}: {what}")

    def _place(self) -> Array:
        if self.at is not None:
            return self._given_place(self.at, "at")
        moving = [point for point in (self.a, self.b) if not point.is_ground]
        if not moving:
            raise ValueError(f"{self.label}: both points are ground; a joint needs a body")
        places = [point.position for point in moving]
        size = max(point.size for point in moving)
        gap = np.linalg.norm(places[-1] - places[0])
        if gap > _COINCIDENT * size:
            middle = ", ".join(f"{x:.9g}" for x in 0.5 * (places[0] + places[-1]))
            raise ValueError(
                f"{self.label}: the points are {gap:g} apart, at {places[0]} and {places[-1]}, "
                f"more than {_COINCIDENT:g} of the size {size:g} of their bodies; let them "
                f"coincide, or give at=... to join them there by rigid links over any gap, such as "
                f"at=({middle})"
            )
        return places[0]
