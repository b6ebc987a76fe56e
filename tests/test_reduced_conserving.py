"""Reduced-order bodies in structure-preserving schemes: laws, order, joints, loads, resume."""

import numpy as np
import pytest

import fem_lie as fl
from tests.interruption import interrupted

RUBBER = fl.Material(E=2e8, nu=0.3, density=2000.0)
SCHEMES = {
    "conserving": fl.EnergyMomentum(),
    "decaying": fl.EnergyDecaying(radius=0.8),
    "composed": fl.schemes.Composed(),
}


def bowed(name="rod", at=(0.0, 0.0, 0.0)):
    """A soft beam of one metre that no mirror leaves as it is, with its scene."""
    scene, section = fl.Scene(), fl.Section.rectangle(0.02, 0.03, RUBBER)

    def position(s):
        return tuple(np.add(at, (s, 0.1 * np.sin(np.pi * s), 0.1 * s**2)))

    return scene, scene.add(fl.Beam(fl.mesh.curve(position, 6), section, name=name, up=(0, 0, 1)))


def reduced(modes=4, name="rod", at=(0.0, 0.0, 0.0)):
    scene, beam = bowed(name, at)
    return fl.reduction.reduced_order_body(
        scene, [beam.point("start"), beam.point("end")], modes, name=name
    )


def free(modes=4):
    """It turns, and one end of it moves away from the other."""
    scene = fl.Scene()
    body = scene.add(reduced(modes))
    body.add_velocity(omega=(0.0, 2.0, 8.0), about=(0.5, 0.0, 0.0))
    body.velocities[1, 1] += 1.0
    return scene, body


def hanging(body):
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(body)
    scene.add(fl.joints.Revolute(fl.ground(), body.point("start"), axis=(0, 1, 0)))
    return scene


def change(values):
    """The largest change of a quantity from the start, over its size."""
    return np.abs(values - values[0]).max() / np.abs(values).max()


@pytest.mark.parametrize("modes", [0, 4])
@pytest.mark.parametrize("scheme", SCHEMES.values(), ids=SCHEMES)
def test_a_free_body_keeps_energy_and_momenta(scheme, modes):
    result = scheme.run(free(modes)[0], duration=0.1, step=1e-3)
    assert result.elastic.max() > 1e-3 * result.kinetic[0]
    assert result.balance_error < 1e-12
    assert change(result.momentum) < 1e-12
    assert change(result.angular_momentum) < 1e-12
    energy = result.total_energy
    if isinstance(scheme, fl.EnergyDecaying):
        assert energy[-1] < (1.0 - 1e-5) * energy[0]
        assert np.diff(energy).max() < 1e-13 * energy[0]
    else:
        assert change(energy) < 1e-12


@pytest.mark.parametrize(
    ("scheme", "order"),
    [(fl.schemes.Variational(), 2), (fl.schemes.Composed(fl.schemes.Variational()), 4)],
    ids=str,
)
def test_variational_steps_keep_momenta_and_an_energy_that_does_not_drift(scheme, order):
    errors = []
    for step in (1e-3, 5e-4):
        result = scheme.run(free()[0], duration=0.1, step=step)
        assert change(result.momentum) < 1e-12
        assert change(result.angular_momentum) < 1e-12
        errors.append(change(result.total_energy))
    assert errors[0] < 1e-4
    assert 0.7 * 2**order < errors[0] / errors[1] < 1.5 * 2**order


def test_variational_steps_with_dampers_and_joints():
    """What gyroscopic inertia does is no damping: the balance closes to second order."""
    errors = []
    for step in (1e-3, 5e-4):
        scene = chain()
        link = scene.add(
            fl.joints.Distance(fl.ground(), scene.bodies[0].point("end"), at=(1.0, 0.0, -1.0))
        )
        scene.add(fl.joints.Spring(link.length, 50.0, damping=5.0))
        result = fl.schemes.Variational().run(scene, duration=0.1, step=step)
        assert np.abs(result.joint_violations).max() < 1e-13
        errors.append(result.balance_error)
    assert errors[0] < 1e-4 and 3.0 < errors[0] / errors[1] < 5.5


def test_a_free_body_far_from_the_origin_keeps_them_too():
    """Its coordinates are differences of positions, which there have four digits less."""
    scene = fl.Scene()
    body = scene.add(reduced(4, at=(1e4, 0.0, 0.0)))
    body.add_velocity(omega=(0.0, 2.0, 8.0), about=(1e4 + 0.5, 0.0, 0.0))
    result = fl.EnergyMomentum().run(scene, duration=0.05, step=1e-3)
    assert result.elastic.max() > 1e-4 * result.kinetic[0]
    assert change(result.total_energy) < 1e-12


@pytest.mark.parametrize(
    "scheme", [SCHEMES["conserving"], SCHEMES["decaying"], fl.schemes.Variational()], ids=str
)
def test_it_is_of_second_order(scheme):
    """Against generalised-α at fine steps."""

    def end(scheme, step):
        scene = hanging(reduced(2))
        return scheme.run(scene, duration=0.16, step=step, record=fl.schemes.Record.FRAMES).frames[
            -1
        ]

    exact = end(fl.GeneralisedAlpha(radius=1.0, tolerance=1e-10), 2e-5)
    coarse, fine = (np.abs(end(scheme, h) - exact).max() for h in (1e-4, 5e-5))
    assert fine < 2e-6 and 3.3 < coarse / fine < 4.7


def test_it_moves_as_the_full_body():
    full = bowed()[1]
    body = reduced(6)
    found, whole = (
        fl.EnergyMomentum().run(hanging(each), duration=0.2, step=1e-3) for each in (body, full)
    )
    found = fl.reduction.recover_full_motion(found, body)
    moved = np.abs(whole.frames[:, :, 0] - whole.frames[0, :, 0]).max()
    assert np.abs(found.frames[:, :, 0] - whole.frames[:, :, 0]).max() < 5e-3 * moved
    speed = np.abs(whole.velocities[:, :, :3]).max()
    assert np.abs(found.velocities[-1, :, :3] - whole.velocities[-1, :, :3]).max() < 2e-2 * speed


def chain():
    """A hinge on the ground, a ball joint to a second one, and a rigid body fixed to its end."""
    first, second = reduced(3, "a"), reduced(2, "b", at=(1.0, 0.0, 0.1))
    scene = hanging(first)
    scene.add(second)
    scene.add(fl.joints.Spherical(first.point("end"), second.point("start")))
    bob = scene.add(fl.RigidBody(0.5, (1e-3, 2e-3, 3e-3), second.point("end").position, name="bob"))
    scene.add(fl.joints.Fixed(second.point("end"), bob.point("centre")))
    return scene


@pytest.mark.parametrize("scheme", SCHEMES.values(), ids=SCHEMES)
def test_joints_at_both_ends(scheme):
    result = scheme.run(chain(), duration=0.1, step=1e-3)
    assert result.kinetic[-1] > 1.0
    assert result.balance_error < 1e-12
    assert result.momentum_error < 1e-11
    assert np.abs(result.joint_violations).max() < 1e-13


def test_bodies_with_steps_of_their_own():
    scene = chain()
    scheme = fl.schemes.MultiRate({scene.bodies[1]: 3})
    result = scheme.run(scene, duration=0.03, step=1e-3)
    assert result.balance_error < 1e-9
    assert np.abs(result.joint_violations).max() < 1e-11
    alone = fl.EnergyMomentum().run(scene, duration=0.03, step=2.5e-4)
    np.testing.assert_allclose(result.frames[-1], alone.frames[-1], atol=3e-4)
    np.testing.assert_allclose(result.kinetic[-1], alone.kinetic[-1], rtol=1e-3)


LOADS = {
    "force": lambda at, history: fl.PointLoad(at, force=(3.0, 1.0, -2.0), history=history),
    "following force": lambda at, history: fl.PointLoad(
        at, force=(0.0, 2.0, 1.0), following=True, history=history
    ),
    "moment": lambda at, history: fl.PointLoad(at, moment=(0.5, -0.3, 0.8), history=history),
}


@pytest.mark.parametrize("history", [None, lambda t: 1.0 + np.sin(40.0 * t)], ids=["", "history"])
@pytest.mark.parametrize("load", LOADS.values(), ids=LOADS)
@pytest.mark.parametrize("name", ["conserving", "decaying"])
def test_loads_at_an_interface(name, load, history):
    """Work and impulses are accounted for, and the motion is that of generalised-α."""
    body = reduced(3)
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(body)
    scene.add(load(body.point("end"), history))
    result = SCHEMES[name].run(scene, duration=0.04, step=2e-4)
    assert np.abs(result.balance[-1]).max() > 1e-3 or load is LOADS["force"]
    assert result.balance_error < 1e-12
    assert result.momentum_error < 1e-12
    other = fl.GeneralisedAlpha(radius=0.9, tolerance=1e-8).run(scene, duration=0.04, step=5e-5)
    moved = np.abs(other.frames - other.frames[0]).max()
    np.testing.assert_allclose(result.frames[-1], other.frames[-1], atol=3e-3 * moved)


def test_dampers_at_an_interface():
    body = reduced(3)
    scene = hanging(body)
    link = scene.add(fl.joints.Distance(fl.ground(), body.point("end"), at=(1.0, 0.0, -1.0)))
    scene.add(fl.joints.Spring(link.length, 50.0, damping=5.0))
    result = fl.EnergyMomentum().run(scene, duration=0.2, step=1e-3)
    assert result.balance[-1, 1] > 0.1
    assert result.balance_error < 1e-12


def test_clamps_have_reactions():
    """The mean of the force at a clamped interface is the weight."""
    body = reduced(2)
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(body)
    scene.add(fl.Clamp(body.point("start")))
    result = fl.EnergyMomentum().run(scene, duration=0.1, step=1e-3)
    assert result.balance_error < 1e-12
    assert result.momentum_error < 1e-11
    weight = 9.81 * 2000.0 * 0.02 * 0.03 * bowed()[1].model.lengths.sum()
    gained = result.momentum[-1, 2] - result.momentum[0, 2]
    lift = -weight * 0.1
    assert result.impulses[-1, 0, 2] == pytest.approx(lift, rel=1e-3)
    assert gained == pytest.approx(result.impulses[-1, :, 2].sum(), abs=1e-10)


def test_beside_cables():
    """A rope on its end, whose nodes are no frames."""
    body = reduced(3)
    scene = hanging(body)
    end = np.asarray(body.point("end").position)
    section = fl.Section.circle(0.004, RUBBER)
    rope = fl.Cable(
        fl.mesh.curve(lambda s: (end[0] + 0.5 * s, end[1], end[2]), 4), section, name="rope"
    )
    scene.add(rope)
    scene.add(fl.joints.Spherical(body.point("end"), rope.point("start")))
    result = fl.EnergyMomentum().run(scene, duration=0.05, step=1e-3)
    assert result.balance_error < 1e-11
    assert np.abs(result.joint_violations).max() < 1e-12


def test_a_drive_that_stops():
    """Its jump of velocity is an impulse on the products, too, whose work is counted."""
    body = reduced(2)
    scene = fl.Scene()
    scene.add(body)
    angle = fl.loads.PiecewiseLinear([0.0, 0.05, 0.1], [0.0, 0.02, 0.02])
    hinge = scene.add(fl.joints.Revolute(fl.ground(), body.point("start"), axis=(0, 0, 1)))
    scene.add(fl.joints.Drive(hinge.angle, angle))
    body.add_velocity(omega=(0.0, 0.0, 0.4), about=(0.0, 0.0, 0.0))
    choice = fl.schemes.AdaptiveStep(1e-3, events=(0.05,))
    result = fl.EnergyMomentum().run(scene, duration=0.1, step=choice)
    assert abs(result.balance[-1, 0]) > 1e-5 * result.kinetic[0]
    assert result.balance_error < 1e-11


@pytest.mark.parametrize("scheme", [fl.EnergyMomentum(), fl.GeneralisedAlpha()], ids=str)
def test_steps_are_chosen_as_for_the_full_body(scheme):
    """The error that a step is estimated to have is that of the same inertia."""
    counts = []
    for each in (reduced(6), bowed()[1]):
        result = scheme.run(hanging(each), duration=0.1, step=fl.schemes.AdaptiveStep(1e-3))
        counts.append(len(result.times))
    assert 0.6 < counts[0] / counts[1] < 1.7


@pytest.mark.parametrize(
    ("scheme", "step"),
    [
        *((scheme, 1e-3) for scheme in (*SCHEMES.values(), fl.schemes.Variational())),
        (SCHEMES["conserving"], fl.schemes.AdaptiveStep(1e-2)),
        (SCHEMES["decaying"], fl.schemes.AdaptiveStep(1e-2)),
    ],
    ids=str,
)
def test_resumed_to_the_last_bit(tmp_path, scheme, step):
    plan = {"duration": 0.03, "step": step, "checkpoint_every": 7}
    if not isinstance(step, float):
        plan["checkpoint_every"] = 2
    whole = scheme.run(chain(), **plan, file=tmp_path / "whole.h5")
    with interrupted(2):
        scheme.run(chain(), **plan, file=tmp_path / "run.h5")
    again = scheme.resume(chain(), tmp_path / "run.h5")
    for quantity in ("times", "frames", "velocities", "kinetic", "elastic", "joint_forces"):
        found, wanted = getattr(again, quantity), getattr(whole, quantity)
        np.testing.assert_array_equal(found, wanted, err_msg=quantity)
