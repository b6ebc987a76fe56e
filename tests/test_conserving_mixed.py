"""The energy-momentum scheme on scenes of frames and of positions."""

import numpy as np
import pytest

import fem_lie as fl
from benchmarks.conserving_joints import two_bodies
from benchmarks.conserving_mixed import BAR, SCENES, SOFT
from tests.test_composed import resumed_as_whole

SCHEME, DECAYS = fl.EnergyMomentum(), fl.EnergyDecaying(radius=0.5)


@pytest.mark.parametrize("name", SCENES)
def test_balances_and_motion(name):
    """Energy, work, momenta and constraints to round-off, and the motion of generalised-α."""
    plan = {"duration": 0.06, "step": 1e-3, "save_every": 20}
    found, other = (
        s.run(SCENES[name](), **plan)
        for s in (SCHEME, fl.GeneralisedAlpha(radius=0.95, tolerance=1e-9))
    )
    assert found.balance_error <= 1e-11
    assert found.momentum_error <= 1e-12
    assert found.angular_momentum_error <= 1e-12
    assert found.joint_violations.max() <= 1e-13
    moved = np.abs(other.frames[-1, :, 0] - other.frames[0, :, 0]).max()
    assert np.abs(found.frames[:, :, 0] - other.frames[:, :, 0]).max() <= 5e-3 * moved
    size = np.abs(other.balance).max()
    np.testing.assert_allclose(found.balance, other.balance, rtol=0, atol=0.01 * size + 1e-12)


@pytest.mark.parametrize("name", SCENES)
def test_decaying(name):
    """Energy less work never rises, falls by the accounted dissipation alone; momenta stay."""
    result = DECAYS.run(SCENES[name](), duration=0.04, step=1e-3)
    left = result.total_energy - result.balance[:, 0] + result.balance[:, 1]
    size = np.abs(result.kinetic).max()
    assert np.diff(left).max() <= 1e-12 * size
    assert result.balance[-1, 2] > 1e-8 * size
    assert result.balance_error <= 1e-11
    assert max(result.momentum_error, result.angular_momentum_error) <= 1e-11
    assert result.joint_violations.max() <= 1e-13


def test_order_joint_forces_and_reactions():
    """Of second order, against generalised-α with small steps; both forces at ends of steps."""
    plan = {"duration": 0.02, "save_every": 10**6}
    exact = fl.GeneralisedAlpha(radius=1.0, tolerance=1e-12).run(hanging(), step=5e-5, **plan)
    errors = []
    for step in (4e-4, 2e-4):
        result = SCHEME.run(hanging(), step=step, **plan)
        errors.append(np.abs(result.frames[-1, :, 0] - exact.frames[-1, :, 0]).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.15)
    for what in ("joint_forces", "reactions"):
        forces, other = getattr(result, what)[-1], getattr(exact, what)[-1]
        np.testing.assert_allclose(forces, other, rtol=0, atol=0.02 * np.abs(other).max())


def hanging() -> fl.Scene:
    """A beam on a clamp, a cable on its end, in gravity, drawn by a load that grows."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    jib = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), BAR, cells=2))
    scene.add(fl.Clamp(jib.point("start")))
    rope = scene.add(fl.Cable.straight((1, 0, 0), (1.5, 0, 0), SOFT, cells=2))
    scene.add(fl.joints.Spherical(jib.point("end"), rope.point("start")))
    pull = {"force": (0, 1.0, 0), "moment": (0.05, 0, 0)}
    scene.add(fl.PointLoad(jib.point("end"), **pull, history=lambda t: np.sin(20.0 * t)))
    return scene


def shells() -> fl.Scene:
    """A shell that flies, turns and waves."""
    layer = fl.ShellSection.layer(0.02, fl.Material(2e4, 0.3, 50.0))
    scene = fl.Scene()
    sheet = scene.add(
        fl.Shell(fl.mesh.parametric_surface(lambda a, b: (a, 0.5 * b, 0.1 * a * a), (2, 2)), layer)
    )
    sheet.add_velocity(omega=(2.0, 1.0, 3.0), about=(0.5, 0.2, 0))
    return scene


def beams() -> fl.Scene:
    """A beam with damping that turns on a hinge with a spring."""
    scene = fl.Scene()
    beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), BAR, cells=4))
    beam.model.damping = fl.sections.Damping(mass=0.2, stiffness=1e-3)
    hinge = scene.add(fl.joints.Revolute(fl.ground(), beam.point("start"), axis=(0, 1, 0)))
    scene.add(fl.joints.Spring(hinge.angle, 1.0, 0.02))
    beam.add_velocity(omega=(0, 3.0, 0), about=(0, 0, 0))
    return scene


FRAMES = {"bodies": lambda: two_bodies("revolute", spring=2.0)[0], "shell": shells, "beam": beams}


def beside_a_cable(scene: fl.Scene) -> fl.Scene:
    """The same, and a cable at rest far away, where frames move with positions."""
    rope = fl.Cable.straight((0, 0, 5), (1, 0, 5), SOFT, cells=1)
    scene.add(rope).pin(rope.point("start"))
    rope.pin(rope.point("end"))
    return scene


@pytest.mark.parametrize("scheme", [SCHEME, DECAYS], ids=["conserving", "decaying"])
@pytest.mark.parametrize("name", FRAMES)
def test_frames_move_beside_positions_as_among_themselves(name, scheme):
    """In one system of equations, to the round-off of a run."""
    plan = {"duration": 0.04, "step": 1e-3, "save_every": 10}
    other = scheme.run(FRAMES[name](), **plan)
    found = scheme.run(beside_a_cable(FRAMES[name]()), **plan)
    for what in ("frames", "velocities", "joint_forces", "joint_coordinates"):
        two = getattr(other, what)
        one = getattr(found, what)[:, : two.shape[1]]
        np.testing.assert_allclose(one, two, rtol=0, atol=1e-8 * np.abs(two).max(initial=1.0))


@pytest.mark.parametrize("name", ["shell and cable", "wheel on a motor, cable, beam with damping"])
def test_resumed_to_the_last_bit(name, tmp_path):
    plan = {"duration": 0.016, "step": 1e-3}
    resumed_as_whole(SCHEME, SCENES[name], plan, tmp_path / "run.h5")


def with_pressure(scene: fl.Scene, beam: fl.Beam) -> None:
    """A load that turns with the beam."""
    scene.add(fl.loads.PressureLoad(beam, 2.0))


def with_a_strain(scene: fl.Scene, beam: fl.Beam) -> None:
    """A bimetal that bends as it warms."""
    strain = (0.01, 0, 0, 0, 0.3, 0)
    scene.add(fl.loads.Eigenstrain(beam, strain, history=lambda t: np.sin(20.0 * t)))


def with_a_follower(scene: fl.Scene, beam: fl.Beam) -> None:
    """A body that the start of the beam carries."""
    x = beam.point("start").position - np.array([0.2, 0.0, 0.1])
    body = scene.add(fl.RigidBody(0.3, (1e-3, 2e-3, 2e-3), position=x))
    body.add_velocity(omega=(0.3, 2.0, 3.0), about=(0.5, 0, 0))
    scene.add(fl.joints.RigidLink(beam.point("start"), body.point("centre")))


def with_a_load_within(scene: fl.Scene, beam: fl.Beam) -> None:
    """A force and a moment on a point that is no node, which turn with it."""
    point = beam.point_in_cell(0, 0.3)
    scene.add(fl.PointLoad(point, force=(0, 1, 2), moment=(0, 0.1, 0.2), following=True))


ADDED = {
    "pressure": with_pressure,
    "strain": with_a_strain,
    "follower": with_a_follower,
    "load within a cell": with_a_load_within,
}


@pytest.mark.parametrize("name", ADDED)
def test_what_frames_have_beside_a_cable(name):
    """Work, impulses, second order, and the motion of generalised-α."""

    def made() -> fl.Scene:
        scene = SCENES["beam and cable"]()
        ADDED[name](scene, scene.bodies[0])
        return scene

    result = SCHEME.run(made(), duration=0.1, step=1e-3, save_every=10)
    assert result.balance_error <= 1e-11
    assert max(result.momentum_error, result.angular_momentum_error) <= 1e-11
    exact = fl.GeneralisedAlpha(radius=1.0, tolerance=1e-12).run(
        made(), duration=0.02, step=2.5e-5, save_every=10**6
    )
    errors = []
    for step in (2e-4, 1e-4):
        found = SCHEME.run(made(), duration=0.02, step=step, save_every=10**6)
        errors.append(np.abs(found.frames[-1, :, 0] - exact.frames[-1, :, 0]).max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.25)


@pytest.mark.parametrize("scheme", [SCHEME, DECAYS], ids=["conserving", "decaying"])
@pytest.mark.parametrize("name", ["crane", "shell and cable"])
def test_steps_that_follow_a_tolerance(name, scheme):
    """They conserve as constant ones do, and their errors follow the tolerance."""
    exact = SCHEME.run(SCENES[name](), duration=0.02, step=5e-5, save_every=10**6)
    errors = []
    for tolerance in (1e-4, 1e-6):
        result = scheme.run(SCENES[name](), duration=0.02, step=fl.schemes.AdaptiveStep(tolerance))
        assert result.balance_error <= 1e-11
        assert max(result.momentum_error, result.angular_momentum_error) <= 1e-11
        errors.append(np.abs(result.frames[-1, :, 0] - exact.frames[-1, :, 0]).max())
    assert errors[1] <= 0.2 * errors[0]


@pytest.mark.parametrize(
    ("name", "most"), [("beam and cable", 6.5), ("solid hub, beams, cable, weight", 9.0)]
)
def test_a_matrix_is_made_for_its_own_step(name, most):
    """With joints far ahead, in the middle of its life, steps took half as many iterations more."""
    result = SCHEME.run(SCENES[name](), duration=0.3, step=1e-3, save_every=100)
    assert result.iterations[-1] <= most * 300
    assert result.factorisations <= 12


@pytest.mark.parametrize("name", FRAMES)
def test_a_resting_cable_costs_no_iterations(name):
    """Nor matrices, each at its price in iterations: what moves does not feel the cable.

    Round-off decides in which step a matrix is made, so that one more may fall into the run.
    """
    plan = {"duration": 0.2, "step": 1e-3, "save_every": 100}
    _, price = fl.schemes.Automatic().rule()

    def cost(scene: fl.Scene) -> float:
        result = SCHEME.run(scene, **plan)
        return result.iterations[-1] + price * result.factorisations

    assert cost(beside_a_cable(FRAMES[name]())) <= 1.02 * cost(FRAMES[name]()) + price


def test_composed_steps_of_nodes_without_frames():
    """Of fourth order, and conserving."""
    plan = {"duration": 0.02, "save_every": 10**6}
    exact = fl.schemes.Composed().run(SCENES["crane"](), step=1.25e-4, **plan)
    errors = []
    for step in (1e-3, 5e-4):
        result = fl.schemes.Composed().run(SCENES["crane"](), step=step, **plan)
        assert max(result.balance_error, result.momentum_error) <= 1e-11
        errors.append(np.abs(result.frames[-1, :, 0] - exact.frames[-1, :, 0]).max())
    assert errors[1] <= errors[0] / 9.0


def test_steps_of_each_bodys_own_size():
    """A body and the cable on it make five steps in one of the beam that holds the body."""

    def made() -> fl.Scene:
        scene = fl.Scene()
        beam = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), BAR, cells=2))
        body = scene.add(fl.RigidBody(0.5, (1e-3, 2e-3, 3e-3), position=(1.1, 0, 0)))
        cable = scene.add(fl.Cable.straight((1.1, 0, 0), (2, 0, 0), SOFT, cells=2))
        scene.add(fl.joints.Spherical(beam.point("end"), body.point("centre"), at=(1, 0, 0)))
        scene.add(fl.joints.Spherical(body.point("centre"), cable.point("start")))
        for each in (beam, body, cable):
            each.add_velocity(omega=(0.3, 2.0, 3.0), about=(0.5, 0, 0))
        return scene

    scene = made()
    scheme = fl.schemes.MultiRate(dict.fromkeys(scene.bodies[1:], 5))
    result = scheme.run(scene, duration=0.02, step=1e-3)
    assert max(result.energy_error, result.momentum_error) <= 1e-11
    assert result.angular_momentum_error <= 1e-11
    assert result.joint_violations.max() <= 1e-12
    small = SCHEME.run(made(), duration=0.02, step=1e-4, save_every=10**6)
    away = np.abs(result.frames[-1, :, 0] - small.frames[-1, :, 0]).max()
    assert away <= 1e-2 * np.abs(small.frames[-1, :, 0] - small.frames[0, :, 0]).max()


def test_a_spring_within_a_beam_is_refused():
    scene = SCENES["beam and cable"]()
    hinge = scene.add(fl.joints.Distance(fl.ground(), scene.bodies[0].point_in_cell(0, 0.3)))
    scene.add(fl.joints.Spring(hinge.length, 1.0))
    with pytest.raises(ValueError, match="springs of joints on points that are not nodes"):
        SCHEME.run(scene, duration=0.1, step=0.01)
