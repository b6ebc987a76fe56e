"""Laws of every element along lines: its order on both problems of benchmarks/lines.py, no locking.

A new element is put into the list there.
"""

import pytest

from benchmarks.lines import LINES, study

THICK, SLENDER = 1e1, 1e4
MESHES = (8, 16)
CASES = [
    (problem, name)
    for name, line in LINES.items()
    for problem, order in (("circle", line.circle), ("elastica", line.elastica))
    if order is not None
]


@pytest.mark.parametrize(("problem", "name"), CASES)
def test_order_and_iterations_of_slender_ones(problem, name):
    found, line = study(problem, name, SLENDER, MESHES), LINES[name]
    order = line.circle if problem == "circle" else line.elastica
    # edges that turn by 45° and 22° are that far from the order in the limit
    assert found.order >= order - 0.3
    assert found.iterations <= 5.0
    # what is left of stretch and shear, and the error of twice the finest mesh here
    assert found.rest < 1e-6 + 2.0 ** (1 - order) * found.errors[-1]


@pytest.mark.parametrize(("problem", "name"), [case for case in CASES if LINES[case[1]].thick])
def test_slender_ones_do_not_lock(problem, name):
    thick, slender = (study(problem, name, L, MESHES) for L in (THICK, SLENDER))
    # 1e-10 where the tip is exact
    assert slender.errors[-1] <= 1.25 * thick.errors[-1] + 1e-10
    assert abs(slender.iterations - thick.iterations) <= 0.5
