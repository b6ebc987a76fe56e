"""Bodies with steps of their own: energy, order, joints between them, interruption, bad input."""

from itertools import pairwise

import numpy as np
import pytest

import fem_lie as fl
from tests.test_composed import resumed_as_whole
from tests.test_energy_momentum import SQUARE

JOINTS = {"fixed": fl.Fixed, "revolute": fl.Revolute}


def chain(joint=fl.Fixed) -> tuple[fl.Scene, fl.Beam]:
    """Two beams and a rigid body that fall from a joint with the ground, and the second beam."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    one, two = (
        scene.add(fl.Beam.straight((a, 0, 0), (b, 0, 0), SQUARE, cells=2))
        for a, b in ((0.0, 0.3), (0.3, 0.6))
    )
    bob = scene.add(fl.RigidBody(0.2, (1e-4, 2e-4, 2e-4), position=(0.6, 0, 0)))
    for body in (one, two, bob):
        body.turn((0.5, 1.0, -2.0), about=(0, 0, 0))
    scene.add(fl.Spherical(fl.ground(), one.start))
    scene.add(joint(one.end, two.start) if joint is not fl.Revolute else _hinge(one, two))
    scene.add(fl.Fixed(two.end, bob.centre))
    return scene, two


def _hinge(one: fl.Beam, two: fl.Beam) -> fl.Revolute:
    return fl.Revolute(one.end, two.start, axis=(0.2, 1, 0))


@pytest.mark.parametrize("joint", JOINTS.values(), ids=JOINTS)
def test_joints_between_steps_take_no_energy(joint):
    """Of either sort: the whole energy stays, and so does the work of multipliers, none."""
    scene, two = chain(joint)
    result = fl.MultiRate({two: 5}).run(scene, duration=0.01, step=1e-3)
    assert result.energy_error <= 1e-11
    assert np.abs(result.balance[:, 0]).max() <= 1e-12 * result.kinetic.max()
    assert result.joint_violations.max() <= 1e-11
    assert result.elastic.max() > 1e-4 * result.kinetic[0]


def test_second_order():
    ends = []
    for steps in (10, 20, 40):
        scene, two = chain()
        result = fl.MultiRate({two: 4}).run(
            scene, duration=4e-3, step=4e-3 / steps, save_every=steps
        )
        ends.append((result.frames[-1], result.velocities[-1]))
    far, near = [
        [np.abs(a - b).max() for a, b in zip(one, two, strict=True)] for one, two in pairwise(ends)
    ]
    np.testing.assert_allclose(np.log2(np.array(far) / near), 2.0, atol=0.1)


def test_it_converges_to_small_steps_everywhere():
    scene, two = chain()
    result = fl.MultiRate({two: 4}).run(scene, duration=4e-3, step=1e-4, save_every=40)
    small = fl.EnergyMomentum().run(chain()[0], duration=4e-3, step=2.5e-5, save_every=160)
    np.testing.assert_allclose(result.frames[-1], small.frames[-1], atol=1e-6)
    scale = np.abs(small.joint_forces[-1]).max()
    np.testing.assert_allclose(result.joint_forces[-1], small.joint_forces[-1], atol=5e-2 * scale)


def test_resumed_to_the_last_bit(tmp_path, monkeypatch):
    scene, two = chain()
    plan = {"duration": 0.016, "step": 1e-3}
    scheme, file = fl.MultiRate({two: 3}), tmp_path / "run.h5"
    resumed_as_whole(scheme, lambda: scene, plan, file, monkeypatch)


def test_bad_input():
    scene, two = chain()
    stranger = fl.RigidBody(1.0, (1, 1, 1), name="stranger")
    span = {"duration": 1e-3, "step": 1e-3}
    with pytest.raises(ValueError, match="stranger has steps of its own and is not in the scene"):
        fl.MultiRate({stranger: 10}).run(scene, **span)
    with pytest.raises(ValueError, match=r"MultiRate: steps of .* must be at least 1, got 0"):
        fl.MultiRate({two: 0})
    with pytest.raises(ValueError, match="wanted EnergyMomentum"):
        fl.MultiRate({two: 2}, fl.EnergyDecaying())
    scene.add(fl.Spring(fl.Distance(scene.bodies[0].start, two.end).length, stiffness=1.0))
    with pytest.raises(ValueError, match="joints alone, got Spring between"):
        fl.MultiRate({two: 2}).run(scene, **span)
