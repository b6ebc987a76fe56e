"""Contact of nodes with positions only: nets and discrete cables with round surfaces."""

from __future__ import annotations

import numpy as np
import pytest

import fem_lie as fl

CABLE = fl.Section.circle(1e-3, fl.Material(E=1e9, nu=0.3, density=1000.0))
RADIUS = 0.2


def net(count: int = 9) -> fl.Net:
    """A square net of 1 m, of straight cables."""
    along = np.linspace(-0.5, 0.5, count)
    x, y = np.meshgrid(along, along, indexing="ij")
    positions = np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3)
    numbers = np.arange(count**2).reshape(count, count)
    return fl.Net(positions, [*numbers, *numbers.T], CABLE)


def caught(*, free: bool = True, friction: float = 0.0) -> fl.Scene:
    """It meets a free ball, or one that is fixed."""
    scene, cables = fl.Scene(), net()
    scene.add(cables)
    middle = np.array([0.03, 0.02, -RADIUS - 0.01]) if free else np.zeros(3)
    if not free:
        cables.frames[:, 0] += [-0.03, -0.02, RADIUS + 0.01]
    cables.add_velocity((0.1, 0.0, -3.0))
    point = fl.ground()
    if free:
        point = scene.add(fl.RigidBody(0.1, 1e-3 * np.eye(3), middle)).point("centre")
    nodes = fl.contact.Vertices(
        [fl.extend.Point(cables, k) for k in range(len(cables.frames))], 1e-3
    )
    law = fl.contact.Penalty(1e3, friction=friction)
    scene.add(fl.contact.Contact(nodes, fl.contact.Sphere(point, RADIUS), law))
    return scene


OPTIONS = {"duration": 0.03, "step": 5e-4, "progress": False}


@pytest.mark.parametrize("free", [True, False], ids=["free ball", "fixed ball"])
def test_energy_and_momenta_stay(free):
    scene = caught(free=free)
    result = fl.EnergyMomentum().run(scene, **OPTIONS)
    assert result.balance_error < 1e-12
    assert max(result.momentum_error, result.angular_momentum_error) < 1e-13
    touches = fl.post.contact_forces(result, scene.contacts[0])
    assert touches.touching.max() > 0
    # it is wrapped about the ball
    assert result.elastic.max() > 1e-2 * result.kinetic[0]


def test_friction_on_a_ball_takes_energy_alone():
    """Of nodes that take no moment: the ball has it all."""
    result = fl.EnergyMomentum().run(caught(friction=0.3), **OPTIONS)
    assert np.diff(result.balance[:, 1]).min() >= 0.0
    assert result.balance[-1, 1] > 1e-4 * result.kinetic[0]
    assert result.balance_error < 1e-11
    assert max(result.momentum_error, result.angular_momentum_error) < 1e-13


def test_dissipation_takes_energy_alone():
    result = fl.EnergyDecaying(radius=0.5).run(caught(), **OPTIONS)
    assert max(result.momentum_error, result.angular_momentum_error) < 1e-11
    assert np.diff(result.total_energy).max() < 1e-12 * result.kinetic[0]
    assert result.total_energy[-1] < 0.9999 * result.total_energy[0]


def test_schemes_agree():
    """Until it has bounced often: of second order both."""
    states = []
    for scheme in (fl.EnergyMomentum(), fl.GeneralisedAlpha(radius=1.0)):
        result = scheme.run(caught(), duration=0.006, step=1e-4, progress=False)
        states.append(result.frames[-1][:, 0])
    moved = 3.0 * 0.006
    assert np.abs(states[0] - states[1]).max() < 1e-2 * moved


def test_a_restart_agrees_to_the_last_bit(tmp_path):
    options = {**OPTIONS, "checkpoint_every": 25}
    whole = fl.EnergyMomentum().run(caught(), **options, file=tmp_path / "whole.h5")
    fl.EnergyMomentum().run(caught(), **options, file=tmp_path / "run.h5")
    resumed = fl.EnergyMomentum().resume(caught(), tmp_path / "run.h5", progress=False)
    for name in ("frames", "elastic", "iterations"):
        np.testing.assert_array_equal(getattr(resumed, name), getattr(whole, name))


def test_rotating_surfaces_need_axes():
    cables, scene = net(3), fl.Scene()
    scene.add(cables)
    with pytest.raises(ValueError, match=r"Plane on net.* needs nodes with frames"):
        floor = fl.contact.Plane(cables.point(8), (0, 0, 1))
        scene.add(
            fl.contact.Contact(
                fl.contact.Sphere(cables.point(0), 0.01), floor, fl.contact.Penalty(1e3)
            )
        )


def test_friction_needs_a_side_that_takes_its_moment():
    """On ground or on frames; threads have none against each other."""
    cables = net(3)
    lines = [fl.contact.Line(each, 1e-3) for each in (cables, net(3))]
    law = fl.contact.Penalty(1e3, friction=0.1)
    nodes = fl.contact.Vertices([cables.point(0)], 1e-3)
    fl.contact.Contact(nodes, fl.contact.Plane(fl.ground((0, 0, -1)), (0, 0, 1)), law).check()
    for a, b in (lines, [lines[0], lines[0]]):
        with pytest.raises(ValueError, match=r"friction acts on surfaces.*do not take"):
            fl.contact.Contact(a, b, law).check()
