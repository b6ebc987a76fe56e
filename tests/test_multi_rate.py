"""Bodies with steps of their own: energy, order, joints between them, interruption, bad input."""

from itertools import pairwise

import numpy as np
import pytest

import fem_lie as fl
from tests.test_composed import resumed_as_whole
from tests.test_energy_momentum import SQUARE

JOINTS = {"fixed": fl.joints.Fixed, "revolute": fl.joints.Revolute}


def chain(joint=fl.joints.Fixed) -> tuple[fl.Scene, fl.Beam]:
    """Two beams and a rigid body that fall from a joint with the ground, and the second beam."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    one, two = (
        scene.add(fl.Beam.straight((a, 0, 0), (b, 0, 0), SQUARE, cells=2))
        for a, b in ((0.0, 0.3), (0.3, 0.6))
    )
    bob = scene.add(fl.RigidBody(0.2, (1e-4, 2e-4, 2e-4), position=(0.6, 0, 0)))
    for body in (one, two, bob):
        body.add_velocity(omega=(0.5, 1.0, -2.0), about=(0, 0, 0))
    scene.add(fl.joints.Spherical(fl.ground(), one.point("start")))
    scene.add(
        joint(one.point("end"), two.point("start"))
        if joint is not fl.joints.Revolute
        else _hinge(one, two)
    )
    scene.add(fl.joints.Fixed(two.point("end"), bob.point("centre")))
    return scene, two


def _hinge(one: fl.Beam, two: fl.Beam) -> fl.joints.Revolute:
    return fl.joints.Revolute(one.point("end"), two.point("start"), axis=(0.2, 1, 0))


@pytest.mark.parametrize("joint", JOINTS.values(), ids=JOINTS)
def test_joints_between_steps_take_no_energy(joint):
    """Of either sort: the whole energy stays, and so does the work of multipliers, none."""
    scene, two = chain(joint)
    result = fl.schemes.MultiRate({two: 5}).run(scene, duration=0.01, step=1e-3)
    assert result.energy_error <= 1e-11
    assert np.abs(result.balance[:, 0]).max() <= 1e-12 * result.kinetic.max()
    assert result.joint_violations.max() <= 1e-11
    assert result.elastic.max() > 1e-4 * result.kinetic[0]


def pushed() -> tuple[fl.Scene, fl.Beam]:
    """The chain under loads that change, on bodies of either size of steps."""
    scene, two = chain()
    one, _, bob = scene.bodies
    scene.add(fl.PointLoad(bob.point("centre"), (0, 5, 0), history=lambda t: np.sin(400 * t)))
    scene.add(
        fl.PointLoad(
            two.point("end"), moment=(0.02, 0, 0.03), following=True, history=lambda t: 1 + 200 * t
        )
    )
    scene.add(fl.LineLoad(one, force=(0, 0, 10.0), history=lambda t: np.cos(300 * t)))
    return scene, two


def test_work_of_loads_that_change():
    """They act in the middle of each step, so the balance of energy is exact."""
    scene, two = pushed()
    result = fl.schemes.MultiRate({two: 5}).run(scene, duration=0.01, step=1e-3)
    assert result.balance_error <= 1e-11
    assert np.abs(result.balance[-1, 0]) > 1e-3 * result.kinetic[0]
    assert result.momentum_error <= 1e-9


def test_energy_of_contacts():
    """What a contact stores within a step that is tried several times, is that of the last try."""
    scene, two = chain()
    bob = scene.bodies[2]
    floor = fl.contact.Plane(fl.ground(), at=(0.6, 0, -0.052), normal=(0, 0, 1))
    scene.add(
        fl.contact.Contact(
            fl.contact.Sphere(bob.point("centre"), 0.05), floor, fl.contact.Penalty(1e4)
        )
    )
    result = fl.schemes.MultiRate({two: 3}).run(scene, duration=0.02, step=5e-4)
    stored = result.elastic - result.elastic[0]
    assert stored.max() > 1e-2 * result.kinetic[0]
    assert result.balance_error <= 1e-10


@pytest.mark.parametrize("scene_of", [chain, pushed], ids=["free", "pushed"])
def test_second_order(scene_of):
    ends = []
    for steps in (10, 20, 40):
        scene, two = scene_of()
        result = fl.schemes.MultiRate({two: 4}).run(
            scene, duration=4e-3, step=4e-3 / steps, save_every=steps
        )
        ends.append((result.frames[-1], result.velocities[-1]))
    far, near = [
        [np.abs(a - b).max() for a, b in zip(one, two, strict=True)] for one, two in pairwise(ends)
    ]
    np.testing.assert_allclose(np.log2(np.array(far) / near), 2.0, atol=0.1)


@pytest.mark.parametrize("scene_of", [chain, pushed], ids=["free", "pushed"])
def test_it_converges_to_small_steps_everywhere(scene_of):
    scene, two = scene_of()
    result = fl.schemes.MultiRate({two: 4}).run(scene, duration=4e-3, step=1e-4, save_every=40)
    small = fl.EnergyMomentum().run(scene_of()[0], duration=4e-3, step=2.5e-5, save_every=160)
    np.testing.assert_allclose(result.frames[-1], small.frames[-1], atol=1e-6)
    scale = np.abs(small.joint_forces[-1]).max()
    np.testing.assert_allclose(result.joint_forces[-1], small.joint_forces[-1], atol=5e-2 * scale)


@pytest.mark.parametrize("scene_of", [chain, pushed], ids=["free", "pushed"])
def test_resumed_to_the_last_bit(tmp_path, scene_of):
    scene, two = scene_of()
    plan = {"duration": 0.016, "step": 1e-3}
    scheme, file = fl.schemes.MultiRate({two: 3}), tmp_path / "run.h5"
    resumed_as_whole(scheme, lambda: scene, plan, file)


def test_drives():
    scene, two = chain()
    rod = scene.add(
        fl.joints.Distance(fl.ground(), scene.bodies[2].point("centre"), at=(0, 0, 1), to=None)
    )
    scene.add(fl.joints.Drive(rod.length, lambda t: np.sqrt(1.36) + t))
    with pytest.raises(ValueError, match=r"MultiRate does not support drives, prescribed motions"):
        fl.schemes.MultiRate({two: 2}).run(scene, duration=1e-3, step=1e-3)


def test_bad_input():
    scene, two = chain()
    stranger = fl.RigidBody(1.0, (1, 1, 1), name="stranger")
    span = {"duration": 1e-3, "step": 1e-3}
    with pytest.raises(ValueError, match="stranger has steps of its own and is not in the scene"):
        fl.schemes.MultiRate({stranger: 10}).run(scene, **span)
    with pytest.raises(ValueError, match=r"MultiRate: steps of .* must be at least 1, got 0"):
        fl.schemes.MultiRate({two: 0})
    with pytest.raises(ValueError, match="expected EnergyMomentum"):
        fl.schemes.MultiRate({two: 2}, fl.EnergyDecaying())
    scene.add(
        fl.joints.Spring(
            fl.joints.Distance(scene.bodies[0].point("start"), two.point("end")).length,
            stiffness=1.0,
        )
    )
    with pytest.raises(ValueError, match="of their own, got Spring between"):
        fl.schemes.MultiRate({two: 2}).run(scene, **span)
