"""Joints between two frames of beams, shells, rigid bodies and ground, and what acts along them."""

from fem_lie.joints.connection import (
    Connection,
    ConstraintDefinition,
    Coordinate,
    SlidingConstraintDefinition,
    VelocityConstraintDefinition,
)
from fem_lie.joints.joint import Joint
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
from fem_lie.joints.rigid_link import RigidLink
from fem_lie.joints.rolling import KnifeEdge, RollingDisc
from fem_lie.joints.sliding import Collar, Sleeve, Sliding
from fem_lie.joints.springs import Drive, Gear, Spring

__all__ = [
    "Collar",
    "Connection",
    "ConstraintDefinition",
    "Coordinate",
    "Cylindrical",
    "Distance",
    "Drive",
    "Fixed",
    "Gear",
    "InPlane",
    "Joint",
    "KnifeEdge",
    "Planar",
    "Prismatic",
    "Revolute",
    "RigidLink",
    "RollingDisc",
    "Screw",
    "Sleeve",
    "Sliding",
    "SlidingConstraintDefinition",
    "Spherical",
    "Spring",
    "Universal",
    "VelocityConstraintDefinition",
]
