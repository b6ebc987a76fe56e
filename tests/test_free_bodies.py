"""Free rigid bodies: the compiled loop against the general road, laws, and failure."""

import logging

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie
from fem_lie.lie.motions import move
from fem_lie.solve.alpha import free_bodies, free_impacts
from fem_lie.solve.alpha.run import Run
from fem_lie.solve.alpha.step import free_body, node
from fem_lie.solve.alpha.step.free_body import Body
from fem_lie.solve.alpha.step.impact_steps import UNSETTLED
from fem_lie.solve.recording.plan import EqualSteps, Saving
from tests import test_contact_bad_input as bad_input

HISTORIES = ("times", "frames", "velocities", "kinetic", "potential", "elastic", "momentum")
FULL = np.array([[2.0, 0.3, -0.2], [0.3, 2.5, 0.1], [-0.2, 0.1, 1.5]])


def loaded(
    count: int = 1, *, gravity=(0.5, 0, -9.81), loads: bool = True, group=fl.lie.Group.SE3
) -> fl.Scene:
    """Bodies with full inertia tensors under every kind of load, no two alike."""
    rng = np.random.default_rng(3)
    scene = fl.Scene(gravity=gravity)
    for _ in range(count):
        R = lie.so3_exp(rng.normal(size=3))
        body = scene.add(
            fl.RigidBody(rng.uniform(1, 2), FULL, rng.normal(size=3), R).set_group(group)
        )
        body.add_velocity(rng.normal(size=3))
        body.add_velocity(omega=3.0 * rng.normal(size=3), about=body.point("centre"))
        if loads:
            for following in (False, True):
                for history in (None, np.sin, lambda t: 1 / (1 + t)):
                    f, m = rng.normal(size=(2, 3))
                    load = fl.PointLoad(
                        body.point("centre"), f, m, following=following, history=history
                    )
                    scene.add(load)
    return scene


def general(options: fl.GeneralisedAlpha, scene: fl.Scene, steps: int, step: float) -> fl.Result:
    """The same by the road that all other scenes take."""
    # the compiled loop has all terms in its matrix
    scene.matrix_terms = fl.schemes.MatrixTerms(gyroscopic=True)
    run = Run(options, fl.extend.Equations(scene, dynamics=True), step)
    return run.run(EqualSteps(Saving(), steps, step), False, None)


def as_r3xso3(options: fl.GeneralisedAlpha, scene: fl.Scene, steps: int, step: float) -> fl.Result:
    for body in scene.bodies:
        body.model.group = fl.lie.Group.R3xSO3
    run = free_bodies.Run(options, fl.extend.Equations(scene, dynamics=True), step)
    return run.run(EqualSteps(Saving(), steps, step), False, None)


# --- the same as by the other road --------------------------------------------------------------


@pytest.mark.parametrize("radius", [0.0, 0.8, 1.0])
@pytest.mark.parametrize("step", [2e-3, 2e-2])
def test_same_as_the_general_road(radius, step):
    """One body: the same iterations, so only round-off is between the two."""
    options = fl.GeneralisedAlpha(radius=radius)
    free = options.run(loaded(), duration=100 * step, step=step)
    other = general(options, loaded(), 100, step)
    for name in (*HISTORIES, "angular_momentum"):
        one, two = getattr(free, name), getattr(other, name)
        np.testing.assert_allclose(one, two, rtol=0, atol=1e-11 * max(1.0, np.abs(two).max()))
    assert (free.iterations == other.iterations).all()
    assert free.factorisations == other.factorisations
    assert free.joint_forces.shape == other.joint_forces.shape == (101, 0, 6)
    assert [body.name for body in free.info.bodies] == ["rigidbody 1"]


def test_same_on_r3xso3_within_the_tolerance():
    """The general road has another approximation in its matrix, so the iterations differ."""
    options = fl.GeneralisedAlpha(tolerance=1e-12)
    free = options.run(loaded(group=fl.lie.Group.R3xSO3), duration=0.2, step=2e-3)
    other = general(options, loaded(group=fl.lie.Group.R3xSO3), 100, 2e-3)
    for name in (*HISTORIES, "angular_momentum"):
        one, two = getattr(free, name), getattr(other, name)
        np.testing.assert_allclose(one, two, rtol=0, atol=1e-10 * max(1.0, np.abs(two).max()))


@pytest.mark.parametrize(
    "policy",
    [
        fl.schemes.EveryIteration(),
        fl.schemes.IterationLimit(2),
        fl.schemes.Automatic(cost=3, patience=2),
        fl.schemes.FactoriseOnce(),
    ],
)
def test_policies_are_those_of_the_general_road(policy):
    options = fl.GeneralisedAlpha(policy=policy)
    free = options.run(loaded(), duration=1.0, step=1e-2)
    other = general(options, loaded(), 100, 1e-2)
    assert (free.iterations == other.iterations).all()
    assert free.factorisations == other.factorisations


def test_several_bodies_are_as_exact_as_the_general_road():
    """Its tolerance is that of the whole scene, here every body has its own."""
    options = fl.GeneralisedAlpha(tolerance=1e-12)
    free = options.run(loaded(3), duration=0.2, step=2e-3)
    other = general(options, loaded(3), 100, 2e-3)
    np.testing.assert_allclose(free.frames, other.frames, rtol=0, atol=1e-10)
    np.testing.assert_allclose(free.angular_momentum, other.angular_momentum, rtol=0, atol=1e-9)


def test_which_scenes_take_the_compiled_loop(caplog):
    class Mine(fl.schemes.RefactorisationPolicy):
        def begin(self, bound):
            return Always()

    class Always(fl.extend.PolicyState):
        def before_iteration(self, iteration):
            return True

    def held(item) -> fl.Scene:
        scene = loaded(loads=False, gravity=(0, 0, 0))
        scene.bodies[0].velocities[:] = 0.0
        scene.add(item(scene.bodies[0].point("centre")))
        return scene

    section = fl.Section.rectangle(0.1, 0.1, fl.Material(1e9, 0.3, 1000))
    beams = fl.Scene()
    beams.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=2))
    automatic = fl.schemes.Automatic()
    assert free_impacts.applies(loaded(2), automatic)
    assert not free_impacts.applies(loaded(2), Mine())
    assert not free_impacts.applies(fl.Scene(), automatic)
    assert not free_impacts.applies(beams, automatic)
    for item in (
        fl.Clamp,
        lambda point: fl.joints.Spherical(fl.ground(), point),
        lambda point: fl.PrescribedMotion(point, lambda t: point.frame),
    ):
        assert not free_impacts.applies(held(item), automatic)
    with caplog.at_level(logging.INFO, logger="fem_lie"):
        fl.GeneralisedAlpha(policy=Mine()).run(loaded(), duration=0.01, step=0.01)
        assert not any("free rigid bodies" in message for message in caplog.messages)
        caplog.clear()
        fl.GeneralisedAlpha().run(loaded(), duration=0.01, step=0.01)
    assert caplog.messages == ["free rigid bodies only (1): no matrix of the scene"]


# --- laws ---------------------------------------------------------------------------------------


def exact(times: np.ndarray, spin: np.ndarray, ratio: float) -> np.ndarray:
    """Closed form for J = diag(1, 1, ratio): precession about L, turning about e₃ against it."""
    axis = np.array([0, 0, (ratio - 1) * spin[2]])
    precession = spin * [1, 1, ratio]
    t = times[:, np.newaxis]
    return lie.so3_exp(t * precession) @ lie.so3_exp(-t * axis)


@pytest.mark.parametrize("radius", [0.0, 0.8, 1.0])
@pytest.mark.parametrize("ratio", [0.4, 1.7])
def test_second_order_in_rotation_and_velocity(radius, ratio):
    """Against the closed form."""
    spin, errors = np.array([2.0, 1.0, 5.0]), []
    for step in (4e-3, 2e-3, 1e-3):
        scene = fl.Scene()
        body = scene.add(fl.RigidBody(1.0, (1, 1, ratio)))
        body.add_velocity(omega=spin, about=body.point("centre"))
        result = fl.GeneralisedAlpha(radius=radius).run(scene, duration=1.0, step=step)
        R = exact(result.times, spin, ratio)
        error = lie.so3_log(R.transpose(0, 2, 1) @ result.rotation(body.point("centre")))
        axis = np.array([0, 0, (ratio - 1) * spin[2]])
        omega = lie.so3_exp(result.times[:, np.newaxis] * axis) @ spin
        gap = np.abs(result.velocities[:, 0, 3:] - omega)
        errors.append([np.abs(error).max(), gap.max()])
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders.min() > 1.9, orders


def test_energy_and_momentum_to_second_order():
    def drift(step: float) -> np.ndarray:
        result = fl.GeneralisedAlpha(radius=0.9).run(
            loaded(loads=False, gravity=(0, 0, 0)), duration=1.0, step=step
        )
        return np.array([result.energy_error, result.momentum_error, result.angular_momentum_error])

    coarse, fine = drift(4e-3), drift(2e-3)
    assert fine.max() < 1e-4
    assert (coarse > 3.5 * fine).all()


def test_translation_without_spin_is_exact():
    """A parabola: the scheme integrates constant acceleration to round-off."""
    scene = fl.Scene(gravity=(0, 0, -10))
    R = lie.so3_exp([1, 2, 3])
    body = scene.add(fl.RigidBody(2.0, FULL, (1, 2, 3), R))
    body.add_velocity((1, 0, 4))
    scene.add(fl.PointLoad(body.point("centre"), force=(6, 0, 0)))
    scene.add(fl.PointLoad(body.point("centre"), force=(0, 2, 0), following=True))
    result = fl.GeneralisedAlpha().run(scene, duration=1.0, step=0.05)
    t = result.times[:, np.newaxis]
    path = [1, 2, 3] + t * [1, 0, 4] + 0.5 * t**2 * (np.array([3, 0, -10]) + R[:, 1])
    np.testing.assert_allclose(result.position(body.point("centre")), path, rtol=0, atol=1e-12)
    # but for the work of the following force
    work = 2.0 * (path - path[0]) @ R[:, 1]
    energy = result.total_energy - result.total_energy[0] - work
    assert np.abs(energy).max() < 1e-10


def test_history_gives_its_impulse():
    """Momentum under a load with history is the integral of it, in space."""
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(2.0, FULL))
    body.add_velocity(omega=(1, 2, 3), about=body.point("centre"))
    calls = []

    def history(t: float) -> float:
        calls.append(t)
        return np.cos(7 * t)

    scene.add(fl.PointLoad(body.point("centre"), (1, 2, 0), (0, 3, 1), history=history))
    step = 1e-3
    result = fl.GeneralisedAlpha().run(scene, duration=0.5, step=step)
    impulse = np.sin(7 * result.times)[:, np.newaxis] / 7
    assert np.abs(result.momentum - impulse * [1, 2, 0]).max() < 2e-5
    spin = result.angular_momentum - np.cross(
        result.position(body.point("centre")), result.momentum
    )
    turned = spin - spin[0] - impulse * [0, 3, 1]
    assert np.abs(turned).max() < 1e-4
    # once for each step, and a few times for the start
    assert len(calls) < 505
    assert np.isclose(calls[-500:], step * np.arange(1, 501)).all()


def test_history_that_is_not_finite():
    scene = loaded(loads=False)
    scene.add(fl.PointLoad(scene.bodies[0].point("centre"), force=(1, 0, 0)))
    load = fl.PointLoad(
        scene.bodies[0].point("centre"), (1, 0, 0), history=lambda t: np.inf if t > 0.035 else 1.0
    )
    scene.add(load)
    with pytest.raises(ValueError, match=r"the history of load 2 is inf at time 0\.04"):
        fl.GeneralisedAlpha().run(scene, duration=0.1, step=0.01)


# --- many bodies --------------------------------------------------------------------------------


def test_thousand_bodies_are_thousand_single_runs():
    """Bit for bit: each has its own iteration, whatever else is in the scene."""
    scene = loaded(1000, loads=False)
    options = fl.GeneralisedAlpha()
    loads = np.random.default_rng(5).normal(size=(1000, 2, 3))
    for k, (body, (f, m)) in enumerate(zip(scene.bodies, loads, strict=True)):
        scene.add(fl.PointLoad(body.point("centre"), f, m, following=k % 2 == 0, history=np.cos))
    whole = options.run(scene, duration=0.05, step=1e-3, save_every=7)
    for k in range(0, 1000, 9):
        single = fl.Scene(gravity=scene.gravity)
        body = scene.bodies[k]
        single.add(body)
        single.add(scene.loads[k])
        alone = options.run(single, duration=0.05, step=1e-3, save_every=7)
        assert (alone.frames[:, 0] == whole.frames[:, k]).all()
        assert (alone.velocities[:, 0] == whole.velocities[:, k]).all()
        assert (alone.iterations <= whole.iterations).all()
    assert len(whole.times) == 50 // 7 + 2
    assert whole.factorisations >= 1000


def test_invariants_are_sums_over_bodies():
    result = fl.GeneralisedAlpha().run(loaded(5), duration=0.1, step=0.01)
    mass = np.array([body.model.mass_matrix[0, 0] for body in loaded(5).bodies])
    R, v = result.frames[:, :, 1:], result.velocities
    speed = np.einsum("tnkj,tnk->tnj", R, v[..., :3])
    spin = np.einsum("tnkj,tnk->tnj", R, v[..., 3:] @ FULL)
    momentum = mass[:, np.newaxis] * speed
    kinetic = 0.5 * (momentum * speed).sum((1, 2))
    kinetic += 0.5 * np.einsum("tnk,kl,tnl->t", v[..., 3:], FULL, v[..., 3:])
    np.testing.assert_allclose(result.kinetic, kinetic, rtol=1e-12)
    np.testing.assert_allclose(result.momentum, momentum.sum(1), rtol=1e-12, atol=1e-12)
    angular = (spin + np.cross(result.frames[:, :, 0], momentum)).sum(1)
    np.testing.assert_allclose(result.angular_momentum, angular, rtol=1e-12, atol=1e-12)


def test_rows_do_not_depend_on_what_is_kept_or_shown(capsys, monkeypatch):
    full = fl.GeneralisedAlpha().run(loaded(2), duration=0.5, step=1e-3)
    part = fl.GeneralisedAlpha().run(
        loaded(2), duration=0.5, step=1e-3, save_every=7, progress=True
    )
    bar = capsys.readouterr().err
    assert "500/500" in bar
    assert "it/step" in bar
    monkeypatch.setattr(free_bodies, "_CHUNK", 26)
    chunks = fl.GeneralisedAlpha().run(loaded(2), duration=0.5, step=1e-3)
    rows = [*range(0, 500, 7), 500]
    for name in (*HISTORIES, "angular_momentum", "iterations"):
        assert (getattr(part, name) == getattr(full, name)[rows]).all(), name
        assert (getattr(chunks, name) == getattr(full, name)).all(), name


# --- failure ------------------------------------------------------------------------------------


def kicked(count: int = 1) -> fl.Scene:
    """A moment far too large for the step hits the last body at 0.05."""
    scene = loaded(count, loads=False)
    point = scene.bodies[-1].point("centre")
    scene.add(fl.PointLoad(point, moment=(0, 1e9, 2e9), history=lambda t: t > 0.055))
    return scene


def test_failure_is_that_of_the_general_road():
    options = fl.GeneralisedAlpha(max_iterations=4)
    with pytest.raises(fl.ConvergenceError, match=r"step 6 of 50 .*residual") as free:
        options.run(kicked(), duration=0.5, step=1e-2)
    with pytest.raises(fl.ConvergenceError, match=r"step 6 of 50 .*residual") as other:
        general(options, kicked(), 50, 1e-2)
    one, two = free.value.result, other.value.result
    assert len(one.times) == len(two.times) == 6
    np.testing.assert_allclose(one.frames, two.frames, rtol=0, atol=1e-12)
    assert np.isfinite(one.frames).all()
    assert (one.iterations == two.iterations).all()


def test_failure_of_one_body_ends_the_run_of_all():
    """The message names it; rows after the last step that all have made are not there."""
    scene = kicked(3)
    with pytest.raises(fl.ConvergenceError, match="rigidbody 3: step 6 of 50") as info:
        fl.GeneralisedAlpha(max_iterations=4).run(scene, duration=0.5, step=1e-2, save_every=2)
    result = info.value.result
    np.testing.assert_allclose(result.times, [0, 0.02, 0.04], atol=1e-15)
    free = fl.GeneralisedAlpha().run(loaded(3, loads=False), duration=0.04, step=1e-2, save_every=2)
    np.testing.assert_allclose(result.frames, free.frames, rtol=0, atol=1e-12)


def spinning(ω: tuple[float, float, float]) -> fl.Scene:
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(1.0, (1, 2, 2.5)))
    body.add_velocity(omega=ω, about=body.point("centre"))
    return scene


def test_a_failed_step_is_divided_as_on_the_general_road():
    options, ω = fl.GeneralisedAlpha(max_iterations=2), (3.0, 4.0, 5.0)
    one = options.run(spinning(ω), duration=0.2, step=0.1)
    two = general(options, spinning(ω), 2, 0.1)
    assert one.divided == two.divided == 2
    np.testing.assert_allclose(one.frames, two.frames, rtol=0, atol=1e-6)


def test_spin_beyond_the_step_fails():
    """A hundred radians in a step: what was computed before is kept, and finite."""
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(1.0, (1, 2, 2.5)))
    body.add_velocity(omega=(600, 800, 1000), about=body.point("centre"))
    options = fl.GeneralisedAlpha(max_iterations=4)
    with pytest.raises(fl.ConvergenceError, match=r"step \d of 10 .* Try a smaller step") as info:
        options.run(scene, duration=1.0, step=0.1)
    result = info.value.result
    assert 1 <= len(result.times) < 10
    assert np.isfinite(result.velocities).all()


# --- R³×SO(3) -----------------------------------------------------------------------------------


def test_groups_turn_alike():
    """Turning does not depend on the translation, so it is the same on both groups."""
    options = fl.GeneralisedAlpha(tolerance=1e-12)
    one = options.run(loaded(2), duration=0.2, step=2e-3)
    two = as_r3xso3(options, loaded(2), 100, 2e-3)
    np.testing.assert_allclose(one.frames[:, :, 1:], two.frames[:, :, 1:], rtol=0, atol=1e-10)
    np.testing.assert_allclose(one.velocities[..., 3:], two.velocities[..., 3:], rtol=0, atol=1e-9)


def test_groups_meet_as_the_step_becomes_small():
    """Two schemes of second order for one motion."""
    gaps = []
    for steps in (100, 200, 400):
        options = fl.GeneralisedAlpha(tolerance=1e-10)
        one = options.run(loaded(), duration=0.5, step=0.5 / steps)
        two = as_r3xso3(options, loaded(), steps, 0.5 / steps)
        every = steps // 100
        gaps.append(
            [
                np.abs(one.frames - two.frames)[::every].max(),
                np.abs(one.velocities - two.velocities)[::every].max(),
            ]
        )
    orders = np.log2(np.array(gaps[:-1]) / gaps[1:])
    assert orders.min() > 1.9, orders


def test_translation_is_exact_on_r3xso3_whatever_the_spin():
    """It is decoupled; on SE(3) the same run is wrong by 1e-4."""
    scene = loaded(loads=False, gravity=(1, 0, -10))
    start, v = scene.bodies[0].frames[0], scene.bodies[0].velocities[0]
    result = as_r3xso3(fl.GeneralisedAlpha(), scene, 50, 0.02)
    t = result.times[:, np.newaxis]
    path = start[0] + t * (start[1:].T @ v[:3]) + 0.5 * t**2 * [1, 0, -10]
    np.testing.assert_allclose(result.position(0), path, rtol=0, atol=1e-12)
    assert result.momentum_error < 1e-13, "gravity has an impulse"
    scene.bodies[0].model.group = fl.lie.Group.SE3
    other = fl.GeneralisedAlpha().run(scene, duration=1.0, step=0.02)
    assert np.abs(other.position(0) - path).max() > 1e-5


@pytest.mark.parametrize("group", [int(fl.lie.Group.SE3), int(fl.lie.Group.R3xSO3)])
def test_matrix_is_the_derivative_of_the_residual(group):
    """By central differences along every increment, through the laws of the scheme."""
    rng = np.random.default_rng(2)
    p = node.parameters(0.8, 0.05)
    H = lie.se3_exp(rng.normal(size=6))
    f = 10.0 * rng.normal(size=12)
    d, v1, vdot1 = 0.3 * rng.normal(size=(3, 6))

    def residual(x: np.ndarray) -> np.ndarray:
        moved, end = d + x, np.empty((4, 3))
        move(group, H, moved, end)
        rate, acceleration = v1 + p.damping * x, vdot1 + p.mass * x
        return np.concatenate(free_body.residual(group, 1.3, FULL, f, end, rate, acceleration))

    H1, kept = np.empty((4, 3)), np.empty((9, 3))
    move(group, H, d, H1)
    free_body.factorise(p, Body(group, 1.3, FULL, np.ones(2)), f, H1, v1, d, kept)
    matrix = np.zeros((6, 6))
    matrix[:3, :3], matrix[3:, 3:] = np.linalg.inv(kept[6:]), np.linalg.inv(kept[:3])
    matrix[:3, 3:] = kept[3:6].T
    size = 1e-5
    columns = [(residual(x) - residual(-x)) / (2 * size) for x in size * np.eye(6)]
    np.testing.assert_allclose(matrix, np.array(columns).T, rtol=0, atol=1e-6 * p.mass)


def test_axes_that_are_held_do_not_move():
    body = fl.RigidBody(1.0, np.ones(3), (0, 0, 0))
    body.model.held[0, 2] = True
    scene = fl.Scene(gravity=(1, 0, -9.81))
    scene.add(body)
    result = fl.GeneralisedAlpha(radius=0.8).run(scene, duration=0.1, step=1e-2, progress=False)
    np.testing.assert_allclose(result.position(body.point("centre"))[-1], [5e-3, 0, 0], atol=1e-12)


def unsettled() -> None:
    """The message of a step that has failed, of two balls that were made to be wedged."""
    scene = bad_input.falling(
        fl.contact.Impact(),
        [bad_input.ball((0, 0, 0), "left"), bad_input.ball((0.2, 0, 0), "right")],
    )
    equations = fl.extend.Equations(scene.without_impacts(), dynamics=True)
    one = free_bodies.Run(fl.GeneralisedAlpha(radius=0.8), equations, 1e-2)
    assert one._impacts is not None
    one._impacts._why, reported = UNSETTLED, one._impacts._failed_step
    reported["contacts"], reported["residual"] = 1, 4e-3
    raise fl.ConvergenceError(one._failure(1))


def test_contacts_that_did_not_converge_are_named():
    with pytest.raises(
        fl.ConvergenceError,
        match=r"1 contacts did not converge \(residual 4e-03\).* such as left and right\?",
    ):
        unsettled()
