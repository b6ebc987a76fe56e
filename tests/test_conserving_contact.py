"""Contacts by penalty in conserving steps: what stays over impacts, in steps as long as these."""

import numpy as np
import pytest

import fem_lie as fl
from benchmarks import elastic_bar
from benchmarks.conserving_contact import CASES, scene_of, sheet


def run(name, periods, count, scheme=None):
    build, k, mass, _ = CASES[name]
    scene, touch = build(k)
    step = periods * 2 * np.pi * np.sqrt(mass / (k if name[:5] != "lines" else 0.06 * k))
    scheme = fl.EnergyMomentum() if scheme is None else scheme
    return scheme.run(scene, duration=count * step, step=step, progress=False), touch


@pytest.mark.parametrize(
    ("name", "periods", "count"),
    [
        ("box", 0.02, 400),
        ("box", 0.9, 40),
        ("box", 2.0, 14),
        ("corners", 0.2, 30),
        ("beams", 0.2, 10),
        ("beams", 2.0, 6),  # whose increments fall slowly
        ("lines90", 0.2, 8),
        ("ball", 0.2, 6),
        ("sheets", 0.2, 10),
        ("slab", 0.2, 10),
    ],
)
def test_energy_and_momenta_stay_over_impacts(name, periods, count):
    result, touch = run(name, periods, count)
    found = fl.post.contact_forces(result, touch)
    assert found.touching.max() > 0
    assert result.elastic.max() > 0.01 * result.kinetic[0]
    assert result.energy_error < 5e-12
    assert result.momentum_error < 1e-13
    assert result.angular_momentum_error < 1e-13


@pytest.mark.parametrize(("name", "count"), [("lines90", 8), ("slab", 10)])
def test_steps_in_contact_keep_their_matrix(name, count):
    result, touch = run(name, 0.2, count)
    assert np.count_nonzero(fl.post.contact_forces(result, touch).touching) > 2
    assert result.factorisations <= 3
    assert result.divided == 0


@pytest.mark.parametrize("away", [0.0, 10.0])
@pytest.mark.parametrize("stiffness", [1e4, 1e6, 1e7, 1e9])
def test_a_ball_stays_at_rest_on_a_plane_of_any_stiffness(stiffness, away):
    """The smaller the overlap, the more of its energy is round-off of positions."""
    mass, radius, g = 1.0, 0.1, 9.81
    height = away + radius - mass * g / stiffness
    ball = fl.RigidBody(mass, 0.4 * mass * radius**2 * np.ones(3), (away, 0.0, height))
    scene = fl.Scene(gravity=(0, 0, -g))
    scene.add(ball)
    plane = fl.contact.Plane(fl.ground(), (0, 0, 1), at=(0, 0, away))
    sphere = fl.contact.Sphere(ball.point("centre"), radius)
    scene.add(fl.contact.Contact(sphere, plane, fl.contact.Penalty(stiffness)))
    result = fl.EnergyMomentum().run(scene, duration=0.5, step=1e-2, progress=False)
    assert result.divided == 0
    assert np.ptp(result.frames[:, 0, 0, 2]) <= 1e-14 * (away + radius)
    assert result.iterations[-1] <= 16 * 50


def test_damping_of_shell_surfaces_is_refused():
    lower, upper = sheet(0, 1, 1), sheet(0.1, 1, 1)
    surfaces = (
        fl.contact.ShellSurface(lower, smooth=False),
        fl.contact.ShellSurface(upper, smooth=False),
    )
    law = fl.contact.Penalty(1e6, damping=1e3)
    scene = scene_of(lower, upper, fl.contact.Contact(*surfaces, law))
    with pytest.raises(ValueError, match="does not support contacts by penalty with damping"):
        fl.EnergyMomentum().run(scene, duration=1e-2, step=1e-3, progress=False)


def test_decaying_steps_never_gain_energy():
    result, _ = run("beams", 0.2, 10, fl.EnergyDecaying(radius=0.5))
    energy = result.total_energy
    assert np.diff(energy).max() < 1e-11 * energy[0]
    assert result.balance[-1, 2] > 1e-3 * energy[0]
    assert result.balance_error < 5e-12
    assert result.angular_momentum_error < 1e-13


def test_impulses_of_ground_are_accounted_for():
    """A ball between two slopes of ground."""
    ball = fl.RigidBody(1.0, 4e-3 * np.eye(3), (0, 0, 1))
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(ball)
    surface, law = fl.contact.Sphere(ball.point("centre"), 0.1), fl.contact.Penalty(1e4)
    scene.add(
        fl.contact.Contact(surface, fl.contact.Plane(fl.ground(), (0.3, 0, 1), at=(0, 0, 0.5)), law)
    )
    scene.add(
        fl.contact.Contact(surface, fl.contact.Plane(fl.ground(), (-1, 0, 1), at=(0, 0, 0)), law)
    )
    result = fl.EnergyMomentum().run(scene, duration=1.5, step=5e-3, progress=False)
    assert result.impulses[-1, 1, 0] != 0.0
    assert result.energy_error < 1e-12
    assert result.momentum_error < 1e-13
    assert result.angular_momentum_error < 1e-13


@pytest.mark.parametrize("name", ["lines90", "sheets"])
def test_a_restart_during_an_impact_agrees_to_the_last_bit(tmp_path, name):
    build, k, _, _ = CASES[name]
    step = 1e-3 if name == "lines90" else 4e-3
    options = {"duration": 12 * step, "step": step, "progress": False}
    scheme, file = fl.EnergyMomentum(), tmp_path / "run.h5"
    whole = scheme.run(build(k)[0], **options)
    scheme.run(build(k)[0], **options, file=file, checkpoint_every=5)
    assert whole.elastic[5] > 0.0
    # a step whose contacts change in turns ends soon, and is divided
    assert np.diff(whole.iterations).max() < 300
    resumed = scheme.resume(build(k)[0], file, progress=False)
    for name in ("frames", "velocities", "elastic"):
        np.testing.assert_array_equal(getattr(resumed, name), getattr(whole, name))


@pytest.mark.parametrize(("courant", "part"), [(5.0, 1.0), (5.0, 0.2), (10.0, 0.2)])
def test_a_bar_on_a_wall_gains_nothing_and_does_not_rattle(courant, part):
    found = elastic_bar.run(fl.EnergyDecaying(radius=0.8), courant, part)
    assert found["energy"] <= 1.0 + 1e-12
    assert found["noise"] < 0.03
    assert abs(found["force"] - 1.0) < 0.015
