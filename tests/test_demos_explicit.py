"""Demos of nets, shortened: figures against their references."""

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


def test_space_net():
    """Momenta stay while corner masses pull it open."""
    module = importlib.import_module("demos.space_net")
    record = module.main(unknowns=1e3, steps=5, cells=20)
    assert (record["meshes"], record["unknowns"]) == (2, 3 * (9 + 12 * 19) + 24)
    assert record["energy_error"] <= 1e-3
    assert record["momentum_error"] <= 1e-12
    assert record["angular_momentum_error"] <= 1e-7
