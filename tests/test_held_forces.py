"""Support reactions are the same from their neighbourhood and from the whole scene."""

import numpy as np
import pytest

import fem_lie as fl
from fem_lie.system.balance import HeldForces, supported

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
def test_forces_of_supports_need_only_what_is_near(scene):
    rng, equations = np.random.default_rng(5), fl.extend.Equations(scene(), dynamics=True)
    system = equations.system
    count, frames = system.count, system.frames.copy()
    frames[:count, :3] += 1e-3 * rng.standard_normal((count, 3, 3))
    v, a = rng.standard_normal((2, len(frames), 6))
    state = frames, v, a, rng.standard_normal(system.m)
    held = supported(system)
    near = HeldForces(system, held)
    assert near.near
    r = np.empty(system.size)
    system.with_reactions(fl.extend.TimeState(*state), np.ones(system.m), r)
    wanted = np.where(held, r[: 6 * count].reshape(-1, 6), 0.0)
    assert (near.nodes == np.flatnonzero(wanted.any(axis=1))).all()
    for _ in range(2):
        found = near.find(*state)
        assert np.abs(found - wanted[near.nodes]).max() <= 1e-13 * np.abs(wanted).max()
