"""Demos of resultants against their references, by their records of numbers."""

import importlib

import pytest

import fem_lie as fl

laminate = importlib.import_module("demos.laminate")


@pytest.mark.parametrize(("slenderness", "published"), [(10.0, 1.0250), (100.0, 0.6833)])
def test_navier_is_that_of_the_literature(slenderness, published):
    """Reddy (2004), table of the plate 0/90/90/0 under uniform load, first-order theory."""
    section = laminate.cross_ply(1 / slenderness)
    w = laminate.navier(section, 1.0, 0.5, 0.5)["w"]
    assert 100 * w / slenderness**3 == pytest.approx(published, abs=6e-5)


def test_navier_is_the_classical_plate_if_it_is_thin_and_isotropic():
    """Timoshenko & Woinowsky-Krieger, table 8: 0.00406, 0.0479 and 0.338."""
    section = fl.ShellSection.layer(1e-3, fl.Material(1.0, 0.3, 1.0))
    D = section.stiffness[3, 3]
    centre = laminate.navier(section, 1.0, 0.5, 0.5)
    assert centre["w"] * D == pytest.approx(0.00406, abs=5e-6)
    assert centre["M11"] == pytest.approx(0.0479, abs=5e-5)
    assert laminate.navier(section, 1.0, 0.0, 0.5)["Q1"] == pytest.approx(0.338, abs=2e-3)


@pytest.mark.parametrize("slenderness", [10.0, 100.0])
def test_laminate(slenderness):
    record = laminate.main(cells=16, slenderness=slenderness, pictures=False)
    # of the order (1/16)²; twice extrapolated to the corner, and with boundary layers, more
    for name, bound in (("w", 2e-3), ("M11", 5e-3), ("M22", 5e-3), ("M12", 0.04), ("Q1", 0.03)):
        assert abs(record[f"{name}_error"]) <= bound, name
    assert record["iterations"] <= 3


def test_laminate_converges_with_the_square_of_the_cells():
    rough, fine = (laminate.main(cells=n, pictures=False) for n in (8, 16))
    for name in ("w_error", "M11_error", "M22_error", "Q1_error"):
        assert abs(fine[name]) <= 0.3 * abs(rough[name])


def test_isotropic_plate_has_its_classical_moments():
    section = fl.ShellSection.layer(1e-2, fl.Material(1.0, 0.3, 1.0))
    load = 1e-12
    scene, shell = laminate.plate(section, 16, load)
    _, pairs = laminate.compare(fl.follow_loads(scene), shell, section, load)
    assert pairs["M11"][0] / load == pytest.approx(0.0479, rel=5e-3)
    assert pairs["M22"][0] == pytest.approx(pairs["M11"][0], rel=1e-6)
    assert pairs["w"][0] * section.stiffness[3, 3] / load == pytest.approx(0.00406, rel=5e-3)


def test_laminate_wants_a_node_at_the_centre():
    with pytest.raises(ValueError, match="even"):
        laminate.main(cells=7)
