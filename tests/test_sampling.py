"""Few cells with weights for all: forces of an energy, training, equilibria, refusals."""

import numpy as np
import pytest

import fem_lie as fl

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
    basis = fl.reduction.Basis(same, basis.modes)
    return scene, basis, basis.project(states, axes=FIXED)


@BOTH
def test_few_cells_have_the_equilibrium_of_all(name):
    scene, basis, states = trained(name, 4)
    count = len(basis.body.model.elastic_cells)
    every = fl.reduction.CellSample(basis, np.arange(count), np.ones(count), 0.0)
    full = fl.statics(scene)
    full = full.frames[-1, full.info.body(basis.body.name).nodes, 0]
    away = np.linalg.norm(full - basis.body.frames[:, 0], axis=1).max()
    assert 0.08 < away < 0.16
    for sample, tolerance in ((every, 1e-4), (fl.reduction.ecsw(states, 1e-4), 1e-2)):
        found = fl.reduction.sampled_statics(scene, sample, levels=(0.5, 1.0))
        assert found.frames.shape[0] == 2 and found.iterations.shape == (2,)
        assert 0 < found.iterations[0] < found.iterations[1]
        moved = found.displacement(basis.body.point(0))
        np.testing.assert_array_equal(moved, found.frames[:, 0, 0] - basis.body.frames[0, 0])
        error = np.linalg.norm(found.frames[-1, :, 0] - full, axis=1).max()
        assert error < tolerance * away


@pytest.mark.parametrize(("make", "wide"), [(rod, 6), (plate, 5)])
def test_all_cells_in_all_shapes_are_the_full_model(make, wide):
    scene, body = make(2e-3, 2)
    free = np.flatnonzero(body.frames[:, 0, 0] > 1e-12)
    shapes = np.zeros((len(free) * wide, len(body.frames), 6))
    shapes[:, free, :wide] = np.eye(len(shapes)).reshape(-1, len(free), wide)
    count = len(body.model.elastic_cells)
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
            empty, sample._replace(basis=fl.reduction.Basis(body, basis.modes))
        )
    surface.add(fl.loads.SurfacePressure(shell, 1.0))
    with pytest.raises(ValueError, match="other than nodal forces"):
        fl.reduction.sampled_statics(surface, of_shell)
    scene.add(fl.loads.Temperature(basis.body, 40.0, 1e-5))
    with pytest.raises(ValueError, match="other than nodal forces"):
        fl.reduction.sampled_statics(scene, sample)
    cable = fl.Cable.straight((0, 0, 0), (1, 0, 0), fl.Section.circle(0.01, RUBBER), cells=2)
    with pytest.raises(ValueError, match="individually"):
        cable.model.weighted_cells(np.arange(2), np.ones(2))
