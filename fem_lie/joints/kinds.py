"""Types of joints; each selects the components of the relative motion ``(Δ, Q)`` that vanish.

A new joint of this kind is a new class with its selection; see
:mod:`fem_lie.joints.equations.terms`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, number
from fem_lie.joints.connection import Coordinate, rows
from fem_lie.joints.equations import functions as joint_functions
from fem_lie.joints.joint import TURN, Joint

_COINCIDE = ({0: 1.0}, {1: 1.0}, {2: 1.0})
_SAME_AXIS = ({8: -1.0}, {5: 1.0})  # −Q₂₃ = 0, Q₁₃ = 0: moments about e₁ and e₂ of A
_NO_TURN = ({10: 0.5, 8: -0.5}, {5: 0.5, 9: -0.5}, {6: 0.5, 4: -0.5})  # axial(skew Q)
_ON_AXIS = ({0: 1.0}, {1: 1.0})


class _Turning(Joint):
    """A joint with a free rotation about its axis."""

    @property
    def angle(self) -> Coordinate:
        """Rotation of ``b`` relative to ``a`` about the axis, rad, unwrapped, initially zero."""
        return self._angle("angle", TURN)


class _Gliding(Joint):
    """A joint with a free displacement along its axis."""

    @property
    def displacement(self) -> Coordinate:
        """Displacement of ``b`` relative to ``a`` along the axis, initially zero."""
        return self._linear("displacement", 2)


class Fixed(Joint):
    """Rigid connection: no relative displacement or rotation.

    Example:
        >>> wheel = fl.RigidBody(2.0, (0.1, 0.1, 0.2), position=(1, 0, 0))
        >>> joint = fl.joints.Fixed(fl.ground(), wheel.point("centre"))
        >>> joint.selection.shape[0]
        6
    """

    selection = rows(*_COINCIDE, *_NO_TURN)
    reversible = True


class Spherical(Joint):
    """Ball joint: the two points coincide, rotations are free.

    Example:
        >>> wheel = fl.RigidBody(2.0, (0.1, 0.1, 0.2), position=(1, 0, 0))
        >>> joint = fl.joints.Spherical(fl.ground(), wheel.point("centre"), at=(0, 0, 0))
        >>> joint.selection.shape[0]
        3
    """

    selection = rows(*_COINCIDE)
    reversible = True

    def slips(self) -> tuple[Coordinate, ...]:
        """Rotations about the three axes of ``b``."""
        spin = joint_functions.SPIN
        return tuple(self._function(f"rotation {k + 1}", spin + k) for k in range(3))


class InPlane(Joint):
    """Point ``b`` stays in the plane through ``a`` whose normal ``axis`` is fixed to ``a``.

    Both coincide in the initial configuration. With ground as ``a``: no displacement of ``b`` along
    ``axis``.

    Example:
        >>> wheel = fl.RigidBody(2.0, (0.1, 0.1, 0.2), position=(1, 0, 0))
        >>> joint = fl.joints.InPlane(fl.ground(), wheel.point("centre"), axis=(0, 0, 1))
        >>> joint.selection.shape[0]
        1
    """

    selection = rows({2: 1.0})


class Revolute(_Turning):
    """Hinge: common point and common axis e₃, rotation about it is free.

    Example:
        >>> wheel = fl.RigidBody(2.0, (0.1, 0.1, 0.2), position=(1, 0, 0))
        >>> scene = fl.Scene()
        >>> _ = scene.add(wheel)
        >>> joint = scene.add(fl.joints.Revolute(fl.ground(), wheel.point("centre"), axis=(0, 0,
        ...     1)))
        >>> _ = scene.add(fl.joints.Drive(joint.angle, lambda t: 2.0 * t))
        >>> len(scene.joints), len(scene.connections)
        (1, 1)
    """

    selection = rows(*_COINCIDE, *_SAME_AXIS)
    reversible = True

    def coordinates(self) -> tuple[Coordinate, ...]:
        """The angle."""
        return (self.angle,)


class Prismatic(_Gliding):
    """Slider: displacement along the common axis e₃ is free, rotations are locked.

    Example:
        >>> wheel = fl.RigidBody(2.0, (0.1, 0.1, 0.2), position=(1, 0, 0))
        >>> joint = fl.joints.Prismatic(fl.ground(), wheel.point("centre"), axis=(1, 0, 0))
        >>> len(joint.coordinates())
        1
    """

    selection = rows(*_ON_AXIS, *_NO_TURN)
    reversible = True

    def coordinates(self) -> tuple[Coordinate, ...]:
        """The displacement."""
        return (self.displacement,)


class Cylindrical(_Turning, _Gliding):
    """Cylindrical joint: displacement along and rotation about the common axis e₃ are free.

    Example:
        >>> wheel = fl.RigidBody(2.0, (0.1, 0.1, 0.2), position=(1, 0, 0))
        >>> joint = fl.joints.Cylindrical(fl.ground(), wheel.point("centre"), axis=(1, 0, 0))
        >>> len(joint.coordinates())
        2
    """

    selection = rows(*_ON_AXIS, *_SAME_AXIS)
    reversible = True

    def coordinates(self) -> tuple[Coordinate, ...]:
        """Angle and displacement."""
        return self.angle, self.displacement


@dataclass(frozen=True, eq=False)
class Screw(_Turning, _Gliding):
    """Screw joint: displacement along the axis e₃ is proportional to the rotation about it.

    Attributes:
        pitch: Displacement of ``b`` per turn, positive for a right-handed thread.

    Example:
        >>> wheel = fl.RigidBody(2.0, (0.1, 0.1, 0.2), position=(1, 0, 0))
        >>> joint = fl.joints.Screw(fl.ground(), wheel.point("centre"), axis=(1, 0, 0), pitch=0.01)
        >>> joint.pitch
        0.01
    """

    pitch: float = 0.0

    selection = rows(*_ON_AXIS, *_SAME_AXIS, {2: 1.0})
    reversible = True

    @property
    def functions(self) -> Array:
        """Factors of the last constraint, ``Δ₃ − pitch φ/2π = 0``."""
        factors = np.zeros((5, joint_functions.COUNT))
        factors[4, joint_functions.ANGLE] = -self.pitch / (2.0 * np.pi)
        return factors

    def check(self) -> None:
        """Raise ``ValueError`` if the joint is invalid, or its pitch is zero or not finite."""
        super().check()
        if number(self.pitch, f"{self.label}: pitch") == 0.0:
            raise ValueError(
                f"{self.label}: pitch must be a length per turn, not zero, got {self.pitch}"
            )

    def coordinates(self) -> tuple[Coordinate, ...]:
        """Angle and displacement."""
        return self.angle, self.displacement


@dataclass(frozen=True, eq=False)
class _WithSecondAxis(Joint):
    second: npt.ArrayLike | None = None

    def _require_second(self, why: str) -> None:
        """Raise ``ValueError`` without a second axis: a default would depend on global axes."""
        if self.second is None:
            raise ValueError(
                f"{self.label}: expected second=..., a direction across the axis {self.axis}, "
                f"got none: {why}"
            )

    def _first_axis(self, e3: Array) -> Array:
        if self.second is None:
            return super()._first_axis(e3)
        e1 = self._direction(self.second, "second axis")
        if abs(e1 @ e3) > 1e-9:
            raise ValueError(
                f"{self.label}: the second axis must be across the axis {self.axis}, "
                f"got {self.second}"
            )
        return e1


class Planar(_WithSecondAxis, _Turning):
    """Planar joint: displacements perpendicular to the axis e₃ and rotation about it are free.

    Attributes:
        second: Direction of the first displacement, fixed to ``a``; default: arbitrary, which
            suffices unless a spring or drive acts along one of the displacements.

    Example:
        >>> wheel = fl.RigidBody(2.0, (0.1, 0.1, 0.2), position=(1, 0, 0))
        >>> joint = fl.joints.Planar(fl.ground(), wheel.point("centre"), second=(1, 0, 0))
        >>> joint.selection.shape[0]
        3
    """

    selection = rows({2: 1.0}, *_SAME_AXIS)

    @property
    def displacements(self) -> tuple[Coordinate, Coordinate]:
        """Displacements of ``b`` along e₁ = ``second`` and e₂ of ``a``, initially zero.

        Raises:
            ValueError: There is no second axis, so the directions are undefined.
        """
        self._require_second("the directions of the two displacements are along and across it")
        return self._displacements()

    def _displacements(self) -> tuple[Coordinate, Coordinate]:
        return self._linear("displacement 1", 0), self._linear("displacement 2", 1)

    def coordinates(self) -> tuple[Coordinate, ...]:
        """Angle and the two displacements."""
        return (self.angle, *self._displacements())


class Universal(_WithSecondAxis):
    """Cardan joint: common point; ``axis``, fixed to ``a``, stays perpendicular to ``second``.

    Initially the joint constrains the rotation about ``axis × second`` only.

    Attributes:
        second: Direction of the axis fixed to ``b``, perpendicular to ``axis``; required.

    Example:
        >>> wheel = fl.RigidBody(2.0, (0.1, 0.1, 0.2), position=(1, 0, 0))
        >>> joint = fl.joints.Universal(fl.ground(), wheel.point("centre"), second=(1, 0, 0))
        >>> joint.selection.shape[0]
        4
    """

    selection = rows(*_COINCIDE, {9: 1.0})

    def check(self) -> None:
        """Raise ``ValueError`` if the joint is invalid or has no second axis."""
        super().check()
        self._require_second("the joint constrains the rotation about axis × second")

    @property
    def angle(self) -> Coordinate:
        """Rotation of the cross relative to ``a`` about ``axis``, rad, initially zero."""
        return self._angle("angle", rows({6: 1.0}, {3: 1.0}))

    @property
    def second_angle(self) -> Coordinate:
        """Rotation of ``b`` relative to the cross about ``second``, rad, initially zero."""
        return self._angle("second angle", rows({10: 1.0}, {11: 1.0}))

    def coordinates(self) -> tuple[Coordinate, ...]:
        """The two angles."""
        return self.angle, self.second_angle


@dataclass(frozen=True, eq=False)
class Distance(Joint):
    """Distance of two points as a coordinate for springs, drives and results; no constraint.

    A :class:`~fem_lie.joints.Drive` of its length without a function is a massless rigid rod.

    Attributes:
        at: Position of the end fixed to ``a`` in the initial configuration; default: point ``a``.
        to: Position of the end fixed to ``b`` in the initial configuration; default: point ``b``.

    Example:
        >>> wheel = fl.RigidBody(2.0, (0.1, 0.1, 0.2), position=(1, 0, 0))
        >>> scene = fl.Scene()
        >>> _ = scene.add(wheel)
        >>> joint = scene.add(fl.joints.Distance(fl.ground(), wheel.point("centre"), at=(0, 0, 0)))
        >>> _ = scene.add(fl.joints.Drive(joint.length))  # a massless rod
        >>> len(scene.connections)
        1
    """

    to: npt.ArrayLike | None = None

    selection = rows()
    reversible = True

    @property
    def length(self) -> Coordinate:
        """Distance of the two ends."""
        return self._function("length", joint_functions.DISTANCE)

    def coordinates(self) -> tuple[Coordinate, ...]:
        """The length."""
        return (self.length,)

    def frames(self) -> tuple[Array, Array]:
        """Frames at the two ends, along global axes.

        Raises:
            ValueError: The ends coincide.
        """
        start = self.a.position if self.at is None else self._given_position(self.at, "at")
        end = self.b.position if self.to is None else self._given_position(self.to, "to")
        if not np.linalg.norm(end - start) > 1e-12 * max(self.a.size, self.b.size):
            raise ValueError(
                f"{self.label}: both ends are at {start}; a distance needs two different positions"
            )
        return np.vstack([start, np.eye(3)]), np.vstack([end, np.eye(3)])

    def check(self) -> None:
        """Raise ``ValueError`` if the ends coincide or both points are ground."""
        if self.a.is_ground and self.b.is_ground:
            raise ValueError(f"{self.label}: both points are ground")
        self.frames()
