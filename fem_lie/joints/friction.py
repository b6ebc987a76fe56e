"""Friction in joints, whose normal force is that of the joint itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fem_lie import _arrays
from fem_lie._arrays import Array
from fem_lie.joints.connection import (
    Connection,
    ConstraintDefinition,
    Coordinate,
    FrictionDefinition,
)
from fem_lie.joints.kinds import Cylindrical, Planar, Prismatic, Revolute, Screw, Spherical

if TYPE_CHECKING:
    from fem_lie.joints.joint import Joint

_WITH_BEARINGS = Prismatic | Revolute | Cylindrical
_WITH_SURFACES = _WITH_BEARINGS | Screw | Planar | Spherical


@dataclass(frozen=True, eq=False)
class JointFriction(Connection):
    """Coulomb friction, with Stribeck's effect on request, in a joint with surfaces that slide.

    The forces of the joint press its surfaces together: the normal force ``N`` is the preload, the
    norm of the force across the axis, and what a collar or key takes. A bearing with a ``length``
    takes force and moment at its two ends, each with its own norm; without one the moment across
    the axis causes no friction. The bearing is fixed to point ``b`` of the joint. The thread of a
    screw takes the force along the axis with the normal force of its lead angle, a ball joint the
    norm of the whole force, the pad of a planar joint the force along the normal.

    The force ``μ(s) N`` opposes the slip ``s``: the rate of displacement, radius times rate of
    rotation, or both as a vector: along the helix of a screw, in a plane together with radius times
    its rotation, of the angular velocity in a ball joint. A screw is self-locking, but for creep,
    if ``μ`` is above the tangent of its lead angle. The coefficient is regularised ::

        μ(s) = (μ + (μ₀ − μ) exp(−(s/s₁)²)) tanh(s/s₀),

    so that a joint at rest creeps at a fraction of ``s₀``, instead of sticking. Steps should
    resolve the passage through ``s₀``; for exact sticking switch a :class:`~fem_lie.joints.Drive`
    at events (``demos/stick_slip.py``).

    :class:`~fem_lie.GeneralisedAlpha` with steps of any kind takes friction, and its energy balance
    contains the loss; statics and vibrations take it at rest, where it is a damper. Other schemes
    refuse it by name.

    Attributes:
        joint: A :class:`~fem_lie.joints.Prismatic`, :class:`~fem_lie.joints.Revolute`,
            :class:`~fem_lie.joints.Cylindrical`, :class:`~fem_lie.joints.Screw`,
            :class:`~fem_lie.joints.Planar` or :class:`~fem_lie.joints.Spherical` joint.
        coefficient: Coefficient ``μ`` of kinetic friction.
        stiction_speed: Slip ``s₀`` below which friction fades, a length per time.
        static: Coefficient ``μ₀`` of static friction, at least ``μ``; default: ``μ``.
        stribeck_speed: Slip ``s₁`` over which it falls to ``μ``; required with ``static``.
        radius: Radius of the journal or ball, mean radius of the thread or of the plane surface,
            required where the joint rotates; of a slider: arm of the keys that take the moment
            about its axis, default: that moment causes no friction.
        length: Length of the bearing along the axis; default: force across the axis only. Plane
            surfaces and balls have none.
        collar: Mean radius of the collar that takes the force along the axis of a hinge; default:
            that force causes no friction.
        preload: Normal force that is always there.
        name: Name in messages and results; default: from the joint.

    Example:
        >>> block = fl.RigidBody(2.0, (0.1, 0.1, 0.1))
        >>> scene = fl.Scene(gravity=(9.81 * 0.6, 0, -9.81 * 0.8))
        >>> _ = scene.add(block)
        >>> plane = fl.joints.Prismatic(fl.ground(), block.point("centre"), axis=(1, 0, 0))
        >>> _ = scene.add(plane)
        >>> _ = scene.add(fl.joints.JointFriction(plane, 0.25, stiction_speed=1e-3))
        >>> result = fl.GeneralisedAlpha().run(scene, duration=1.0, step=0.001)
        >>> print(f"{result.velocities[-1, 0, 0] / (9.81 * (0.6 - 0.25 * 0.8)):.3f}")
        1.000
    """

    joint: Joint
    coefficient: float
    stiction_speed: float
    static: float | None = None
    stribeck_speed: float | None = None
    radius: float | None = None
    length: float | None = None
    collar: float | None = None
    preload: float = 0.0
    name: str = ""

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if an argument has a wrong type."""
        expected = (
            "a Prismatic, Revolute, Cylindrical, Screw, Planar or Spherical joint, which has "
            "surfaces that slide; a universal joint is two Revolutes"
        )
        _arrays.instance(self.joint, _WITH_SURFACES, "JointFriction: joint", expected)
        _arrays.text(self.name, "JointFriction: name")

    @property
    def label(self) -> str:
        """Name in messages and results."""
        return self.name or f"JointFriction({self.joint.label})"

    @property
    def _rotates(self) -> bool:
        return not isinstance(self.joint, Prismatic)

    def check(self) -> None:
        """Raise ``ValueError`` if a number is missing, out of its range or without effect."""
        self._check_ranges()
        both = self.static is None, self.stribeck_speed is None
        if both[0] != both[1]:
            raise ValueError(
                f"{self.label}: expected static and stribeck_speed together, got static="
                f"{self.static} and stribeck_speed={self.stribeck_speed}"
            )
        if self.static is not None and self.static < self.coefficient:
            raise ValueError(
                f"{self.label}: expected static ≥ coefficient = {self.coefficient:g}, got "
                f"{self.static:g}"
            )
        if self._rotates and self.radius is None:
            raise ValueError(
                f"{self.label}: expected radius=..., that of the journal, as the joint rotates"
            )
        if self.collar is not None and not isinstance(self.joint, Revolute):
            raise ValueError(
                f"{self.label}: expected collar with a Revolute joint, which takes forces along "
                f"its axis, got one with {type(self.joint).__name__}"
            )
        if self.length is not None and isinstance(self.joint, Planar | Spherical):
            raise ValueError(
                f"{self.label}: expected length with a joint that has a bearing, got one with "
                f"{type(self.joint).__name__}"
            )
        if not self.joint.active:
            raise ValueError(
                f"{self.label}: {self.joint.label} is not active: it has no forces that press its "
                "surfaces together"
            )

    def _check_ranges(self) -> None:
        """Raise ``ValueError`` if a number is negative, or zero where it is a divisor."""
        positive = ("stiction_speed", "stribeck_speed", "radius", "length", "collar")
        for what in (*positive, "coefficient", "static", "preload"):
            value = getattr(self, what)
            if value is None:
                continue
            found, zero = _arrays.number(value, f"{self.label}: {what}"), what not in positive
            if found < 0.0 or (found == 0.0 and not zero):
                sign = "≥" if zero else ">"
                raise ValueError(f"{self.label}: expected {what} {sign} 0, got {value}")

    @property
    def friction(self) -> FrictionDefinition:
        """The joint, and the data of :mod:`~fem_lie.joints.equations.friction`."""
        inverse = [0.0 if x is None else 1.0 / x for x in (self.stribeck_speed, self.length)]
        drop = 0.0 if self.static is None else self.static - self.coefficient
        radius = 1.0 if self.radius is None else self.radius
        collar = 0.0 if self.collar is None else self.collar / radius
        if isinstance(self.joint, Screw):
            # the normal force of a thread over its part along the axis
            collar = float(np.hypot(1.0, self.joint.pitch / (2.0 * np.pi * radius)))
        if isinstance(self.joint, Planar):
            collar = 1.0
        key = 0.0 if self._rotates or self.radius is None else 1.0 / radius
        law = [self.coefficient, drop, inverse[0], 1.0 / self.stiction_speed]
        ball = float(isinstance(self.joint, Spherical))
        bearing = [self.preload, inverse[1], collar, key, radius, ball]
        return FrictionDefinition(self.joint, np.array([*law, *bearing], dtype=np.float64))

    @property
    def fingerprint(self) -> Array:
        """Numbers of the law and the bearing."""
        return self.friction.data

    @property
    def spring(self) -> tuple[float, float, float]:
        """No stiffness, the factor of the force, no rest value."""
        return 0.0, 1.0, 0.0

    def definitions(self) -> list[ConstraintDefinition]:
        """Definition of the free coordinates as terms without constraint."""
        parts = [coordinate.definition for coordinate in self.joint.slips()]
        return [
            parts[0]._replace(
                selection=np.concatenate([each.selection for each in parts]),
                functions=np.concatenate([each.functions for each in parts]),
                rows=(-1,) * len(parts),
                angle=np.sum([each.angle for each in parts], axis=0),
            )
        ]

    def coordinates(self) -> tuple[Coordinate, ...]:
        """The free coordinates of the joint."""
        return self.joint.coordinates()
