"""Few cells with weights for all: forces of an energy, training, equilibria, refusals."""

import numpy as np
import pytest

import fem_lie as fl
from fem_lie.reduction.ecsw import ReducedCells, forces_of_training

RUBBER = fl.Material(E=5e6, nu=0.3, density=1100.0)
FIXED = fl.reduction.FixedAxes()


def rod(force, cells=40, **options):
    scene = fl.Scene()
    section = fl.Section.rectangle(0.01, 0.015, RUBBER)
    beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=cells, name="rod", **options)
    scene.add(beam)
    scene.add(fl.Clamp(beam.point("start")))
    if force:
        scene.add(fl.PointLoad(beam.point("end"), force=force * np.array([0.0, 1.0, 1.5])))
    return scene, beam


def plate(force, cells=6):
    scene = fl.Scene()
    mesh = fl.mesh.parametric_surface(lambda a, b: (a, 0.5 * b, 0.1 * a * b), (cells, cells))
    shell = scene.add(fl.Shell(mesh, fl.ShellSection.layer(0.01, RUBBER), name="plate"))
    shell.clamp("a=0")
    if force:
        scene.add(fl.PointLoad(shell.point("11"), force=(0, 0, force)))
    return scene, shell


SCENES = {"beam": (rod, 1.6e-3), "shell": (plate, 0.06)}
BOTH = pytest.mark.parametrize("name", SCENES)


def trained(name, modes, force=None):
    """A scene, shapes of its body from loads up to 1.2 times its own, and these states in them."""
    make, size = SCENES[name]
    training, body = make(1.2 * size)
    states = fl.statics(training, levels=np.linspace(0.1, 1.0, 8))
    basis = fl.reduction.pod(states, body, modes, axes=FIXED)
    scene, same = make(size if force is None else force)
    basis = fl.reduction.Basis(same, basis.shapes)
    return scene, basis, basis.project(states, axes=FIXED)


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
    count = len(basis.body.elastic_cells)
    assert sizes[0] < sizes[1] <= count // 2
    each = forces_of_training(ReducedCells(basis, np.arange(count), np.ones(count)), states)
    assert each.shape == (states.coordinates.size, count)
    missed = each[:, sample.cells] @ sample.weights - each.sum(axis=1)
    error = np.linalg.norm(missed) / np.linalg.norm(each.sum(axis=1))
    assert sample.error == pytest.approx(error, rel=1e-6)


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
def test_few_cells_have_the_equilibrium_of_all(name):
    scene, basis, states = trained(name, 4)
    count = len(basis.body.elastic_cells)
    every = fl.reduction.CellSample(basis, np.arange(count), np.ones(count), 0.0)
    full = fl.statics(scene)
    full = full.frames[-1, full.info.body(basis.body.name).nodes, 0]
    away = np.linalg.norm(full - basis.body.frames[:, 0], axis=1).max()
    assert 0.08 < away < 0.16
    for sample, tolerance in ((every, 1e-4), (fl.reduction.ecsw(states, 1e-4), 1e-2)):
        found = fl.reduction.sampled_statics(scene, sample, levels=(0.5, 1.0))
        assert found.frames.shape[0] == 2
        error = np.linalg.norm(found.frames[-1, :, 0] - full, axis=1).max()
        assert error < tolerance * away


@pytest.mark.parametrize(("make", "wide"), [(rod, 6), (plate, 5)])
def test_all_cells_in_all_shapes_are_the_full_model(make, wide):
    scene, body = make(2e-3, 2)
    free = np.flatnonzero(body.frames[:, 0, 0] > 1e-12)
    shapes = np.zeros((len(free) * wide, len(body.frames), 6))
    shapes[:, free, :wide] = np.eye(len(shapes)).reshape(-1, len(free), wide)
    count = len(body.elastic_cells)
    sample = fl.reduction.CellSample(
        fl.reduction.Basis(body, shapes), np.arange(count), np.ones(count), 0.0
    )
    full = fl.statics(scene)
    full = full.frames[-1, full.info.body(body.name).nodes, 0]
    found = fl.reduction.sampled_statics(scene, sample).frames[-1, :, 0]
    away = np.abs(full - body.frames[:, 0]).max()
    assert away > 1e-3
    np.testing.assert_allclose(found, full, atol=1e-6 * away)


def test_weight_and_follower_loads_act_as_on_all_cells():
    scene, basis, _ = trained("beam", 3, force=0.0)
    beam = basis.body
    scene.add(fl.PointLoad(beam.point("end"), force=(0.0, 5e-4, 1e-3), following=True))
    scene.add(fl.PointLoad(beam.point(20), moment=(0.0, 2e-5, 1e-5)))
    every = fl.reduction.CellSample(basis, np.arange(40), np.ones(40), 0.0)
    found = fl.reduction.sampled_statics(scene, every)
    wanted = fl.reduction.reduced_statics(scene, basis, load_steps=2)
    np.testing.assert_allclose(
        found.coordinates[0], wanted.coordinates, atol=1e-5 * np.abs(wanted.coordinates).max()
    )


def test_what_cannot_be_sampled_is_said():
    scene, basis, states = trained("beam", 2)
    with pytest.raises(ValueError, match="below 1"):
        fl.reduction.ecsw(states, 1.0)
    with pytest.raises(TypeError, match=r"basis\.project"):
        fl.reduction.ecsw(basis, 0.1)
    nothing = fl.reduction.ReducedStates(
        basis, states.rigid, np.zeros_like(states.coordinates), states.errors
    )
    with pytest.raises(ValueError, match="without forces"):
        fl.reduction.ecsw(nothing, 0.1)
    rigid = fl.reduction.Basis(basis.body, np.tile([1.0, 0, 0, 0, 0, 0], (1, 41, 1)))
    with pytest.raises(ValueError, match="rigid-body modes"):
        fl.reduction.ecsw(
            fl.reduction.ReducedStates(
                rigid, states.rigid, states.coordinates[:, :1], states.errors
            ),
            0.1,
        )
    sample = fl.reduction.ecsw(states, 1e-2)
    surface, shell = plate(0.06)
    of_shell = fl.reduction.CellSample(
        fl.reduction.Basis(shell, np.zeros((1, 49, 6))), np.arange(1), np.ones(1), 0.0
    )
    with pytest.raises(ValueError, match="not the body"):
        fl.reduction.sampled_statics(rod(1.0)[0], sample)
    with pytest.raises(ValueError, match="fixed nodes"):
        fl.reduction.sampled_statics(scene, sample._replace(basis=rigid))
    with pytest.raises(ValueError, match="levels must"):
        fl.reduction.sampled_statics(scene, sample, levels=())
    empty, body = rod(0.0)
    with pytest.raises(ValueError, match="no load"):
        fl.reduction.sampled_statics(
            empty, sample._replace(basis=fl.reduction.Basis(body, basis.shapes))
        )
    surface.add(fl.loads.SurfacePressure(shell, 1.0))
    with pytest.raises(ValueError, match="other than nodal forces"):
        fl.reduction.sampled_statics(surface, of_shell)
    scene.add(fl.loads.Temperature(basis.body, 40.0, 1e-5))
    with pytest.raises(ValueError, match="other than nodal forces"):
        fl.reduction.sampled_statics(scene, sample)
    cable = fl.Cable.straight((0, 0, 0), (1, 0, 0), fl.Section.circle(0.01, RUBBER), cells=2)
    with pytest.raises(ValueError, match="individually"):
        cable.weighted_cells(np.arange(2), np.ones(2))
