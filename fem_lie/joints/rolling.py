"""Joints with velocity constraints: rolling without slip, and knife edges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, positive
from fem_lie.joints.connection import VelocityConstraintDefinition, rows
from fem_lie.joints.equations import functions as joint_functions
from fem_lie.joints.joint import Joint


class KnifeEdge(Joint):
    """A point of ``b`` has no velocity relative to ``a`` along ``axis``, which is fixed to ``b``.

    A skate, or an unsteered wheel. The constraint is nonholonomic: positions are not constrained.
    In the frame of ``b`` the constrained component of the velocity is constant.

    Example:
        >>> wheel = fl.RigidBody(2.0, (0.1, 0.1, 0.2), position=(1, 0, 0))
        >>> scene = fl.Scene()
        >>> _ = scene.add(wheel)
        >>> joint = scene.add(fl.joints.KnifeEdge(fl.ground(), wheel.point("centre"), axis=(0, 1,
        ...     0)))
        >>> len(scene.joints)
        1
    """

    selection = rows()

    def velocity_definitions(self) -> list[VelocityConstraintDefinition]:
        """The velocity component along e₃ of ``b``."""
        across = np.zeros((1, 6))
        across[0, 2] = 1.0
        return [VelocityConstraintDefinition(self.a, self.b, self.frames(), across)]


@dataclass(frozen=True, eq=False)
class RollingDisc(Joint):
    """A thin disc on ``b`` rolls without slip on a plane that is fixed to ``a``.

    The rim stays on the plane, and at the point of contact it has the velocity of the plane. The
    force in results acts on ``a``, with moments about the initial point of contact.

    Attributes:
        at: Centre of the disc in the initial configuration; default: the point ``b``.
        axis: Axis of the disc.
        radius: Radius of the disc.
        normal: Normal of the plane, towards the disc.

    Example:
        >>> wheel = fl.RigidBody(2.0, (0.1, 0.1, 0.2), position=(1, 0, 0))
        >>> scene = fl.Scene()
        >>> _ = scene.add(wheel)
        >>> disc = wheel.point("centre")
        >>> joint = scene.add(fl.joints.RollingDisc(fl.ground(), disc, axis=(0, 1, 0), radius=0.3))
        >>> len(scene.joints)
        1
    """

    radius: float = 0.0
    normal: npt.ArrayLike = (0.0, 0.0, 1.0)

    selection = rows({2: 1.0})

    @property
    def functions(self) -> Array:
        """Factors of the constraint: centre height = ``radius`` times the sine of the tilt."""
        factors = np.zeros((1, joint_functions.COUNT))
        factors[0, joint_functions.TILT] = -self.radius
        return factors

    def check(self) -> None:
        """Raise ``ValueError`` if the joint is invalid, or the disc lies in the plane."""
        positive(self.radius, f"{self.label}: the radius")
        super().check()
        self.frames()

    def frames(self) -> tuple[Array, Array]:
        """Frame at the point of contact with e₃ along the normal, and at the centre with e₃ = axis.

        Raises:
            ValueError: The disc lies in the plane.
        """
        axis = self._direction(self.axis, "axis")
        normal = self._direction(self.normal, "normal")
        centre = self.b.position if self.at is None else self._given_position(self.at, "at")
        up = normal - (normal @ axis) * axis
        tilt = float(np.linalg.norm(up))
        if not tilt > 1e-9:
            raise ValueError(
                f"{self.label}: the axis {self.axis} must not be the normal of the plane"
            )
        along = np.cross(axis, normal) / tilt
        contact = centre - self.radius * up / tilt
        plane = np.array([contact, along, np.cross(normal, along), normal])
        return plane, np.array([centre, along, np.cross(axis, along), axis])

    def velocity_definitions(self) -> list[VelocityConstraintDefinition]:
        """Slip velocities along and across the path."""
        return [
            VelocityConstraintDefinition(
                self.a, self.b, self.frames(), np.zeros((2, 6)), float(self.radius)
            )
        ]

    def _position(self) -> Array:
        return self.b.position
