"""Demos of mechanisms against their references, by their records of numbers."""

import importlib

import numpy as np
import pytest

from demos.reference.woodpecker import Toy, passages


def main(demo: str, **parameters):
    return importlib.import_module(f"demos.{demo}").main(pictures=False, **parameters)


def test_extrapolation_removes_the_powers_that_are_there():
    """Exactly those of the expansion, and the order is what the results show."""
    extrapolation = importlib.import_module("demos.extrapolation")
    steps = (0.1, 0.05, 0.025, 0.0125)
    limit = np.array([1.0, -2.0])
    results = [limit + h**2 * np.array([3.0, 5.0]) + 7.0 * h**3 - h**4 for h in steps]
    np.testing.assert_allclose(extrapolation.extrapolated(results), limit, atol=1e-14)
    left = extrapolation.extrapolated(results[:3]) - limit
    np.testing.assert_allclose(left, -(0.1**4) / 56, rtol=1e-6)
    assert extrapolation.order([h**2 for h in steps]) == pytest.approx(2.0)
    assert np.isnan(extrapolation.order(results[:2]))
    with pytest.raises(ValueError, match="wanted 1 to 4 results, got 5"):
        extrapolation.extrapolated([1.0] * 5)


def test_slider_crank():
    """Order two, and extrapolated to what ten digits of reference leave, at all of its rows."""
    record = main("slider_crank", step=1e-3, duration=0.5)
    assert 1.99 < record["order"] < 2.01
    coarse, _, fine = record["angle_errors"]
    assert 15.5 < coarse / fine < 16.5
    # the third power of h has gone, too: 2e-9 and 2e-8 are left of 9e-6 and 3e-4
    assert record["slider_extrapolated"] < 3e-9 and record["angle_extrapolated"] < 4e-8
    assert record["violation"] < 1e-11
    # 5.66 where multipliers count by the scale of their vector, not by what they move
    assert record["iterations_per_step"] < 4.9


def test_slider_crank_with_a_flexible_rod():
    """Converged in elements and steps: 1.975134 rad at 0.25 s."""
    soft = main("slider_crank", elements=8, step=2.5e-4, runs=2, duration=0.25)
    # elements leave 1.5e-5, unresolved waves as much
    assert soft["angles"]["0.25"] == pytest.approx(1.975134, abs=5e-5)
    assert soft["angles"]["0.25"] - 1.949259478 > 0.02
    assert 0.01 < soft["deflection"] < 0.02
    stiff = main("slider_crank", elements=4, step=5e-4, runs=1, duration=0.25, modulus=2e11)
    # the thin rod has 5 % less inertia across its axis
    assert stiff["angle_extrapolated"] < 5e-3


def test_four_bar_with_a_tilted_axis():
    """The accuracy of the reference: 5e-7 m, forces 2e-4 of their largest."""
    record = main("four_bar", duration=3.6)
    assert record["position_error"] < 7e-7
    assert record["force_error"] < 2e-4
    assert record["angle_error"] < 2e-5
    assert record["violation"] < 1e-9


@pytest.mark.parametrize("speed", [1.0, 0.16])
def test_governor(speed):
    """Extrapolated to the eight digits of the reference: the start of the dampers is resolved."""
    record = main("governor", speed=speed, duration=0.5)
    coarse, fine = record["s_errors"]
    assert 3.9 < coarse / fine < 4.1 and fine < 1e-6
    assert record["s_extrapolated"] < 5e-9 and record["theta_extrapolated"] < 5e-7
    assert record["momentum_error"] < 2e-6
    # forces of joints count by what they move, on each level of steps
    assert record["iterations_per_step"] < 5


def test_bricard():
    """Of second order down to the reference's digits; the redundant constraint is named."""
    record = main("bricard", step=2e-3, runs=2, duration=1.0)
    assert "1 of 30 constraints are redundant" in record["refusal"]
    coarse, fine = record["position_errors"]
    assert 3.9 < coarse / fine < 4.1 and fine < 1e-6
    # the reference has eight digits that early: its y at 0.5 s is 2.1e-9 from the limit of ours
    assert record["extrapolated"] < 1e-8
    assert record["violation"] < 1e-11
    # the force that the motion does not decide must not keep the iteration from its end
    assert record["matrices_per_step"] < 0.2
    assert record["iterations_per_step"] < 6


def test_double_four_bar_through_flat_postures():
    """On the regular branch in four ways, and of second order against ten digits."""
    record = main("double_four_bar", step=4e-3, runs=2, duration=1.0)
    coarse, fine = record["errors"]
    assert 3.8 < coarse / fine < 4.2
    assert record["extrapolated"] < 2e-6
    for way in ("hinges", "pins", "variable", "conserving"):
        assert record[way]["end"] == pytest.approx(1.0)
        assert record[way]["angle_between"] < 1e-7
    # round-off over the square of the angle from the flat posture
    assert record["conserving"]["energy_error"] < 1e-10


def test_rolling_disc():
    """Second order against an independent integration; the force of contact does no work."""
    coarse, fine = (main("rolling_disc", step=h, duration=1.0) for h in (2e-3, 1e-3))
    assert fine["position_error"] < 1e-5
    assert 3.8 < coarse["position_error"] / fine["position_error"] < 4.2
    assert fine["energy_error"] < 2e-6
    assert 3.8 < coarse["energy_error"] / fine["energy_error"] < 4.2
    assert fine["violation"] < 1e-8


@pytest.mark.slow
def test_squeezer():
    """Reference of the test set for initial value problem solvers, to a billionth."""
    record = main("squeezer")
    first, second, third, best = record["errors"]
    assert 3.95 < first / second < 4.05 and 3.95 < second / third < 4.05
    assert best < 1e-9


def test_slider_crank_friction():
    """Errors of second order, three times back and forth; the normal force is not the weight."""
    coarse, fine = (main("slider_crank_friction", step=step) for step in (5e-4, 2.5e-4))
    assert coarse["error"] < 3e-6 and 3.5 < coarse["error"] / fine["error"] < 6.0
    assert coarse["balance"] < 1e-6 and 3.0 < coarse["balance"] / fine["balance"] < 4.5
    np.testing.assert_allclose(fine["normal"], [18.9178, 27.0059], atol=2e-3)


@pytest.mark.slow
def test_bicycle():
    """Roots at 5 m/s, and the speeds at which weave and capsize neither grow nor decay."""
    found = main("bicycle")
    assert found["weave_error"] < 1e-4 and found["capsize_error"] < 1e-3
    assert abs(main("bicycle", speed=4.29238253634)["weave"]) < 5e-4
    assert abs(main("bicycle", speed=6.02426201539)["capsize"]) < 2e-3


@pytest.mark.slow
def test_stick_slip():
    """Period and slips in closed form, with errors of second order; nothing is lost by sticking."""
    coarse, fine = (main("stick_slip", step=step) for step in (2e-3, 1e-3))
    assert fine["periods"] == 5 and abs(fine["period"] - 0.669357) < 1e-6
    assert fine["period_error"] < 1e-5 and fine["slip_error"] < 1e-5
    assert 3.5 < coarse["period_error"] / fine["period_error"] < 4.5
    assert fine["lost"] < 1e-10


@pytest.mark.slow
def test_woodpecker():
    """Time and state after a period against Moreau's time-stepping and the published state."""
    found = main("woodpecker", step=2e-4, duration=0.15)
    (time, *state), (exact, *reference) = found["passages"][0], found["moreau"][0]
    assert abs(time / exact - 1.0) < 2e-4 and abs(exact - 0.14589) < 1e-5
    np.testing.assert_allclose(state, reference, rtol=2e-3)
    # both digits of the published velocity, and three of the rate of the bird
    np.testing.assert_allclose(state, found["published"], rtol=1e-2)
    assert found["cone_residual"] < 1e-9


def test_published_woodpecker_is_a_step_of_the_time_stepping_that_is_published():
    """With steps of 1e-4 s Moreau's scheme returns to it, in the digits that are printed.

    The tilt lies beyond the contact of the sleeve, where only time-stepping can be; with short
    steps the same state returns elsewhere.
    """
    toy, start = Toy(), Toy().start
    start[1] = -0.1036
    found = toy.steps(0.2924, 1e-4, start)[-1]
    np.testing.assert_allclose(found[[1, 2, 3]], [-0.1036, -0.2788, -0.3411], atol=5e-5)
    assert abs(found[5] / -7.4583 - 1.0) < 1e-4
    # the edge is in contact, 1.2e-4 rad beyond it
    assert found[1] < toy.start[1] - 1e-4
    _, speed, rate = passages(toy.moreau(0.15, 5e-6))[-1]
    assert abs(speed + 0.3411) > 2e-3 and abs(rate + 7.4583) > 5e-3


@pytest.mark.slow
def test_crane():
    """Linear theory of trolley, heavy cable and load; feed-forward alone arrives at rest."""
    found = main("crane", cells=12, step=1e-2)
    for name in ("undisturbed", "pulled", "feedback"):
        assert found[f"{name}_error"] <= 1e-3
    assert found["undisturbed_left"] <= 2e-4
    assert found["feedback_left"] <= 0.05 * found["pulled_left"]


def test_inverted_pendulum():
    """Angles at samples against linear theory, with an error of second order in the step."""
    coarse, fine = (main("inverted_pendulum", step=step, samples=50) for step in (4e-3, 2e-3))
    assert fine["error"] < 2e-5
    assert 3.5 < coarse["error"] / fine["error"] < 4.5
    assert abs(fine["angles"][-1]) < 0.1


def test_deployed_panels():
    """Panels latch in their order, at times and with losses of second order in the step."""
    coarse, fine = (main("deployed_panels", step=step) for step in (1e-2, 5e-3))
    assert coarse["panels"] == fine["panels"] == [1, 0]
    for errors in ("time_errors", "loss_errors"):
        ratios = np.array(coarse[errors]) / np.array(fine[errors])
        assert ((ratios > 3.5) & (ratios < 4.5)).all()
    for found in (coarse, fine):
        np.testing.assert_allclose(found["losses"], found["losses_by_hand"], atol=1e-10)
        np.testing.assert_allclose(found["rates"], found["rates_by_hand"], atol=1e-12)


@pytest.mark.slow
def test_panels_latch_in_time():
    """1e-5 s at a step of 2e-3 s; half of it is due to the iteration at the usual tolerance."""
    found = main("deployed_panels")
    assert max(found["time_errors"]) < 1e-5 and max(found["loss_errors"]) < 1e-4
