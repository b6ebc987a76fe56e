"""Limits of coordinates: impacts and rest by closed forms, momentum, checkpoints, messages."""

from time import thread_time

import divided_events
import numpy as np
import pytest

import fem_lie as fl
from fem_lie.joints import Limit

SCHEME = fl.GeneralisedAlpha(radius=1.0)
STEPS = [0.01, fl.schemes.AdaptiveStep(1e-4, largest=0.01)]
MASS, SPRING, REST = 5.0, 0.5, np.radians(108.0)


def faller(restitution=0.0, height=1.0, **load):
    """A mass on a vertical rail over a floor, g = 10."""
    scene = fl.Scene(gravity=(0.0, 0.0, -10.0))
    ball = scene.add(fl.RigidBody(2.0, (0.1, 0.1, 0.1), position=(0.0, 0.0, height)))
    rail = scene.add(fl.joints.Prismatic(fl.ground(), ball.point("centre"), name="rail"))
    scene.add(Limit(rail.displacement, lower=-height, restitution=restitution, name="floor"))
    if load:
        scene.add(fl.PointLoad(ball.point("centre"), **load))
    return scene


@pytest.mark.parametrize("step", STEPS)
def test_a_ball_bounces_and_comes_to_rest(step):
    """Falls of √(2 h/g), then flights of 2 eᵏ v/g until one is shorter than a step."""
    result = SCHEME.run(faller(0.5), duration=2.0, step=step)
    first, speed = np.sqrt(0.2), np.sqrt(20.0)
    flights = 0.2 * speed * 0.5 ** np.arange(1, 6)
    expected = first + np.cumsum([0.0, *flights])
    np.testing.assert_allclose(result.steps.event_times[:6], expected, atol=1e-9)
    # e² of the energy is left by each impact, and nothing at the end
    losses = 2.0 * 10.0 * 0.75 * 0.25 ** np.arange(6)
    np.testing.assert_allclose(result.steps.event_losses[:6], losses, rtol=1e-9)
    assert abs(result.steps.event_losses.sum() - 20.0) < 1e-8
    height = result.coordinate("rail") + 1.0
    assert height.min() > -1e-10
    rest = result.times > result.steps.event_times[-1]
    assert rest.sum() > 10 and np.abs(height[rest]).max() < 1e-10
    # the floor carries the weight of 2 kg, and pushes side A, the ground, down
    np.testing.assert_allclose(result.joint_force("floor")[-1, 2], -20.0, rtol=1e-9)
    assert result.kinetic[-1] < 1e-20


def sprung(stiffness, damping, stop, restitution):
    """A mass of 2 kg between a stiff spring and a force of 60 (1 − cos 8 t) N, and a stop."""
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(2.0, (0.1, 0.1, 0.1), name="cart"))
    rail = fl.joints.Prismatic(fl.ground(), body.point("centre"), axis=(1, 0, 0), name="rail")
    scene.add(rail)
    scene.add(fl.joints.Spring(rail.displacement, stiffness, damping))
    force = {"force": (60.0, 0, 0), "history": lambda t: 1.0 - np.cos(8.0 * t)}
    scene.add(fl.PointLoad(body.point("centre"), **force))
    scene.add(Limit(rail.displacement, upper=stop, restitution=restitution))
    return scene


@pytest.mark.parametrize(
    ("radius", "step", "spring"),
    [
        (0.9, 4e-3, (3e5, 50.0, 3.2e-4, 0.5)),
        (0.0, 1e-3, (10157.246, 0.0, 1.50944567e-3, 0.0)),
        (0.0, 1e-2, (4214893.18, 0.0, 1.36892576e-5, 0.3)),
        (0.5, 1e-2, (453489.867, 2.69, 2.61456967e-4, 0.5)),
    ],
    ids=["round-off of steps", "plastic", "unresolved", "damped"],
)
def test_a_stiff_spring_comes_to_rest_on_its_stop(radius, step, spring):
    """It stays until the force falls below that of the spring, however its impacts end.

    In the first case the sign of the gap at the end of a cut step depends on the matrix with which
    it is solved; in the others the spring pulls back at the impact, but not at the end of the step.
    """
    stiffness, stop = spring[0], spring[2]
    scheme = fl.GeneralisedAlpha(radius=radius)
    result = scheme.run(sprung(*spring), duration=0.8, step=fl.schemes.ConstantStep(step))
    times, x = result.steps.event_times, result.coordinate("rail")
    free = (2.0 * np.pi - np.arccos(1.0 - stiffness * stop / 60.0)) / 8.0
    np.testing.assert_allclose(times[-1], free, atol=1e-6)
    resting = (result.times > times[-2] + 2.0 * step) & (result.times < free)
    assert resting.sum() > 2
    np.testing.assert_allclose(x[resting], stop, atol=1e-9)
    assert x.max() < stop + 1e-9 and len(times) < 10


def panel(restitution=0.0):
    """One panel, 5 kg and 1 m, hinged at its edge, with a torsion spring and a stop at 90°."""
    scene = fl.Scene()
    inertia = MASS / 12.0
    body = scene.add(fl.RigidBody(MASS, (1e-3, inertia, inertia), position=(0.5, 0.0, 0.0)))
    hinge = fl.joints.Revolute(fl.ground(), body.point("centre"), at=(0, 0, 0), name="hinge")
    scene.add(hinge)
    scene.add(fl.joints.Spring(hinge.angle, SPRING, rest=REST))
    scene.add(Limit(hinge.angle, upper=0.5 * np.pi, restitution=restitution, name="stop"))
    return scene


@pytest.mark.parametrize("restitution", [0.0, 0.3])
def test_panel_at_its_stop(restitution):
    result = fl.GeneralisedAlpha(radius=0.9).run(panel(restitution), duration=12.0, step=0.005)
    assert abs(result.steps.event_times[0] - 2.56215) < 1e-5
    lost = 0.5 * SPRING * (REST**2 - np.radians(18.0) ** 2)
    np.testing.assert_allclose(result.steps.event_losses[0], (1 - restitution**2) * lost, rtol=1e-5)
    assert result.coordinate("hinge").max() < 0.5 * np.pi + 1e-10
    torque = result.joint_force("stop")[-1, 5]
    np.testing.assert_allclose(torque, SPRING * np.radians(18.0), rtol=1e-6)


def test_between_two_stops_without_loss():
    """A mass flies to and fro at 2 m/s between −0.5 m and 0.5 m: an impact every 0.5 s."""
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(1.0, (0.1, 0.1, 0.1)))
    body.add_velocity((2.0, 0.0, 0.0))
    rail = fl.joints.Prismatic(fl.ground(), body.point("centre"), axis=(1, 0, 0), name="rail")
    scene.add(rail)
    scene.add(Limit(rail.displacement, -0.5, 0.5, restitution=1.0))
    result = SCHEME.run(scene, duration=4.08, step=0.03)
    np.testing.assert_allclose(result.steps.event_times, 0.25 + 0.5 * np.arange(8), atol=1e-9)
    np.testing.assert_allclose(result.kinetic, 2.0, rtol=1e-12)
    np.testing.assert_allclose(np.abs(result.coordinate("rail")).max(), 0.5, atol=1e-9)


def test_momentum_over_an_impact_of_two_bodies():
    """A rod of variable length between two tumbling bodies reaches its end."""
    scene = fl.Scene()
    a = scene.add(fl.RigidBody(2.0, (0.1, 0.2, 0.3)))
    b = scene.add(fl.RigidBody(3.0, (0.3, 0.2, 0.4), position=(2.0, 0.4, 0.0)))
    b.add_velocity((-0.3, 0.0, 0.0))
    a.add_velocity(omega=(0.2, 0.3, -0.1), about=(0.0, 0.0, 0.0))
    ends = a.point((0.1, 0.0, 0.1)), b.point("centre")
    rail = scene.add(fl.joints.Distance(*ends, name="rail"))
    scene.add(Limit(rail.length, lower=1.5, restitution=0.6))
    rates = []
    event = fl.schemes.Event(
        lambda state: state.coordinate(rail) - 1.51,
        lambda state: rates.append(state.rate(rail)),
        repeated=True,
    )
    scene.add(event)
    result = SCHEME.run(scene, duration=3.0, step=0.02)
    numbers = result.steps.event_numbers
    np.testing.assert_array_equal(numbers, [0, 1, 0])
    before = np.flatnonzero(np.diff(result.times) == 0.0)[1]
    for momentum in (result.momentum, result.angular_momentum):
        np.testing.assert_allclose(momentum[before + 1], momentum[before], atol=1e-13)
    assert result.steps.event_losses[1] > 1e-3
    # close to the impact the rate is reversed by the coefficient of restitution
    assert abs(rates[1] / rates[0] + 0.6) < 0.02


@pytest.mark.parametrize("step", STEPS)
def test_a_lifted_mass_leaves_its_stop(step):
    """A lift of 40 N/s · t on 2 kg, g = 10: it leaves at 0.5 s, then z = (20/6) (t − 0.5)³."""
    lift = {"force": (0.0, 0.0, 40.0), "history": lambda t: t}
    result = SCHEME.run(faller(height=0.0, **lift), duration=1.0, step=step)
    first, last = result.steps.event_times
    assert first == 0.0 and abs(last - 0.5) < 1e-6
    exact = 20.0 / 6.0 * np.maximum(result.times - 0.5, 0.0) ** 3
    np.testing.assert_allclose(result.coordinate("rail"), exact, atol=1e-4)
    force = result.joint_force("floor")[:, 2]
    pressed = result.times < 0.49
    np.testing.assert_allclose(
        force[pressed][2:], 40.0 * result.times[pressed][2:] - 20.0, atol=1e-8
    )
    assert np.abs(force[result.times > 0.51]).max() == 0.0


def test_a_flexible_arm_rests_on_its_stop():
    """A cantilever under its weight on a stop at its tip: a propped beam, reaction 3/8 of it."""
    material = fl.Material(E=1e7, nu=0.3, density=1e3)
    section = fl.Section.rectangle(0.02, 0.02, material)
    arm = fl.Beam.straight(
        (0, 0, 0), (1, 0, 0), section, cells=8, damping=fl.sections.Damping(mass=6.0)
    )
    scene = fl.Scene(gravity=(0, 0, -0.1))
    scene.add(arm)
    scene.add(fl.Clamp(arm.point("start")))
    tip = scene.add(fl.joints.Distance(fl.ground(), arm.point("end"), at=(1, 0, -1), to=(1, 0, 0)))
    scene.add(Limit(tip.length, lower=1.0 - 1e-4, name="stop"))
    result = fl.GeneralisedAlpha(radius=0.5).run(scene, duration=4.0, step=0.01)
    force = abs(result.joint_force("stop")[-1, 2])
    np.testing.assert_allclose(force, 0.375 * 0.04, rtol=0.2)
    assert result.position(arm.point("end"))[:, 2].min() > -1e-4 - 1e-8


@pytest.mark.parametrize("step", STEPS)
def test_resumed_to_the_last_bit(tmp_path, step):
    plan = {"duration": 2.0, "step": step, "checkpoint_every": 17}
    whole = SCHEME.run(faller(0.5), file=tmp_path / "whole.h5", **plan)
    for k, end in enumerate((0.6, 1.2, 1.6)):
        path = tmp_path / f"{k}.h5"

        def late(t, end=end):
            if t > end:
                raise InterruptedError("enough")
            return 0.0

        scene = faller(0.5, force=(0.0, 0.0, 1.0), history=late)
        with pytest.raises(InterruptedError):
            SCHEME.run(scene, file=path, **plan)
        again = faller(0.5, force=(0.0, 0.0, 1.0), history=lambda t: 0.0)
        resumed = SCHEME.resume(again, path)
        np.testing.assert_array_equal(resumed.times, whole.times)
        np.testing.assert_array_equal(resumed.frames, whole.frames)
        np.testing.assert_array_equal(resumed.steps.event_losses, whole.steps.event_losses)
    with pytest.raises(ValueError, match="floor"):
        SCHEME.resume(faller(0.4), tmp_path / "whole.h5")


WRONG = {
    "crossed": ({"lower": 0.5, "upper": -0.5}, "expected lower < upper, got 0.5 and -0.5"),
    "none": ({}, "expected lower, upper or both"),
    "restitution": ({"upper": 1.0, "restitution": 1.5}, "expected a restitution from 0 to 1"),
    "start": ({"lower": 0.1}, "expected an initial value between 0.1 and inf, got 0"),
    "vector": ({"lower": (1, 2)}, "lower"),
}


@pytest.mark.parametrize(("how", "match"), WRONG.values(), ids=WRONG)
def test_wrong_limits(how, match):
    scene = faller()
    with pytest.raises((ValueError, TypeError), match=match):
        scene.add(Limit(scene.joints[0].displacement, **how))


def test_limits_switch_themselves():
    scene = faller()
    with pytest.raises(ValueError, match="floor is a limit, which switches itself"):
        fl.schemes.Lock(scene.connections[0])
    with pytest.raises(TypeError, match="Limit: coordinate must be a coordinate"):
        Limit(scene.joints[0], lower=-1.0)


@pytest.mark.parametrize("scheme", [fl.EnergyMomentum(), fl.schemes.Variational(), fl.Explicit()])
def test_other_schemes_refuse_limits(scheme):
    with pytest.raises(ValueError, match="does not support events and inactive joints"):
        scheme.run(faller(), duration=0.1, step=0.01)
    with pytest.raises(ValueError, match="is inactive or switched by an event"):
        fl.statics(faller())


def test_a_stop_that_contradicts_a_drive():
    """The drive runs through the stop: there the stop follows from the drive."""
    scene = faller()
    scene.add(fl.joints.Drive(scene.joints[0].displacement, lambda t: -2.0 * t**2))
    with pytest.raises(fl.ConvergenceError, match="may follow from others") as error:
        SCHEME.run(scene, duration=1.0, step=0.01)
    assert error.value.result.times[-1] == pytest.approx(np.sqrt(0.5))


def test_compiled_steps_are_those_of_python():
    """A sensor is evaluated after each step in Python; without it most steps are in the loop."""
    plan = {"duration": 6.0, "step": 0.002, "save_every": 100}
    scheme, found = fl.GeneralisedAlpha(radius=0.9), []
    scheme.run(panel(0.3), duration=0.1, step=0.002)
    for watched in (False, True):
        scene = panel(0.3)
        if watched:
            scene.add(fl.schemes.Sensor("angle", lambda state: state.coordinate("hinge")))
        start = thread_time()
        result = scheme.run(scene, **plan)
        found.append((result, thread_time() - start))
    (loop, short), (python, long) = found
    assert short < 0.7 * long
    np.testing.assert_allclose(loop.times, python.times, atol=1e-11)
    np.testing.assert_allclose(loop.frames, python.frames, atol=1e-11)
    np.testing.assert_allclose(loop.elastic, python.elastic, atol=1e-11)
    np.testing.assert_allclose(loop.steps.event_times, python.steps.event_times, atol=1e-11)
    np.testing.assert_allclose(loop.steps.times, python.steps.times, atol=1e-11)
    for name in ("rotation", "translation"):
        errors = [getattr(each.steps, name) for each in (loop, python)]
        np.testing.assert_allclose(errors[0], errors[1], rtol=1e-6, atol=1e-14)


def test_a_stop_is_found_among_constraints_of_other_kinds():
    """Constraints of other kinds come after all others, whatever was added first."""
    times = []
    for skates in (False, True):
        scene = fl.Scene(gravity=(0.0, 0.0, -10.0))
        if skates:
            skate = scene.add(fl.RigidBody(1.0, (0.1, 0.1, 0.1), position=(3.0, 0.0, 0.0)))
            scene.add(fl.joints.Prismatic(fl.ground(), skate.point("centre"), axis=(1, 0, 0)))
            blade = scene.add(fl.RigidBody(1.0, (0.1, 0.1, 0.1), position=(5.0, 0.0, 0.0)))
            scene.add(fl.joints.KnifeEdge(fl.ground(), blade.point("centre"), axis=(0, 1, 0)))
        ball = scene.add(fl.RigidBody(2.0, (0.1, 0.1, 0.1), position=(0.0, 0.0, 1.0)))
        rail = scene.add(fl.joints.Prismatic(fl.ground(), ball.point("centre")))
        scene.add(Limit(rail.displacement, lower=-1.0, restitution=0.5))
        times.append(SCHEME.run(scene, duration=1.0, step=0.01).steps.event_times)
    assert len(times[0]) == 2
    np.testing.assert_allclose(times[1], times[0], rtol=1e-12)


def test_energy_balance_of_impacts_in_compiled_steps():
    """A step that the compiled loop takes back leaves nothing in the balance."""
    found = []
    for watched in (False, True):  # sensors need Python after each step
        scene, _ = divided_events.stops()
        if watched:
            scene.add(fl.schemes.Sensor("nothing", lambda state: 0.0))
        run = divided_events.SCHEME.run(scene, duration=0.05, step=divided_events.STEP)
        assert len(run.steps.event_times) >= 5
        # what impacts have lost, as damped steps lose little here
        assert abs(run.balance[-1, 0] + run.steps.event_losses.sum()) < 1e-12
        found.append(run.balance)
    np.testing.assert_allclose(found[0], found[1], rtol=0, atol=1e-12)
