"""Forces of users along coordinates of joints or between two points."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fem_lie import _arrays
from fem_lie._arrays import Array
from fem_lie.bodies.body import Point
from fem_lie.joints.connection import Connection, ConstraintDefinition, Coordinate
from fem_lie.joints.kinds import Distance
from fem_lie.joints.laws import Derivatives, Force, Law, Potential, PythonLaw, checked, sampled


@dataclass(frozen=True, eq=False)
class ForceLaw(Connection):
    """Force along a coordinate, or between two points, as a function of time, coordinate and rate.

    A positive force opposes an increase of the coordinate, like that of a spring: between two
    points it pulls. ``Spring(q, k, c, rest=q₀)`` is ``ForceLaw(q, lambda t, q, rate: k * (q − q₀) +
    c * rate)``.

    :class:`~fem_lie.GeneralisedAlpha` and statics take every law; in statics ``t`` is the load
    factor and the rate is zero. Other schemes take laws with a potential, whose work over a step is
    its change, and refuse the rest by name.

    Attributes:
        coordinate: Coordinate of a joint, or two points, between which it acts along their
            distance.
        law: Function ``law(t, q, rate)`` that returns a force, or a moment for angles; or a law
            compiled by :func:`~fem_lie.loads.compiled_law`; or a
            :class:`~fem_lie.loads.SpringTable`, :class:`~fem_lie.loads.TensionOnly` or
            :class:`~fem_lie.loads.CompressionOnly`.
        derivatives: Function of the same arguments that returns ``∂F/∂q`` and ``∂F/∂rate``;
            default: derivatives by complex numbers.
        potential: Potential ``W(q)`` of a law that depends on ``q`` only, with ``F = dW/dq``.
        name: Name in messages and results; default: from the coordinate.

    Example:
        >>> wheel = fl.RigidBody(2.0, (0.1, 0.1, 0.2), position=(1, 0, 0))
        >>> scene = fl.Scene()
        >>> _ = scene.add(wheel)
        >>> joint = scene.add(fl.joints.Prismatic(fl.ground(), wheel.point("centre"), axis=(1, 0,
        ...     0)))
        >>> _ = scene.add(fl.loads.ForceLaw(joint.displacement, lambda t, q, rate: 50.0 * q**3))
        >>> len(scene.connections)
        1
    """

    coordinate: Coordinate | tuple[Point, Point]
    law: Force | Law
    derivatives: Derivatives | None = None
    potential: Potential | None = None
    name: str = ""

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if an argument has a wrong type."""
        if isinstance(self.coordinate, tuple) and not isinstance(self.coordinate, Coordinate):
            if len(self.coordinate) != 2:
                raise ValueError(
                    f"ForceLaw: coordinate must be a coordinate of a joint or two points, got "
                    f"{len(self.coordinate)} points"
                )
            for point in self.coordinate:
                _arrays.instance(point, Point, "ForceLaw: coordinate", "two points")
        else:
            Coordinate.require(self.coordinate, "ForceLaw: coordinate")
        _arrays.text(self.name, "ForceLaw: name")
        own = {"derivatives": self.derivatives, "potential": self.potential}
        for what, function in {"law": self.law, **own}.items():
            if not (callable(function) or (function is None and what != "law")):
                raise TypeError(
                    f"ForceLaw: {what} must be a function, got {_arrays.shown(function)}"
                )
        twice = [what for what, function in own.items() if function is not None]
        if isinstance(self.law, Law) and twice:
            raise ValueError(
                f"ForceLaw: a {type(self.law).__name__} has its own {twice[0]}; give them to "
                "compiled_law"
            )

    @property
    def along(self) -> Coordinate:
        """Coordinate along which the force acts."""
        # not stored: copies of this item on other ranks refer to parts of bodies
        if isinstance(self.coordinate, Coordinate):
            return self.coordinate
        return Distance(*self.coordinate).length

    @cached_property
    def force_law(self) -> Law:
        """The law as a callback."""
        if isinstance(self.law, Law):
            return self.law
        return PythonLaw(self.law, self.derivatives, self.potential)

    @property
    def label(self) -> str:
        """Name in messages and results."""
        return self.name or f"ForceLaw({self.along.label})"

    @property
    def _scale(self) -> float:
        return 1.0 if self.along.angular else self.along.size

    def check(self) -> None:
        """Raise an error if the law does not give numbers, or contradicts its derivatives."""
        checked(self.force_law, self.label, self.along.start(), self._scale)

    def definitions(self) -> list[ConstraintDefinition]:
        """Definition of the coordinate as a term without constraint."""
        return [self.along.as_row(-1)]

    @property
    def spring(self) -> tuple[float, float, float]:
        """Factors of the law and of its derivative in the rate, and the shift of its coordinate."""
        return 1.0, 0.0 if self.force_law.has_potential else 1.0, 0.0

    @property
    def fingerprint(self) -> Array:
        """Numbers that differ if the law does."""
        own = sampled(self.force_law, self.along.start(), self._scale)
        return np.concatenate([own, self.force_law.data])

    def coordinates(self) -> tuple[Coordinate, ...]:
        """The coordinate along which the force acts."""
        return (self.along,)
