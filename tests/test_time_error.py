"""Local errors of time integration, and steps that follow a tolerance."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie
from studies.time_error import TIP, rigid_pendulum, tip
from studies.variable_step import four_bar

PARTS = 10
# of second order, an error measured by a step in PARTS parts lacks that of the parts
MISSING = 1.0 - 1.0 / PARTS**2
KINDS = [
    (group, parametrisation) for group in fl.lie.Group for parametrisation in fl.lie.Parametrisation
]


def tumbling(group: fl.lie.Group = fl.lie.Group.R3xSO3) -> fl.Scene:
    """A free body under smooth loads."""
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(2.0, (1.0, 2.0, 2.5), (0.3, 0, 0), name="body").set_group(group))
    body.add_velocity((1.0, -2.0, 0.5))
    body.add_velocity(omega=(3.0, 2.0, -1.0), about=body.point("centre"))
    scene.add(
        fl.PointLoad(body.point("centre"), force=(9, 5, -7), history=lambda t: math.sin(4 * t + 1))
    )
    scene.add(
        fl.PointLoad(
            body.point("centre"),
            moment=(3, -2, 5),
            following=True,
            history=lambda t: math.cos(3 * t),
        )
    )
    return scene


def with_joints(group: fl.lie.Group) -> fl.Scene:
    """The double pendulum, turning about all axes."""
    scene = rigid_pendulum(group)
    for body in scene.bodies:
        body.add_velocity(omega=(5.0, 1.0, 4.0), about=(0, 0, 0))
    return scene


def driven_crank() -> fl.Scene:
    """A crank of 0.3 m makes a revolution in 1 s, on it a rod of 0.6 m and a slider of 2 kg."""
    scene, ground = fl.Scene(), fl.ground()
    crank = scene.add(fl.RigidBody(1.0, (0.01, 0.01, 0.01), (0.15, 0, 0), name="crank"))
    rod = scene.add(fl.RigidBody(1.0, (0.001, 0.03, 0.03), (0.6, 0, 0), name="rod"))
    slider = scene.add(fl.RigidBody(2.0, (0.01, 0.01, 0.01), (0.9, 0, 0), name="slider"))
    inner, middle, outer = (body.point("centre") for body in (crank, rod, slider))
    joints = fl.joints
    axle = scene.add(joints.Revolute(ground, inner, at=(0, 0, 0), axis=(0, 0, 1)))
    scene.add(joints.Spherical(inner, middle, at=(0.3, 0, 0)))
    scene.add(joints.Revolute(middle, outer, at=(0.9, 0, 0), axis=(0, 0, 1)))
    scene.add(joints.InPlane(ground, outer, at=(0.9, 0, 0), axis=(0, 1, 0)))
    scene.add(joints.Drive(axle.angle, lambda t: 2 * np.pi * t, name="motor"))
    fl.schemes.set_initial_velocities(scene, 1e-4)
    return scene


def run(
    scene: fl.Scene, step: float | fl.extend.StepChoice, duration: float = 1.0, **options
) -> fl.Result:
    return fl.GeneralisedAlpha(**options).run(scene, duration=duration, step=step)


# --- the estimate ---


@pytest.mark.parametrize(("group", "parametrisation"), KINDS)
@pytest.mark.parametrize("make", [tumbling, with_joints])
def test_estimate_over_error_tends_to_one(make, group, parametrisation):
    """With a matrix of its own in every step; a kept one changes the estimate, not its order."""
    away = []
    for h in (4e-3, 2e-3):
        result = run(
            make(group),
            fl.schemes.ConstantStep(h, refinement=PARTS),
            0.2,
            parametrisation=parametrisation,
            policy=fl.schemes.EveryIteration(),
            tolerance=1e-11,
        )
        # the first steps have what is left of the start
        ratios = MISSING * result.steps.ratios[5:]
        away.append(np.median(np.abs(ratios - 1.0), axis=0))
    assert (away[1] < 0.04).all()
    # of first order in h; nearly nothing is nothing
    assert ((away[1] < 0.65 * away[0]) | (away[1] < 2e-3)).all()


def test_estimate_is_of_third_order():
    sizes = [
        run(tumbling(), fl.schemes.ConstantStep(h), 0.2).steps.translation[-1] for h in (2e-3, 1e-3)
    ]
    assert 2.9 < np.log2(sizes[0] / sizes[1]) < 3.1


def test_flight_has_no_error():
    """On R³×SO(3) the parabola is exact, and the estimate says so."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    body = scene.add(fl.RigidBody(1.0, (1.0, 1.0, 1.0), name="body"))
    body.add_velocity((1, 0, 5))
    steps = run(scene, fl.schemes.ConstantStep(0.01), 0.2, tolerance=1e-12).steps
    assert steps.translation.max() < 1e-13
    assert steps.rotation.max() < 1e-13


def test_estimating_changes_nothing():
    """Nor do the components of the matrix change the estimate."""
    # a matrix in each iteration: constant steps keep factors whole, plain ones renew borders alone
    options = {"policy": fl.schemes.EveryIteration(), "tolerance": 1e-11}
    plain = run(with_joints(fl.lie.Group.SE3), 2e-3, 0.2, **options)
    watched = run(with_joints(fl.lie.Group.SE3), fl.schemes.ConstantStep(2e-3), 0.2, **options)
    inertial = run(
        with_joints(fl.lie.Group.SE3),
        fl.schemes.ConstantStep(2e-3),
        0.2,
        matrix_frame=fl.schemes.MatrixFrame.INERTIAL,
    )
    np.testing.assert_allclose(watched.frames, plain.frames, atol=1e-9)
    np.testing.assert_allclose(watched.joint_forces, plain.joint_forces, atol=1e-4)
    np.testing.assert_allclose(inertial.steps.translation, watched.steps.translation, rtol=0.05)


def test_nodes_of_the_error_are_those_of_the_results():
    result = run(with_joints(fl.lie.Group.SE3), fl.schemes.ConstantStep(1e-3), 0.01)
    far, _ = result.info.node("bar II.centre"), result.info.node("bar I.centre")
    assert (result.steps.nodes[:, 0] == far).all()


# --- the order with steps that change ---


class Zigzag(fl.extend.Control):
    """Up and down by one level, again and again."""

    def accept(self, e: float) -> None:
        self.level = 1 - self.level


@dataclass(frozen=True)
class Alternating(fl.extend.StepChoice):
    size: float
    refinement: int = 1

    def check(self, duration: float) -> None:
        pass

    def control(self, duration: float, length: float, order: int, jumps=()) -> fl.extend.Control:
        return Zigzag(self.size, math.inf, math.inf, (duration,), 1.0, 0.0, order)


@pytest.mark.parametrize("group", list(fl.lie.Group))
def test_second_order_with_alternating_steps(group):
    """Joint forces, too: wrong by a tenth if velocities across joints stay as they are."""
    options = {"policy": fl.schemes.EveryIteration()}
    exact = run(with_joints(group), 2.5e-4, 0.5, **options)
    errors, forces = [], []
    for h in (4e-3, 2e-3, 1e-3):
        result = run(with_joints(group), Alternating(h), 0.5, **options)
        sizes = result.steps.sizes[:20] / h
        np.testing.assert_allclose(sizes, np.tile([1.0, 2**0.5], 10), rtol=1e-12)
        same = exact.resampled(result.times[5:])
        gaps = result.position("bar II.centre")[5:] - same.position("bar II.centre")
        errors.append(np.abs(gaps).max())
        forces.append(np.abs(result.joint_forces[5:] - same.joint_forces).max())
    # what the exact run lacks is a tenth of the last error
    assert np.log2(errors[0] / errors[2]) / 2 > 1.85
    assert np.log2(forces[0] / forces[2]) / 2 > 1.85
    assert forces[2] < 1e-3 * np.abs(exact.joint_forces).max()


def test_joint_forces_with_kept_matrices():
    """The part of velocities across the joints is found with an old Jacobian."""
    exact = run(with_joints(fl.lie.Group.R3xSO3), 2.5e-4, 0.5)
    result = run(with_joints(fl.lie.Group.R3xSO3), Alternating(1e-3), 0.5)
    same = exact.resampled(result.times[5:])
    gap = np.abs(result.joint_forces[5:] - same.joint_forces).max()
    assert gap < 3e-3 * np.abs(exact.joint_forces).max()


class TooLarge(fl.extend.Control):
    """Tries twice the size before each step, which is rejected."""

    def ratio(self, translation: float, rotation: float, h: float) -> float:
        return 10.0 * self.level

    def accept(self, e: float) -> None:
        self.level = 2

    def reject(self, e: float) -> None:
        self.level = 0


@dataclass(frozen=True)
class FirstTooLarge(Alternating):
    def control(self, duration: float, length: float, order: int, jumps=()) -> fl.extend.Control:
        return TooLarge(self.size, math.inf, math.inf, (duration,), 1.0, 0.0, order)


@pytest.mark.parametrize("make", [with_joints, lambda _: driven_crank()])
def test_rejected_sizes_leave_no_trace(make):
    """Velocities across joints are of the size of the next step, not of one that was rejected."""
    exact = run(make(fl.lie.Group.SE3), 1e-3, 0.2)
    result = run(make(fl.lie.Group.SE3), FirstTooLarge(1e-3), 0.2)
    assert len(result.steps.rejected) > 190
    # the last steps, which end at the end of the run, are smaller
    same = slice(3, 190)
    gap = np.abs(result.joint_forces[same] - exact.joint_forces[same]).max()
    assert gap < 2e-3 * np.abs(exact.joint_forces).max()


# --- the tolerance ---


@pytest.mark.parametrize(
    "scheme", [fl.GeneralisedAlpha(), fl.EnergyMomentum(), fl.EnergyDecaying()]
)
def test_velocities_of_a_driven_mechanism_follow_the_tolerance(scheme):
    """Positions have no error, and say nothing about the step."""
    errors, numbers = [], []
    for tolerance in (1e-1, 1e-2, 1e-3):
        step = fl.schemes.AdaptiveStep(tolerance)
        result = scheme.run(driven_crank(), duration=1.0, step=step)
        angle = 2 * np.pi * result.times
        sine, cosine = np.sin(angle), np.cos(angle)
        along = np.sqrt(0.6**2 - 0.3**2 * sine**2)
        assert np.abs(result.position("slider.centre")[:, 0] - 0.3 * cosine - along).max() < 1e-9
        speed = -2 * np.pi * (0.3 * sine + 0.3**2 * sine * cosine / along)
        errors.append(np.abs(result.velocity("slider.centre")[:, 0] - speed).max() / tolerance)
        numbers.append(len(result.times))
    assert max(errors[1:]) < 4.0
    assert numbers[2] > 2 * numbers[1]


@pytest.mark.parametrize("group", list(fl.lie.Group))
def test_global_error_follows_the_tolerance(group):
    tolerances = 10.0 ** np.arange(-2, -6.5, -1)
    errors = []
    for tolerance in tolerances:
        result = run(rigid_pendulum(group), fl.schemes.AdaptiveStep(tolerance, 2 * tolerance))
        errors.append(np.linalg.norm(tip(result)[-1] - TIP))
        steps = result.steps
        assert (steps.translation <= tolerance * steps.sizes).all()
        assert (steps.rotation <= 2 * tolerance * steps.sizes).all()
    slope = np.polyfit(np.log(tolerances), np.log(errors), 1)[0]
    assert 0.8 < slope < 1.2


def test_rotations_have_their_own_tolerance():
    loose, strict = (
        run(tumbling(), fl.schemes.AdaptiveStep(1e-1, rotation_tolerance=value), 0.5)
        for value in (1e-3, 1e-5)
    )
    assert len(strict.times) > 5 * len(loose.times)
    assert (strict.steps.rotation <= 1e-5 * strict.steps.sizes).all()


def spinning_top() -> fl.Scene:
    """On a spherical joint; R. Brüls & A. Cardona's."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    top = scene.add(fl.RigidBody(15.0, (0.234375, 0.234375, 0.46875), (0, 1, 0), name="top"))
    scene.add(fl.joints.Spherical(top.point("centre"), fl.ground(), at=(0, 0, 0)))
    top.add_velocity(omega=(0.0, 150.0, 0.0), about=(0, 0, 0))
    return scene


@pytest.mark.parametrize(
    ("make", "tolerance"), [(rigid_pendulum, 1e-5), (tumbling, 1e-3), (spinning_top, 1e-4)]
)
def test_factorisations_are_kept_when_steps_change(make, tolerance):
    result = run(make(), fl.schemes.AdaptiveStep(tolerance))
    assert len(np.unique(result.steps.sizes.round(9))) >= 3
    assert result.factorisations <= 0.02 * len(result.steps.times)


def test_sizes_are_levels():
    """But for the steps that are made to fit the end."""
    result = run(rigid_pendulum(), fl.schemes.AdaptiveStep(1e-4, first=1e-3))
    levels = 2.0 * np.log2(result.steps.sizes / 1e-3)
    away = np.abs(levels - levels.round()) > 1e-6
    assert not away[:-4].any()
    assert result.times[-1] == 1.0
    np.testing.assert_allclose(np.cumsum(result.steps.sizes), result.steps.times, rtol=1e-12)


def test_stiff_waves_do_not_stop_the_steps():
    """After steps that do not resolve stiff bars a smaller one finds its accelerations anew.

    Without that steps fall to 1e-9 s, and there are 100 000.
    """
    result = run(four_bar(4), fl.schemes.AdaptiveStep(1e-2, largest=0.05), 3.0)
    assert len(result.steps.rejected) >= 2
    assert result.steps.sizes.min() > 1e-7
    assert len(result.steps.times) < 1000


# --- events ---


def pushed(history) -> fl.Scene:
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(2.0, (1.0, 1.0, 1.0), name="ball"))
    scene.add(fl.PointLoad(body.point("centre"), force=(6.0, 0, 0), history=history))
    return scene


def jump(t: float) -> float:
    return 1.0 if t >= 0.3 else 0.0


def test_jump_at_a_named_event():
    """Steps end there, and both sides are exact: rest, and a parabola."""
    result = run(pushed(jump), fl.schemes.AdaptiveStep(1e-6, events=(0.3,)))
    assert (result.times == 0.3).sum() == 2
    assert len(result.steps.rejected) == 0
    exact = 1.5 * np.clip(result.times - 0.3, 0.0, None) ** 2
    np.testing.assert_allclose(result.position("ball.centre")[:, 0], exact, atol=1e-8)


def test_jump_found_by_rejection():
    result = run(pushed(jump), fl.schemes.AdaptiveStep(1e-4))
    assert len(result.steps.rejected) >= 3
    near = np.abs(result.steps.times - 0.3).argmin()
    assert result.steps.sizes[near] < 1e-2 * result.steps.sizes.max()
    exact = 1.5 * np.clip(result.times - 0.3, 0.0, None) ** 2
    np.testing.assert_allclose(result.position("ball.centre")[:, 0], exact, atol=1e-4)


def arm_that_stops() -> fl.Scene:
    """An arm that is driven to turn by 2 rad/s, and stopped at once at 0.4 s."""
    scene = fl.Scene()
    arm = scene.add(fl.RigidBody(1.0, (0.1, 0.1, 0.1), (0.5, 0, 0), name="arm"))
    arm.add_velocity(omega=(0, 0, 2.0), about=(0.5, 0, 0))
    frame = arm.point("centre").frame.copy()

    def drive(t: float) -> np.ndarray:
        turned = frame.copy()
        turned[1:] = frame[1:] @ lie.so3_exp(np.array([0, 0, 2.0 * min(t, 0.4)])).T
        return turned

    scene.add(fl.PrescribedMotion(arm.point("centre"), drive))
    return scene


def test_kink_of_a_drive():
    """A drive that stops at once: the velocity of what it drives jumps with it."""
    choice = fl.schemes.AdaptiveStep(1e-4, events=(0.4,), largest=0.05)
    result = run(arm_that_stops(), choice)
    # both sides are kept
    event = int(np.flatnonzero(result.times == 0.4)[1])
    spin = result.velocity("arm.centre")[:, 5]
    np.testing.assert_allclose(spin[:event], 2.0, atol=1e-6)
    np.testing.assert_allclose(spin[event:], 0.0, atol=1e-6)
    # and no reaction, on either side
    np.testing.assert_allclose(result.joint_forces, 0.0, atol=1e-3)
    times = np.linspace(0, 1, 101)
    angles = result.resampled(times).rotation("arm.centre")[:, 1, 0]
    np.testing.assert_allclose(angles, np.sin(2 * np.minimum(times, 0.4)), atol=1e-6)


# --- what goes wrong ---


def test_tolerance_out_of_reach_names_time_error_and_body():
    # no step is small enough for a force that grows beyond all bounds
    scene = pushed(lambda t: (0.5 - t) ** -2 if t < 0.5 else 1e6)
    expected = r"at time 0\.4\d+ a step of .* error of .* length per time, "
    expected += r"expected at most 1\.000e-03"
    with pytest.raises(fl.ConvergenceError, match=expected + ".*; ball limits it") as caught:
        run(scene, fl.schemes.AdaptiveStep(1e-3, smallest=1e-6))
    assert 0.4 < caught.value.result.times[-1] < 0.5
    assert len(caught.value.result.steps.times) == len(caught.value.result.times) - 1


def test_step_that_does_not_converge_is_tried_smaller():
    scene, options = with_joints(fl.lie.Group.SE3), {"max_iterations": 4}
    with pytest.raises(fl.ConvergenceError, match="did not converge in 4"):
        run(scene, 0.04, 0.2, policy=fl.schemes.FactoriseOnce(), **options)
    for step in (
        fl.schemes.AdaptiveStep(1.0, first=0.04, largest=0.04),
        fl.schemes.ConstantStep(0.04),
    ):
        result = run(scene, step, 0.2, **options)
        assert len(result.steps.rejected) > 0
        assert result.times[-1] == 0.2
    assert run(scene, 0.04, 0.2, **options).divided > 0
    options["max_iterations"] = 1
    with pytest.raises(fl.ConvergenceError, match=r"did not converge, and smaller ones than 0\.00"):
        run(scene, fl.schemes.ConstantStep(0.04), 0.2, **options)


@pytest.mark.parametrize(
    ("choice", "message"),
    [
        (fl.schemes.AdaptiveStep(0.0), "tolerance must be a positive finite number, got 0.0"),
        (
            fl.schemes.AdaptiveStep(1e-3, rotation_tolerance=-1.0),
            "rotation_tolerance must be a positive",
        ),
        (fl.schemes.AdaptiveStep(1e-3, first=2.0, largest=0.5), "smallest ≤ first ≤ largest"),
        (fl.schemes.AdaptiveStep(1e-3, events=(1.5,)), r"events must be in \(0, 1\), got \[1.5\]"),
        (fl.schemes.AdaptiveStep(1e-3, refinement=0), "refinement must be at least 1, got 0"),
        (fl.schemes.ConstantStep(-1.0), "the step must be a positive finite number, got -1.0"),
        (fl.schemes.ConstantStep(0.3), "duration 1.0 is not a multiple of the step 0.3"),
    ],
)
def test_bad_choices(choice, message):
    with pytest.raises(ValueError, match=message):
        run(tumbling(), choice)


# --- between the steps ---


def test_resampled_is_of_fourth_order():
    errors = []
    for every in (4, 2):
        fine = run(tumbling(), 1e-3, 0.4, tolerance=1e-11)
        coarse = thinned(fine, 20 * every)
        between = coarse.resampled(fine.times)
        gaps = lie.se3_relative(between.frames, fine.frames)
        errors.append((np.abs(gaps).max(), np.abs(between.velocities - fine.velocities).max()))
    orders = np.log2(np.array(errors[0]) / np.array(errors[1]))
    assert orders[0] > 3.6
    assert orders[1] > 2.6


def thinned(result: fl.Result, every: int) -> fl.Result:
    rows = {
        field.name: value[::every]
        for field in fields(result)
        if isinstance(value := getattr(result, field.name), np.ndarray)
    }
    return replace(result, **rows)


def test_resampled_meets_what_was_kept_and_screws_exactly():
    result = run(tumbling(), 0.01, 0.2)
    same = result.resampled(result.times)
    np.testing.assert_allclose(same.frames, result.frames, atol=1e-14)
    np.testing.assert_allclose(same.velocities, result.velocities, atol=1e-12)
    np.testing.assert_array_equal(same.kinetic, result.kinetic)
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(1.0, (1.0, 1.0, 1.0), name="ball"))
    body.add_velocity(omega=(0, 0, 2.0), about=body.point("centre"))
    body.add_velocity((0, 0, 1.0))
    times = np.array([0.123, 0.77])
    found = run(scene, 0.25).resampled(times)
    np.testing.assert_allclose(found.position(0)[:, 2], times, atol=1e-12)
    np.testing.assert_allclose(found.rotation(0)[:, 1, 0], np.sin(2 * times), atol=1e-12)
    with pytest.raises(ValueError, match=r"times must be within \[0, 0.2\], got 0.1 … 0.3"):
        result.resampled([0.1, 0.3])


def test_steps_are_saved(tmp_path):
    result = run(tumbling(), fl.schemes.AdaptiveStep(1e-3), 0.1)
    result.save(tmp_path / "run.h5")
    loaded = fl.Result.load(tmp_path / "run.h5")
    np.testing.assert_array_equal(loaded.steps.translation, result.steps.translation)
    np.testing.assert_array_equal(loaded.steps.rejected, result.steps.rejected)
    with pytest.raises(ValueError, match="sizes has the shape"):
        replace(result.steps, sizes=np.zeros(1))


def test_save_every_keeps_the_last_step():
    every = fl.GeneralisedAlpha().run(
        tumbling(), duration=0.3, step=fl.schemes.AdaptiveStep(1e-3), save_every=4, progress=True
    )
    assert every.times[-1] == 0.3
    assert len(every.times) == math.ceil(len(every.steps.times) / 4) + 1
    np.testing.assert_array_equal(
        every.times[1:-1], every.steps.times[3:-1:4][: len(every.times) - 2]
    )
