"""The examples in demos/forms beside their closed forms or literature, on one to three ranks."""

import json

from mpi4py import MPI

import numpy as np
import parallel_form_demos
import pytest
from parallel_form_demos import DEMOS
from ranks import on_ranks

BOUNDS = {
    "edge_energy": {"tip_error": 1e-8},
    "two_measures": {"tip_error": 1e-7},
    "selective_integration": {"error": 1.1e-3},  # h²/4 of the bending energy of linear elements
    "dead_force": {"tip_error": 2e-5},  # five digits are tabulated
    "follower_force": {"tip_error": 2e-5},
    "hellinger_reissner_beam": {"tip_error": 2e-3, "difference_to_displacement": 1e-10},
    "hellinger_reissner_shell": {"tip_error": 1e-3},  # four digits are tabulated
    "hu_washizu_beam": {"tip_error": 3e-3},
    "hu_washizu_shell": {"tip_error": 5e-5},
    "newton_and_snes": {"tip_error": 6e-3, "difference": 1e-8},
    "temperature": {"tip_error": 3e-4},
    "transient_element": {"difference": 1e-12},
}


@pytest.fixture(scope="module")
def records() -> dict:
    return parallel_form_demos.results(MPI.COMM_SELF)


@pytest.mark.parametrize("demo", BOUNDS)
def test_errors(demo, records):
    for name, bound in BOUNDS[demo].items():
        assert 0 <= records[demo][name] <= bound


@pytest.mark.parametrize("demo", ["hellinger_reissner_beam", "hu_washizu_beam"])
def test_mixed_beams_are_of_second_order(demo, records):
    assert records[demo]["ratio_of_errors"] == pytest.approx(4.0, abs=0.1)


def test_independent_stress_saves_iterations(records):
    record = records["hellinger_reissner_beam"]
    assert 4 * record["iterations"] < record["plain_iterations"]


def test_full_steps_are_fastest(records):
    record = records["newton_and_snes"]
    assert record["newton"] == record["basic"] <= 5
    assert record["basic"] < min(record["bt"], record["cp"])


def test_bounds_are_of_all_demos():
    assert set(BOUNDS) == set(DEMOS)


def test_shear_locks_as_predicted_without_selective_integration(records):
    record = records["selective_integration"]
    assert record["locking"] == pytest.approx(record["expected_locking"], rel=1e-6)


@pytest.mark.parametrize("demo", DEMOS)
def test_examples_are_short(demo):
    lines = (parallel_form_demos.FOLDER / f"{demo}.py").read_text().splitlines()
    code = lines[next(k for k, line in enumerate(lines) if line.startswith("from __future__")) :]
    assert sum(1 for line in code if line.strip()) <= 60


@pytest.mark.parametrize("ranks", [2, pytest.param(3, marks=pytest.mark.slow)])
def test_ranks(ranks, records, tmp_path):
    on_ranks(parallel_form_demos, ranks, tmp_path / "out.json")
    parallel = json.loads((tmp_path / "out.json").read_text())
    for demo, record in records.items():
        for name, value in record.items():
            # others are numbers of iterations, and errors of solutions
            tolerance = 1e-12 if name in ("tip", "deflection") else 1e-9
            np.testing.assert_allclose(parallel[demo][name], value, rtol=0.0, atol=tolerance)
