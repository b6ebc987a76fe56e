"""Hamel's form: sledge and disc against what is known of them, energy, interruption, bad input."""

import numpy as np
import pytest

import fem_lie as fl
from benchmarks.hamel import AHEAD, rolling, sledge
from demos.rolling_disc import reference
from tests.test_composed import resumed_as_whole

SCHEME = fl.schemes.Hamel()


def test_sledge_keeps_energy_and_edge():
    scene, blade = sledge()
    result = SCHEME.run(scene, duration=20.0, step=2e-3, save_every=100)
    assert result.energy_error <= 1e-13
    assert result.joint_violation(blade).max() <= 1e-13
    assert np.ptp(result.velocities[:, 0, 5]) > 1.0


def test_sledge_is_of_second_order():
    """Without gravity: v of the edge is E tanh, the rotation E/b cosh (Chaplygin)."""
    v0, w0 = -0.5, 2.0
    b = np.sqrt(0.05 / 1.5 + AHEAD**2)
    E = np.hypot(v0, b * w0)
    errors = []
    for step in (1e-2, 5e-3):
        scene, _ = sledge()
        scene.gravity = (0, 0, 0)
        result = SCHEME.run(scene, duration=2.0, step=step)
        phase = AHEAD * E / b**2 * result.times + np.arctanh(v0 / E)
        errors.append(np.abs(result.velocities[:, 0, 5] - E / b / np.cosh(phase)).max())
    assert errors[1] < 3e-5
    assert 3.8 < errors[0] / errors[1] < 4.2


def test_disc_is_of_second_order_and_rolls():
    errors = []
    for step in (2e-3, 1e-3):
        scene, contact = rolling()
        result = SCHEME.run(scene, duration=0.5, step=step)
        exact = reference(np.radians(20.0), 12.0, 1.0, result.times)
        errors.append(np.abs(result.frames[:, 0, 0] - exact).max())
        assert result.joint_violation(contact).max() <= 1e-12
        assert 1e-12 < result.energy_error <= 1e-5
    assert errors[1] < 1e-4
    assert 3.8 < errors[0] / errors[1] < 4.2


def test_force_of_the_contact():
    """Of the equations of motion, as generalised-α has it."""
    forces = []
    for scheme in (SCHEME, fl.GeneralisedAlpha(radius=0.9, tolerance=1e-10)):
        scene, contact = rolling()
        result = scheme.run(scene, duration=0.2, step=1e-3, save_every=50)
        forces.append(result.joint_force(contact)[1:])
    np.testing.assert_allclose(*forces, atol=1e-2)


def test_energy_does_not_drift():
    """Of the disc: what goes up and down is what the ends of steps show of it."""
    scene, _ = rolling()
    kept = fl.schemes.Record.ENERGIES
    result = SCHEME.run(scene, duration=200.0, step=2e-3, save_every=20, record=kept)
    energy = result.total_energy
    early, late = np.split(energy[1:], 2)
    assert np.ptp(late) <= 1.05 * np.ptp(early)


def test_resumed_to_the_last_bit(tmp_path):
    plan = {"duration": 0.06, "step": 3e-3}
    resumed_as_whole(SCHEME, lambda: rolling()[0], plan, tmp_path / "run.h5")


def test_bad_input():
    span = {"duration": 1e-2, "step": 1e-2}
    scene, blade = sledge()
    scene.add(fl.joints.Planar(fl.ground(), blade.b))
    with pytest.raises(ValueError, match="joints other than KnifeEdge and RollingDisc"):
        SCHEME.run(scene, **span)
    scene, blade = sledge()
    scene.add(fl.PointLoad(blade.b, force=(0, 0, 1)))
    with pytest.raises(ValueError, match="loads other than gravity"):
        SCHEME.run(scene, **span)
    scene, _ = sledge()
    with pytest.raises(ValueError, match="Hamel makes constant steps"):
        SCHEME.run(scene, duration=1e-2, step=fl.schemes.AdaptiveStep(tolerance=1e-3))
