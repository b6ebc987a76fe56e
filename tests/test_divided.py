"""Scenes divided among ranks: parts add up to the whole, and results are those of one rank."""

from copy import copy
from dataclasses import replace

import divided_scenes
import dolfinx
import numpy as np
import pytest
from ranks import on_ranks

import fem_lie as fl

PARTS = 3


@pytest.fixture(scope="module")
def alone():
    return divided_scenes.results()


IN_TIME = ["rest", "motions", "explicit"]
IN_THREE = pytest.param(3, IN_TIME, marks=pytest.mark.slow)
"""Searches and refusals, with many small solutions, are slow where ranks share a core."""


@pytest.mark.parametrize(("ranks", "parts"), [(2, list(divided_scenes.PARTS)), IN_THREE])
def test_divided_scenes_have_the_results_of_one_rank(alone, tmp_path, ranks, parts):
    out = tmp_path / "found.npz"
    on_ranks(divided_scenes, ranks, out, *parts)
    wanted = {name: value for name, value in alone.items() if name.split(":")[0] in parts}
    with np.load(out) as found:
        assert set(found.files) == set(wanted)
        for name, expected in wanted.items():
            # angles and lengths of joints are small here, and have the round-off of radians
            least = 1.0 if name.endswith("joint coordinates") else 0.0
            size = np.abs(expected).max(initial=least)
            # they contain round-off of positions times the axial stiffness of cells
            of_reactions = name.endswith(("in motion, reactions", "in motion, impulses"))
            # residuals of vectors are the square roots of those of eigenvalues
            of_modes = name.endswith("amplitudes")
            # states at critical points are located to 1e-10, and branches depend on them
            located = name.startswith(("paths: arch", "paths: strut"))
            allowed = 1e-8 if of_reactions or of_modes or located else 1e-10
            # round-off of positions over a step, which stiff cells pass on from step to step
            if "in motion, velocity" in name:
                allowed = 1e-9
            np.testing.assert_allclose(
                found[name], expected, rtol=0, atol=allowed * size, err_msg=name
            )
    if "paths" in parts:
        goes_on_from_a_file(f"{out}.path", alone)


def goes_on_from_a_file(path, alone):
    """A path of several ranks goes on on one rank, which leaves it at its bifurcation."""
    run = fl.stability.EquilibriumPath.load(path)
    scene, points = divided_scenes.strut()
    first = run.bifurcations[0]
    start = fl.stability.switch_branch(scene, first)
    found = divided_scenes.branch(scene, points, start, first.factor)
    for name, values in found.items():
        np.testing.assert_allclose(values, alone[f"paths: strut, path, {name}"], rtol=0, atol=1e-8)


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
        "membrane": divided_scenes.sail()[0].bodies[0],
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


def loads():
    """Loads that are sums over cells, some on edges and faces between cells, by their names."""
    steel = divided_scenes.STEEL
    plate = fl.mesh.parametric_surface(lambda a, b: (a, b, 0.0), (4, 4))
    middle = np.flatnonzero(plate.points[:, 0] == 0.5)
    curve = {"middle": np.column_stack([middle[:-1], middle[1:]])}
    shell = fl.Shell(replace(plate, curves=curve), fl.ShellSection.layer(0.01, steel))
    box = fl.mesh.brick((1, 1, 2), (2, 2, 4))
    facets = dolfinx.mesh.locate_entities(box.mesh, 2, lambda x: np.isclose(x[2], 1.0))
    solid = fl.Solid(
        replace(box, faces={"middle": facets.astype(np.int64)}),
        fl.sections.NeoHooke(E=1e6, nu=0.3, density=1e3),
    )
    beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), divided_scenes.ROUND, cells=6)
    return {
        "edge between cells": (shell, lambda body: fl.loads.EdgeLoad(body, "middle", (0, 0, 1.0))),
        "area": (shell, lambda body: fl.AreaLoad(body, lambda x: (0, x[1], x[0]))),
        "face between cells": (solid, lambda body: fl.loads.FaceLoad(body, "middle", (0, 0, 1.0))),
        "volume": (solid, lambda body: fl.loads.BulkLoad(body, (0, 0, 1.0))),
        "line": (beam, lambda body: fl.LineLoad(body, force=(0, 1.0, 0))),
    }


@pytest.mark.parametrize("name", loads())
def test_loads_on_parts_of_a_body_add_up(name):
    body, load_on = loads()[name]
    expected = load_on(body).nodal()
    found, cells = np.zeros_like(expected), np.arange(len(body.model.divisible_cells)) % PARTS
    for k in range(PARTS):
        part = copy(body)
        part.model, nodes = body.model.restricted(np.flatnonzero(cells == k), ())
        np.add.at(found, nodes, load_on(part).nodal())
    assert np.abs(expected).max() > 0.0
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-14 * np.abs(expected).max())


def test_a_body_that_stays_in_one_piece_says_so():
    ball = fl.RigidBody(1.0, np.eye(3))
    with pytest.raises(ValueError, match="cannot be divided between cells"):
        ball.model.restricted(np.arange(1), ())
