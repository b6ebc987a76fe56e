"""Scenes divided among ranks: parts add up to the whole, and results are those of one rank."""

import divided_scenes
import numpy as np
import pytest
from ranks import on_ranks

import fem_lie as fl
from fem_lie.parts.part_scene import connections_of, part_of

PARTS = 3


@pytest.fixture(scope="module")
def alone():
    return divided_scenes.results()


@pytest.mark.parametrize("ranks", [2, pytest.param(3, marks=pytest.mark.slow)])
def test_divided_scenes_have_the_results_of_one_rank(alone, tmp_path, ranks):
    out = tmp_path / "found.npz"
    on_ranks(divided_scenes, ranks, out)
    with np.load(out) as found:
        assert set(found.files) == set(alone)
        for name, expected in alone.items():
            size = np.abs(expected).max(initial=0.0)
            # reactions contain accelerations, with round-off of positions over the step squared
            allowed = 1e-9 if name.endswith("in motion, reactions") else 1e-10
            np.testing.assert_allclose(
                found[name], expected, rtol=0, atol=allowed * size, err_msg=name
            )


class Ranks:
    """Communicator of ranks that are asked one after the other."""

    def __init__(self, rank, given):
        self.rank, self.size, self._given = rank, PARTS, given

    def bcast(self, value):
        if self.rank == 0:
            self._given.append(value)
        return self._given[-1]


def parts(scene):
    given = []
    return [part_of(scene, Ranks(rank, given)) for rank in range(PARTS)]


@pytest.mark.parametrize("build", divided_scenes.MOTIONS.values(), ids=divided_scenes.MOTIONS)
def test_parts_have_all_nodes_and_no_rank_has_all(build):
    scene, _ = build()
    found = parts(scene)
    own = [np.unique(np.concatenate(list(part.nodes.values()))) for part in found]
    count = sum(len(body.frames) for body in scene.bodies)
    assert sorted(set(np.concatenate(own))) == list(range(count))
    assert max(map(len, own)) < count
    for rank, part in enumerate(found):
        for other, shared in part.sharers.items():
            np.testing.assert_array_equal(shared, found[other].sharers[rank])
            assert np.isin(shared, own[rank]).all() and np.isin(shared, own[other]).all()


@pytest.mark.parametrize("build", divided_scenes.MOTIONS.values(), ids=divided_scenes.MOTIONS)
def test_each_connection_and_each_point_load_is_in_one_part(build):
    scene, _ = build()
    found = parts(scene)
    numbers = np.concatenate([part.connections for part in found])
    assert sorted(numbers) == list(range(len(connections_of(scene))))
    at_points = [
        sum(isinstance(load, fl.PointLoad) for load in one.loads)
        for one in (scene, *(part.scene for part in found))
    ]
    assert at_points[0] == sum(at_points[1:])


def bodies():
    """Bodies that can be divided, by their names."""
    steel, thin = divided_scenes.STEEL, divided_scenes.ROUND
    layer = fl.ShellSection.layer(0.01, steel)
    folded = fl.mesh.parametric_surface(
        lambda a, b: (a, 0.2 * min(b, 0.5), 0.2 * max(0.0, b - 0.5)), (3, 4), cell="triangle"
    )
    tetrahedra = fl.mesh.brick((1, 1, 1), (1, 2, 2), cell="tetrahedron")
    return {
        "beam": fl.Beam.straight((0, 0, 0), (1, 0, 0), thin, cells=6),
        "beam with a corner": fl.Beam.polyline([(0, 0, 0), (1, 0, 0), (1, 1, 0)], thin, cells=2),
        "rod": fl.Rod.straight((0, 0, 0), (1, 0, 0), thin, cells=6),
        "cable": fl.Cable.straight((0, 0, 0), (1, 0, 0), thin, cells=6),
        "net": divided_scenes.net()[0].bodies[0],
        "shell": divided_scenes.sheet()[0].bodies[0],
        "folded shell": fl.Shell(folded, layer),
        "solid": divided_scenes.block()[0].bodies[0],
        "solid of tetrahedra": fl.Solid(
            tetrahedra, fl.sections.NeoHooke(E=1e6, nu=0.3, density=1e3), degree=2
        ),
    }


def forces_and_mass(model, frames):
    """Forces on all nodes at ``frames``, and the mass."""
    assembly = type(model).assemble([model])
    ordered, forces = np.empty_like(frames), np.zeros((len(frames), 6))
    ordered[assembly.order] = frames
    for term in (assembly, *assembly.further_terms):
        own = np.zeros_like(forces)
        term.add_forces(ordered, own)
        forces += own[assembly.order]
    return forces, assembly.inertia.mass[:, 0, 0].sum()


@pytest.mark.parametrize("name", bodies())
def test_forces_and_mass_of_parts_of_a_body_add_up(name):
    model, rng = bodies()[name].model, np.random.default_rng(1)
    frames = model.frames.copy()
    frames[:, 0] += 0.02 * model.size * rng.standard_normal((len(frames), 3))
    forces, mass = forces_and_mass(model, frames)
    found, found_mass = np.zeros_like(forces), 0.0
    cells = rng.integers(PARTS, size=len(model.divisible_cells))
    attached = np.flatnonzero(model.masters != np.arange(len(frames)))
    around = np.isin(model.divisible_cells, [*attached, *model.masters[attached]]).any(axis=1)
    cells[around] = 0
    for k in np.unique(cells):
        part, nodes = model.restricted(np.flatnonzero(cells == k), ())
        own, own_mass = forces_and_mass(part, frames[nodes])
        np.add.at(found, nodes, own)
        found_mass += own_mass
    np.testing.assert_allclose(found, forces, rtol=0, atol=1e-13 * np.abs(forces).max())
    assert found_mass == pytest.approx(mass, rel=1e-13)


def test_a_body_that_stays_in_one_piece_says_so():
    ball = fl.RigidBody(1.0, np.eye(3))
    with pytest.raises(ValueError, match="cannot be divided between cells"):
        ball.model.restricted(np.arange(1), ())
