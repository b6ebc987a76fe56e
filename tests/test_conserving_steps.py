"""Conserving schemes: local errors, and steps that follow a tolerance without a loss."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest

import fem_lie as fl
from studies.time_error import TIP, rigid_pendulum, tip
from tests.test_conserving_any import flying
from tests.test_energy_momentum import bars
from tests.test_reduced_conserving import free
from tests.test_time_error import Alternating, arm_that_stops, jump, pushed

PARTS = 10
# of second order, an error measured by a step in PARTS parts lacks that of the parts
MISSING = 1.0 - 1.0 / PARTS**2
SCHEMES = {"conserving": fl.EnergyMomentum(), "decaying": fl.EnergyDecaying(radius=0.8)}
each_scheme = pytest.mark.parametrize("scheme", SCHEMES.values(), ids=SCHEMES.keys())


def turning_pendulum() -> fl.Scene:
    """The rigid double pendulum, turning about all axes."""
    scene = rigid_pendulum()
    for body in scene.bodies:
        body.add_velocity(omega=(5.0, 1.0, 4.0), about=(0, 0, 0))
    return scene


def hinged() -> fl.Scene:
    """A body that turns fast about a skew hinge, and a second one on its rim."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    wheel = scene.add(fl.RigidBody(1.0, (0.1, 0.2, 0.1), (0, 0, 0)))
    bob = scene.add(fl.RigidBody(0.5, (0.01, 0.02, 0.01), (0.5, 0, 0)))
    scene.add(fl.joints.Revolute(fl.ground(), wheel.point("centre"), axis=(0, 1, 0.1)))
    scene.add(
        fl.joints.Revolute(
            wheel.point("centre"), bob.point("centre"), at=(0.4, 0, 0), axis=(0, 1, 0.1)
        )
    )
    for body in (wheel, bob):
        body.add_velocity(omega=20.0 * np.array([0, 1, 0.1]) / np.hypot(1, 0.1), about=(0, 0, 0))
    return scene


def tumbling() -> fl.Scene:
    """A free body under smooth loads."""
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(2.0, (1.0, 2.0, 2.5), (0.3, 0, 0), name="body"))
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


class Wandering(fl.extend.Control):
    """Up and down by as much as two levels, in no order."""

    def accept(self, e: float) -> None:
        self._rng = getattr(self, "_rng", np.random.default_rng(1))
        self.level = int(self._rng.integers(-2, 3))


@dataclass(frozen=True)
class AnySize(fl.extend.StepChoice):
    size: float
    refinement: int = 1

    def check(self, duration: float) -> None:
        pass

    def control(self, duration: float, length: float, order: int, jumps=()) -> fl.extend.Control:
        return Wandering(self.size, math.inf, math.inf, (duration,), 1.0, 0.0, order)


# --- conservation ---


@pytest.mark.parametrize(
    "choice", [fl.schemes.AdaptiveStep(1e-2), AnySize(5e-4)], ids=["chosen", "any"]
)
def test_energy_and_momenta_stay_when_steps_change(choice):
    scene, _, _ = bars()
    result = fl.EnergyMomentum().run(scene, duration=0.5, step=choice)
    assert len(np.unique(result.steps.sizes.round(12))) >= 3
    # some 1e-15 in each of the many steps that a tolerance asks for
    assert result.energy_error < 2e-12
    assert result.angular_momentum_error < 1e-12
    assert np.abs(result.balance).max() < 1e-12 * result.kinetic[0]


def test_energy_falls_and_momenta_stay_when_steps_change():
    scene, _, _ = bars()
    result = fl.EnergyDecaying(radius=0.5).run(scene, duration=0.5, step=AnySize(1e-3))
    energy = result.kinetic + result.elastic
    assert np.diff(energy).max() < 1e-12 * energy[0]
    assert energy[-1] < energy[0] * (1.0 - 1e-6)
    assert result.angular_momentum_error < 1e-12
    assert result.balance_error < 1e-11


# --- the estimate ---


@each_scheme
@pytest.mark.parametrize("make", [tumbling, turning_pendulum])
def test_estimate_over_error_tends_to_one(make, scheme):
    away = []
    for h in (4e-3, 2e-3):
        steps = scheme.run(
            make(), duration=0.2, step=fl.schemes.ConstantStep(h, refinement=PARTS)
        ).steps
        # the first steps have what is left of the start
        away.append(np.median(np.abs(MISSING * steps.ratios[5:] - 1.0), axis=0))
    assert (away[1] < 0.04).all()


def test_estimate_is_of_third_order():
    sizes = [
        fl.EnergyMomentum().run(tumbling(), duration=0.2, step=fl.schemes.ConstantStep(h)).steps
        for h in (2e-3, 1e-3)
    ]
    ratio = sizes[0].translation[-1] / sizes[1].translation[-1]
    assert 2.9 < np.log2(ratio) < 3.1


DISSIPATING = {
    "frames": lambda: bars(cells=1)[0],
    "vector coordinates": lambda: flying("discrete cable")[0],
    "modal coordinates": lambda: free(1)[0],
}


@pytest.mark.parametrize("name", DISSIPATING)
def test_dissipation_is_of_second_order_when_steps_change(name):
    """Of less if the filter state of forces, of velocities or of stresses keeps its size."""
    losses = []
    for h in (5e-4, 1.25e-4):
        scheme = fl.EnergyDecaying(radius=0.2)
        result = scheme.run(DISSIPATING[name](), duration=0.02, step=Alternating(h))
        assert len(np.unique(result.steps.sizes.round(9))) >= 2
        losses.append(result.balance[-1, 2])
    assert losses[1] > 0.0
    assert np.log2(losses[0] / losses[1]) / 2 > 1.9


def test_flight_has_no_error():
    """A parabola, and a turn about a fixed axis errs in its angle alone."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    body = scene.add(fl.RigidBody(1.0, (1.0, 1.0, 1.0), name="body"))
    body.add_velocity((1, 0, 5))
    steps = fl.EnergyMomentum().run(scene, duration=0.2, step=fl.schemes.ConstantStep(0.01)).steps
    assert steps.translation.max() < 1e-13
    assert steps.rotation.max() < 1e-13


@each_scheme
def test_estimating_changes_nothing(scheme):
    """Two runs differ by round-off: matrices are made at other times."""
    plain = scheme.run(turning_pendulum(), duration=0.1, step=2e-3)
    watched = scheme.run(turning_pendulum(), duration=0.1, step=fl.schemes.ConstantStep(2e-3))
    np.testing.assert_allclose(watched.frames, plain.frames, atol=1e-10)
    np.testing.assert_allclose(watched.times, plain.times, rtol=1e-12)
    assert np.isfinite(watched.steps.translation).all()


# --- the tolerance ---


def test_global_error_follows_the_tolerance():
    tolerances, errors = 10.0 ** np.arange(-2, -5.5, -1), []
    for tolerance in tolerances:
        choice = fl.schemes.AdaptiveStep(tolerance)
        result = fl.EnergyMomentum().run(rigid_pendulum(), duration=1.0, step=choice)
        errors.append(np.linalg.norm(tip(result)[-1] - TIP))
        assert (result.steps.translation <= tolerance * result.steps.sizes).all()
        assert result.energy_error < 1e-11
    assert 0.8 < np.polyfit(np.log(tolerances), np.log(errors), 1)[0] < 1.2


# --- events ---


@each_scheme
def test_jump_at_a_named_event(scheme):
    """Steps end there, and both sides are exact: rest, and a parabola."""
    result = scheme.run(
        pushed(jump), duration=1.0, step=fl.schemes.AdaptiveStep(1e-6, events=(0.3,))
    )
    assert (result.times == 0.3).sum() == 2
    assert len(result.steps.rejected) == 0
    exact = 1.5 * np.clip(result.times - 0.3, 0.0, None) ** 2
    atol = 1e-8
    np.testing.assert_allclose(result.position("ball.centre")[:, 0], exact, atol=atol)
    assert result.balance_error < 1e-12
    # dense output over the event
    times = np.linspace(0, 1, 51)
    between = result.resampled(times).position("ball.centre")[:, 0]
    np.testing.assert_allclose(between, 1.5 * np.clip(times - 0.3, 0.0, None) ** 2, atol=10 * atol)


def test_jump_found_by_rejection():
    """The step that holds it sees it, and is taken back: its state is as it was.

    It may err by h²/12 of the jump in position, which is held against the tolerance, and by h/2 of
    it in velocity: by six tolerances.
    """
    scene, when = pushed(lambda t: 1.0 if t >= 0.2957 else 0.0), 0.2957
    result = fl.EnergyMomentum().run(scene, duration=1.0, step=fl.schemes.AdaptiveStep(1e-4))
    assert len(result.steps.rejected) >= 3
    near = np.searchsorted(result.steps.times, when)
    assert result.steps.sizes[near] < 1e-2 * result.steps.sizes.max()
    exact = 1.5 * np.clip(result.times - when, 0.0, None) ** 2
    np.testing.assert_allclose(result.position("ball.centre")[:, 0], exact, atol=6e-4)
    assert result.balance_error < 1e-12


def test_kink_of_a_drive():
    """The velocity of what is driven jumps with it, and that work is counted."""
    choice = fl.schemes.AdaptiveStep(1e-4, events=(0.4,), largest=0.05)
    result = fl.EnergyMomentum().run(arm_that_stops(), duration=1.0, step=choice)
    event = int(np.flatnonzero(result.times == 0.4)[1])
    spin = result.velocity("arm.centre")[:, 5]
    # with the velocity of Cayley's map, which is (ωh)²/12 larger
    away = 2.0 * (2.0 * 0.05) ** 2 / 12
    np.testing.assert_allclose(spin[:event], 2.0, atol=1.1 * away)
    np.testing.assert_allclose(spin[event:], 0.0, atol=1.1 * away)
    # the energy of the arm, ½ 0.1 2² J, goes into the drive
    np.testing.assert_allclose(result.balance[-1, 0], -0.2, atol=1e-3)
    assert result.balance_error < 1e-12


# --- what goes wrong ---


def test_rejected_steps_leave_the_state_as_it_was():
    """A first step that is far too large, and taken back: the same run as without it."""
    small, large = (
        fl.EnergyMomentum().run(
            turning_pendulum(), duration=0.1, step=fl.schemes.AdaptiveStep(1e-4, first=first)
        )
        for first in (1e-2 * 2.0**-3.5, 1e-2)
    )
    assert len(large.steps.rejected) >= 1
    assert large.energy_error < 1e-12
    gap = large.position("bar II.centre")[-1] - small.position("bar II.centre")[-1]
    assert np.abs(gap).max() < 2e-4


def test_tolerance_out_of_reach_names_time_error_and_body():
    scene = pushed(lambda t: (0.5 - t) ** -2 if t < 0.5 else 1e6)
    expected = r"at time 0\.4\d+ a step of .* error of .* length per time, "
    expected += r"expected at most 1\.000e-03"
    with pytest.raises(fl.ConvergenceError, match=expected + ".*; ball limits it") as caught:
        fl.EnergyMomentum().run(
            scene, duration=1.0, step=fl.schemes.AdaptiveStep(1e-3, smallest=1e-6)
        )
    assert 0.4 < caught.value.result.times[-1] < 0.5
    assert len(caught.value.result.steps.times) == len(caught.value.result.times) - 1


def test_what_there_is_not_is_refused_before_a_file_is_made(tmp_path):
    scene, _, _ = bars()
    scheme, file = fl.EnergyMomentum(), tmp_path / "run.h5"
    with pytest.raises(ValueError, match="tolerance must be a positive finite number, got 0"):
        scheme.run(scene, duration=1.0, step=fl.schemes.AdaptiveStep(0.0))
    with pytest.raises(ValueError, match="supports along axes fixed in space"):
        mesh = fl.mesh.parametric_surface(lambda a, b: np.array([a, b, 0.0]), (1, 1))
        sheet = fl.Shell(mesh, fl.ShellSection.layer(0.05, fl.Material(1e6, 0.3, 1e3)))
        sheet.roller("a=0", (1, 0, 0))
        guided = fl.Scene()
        guided.add(sheet)
        scheme.run(guided, duration=1.0, step=0.1, file=file)
    assert not file.exists()
