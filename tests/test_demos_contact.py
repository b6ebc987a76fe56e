"""Demos of contact against their references, by their records of numbers."""

import importlib

import pytest

DEMO = importlib.import_module("demos.rod_in_box")


@pytest.mark.parametrize(
    ("ends", "friction"), [("square", 0.0), ("square", 0.2), ("square", 0.6), ("spheres", 0.2)]
)
def test_rod_in_box(ends, friction):
    """Where the references are, without a step cut, energy gained or overlap."""
    record = DEMO.main(friction, ends, pictures=False)
    assert record["rod_end_z"] == pytest.approx(DEMO.REFERENCES[ends][friction], abs=2e-4)
    assert record["momentum_error"] < 1e-13
    assert record["energy_gain"] < 1e-7
    assert record["penetration"] < 1e-12
    assert record["cone_residual"] < 1e-6
    assert record["steps_cut"] == 0


def test_rod_in_box_has_no_other_ends():
    with pytest.raises(ValueError, match="--ends must be square or spheres, got 'round'"):
        DEMO.main(ends="round", pictures=False)
