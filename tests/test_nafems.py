"""Standard benchmarks of NAFEMS: the values of the table in docs/measured/nafems.md."""

import pytest

from benchmarks import nafems

WITHIN = {"LE1": 0.03, "LE5": 0.025, "LE6": 0.03, "LE10": 0.07, "FV12": 0.015, "FV15": 0.01}
WITHIN |= {"FV16": 0.01, "FV52": 0.065, "13": 0.03}
"""Largest difference from the target on these meshes."""


@pytest.mark.parametrize("test", nafems.TESTS)
def test_published_values(test):
    rows = nafems.TESTS[test](1)
    assert rows
    for row in rows:
        assert abs(row.error) < WITHIN[test], row


def test_quadratic_cells_converge_to_the_stress_at_the_hole():
    """The error of LE1 falls by more than half with cells half as large."""
    coarse, fine = (nafems.le1(refine)[0].error for refine in (1, 2))
    assert abs(fine) < 0.5 * abs(coarse)
