"""A closed loop of a plate, beams and a rigid body on the ground, in any system of units."""

from __future__ import annotations

import numpy as np

import fem_lie as fl
from tests.unit_systems import METRES, UnitSystem


def closed_loop(
    u: UnitSystem = METRES,
    *,
    gravity: float = 9.81,
    drilling: bool | None = None,
) -> fl.Scene:
    """Ground, beam, plate, beam, rigid body, ground: a hinge about y, and spherical joints.

    All of steel; the plate is 0.4 by 0.2 by 0.01. With six parameters it is hinged to a beam.
    """
    steel = fl.Material(u.stress(2e11), 0.3, u.density(7800.0))
    section = fl.Section.rectangle(u.length(0.02), u.length(0.02), steel)
    scene = fl.Scene(gravity=u.acceleration([0.0, 0.0, -gravity]))
    low, high = u.length([0, 0.1, 0]), u.length([0.1, 0.1, 0.5])
    far, foot = u.length([0.5, 0.1, 0.5]), u.length([0.6, 0.1, 0.1])
    left = scene.add(fl.Beam.straight(low, high, section, cells=2, name="left"))
    plate = scene.add(
        fl.Shell(
            fl.mesh.parametric_surface(
                lambda a, b: u.length([0.1 + 0.4 * a, 0.2 * b, 0.5]), (4, 2)
            ),
            fl.ShellSection.layer(u.length(0.01), steel),
            drilling=drilling,
            name="plate",
        )
    )
    right = scene.add(fl.Beam.straight(far, foot, section, cells=2, name="right"))
    block = scene.add(
        fl.RigidBody(
            u.mass(3.0), u.inertia([0.02, 0.03, 0.04]), u.length([0.6, 0.1, 0.0]), name="block"
        )
    )
    scene.add(fl.joints.Revolute(fl.ground(), left.point("start"), axis=(0, 1, 0), name="root"))
    scene.add(fl.joints.Spherical(left.point("end"), nearest(plate, high), name="near"))
    corner = nearest(plate, far)
    if drilling:
        scene.add(fl.joints.Revolute(corner, right.point("start"), axis=(0, 1, 0), name="far"))
    else:
        scene.add(fl.joints.Spherical(corner, right.point("start"), name="far"))
    scene.add(fl.joints.Spherical(right.point("end"), block.point("centre"), at=foot, name="foot"))
    scene.add(
        fl.joints.Spherical(
            block.point("centre"), fl.ground(), at=u.length([0.7, 0.1, -0.1]), name="ground"
        )
    )
    return scene


def nearest(body: fl.Shell, position: np.ndarray) -> fl.extend.Point:
    """The node of a body that is nearest to a position."""
    return body.point(int(np.linalg.norm(body.frames[:, 0] - position, axis=1).argmin()))
