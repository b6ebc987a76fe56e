"""Corrections that learn from the last ones of their step."""

from __future__ import annotations

import numpy as np
import pytest

import fem_lie as fl
from fem_lie.solve.secants import Secants
from tests.test_composed import resumed_as_whole

SIZE = 30


def iterated(A: np.ndarray, kept: np.ndarray, most: int, count: int) -> list[float]:
    """Sizes of corrections of ``A x = b`` by the inverse of another matrix."""
    b = np.random.default_rng(1).standard_normal(len(A))
    secants, x, sizes = Secants(most, np.ones(len(A))), np.zeros(len(A)), []
    for _ in range(count):
        g = np.linalg.solve(kept, A @ x - b)
        sizes.append(float(np.abs(g).max()))
        if most:
            secants.improve(g)
        x -= g
    return sizes


def matrices(rank: int, share: float) -> tuple[np.ndarray, np.ndarray]:
    """One, and the same with so many of its directions stiffer by a share of themselves."""
    given = np.random.default_rng(2)
    kept = np.diag(np.linspace(1.0, 2.0, SIZE))
    axes, _ = np.linalg.qr(given.standard_normal((SIZE, rank)))
    return kept + (axes * share * np.arange(1, rank + 1)) @ axes.T, kept


@pytest.mark.parametrize("rank", [1, 2, 3])
def test_linear_changes_of_low_rank_are_found(rank):
    """After twice as many corrections as directions have changed, and one; alone it takes long."""
    A, kept = matrices(rank, 0.2)
    plain, better = (iterated(A, kept, most, 2 * rank + 3) for most in (0, 2 * rank))
    assert better[-1] < 1e-10 * better[0]
    assert plain[-1] > 1e3 * better[-1]


def test_a_right_matrix_is_left_alone():
    """The second correction is round-off, and is none the larger for it."""
    A, _ = matrices(3, 0.2)
    sizes = iterated(A, A, 3, 4)
    assert max(sizes[1:]) < 1e-13 * sizes[0]


def test_changes_that_say_the_same_are_left_out():
    """The same correction twice over: as if it had been one."""
    A, kept = matrices(1, 0.2)
    sizes = iterated(A, kept, 8, 12)
    assert np.isfinite(sizes).all()
    assert sizes[-1] < 1e-13 * sizes[0]


def test_what_is_not_measured_follows():
    """A multiplier, in units in which it is huge, changes nothing of the rest."""
    A, kept = matrices(2, 0.3)
    found = []
    for unit in (0.0, 1e9):
        both, x = Secants(3, np.append(np.ones(SIZE), 0.0)), np.zeros(SIZE)
        for k in range(5):
            g = np.append(np.linalg.solve(kept, A @ x - 1.0), unit * (k + 1.0))
            both.improve(g)
            x -= g[:SIZE]
        found.append(x)
    np.testing.assert_array_equal(*found)


def test_a_correction_that_grows_begins_anew():
    """What is known of another slope is not used: the larger correction is made as it is."""
    secants = Secants(3, np.ones(2))
    for g in ([1.0, 0.0], [0.5, 0.1]):
        secants.improve(np.array(g))
    larger = np.array([2.0, -1.0])
    secants.improve(larger)
    np.testing.assert_array_equal(larger, [2.0, -1.0])


def test_what_is_forgotten_is_not_used():
    """In the next step, or with another matrix, though the correction has not grown."""
    secants = Secants(3, np.ones(2))
    for g in ([1.0, 0.0], [0.5, 0.1]):
        secants.improve(np.array(g))
    secants.forget()
    first = np.array([0.2, 0.1])
    secants.improve(first)
    np.testing.assert_array_equal(first, [0.2, 0.1])


def going_slack() -> fl.Scene:
    """A net that is let go by all but three corners: its cables go slack and taut."""
    points = np.array([[i / 4, j / 4, 0.0] for i in range(5) for j in range(5)])
    cables = [[5 * i + j for j in range(5)] for i in range(5)]
    cables += [[5 * i + j for i in range(5)] for j in range(5)]
    section = fl.Section.from_stiffness([1e4] * 3 + [1e-4] * 3, mass=0.1)
    scene = fl.Scene(gravity=(0, 0, -9.81))
    own = fl.elements.DiscreteCable(slack=1e-3)
    net = scene.add(fl.Net(points, cables, section, formulation=own))
    net.pin(*(net.point(k) for k in (0, 4, 20)))
    return scene


def scheme(secants: int) -> fl.GeneralisedAlpha:
    """Which forgets high frequencies at once."""
    policy = fl.schemes.Automatic(secants=secants, cost=200.0)
    return fl.GeneralisedAlpha(radius=0.0, tolerance=1e-9, policy=policy)


PLAN = {"duration": 0.1, "step": 5e-3}


def test_motion_is_the_same_with_fewer_iterations():
    """Of a tension-only net, within what iterations leave."""
    plain, better = (scheme(secants).run(going_slack(), **PLAN) for secants in (0, 3))
    positions, others = (result.frames[:, :, 0] for result in (plain, better))
    assert np.abs(positions - others).max() < 1e-6 * np.abs(positions - positions[0]).max()
    assert better.iterations[-1] < plain.iterations[-1]


def test_a_restart_agrees_to_the_last_bit(tmp_path):
    """For nothing is kept beyond a step."""
    resumed_as_whole(scheme(3), going_slack, PLAN, tmp_path / "run.h5")


def thrown() -> fl.Scene:
    """A rope in the air that is thrown so that it bends and stretches."""
    section = fl.Section.from_stiffness([1e3] * 3 + [0.1] * 3, mass=0.1)
    mesh = fl.mesh.straight_line((0, 0, 0), (1, 0, 0), 12)
    rope = fl.Cable(mesh, section, formulation=fl.elements.DiscreteCable())
    s = np.linspace(0.0, 1.0, 13)
    rope.velocities[:, :3] = 10.0 * np.column_stack([s**2, np.sin(6.0 * s), s - 0.5])
    scene = fl.Scene()
    scene.add(rope)
    return scene


def test_conserving_steps_learn_too():
    """Energy as before, the same motion, fewer matrices, which steps that diverge ask for."""
    found = []
    for secants in (0, 3):
        policy = fl.schemes.Automatic(cost=1e6, patience=10**6, secants=secants)
        found.append(fl.EnergyMomentum(policy=policy).run(thrown(), duration=0.05, step=2e-3))
    plain, better = found
    positions, others = (result.frames[:, :, 0] for result in found)
    assert np.abs(positions - others).max() < 1e-10
    assert better.energy_error < 1e-12
    assert better.k_updates < plain.k_updates
    assert better.iterations[-1] < plain.iterations[-1]


def test_bad_numbers_are_named():
    """Not negative, and not more than pay."""
    for given in (-1, 21):
        with pytest.raises(ValueError, match=f"secants must be 0 … 20, got {given}"):
            fl.schemes.Automatic(secants=given)


def test_schemes_without_them_say_so():
    """Before any work."""
    with pytest.raises(ValueError, match="expected secants=0, got 2"):
        fl.schemes.Variational(policy=fl.schemes.Automatic(secants=2))
    scene = fl.Scene()
    scene.add(fl.RigidBody(1.0, (0.1, 0.2, 0.3)))
    scheme = fl.EnergyMomentum(policy=fl.schemes.Automatic(secants=2))
    with pytest.raises(ValueError, match="expected secants=0 without these, got 2"):
        scheme.run(scene, duration=0.1, step=0.01)
