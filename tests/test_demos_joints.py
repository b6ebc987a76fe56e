"""Demos of mechanisms against their references, by their records of numbers."""

import importlib

import pytest


def main(demo: str, **parameters):
    return importlib.import_module(f"demos.{demo}").main(pictures=False, **parameters)


def test_slider_crank():
    """Errors fall with the square of the step, to what ten digits of reference leave."""
    coarse = main("slider_crank", step=5e-4, duration=0.5)
    fine = main("slider_crank", step=2.5e-4, duration=0.5)
    assert fine["slider_error"] < 5e-7 and fine["angle_error"] < 4e-5
    assert 3.8 < coarse["angle_error"] / fine["angle_error"] < 4.2
    assert fine["violation"] < 1e-11


def test_slider_crank_with_a_flexible_rod():
    """Converged in elements; a stiff rod is the rigid one but for its inertia about its axis."""
    soft = [main("slider_crank", elements=n, step=5e-4, duration=0.25) for n in (4, 8)]
    assert abs(soft[0]["angle"] - soft[1]["angle"]) < 1e-4
    assert abs(soft[1]["angle"] - 1.949259478) > 0.02
    assert 0.01 < soft[1]["deflection"] < 0.02
    stiff = main("slider_crank", elements=4, step=5e-4, duration=0.25, modulus=2e11)
    # the thin rod has 5 % less inertia across its axis
    assert stiff["angle_error"] < 5e-3


def test_four_bar_with_a_tilted_axis():
    """The accuracy of the reference: 5e-7 m, forces 2e-4 of their largest."""
    record = main("four_bar", duration=3.6)
    assert record["position_error"] < 7e-7
    assert record["force_error"] < 2e-4
    assert record["angle_error"] < 2e-5
    assert record["violation"] < 1e-9


@pytest.mark.parametrize("speed", [1.0, 0.16])
def test_governor(speed):
    coarse = main("governor", speed=speed, step=1e-3, duration=0.5)
    fine = main("governor", speed=speed, step=5e-4, duration=0.5)
    assert fine["s_error"] < 5e-7 and fine["theta_error"] < 3e-5
    assert 3.5 < coarse["s_error"] / fine["s_error"] < 5.5
    assert fine["momentum_error"] < 2e-6


def test_bricard():
    """Of second order down to the reference's digits; the redundant constraint is named."""
    coarse, fine = (main("bricard", step=h, duration=1.0) for h in (2e-3, 1e-3))
    assert "1 of 30 constraints are redundant" in coarse["refusal"]
    assert fine["position_error"] < 1.2e-6
    assert 3.5 < coarse["position_error"] / fine["position_error"] < 4.5
    assert fine["violation"] < 1e-11


def test_rolling_disc():
    """Second order against an independent integration; the force of contact does no work."""
    coarse, fine = (main("rolling_disc", step=h, duration=1.0) for h in (2e-3, 1e-3))
    assert fine["position_error"] < 1e-5
    assert 3.8 < coarse["position_error"] / fine["position_error"] < 4.2
    assert fine["energy_error"] < 2e-6
    assert 3.8 < coarse["energy_error"] / fine["energy_error"] < 4.2
    assert fine["violation"] < 1e-8
