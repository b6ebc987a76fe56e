"""Kinds of joints: each is the selection of the relative motion ``(Δ, Q)`` that it forbids.

A new joint of this kind is a new class with that selection; see
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
    """Turns about its axis."""

    @property
    def angle(self) -> Coordinate:
        """Rotation of ``b`` against ``a`` about the axis, unwrapped, zero at the start, rad."""
        return self._angle("angle", TURN)


class _Gliding(Joint):
    """Glides along its axis."""

    @property
    def displacement(self) -> Coordinate:
        """Displacement of ``b`` against ``a`` along the axis, zero at the start."""
        return self._linear("displacement", 2)


class Fixed(Joint):
    """No relative motion.

    Example:
        >>> wheel = fl.RigidBody(2.0, (0.1, 0.1, 0.2), position=(1, 0, 0))
        >>> joint = fl.Fixed(fl.ground(), wheel.point("centre"))
        >>> joint.selection.shape[0]
        6
    """

    selection = rows(*_COINCIDE, *_NO_TURN)
    reversible = True


class Spherical(Joint):
    """Common point.

    Example:
        >>> wheel = fl.RigidBody(2.0, (0.1, 0.1, 0.2), position=(1, 0, 0))
        >>> joint = fl.Spherical(fl.ground(), wheel.point("centre"), at=(0, 0, 0))
        >>> joint.selection.shape[0]
        3
    """

    selection = rows(*_COINCIDE)
    reversible = True


class InPlane(Joint):
    """Point ``b`` stays in the plane through ``a`` with the normal ``axis`` fixed to ``a``.

    Both coincide in the initial configuration. With ground as ``a``: no displacement of ``b`` along
    ``axis``.

    Example:
        >>> wheel = fl.RigidBody(2.0, (0.1, 0.1, 0.2), position=(1, 0, 0))
        >>> joint = fl.InPlane(fl.ground(), wheel.point("centre"), axis=(0, 0, 1))
        >>> joint.selection.shape[0]
        1
    """

    selection = rows({2: 1.0})


class Revolute(_Turning):
    """Common point and common axis e₃.

    Example:
        >>> wheel = fl.RigidBody(2.0, (0.1, 0.1, 0.2), position=(1, 0, 0))
        >>> scene = fl.Scene()
        >>> _ = scene.add(wheel)
        >>> joint = scene.add(fl.Revolute(fl.ground(), wheel.point("centre"), axis=(0, 0, 1)))
        >>> _ = scene.add(fl.Drive(joint.angle, lambda t: 2.0 * t))
        >>> len(scene.joints), len(scene.connections)
        (1, 1)
    """

    selection = rows(*_COINCIDE, *_SAME_AXIS)
    reversible = True

    def coordinates(self) -> tuple[Coordinate, ...]:
        """The angle."""
        return (self.angle,)


class Prismatic(_Gliding):
    """Displacement along the common axis e₃ alone.

    Example:
        >>> wheel = fl.RigidBody(2.0, (0.1, 0.1, 0.2), position=(1, 0, 0))
        >>> joint = fl.Prismatic(fl.ground(), wheel.point("centre"), axis=(1, 0, 0))
        >>> len(joint.coordinates())
        1
    """

    selection = rows(*_ON_AXIS, *_NO_TURN)
    reversible = True

    def coordinates(self) -> tuple[Coordinate, ...]:
        """The displacement."""
        return (self.displacement,)


class Cylindrical(_Turning, _Gliding):
    """Displacement along and rotation about the common axis e₃, each free.

    Example:
        >>> wheel = fl.RigidBody(2.0, (0.1, 0.1, 0.2), position=(1, 0, 0))
        >>> joint = fl.Cylindrical(fl.ground(), wheel.point("centre"), axis=(1, 0, 0))
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
    """Displacement along the common axis e₃ in proportion to the rotation about it.

    Attributes:
        pitch: Displacement of ``b`` per turn, positive for a right-handed thread.

    Example:
        >>> wheel = fl.RigidBody(2.0, (0.1, 0.1, 0.2), position=(1, 0, 0))
        >>> joint = fl.Screw(fl.ground(), wheel.point("centre"), axis=(1, 0, 0), pitch=0.01)
        >>> joint.pitch
        0.01
    """

    pitch: float = 0.0

    selection = rows(*_ON_AXIS, *_SAME_AXIS, {2: 1.0})
    reversible = True

    @property
    def functions(self) -> Array:
        """``Δ₃ − pitch φ/2π`` is the last constraint."""
        factors = np.zeros((5, 3))
        factors[4, joint_functions.ANGLE] = -self.pitch / (2.0 * np.pi)
        return factors

    def check(self) -> None:
        """Raise ``ValueError`` if the joint is bad, or its pitch no number other than zero."""
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
        """Raise ``ValueError`` if there is none: global axes must not decide."""
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
    """Displacements in the plane across the common axis e₃ and rotation about it.

    Attributes:
        second: Direction of the first of the two displacements, fixed to ``a``; default: any, which
            is enough where nothing acts along one of them.

    Example:
        >>> wheel = fl.RigidBody(2.0, (0.1, 0.1, 0.2), position=(1, 0, 0))
        >>> joint = fl.Planar(fl.ground(), wheel.point("centre"), second=(1, 0, 0))
        >>> joint.selection.shape[0]
        3
    """

    selection = rows({2: 1.0}, *_SAME_AXIS)

    @property
    def displacements(self) -> tuple[Coordinate, Coordinate]:
        """Displacements of ``b`` along e₁ = ``second`` and e₂ of ``a``, zero at the start.

        Raises:
            ValueError: There is no second axis, without which they have no direction.
        """
        self._require_second("directions of the two displacements are along it and across")
        return self._displacements()

    def _displacements(self) -> tuple[Coordinate, Coordinate]:
        return self._linear("displacement 1", 0), self._linear("displacement 2", 1)

    def coordinates(self) -> tuple[Coordinate, ...]:
        """Angle and the two displacements."""
        return (self.angle, *self._displacements())


class Universal(_WithSecondAxis):
    """Common point; ``axis`` fixed to ``a`` stays perpendicular to ``second`` fixed to ``b``.

    At the start it holds the rotation about ``axis × second``, and no other.

    Attributes:
        second: Direction of the axis that is fixed to ``b``, across ``axis``; it must be given.

    Example:
        >>> wheel = fl.RigidBody(2.0, (0.1, 0.1, 0.2), position=(1, 0, 0))
        >>> joint = fl.Universal(fl.ground(), wheel.point("centre"), second=(1, 0, 0))
        >>> joint.selection.shape[0]
        4
    """

    selection = rows(*_COINCIDE, {9: 1.0})

    def check(self) -> None:
        """Raise ``ValueError`` if the joint is bad, or has no second axis."""
        super().check()
        self._require_second("the joint holds the rotation about axis × second")

    @property
    def angle(self) -> Coordinate:
        """Rotation of the cross against ``a`` about ``axis``, unwrapped, zero at the start, rad."""
        return self._angle("angle", rows({6: 1.0}, {3: 1.0}))

    @property
    def second_angle(self) -> Coordinate:
        """Rotation of ``b`` against the cross about ``second``."""
        return self._angle("second angle", rows({10: 1.0}, {11: 1.0}))

    def coordinates(self) -> tuple[Coordinate, ...]:
        """Both angles."""
        return self.angle, self.second_angle


@dataclass(frozen=True, eq=False)
class Distance(Joint):
    """Forbids nothing: the distance of two points, for springs, drives and results.

    A :class:`~fem_lie.joints.Drive` of its length without history is a massless rod.

    Attributes:
        at: Place on ``a``'s side in the initial configuration; default: the point itself.
        to: Place on ``b``'s side; likewise.

    Example:
        >>> wheel = fl.RigidBody(2.0, (0.1, 0.1, 0.2), position=(1, 0, 0))
        >>> scene = fl.Scene()
        >>> _ = scene.add(wheel)
        >>> joint = scene.add(fl.Distance(fl.ground(), wheel.point("centre"), at=(0, 0, 0)))
        >>> _ = scene.add(fl.Drive(joint.length))  # a massless rod
        >>> len(scene.connections)
        1
    """

    to: npt.ArrayLike | None = None

    selection = rows()
    reversible = True

    @property
    def length(self) -> Coordinate:
        """Distance of the two places."""
        return self._function("length", joint_functions.DISTANCE)

    def coordinates(self) -> tuple[Coordinate, ...]:
        """The length."""
        return (self.length,)

    def frames(self) -> tuple[Array, Array]:
        """At the two places, along global axes.

        Raises:
            ValueError: They coincide.
        """
        start = self.a.position if self.at is None else self._given_place(self.at, "at")
        end = self.b.position if self.to is None else self._given_place(self.to, "to")
        if not np.linalg.norm(end - start) > 1e-12 * max(self.a.size, self.b.size):
            raise ValueError(f"{self.label}: both places are {start}; a distance needs two")
        return np.vstack([start, np.eye(3)]), np.vstack([end, np.eye(3)])

    def check(self) -> None:
        """Raise ``ValueError`` if the places coincide or both points are ground."""
        if self.a.is_ground and self.b.is_ground:
            raise ValueError(f"{self.label}: both points are ground")
        self.frames()
