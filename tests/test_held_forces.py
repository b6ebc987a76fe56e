"""Support reactions are the same from their neighbourhood and from the whole scene."""

import numpy as np
import pytest

import fem_lie as fl

STEEL = fl.Material(E=2e11, nu=0.3, density=7800.0)
SECTION = fl.Section.rectangle(0.02, 0.03, STEEL)


def bar(scene, start, end, name):
    return scene.add(fl.Beam.straight(start, end, SECTION, cells=4, name=name))


def cantilever():
    scene = fl.Scene(gravity=(1.0, 2.0, -9.81))
    one = bar(scene, (0, 0, 0), (1, 0.2, 0.1), "one")
    scene.add(fl.Clamp(one.point("start")))
    scene.add(fl.PointLoad(one.point("start"), force=(1.0, 2.0, 3.0), moment=(4.0, 5.0, 6.0)))
    return scene


def branched():
    """Attached nodes, with a supported master node in the middle of the numbering."""
    scene = cantilever()
    one = scene.bodies[0]
    two = bar(scene, (0.5, -1, 0), one.point("end").position, "two")
    three = bar(scene, one.point("start").position, (0, 1, 0), "three")
    scene.add(fl.joints.RigidLink(two.point("end"), one.point("end")))
    scene.add(fl.joints.RigidLink(one.point("start"), three.point("start")))
    scene.add(fl.Clamp(two.point("start")))
    return scene


def jointed():
    """Joints, springs and dampers act on supported nodes."""
    scene = branched()
    one, two, three = scene.bodies
    four = bar(scene, (0, 0, 0), (0, 0, 1), "four")
    scene.add(fl.joints.Spherical(four.point("start"), one.point("start")))
    scene.add(
        fl.joints.Spherical(two.point("start"), three.point("end"), at=two.point("start").position)
    )
    hinge = scene.add(
        fl.joints.Revolute(
            one.point("end"), four.point("end"), at=four.point("end").position, axis=(0, 1, 0)
        )
    )
    scene.add(fl.joints.Spring(hinge.angle, stiffness=30.0, damping=2.0))
    scene.add(
        fl.joints.Spring(
            fl.joints.Distance(one.point("start"), four.point("end")).length,
            stiffness=100.0,
            damping=3.0,
        )
    )
    return scene


@pytest.mark.parametrize("scene", [cantilever, branched, jointed])
def test_impulses_of_supports_need_only_what_is_near(scene):
    """After each step they are found around the supports, in recorded rows from the whole scene."""
    h, made = 1e-4, scene()
    result = fl.GeneralisedAlpha().run(made, duration=30 * h, step=h, progress=False)
    positions = result.frames[:, result.info.supports.at, 0]
    F, M = np.split(result.reactions, 2, axis=-1)
    forces = np.concatenate([F.sum(axis=1), (M + np.cross(positions, F)).sum(axis=1)], axis=-1)
    wanted = np.cumsum(0.5 * h * (forces[1:] + forces[:-1]), axis=0)
    found = result.impulses[1:, 1] - result.impulses[0, 1]
    for k in (slice(0, 3), slice(3, 6)):
        assert np.abs(wanted[:, k]).max() > 0.0
        gap = np.abs(found[:, k] - wanted[:, k]).max()
        assert gap <= 1e-12 * np.abs(h * forces[:, k]).sum()
