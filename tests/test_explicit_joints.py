"""Joints in explicit steps: gaps, order, momenta, resumed runs, what is refused."""

from itertools import pairwise

import numpy as np
import pytest

import fem_lie as fl
from tests.combinations import joined
from tests.scene_builder import build
from tests.test_composed import resumed_as_whole, rigid_pendulum
from tests.test_energy_momentum import SQUARE, bars
from tests.test_explicit import CABLE

SCHEME = fl.Explicit()
BALL = 0.02, (1e-5, 2e-5, 2e-5)


def rope() -> fl.Scene:
    """A cable that flies with a ball at its end, held off its centre."""
    scene = fl.Scene()
    cable = scene.add(fl.Cable.straight((0, 0, 0), (1, 0, 0), CABLE, cells=4))
    ball = scene.add(fl.RigidBody(*BALL, position=(1.1, 0, 0)))
    ball.velocities[0, [1, 5]] = 0.2, 2.0
    scene.add(fl.joints.Spherical(cable.point("end"), ball.point("centre"), at=(1, 0, 0)))
    return scene


def net() -> fl.Scene:
    """A stretched net that flies with a ball on one of its knots."""
    positions = np.array([(a, b, 0) for a in (0, 0.5, 1) for b in (0, 0.5, 1)])
    grid = np.arange(9).reshape(3, 3)
    scene = fl.Scene()
    body = scene.add(fl.Net(positions, [*map(list, grid), *map(list, grid.T)], CABLE, stretch=1.05))
    ball = scene.add(fl.RigidBody(*BALL, position=(1, 1, 0)))
    ball.velocities[0, 3] = 0.5
    scene.add(fl.joints.Spherical(body.point(8), ball.point("centre")))
    return scene


def collar() -> fl.Scene:
    """A body that slides along a soft beam that turns."""
    scene = fl.Scene()
    beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), SQUARE, cells=3))
    ball = scene.add(fl.RigidBody(0.05, (1e-5, 2e-5, 2e-5), position=(0.4, 0, 0)))
    beam.add_velocity(omega=(0, 0, 3), about=(0, 0, 0))
    ball.velocities[0, [0, 1, 5]] = 1.0, 1.2, 3.0
    scene.add(fl.joints.Collar(beam, ball.point("centre")))
    return scene


FREE = {"rope": rope, "net": net, "collar": collar}
SCENES = FREE | {"bodies": rigid_pendulum, "bars": lambda: bars()[0]}


def plan(scene: fl.Scene, steps: int) -> dict[str, float]:
    """Steps of a tenth of the largest one."""
    limit = SCHEME.stable_step(scene)
    step = 1e-3 if np.isinf(limit) else 0.1 * limit
    return {"duration": steps * step, "step": step}


def damped_rope() -> fl.Scene:
    """The cable is damped, and the ball is not."""
    scene = rope()
    scene.bodies[0].model.damping = fl.sections.Damping(mass=50.0)
    return scene


SCENES["damped rope"] = damped_rope
SCENES["thin shell"] = lambda: build(joined("thin shell", "Spherical")).scene


@pytest.mark.parametrize("name", SCENES)
def test_joints_stay_closed(name):
    result = SCHEME.run(SCENES[name](), **plan(SCENES[name](), 200), save_every=10)
    assert np.abs(result.joint_forces).max() > 1e-6
    assert result.joint_violations.max() <= 1e-12
    if name in FREE:
        assert result.momentum_error <= 1e-13
        assert result.angular_momentum_error <= 1e-13


@pytest.mark.parametrize("name", SCENES)
def test_second_order(name):
    """In frames, velocities and joint forces."""
    steps = 160 if name in FREE or "rope" in name else 40
    whole = plan(SCENES[name](), steps)
    if "rope" in name:  # its bending waves are shorter
        whole = {key: value / 4 for key, value in whole.items()}
    duration, step = whole.values()
    ends = [
        SCHEME.run(SCENES[name](), duration=duration, step=step / parts, save_every=10**6)
        for parts in (1, 2, 4)
    ]
    for what in ("frames", "velocities", "joint_forces"):
        far, near = (
            np.abs(getattr(a, what)[-1] - getattr(b, what)[-1]).max() for a, b in pairwise(ends)
        )
        assert np.log2(far / near) == pytest.approx(2.0, abs=0.1), what


def test_bodies_swing_as_with_energy_momentum():
    """Nothing but the discretisation in time differs: inertia of rigid bodies is not lumped."""
    here, there = (
        scheme.run(rigid_pendulum(), duration=0.2, step=2e-4, save_every=100)
        for scheme in (SCHEME, fl.EnergyMomentum())
    )
    np.testing.assert_allclose(here.frames, there.frames, atol=1e-6)
    np.testing.assert_allclose(here.joint_forces, there.joint_forces, atol=1e-3)


@pytest.mark.parametrize("name", ["damped rope", "collar", "bodies", "thin shell"])
def test_resumed_to_the_last_bit(tmp_path, name):
    scene = SCENES[name]
    steps = plan(scene(), 30) | {"save_every": 3}
    resumed_as_whole(SCHEME, scene, steps, tmp_path / "run.h5")


def test_light_bodies_on_long_arms():
    """Impulses of the last step would rotate the body of a sling by far too much."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    rod = scene.add(fl.RigidBody(500.0, (50, 50, 50), position=(1, 0, 0)))
    ball = scene.add(fl.RigidBody(5.0, (1e-6, 1e-6, 1e-6), position=(-5, 0, 0)))
    centre, sling, y = rod.point("centre"), ball.point("centre"), (0, 1, 0)
    scene.add(fl.joints.Revolute(fl.ground(), centre, at=(0, 0, 0), axis=y))
    scene.add(fl.joints.Revolute(centre, sling, at=(-3, 0, 0), axis=y))
    exact, found = (
        scheme.run(scene, duration=0.5, step=1e-3).position(sling)[-1]
        for scheme in (fl.schemes.MuntheKaas(), SCHEME)
    )
    np.testing.assert_allclose(found, exact, atol=1e-4)


# --- bad input ---


def test_drives():
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(1.0, (1, 1, 1)))
    hinge = scene.add(fl.joints.Revolute(fl.ground(), body.point("centre"), axis=(0, 0, 1)))
    scene.add(fl.joints.Drive(hinge.angle, lambda t: 0.1 * t**3))
    with pytest.raises(ValueError, match=r"Explicit does not support drives: use GeneralisedAlpha"):
        SCHEME.run(scene, duration=0.1, step=1e-3)


def test_constraints_of_velocities():
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(1.0, (1, 1, 1)))
    scene.add(fl.joints.KnifeEdge(fl.ground(), body.point("centre"), at=(0, 0, 0), axis=(0, 1, 0)))
    with pytest.raises(ValueError, match=r"Explicit does not support velocity constraints"):
        SCHEME.run(scene, duration=0.1, step=1e-3)


def test_steps_that_leave_joints_open():
    """So large that no impulse closes the joints."""
    with pytest.raises(fl.ConvergenceError, match=r"joints were left open by .* a smaller step"):
        SCHEME.run(rigid_pendulum(), duration=20.0, step=2.0)
