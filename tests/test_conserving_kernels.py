"""Kernels of the conserving schemes.

Where constraints touch few unknowns, a small dense matrix stands for solutions with factors; when
iterations stop at round-off; forces at the end of a run; energy that earlier steps have left.
"""

from __future__ import annotations

import numpy as np
import pytest

import fem_lie as fl
from demos.double_pendulum import pendulum
from fem_lie import lie
from fem_lie._jit.records import block_of
from fem_lie.forms.abilities import Ends
from fem_lie.solve.conserving import model
from fem_lie.solve.conserving.midpoint import mean_forces
from fem_lie.solve.conserving.midpoint.cayley import span
from fem_lie.solve.conserving.midpoint.end_forces import _part_of_earlier, at_end
from fem_lie.solve.conserving.step import corrections
from fem_lie.solve.conserving.step.records import Incidences

STEPS, SIZE = 1500, 1e-4


def run(dense: int, whole: int, monkeypatch: pytest.MonkeyPatch) -> fl.Result:
    """Case 1, with so many unknowns in the dense matrix, and numbers in columns, at most."""
    monkeypatch.setattr(model, "DENSE", dense)
    monkeypatch.setattr(model, "WHOLE", whole)
    scheme = fl.EnergyMomentum()
    return scheme.run(pendulum(1)[0], step=SIZE, duration=STEPS * SIZE, progress=False)


@pytest.mark.parametrize("whole", [0, model.WHOLE], ids=["solution", "columns"])
def test_the_dense_matrix_changes_neither_motion_nor_conservation(whole, monkeypatch):
    """Joints rotate: frozen matrices have the constraints of other configurations."""
    solved, small = run(0, 0, monkeypatch), run(60, whole, monkeypatch)
    gap = solved.position("bar II.end") - small.position("bar II.end")
    moved = np.ptp(small.position("bar II.end"), axis=0).max()
    assert np.abs(gap).max() <= 1e-9 * moved
    assert max(solved.energy_error, small.energy_error) <= 1e-12
    assert small.iterations[-1] <= 1.05 * solved.iterations[-1]
    assert small.factorisations <= solved.factorisations


def test_incidences_find_their_unknowns_in_the_dense_matrix():
    """Two constraints between nodes 1 and 4 of five, and one on node 1 alone."""
    incidences = Incidences(np.array([1, 4, 1, 4, 1]), np.array([0, 0, 2, 2, 1]))
    ends = model.incidence_positions_of(incidences, 5, 33)
    assert ends.unknowns.tolist() == [*range(6, 12), *range(24, 30), 30, 31, 32]
    first, row = ends.at
    assert (ends.unknowns[first] == 6 * incidences.nodes).all()
    assert (ends.unknowns[row] == 30 + incidences.constraints).all()
    assert ends.inverse.shape == (15, 15) and ends.columns.shape == (15, 33)


def test_whole_columns_are_kept_where_they_are_few_numbers():
    incidences = Incidences(np.array([1, 4]), np.array([0, 0]))
    ends = model.incidence_positions_of(incidences, 10**5, 6 * 10**5 + 1)
    assert ends.inverse.shape == (13, 13) and len(ends.columns) == 0


def test_many_incidences_have_no_dense_matrix():
    incidences = Incidences(np.arange(20), np.arange(20))
    assert model.incidence_positions_of(incidences, 20, 140).inverse.size == 0


def test_energy_of_earlier_steps_waits_for_work():
    """Forces that do hardly any do not jump with its sign."""
    left, work = 1e-12, np.linspace(-2e-6, 2e-6, 4001)
    parts = np.array([_part_of_earlier(left, each, 1e-6) for each in work])
    np.testing.assert_allclose(parts, -parts[::-1])
    assert np.abs(np.diff(parts)).max() < 1.01 * left / 1e-6 * 1e-3
    assert parts[-1] * work[-1] == pytest.approx(left)


@pytest.mark.parametrize("sizes", [(1.0, 1.0, 1.0), (0.5, 1.0, 2.0), (2.0, 0.3, 0.7)], ids=str)
def test_the_end_of_a_line_that_alternates(sizes):
    """Exact for a straight line and an alternating part of constant impulse."""
    h = np.array(sizes)
    middles = -(np.cumsum(h) - 0.5 * h)
    values = 3.0 + 2.0 * middles + 0.4 * np.array([1.0, -1.0, 1.0]) / h
    last, *earlier = values[:, np.newaxis]
    assert at_end(last, np.array(earlier), h) == pytest.approx([3.0], abs=1e-13)


def test_increments_that_fall_slowly_are_not_round_off():
    """Forces left over do work: taken for noise they raised the energy by 1e-12 in one step."""

    def ends(increments: list[float], window: int) -> list[bool]:
        progress, found = block_of(corrections.PROGRESS())[0], []
        corrections.forget(progress)
        for increment in increments:
            found.append(bool(corrections.stalls(progress, increment, window)))
        return found

    for window in (corrections.WINDOW, corrections.LEARNING):
        assert not any(ends(list(1e-13 * 0.7 ** np.arange(12.0)), window))
        constant = ends([2.5e-16] * (window + 1), window)
        assert constant == [False] * window + [True]


# --- the mean of nodal forces ---


def cayley(ψ: np.ndarray) -> np.ndarray:
    """Rotation vector of the Cayley map's ``ψ``."""
    return 2.0 * np.arctan(0.5 * np.linalg.norm(ψ)) * ψ / max(np.linalg.norm(ψ), 1e-300)


def turned(H: np.ndarray, change: np.ndarray, ω: np.ndarray) -> np.ndarray:
    """Local changes of frames, then a turn of all by ``cay(ω)``, as spatial steps (n, 6)."""
    ends = lie.se3_retract(H, change) @ lie.so3_exp(cayley(ω)).T
    R = ends[:, 1:].transpose(0, 2, 1) @ H[:, 1:]
    θ = lie.so3_log(R)
    size = np.maximum(np.linalg.norm(θ, axis=1, keepdims=True), 1e-300)
    return np.hstack([ends[:, 0] - H[:, 0], 2.0 * np.tan(0.5 * size) * θ / size])


def work(H: np.ndarray, step: np.ndarray, F: np.ndarray, director: bool) -> float:
    """Of forces (n, 6) that are constant in the frames, on the step, by their mean."""
    rows = np.zeros((4, len(H), 4, 3))
    delta, mean, end, middle = rows
    span(H, step, delta, mean, end, middle)
    nodes = np.arange(len(H))
    f, s, Ms = np.empty((3, len(H), 6))
    path = mean_forces.Path(mean, delta, step)
    fit = mean_forces.metric_and_fit(nodes, director, path)
    ends = mean_forces.Ends(H, end, F, F)
    mean_forces.mean_forces(nodes, director, ends, mean, fit, f)
    mean_forces.deformation(nodes, director, path, fit, s, Ms)
    return float(np.sum(f * s))


@pytest.mark.parametrize("director", [False, True], ids=["frames", "directors"])
@pytest.mark.parametrize("kind", ["stretched", "bent", "twisted"])
@pytest.mark.parametrize("ω", [(0, 0, 0.0), (0, 0, 0.5), (0.7, -1.5, 1.0)], ids=str)
def test_mean_forces_do_their_work_however_far_an_element_turns(kind, ω, director):
    """Two nodes, a small deformation: the work is force times elongation, moment times angle."""
    small, axis = 1e-6, {"stretched": 0, "bent": 4, "twisted": 3}[kind]
    H = np.zeros((2, 4, 3))
    H[:, 1:], H[1, 0, 0] = np.eye(3), 0.8
    F, change = np.zeros((2, 6)), np.zeros((2, 6))
    F[:, axis], change[:, axis] = (-3.0, 3.0), (-0.5 * small, 0.5 * small)
    found = work(H, turned(H, change, np.array(ω)), F, director)
    assert found == pytest.approx(3.0 * small, rel=1e-6)


def test_the_work_of_contacts_of_lines_is_the_change_of_their_energy():
    """Of bent threads that move at random, so that parts begin and cease to overlap."""
    section = fl.Section.circle(0.01, fl.Material(1e8, 0.3, 1000.0))
    x = np.linspace(-0.2, 0.2, 6)
    paths = [
        np.column_stack([x, 0.0 * x, 2.0 * x * x]),
        np.column_stack([x + 0.01, 0.1 * x, 0.018 - 2.0 * x * x]),
    ]
    threads = [fl.Net(path, [range(6)], section) for path in paths]
    lines = [fl.contact.Line(thread, 0.01) for thread in threads]
    contact = fl.contact.Contact(*lines, fl.contact.Penalty(1e6))
    numbers = {thread: np.arange(6) + 6 * k for k, thread in enumerate(threads)}
    random = np.random.default_rng(0)
    for _ in range(40):
        start, end = (np.concatenate([thread.frames for thread in threads]) for _ in range(2))
        for each in (start, end):
            each[:, 0] += random.normal(0.0, 2e-3, (12, 3))
        term = contact.term(numbers.__getitem__)
        before, after = term.energy(start), term.energy(end)
        ends = Ends(start, end, 0.5 * (start + end), end - start)
        done = term.add_over_step(ends, np.zeros((12, 6)), np.zeros(6))
        assert done.work == pytest.approx(after - before, abs=1e-13 * (before + after))
