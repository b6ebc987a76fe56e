"""Loads and drives that jump: steps end there, and the order is kept."""

import numpy as np
import pytest

import fem_lie as fl
from tests.jumping import (
    AT_END,
    END,
    INSIDE,
    OMEGA,
    SCHEMES,
    M,
    after_acceleration,
    after_step_force,
    driven,
    oscillator,
)

each = pytest.mark.parametrize("scheme", SCHEMES)


def errors(scene, body, scheme, exact, at, step):
    """Of position and velocity after the jump, the largest."""
    result = SCHEMES[scheme].run(scene, duration=END, step=step)
    x, v = exact(result.times, at)
    assert np.abs(result.times - at).min() <= 1e-12, "a step ends at the jump"
    gaps = (
        result.position(body.point("centre"))[:, 0] - x,
        result.velocity(body.point("centre"))[:, 0] - v,
    )
    return np.array([np.abs(gap).max() for gap in gaps])


@each
@pytest.mark.parametrize("at", [AT_END, INSIDE])
@pytest.mark.parametrize("kind", [float, fl.schemes.ConstantStep])
def test_a_load_that_jumps_costs_no_order(scheme, at, kind):
    """At the end of a step and within one; the same with a table and with a function that says."""
    table = fl.loads.PiecewiseLinear((0, at, at), (0, 0, 1))
    scene, body = oscillator(table)
    found = [errors(scene, body, scheme, after_step_force, at, kind(h)) for h in (2e-2, 1e-2)]
    assert (found[0] / found[1] >= 3.6).all(), found
    assert (found[1] <= [1e-2 * 0.05, 1e-2 * 0.05 * OMEGA]).all(), found


@each
@pytest.mark.parametrize("at", [AT_END, INSIDE])
def test_an_acceleration_of_a_drive_that_jumps_costs_no_order(scheme, at):
    function = fl.loads.PiecewiseSmooth(lambda t: 0.75 * max(t - at, 0.0) ** 2, (at,))
    scene, body = driven(function)
    found = [errors(scene, body, scheme, after_acceleration, at, h) for h in (2e-2, 1e-2)]
    assert (found[0] / found[1] >= 3.6).all(), found
    assert (found[1] <= 5e-3).all(), found
    # the mass hardly feels what the cart does: its velocity is wrong by 3e-4 … 4e-3 if untold
    result = SCHEMES[scheme].run(scene, duration=END, step=1e-2)
    wanted = 1.5 * np.maximum(result.times - at, 0.0)
    assert np.abs(result.velocity("cart.centre")[:, 0] - wanted).max() <= 6e-5


@each
def test_a_velocity_of_a_drive_that_jumps(scheme):
    """A kink in a table: the spring feels a base that starts with the velocity 0.5 at once."""
    scene, body = driven(fl.loads.PiecewiseLinear((0, INSIDE, END), (0, 0, 0.5 * (END - INSIDE))))

    def exact(t, at):
        s = np.maximum(t - at, 0.0)
        moves = t >= at
        return (
            0.5 * (s - np.sin(OMEGA * s) / OMEGA),
            0.5 * moves * (1 - np.cos(OMEGA * s)),
        )

    found = [errors(scene, body, scheme, exact, INSIDE, h) for h in (2e-2, 1e-2)]
    assert (found[0] / found[1] >= 3.6).all(), found


@each
def test_what_jumps_is_in_the_balance(scheme):
    scene, body = oscillator(fl.loads.PiecewiseLinear((0, AT_END, AT_END), (0, 0, 1)))
    result = SCHEMES[scheme].run(scene, duration=END, step=5e-3)
    work = 4.0 * result.position(body.point("centre"))[-1, 0]
    np.testing.assert_allclose(result.balance[-1, 0], work, rtol=2e-3)
    assert result.balance_error <= (5e-3 if scheme == "generalised alpha" else 1e-11)
    assert result.momentum_error <= (5e-3 if scheme == "generalised alpha" else 1e-11)


def test_adaptive_steps_end_at_jumps_that_are_said():
    step = fl.schemes.AdaptiveStep(1e-4)
    scene, _ = oscillator(fl.loads.PiecewiseLinear((0, INSIDE, INSIDE), (0, 0, 1)))
    listed = SCHEMES["generalised alpha"].run(scene, duration=END, step=step)
    assert np.sum(np.abs(listed.times - INSIDE) < 1e-12) == 2, "both sides"
    blind, _ = oscillator(lambda t: float(t >= INSIDE))
    found = SCHEMES["generalised alpha"].run(blind, duration=END, step=step)
    assert len(listed.steps.rejected) < len(found.steps.rejected)


def test_free_bodies_feel_jumps_too():
    """m ẍ = F from the jump on: exact for a constant acceleration, if the step ends there."""
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(M, (0.1, 0.2, 0.3)).set_group(fl.lie.Group.R3xSO3))
    scene.add(
        fl.PointLoad(
            body.point("centre"),
            force=(4.0, 0, 0),
            history=fl.loads.PiecewiseSmooth(lambda t: t >= 0.31, (0.31,)),
        )
    )
    result = SCHEMES["generalised alpha"].run(scene, duration=END, step=0.05)
    s = np.maximum(result.times - 0.31, 0.0)
    np.testing.assert_allclose(result.position(body.point("centre"))[:, 0], s**2, atol=1e-9)


def test_tables_are_straight_between_times_and_take_the_side_after_a_jump():
    table = fl.loads.PiecewiseLinear((0.0, 1.0, 1.0, 3.0), (2.0, 4.0, -1.0, 1.0))
    times = (-1.0, 0.0, 0.5, 1.0 - 1e-12, 1.0, 2.0, 3.0, 9.0)
    np.testing.assert_allclose([table(t) for t in times], [2, 2, 3, 4, -1, 0, 1, 1], atol=1e-10)
    assert table.jumps == (1.0,) and table.kinks == (0.0, 1.0, 3.0)
    assert fl.loads.PiecewiseLinear([0, 1], [0, 1]) == fl.loads.PiecewiseLinear(
        (0.0, 1.0), (0.0, 1.0)
    )
    assert fl.loads.PiecewiseLinear((0.5,), (7.0,))(0.0) == 7.0


def two(body):
    """A drive whose table jumps."""
    slide = fl.joints.Prismatic(fl.ground(), body.point("centre"), axis=(1, 0, 0))
    return slide, fl.joints.Drive(
        slide.displacement, fl.loads.PiecewiseLinear((0, 0.5, 0.5), (0, 0, 1))
    )


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: fl.loads.PiecewiseLinear((0, 1), (1,)), "as many times as values, got 2 and 1"),
        (lambda: fl.loads.PiecewiseLinear((), ()), "as many times as values"),
        (lambda: fl.loads.PiecewiseLinear((0, 2, 1), (0, 0, 0)), "must not fall, got"),
        (lambda: fl.loads.PiecewiseLinear((0, 1, 1, 1), (0, 0, 0, 0)), "twice at most"),
        (lambda: fl.loads.PiecewiseLinear((0, np.nan), (0, 0)), "times must be finite"),
        (lambda: fl.loads.PiecewiseLinear((0, 1), (0, np.inf)), "must be finite, got"),
        (lambda: fl.loads.PiecewiseSmooth(abs, (np.nan,)), "jumps must be finite times"),
        (
            lambda: fl.schemes.ConstantStep(0.1, events=(2.0,)).check(1.0),
            r"events must be in \(0, 1\)",
        ),
    ],
)
def test_bad_histories_are_named(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_drives_must_not_jump():
    scene = fl.Scene()
    for item in two(scene.add(fl.RigidBody(1.0, (1, 1, 1)))):
        if isinstance(item, fl.joints.Drive):
            with pytest.raises(ValueError, match=r"jumps at the times \[0.5\]"):
                scene.add(item)
        else:
            scene.add(item)


@each
def test_runs_go_to_a_file_through_a_jump(scheme, tmp_path):
    scene, _ = oscillator(fl.loads.PiecewiseLinear((0, AT_END, AT_END), (0, 0, 1)))
    plan = {"duration": END, "step": 1e-2}
    whole = SCHEMES[scheme].run(scene, **plan)
    kept = SCHEMES[scheme].run(scene, **plan, file=tmp_path / "run.h5")
    np.testing.assert_array_equal(kept.times, whole.times)
    assert (np.diff(kept.times) == 0.0).sum() == 1
    assert np.abs(kept.frames - whole.frames).max() < 1e-8


# --- functions that are defined during the run only, such as those of measured data ---


def within(function, last: float):
    """The function, which fails before the start of a run and after its end."""

    def checked(t: float):
        assert 0.0 <= t <= last * (1.0 + 1e-15), f"evaluated at {t!r}"
        return function(t)

    return checked


def moved_by_data(last: float) -> fl.Scene:
    """A driven rod on a spring, hung on a body whose motion is prescribed."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    carriage = scene.add(fl.RigidBody(1.0, (0.1, 0.1, 0.1), (0, 0, 0)))
    rod = scene.add(fl.RigidBody(2.0, (0.01, 0.2, 0.2), (0.5, 0, 0)))
    load = scene.add(fl.RigidBody(1.0, (0.1, 0.1, 0.1), (1, 0, 0)))
    centre, middle, end = (body.point("centre") for body in (carriage, rod, load))
    hinge = scene.add(fl.joints.Revolute(centre, middle, at=(0, 0, 0), axis=(0, 1, 0)))
    free = scene.add(fl.joints.Revolute(middle, end, axis=(0, 1, 0), at=(1, 0, 0)))
    scene.add(fl.joints.Spring(free.angle, 5.0))
    scene.add(fl.joints.Drive(hinge.angle, within(lambda t: 2.0 * t**2, last)))

    def motion(t: float) -> np.ndarray:
        return np.vstack([(0.1 * t**2, 0, 0), np.eye(3)])

    scene.add(fl.PrescribedMotion(centre, within(motion, last)))
    return scene


@pytest.mark.parametrize(
    ("scheme", "step"),
    [
        (fl.GeneralisedAlpha(), 1e-2),
        (fl.GeneralisedAlpha(index=fl.schemes.ConstraintIndex.STABILISED_TWO), 1e-2),
        (fl.GeneralisedAlpha(), fl.schemes.AdaptiveStep(1e-2)),
        (fl.EnergyMomentum(), fl.schemes.AdaptiveStep(1e-2)),
        (fl.schemes.Variational(), 1e-2),
        (fl.schemes.Composed(), 1e-2),
    ],
    ids=["alpha", "stabilised", "alpha adaptive", "energy adaptive", "variational", "composed"],
)
def test_motions_are_evaluated_during_the_run_only(scheme, step):
    result = scheme.run(moved_by_data(0.2), duration=0.2, step=step)
    assert result.joint_coordinates[-1, 0] == pytest.approx(0.08, abs=1e-9)
