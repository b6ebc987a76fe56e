"""The numbers of benchmarks/work_precision.py: its references, and what is read from its runs."""

import math

import numpy as np
import pytest

import fem_lie as fl
from benchmarks import work_precision
from benchmarks.work_precision import PROBLEMS, TOLERANCES, Row


@pytest.mark.parametrize("name", PROBLEMS)
def test_references_are_those_of_the_scenes(name):
    problem = PROBLEMS[name]
    found = work_precision.positions(work_precision.run(problem, fl.schemes.Composed(), 80))
    exact = work_precision.references()[name]
    assert np.abs(found - exact).max() < 3e-6 * problem.length


def rows(tolerance, *pairs):
    return [Row("", "", tolerance, 1, error, seconds, 1, 1) for error, seconds in pairs]


def test_seconds_are_those_of_the_better_tolerance():
    loose = rows(TOLERANCES[0], (1e-4, 1.0), (1e-6, 10.0), (9e-7, 100.0))
    tight = rows(TOLERANCES[1], (1e-4, 2.0), (1e-8, 200.0))
    assert work_precision.seconds_at(1e-5, loose + tight) == pytest.approx(math.sqrt(10.0))
    assert work_precision.seconds_at(1e-7, loose + tight) == pytest.approx(2.0 * 10.0**1.5)
    assert work_precision.seconds_at(1e-9, loose + tight) == math.inf


def test_runs_that_are_beaten_in_both_do_not_count():
    kept = rows(0.0, (1e-4, 1.0), (1e-3, 2.0), (1e-6, 3.0))
    assert [row.error for row in work_precision.front(kept)] == [1e-4, 1e-6]
