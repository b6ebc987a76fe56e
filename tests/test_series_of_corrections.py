"""Where constraints touch few unknowns, a small dense matrix stands for solutions with factors."""

from __future__ import annotations

import numpy as np
import pytest

import fem_lie as fl
from demos.double_pendulum import pendulum
from fem_lie.solve.conserving import memory
from fem_lie.solve.conserving.step.records import Legs

STEPS, SIZE = 1500, 1e-4


def run(dense: int, whole: int, monkeypatch: pytest.MonkeyPatch) -> fl.Result:
    """Case 1, with so many unknowns in the dense matrix, and numbers in columns, at most."""
    monkeypatch.setattr(memory, "DENSE", dense)
    monkeypatch.setattr(memory, "WHOLE", whole)
    scheme = fl.EnergyMomentum()
    return scheme.run(pendulum(1)[0], step=SIZE, duration=STEPS * SIZE, progress=False)


@pytest.mark.parametrize("whole", [0, memory.WHOLE], ids=["solution", "columns"])
def test_the_dense_matrix_changes_neither_motion_nor_conservation(whole, monkeypatch):
    """Joints turn: kept matrices have the constraints of other postures."""
    solved, small = run(0, 0, monkeypatch), run(60, whole, monkeypatch)
    gap = solved.position("bar II.end") - small.position("bar II.end")
    moved = np.ptp(small.position("bar II.end"), axis=0).max()
    assert np.abs(gap).max() <= 1e-9 * moved
    assert max(solved.energy_error, small.energy_error) <= 1e-12
    assert small.iterations[-1] <= 1.05 * solved.iterations[-1]
    assert small.factorisations <= solved.factorisations


def test_legs_find_their_unknowns_in_the_dense_matrix():
    """Two constraints between nodes 1 and 4 of five, and one on node 1 alone."""
    legs = Legs(np.array([1, 4, 1, 4, 1]), np.array([0, 0, 2, 2, 1]))
    ends = memory.ends_of(legs, 5, 33)
    assert ends.unknowns.tolist() == [*range(6, 12), *range(24, 30), 30, 31, 32]
    first, row = ends.at
    assert (ends.unknowns[first] == 6 * legs.nodes).all()
    assert (ends.unknowns[row] == 30 + legs.constraints).all()
    assert ends.inverse.shape == (15, 15) and ends.columns.shape == (15, 33)


def test_whole_columns_are_kept_where_they_are_few_numbers():
    legs = Legs(np.array([1, 4]), np.array([0, 0]))
    ends = memory.ends_of(legs, 10**5, 6 * 10**5 + 1)
    assert ends.inverse.shape == (13, 13) and len(ends.columns) == 0


def test_many_legs_have_no_dense_matrix():
    legs = Legs(np.arange(20), np.arange(20))
    assert memory.ends_of(legs, 20, 140).inverse.size == 0
