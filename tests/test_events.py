"""Events: times by closed forms, plastic impacts, release, checkpoints, messages."""

import numpy as np
import pytest

import fem_lie as fl
from fem_lie.schemes import Event, Lock, Release, Stop

SCHEME = fl.GeneralisedAlpha(radius=1.0)
MASS, LENGTH, SPRING, REST = 5.0, 1.0, 0.5, np.radians(108.0)
HIT = 2.56215
"""Time at which the panel reaches 90°: cos ωt = 1/6, ω² = 0.5/(5/3)."""


def panel(*actions, **how):
    """One panel, 5 kg and 1 m, hinged at its edge, with a torsion spring; an event at 90°."""
    scene = fl.Scene()
    inertia = MASS * LENGTH**2 / 12.0
    body = scene.add(fl.RigidBody(MASS, (1e-3, inertia, inertia), position=(0.5, 0.0, 0.0)))
    hinge = scene.add(
        fl.joints.Revolute(fl.ground(), body.point("centre"), at=(0, 0, 0), name="hinge")
    )
    scene.add(fl.joints.Spring(hinge.angle, SPRING, rest=REST))
    latch = scene.add(fl.joints.Drive(hinge.angle, active=False, name="latch"))
    actions = [Lock(latch) if each == "lock" else each for each in actions]

    def opened(state):
        return state.coordinate(hinge) - 0.5 * np.pi

    scene.add(Event(opened, actions, **how))
    return scene


def test_panel_hits_its_stop_in_time():
    result = SCHEME.run(panel(Stop()), duration=4.0, step=0.002)
    assert abs(result.times[-1] - HIT) < 1e-5
    assert abs(result.coordinate("hinge")[-1] - 0.5 * np.pi) < 1e-9
    np.testing.assert_array_equal(result.steps.event_numbers, [0])


@pytest.mark.parametrize("step", [0.01, fl.schemes.AdaptiveStep(1e-5)])
def test_latched_panel_rests_and_lost_its_energy(step):
    result = SCHEME.run(panel("lock"), duration=4.0, step=step)
    first = np.flatnonzero(np.diff(result.times) == 0.0)[0]
    before, after = first, first + 1
    # energy conservation: ½ k (108°² − 18°²)
    lost = 0.5 * SPRING * (REST**2 - np.radians(18.0) ** 2)
    assert abs(result.steps.event_losses[0] - result.kinetic[before]) < 1e-12
    assert abs(result.kinetic[before] - lost) < 1e-4
    assert result.kinetic[after:].max() < 1e-20
    np.testing.assert_allclose(result.coordinate("hinge")[after:], 0.5 * np.pi, atol=1e-9)
    # the latch holds the torque of the spring
    torque = result.joint_force("latch")[-1, 5]
    np.testing.assert_allclose(torque, SPRING * np.radians(18.0), rtol=1e-6)
    assert np.abs(result.joint_force("latch")[:before]).max() == 0.0


@pytest.mark.parametrize("initially", [True, False], ids=["released", "inactive"])
def test_a_joint_that_does_not_act_is_not_violated(initially):
    scene = fl.Scene(gravity=(0, 0, -10.0))
    ball = scene.add(fl.RigidBody.ball(1.0, 0.1))
    hold = fl.joints.Spherical(fl.ground(), ball.point("centre"), active=initially)
    scene.add(hold)
    if initially:
        scene.add(Event(lambda state: state.time - 0.2, Release(hold)))
    result = SCHEME.run(scene, duration=0.5, step=0.01)
    assert np.ptp(result.position(ball.point("centre"))[:, 2]) > 0.1
    assert result.joint_violation(hold).max() < 1e-12


def docking(speed=0.3):
    """Two free bodies fly apart or together and are locked to each other."""
    scene = fl.Scene()
    a = scene.add(fl.RigidBody(2.0, (0.1, 0.2, 0.3), position=(0.0, 0.0, 0.0)))
    b = scene.add(fl.RigidBody(3.0, (0.3, 0.2, 0.4), position=(2.0, 0.4, 0.0)))
    b.add_velocity((-speed, 0.0, 0.0))
    rail = scene.add(fl.joints.Distance(a.point("centre"), b.point("centre"), name="rail"))
    rod = scene.add(fl.joints.Drive(rail.length, active=False, name="rod"))
    scene.add(Event(lambda state: state.coordinate(rail) - 1.5, Lock(rod), name="capture"))
    scene.add(Event(lambda state: state.time - 3.0, Release(rod)))
    return scene


def test_momentum_and_energy_over_events():
    result = SCHEME.run(docking(), duration=4.0, step=0.02)
    before = np.flatnonzero(np.diff(result.times) == 0.0)
    assert len(before) == 2
    for momentum in (result.momentum, result.angular_momentum):
        np.testing.assert_allclose(momentum[before + 1], momentum[before], atol=1e-13)
        # the scheme itself keeps it to its order
        np.testing.assert_allclose(momentum - momentum[0], 0.0, atol=1e-6)
    np.testing.assert_array_equal(result.steps.event_numbers, [0, 1])
    # a straight flight: x = 2 − 0.3 t, y = 0.4 until √(x² + y²) = 1.5
    x = np.sqrt(1.5**2 - 0.4**2)
    assert abs(result.steps.event_times[0] - (2.0 - x) / 0.3) < 1e-8
    # the impulse stops the relative velocity along the rod: ½ μ (v·n)², μ = 6/5
    lost = 0.5 * 1.2 * (0.3 * x / 1.5) ** 2
    assert abs(result.steps.event_losses[0] - lost) < 1e-10
    assert abs(result.steps.event_losses[1]) < 1e-12
    length = result.coordinate("rail")
    during = (result.times > result.steps.event_times[0]) & (result.times < 3.0)
    np.testing.assert_allclose(length[during], 1.5, atol=1e-8)
    assert length[-1] > 1.5 + 1e-3


@pytest.mark.parametrize("step", [0.02, fl.schemes.AdaptiveStep(1e-4)])
def test_resumed_to_the_last_bit_before_and_after_events(tmp_path, step):
    plan = {"duration": 4.0, "step": step, "checkpoint_every": 15}
    whole = SCHEME.run(docking(), file=tmp_path / "whole.h5", **plan)
    for k, end in enumerate((1.0, 2.5, 3.3)):
        path = tmp_path / f"{k}.h5"
        scene, calls = docking(), []

        def interrupt(state, end=end, calls=calls):
            if state.time > end and calls:
                raise InterruptedError("enough")
            calls.append(state.time)
            return 1.0

        scene.add(Event(interrupt, Stop(), name="interruption"))
        with pytest.raises(fl.ConvergenceError, match="InterruptedError: enough"):
            SCHEME.run(scene, file=path, **plan)
        again = docking()
        again.add(Event(lambda state: 1.0, Stop(), name="interruption"))
        resumed = SCHEME.resume(again, path)
        np.testing.assert_array_equal(resumed.times, whole.times)
        np.testing.assert_array_equal(resumed.frames, whole.frames)
        np.testing.assert_array_equal(resumed.velocities, whole.velocities)
        np.testing.assert_array_equal(resumed.steps.event_times, whole.steps.event_times)


def test_release_of_a_held_pendulum():
    """A hold-down until 1 s, then a fall of a hinged rod: as a run that starts then."""

    def pendulum(held):
        scene = fl.Scene(gravity=(0.0, -9.81, 0.0))
        rod = scene.add(fl.RigidBody(1.0, (1e-3, 0.08, 0.08), position=(0.5, 0.0, 0.0)))
        hinge = scene.add(
            fl.joints.Revolute(fl.ground(), rod.point("centre"), at=(0, 0, 0), name="hinge")
        )
        if held:
            hold = scene.add(fl.joints.Drive(hinge.angle))
            scene.add(Event(lambda state: state.time - 1.0, Release(hold)))
        return scene

    held = SCHEME.run(pendulum(True), duration=1.5, step=0.005)
    free = SCHEME.run(pendulum(False), duration=0.5, step=0.005)
    assert abs(held.steps.event_times[0] - 1.0) < 1e-9
    angle = held.coordinate("hinge")
    assert abs(angle[held.times < 1.0]).max() < 1e-12
    assert abs(angle[-1] - free.coordinate("hinge")[-1]) < 1e-7


@pytest.mark.parametrize("after", [1e-13, 1e-10, 1e-7])
def test_events_just_after_the_start_of_a_step(after):
    """What depends on the square of the size of such a short step must not be divided by it."""

    def pendulum(*events):
        scene = fl.Scene(gravity=(0.0, -9.81, 0.0))
        before = fl.ground()
        for k in range(2):
            body = scene.add(fl.RigidBody(1.0, (0.01, 0.08, 0.08), position=(0.5 + k, 0.0, 0.0)))
            scene.add(fl.joints.Revolute(before, body.point("centre"), at=(k, 0, 0)))
            before = body.point("centre")
        for event in events:
            scene.add(event)
        return scene

    plan = {"duration": 1.0, "step": 0.002}
    plain = SCHEME.run(pendulum(Event(lambda state: state.time - 9.0, Stop())), **plan)
    event = Event(lambda state: state.time - 0.5 - after, lambda state: None)
    result = SCHEME.run(pendulum(event), **plan)
    assert abs(result.steps.event_losses[0]) < 1e-8
    np.testing.assert_allclose(result.frames[-1], plain.frames[-1], atol=3e-5)


def test_locking_a_flexible_body_keeps_momentum():
    material = fl.Material(E=1e7, nu=0.3, density=1e3)
    scene = fl.Scene()
    beam = scene.add(
        fl.Beam.straight((0, 0, 0), (1, 0, 0), fl.Section.circle(0.02, material), cells=6)
    )
    other = scene.add(fl.RigidBody(0.5, (1e-3, 1e-3, 1e-3), position=(1.0, 0.3, 0.0)))
    other.add_velocity((0.0, -1.0, 0.0))
    gap = scene.add(fl.joints.Distance(beam.point("end"), other.point("centre"), name="gap"))
    rod = scene.add(fl.joints.Drive(gap.length, active=False))
    scene.add(Event(lambda state: state.coordinate(gap) - 0.1, Lock(rod)))
    result = fl.GeneralisedAlpha(radius=0.8).run(scene, duration=0.3, step=0.001)
    assert abs(result.steps.event_times[0] - 0.2) < 1e-9
    momentum = result.momentum
    after = np.flatnonzero(np.diff(result.times) == 0.0)[0] + 1
    np.testing.assert_allclose(momentum[after], momentum[after - 1], atol=1e-13)
    np.testing.assert_allclose(result.coordinate("gap")[after:], 0.1, atol=1e-7)


def bouncing(**how):
    """A mass that falls through the floor; a function of the user sees it there."""
    scene = fl.Scene(gravity=(0.0, 0.0, -10.0))
    ball = scene.add(fl.RigidBody(1.0, (0.1, 0.1, 0.1), position=(0.0, 0.0, 1.0)))
    heights, speeds = [], []

    def seen(state):
        heights.append(state.position(ball.point("centre"))[2])
        speeds.append(state.velocity(ball.point("centre"))[2])

    scene.add(Event(lambda state: state.position(ball.point("centre"))[2], seen, **how))
    return scene, heights, speeds


def test_functions_of_users_see_the_state():
    scene, heights, speeds = bouncing()
    result = SCHEME.run(scene, duration=1.0, step=0.05)
    assert abs(result.steps.event_times[0] - np.sqrt(0.2)) < 1e-9
    assert abs(heights[0]) < 1e-9 and abs(speeds[0] + np.sqrt(20.0)) < 1e-9


@pytest.mark.parametrize(("direction", "count"), [(0, 4), (1, 2), (-1, 2)])
def test_repeated_events_and_their_direction(direction, count):
    """x = cos 2πt passes through zero four times in two periods."""
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(1.0, (0.1, 0.1, 0.1), position=(1.0, 0.0, 0.0)))
    slide = scene.add(fl.joints.Prismatic(fl.ground(), body.point("centre"), axis=(1, 0, 0)))
    scene.add(fl.joints.Spring(slide.displacement, 4.0 * np.pi**2, rest=-1.0))
    rates = []
    scene.add(
        Event(
            lambda state: state.coordinate(slide) + 1.0,
            lambda state: rates.append(state.rate(slide)),
            direction=direction,
            repeated=True,
        )
    )
    result = SCHEME.run(scene, duration=2.0, step=0.01)
    assert len(rates) == count == len(result.steps.event_times)
    quarters = np.array([0.25, 0.75, 1.25, 1.75])
    expected = quarters if direction == 0 else quarters[(1 if direction > 0 else 0) :: 2]
    np.testing.assert_allclose(result.steps.event_times, expected, rtol=1e-3)
    signs = -np.cos(np.pi * np.arange(4)) if direction == 0 else direction * np.ones(2)
    np.testing.assert_allclose(rates, 2.0 * np.pi * signs, rtol=1e-3)


def test_lock_of_an_open_joint_contradicts_the_state():
    """The results up to the event are kept."""
    scene = docking()
    a, b = scene.bodies
    points = a.point("centre"), b.point("centre")
    weld = scene.add(fl.joints.Fixed(*points, at=(1, 0, 0), active=False))
    scene.add(Event(lambda state: state.time - 1.0, Lock(weld)))
    with pytest.raises(fl.ConvergenceError, match="contradicts the state") as error:
        SCHEME.run(scene, duration=4.0, step=0.02)
    assert error.value.result.times[-1] == pytest.approx(1.0)


def test_locked_constraints_that_follow_from_others():
    scene = docking()
    again = scene.add(fl.joints.Drive(scene.joints[0].length, active=False))
    scene.add(Event(lambda state: state.coordinate("rail") - 1.5, Lock(again)))
    with pytest.raises(fl.ConvergenceError, match="may follow from others") as error:
        SCHEME.run(scene, duration=4.0, step=0.02)
    assert error.value.result.times[-1] == pytest.approx(2.0 / 0.3 - np.sqrt(2.09) / 0.3)


def test_event_without_end():
    """Each time the condition moves ahead by a microsecond."""
    scene, level = docking(), [0.1]

    def ahead(state):
        level[0] += 1e-6

    scene.add(Event(lambda state: state.time - level[0], ahead, repeated=True, name="chatter"))
    with pytest.raises(fl.ConvergenceError, match="chatter happens without end") as error:
        SCHEME.run(scene, duration=0.4, step=0.01)
    assert error.value.result.times[-1] == pytest.approx(0.1, abs=1e-4)


WRONG = {
    "condition": (lambda: Event(3.0, Stop()), TypeError, "condition must be a function"),
    "action": (lambda: Event(abs, 3.0), TypeError, "action must be Lock"),
    "direction": (lambda: Event(abs, Stop(), direction=2), ValueError, "direction 1, −1 or 0"),
    "spring": (
        lambda: Lock(fl.joints.Distance(fl.ground(), fl.RigidBody(1.0, (1, 1, 1)).point("centre"))),
        ValueError,
        "no constraints of positions",
    ),
    "not a joint": (lambda: Release(3.0), TypeError, "a joint, drive or gear"),
}


@pytest.mark.parametrize(("make", "kind", "match"), WRONG.values(), ids=WRONG)
def test_wrong_events(make, kind, match):
    with pytest.raises(kind, match=match):
        make()


def test_vector_of_a_condition_and_strangers():
    scene, *_ = bouncing()
    scene.add(Event(lambda state: np.zeros(3), Stop(), name="vector"))
    with pytest.raises(RuntimeError, match="the condition of vector failed at time 0"):
        SCHEME.run(scene, duration=0.1, step=0.01)
    stranger = docking().connections[0]
    with pytest.raises(ValueError, match="switches rod, which is not in the scene"):
        scene.add(Event(abs, Lock(stranger)))


@pytest.mark.parametrize("scheme", [fl.EnergyMomentum(), fl.schemes.Variational(), fl.Explicit()])
def test_other_schemes_refuse_events_and_inactive_joints(scheme):
    with pytest.raises(ValueError, match="does not support events and inactive joints"):
        scheme.run(panel(Stop()), duration=0.1, step=0.01)
    with pytest.raises(ValueError, match="is inactive or switched by an event"):
        fl.statics(panel(Stop()))


def test_rates_relative_to_a_prescribed_motion():
    """A condition may contain the rate of a coordinate relative to a body whose motion is given."""
    scene = fl.Scene()
    belt = scene.add(fl.RigidBody(1.0, (0.1, 0.1, 0.1), name="belt"))
    mass = scene.add(fl.RigidBody(1.0, (0.1, 0.1, 0.1), name="mass"))
    belt.add_velocity((0.5, 0.0, 0.0))

    def frame(t):
        return np.vstack([(0.5 * t, 0.0, 0.0), np.eye(3)])

    scene.add(fl.PrescribedMotion(belt.point("centre"), frame))
    centre = mass.point("centre")
    slide = scene.add(fl.joints.Prismatic(belt.point("centre"), centre, axis=(1, 0, 0)))
    scene.add(fl.PointLoad(centre, force=(2.0, 0.0, 0.0)))
    scene.add(fl.schemes.Sensor("rate", lambda state: state.rate(slide)))
    # relative to the belt the mass moves at 2 t − 0.5
    scene.add(fl.schemes.Event(lambda state: state.rate(slide), fl.schemes.Stop()))
    result = fl.GeneralisedAlpha(radius=1.0).run(scene, duration=1.0, step=0.01)
    assert abs(result.times[-1] - 0.25) < 1e-9
    times = result.steps.sensor_times
    np.testing.assert_allclose(result.sensor("rate"), 2.0 * times - 0.5, atol=1e-8)


def test_events_that_change_nothing_do_not_happen():
    """A locked coordinate has a rate of round-off, whose sign must not lock it again."""
    scene = fl.Scene(gravity=(0.3, 0.0, -9.81))
    mass = scene.add(fl.RigidBody(1.0, (0.1, 0.1, 0.1), position=(0.3, 0.2, 0.1)))
    mass.add_velocity((-0.5, 0.0, 0.0))
    rail = fl.joints.Prismatic(fl.ground(), mass.point("centre"), axis=(1, 0, 0))
    scene.add(rail)
    pull = scene.add(fl.PointLoad(mass.point("centre"), force=(0.7, 0.0, 0.0)))
    stick = scene.add(fl.joints.Drive(rail.displacement, active=False))
    actions = fl.schemes.Lock(stick), fl.schemes.Scale(pull, 0.0)
    rate = {"direction": 1, "repeated": True}
    scene.add(fl.schemes.Event(lambda state: state.rate(rail), actions, **rate))
    again = fl.schemes.Release(stick), fl.schemes.Scale(pull, -1.0)
    scene.add(fl.schemes.Event(lambda state: state.time - 1.0, again))
    result = fl.GeneralisedAlpha(radius=0.8).run(scene, duration=1.5, step=0.01)
    np.testing.assert_array_equal(result.steps.event_numbers, [0, 1])
    np.testing.assert_allclose(result.steps.event_times, [0.5, 1.0], atol=1e-9)
