"""The demo of six-parameter shells gives the numbers that it promises."""

import importlib

import pytest


@pytest.fixture(scope="module")
def record():
    return importlib.import_module("demos.i_beam_shell").main(along=20, pictures=False)


@pytest.mark.parametrize("name", ["deflection_strong", "deflection_weak", "twist", "buckling_load"])
def test_i_beam_of_shells_is_a_beam(record, name):
    """The flanges overlap with the web: 1.3 % of the stiffness about the strong axis."""
    assert record[f"error_{name}"] == pytest.approx(0.0, abs=0.02)


def test_whole_load_takes_few_iterations(record):
    assert max(record["iterations_strong"], record["iterations_weak"]) <= 6
