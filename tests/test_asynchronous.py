"""Steps of each cell by itself: those of explicit steps if equal, work, invariants, bad input.

Forces in no cell have a step of their own: contact, springs, pressure, loads in time; nodes with
rotations and with joints move with them.
"""

from itertools import pairwise

import numpy as np
import pytest

import fem_lie as fl
from benchmarks import asynchronous
from tests.test_composed import flying, resumed_as_whole
from tests.test_contact_of_positions import caught
from tests.test_explicit import CABLE, net
from tests.test_explicit_joints import net as joined
from tests.test_solids import brick

SCHEME = fl.schemes.Asynchronous()


def sprung() -> fl.Scene:
    """Springs to ground and within a net."""
    scene, body = net()
    for end, stiffness in ((fl.ground((0.3, 0.3, 0.5)), 30.0), (body.point(21), 3.0)):
        length = fl.joints.Distance(body.point(14), end).length
        scene.add(fl.joints.Spring(length, stiffness=stiffness, rest=0.3))
    return scene


def loaded() -> fl.Scene:
    """A load in time, and gravity, with damping."""
    scene, body = net()
    scene.gravity[:] = (0, 0, -9.81)
    body.model.damping = fl.sections.Damping(mass=5.0)
    scene.add(fl.PointLoad(body.point(14), force=(0, 0, 0.1), history=lambda t: np.sin(40 * t)))
    return scene


def pressed() -> fl.Scene:
    """A solid under a pressure in time, which follows its face."""
    scene, body = fl.Scene(gravity=(0, 0, -9.81)), brick((2, 1, 1))
    body.clamp("a=0")
    scene.add(body)
    scene.add(fl.loads.FacePressure(body, "c=1", 30.0, history=lambda t: np.cos(50 * t)))
    return scene


def uneven(*, free: bool, friction: float = 0.0, stiffness: float = 50.0) -> fl.Scene:
    """A net with short cells in the middle hits a ball there, and has another ball at a corner."""
    along = np.array([-0.5, -0.25, -0.06, -0.03, 0.0, 0.03, 0.06, 0.25, 0.5])
    x, y = np.meshgrid(along, along, indexing="ij")
    positions = np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3)
    numbers = np.arange(len(positions)).reshape(x.shape)
    section = fl.Section.circle(1e-3, fl.Material(E=4e8, nu=0.3, density=1000.0))
    body = fl.Net(positions, [*numbers, *numbers.T], section)
    scene, speed, middle = fl.Scene(), (0.3, 0.1, -3.0), (0.0, 0.0, -0.2)
    scene.add(body)
    body.frames[:, 0] += (0.013, 0.027, 0.0015)
    corner = scene.add(fl.RigidBody(0.01, 1e-6 * np.eye(3), body.frames[0, 0]))
    for each in (body, corner):
        each.add_velocity(speed)
    scene.add(fl.joints.Spherical(body.point(0), corner.point("centre"), name="corner"))
    ball = fl.ground(middle)
    if free:
        ball = scene.add(fl.RigidBody(0.1, 1e-3 * np.eye(3), middle)).point("centre")
    knots = fl.contact.Vertices([fl.extend.Point(body, k) for k in range(len(positions))], 1e-3)
    law = fl.contact.Penalty(stiffness, friction=friction)
    scene.add(fl.contact.Contact(knots, fl.contact.Sphere(ball, 0.2), law))
    return scene


EQUAL = {
    "net": lambda: net()[0],
    "contact": lambda: caught(free=False),
    "contact with a body, friction": lambda: caught(friction=0.3),
    "springs": sprung,
    "load in time, damping": loaded,
    "pressure in time": pressed,
    "joint": joined,
    "beam": flying,
}


@pytest.mark.parametrize("name", EQUAL)
def test_equal_steps_are_explicit_ones(name):
    step = 0.3 * fl.Explicit().stable_step(EQUAL[name]())
    plan = {"duration": 100 * step, "step": step, "save_every": 20}
    here = fl.schemes.Asynchronous(1.0).run(EQUAL[name](), **plan)
    there = fl.Explicit().run(EQUAL[name](), **plan)
    size = np.abs(there.frames).max()
    np.testing.assert_allclose(here.frames, there.frames, atol=4e-15 * size, rtol=0.0)
    speed = np.abs(there.velocities).max()
    np.testing.assert_allclose(here.velocities, there.velocities, atol=1e-11 * speed, rtol=0.0)
    energy = np.abs(there.total_energy).max()
    np.testing.assert_allclose(here.balance, there.balance, atol=1e-12 * energy, rtol=0.0)
    forces = there.joint_forces
    largest = np.abs(forces).max(initial=0.0)
    np.testing.assert_allclose(here.joint_forces, forces, atol=1e-10 * largest, rtol=0.0)
    assert here.momentum_error <= 1e-12 or name == "load in time, damping"


def test_second_order_with_contact_and_a_joint():
    """Of cells with steps of their own, and of all else with another one."""
    duration, ends = 0.006, []
    limit = fl.Explicit().stable_step(uneven(free=True))
    count = int(np.ceil(duration / (0.1 * limit)))
    exact = fl.Explicit().run(
        uneven(free=True), duration=duration, step=duration / count, save_every=count
    )
    for part in (1.0, 0.5, 0.25):
        scheme = fl.schemes.Asynchronous(0.8 * part)
        run = scheme.run(uneven(free=True), duration=duration, step=1e-4 * part, save_every=20)
        assert run.joint_violation("corner").max() <= 1e-12
        assert max(run.momentum_error, run.angular_momentum_error) <= 1e-12
        ends.append(run)
    moved = np.abs(exact.frames[-1, :, 0] - exact.frames[0, :, 0]).max()
    errors = [np.abs(run.frames[-1] - exact.frames[-1]).max() for run in ends]
    assert errors[0] <= 1e-3 * moved
    assert all(np.log2(far / near) >= 1.8 for far, near in pairwise(errors)), errors
    balances = [run.balance_error for run in ends]
    assert all(near <= 0.35 * far for far, near in pairwise(balances)), balances


@pytest.mark.parametrize("stiffness", [1e3, 1e5])
def test_stiff_contacts_have_smaller_steps(stiffness):
    """The largest step is that of cells; energy and momenta of free bodies stay."""
    scene = uneven(free=True, stiffness=stiffness)
    result = SCHEME.run(scene, duration=0.05, step=2e-4, save_every=10)
    assert max(result.momentum_error, result.angular_momentum_error) <= 1e-12
    assert result.balance_error <= 3e-3
    touching = fl.post.contact_forces(result, scene.contacts[0]).touching
    assert touching.max() > 0


def test_friction_takes_energy():
    result = SCHEME.run(uneven(free=True, friction=0.3), duration=0.02, step=1e-4, save_every=10)
    assert result.momentum_error <= 1e-12
    assert np.diff(result.balance[:, 1]).min() >= 0.0
    assert result.balance[-1, 1] >= 1e-6 * result.kinetic[0]
    assert result.balance_error <= 1e-4


def test_loads_in_time():
    """Of second order, and so are their work and impulses in the balance."""
    runs = [
        fl.schemes.Asynchronous(0.4 * part).run(
            loaded(), duration=0.02, step=1e-3 * part, save_every=10**6
        )
        for part in (1.0, 0.5, 0.25)
    ]
    far, near = (np.abs(a.frames[-1] - b.frames[-1]).max() for a, b in pairwise(runs))
    assert np.log2(far / near) == pytest.approx(2.0, abs=0.4)
    assert runs[1].balance_error <= 0.4 * runs[0].balance_error


def test_dead_loads_are_followed_exactly():
    """A stone that is thrown, of steps as large as the way."""
    scene = fl.Scene(gravity=(0, 0, -10.0))
    body = scene.add(fl.Net([(0, 0, 0), (1, 0, 0)], [[0, 1]], CABLE))
    body.velocities[:, 0] = 3.0
    result = SCHEME.run(scene, duration=1.0, step=0.5)
    fallen = result.frames[-1, :, 0] - result.frames[0, :, 0]
    np.testing.assert_allclose(fallen, np.broadcast_to([3.0, 0.0, -5.0], (2, 3)), atol=1e-12)


def test_momenta_are_exact():
    result = SCHEME.run(net(pinned=False)[0], duration=0.2, step=1e-2)
    assert result.momentum_error <= 1e-12
    assert result.angular_momentum_error <= 1e-12


def test_order():
    """One at least."""
    exact = fl.schemes.Asynchronous(0.02).run(asynchronous.net(4, 1, 0.1), duration=0.01, step=2e-3)
    errors = []
    for courant in (0.4, 0.2, 0.1):
        run = fl.schemes.Asynchronous(courant).run(
            asynchronous.net(4, 1, 0.1), duration=0.01, step=2e-3
        )
        errors.append(np.abs(run.frames[-1] - exact.frames[-1]).max())
    assert all(near <= 0.6 * far for far, near in pairwise(errors)), errors


def test_work_around_a_short_element():
    """At least 20 times less than explicit steps, all as small as the short ones want."""
    record = asynchronous.against_explicit(16, 2, 4e-3)
    assert record["asynchronous: less work than explicit"] >= 60.0
    assert record["quarter: less work than explicit"] >= 20.0
    assert record["quarter: error"] <= 5e-3


def test_energy_stays():
    record = asynchronous.long_run(4, 2, 100_000)
    assert record["steps of cells"] >= 90_000
    assert record["energy, largest change"] <= 1e-2
    assert record["energy, last third"] <= 2.0 * record["energy, first third"]


RESUMED = {
    "net": (lambda: net()[0], 1e-3),
    "contact": (lambda: uneven(free=True, friction=0.3), 2e-4),
    "load in time": (loaded, 1e-3),
}


@pytest.mark.parametrize("name", RESUMED)
def test_resumed_to_the_last_bit(tmp_path, name):
    scene, step = RESUMED[name]
    plan = {"duration": 30 * step, "step": step, "save_every": 3}
    resumed_as_whole(SCHEME, scene, plan, tmp_path / "run.h5")


# --- bad input ---


@pytest.mark.parametrize("courant", [0.0, 1.5, -1.0])
def test_courant(courant):
    with pytest.raises(ValueError, match=r"expected 0 < courant ≤ 1"):
        fl.schemes.Asynchronous(courant)


def test_what_is_not_supported():
    scene, body = net()
    length = fl.joints.Distance(body.point(14), fl.ground((0.3, 0.3, 0.5))).length
    scene.add(fl.joints.Spring(length, damping=1.0))
    with pytest.raises(ValueError, match=r"Asynchronous does not support damping by strain rates"):
        SCHEME.run(scene, duration=1e-3, step=1e-4)


def test_steps_that_change():
    with pytest.raises(ValueError, match=r"largest one as a number .* got AdaptiveStep"):
        SCHEME.run(net()[0], duration=0.1, step=fl.schemes.AdaptiveStep(1e-4))
