"""Limits of the coordinates of joints: stops with restitution."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fem_lie import _arrays
from fem_lie._arrays import Array
from fem_lie.joints.connection import Bounds, Connection, ConstraintDefinition, Coordinate


@dataclass(frozen=True, eq=False)
class Limit(Connection):
    """Stops at one or both ends of the range of a coordinate: a unilateral constraint.

    An impact on a stop is an event: the coordinate's rate ``w`` becomes ``−e w`` by an impulse in
    the joint, which conserves momentum. What would leave the stop and return within one step rests
    on it as a constraint, until its force would pull: rebounds without end, whose flights become
    shorter and shorter, end at rest.
    Limits that are closed take part in the impacts of others as constraints.

    :class:`~fem_lie.GeneralisedAlpha` with steps of any kind has limits; other schemes refuse them.
    ``result.joint_force(limit)`` is the force of the stops between impacts, and ``result.steps``
    has times and lost energy of the impacts.

    Attributes:
        coordinate: Coordinate of a joint: ``joint.angle``, ``joint.displacement``,
            ``Distance(…).length``.
        lower: Smallest value, rad or a length; default: no stop there.
        upper: Largest value; default: no stop there.
        restitution: Coefficient of restitution ``e``, from 0 to 1.
        name: Name in messages and results; default: from the coordinate.

    Example:
        >>> ball = fl.RigidBody(1.0, (0.1, 0.1, 0.1), position=(0, 0, 1.0))
        >>> scene = fl.Scene(gravity=(0, 0, -10.0))
        >>> _ = scene.add(ball)
        >>> rail = fl.joints.Prismatic(fl.ground(), ball.point("centre"), axis=(0, 0, 1))
        >>> _ = scene.add(rail)
        >>> _ = scene.add(fl.joints.Limit(rail.displacement, lower=-1.0, restitution=0.5))
        >>> result = fl.GeneralisedAlpha().run(scene, duration=1.2, step=0.01)
        >>> print(result.steps.event_times.round(6), result.steps.event_losses.round(3))
        [0.447214 0.894427 1.118034] [7.5   1.875 0.469]
    """

    coordinate: Coordinate
    lower: float | None = None
    upper: float | None = None
    restitution: float = 0.0
    name: str = ""
    active: bool = field(default=False, init=False)

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if an argument has a wrong type."""
        Coordinate.require(self.coordinate, "Limit: coordinate")
        _arrays.text(self.name, "Limit: name")

    @property
    def label(self) -> str:
        """Name in messages and results."""
        return self.name or f"Limit({self.coordinate.label})"

    @property
    def bounds(self) -> Bounds:
        """Range of the coordinate and restitution."""
        given = {"lower": self.lower, "upper": self.upper}
        known = {
            what: _arrays.number(value, f"{self.label}: {what}")
            for what, value in given.items()
            if value is not None
        }
        lower, upper = known.get("lower", -np.inf), known.get("upper", np.inf)
        restitution = _arrays.number(self.restitution, f"{self.label}: restitution")
        unit = 1.0 if self.coordinate.angular else self.coordinate.size
        return Bounds(lower, upper, restitution, unit)

    def check(self) -> None:
        """Raise ``ValueError`` if the range is empty, or does not contain the initial value."""
        lower, upper, restitution, unit = self.bounds
        if not (np.isfinite(lower) or np.isfinite(upper)):
            raise ValueError(f"{self.label}: expected lower, upper or both")
        if not lower < upper:
            raise ValueError(f"{self.label}: expected lower < upper, got {lower:g} and {upper:g}")
        if not 0.0 <= restitution <= 1.0:
            raise ValueError(
                f"{self.label}: expected a restitution from 0 to 1, got {restitution:g}"
            )
        start, slack = self.coordinate.start(), 1e-9 * unit
        if not lower - slack <= start <= upper + slack:
            raise ValueError(
                f"{self.label}: expected an initial value between {lower:g} and {upper:g}, got "
                f"{start:g}"
            )

    def definitions(self) -> list[ConstraintDefinition]:
        """Definition of the coordinate as a constraint."""
        return [self.coordinate.as_row(0)]

    @property
    def size(self) -> int:
        """Number of constraints: 1."""
        return 1

    @property
    def holds(self) -> bool:
        """True: at a stop it keeps the present coordinate."""
        return True

    @property
    def fingerprint(self) -> Array:
        """Range, restitution."""
        return np.array(self.bounds)

    def coordinates(self) -> tuple[Coordinate, ...]:
        """The limited coordinate."""
        return (self.coordinate,)
