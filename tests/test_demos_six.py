"""The demo of six-parameter shells gives the numbers that it promises."""

import importlib.util
import sys
from pathlib import Path

import pytest

DEMOS = Path(__file__).parents[1] / "demos"


@pytest.fixture(scope="module")
def record():
    spec = importlib.util.spec_from_file_location("i_beam_shell", DEMOS / "i_beam_shell.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules["i_beam_shell"] = module
    spec.loader.exec_module(module)
    return module.main(along=20, pictures=False)


@pytest.mark.parametrize("name", ["deflection_strong", "deflection_weak", "twist"])
def test_i_beam_of_shells_is_a_beam(record, name):
    """The flanges overlap with the web: 1.3 % of the stiffness about the strong axis."""
    assert record[f"error_{name}"] == pytest.approx(0.0, abs=0.02)


def test_warping_is_held_and_whole_load_takes_few_iterations(record):
    assert record["twist"] < record["twist_beam"] * 1.02
    assert max(record["iterations_strong"], record["iterations_weak"]) <= 6
