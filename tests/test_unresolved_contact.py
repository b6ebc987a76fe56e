"""Steps that are too large for contacts by penalty: passing through, energy that comes or goes."""

import numpy as np
import pytest

import fem_lie as fl

STEEL = fl.Material(1e9, 0.3, 1000.0)
CONSTANT = [fl.GeneralisedAlpha(radius=0.8), fl.schemes.Variational(), fl.Explicit()]
DIVIDING = [fl.EnergyMomentum(), fl.EnergyDecaying(radius=0.8)]


def name(scheme) -> str:
    return type(scheme).__name__


def balls(stiffness, unit=1.0, offset=0.0, law=fl.contact.Penalty, others=()) -> fl.Scene:
    """Two balls of 1 kg and 1 cm, of which the first comes at 100 m/s; lengths in another unit."""
    inertia = (1e-4 * unit**2,) * 3
    left = fl.RigidBody(1.0, inertia, position=(-0.275 * unit, offset * unit, 0), name="left")
    right = fl.RigidBody(1.0, inertia, name="right")
    left.add_velocity((100.0 * unit, 0, 0))
    scene = fl.Scene()
    for body in (left, right, *others):
        scene.add(body)
    given = (
        fl.contact.Sphere(left.point("centre"), 0.01 * unit),
        fl.contact.Sphere(right.point("centre"), 0.01 * unit),
    )
    scene.add(
        fl.contact.Contact(
            *given, law(stiffness) if law is fl.contact.Penalty else law(restitution=1.0)
        )
    )
    return scene


def bars(angle, speed, offset=0.0) -> fl.Scene:
    """A beam that falls on another one at an angle."""
    section, (c, s) = fl.Section.circle(0.01, STEEL), (np.cos(angle), np.sin(angle))
    lower = fl.Beam.straight((-0.5, 0, 0), (0.5, 0, 0), section, cells=4)
    ends = (-0.5 * c, offset - 0.5 * s, 0.13), (0.5 * c, offset + 0.5 * s, 0.13)
    upper = fl.Beam.straight(*ends, section, cells=4)
    upper.add_velocity((0, 0, -speed))
    scene = fl.Scene()
    scene.add(lower)
    scene.add(upper)
    scene.add(
        fl.contact.Contact(
            fl.contact.Line(upper, 0.01), fl.contact.Line(lower, 0.01), fl.contact.Penalty(1e6)
        )
    )
    return scene


def floor(speed, gap, stiffness=1e6, **law) -> tuple[fl.Scene, fl.RigidBody]:
    """A ball of 1 kg that comes down on a plane: in contact for π ms with 1e6 N/m."""
    ball = fl.RigidBody(1.0, (1e-2,) * 3, position=(0, 0, 0.1 + gap), name="ball")
    ball.add_velocity((0, 0, -speed))
    scene = fl.Scene()
    scene.add(ball)
    plane, given = fl.contact.Plane(fl.ground(), (0, 0, 1)), fl.contact.Penalty(stiffness, **law)
    scene.add(fl.contact.Contact(fl.contact.Sphere(ball.point("centre"), 0.1), plane, given))
    return scene, ball


def run(scheme, scene, duration, step):
    return scheme.run(scene, duration=duration, step=step, progress=False)


# --- what goes through ---


@pytest.mark.parametrize("scheme", CONSTANT, ids=name)
@pytest.mark.parametrize("unit", [1.0, 1e3])
def test_balls_that_jump_over_each_other_fail_the_step(scheme, unit):
    with pytest.raises(
        fl.ConvergenceError, match=r"step 3 .*Sphere on right\): one side passed through .* smaller"
    ):
        run(scheme, balls(1e8, unit), 5e-3, 1e-3)


@pytest.mark.parametrize("offset", [0.0, 0.012, 0.0188])
def test_a_graze_that_no_step_sees_fails_it(offset):
    """Centres pass at a distance below the sum of the radii, 0.02; the rim is let go."""
    scheme = fl.GeneralisedAlpha(radius=0.8)
    with pytest.raises(fl.ConvergenceError, match="passed through the other"):
        run(scheme, balls(1e8, offset=offset), 5e-3, 1e-3)


@pytest.mark.parametrize("scheme", [*CONSTANT, *DIVIDING], ids=name)
def test_balls_that_miss_each_other_fly_on(scheme):
    result = run(scheme, balls(1e8, offset=0.0202), 5e-3, 1e-3)
    np.testing.assert_allclose(result.velocities[-1, :2, 0], [100.0, 0.0], atol=1e-9)


@pytest.mark.parametrize("scheme", DIVIDING, ids=name)
def test_conserving_steps_are_divided_until_balls_meet(scheme):
    """They exchange their velocities, as equal balls do; decaying steps take some energy."""
    result, lost = run(scheme, balls(4e7), 4e-3, 1e-3), isinstance(scheme, fl.EnergyDecaying)
    assert 0 < result.divided < 4
    velocities = result.velocities[-1, :2, 0]
    np.testing.assert_allclose(velocities, [0.0, 100.0], atol=2.0 if lost else 1e-6)


def test_adaptive_steps_shrink_until_balls_meet():
    choice = fl.schemes.AdaptiveStep(1.0, rotation_tolerance=100.0, first=1e-3, largest=1e-3)
    with pytest.warns(fl.contact.UnresolvedContactWarning):  # errors of steps may be any
        result = run(fl.GeneralisedAlpha(radius=0.8), balls(4e7), 4e-3, choice)
    assert result.frames[-1, 0, 0, 0] < result.frames[-1, 1, 0, 0] - 0.02


@pytest.mark.parametrize("scheme", [*CONSTANT, *DIVIDING], ids=name)
def test_a_contact_that_is_too_soft_for_the_impact_says_so(scheme):
    """At 1e4 N/m the contact holds a thousandth of the energy; the step is no more to blame."""
    with pytest.raises(fl.ConvergenceError, match="use a higher stiffness"):
        run(scheme, balls(1e4), 4e-3, 1e-5)


def test_impacts_beside_joints_see_what_goes_through():
    far = fl.RigidBody(1.0, (1.0, 1.0, 1.0), position=(5, 0, 0))
    scene = balls(0.0, law=fl.contact.Impact, others=(far,))
    scene.add(fl.joints.Revolute(fl.ground(), far.point("centre"), axis=(0, 0, 1)))
    scheme = fl.GeneralisedAlpha(radius=0.8)
    with pytest.raises(
        fl.ConvergenceError, match=r"left and right: one side passed through .* smaller"
    ):
        run(scheme, scene, 5e-3, 1e-3)
    scene.bodies[0].velocities[0, 0] = 15.0
    result = run(scheme, scene, 3e-2, 1e-3)
    np.testing.assert_allclose(result.velocities[-1, :2, 0], [0.0, 15.0], rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("angle", [0.0, 0.1, 0.8, np.pi / 2])
def test_lines_that_go_through_each_other_fail_the_step(angle):
    with pytest.raises(fl.ConvergenceError, match=r"step 2 .* Line .* passed through the other"):
        run(fl.GeneralisedAlpha(radius=0.8), bars(angle, 100.0), 3e-3, 1e-3)


@pytest.mark.parametrize("angle", [0.0, np.pi / 2])
def test_lines_that_go_past_each_other_fly_on(angle):
    """Side by side, or past a round end."""
    scene = bars(angle, 100.0, offset=0.022 if angle == 0.0 else 0.5221)
    result = run(fl.GeneralisedAlpha(radius=0.8), scene, 3e-3, 1e-3)
    assert result.frames[-1, 5:, 0, 2] == pytest.approx(-0.17)


def test_lines_that_meet_are_let_go():
    """In steps that see it, one rests on the other or bounces off."""
    result = run(fl.GeneralisedAlpha(radius=0.8), bars(0.8, 5.0), 0.04, 1e-4)
    assert (result.frames[:, 7, 0, 2] > result.frames[:, 2, 0, 2] + 0.01).all()


# --- energy ---


@pytest.mark.parametrize("scheme", CONSTANT, ids=name)
@pytest.mark.parametrize("unit", [1.0, 1e-6])
def test_energy_that_a_contact_of_few_steps_changes_is_warned_of(scheme, unit):
    """By as much as the ball has more or less afterwards; the steps that are named resolve it."""
    step, speed = 1.04e-3, 100.0 * unit
    scene, ball = floor(speed, 2.02 * step * speed)
    with pytest.warns(
        fl.contact.UnresolvedContactWarning, match="steps of 0.001 do not resolve"
    ) as found:
        result = run(scheme, scene, 12 * step, step)
    (message,) = [str(each.message) for each in found]
    changed = (result.velocity(ball.point("centre"))[-1, 2] / speed) ** 2 - 1.0
    assert abs(changed) > 0.05
    assert np.sign(changed) == (1.0 if "bodies by +" in message else -1.0)
    assert "higher" not in message
    advised = float(message.split("Take steps of ")[1].split(" ")[0])
    assert advised == pytest.approx(0.1e-3 * np.pi, rel=0.3)
    softer = float(message.split("a stiffness of ")[1].split(" ")[0])
    fine, ball = floor(speed, 2.02 * step * speed)
    result = run(scheme, fine, round(12 * step / advised) * advised, advised)
    assert (result.velocity(ball.point("centre"))[-1, 2] / speed) ** 2 == pytest.approx(
        1.0, abs=0.02
    )
    soft, ball = floor(speed, 2.02 * step * speed, softer)
    result = run(scheme, soft, 24 * step, step)
    assert (result.velocity(ball.point("centre"))[-1, 2] / speed) ** 2 == pytest.approx(
        1.0, abs=0.02
    )


def test_conserving_steps_give_back_what_they_took():
    step = 1.04e-3
    scene, ball = floor(100.0, 202.0 * step)
    result = run(fl.EnergyMomentum(), scene, 12 * step, step)
    assert result.velocity(ball.point("centre"))[-1, 2] == pytest.approx(100.0, rel=1e-10)


def test_damping_takes_energy_without_a_warning():
    scene, ball = floor(1.0, 1e-3, damping=600.0)
    result = run(fl.GeneralisedAlpha(radius=0.8), scene, 1.2e-2, 3e-4)
    assert 0.0 < result.velocity(ball.point("centre"))[-1, 2] < 0.6


def test_the_energy_watch_restarts_from_a_checkpoint(tmp_path):
    """A run that restarts in the middle of a contact warns as the whole run does."""
    scheme, step = fl.GeneralisedAlpha(radius=0.8), 1.04e-3
    options = {"duration": 7 * step, "step": step, "checkpoint_every": 4, "progress": False}
    scene, _ = floor(100.0, 202.0 * step)
    with pytest.warns(fl.contact.UnresolvedContactWarning) as whole:
        scheme.run(scene, **options, file=tmp_path / "run.h5")
    scene, _ = floor(100.0, 202.0 * step)
    with pytest.warns(fl.contact.UnresolvedContactWarning) as found:
        scheme.resume(scene, tmp_path / "run.h5", progress=False)
    assert str(found[0].message) == str(whole[0].message)
