"""The demo of explicit steps, shortened: figures against their references."""

import importlib


def test_wave_in_a_net():
    """Stable at nine tenths of the largest step, with exact momenta."""
    module = importlib.import_module("demos.wave_in_a_net")
    record = module.main(cells=10, steps=2000, pictures=False)
    assert record["energy_error"] <= 1e-3
    assert record["energy_drift"] <= 1e-4
    assert record["momentum_error"] <= 1e-12
    assert record["angular_momentum_error"] <= 1e-12
    assert record["highest"] > 1e-3
