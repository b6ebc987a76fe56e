"""Demos of the conserving schemes, shortened: figures against their references."""

import importlib
import itertools

import numpy as np
import pytest

import fem_lie as fl


def main(demo: str, **parameters):
    return importlib.import_module(f"demos.{demo}").main(pictures=False, **parameters)


def study(name: str, **parameters):
    return importlib.import_module(f"studies.{name}").main(pictures=False, **parameters)


@pytest.mark.parametrize("case", [1, 2, 3])
def test_pendulums(case):
    """Bounds are those of a million steps."""
    record = study("pendulum_conservation", case=case, steps=1000)
    bound = 2e-11 if case == 2 else 5e-12
    assert record["energy_error"] <= bound
    assert record["angular_momentum_error"] <= bound
    assert record["constraint_error"] <= 1e-12
    assert record["steps"] == 1000


def test_tip_of_the_pendulum():
    """Exudyn with the same elements; converged in time to 2e-7 m there and to 1e-5 m here."""
    record = study("pendulum_conservation", case=1, steps=5000, step=2e-4)
    reference = np.array([-0.25256, -0.71726, 0.22333])
    tip = np.array([record[f"tip_{axis}"] for axis in "xyz"])
    assert np.linalg.norm(tip - reference) <= 1e-4
    assert record["tip_distance_at_1s"] <= 1e-4


def test_decaying_pendulum():
    record = study("pendulum_conservation", case=1, steps=500, decaying=0.8, save_every=1)
    assert record["largest_energy_gain"] <= 1e-15
    assert record["angular_momentum_error"] <= 5e-12


@pytest.mark.parametrize("formulation", ["displacement", "hr", "hw"])
def test_tumbling_plate(formulation):
    record = main("tumbling_plate", formulation=formulation, along=3, across=2, steps=200)
    assert record["energy_error"] <= 1e-11
    assert record["momentum_error"] <= 1e-11
    assert record["angular_momentum_error"] <= 1e-11
    assert record["elastic_share"] > 1e-2


def test_stiff_energy():
    record = main("stiff_energy", duration=1.0)
    for scheme in ("energy_momentum", "energy_decaying"):
        assert not record[f"{scheme}_failed"]
        assert record[f"{scheme}_energy_largest"] <= 1 + 1e-10
        assert record[f"{scheme}_angular_momentum_error"] <= 1e-10


def test_conservation_against_time():
    record = study("conservation_against_time", repeats=1, steps=4)
    assert record["energy_momentum_order"] >= 1.8
    assert record["energy_momentum_energy_error"] <= 1e-12


@pytest.mark.parametrize("case", ["pendulum", "beam"])
def test_order_four(case):
    """In configuration, velocity and joint forces; what costs are is not asked."""
    record = main("order_four", case=case, steps=50, repeats=0)
    orders = {key: value for key, value in record.items() if key.startswith("order")}
    assert len(orders) == {"pendulum": 4, "beam": 3}[case]
    assert all(abs(order - 4.0) <= 0.1 for order in orders.values()), orders
    assert record["energy_error"] <= 5e-12
    assert record["angular_momentum_error"] <= 5e-12


@pytest.mark.parametrize("case", [1, 3])
def test_variational_pendulum(case):
    """Bounds are those of a million steps; a line needs more steps than these."""
    record = main("variational_pendulum", case=case, steps=500)
    assert record["angular_momentum_error"] <= 1e-11
    assert record["energy_error"] <= 1e-5
    assert record["energy_drift"] <= record["energy_swing"]
    assert record["joint_gap"] <= 1e-13


def test_variational_free_body():
    record = main("variational_pendulum", free=True, steps=1000)
    assert record["energy_error"] <= 1e-12
    assert record["angular_momentum_error"] <= 1e-12


def test_stiffly_accurate_stages():
    """Nearly fourth order where bars damp strains, and where generalised-alpha goes, too."""
    module = importlib.import_module("studies.stiffly_accurate")
    positions = [module.staged(1e-3, 0.1, steps, 1e-9)[0] for steps in (10, 20, 40)]
    first, second = (np.abs(a - b).max() for a, b in itertools.pairwise(positions))
    assert np.log2(first / second) >= 3.0
    plan = {"duration": 0.1, "step": 0.1 / 1600, "save_every": 1600}
    made = fl.GeneralisedAlpha(radius=0.8).run(module.scene(1e-3), **plan)
    run = module.staged(1e-3, 0.1, 1, 1e-2)[1]
    there = made.frames[-1, run.equations.unknowns.masters, 0]
    assert np.abs(positions[-1] - there).max() <= 3e-6
