"""Stiffness of contacts as a low-rank correction of a frozen matrix."""

import numpy as np
import pytest

import fem_lie as fl
from fem_lie.linear.low_rank import Columns, LowRankCorrection

RADIUS, CELLS = 0.01, 8
SECTION = fl.Section.circle(RADIUS, fl.Material(1e7, 0.3, 1000.0))
SCHEME = fl.GeneralisedAlpha(radius=0.8, tolerance=1e-6)


def falling(stiffness: float, *, line: bool = False) -> fl.Scene:
    """A tilted beam that is about to touch a plane."""
    scene = fl.Scene(gravity=(0, 0, -9.81))
    tilt = np.radians(5)
    end = np.cos(tilt), 0, np.sin(tilt)
    beam = scene.add(fl.Beam.straight((0, 0, 0), end, SECTION, cells=CELLS))
    plane = fl.contact.Plane(fl.ground(), (0, 0, 1), at=(0, 0, -0.011))
    nodes = fl.contact.Vertices([fl.extend.Point(beam, k) for k in range(CELLS + 1)])
    surface = fl.contact.Line(beam, RADIUS) if line else nodes
    scene.add(fl.contact.Contact(surface, plane, fl.contact.Penalty(stiffness)))
    return scene


def test_solutions_are_those_of_the_whole_matrix():
    """Also with columns of a row that has rotated a little since, and one that is left out."""
    rng = np.random.default_rng(3)
    S = 4.0 * np.eye(9) + rng.uniform(size=(9, 9))
    first, unknowns = np.array([0, 4, 7]), np.array([0, 1, 5, 6, 1, 2, 8])
    left, right = rng.uniform(size=(2, 7))
    columns, solved = Columns(), []

    def solve(b, x):
        solved.append(b)
        x[:] = np.linalg.solve(S, b)

    def found(left, right):
        x, r = np.empty(9), np.arange(1.0, 10.0)
        x[:] = np.linalg.solve(S, r)
        beside = LowRankCorrection(first, unknowns, left, right, np.array([1e6, 3.0]))
        columns.correct(beside, solve, x)
        return S @ x + beside.times(x) - r

    assert np.abs(found(left, right)).max() < 1e-8
    assert len(solved) == 2
    # another row on the right is taken at once; one on the left by its former column
    assert np.abs(found(left, 1.1 * right)).max() < 1e-8
    turned = left.copy()
    turned[0] *= 1.001
    found(turned, right)
    assert len(solved) == 2
    turned[4] *= 1.5
    found(turned, right)
    assert len(solved) == 3


@pytest.mark.parametrize("line", [False, True], ids=["nodes", "line"])
def test_what_is_beside_is_the_stiffness_of_the_contact(line):
    """Differences of the residual along increments, without rotations of forces."""
    scene = falling(1e6, line=line)
    equations = fl.extend.Equations(scene, dynamics=True)
    still = np.zeros((equations.unknowns.moving, 6))
    H = equations.start.frames.copy()
    H[:, 0, 2] -= 0.002 if line else 0.011 + 1e-6
    state = fl.extend.TimeState(H, still, still, np.empty(0))
    r, none = np.empty(equations.unknowns.size), np.empty(0)
    forces = equations.residual(state, none, r)
    whole, separate = (
        fl.extend.Plan(still, none),
        fl.extend.Plan(still, none, without_low_rank=True),
    )
    equations.fill(state, forces, whole)
    x = np.random.default_rng(1).normal(size=len(r))
    wanted = equations.matrix.times(x)
    equations.fill(state, forces, separate)
    without = equations.matrix.times(x)
    equations.fill(state, forces, separate._replace(low_rank_only=True))
    assert equations.matrix.correction is not None
    part = np.abs(wanted - without).max()
    assert part > 1.0
    assert np.abs(equations.matrix.times(x) - wanted).max() < 1e-2 * part


def test_a_stiff_contact_makes_no_more_matrices_than_a_soft_one():
    soft = SCHEME.run(falling(1e3), duration=0.3, step=1e-3, progress=False)
    with pytest.warns(fl.contact.UnresolvedContactWarning):
        stiff = SCHEME.run(falling(1e5), duration=0.3, step=1e-3, progress=False)
    made = soft.factorisations, stiff.factorisations
    assert made[1] <= 1.5 * made[0]


def test_many_rows_go_into_the_matrix(monkeypatch):
    """The motion is the same with all rows in the correction, and with at most one."""
    beside = SCHEME.run(falling(1e4), duration=0.05, step=1e-3, progress=False)
    monkeypatch.setattr("fem_lie.solve.alpha.run_state.MOST", 0)
    within = SCHEME.run(falling(1e4), duration=0.05, step=1e-3, progress=False)
    assert within.factorisations > beside.factorisations
    np.testing.assert_allclose(within.frames, beside.frames, rtol=0, atol=1e-6)


@pytest.mark.parametrize("line", [False, True], ids=["nodes", "line"])
def test_a_restart_during_contact_agrees_to_the_last_bit(tmp_path, line):
    options = {"duration": 0.05, "step": 1e-3, "progress": False, "checkpoint_every": 37}
    whole = SCHEME.run(falling(1e4, line=line), file=tmp_path / "whole.h5", **options)
    SCHEME.run(falling(1e4, line=line), file=tmp_path / "run.h5", **options)
    again = SCHEME.resume(falling(1e4, line=line), tmp_path / "run.h5", progress=False)
    np.testing.assert_array_equal(again.frames, whole.frames)
    np.testing.assert_array_equal(again.iterations, whole.iterations)
