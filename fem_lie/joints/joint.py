"""Base class of joints: two points, a position, an axis, and the constrained relative motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import Enum
from functools import cached_property
from math import dist
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, direction, flag, text, vector
from fem_lie.bodies.body import Point
from fem_lie.bodies.points import require_point
from fem_lie.joints.connection import NO_ANGLE, Connection, ConstraintDefinition, Coordinate, rows
from fem_lie.joints.equations import functions as joint_functions

_COINCIDENT = 1e-9
"""Largest distance of coincident points, over the size of their bodies."""

TURN = rows({6: 1.0, 4: -1.0}, {3: 1.0, 7: 1.0})
"""Sine and cosine, times 1 + Q₃₃, of the rotation about the axis: Q₂₁ − Q₁₂, Q₁₁ + Q₂₂."""


class RedundantConstraints(Enum):
    """Treatment of redundant constraints, which follow from other constraints.

    ``REFUSE``: an error that names them. ``MINIMUM_NORM``: the solver keeps all of them; results
    report the joint forces with the least sum of squares, moments divided by the length of the
    model, among all that cause the same motion. Rigid-body mechanics does not determine these
    forces.
    """

    REFUSE = "refuse"
    MINIMUM_NORM = "minimum norm"


@dataclass(frozen=True, eq=False)
class Joint(Connection):
    """Base class of joints between two points.

    A subclass states its ``selection`` of ``(Δ, Q)``. A joint that imposes the same constraints
    with its two sides exchanged is ``reversible``: a side that does not move then becomes B,
    because terms of ``Δ`` alone have a constant Jacobian on side A in local frames.

    Attributes:
        a: A point of a body, or :func:`~fem_lie.bodies.points.ground`.
        b: A point of another body, or ground.
        at: Position of the joint in the initial configuration (global, length); default: where the
            two points coincide. If it is given, rigid links join the points to it.
        axis: Direction of the joint's e₃ in the initial configuration, global components.
        name: Name in messages and results; default: class name and number.
        active: Whether its constraints act from the start; :class:`~fem_lie.schemes.Lock` and
            :class:`~fem_lie.schemes.Release` switch them.
    """

    a: Point
    b: Point
    # a third position would be read as an axis by one, as a position by another
    at: npt.ArrayLike | None = field(default=None, kw_only=True)
    axis: npt.ArrayLike = field(default=(0.0, 0.0, 1.0), kw_only=True)
    name: str = field(default="", kw_only=True)
    active: bool = field(default=True, kw_only=True)

    selection: ClassVar[Array]
    reversible: ClassVar[bool] = False
    turn: ClassVar[Array] = TURN

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if an argument is not a point."""
        require_point(self.a, f"{type(self).__name__}: a")
        require_point(self.b, f"{type(self).__name__}: b")
        text(self.name, f"{type(self).__name__}: name")
        flag(self.active, f"{type(self).__name__}: active")

    @property
    def functions(self) -> Array:
        """Factors of the functions in each constraint, shape (m, 6)."""
        return np.zeros((len(self.selection), joint_functions.COUNT))

    @property
    def size(self) -> int:
        """Number of constraints."""
        return len(self.selection)

    @property
    def label(self) -> str:
        """Name in messages: that of the user, or the class and the points."""
        return self.name or f"{type(self).__name__}({self.a.label}, {self.b.label})"

    def check(self) -> None:
        """Raise ``ValueError`` if position or axis are invalid, or the points are the same."""
        self.frame()
        if self.a.same(self.b):
            raise ValueError(f"{self.label} joins a point to itself")

    @property
    def points(self) -> list[Point]:
        """Points a and b."""
        return [self.a, self.b]

    def definitions(self) -> list[ConstraintDefinition]:
        """One pair of frames with all constraints."""
        return [self._tie(self.selection, self.functions, range(self.size), self.turn)]

    def frame(self) -> Array:
        """Joint frame in the initial configuration, shape (4, 3).

        Raises:
            ValueError: The points do not coincide and ``at`` is not given, or the axis is zero.
        """
        found = np.empty((4, 3))
        found[1:] = self._axes  # first, as an error about the axis says more
        found[0] = self._position()
        return found

    @cached_property
    def _axes(self) -> Array:
        """Axes of the joint frame, which do not depend on the bodies, shape (3, 3)."""
        e3 = self._direction(self.axis, "axis")
        e1 = self._first_axis(e3)
        # written out: np.cross is slow for single vectors
        (a, b, c), (x, y, z) = e3, e1
        return np.array([e1, (b * z - c * y, c * x - a * z, a * y - b * x), e3])

    def frames(self) -> tuple[Array, Array]:
        """Frames A and B in the initial configuration."""
        frame = self.frame()
        return frame, frame

    def _first_axis(self, e3: Array) -> Array:
        """A direction perpendicular to the axis."""
        k = int(np.argmin(np.abs(e3)))
        i, j, e1 = (k + 1) % 3, (k + 2) % 3, np.zeros(3)
        e1[i], e1[j] = -e3[j], e3[i]
        return np.asarray(e1 / np.linalg.norm(e1))

    def _direction(self, given: npt.ArrayLike, what: str) -> Array:
        return direction(given, f"{self.label}: {what}")

    def slips(self) -> tuple[Coordinate, ...]:
        """Motions whose rates are the slip of its surfaces; default: its coordinates."""
        return self.coordinates()

    def _tie(
        self, selection: Array, functions: Array, of: Sequence[int], angle: Array
    ) -> ConstraintDefinition:
        pair = self.frames()
        return ConstraintDefinition(
            self.a, self.b, pair, selection, functions, of, angle, self.reversible
        )

    def _linear(self, name: str, index: int) -> Coordinate:
        """Coordinate that is a component of ``Δ``."""
        none = np.zeros((1, joint_functions.COUNT))
        definition = self._tie(rows({index: 1.0}), none, (0,), NO_ANGLE)
        return Coordinate(definition, name, self)

    def _function(self, name: str, number: int, angle: Array = NO_ANGLE) -> Coordinate:
        """Coordinate that is one of the functions."""
        factors = np.zeros((1, joint_functions.COUNT))
        factors[0, number] = 1.0
        return Coordinate(self._tie(np.zeros((1, 12)), factors, (0,), angle), name, self)

    def _angle(self, name: str, angle: Array) -> Coordinate:
        return self._function(name, joint_functions.ANGLE, angle)

    def _given_position(self, at: npt.ArrayLike, what: str) -> Array:
        return vector(at, 3, f"{self.label}: {what}")

    def _position(self) -> Array:
        if self.at is not None:
            return self._given_position(self.at, "at")
        moving = [point for point in (self.a, self.b) if not point.is_ground]
        if not moving:
            raise ValueError(f"{self.label}: both points are ground; a joint needs a body")
        placed = [point for point in (self.a, self.b) if not point.is_everywhere]
        positions = [point.position for point in placed]
        size = max(point.size for point in moving)
        gap = dist(positions[-1], positions[0])
        if gap > _COINCIDENT * size:
            middle = ", ".join(f"{x:.9g}" for x in 0.5 * (positions[0] + positions[-1]))
            raise ValueError(
                f"{self.label}: the points are {gap:g} apart, at {positions[0]} and "
                f"{positions[-1]}, more than {_COINCIDENT:g} of the size {size:g} of their "
                f"bodies; let them coincide, or give at=... to join them there by rigid links over "
                f"any gap, such as at=({middle})"
            )
        return positions[0]
