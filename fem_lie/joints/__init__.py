"""Joints between two points of bodies or of ground, and what acts along them: springs, drives."""

from typing import TYPE_CHECKING

from fem_lie._public_names import public_names

if TYPE_CHECKING:
    from fem_lie.contact.mortar.tie import Tie
    from fem_lie.events.limit import Limit
    from fem_lie.joints.bushing import Bushing
    from fem_lie.joints.connection import Connection, Coordinate
    from fem_lie.joints.friction import JointFriction
    from fem_lie.joints.joint import Joint, RedundantConstraints
    from fem_lie.joints.kinds import (
        Cylindrical,
        Distance,
        Fixed,
        InPlane,
        Planar,
        Prismatic,
        Revolute,
        Screw,
        Spherical,
        Universal,
    )
    from fem_lie.joints.rigid_link import KinematicCoupling, RigidLink
    from fem_lie.joints.rolling import KnifeEdge, RollingDisc
    from fem_lie.joints.sliding import Collar, Sleeve, Sliding
    from fem_lie.joints.springs import Drive, Gear, Spring
else:
    __getattr__, __dir__ = public_names(__name__)

__all__ = [
    "Bushing",
    "Collar",
    "Connection",
    "Coordinate",
    "Cylindrical",
    "Distance",
    "Drive",
    "Fixed",
    "Gear",
    "InPlane",
    "Joint",
    "JointFriction",
    "KinematicCoupling",
    "KnifeEdge",
    "Limit",
    "Planar",
    "Prismatic",
    "RedundantConstraints",
    "Revolute",
    "RigidLink",
    "RollingDisc",
    "Screw",
    "Sleeve",
    "Sliding",
    "Spherical",
    "Spring",
    "Tie",
    "Universal",
]
