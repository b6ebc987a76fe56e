"""The deployable truss: what is left of the iteration matrix's updates in local frames."""

import importlib

import numpy as np
import pytest

import fem_lie as fl

demo = importlib.import_module("demos.truss_deployment")


def main(**parameters):
    return demo.main(cells=1, elements=2, pictures=False, **parameters)


def test_stiff_bars_deploy_with_one_mass_and_stiffness_matrix():
    """All the way to straight longerons; the coarse step damps what the start excites."""
    record = main(policy="frozen", step=2e-2)
    assert record["bars"] == 28
    assert record["k_updates"] == 1 < record["phi_updates"]
    assert record["posture_error"] < 5e-3  # of 4 m: still vibrating
    assert record["max_deflection"] < 5e-4
    assert record["violation"] < 1e-9


def test_the_posture_follows_from_the_layout():
    """In statics, where nothing vibrates, bars of any stiffness are in the exact posture."""
    section = fl.Section.tube(0.0115, 0.012, demo.STEEL)
    truss = demo.Truss(1, section, elements=1, driven=4, choices=fl.Choices())
    result = fl.statics(truss.scene, levels=np.linspace(1.0, 10.0, 10))
    assert demo.posture_error(result, truss, 10.0) < 1e-6
    assert demo.bending(result, truss, 0.012)[1] < 1e-7


def test_policies_and_components_agree():
    """They decide on the cost, not on the motion; full Newton takes the fewest iterations."""
    full, nni4, frozen, auto, inertial = (
        main(tubes="thin", step=2e-2, duration=2.0, policy=policy, inertial=inertial)
        for policy, inertial in [(p, False) for p in demo.POLICIES] + [("nni4", True)]
    )
    for record in (nni4, frozen, auto, inertial):
        assert record["max_deflection"] == pytest.approx(full["max_deflection"], rel=1e-4)
        assert record["iterations"] >= full["iterations"]
    assert full["k_updates"] == full["iterations"]
    assert frozen["k_updates"] == 1
    assert nni4["k_updates"] < full["k_updates"]
    assert inertial["k_updates"] > nni4["k_updates"]


def test_bad_options_are_refused():
    with pytest.raises(ValueError, match="stiff, thin"):
        main(tubes="wood")
    with pytest.raises(ValueError, match="driven"):
        main(driven=5)
