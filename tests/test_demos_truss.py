"""The deployable truss: what is left of the iteration matrix's updates in local frames."""

import importlib

import numpy as np
import pytest

import fem_lie as fl

demo = importlib.import_module("demos.truss_deployment")
scene = importlib.import_module("demos.truss_scene")
layout = importlib.import_module("demos.reference.truss")
study = importlib.import_module("studies.truss_policies")


def main(**parameters):
    return demo.main(elements=2, pictures=False, **parameters)


def test_a_telescope_always_overlaps():
    """Its two tubes are longer than it in every posture, in the side faces and the leaning ones."""
    for q in np.linspace(layout.START, layout.END, 50):
        (c0, d0, e0, _), (c1, d1, *_) = (layout.corners(level, q) for level in range(2))
        opening, closing, leaning = (
            np.linalg.norm(b - a) for a, b in ((d0, c1), (c0, d1), (e0, d1))
        )
        assert np.linalg.norm(c1 - c0) == pytest.approx(4.0)
        assert leaning == pytest.approx(np.hypot(2.0, 4.0))
        assert max(opening, leaning) < 2 * scene.TUBES["opening"] - 0.3
        assert closing < 2 * scene.TUBES["closing"] - 0.3


def test_stiff_bars_deploy_with_one_mass_and_stiffness_matrix():
    """From 5 degrees until the truss stands, both cells on one drive and one pair of gears."""
    record = main(policy="frozen", step=4e-2)
    assert record["bars"] == 56
    assert record["k_updates"] == 1 < record["phi_updates"]
    assert record["posture_error"] < 1e-6
    assert record["off_at_end"] < 0.1  # of 8 m: the law ends with its full deceleration
    assert record["max_deflection"] < 3e-3
    # 2e-8 of the largest motion in a step, 0.04 m, and ten times that where angles are bound
    assert record["violation"] < 8e-9


def test_thin_bars_bend_as_the_papers_do():
    """2 to 5 % of their length, by the moment that lifts all cells on one longeron."""
    record = main(tubes="thin", step=4e-2, duration=12.0)
    assert 0.02 < record["max_deflection"] < 0.03
    assert record["posture_error"] < 1e-6
    # 8.3e-4 with ten elements; their ends, where the moment is largest, are not nodes of strain
    assert 4e-4 < record["max_strain"] < 9e-4


def test_at_the_midpoint_the_posture_follows_from_the_layout():
    """In statics, where nothing vibrates, bars of any stiffness are where rigid ones would be."""
    section = fl.Section.tube(0.0115, 0.012, demo.STEEL)
    truss = demo.Truss(3, section, elements=1, driven=2, matrix_terms=fl.schemes.MatrixTerms())
    assert demo.posture_error(truss, 10.0) < 1e-6
    assert layout.angle(10.0) == pytest.approx(np.radians(47.5))


def test_policies_and_components_agree():
    """They decide on the cost, not on the motion; full Newton takes the fewest iterations."""
    thin = {"cells": 1, "tubes": "thin", "step": 2e-2, "duration": 1.2}
    rows = list(study.main(**thin, elements=2)["rows"].values())
    assert [row["policy"] for row in rows] == 2 * list(demo.POLICIES)
    assert [row["steps"] for row in rows] == 4 * [60] + 4 * [120]
    full, nni4, frozen, auto = rows[:4]
    inertial = main(**thin, policy="nni4", inertial=True)
    for record in (nni4, frozen, auto, inertial):
        assert record["max_deflection"] == pytest.approx(full["max_deflection"], rel=1e-4)
        assert record["iterations"] >= full["iterations"]
    assert full["k_updates"] == full["phi_updates"] == full["iterations"]
    assert frozen["k_updates"] == 1
    assert nni4["k_updates"] < full["k_updates"]
    assert inertial["k_updates"] > nni4["k_updates"]


def test_bad_options_are_refused():
    with pytest.raises(ValueError, match="stiff, thin"):
        main(tubes="wood")
    with pytest.raises(ValueError, match="driven"):
        main(driven=5)
