"""Symmetric steps of the variational scheme: no drift, momenta, order, events, files, bad input."""

import numpy as np
import pytest

import fem_lie as fl
from studies.symmetric_steps import LateStep, bar, drift, errors, orbit
from tests.interruption import interrupted
from tests.jumping import END, INSIDE, after_acceleration, after_step_force, oscillator
from tests.jumping import driven as driven_cart
from tests.test_composed import driven, flying, rigid_pendulum
from tests.test_conserving_any import flying as flung
from tests.test_energy_momentum import bars, plate, same

SCHEME = fl.schemes.Variational()
Symmetric = fl.schemes.SymmetricStep


def test_the_energy_does_not_drift():
    """Of eight eccentric orbits; with the same speeds taken from the last step it does."""
    sizes = 0.04, 0.4
    symmetric = drift(orbit(), 16.0 * np.pi, Symmetric(*sizes))
    late = drift(orbit(), 16.0 * np.pi, LateStep(*sizes))
    constant = drift(orbit(), 16.0 * np.pi, 16.0 * np.pi / symmetric.steps)
    assert 7.0 <= symmetric.ratio <= 9.0
    assert abs(symmetric.drift) <= 1e-5
    assert abs(late.drift) >= 1e-3
    assert symmetric.swing <= 0.1 * constant.swing
    assert symmetric.angular <= 1e-13


def test_second_order_and_fewer_steps():
    """The centre of the body on Kepler's ellipse, from the solution of his equation."""
    (steps, coarse, _), (more, fine, constant) = errors(0.04), errors(0.02)
    assert np.log(coarse / fine) / np.log(more / steps) == pytest.approx(2.0, abs=0.05)
    assert fine <= constant / 10.0


def test_a_flexible_bar():
    found = drift(bar(), 4.0, Symmetric(0.008, 0.01))
    assert found.ratio >= 2.5
    assert abs(found.drift) <= 0.1 * found.swing <= 1e-4


def test_the_size_follows_the_speed():
    """A distance in each step, when it is fast: v² = 2 T/m, whatever the mass."""
    scene = rigid_pendulum()
    result = SCHEME.run(scene, duration=1.0, step=Symmetric(5e-3, 1e-2))
    speed = np.sqrt(2.0 * result.kinetic / 1.7)
    middle = np.interp(result.steps.times - 0.5 * result.steps.sizes, result.times, speed)
    wanted = 1.0 / np.sqrt(1.0 / 1e-2**2 + (middle / 5e-3) ** 2)
    # the last four steps are fitted to the end
    np.testing.assert_allclose(result.steps.sizes[:-4], wanted[:-4], rtol=0.03)
    assert result.steps.sizes.max() >= 4.0 * result.steps.sizes.min()


@pytest.mark.parametrize(
    ("scene", "step"),
    [
        (lambda: bars()[0], (2e-3, 1e-3)),
        (lambda: plate("MITC4")[0], (2e-3, 1e-3)),
        (lambda: flung("net")[0], (2e-3, 1e-3)),
        (lambda: flung("hexahedra")[0], (2e-3, 1e-3)),
    ],
    ids=["beams", "shell", "net", "solid"],
)
def test_momenta_of_any_body(scene, step):
    result = SCHEME.run(scene(), duration=0.02, step=Symmetric(*step))
    assert np.ptp(result.steps.sizes[:-4]) > 0.0
    assert result.angular_momentum_error <= 1e-12
    assert result.energy_error <= 1e-2


# --- events, times, files ---


def test_jumps_cost_no_order():
    """Steps end at jumps of loads and at kinks of drives, which plain constant steps refuse."""
    cases = (
        (oscillator, fl.loads.PiecewiseLinear((0, INSIDE, INSIDE), (0, 0, 1)), after_step_force),
        (
            driven_cart,
            fl.loads.PiecewiseSmooth(lambda t: 0.75 * max(t - INSIDE, 0.0) ** 2, (INSIDE,)),
            after_acceleration,
        ),
    )
    for case, history, exact in cases:
        gaps = []
        for h in (2e-2, 1e-2):
            scene, body = case(history)
            result = SCHEME.run(scene, duration=END, step=Symmetric(10.0 * h, h))
            assert np.sum(np.abs(result.times - INSIDE) <= 1e-12) == 2, "both sides"
            x, v = exact(result.times, INSIDE)
            point = body.point("centre")
            found = result.position(point)[:, 0] - x, result.velocity(point)[:, 0] - v
            gaps.append([np.abs(gap).max() for gap in found])
        assert (np.divide(*gaps) >= 3.6).all(), gaps


def test_requested_times_change_no_step():
    step, times = Symmetric(5e-3, 5e-3), np.linspace(0.0, 0.3, 7)
    whole = SCHEME.run(rigid_pendulum(), duration=0.3, step=step)
    some = SCHEME.run(rigid_pendulum(), duration=0.3, step=step, save_at=times)
    np.testing.assert_array_equal(whole.steps.times, some.steps.times)
    np.testing.assert_allclose(some.times, times, atol=1e-12)
    np.testing.assert_allclose(some.frames[-1], whole.frames[-1], atol=1e-12)


def test_measured_errors_are_of_third_order():
    found = []
    for distance in (8e-3, 4e-3):
        step = Symmetric(distance, distance, refinement=4)
        result = SCHEME.run(rigid_pendulum(), duration=0.1, step=step)
        steps = result.steps
        found.append(np.median(steps.measured_translation / steps.sizes**3))
        assert np.isnan(steps.translation).all(), "not estimated"
    assert found[0] / found[1] == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize("scene", [flying, driven], ids=["free", "driven"])
def test_resumed_to_the_last_bit(tmp_path, scene):
    plan = {"duration": 0.03, "step": Symmetric(5e-3, 1e-3), "save_every": 3}
    file, kept = tmp_path / "run.h5", {"checkpoint_every": 7}
    whole = SCHEME.run(scene(), **plan, file=tmp_path / "whole.h5", **kept)
    with interrupted(2):
        SCHEME.run(scene(), **plan, file=file, **kept)
    resumed = SCHEME.resume(scene(), file)
    same(resumed, whole)
    np.testing.assert_array_equal(resumed.steps.sizes, whole.steps.sizes)


# --- bad input ---


def test_other_schemes_refuse_them():
    for scheme in (fl.GeneralisedAlpha(), fl.EnergyMomentum()):
        with pytest.raises(ValueError, match="expected AdaptiveStep, got SymmetricStep"):
            scheme.run(flying(), duration=0.1, step=Symmetric(1e-3, 1e-3))


def test_impacts_are_refused():
    scene = fl.Scene()
    one, two = (scene.add(fl.RigidBody(1.0, (1, 1, 1), (x, 0, 0))) for x in (0.0, 3.0))
    balls = [fl.contact.Sphere(body.point("centre"), 0.5) for body in (one, two)]
    scene.add(fl.contact.Contact(*balls, fl.contact.Impact()))
    with pytest.raises(ValueError, match="Impact is for Variational with constant steps"):
        SCHEME.run(scene, duration=0.1, step=Symmetric(1e-3, 1e-3))


def test_options():
    with pytest.raises(ValueError, match=r"smallest ≤ largest step, got 0\.1, 0\.01"):
        SCHEME.run(flying(), duration=0.1, step=Symmetric(1e-3, 1e-2, smallest=0.1))
    with pytest.raises(ValueError, match="distance"):
        SCHEME.run(flying(), duration=0.1, step=Symmetric(0.0, 1e-2))
