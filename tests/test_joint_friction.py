"""Friction in joints: closed forms, a pendulum against scipy, checkpoints, messages."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fem_lie as fl
from fem_lie.joints import JointFriction

G, SLOW = 9.81, 1e-3


def driven_by(joint_of, gravity=(0, 0, -G), mass=2.0, inertia=(0.1, 0.1, 0.1), **friction):
    """A body at the origin in a joint with friction; the scene, the body and the joint."""
    scene = fl.Scene(gravity=gravity)
    body = scene.add(fl.RigidBody(mass, inertia))
    joint = scene.add(joint_of(fl.ground(), body.point("centre")))
    given = {"coefficient": 0.25, "stiction_speed": SLOW, "name": "friction"} | friction
    scene.add(JointFriction(joint, **given))
    return scene, body, joint


def slider(**given):
    return driven_by(lambda a, b: fl.joints.Prismatic(a, b, axis=(1, 0, 0)), **given)


def hinge(axis=(0, 1, 0), **given):
    return driven_by(lambda a, b: fl.joints.Revolute(a, b, axis=axis), **given)


def speed_on_slope(drive, friction, slow, time):
    """Speed from rest under ``v' = drive − friction tanh(v/slow)``, once tanh is 1."""
    late = friction * np.log(2.0 * drive / (drive - friction)) / (drive**2 - friction**2)
    return (drive - friction) * (time + slow * late)


@pytest.mark.parametrize("side", ["a", "b"])
@pytest.mark.parametrize("step", [1e-4, fl.schemes.AdaptiveStep(1e-6, first=1e-4)])
def test_block_slides_down_a_slope(side, step):
    """a = g (sin − μ cos), with the delay of the regularised law."""
    joints = {
        "a": lambda a, b: fl.joints.Prismatic(a, b, axis=(1, 0, 0)),
        "b": lambda a, b: fl.joints.Prismatic(b, a, axis=(-0.8, 0, -0.6)),
    }
    down = {"a": (0.6 * G, 0, -0.8 * G), "b": (0, 0, -G)}
    scene, *_ = driven_by(joints[side], gravity=down[side], stiction_speed=0.02)
    # by default iterations end at 2e-8
    result = fl.GeneralisedAlpha(tolerance=1e-10).run(scene, duration=0.2, step=step)
    speed = np.linalg.norm(result.velocities[-1, 0, :3])
    exact = speed_on_slope(0.6 * G, 0.25 * 0.8 * G, 0.02, 0.2)
    assert abs(speed / exact - 1.0) < (1e-6 if step == 1e-4 else 1e-4)
    np.testing.assert_allclose(np.abs(result.joint_force("friction")[-1]).max(), 0.4 * G, rtol=1e-8)


def test_disc_on_its_journal_stops():
    """The moment μ m g r stops a disc after ω J/(μ m g r); the balance has its energy."""
    scene, body, joint = hinge(inertia=(0.04, 0.04, 0.04), coefficient=0.3, radius=0.05)
    body.add_velocity(omega=(0, 20.0, 0), about=(0, 0, 0))
    deceleration = 0.3 * 2.0 * G * 0.05 / 0.04
    end = 20.0 / deceleration
    result = fl.GeneralisedAlpha().run(scene, duration=1.2 * end, step=end / 500, save_every=1)
    rate = result.velocities[:, 0, 4]
    before = result.times < end - 0.02
    exact = 20.0 - deceleration * result.times
    np.testing.assert_allclose(rate[before], exact[before], rtol=5e-6)
    assert np.abs(rate[result.times > 1.01 * end]).max() < 1e-5
    way = 0.5 * 20.0 * end
    assert abs(result.coordinate(joint)[-1] / way - 1.0) < 1e-5
    lost = result.balance[-1, 1]
    assert abs(lost / (0.5 * 0.04 * 20.0**2) - 1.0) < 1e-5
    assert result.energy_error < 1e-4


def pendulum(coefficient=0.4, radius=0.1, kind=fl.joints.Revolute, **friction):
    scene = fl.Scene(gravity=(0, 0, -G))
    body = scene.add(fl.RigidBody(2.0, (0.02, 0.02, 0.02), position=(0.5, 0, 0), name="bob"))
    pin = kind(fl.ground(), body.point("centre"), at=(0, 0, 0), axis=(0, 1, 0))
    joint = scene.add(pin)
    scene.add(JointFriction(joint, coefficient, 0.02, radius=radius, name="friction", **friction))
    return scene, joint


def pendulum_rates(_, state, coefficient=0.4, radius=0.1):
    angle, rate = state
    friction, acceleration = coefficient * radius * np.tanh(radius * rate / 0.02), 0.0
    for _ in range(40):
        across = 0.5 * acceleration - G * np.cos(angle)
        along = 0.5 * rate**2 + G * np.sin(angle)
        moment = 2.0 * (0.5 * G * np.cos(angle) - friction * np.hypot(across, along))
        acceleration = moment / (0.02 + 2.0 * 0.25)
    return rate, acceleration


@pytest.mark.parametrize("kind", [fl.joints.Revolute, fl.joints.Spherical])
def test_pendulum_on_its_journal_against_scipy(kind):
    """Motion and energy balance of second order; the force of the joint changes with the motion."""
    exact = solve_ivp(pendulum_rates, (0, 2), (0, 0), "DOP853", rtol=1e-10, atol=1e-12).y[0, -1]
    errors, balances = [], []
    for step in (2e-3, 1e-3):
        scene, _ = pendulum(kind=kind)
        result = fl.GeneralisedAlpha().run(scene, duration=2.0, step=step)
        x, _, z = result.position("bob.centre")[-1]
        errors.append(abs(np.arctan2(-z, x) - exact))
        balances.append(result.energy_error)
    assert errors[1] < 3e-5 and 3.8 < errors[0] / errors[1] < 4.2
    assert balances[1] < 1e-5 and 3.8 < balances[0] / balances[1] < 4.2


def test_friction_costs_no_iterations_of_newtons_method():
    """The matrix has the derivatives in twists and multipliers: 1.8 a step with and without."""
    scheme = fl.GeneralisedAlpha(policy=fl.schemes.EveryIteration())
    counts = []
    for coefficient in (0.4, 0.0):
        scene, _ = pendulum(coefficient)
        counts.append(scheme.run(scene, duration=0.3, step=1e-3).iterations[-1])
    assert counts[0] <= 1.05 * counts[1]


def test_friction_of_a_shaft_is_along_its_slip():
    """With J = m r² both parts of the slip shrink alike: s' = −μ g, and their ratio stays."""
    scene, body, _ = driven_by(
        lambda a, b: fl.joints.Cylindrical(a, b, axis=(1, 0, 0)),
        inertia=(2.0 * 0.2**2, 0.1, 0.1),
        radius=0.2,
    )
    body.add_velocity((3.0, 0, 0), omega=(20.0, 0, 0), about=body.point("centre"))
    result = fl.GeneralisedAlpha().run(scene, duration=0.5, step=1e-3)
    velocity, spin = result.velocities[-1, 0, [0, 3]]
    np.testing.assert_allclose((velocity, 0.2 * spin), np.array((3.0, 4.0)) * (1 - 0.1 * 0.25 * G))
    assert result.energy_error < 1e-9
    force = result.joint_force("friction")[-1]
    np.testing.assert_allclose(np.abs(force[[2, 5]]) / (0.25 * 2.0 * G), (0.6, 0.2 * 0.8))


def screw(side="a", **given):
    """A nut on a vertical right-handed thread, 50 mm a turn; its lead angle has tan α = 0.398."""
    joints = {
        "a": lambda a, b: fl.joints.Screw(a, b, axis=(0, 0, 1), pitch=0.05),
        "b": lambda a, b: fl.joints.Screw(b, a, axis=(0, 0, -1), pitch=0.05),
    }
    return driven_by(joints[side], inertia=(2e-3, 2e-3, 2e-3), radius=0.02, **given)


LEAD = 0.05 / (2.0 * np.pi * 0.02)


@pytest.mark.parametrize("side", ["a", "b"])
@pytest.mark.parametrize("coefficient", [0.0, 0.1, 0.3])
def test_nut_runs_down_its_thread(side, coefficient):
    """Force N along the normal of the thread, μ N along the helix: both equations of motion."""
    scene, body, _ = screw(side, coefficient=coefficient, stiction_speed=1e-6)
    rate = -10.0
    body.add_velocity((0, 0, rate * 0.05 / (2.0 * np.pi)), omega=(0, 0, rate), about=(0, 0, 0))
    result = fl.GeneralisedAlpha().run(scene, duration=0.3, step=1e-3)
    cos = 1.0 / np.hypot(1.0, LEAD)
    sin = LEAD * cos
    along, around = cos + coefficient * sin, coefficient * cos - sin  # per N
    mass = 2.0 - 2e-3 / 0.02**2 / LEAD * along / around
    fall = -2.0 * G / mass
    change = result.velocities[-1, 0, 2] - result.velocities[0, 0, 2]
    np.testing.assert_allclose(change, 0.3 * fall, rtol=1e-8)
    assert result.energy_error < 1e-8
    # a nut that pushes at μ N along the helix, upwards and against its rotation
    normal = 2e-3 * fall / (0.02**2 * LEAD * around)
    force = np.abs(result.joint_force("friction")[-1, [2, 5]])
    np.testing.assert_allclose(force, coefficient * normal * np.array([sin, 0.02 * cos]), rtol=1e-7)


@pytest.mark.parametrize(("coefficient", "holds"), [(1.01 * LEAD, True), (0.99 * LEAD, False)])
def test_a_screw_locks_itself(coefficient, holds):
    """Above the tangent of its lead angle a thread holds a weight; it creeps at s₀ atanh(α/μ)."""
    scene, *_ = screw(coefficient=coefficient, stiction_speed=1e-5)
    result = fl.GeneralisedAlpha().run(scene, duration=0.2, step=1e-3)
    fall = -result.velocities[-1, 0, 2]
    if holds:
        creep = 1e-5 * np.arctanh(1.0 / 1.01) * LEAD / np.hypot(1.0, LEAD)
        np.testing.assert_allclose(fall, creep, rtol=1e-3)
    else:
        assert fall > 1e-4


@pytest.mark.parametrize("side", ["a", "b"])
def test_a_ball_in_its_socket_stops_about_its_axis(side):
    """The moment μ m g r opposes the angular velocity: it keeps its axis, its rate falls evenly."""
    joints = {
        "a": lambda a, b: fl.joints.Spherical(a, b),
        "b": lambda a, b: fl.joints.Spherical(b, a),
    }
    scene, body, _ = driven_by(joints[side], inertia=(0.04, 0.04, 0.04), radius=0.05)
    start = np.array([4.0, -2.0, 4.0])
    body.add_velocity(omega=start, about=(0, 0, 0))
    deceleration = 0.25 * 2.0 * G * 0.05 / 0.04
    end = 6.0 / deceleration
    result = fl.GeneralisedAlpha().run(scene, duration=1.1 * end, step=end / 500, save_every=1)
    before = result.times < end - 0.02
    exact = start * (1.0 - result.times[before, np.newaxis] / end)
    np.testing.assert_allclose(result.velocities[before, 0, 3:], exact, atol=2e-5)
    assert np.abs(result.velocities[-1, 0, 3:]).max() < 1e-5
    np.testing.assert_allclose(result.balance[-1, 1], 0.5 * 0.04 * 36.0, rtol=1e-5)


def test_a_puck_slides_and_spins():
    """With J = m r² both parts of the slip shrink alike, as those of a shaft."""
    inertia = (0.1, 0.1, 2.0 * 0.2**2)
    scene, body, _ = driven_by(fl.joints.Planar, inertia=inertia, radius=0.2)
    body.add_velocity((2.0, 1.0, 0), omega=(0, 0, 10.0), about=body.point("centre"))
    result = fl.GeneralisedAlpha().run(scene, duration=0.5, step=1e-3)
    slip = np.linalg.norm([2.0, 1.0, 2.0])
    left = 1.0 - 0.5 * 0.25 * G / slip
    velocity, spin = result.velocities[-1, 0].reshape(2, 3) @ result.frames[-1, 0, 1:]
    np.testing.assert_allclose(velocity, left * np.array([2.0, 1.0, 0.0]), atol=1e-7)
    np.testing.assert_allclose(spin, left * np.array([0.0, 0.0, 10.0]), atol=1e-6)
    assert result.energy_error < 1e-6


BEARINGS = {
    "preload": (slider, {"preload": 5.0}, (0, 0, 0), 2.0 * G + 5.0),
    "between the ends": (slider, {"length": 0.4}, (0.1, 0, 0), 2.0 * G),
    "beyond an end": (slider, {"length": 0.4}, (0.3, 0, 0), 2.0 * G * 0.3 / 0.2),
    "key": (slider, {"radius": 0.1}, (0, 0.3, 0), 2.0 * G * (1.0 + 0.3 / 0.1)),
    "journal": (hinge, {"radius": 0.1}, (0, 0, 0), 2.0 * G * 0.1),
    "collar": (
        lambda **given: hinge(axis=(0, 0, 1), **given),
        {"radius": 0.1, "collar": 0.3},
        (0, 0, 0),
        2.0 * G * 0.3,
    ),
}


@pytest.mark.parametrize(("scene_of", "given", "load", "normal"), BEARINGS.values(), ids=BEARINGS)
def test_what_presses_a_bearing(scene_of, given, load, normal):
    """Weight that acts at a point of the body; the joint moves at a constant rate."""
    scene, body, joint = scene_of(gravity=(0, 0, 0), **given)
    scene.add(fl.PointLoad(body.point(load), force=(0, 0, -2.0 * G)))
    (coordinate,) = joint.coordinates()
    scene.add(fl.joints.Drive(coordinate, lambda t: 0.5 * t))
    turning = isinstance(joint, fl.joints.Revolute)
    along = 0.5 * joint.frame()[3]
    if turning:
        body.add_velocity(omega=along, about=body.point("centre"))
    else:
        body.add_velocity(along)
    result = fl.GeneralisedAlpha().run(scene, duration=0.01, step=1e-3)
    force = np.abs(result.joint_force("friction")[:, 5 if turning else 2])
    np.testing.assert_allclose(force, 0.25 * normal, rtol=1e-9)


@pytest.mark.parametrize("fixed", ["body", "ground"])
def test_bearing_is_fixed_to_the_second_point(fixed):
    """A weight 0.3 m ahead of the bearing moves away from one on the ground."""
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(2.0, (0.1, 0.1, 0.1)))
    points = fl.ground(), body.point("centre")
    joint = fl.joints.Prismatic(*(points if fixed == "body" else points[::-1]), axis=(1, 0, 0))
    scene.add(joint)
    scene.add(JointFriction(joint, 0.25, SLOW, length=0.4, name="friction"))
    scene.add(fl.PointLoad(body.point((0.3, 0, 0)), force=(0, 0, -2.0 * G)))
    sign = 1.0 if fixed == "body" else -1.0
    scene.add(fl.joints.Drive(joint.displacement, lambda t: sign * 10.0 * t))
    body.add_velocity((10.0, 0, 0))
    result = fl.GeneralisedAlpha().run(scene, duration=0.01, step=1e-3)
    ahead = 0.3 + (0.0 if fixed == "body" else 10.0) * result.times
    force = np.abs(result.joint_force("friction")[:, 2])
    np.testing.assert_allclose(force, 0.25 * 2.0 * G * ahead / 0.2, rtol=1e-9)


def test_start_of_a_flexible_body_does_not_depend_on_friction_that_is_zero():
    """Modes that the step does not resolve take no part in the first accelerations."""
    frames = []
    section = fl.Section.circle(0.01, fl.Material(2e11, 0.3, 7800.0))
    for coefficient in (None, 0.0):
        scene = fl.Scene(gravity=(0, 0, -G))
        beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=4))
        pin = fl.joints.Revolute(fl.ground(), beam.point("start"), axis=(0, 1, 0))
        scene.add(pin)
        if coefficient is not None:
            scene.add(JointFriction(pin, coefficient, SLOW, radius=0.01))
        frames.append(fl.GeneralisedAlpha().run(scene, duration=0.1, step=0.01).frames)
    np.testing.assert_allclose(*frames, rtol=0.0, atol=1e-11)


def test_an_equilibrium_has_no_friction():
    """Statics finds that of the spring alone, where a run stays."""
    scene, body, joint = slider(gravity=(0.6 * G, 0, -0.8 * G))
    scene.add(fl.joints.Spring(joint.displacement, 100.0))
    moved = fl.statics(scene).position(body.point("centre"))[..., 0]
    np.testing.assert_allclose(moved, 0.012 * G, rtol=1e-9)
    scene, _, joint = slider(gravity=(0.6 * G, 0, -0.8 * G))
    scene.add(fl.joints.Spring(joint.displacement, 100.0, rest=-0.012 * G))
    result = fl.GeneralisedAlpha().run(scene, duration=0.1, step=0.01)
    assert np.abs(result.velocities).max() < 1e-12


@pytest.mark.parametrize("speed", [0.0, 2e-8, 3e-4, 2e-3, 0.02, 0.3])
def test_stribeck_curve(speed):
    law = {"coefficient": 0.1, "static": 0.3, "stribeck_speed": 0.02, "stiction_speed": 1e-3}
    scene, body, joint = slider(**law)
    scene.add(fl.joints.Drive(joint.displacement, lambda t: speed * t))
    body.add_velocity((speed, 0, 0))
    result = fl.GeneralisedAlpha().run(scene, duration=0.01, step=1e-3)
    exact = (0.1 + 0.2 * np.exp(-((speed / 0.02) ** 2))) * np.tanh(speed / 1e-3) * 2.0 * G
    np.testing.assert_allclose(np.abs(result.joint_force("friction")[:, 2]), exact, rtol=1e-7)


def test_friction_in_a_joint_within_a_beam():
    """A bead on a stiff rail between its nodes decelerates by μ g, as it does on the ground."""
    section = fl.Section.circle(0.05, fl.Material(2e13, 0.3, 1e-3))
    speeds = []
    for beam in (False, True):
        scene = fl.Scene(gravity=(0, 0, -G))
        bead = scene.add(fl.RigidBody(1.0, (0.1, 0.1, 0.1), (0.42, 0, 0)))
        bead.add_velocity((1.0, 0, 0))
        rail = fl.ground()
        if beam:
            line = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=2))
            scene.add(fl.Clamp(line.point("start")))
            rail = line.point((0.42, 0, 0))
        joint = scene.add(fl.joints.Prismatic(rail, bead.point("centre"), axis=(1, 0, 0)))
        scene.add(JointFriction(joint, 0.2, 1e-3))
        result = fl.GeneralisedAlpha().run(scene, duration=0.1, step=1e-3)
        speeds.append(result.velocity(bead.point("centre"))[-1, 0])
    np.testing.assert_allclose(speeds, 1.0 - 0.02 * G, rtol=1e-5)


def test_small_motions_are_damped_at_rest():
    """At rest friction is a damper μ N/s₀: response F/(k − m ω² + i ω μ N/s₀)."""
    scene, body, joint = slider(stiction_speed=1.0)
    scene.add(fl.joints.Spring(joint.displacement, 200.0))
    push = fl.PointLoad(body.point("centre"), force=(1, 0, 0))
    found = fl.post.frequency_response(scene, push, [5.0]).displacement(body.point("centre"))
    exact = 1.0 / (200.0 - 2.0 * 5.0**2 + 5.0j * 0.25 * 2.0 * G)
    np.testing.assert_allclose(found[0, 0], exact, rtol=1e-9)


def test_block_rebounds_from_a_stop():
    """Friction helps gravity on the way up; the stop takes what its restitution leaves."""
    scene, _, joint = slider(gravity=(0.6 * G, 0, -0.8 * G))
    scene.add(fl.joints.Limit(joint.displacement, upper=0.5, restitution=0.5))
    result = fl.GeneralisedAlpha().run(scene, duration=0.82, step=2e-4)
    down, up = G * (0.6 - 0.2), G * (0.6 + 0.2)
    speed = np.sqrt(2.0 * down * 0.5)
    way = (0.5 * speed) ** 2 / (2.0 * up)
    first = speed / down
    times = first, first + 0.5 * speed / up + np.sqrt(2.0 * way / down)
    np.testing.assert_allclose(result.steps.event_times, times, atol=4e-4)
    np.testing.assert_allclose(result.steps.event_losses[0], 0.75 * speed**2, rtol=2e-4)
    assert result.energy_error < 1e-5


def test_an_event_switches_friction():
    scene, body, _ = slider()
    body.add_velocity((1.0, 0, 0))
    (friction,) = scene.connections
    scene.add(fl.schemes.Event(lambda s: s.time - 0.1, fl.schemes.Scale(friction, 0.0)))
    result = fl.GeneralisedAlpha().run(scene, duration=0.2, step=0.01)
    np.testing.assert_allclose(result.velocities[-1, 0, 0], 1.0 - 0.1 * 0.25 * G, rtol=1e-9)


def test_run_resumes_to_the_last_bit(tmp_path):
    def scene(coefficient=0.4, law=lambda t, q, rate: 0.0 * q):
        found, joint = pendulum(coefficient)
        found.add(fl.loads.ForceLaw(joint.angle, law))
        return found

    calls = []

    def interrupted(t, q, rate):
        calls.append(t)
        if len(calls) > 100 and t > 0.555:
            raise KeyError("enough")
        return 0.0 * q

    scheme, plan = fl.GeneralisedAlpha(), {"duration": 1.0, "step": 0.01, "checkpoint_every": 10}
    whole = scheme.run(scene(), file=tmp_path / "whole.h5", **plan)
    with pytest.raises(fl.ConvergenceError, match="enough"):
        scheme.run(scene(law=interrupted), file=tmp_path / "run.h5", **plan)
    resumed = scheme.resume(scene(), tmp_path / "run.h5")
    np.testing.assert_array_equal(resumed.frames, whole.frames)
    np.testing.assert_array_equal(resumed.balance, whole.balance)
    np.testing.assert_array_equal(resumed.joint_force("friction"), whole.joint_force("friction"))
    with pytest.raises(ValueError, match="force law of friction"):
        scheme.resume(scene(0.5), tmp_path / "run.h5")


@pytest.mark.parametrize(
    "scheme",
    [fl.EnergyMomentum(), fl.schemes.Variational(), fl.Explicit(), fl.schemes.MuntheKaas()],
)
def test_other_schemes_refuse_friction(scheme):
    with pytest.raises(ValueError, match=r"friction (in joints|by forces of joints)"):
        scheme.run(slider()[0], duration=0.1, step=0.01)


NUMBERS = {
    "a negative coefficient": ({"coefficient": -0.1}, "expected coefficient ≥ 0, got -0.1"),
    "no stiction speed": ({"stiction_speed": 0.0}, "expected stiction_speed > 0, got 0"),
    "a negative preload": ({"preload": -1.0}, "expected preload ≥ 0"),
    "no length": ({"length": 0.0}, "expected length > 0"),
    "static alone": ({"static": 0.5}, "expected static and stribeck_speed together"),
    "static below": ({"static": 0.1, "stribeck_speed": 1.0}, "expected static ≥ coefficient"),
    "a collar of a slider": ({"collar": 0.1}, "expected collar with a Revolute joint"),
}


def test_a_ball_has_no_bearing_with_ends():
    with pytest.raises(ValueError, match="expected length with a joint that has a bearing"):
        driven_by(fl.joints.Spherical, radius=0.1, length=0.2)


@pytest.mark.parametrize(("given", "message"), NUMBERS.values(), ids=NUMBERS)
def test_wrong_numbers_are_refused(given, message):
    with pytest.raises(ValueError, match=f"friction: {message}"):
        slider(**given)


def test_joints_without_such_forces_are_refused():
    scene, _, joint = slider()
    with pytest.raises(ValueError, match="expected radius"):
        hinge()
    with pytest.raises(TypeError, match="a universal joint is two Revolutes"):
        JointFriction(fl.joints.Universal(joint.a, joint.b, second=(1, 0, 0)), 0.1, SLOW)
    with pytest.raises(TypeError, match="got "):
        JointFriction(joint.displacement, 0.1, SLOW)
    with pytest.raises(TypeError, match="must be a number"):
        slider(coefficient="steel")
    idle = fl.joints.Prismatic(joint.a, joint.b, active=False)
    with pytest.raises(ValueError, match="is not active: it has no forces"):
        scene.add(JointFriction(idle, 0.1, SLOW))
    with pytest.raises(ValueError, match="add the joint first"):
        scene.add(JointFriction(fl.joints.Prismatic(joint.a, joint.b), 0.1, SLOW))


def test_a_second_friction_of_a_joint_is_refused():
    scene, _, joint = slider()
    with pytest.raises(ValueError, match=r"Prismatic.* has friction already, by"):
        scene.add(JointFriction(joint, 0.1, SLOW))


def test_joints_whose_forces_are_not_unique_or_vanish_are_refused():
    scene, _, joint = slider()
    scene.redundant = fl.joints.RedundantConstraints.MINIMUM_NORM
    with pytest.raises(ValueError, match="redundant constraints leave the forces of joints open"):
        fl.GeneralisedAlpha().run(scene, duration=0.1, step=0.01)
    scene, _, joint = slider()
    scene.add(fl.schemes.Event(lambda s: s.time - 0.05, fl.schemes.Release(joint)))
    with pytest.raises(ValueError, match="an event switches Prismatic"):
        fl.GeneralisedAlpha().run(scene, duration=0.1, step=0.01)
