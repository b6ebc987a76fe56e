"""State of a running scene, as conditions and actions of events see it."""

from __future__ import annotations

from typing import Protocol

from fem_lie._arrays import Array
from fem_lie.bodies.body import Point
from fem_lie.joints.connection import Connection


class State(Protocol):
    """State of a running scene, as conditions and actions of events see it.

    Attributes:
        time: The time.
    """

    time: float

    def position(self, point: Point | str) -> Array:
        """Position of a point, global components, shape (3,)."""

    def rotation(self, point: Point | str) -> Array:
        """Rotation of a point's frame, local to global, shape (3, 3)."""

    def velocity(self, point: Point | str) -> Array:
        """Velocity of a point (translation, rotation) in its local frame, shape (6,)."""

    def coordinate(self, joint: Connection | str, name: str | None = None) -> float:
        """Relative coordinate of a joint: an unwrapped angle in rad, or a length."""

    def rate(self, joint: Connection | str, name: str | None = None) -> float:
        """Rate of a relative coordinate."""
