"""Controllers with states of their own: linear theory, order, checkpoints, errors."""

import numpy as np
import pytest
from scipy.linalg import expm

import fem_lie as fl
from fem_lie.schemes import AdaptiveStep, ConstantStep, ContinuousController, Controller, Event

MASS, GAIN, INTEGRAL, RATE, FILTER = 2.0, 20.0, 8.0, 8.0, 0.05
SCHEME = fl.GeneralisedAlpha(radius=0.9)


def cart():
    """A mass on a line, and a force of 1 N along it."""
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(MASS, (0.1, 0.1, 0.1), name="cart"))
    rail = fl.joints.Prismatic(fl.ground(), body.point("centre"), axis=(1, 0, 0), name="rail")
    scene.add(rail)
    force = scene.add(fl.PointLoad(body.point("centre"), force=(1.0, 0.0, 0.0)))
    return scene, rail, force


def regulated(lag=FILTER, fails=np.inf, actuator=None):
    """The cart goes to x = 1 by a PID controller with a filtered derivative."""
    scene, rail, force = cart()
    if actuator is not None:
        scene.loads.clear()
        force = scene.add(actuator(rail))

    def gap(state):
        if state.time > fails:
            raise InterruptedError("enough")
        return 1.0 - state.coordinate(rail)

    def rate(state, x):
        return [gap(state), (gap(state) - x[1]) / lag]

    def output(state, x):
        return GAIN * gap(state) + INTEGRAL * x[0] + RATE / lag * (gap(state) - x[1])

    scene.add(ContinuousController(rate, output, [force], [0.0, 1.0], name="pid"))
    return scene


def exact(time, lag=FILTER):
    """Position of the cart by linear theory; unknowns x, v, integral, filtered gap, 1."""
    stiff = GAIN + RATE / lag
    A = np.array(
        [
            [0, 1, 0, 0, 0],
            [-stiff / MASS, 0, INTEGRAL / MASS, -RATE / lag / MASS, stiff / MASS],
            [-1, 0, 0, 0, 1],
            [-1 / lag, 0, 0, -1 / lag, 1 / lag],
            [0, 0, 0, 0, 0],
        ]
    )
    return (expm(A * time) @ [0, 0, 0, 1, 1])[0]


def test_filtered_pid_on_a_mass():
    """Linear theory to 1e-6 at order 2."""
    errors = []
    for step in (5e-3, 2.5e-3, 1.25e-3):
        result = SCHEME.run(regulated(), duration=1.0, step=step, save_every=1000)
        errors.append(result.coordinate("rail")[-1] - exact(1.0))
    assert abs(errors[-1]) < 1e-6
    np.testing.assert_allclose(np.divide(errors[:-1], errors[1:]), 4.0, rtol=0.03)
    assert abs((4.0 * errors[2] - errors[1]) / 3.0) < 1e-8


def test_steps_of_alternating_sizes():
    """Order 2 where each step is a third or three times of the one before."""
    errors = []
    for count in (100, 200):
        ends = np.cumsum(np.tile([1.0 / 3.0, 1.0], 3 * count // 4)) / count
        step = ConstantStep(1.0 / count, events=ends[:-1])
        result = SCHEME.run(regulated(), duration=1.0, step=step)
        assert len(result.steps.times) == len(ends)
        errors.append(result.coordinate("rail")[-1] - exact(1.0))
    np.testing.assert_allclose(errors[0] / errors[1], 4.0, rtol=0.1)


POLE, LENGTH, INERTIA, GRAVITY, TILT = 0.2, 0.3, 0.006, 9.81, 1e-4


def pendulum():
    """Cart of 1 kg, on which a pole is balanced; a PID controller with a filter of 20 ms."""
    turn = fl.lie.so3_exp([0.0, TILT, 0.0])
    scene = fl.Scene(gravity=(0, 0, -GRAVITY))
    body = scene.add(fl.RigidBody(1.0, (0.01, 0.01, 0.01)))
    pole = scene.add(fl.RigidBody(POLE, (INERTIA, INERTIA, 1e-4), LENGTH * turn[:, 2], turn))
    middle, centre = body.point("centre"), pole.point("centre")
    scene.add(fl.joints.Prismatic(fl.ground(), middle, axis=(1, 0, 0)))
    hinge = scene.add(
        fl.joints.Revolute(middle, centre, at=(0, 0, 0), axis=(0, 1, 0), name="hinge")
    )
    drive = scene.add(fl.PointLoad(middle, force=(1, 0, 0)))

    def angle(state):
        return TILT + state.coordinate(hinge)

    scene.add(
        ContinuousController(
            lambda state, x: [angle(state), (angle(state) - x[1]) / 0.02],
            lambda state, x: 40 * angle(state) + 60 * x[0] + 4 / 0.02 * (angle(state) - x[1]),
            [drive],
            [0.0, TILT],
        )
    )
    return scene


def angle_by_linear_theory(time):
    mass = np.array([[1.0 + POLE, POLE * LENGTH], [POLE * LENGTH, INERTIA + POLE * LENGTH**2]])
    A = np.zeros((6, 6))  # of x, angle, their rates, integral, filtered angle
    A[:2, 2:4] = np.eye(2)
    A[2:4, 1] = np.linalg.solve(mass, [40.0 + 200.0, POLE * GRAVITY * LENGTH])
    A[2:4, 4], A[2:4, 5] = np.linalg.solve(mass, [60, 0]), np.linalg.solve(mass, [-200, 0])
    A[4, 1], A[5, 1], A[5, 5] = 1.0, 50.0, -50.0
    return (expm(A * time) @ [0, TILT, 0, 0, 0, TILT])[1]


def test_inverted_pendulum_on_a_cart():
    """Linearised closed loop at 0.4 s: order 2, and 1e-6 of the initial angle."""
    errors, exact_angle = [], angle_by_linear_theory(0.4)
    for step in (1e-3, 5e-4):
        result = SCHEME.run(pendulum(), duration=0.4, step=step, save_every=1000)
        errors.append((TILT + result.coordinate("hinge")[-1] - exact_angle) / TILT)
    np.testing.assert_allclose(errors[0] / errors[1], 4.0, rtol=0.1)
    assert abs((4.0 * errors[1] - errors[0]) / 3.0) < 1e-6


def as_spring(stiffness, damping, controlled, **limit):
    """A cart between a spring and a growing force; the spring as a law or as a controller."""
    scene, rail, force = cart()
    middle = force.point
    scene.add(fl.PointLoad(middle, force=(60.0, 0, 0), history=lambda t: 1.0 - np.cos(8.0 * t)))
    if limit:
        scene.add(fl.joints.Limit(rail.displacement, **limit))
    if controlled:

        def output(state, x):
            return -stiffness * state.coordinate(rail) - damping * state.rate(rail)

        scene.add(ContinuousController(lambda state, x: [], output, [force]))
    else:
        scene.loads.remove(force)
        scene.add(fl.joints.Spring(rail.displacement, stiffness, damping))
    return scene


@pytest.mark.parametrize(
    ("stiffness", "damping", "stop", "error"),
    [
        (30.0, 2.0, None, 5e-9),
        (3e5, 50.0, None, 5e-9),
        (30.0, 2.0, 0.8, 1e-3),
        (3e5, 50.0, 0.8, 5e-9),
    ],
    ids=["soft", "stiff", "stop", "stiff stop"],
)
def test_feedback_has_no_delay(stiffness, damping, stop, error):
    """Each step is that of a spring and damper, however stiff; impacts restart both."""
    ends, size = [], 120.0 / stiffness
    for controlled in (True, False):
        limit = {} if stop is None else {"upper": stop * size, "restitution": 0.5}
        scene = as_spring(stiffness, damping, controlled, **limit)
        result = SCHEME.run(scene, duration=0.8, step=ConstantStep(4e-3))
        assert bool(len(result.steps.event_times)) == (stop is not None)
        ends.append(np.interp(np.linspace(0, 0.8, 41), result.times, result.coordinate("rail")))
    np.testing.assert_allclose(ends[0], ends[1], atol=error)


def test_filters_faster_than_steps_are_damped():
    """A filter of 1 µs with steps of 5 ms is the derivative itself."""
    fast = SCHEME.run(regulated(lag=1e-6), duration=1.0, step=5e-3)
    slow = SCHEME.run(regulated(lag=1e-2), duration=1.0, step=5e-3)
    x = fast.coordinate("rail")
    assert abs(np.diff(x, 2)).max() < 1.2 * abs(np.diff(slow.coordinate("rail"), 2)).max()
    np.testing.assert_allclose(x[-1], exact(1.0, 1e-3), atol=2e-3)


@pytest.mark.parametrize(
    "actuator",
    [
        lambda rail: fl.loads.ForceLaw(rail.displacement, lambda t, q, rate: -1.0),
        lambda rail: fl.loads.ForceLaw(
            rail.displacement, fl.loads.compiled_law(lambda t, q, rate: -1.0)
        ),
    ],
    ids=["Python", "compiled"],
)
def test_motors_in_joints(actuator):
    """A constant force law along the coordinate of a joint, scaled by the controller."""
    result = SCHEME.run(regulated(actuator=actuator), duration=0.5, step=2.5e-3)
    load = SCHEME.run(regulated(), duration=0.5, step=2.5e-3)
    np.testing.assert_allclose(result.coordinate("rail"), load.coordinate("rail"), atol=1e-9)


def test_events_and_adaptive_steps():
    """The cart passes x = 1/2 when linear theory says so, with steps of any size."""
    scene = regulated()
    rail = scene.joints[0]
    scene.add(Event(lambda state: state.coordinate(rail) - 0.5, fl.schemes.Stop()))
    result = SCHEME.run(scene, duration=2.0, step=AdaptiveStep(1e-5, largest=2e-3))
    assert result.times[-1] < 1.0
    np.testing.assert_allclose(exact(result.times[-1]), 0.5, atol=1e-5)


@pytest.mark.parametrize("step", [5e-3, AdaptiveStep(1e-4, largest=0.02)])
def test_resumed_to_the_last_bit(tmp_path, step):
    plan = {"duration": 1.0, "step": step, "checkpoint_every": 7}
    whole = SCHEME.run(regulated(), file=tmp_path / "whole.h5", **plan)
    for k, end in enumerate((0.2, 0.7)):
        path = tmp_path / f"{k}.h5"
        with pytest.raises(fl.ConvergenceError, match=r"the rate of pid failed at time .*enough"):
            SCHEME.run(regulated(fails=end), file=path, **plan)
        resumed = SCHEME.resume(regulated(), path)
        np.testing.assert_array_equal(resumed.times, whole.times)
        np.testing.assert_array_equal(resumed.frames, whole.frames)
        np.testing.assert_array_equal(resumed.velocities, whole.velocities)
    other, _, force = cart()
    other.add(ContinuousController(max, max, [force], [0.0, 2.0], name="pid"))
    with pytest.raises(ValueError, match=r"controller 1 \(pid\)"):
        SCHEME.resume(other, tmp_path / "whole.h5")


def none(state, x):
    return []


WRONG = {
    "rate": (lambda f: ContinuousController(3.0, none, [f]), TypeError, "rate must be a function"),
    "output": (lambda f: ContinuousController(none, [1], [f]), TypeError, "output must be a func"),
    "actuators": (lambda f: ContinuousController(none, none, f), ValueError, "a sequence of loads"),
    "initial": (
        lambda f: ContinuousController(none, none, [f], [np.inf]),
        ValueError,
        "finite numbers in initial",
    ),
    "name": (lambda f: ContinuousController(none, none, [f], name=3), TypeError, "name"),
}


@pytest.mark.parametrize(("make", "kind", "match"), WRONG.values(), ids=WRONG)
def test_wrong_arguments(make, kind, match):
    with pytest.raises(kind, match=match):
        make(cart()[2])


RETURNS = {
    "rates": (lambda s, x: [1.0], lambda s, x: 1.0, "rate of it failed.*expected 2 finite numbers"),
    "nan": (lambda s, x: [np.nan, 0], lambda s, x: 1.0, "rate of it failed.*expected 2 finite"),
    "outputs": (lambda s, x: 0 * x, lambda s, x: [1, 2], "output of it failed.*expected 1 finite"),
    "key": (lambda s, x: 0 * x, lambda s, x: {}[1], "output of it failed at time 0: KeyError"),
}


@pytest.mark.parametrize(("rate", "output", "match"), RETURNS.values(), ids=RETURNS)
def test_wrong_functions(rate, output, match):
    scene, _, force = cart()
    scene.add(ContinuousController(rate, output, [force], [0.0, 0.0], name="it"))
    with pytest.raises(RuntimeError, match=match):
        SCHEME.run(scene, duration=0.1, step=0.01)


def test_what_cannot_be_solved_is_said():
    """A discontinuous output has no solution in a step; a rate that explodes has none either."""
    scene, rail, force = cart()
    scene.add(
        ContinuousController(
            none,
            lambda s, x: -1e6 * np.sign(s.coordinate(rail) - 1e-9) - 1.0,
            [force],
            name="relay",
        )
    )
    with pytest.raises(fl.ConvergenceError, match="the outputs of relay did not converge"):
        SCHEME.run(scene, duration=0.1, step=0.01)
    scene, _, force = cart()
    scene.add(
        ContinuousController(
            lambda s, x: 1.0 + x**2, lambda s, x: 0.0, [force], [0.0], name="explosion"
        )
    )
    with pytest.raises(fl.ConvergenceError, match="the state of explosion did not converge"):
        SCHEME.run(scene, duration=2.0, step=0.1)


def test_what_is_refused():
    scene, _, force = cart()
    scene.add(Controller(max, [force], 0.1, name="first"))
    with pytest.raises(ValueError, match="second: first controls PointLoad already"):
        scene.add(ContinuousController(none, none, [force], name="second"))
    with pytest.raises(ValueError, match="scales PointLoad, which is not in the scene"):
        scene.add(ContinuousController(none, none, [cart()[2]]))
    with pytest.raises(ValueError, match="errors of steps with continuous controllers"):
        SCHEME.run(regulated(), duration=0.1, step=ConstantStep(0.01, refinement=2))


@pytest.mark.parametrize("scheme", [fl.EnergyMomentum(), fl.schemes.Variational(), fl.Explicit()])
def test_other_schemes_refuse_them(scheme):
    with pytest.raises(ValueError, match=r"does not support sensors and controllers \(pid"):
        scheme.run(regulated(), duration=0.1, step=0.01)
