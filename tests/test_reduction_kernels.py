"""Parts of reduction: activity of regions, forces of sampled cells and of their training."""

import numpy as np
import pytest

import fem_lie as fl
from fem_lie.reduction.energy_sampling import ReducedCells, forces_of_training
from fem_lie.reduction.merging import ActivityCheck, MotionMatrices, expansion
from tests.test_regions import rod
from tests.test_sampling import BOTH, trained


def looking(scene, increments=None, twists=None):
    """At a state of the rod, by default the initial one."""
    whole = fl.extend.Equations(scene, dynamics=True)
    (body,) = scene.bodies
    frames = body.frames if increments is None else fl.lie.se3_retract(body.frames, increments)
    nodes = whole.unknowns.bodies[body]
    ordered, moving = np.empty_like(frames), np.empty((len(frames), 6))
    ordered[nodes] = frames
    moving[nodes] = body.velocities if twists is None else twists
    return ActivityCheck(MotionMatrices(whole, ordered, 0.02), ordered, moving, np.array([0.0]))


def test_what_is_missed_is_how_far_nodes_go_elsewhere():
    """Within the time that is looked ahead, up to the factor of one step of that size."""
    bent, one = np.zeros((9, 6)), np.zeros(9, dtype=int)
    bent[:, 2] = 0.01 * np.linspace(0.0, 1.0, 9) ** 2
    missed = looking(rod(), bent).missed(one).max()
    ends = []
    for merged in (False, True):
        scene = rod()
        (body,) = scene.bodies
        body.model.start_frames = fl.lie.se3_retract(body.frames, bent)
        if merged:
            body.model.masters = one
            body.velocities[:] = rigid_twists(bent)
        result = fl.GeneralisedAlpha().run(scene, duration=0.02, step=5e-4, progress=False)
        ends.append(result.frames[-1, :, 0])
    wanted = np.linalg.norm(ends[1] - ends[0], axis=1).max()
    assert wanted > 1e-3
    assert 0.4 * wanted < missed < 2.5 * wanted


def rigid_twists(bent):
    """Those of the rod's rigid motion at bent positions that are nearest to its own."""
    whole = fl.extend.Equations(rod(), dynamics=True)
    nodes = whole.unknowns.bodies[whole.scene.bodies[0]]
    return looking(rod(), bent).projected(np.zeros(9, dtype=int))[0][nodes]


def test_rigid_motion_needs_one_frame_and_a_bent_rod_more():
    look = looking(rod())
    none = look.active(1e-4)
    assert not none.any()
    assert len(np.unique(look.merged(none))) == 1
    bent = np.zeros((9, 6))
    bent[-1, 1] = 0.02
    root = looking(rod(), bent).merged(looking(rod(), bent).active(1e-4))
    assert 1 < len(np.unique(root)) < 9 or (root == np.arange(9)).all()


def test_projected_twists_have_the_same_momenta_and_the_reported_energy_loss():
    random = np.random.default_rng(2)
    look = looking(
        rod(), 0.02 * random.uniform(-1.0, 1.0, (9, 6)), random.uniform(-1.0, 1.0, (9, 6))
    )
    active = np.zeros(9, dtype=bool)
    active[4] = True
    root = look.merged(active)
    assert len(np.unique(root)) == 3
    v, lost = look.projected(root)
    before, after = look.v.ravel(), v.ravel()
    rigid = expansion(look.H, np.zeros(9, dtype=int))
    momenta = rigid.T @ (look.mass @ np.column_stack([before, after]))
    np.testing.assert_allclose(momenta[:, 1], momenta[:, 0], atol=1e-13 * np.abs(momenta).max())
    kinetic = 0.5 * after @ (look.mass @ after)
    assert lost > 0.1 * look.kinetic
    assert look.kinetic - kinetic == pytest.approx(lost, rel=1e-12)


@BOTH
def test_forces_are_the_gradient_of_an_energy(name):
    """Of some cells with any weights; so the matrix is symmetric."""
    _, basis, states = trained(name, 3)
    cells = ReducedCells(basis, np.array([0, 3, 17, 30]), np.array([2.0, 7.0, 0.5, 11.0]))
    η = states.coordinates[-1] * np.array([1.0, 0.8, 1.3])
    forces, K = cells.forces_and_matrix(η)
    step = 1e-5 * np.abs(η).max()
    found = [(cells.energy(η + d) - cells.energy(η - d)) / (2 * step) for d in step * np.eye(3)]
    np.testing.assert_allclose(found, forces, atol=1e-6 * np.abs(forces).max())
    slopes = [(cells.forces(η + d) - cells.forces(η - d)) / (2 * step) for d in step * np.eye(3)]
    np.testing.assert_allclose(slopes, K, atol=1e-6 * np.abs(K).max())
    np.testing.assert_allclose(K, K.T, atol=1e-11 * np.abs(K).max())


def test_forces_of_training_are_in_units_of_energy_and_each_state_counts_alike():
    """Of small deformations: products of their sums are those of the energy, over both norms."""
    _, basis, states = trained("beam", 3)
    cells = ReducedCells(basis, np.arange(40), np.ones(40))
    random, (_, K) = np.random.default_rng(4), cells.forces_and_matrix(np.zeros(3))
    η = 1e-5 * random.uniform(0.1, 1.0, (4, 1)) * random.normal(size=(4, 3)) / np.sqrt(K.diagonal())
    given = fl.reduction.ReducedStates(basis, states.rigid[:4], η, states.errors[:4])
    found = forces_of_training(cells, given).reshape(4, 3, 40).sum(axis=2)
    product = η @ K @ η.T
    sizes = np.sqrt(product.diagonal())
    np.testing.assert_allclose(found @ found.T, product / np.outer(sizes, sizes), atol=1e-3)
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), 1.0, rtol=1e-12)
    resting = fl.reduction.ReducedStates(
        basis, given.rigid, η * [[1.0], [0.0], [1.0], [1.0]], given.errors
    )
    np.testing.assert_array_equal(
        forces_of_training(cells, resting).reshape(3, 3, 40).sum(axis=2), found[[0, 2, 3]]
    )


@BOTH
def test_weights_are_positive_and_forces_those_of_training(name):
    _, basis, states = trained(name, 3)
    sizes = []
    for tolerance in (1e-2, 1e-4):
        sample = fl.reduction.ecsw(states, tolerance)
        assert sample.error <= tolerance
        assert (sample.weights > 0.0).all()
        assert (np.diff(sample.cells) > 0).all()
        sizes.append(len(sample.cells))
    count = len(basis.body.model.elastic_cells)
    assert sizes[0] < sizes[1] <= count // 2
    each = forces_of_training(ReducedCells(basis, np.arange(count), np.ones(count)), states)
    assert each.shape == (states.coordinates.size, count)
    missed = each[:, sample.cells] @ sample.weights - each.sum(axis=1)
    error = np.linalg.norm(missed) / np.linalg.norm(each.sum(axis=1))
    assert sample.error == pytest.approx(error, rel=1e-6)
