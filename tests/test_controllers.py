"""Factors of loads and laws, sensors and sampled controllers: closed forms, checkpoints, errors."""

import numpy as np
import pytest

import fem_lie as fl
from fem_lie.schemes import Controller, Event, Scale, Sensor

SCHEME = fl.GeneralisedAlpha(radius=1.0)
STEPS = [0.01, fl.schemes.AdaptiveStep(1e-4, largest=0.01)]


def cart(**how):
    """A mass of 2 kg on a line, and a force of 1 N along it."""
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(2.0, (0.1, 0.1, 0.1), name="cart"))
    rail = fl.joints.Prismatic(fl.ground(), body.point("centre"), axis=(1, 0, 0), name="rail")
    scene.add(rail)
    force = scene.add(fl.PointLoad(body.point("centre"), force=(1.0, 0.0, 0.0), **how))
    return scene, rail, force


@pytest.mark.parametrize("step", STEPS)
def test_a_load_is_switched_by_an_event(step):
    """On from 0.305 s at three times its value, off when x = 0.1: then v is constant."""
    scene, rail, force = cart()
    on, off = Scale(force, 3.0, initial=0.0), Scale(force, 0.0)
    scene.add(Event(lambda state: state.time - 0.305, on))
    scene.add(Event(lambda state: state.coordinate(rail) - 0.1, off))
    result = SCHEME.run(scene, duration=1.0, step=step)
    burn = np.sqrt(2.0 * 0.1 / 1.5)
    np.testing.assert_allclose(result.steps.event_times, [0.305, 0.305 + burn], atol=1e-8)
    speed = 1.5 * burn
    np.testing.assert_allclose(
        result.coordinate("rail")[-1], 0.1 + speed * (0.695 - burn), atol=1e-8
    )
    assert abs(result.coordinate("rail")[result.times <= 0.305]).max() < 1e-12
    # the work of the load is that of its factor
    np.testing.assert_allclose(result.kinetic[-1], 3.0 * 0.1, rtol=1e-8)
    assert result.energy_error < 1e-9


def test_loads_with_histories_and_gravity_keep_theirs():
    """Half of a linear history from 0.5 s on, with another load of the same history."""
    scene, _, force = cart(history=lambda t: t)
    other = fl.PointLoad(force.point, force=(0.5, 0.0, 0.0), history=force.history)
    scene.add(other)
    scene.add(Event(lambda state: state.time - 0.5, Scale(force, 0.5)))
    result = SCHEME.run(scene, duration=1.0, step=0.005)
    # a = 1.5 t/2, then t/2
    speed = 0.75 * 0.5**2 / 2.0 + 0.5 * (1.0 - 0.25) / 2.0
    np.testing.assert_allclose(np.sqrt(result.kinetic[-1]), speed, rtol=1e-5)


@pytest.mark.parametrize("law", ["spring", "Python", "compiled", "table"])
def test_springs_and_laws_are_switched_off(law):
    """x = −cos 2t from x = −1: released at x = 0, it flies on at 2 m/s."""
    laws = {
        "Python": lambda t, q, rate: 8.0 * (q - 1.0),
        "compiled": fl.loads.compiled_law(lambda t, q, rate: 8.0 * (q - 1.0)),
        "table": fl.loads.SpringTable((0.0, 2.0), (-8.0, 8.0)),
    }
    scene, rail, _ = cart()
    scene.loads.clear()
    q = rail.displacement
    made = (
        fl.joints.Spring(q, 8.0, rest=1.0) if law == "spring" else fl.loads.ForceLaw(q, laws[law])
    )
    spring = scene.add(made)
    half, off = Scale(spring, 0.5), Scale(spring, 0.0)
    scene.add(Event(lambda state: state.coordinate(rail) - 1.0, off))
    scene.add(Event(lambda state: state.time - 10.0, half))
    result = SCHEME.run(scene, duration=2.0, step=0.002)
    quarter = 0.25 * np.pi
    np.testing.assert_allclose(result.steps.event_times, [quarter], atol=1e-5)
    np.testing.assert_allclose(result.coordinate("rail")[-1], 1 + 2 * (2 - quarter), rtol=1e-5)
    assert result.elastic[-1] == 0.0


def test_sensors_sample_every_step(tmp_path):
    scene, rail, _ = cart()
    scene.add(Sensor("x", lambda state: state.coordinate(rail)))
    scene.add(Sensor("speed", lambda state: state.rate(rail)))
    file = tmp_path / "run.h5"
    result = SCHEME.run(scene, duration=1.0, step=0.01, save_every=50, file=file)
    assert len(result.times) == 3
    times = result.steps.sensor_times
    np.testing.assert_allclose(times, 0.01 * np.arange(101), atol=1e-12)
    np.testing.assert_allclose(result.sensor("x"), 0.25 * times**2, atol=1e-12)
    np.testing.assert_allclose(result.sensor("speed"), 0.5 * times, atol=1e-9)
    loaded = fl.Result.load(file)
    np.testing.assert_array_equal(loaded.sensor("x"), result.sensor("x"))
    with pytest.raises(KeyError, match="no sensor named 'y'; known: x, speed"):
        result.sensor("y")
    plain, *_ = cart()
    with pytest.raises(KeyError, match="the scene of this run had none"):
        SCHEME.run(plain, duration=0.1, step=0.01).sensor("x")


def regulated(calls=None, period=0.05, fails=np.inf):
    """A PI-controlled cart; its memory is the sum of the errors."""
    scene, rail, force = cart()

    def update(state, memory):
        if state.time > fails:
            raise InterruptedError("enough")
        if calls is not None:
            calls.append(state.time)
        gap = 1.0 - state.coordinate(rail)
        total = memory[0] + gap
        return [20.0 * gap - 8.0 * state.rate(rail) + 0.2 * total], [total]

    scene.add(Controller(update, [force], period=period, memory=[0.0], name="regulator"))
    return scene


def sampled_reference(count, period=0.05, mass=2.0):
    """Positions at the samples: constant force in between."""
    x = v = total = 0.0
    found = [x]
    for _ in range(count):
        gap = 1.0 - x
        total += gap
        a = (20.0 * gap - 8.0 * v + 0.2 * total) / mass
        x, v = x + v * period + 0.5 * a * period**2, v + a * period
        found.append(x)
    return np.array(found)


@pytest.mark.parametrize("step", [0.01, 0.03, fl.schemes.AdaptiveStep(1e-4, largest=0.02)])
def test_sampled_controller_with_memory(step):
    """Forces are constant between samples, so positions there are exact."""
    calls = []
    result = SCHEME.run(regulated(calls), duration=3.0, step=step)
    np.testing.assert_allclose(calls, 0.05 * np.arange(60), atol=1e-12)
    at = np.searchsorted(result.times, 0.05 * np.arange(60) - 1e-9)
    found = result.coordinate("rail")[at]
    np.testing.assert_allclose(found, sampled_reference(59), atol=1e-7)


@pytest.mark.parametrize("step", [0.01, fl.schemes.AdaptiveStep(1e-4, largest=0.02)])
def test_resumed_to_the_last_bit(tmp_path, step):
    plan = {"duration": 2.0, "step": step, "checkpoint_every": 7}
    whole = SCHEME.run(regulated(), file=tmp_path / "whole.h5", **plan)
    for k, end in enumerate((0.4, 1.3)):
        path = tmp_path / f"{k}.h5"
        with pytest.raises(fl.ConvergenceError, match="update of regulator failed"):
            SCHEME.run(regulated(fails=end), file=path, **plan)
        resumed = SCHEME.resume(regulated(), path)
        np.testing.assert_array_equal(resumed.times, whole.times)
        np.testing.assert_array_equal(resumed.frames, whole.frames)
        np.testing.assert_array_equal(resumed.velocities, whole.velocities)
    with pytest.raises(ValueError, match="regulator"):
        SCHEME.resume(regulated(period=0.1), tmp_path / "whole.h5")


WRONG = {
    "update": (lambda f: Controller(3.0, [f], 0.1), TypeError, "update must be a function"),
    "actuators": (lambda f: Controller(max, [], 0.1), ValueError, "a sequence of loads"),
    "one actuator": (lambda f: Controller(max, f, 0.1), ValueError, "a sequence of loads"),
    "period": (lambda f: Controller(max, [f], 0.0), ValueError, "period"),
    "memory": (lambda f: Controller(max, [f], 0.1, [np.nan]), ValueError, "finite numbers"),
    "factor": (lambda f: Scale(f, "half"), TypeError, "Scale: factor"),
    "name": (lambda f: Sensor("", max), ValueError, "expected a name"),
    "quantity": (lambda f: Sensor("x", 3.0), TypeError, "quantity must be a function"),
}


@pytest.mark.parametrize(("make", "kind", "match"), WRONG.values(), ids=WRONG)
def test_wrong_arguments(make, kind, match):
    with pytest.raises(kind, match=match):
        make(cart()[2])


def test_actuators_that_cannot_be_scaled():
    scene, rail, force = cart()
    stranger = cart()[2]
    with pytest.raises(ValueError, match="scales PointLoad, which is not in the scene"):
        scene.add(Controller(max, [stranger], 0.1))
    with pytest.raises(TypeError, match="expected a load, spring or force law to scale"):
        scene.add(Event(max, Scale(rail, 0.0)))
    scene.add(Event(max, Scale(force, 2.0, initial=0.0)))
    with pytest.raises(ValueError, match="expected the initial factor 0, as another event says"):
        scene.add(Event(max, Scale(force, 2.0, initial=0.5)))
    scene.add(Sensor("x", max))
    with pytest.raises(ValueError, match="has a sensor named 'x' already"):
        scene.add(Sensor("x", max))


RETURNS = {
    "one value": (lambda state, memory: 1.0, "expected factors of the actuators and the memory"),
    "two factors": (lambda state, memory: ([1, 2], []), "expected 1 finite numbers as factors"),
    "nan": (lambda state, memory: (np.nan, []), "expected 1 finite numbers as factors"),
    "memory": (lambda state, memory: (1.0, [3.0]), "expected 0 finite numbers as memory"),
}


@pytest.mark.parametrize(("update", "match"), RETURNS.values(), ids=RETURNS)
def test_wrong_updates(update, match):
    scene, _, force = cart()
    scene.add(Controller(update, [force], 0.1, name="wrong"))
    with pytest.raises(RuntimeError, match=f"update of wrong failed at time 0: .*{match}"):
        SCHEME.run(scene, duration=0.1, step=0.01)


@pytest.mark.parametrize("scheme", [fl.EnergyMomentum(), fl.schemes.Variational(), fl.Explicit()])
def test_other_schemes_refuse_them(scheme):
    with pytest.raises(ValueError, match=r"does not support sensors and controllers \(regul"):
        scheme.run(regulated(), duration=0.1, step=0.01)
    scene, *_ = cart()
    scene.add(Sensor("x", max))
    with pytest.raises(ValueError, match=r"does not support sensors and controllers \(x\)"):
        scheme.run(scene, duration=0.1, step=0.01)
