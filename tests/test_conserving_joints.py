"""Every joint, and springs along them, keep energy and momenta to round-off."""

import pytest

import fem_lie as fl
from benchmarks.conserving_joints import JOINTS, errors, two_bodies


@pytest.mark.parametrize("kind", JOINTS)
def test_joints_do_no_work(kind):
    """Round-off of 200 steps of 2e-3 s is some 1e-15 each."""
    e = errors(kind, steps=200, step=2e-3)
    assert e["energy_error"] <= 1e-12
    assert e["angular_momentum_error"] <= 1e-12
    assert e["violation"] <= 1e-12
    assert e["moved"] > 1e-2


@pytest.mark.parametrize("kind", ["revolute", "prismatic", "screw", "distance"])
def test_springs_along_angles_and_displacements_store_what_they_take(kind):
    e = errors(kind, steps=200, step=2e-3, spring=20.0)
    assert e["energy_error"] <= 1e-12
    assert e["angular_momentum_error"] <= 1e-12


def test_what_a_damper_takes_is_in_the_balance():
    scene, joint = two_bodies("revolute")
    scene.add(fl.joints.Spring(joint.angle, stiffness=5.0, damping=0.5))
    result = fl.EnergyMomentum().run(scene, duration=0.4, step=2e-3)
    assert result.balance[-1, 1] > 1e-4
    assert result.balance_error <= 1e-12


def test_a_drive_does_the_work_that_the_balance_counts():
    scene, joint = two_bodies("revolute")
    scene.add(fl.joints.Drive(joint.angle, lambda t: 2.0 * t**3))
    result = fl.EnergyMomentum().run(scene, duration=0.4, step=2e-3)
    assert abs(result.balance[-1, 0]) > 1e-4
    assert result.balance_error <= 1e-11
    assert result.angular_momentum_error <= 1e-12
