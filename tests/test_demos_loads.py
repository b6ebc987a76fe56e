"""Demos of loads in motion against their references, by their records of numbers."""

import importlib


def test_flapping_plate():
    """Work is energy, errors are of second order in the step, small strokes are those of a beam."""
    record = importlib.import_module("demos.flapping_plate").main(
        mesh=8, step=0.01, periods=1.0, pictures=False
    )
    assert record["energy_error"] <= 1e-3
    assert record["energy_error"] <= record["energy_error_coarse"] / 2.5
    assert record["time_difference"] <= 0.02
    assert record["beam_error"] <= 0.02
    assert record["beam_flexibility"] >= 0.05  # it is not the rigid sheet that is compared
    assert 25.0 <= record["root_amplitude"] <= 40.0
    assert record["greatest_elastic_energy"] >= 0.3 * record["greatest_energy"]
