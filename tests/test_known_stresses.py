"""Errors of cables, ANCF bodies and solids against problems whose stress is known."""

from dataclasses import replace

import numpy as np
import pytest

import fem_lie as fl
from benchmarks import known_stresses as known
from fem_lie import lie


def within(row):
    return 0.8 < row.effectivity < 1.25


@pytest.mark.parametrize("problem", known.TIP)
@pytest.mark.parametrize("kind", known.LINES)
def test_lines(kind, problem):
    found = [known.line(kind, problem, cells) for cells in (8, 16)]
    assert all(map(within, found))
    order = np.log2(found[0].error / found[1].error)
    assert order == pytest.approx(1.0 if kind == "ancf_beam" else 2.0, abs=0.1)


@pytest.mark.parametrize("kind", known.PLATES)
def test_plates(kind):
    assert within(known.plate(kind, 6))


@pytest.mark.parametrize(("kind", "cells"), [(k, counts[1]) for k, counts in known.SOLIDS.items()])
def test_solids(kind, cells):
    assert within(known.solid(*kind, min(cells, 8 if kind[0] == "tetrahedron" else 6)))


def test_a_solid_that_is_inflated():
    assert within(known.tube(5))


def cable(cells=6, formulation=None):
    """A cable that sags, clamped at its start."""
    section = fl.Section.from_stiffness([1e6, 1e5, 1e5, 10.0, 10.0, 10.0])
    mesh = fl.mesh.straight_line((0, 0, 0), (2, 0, 0), cells)
    scene = fl.Scene()
    rope = scene.add(fl.Cable(mesh, section, formulation=formulation, name="rope"))
    rope.clamp(rope.point("start"))
    scene.add(fl.PointLoad(rope.point("end"), force=(1.0, 3.0, -8.0)))
    return scene


def beam():
    """An ANCF beam under a force."""
    section = fl.Section.circle(0.02, fl.Material(2e11, 0.3, 7800.0))
    scene = fl.Scene()
    own = scene.add(fl.AncfBeam.straight((0, 0, 0), (1, 0, 0), section, cells=5))
    own.clamp(own.point("start"))
    scene.add(fl.PointLoad(own.point("end"), force=(0.0, 30.0, 900.0)))
    return scene


def shell():
    """A thick ANCF shell under pressure."""
    patch = fl.mesh.smooth_patch(lambda a, b: (a, b, 0.2 * a * a), (4, 3))
    scene = fl.Scene()
    own = scene.add(fl.AncfShell(patch, fl.ShellSection.layer(0.4, fl.Material(1e6, 0.3, 1e3))))
    own.clamp("a=0")
    scene.add(fl.AreaLoad(own, (0.0, 20.0, 1000.0)))
    return scene


def block():
    """A solid under a force."""
    scene = fl.Scene()
    own = scene.add(fl.Solid.brick((2, 1, 1), fl.sections.NeoHooke(1e6, 0.3), cells=(4, 2, 2)))
    own.clamp("a=0")
    scene.add(fl.PointLoad(own.point("a=1"), force=(0.0, 1e3, 1e4)))
    return scene


SCENES = (cable, beam, shell, block)
each_scene = pytest.mark.parametrize("build", SCENES, ids=lambda build: build.__name__)


@each_scene
def test_rigid_motion_adds_nothing(build):
    scene = build()
    (body,) = scene.bodies
    result = fl.statics(scene, load_steps=2)
    H = lie.se3_exp(np.array([3.0, -2.0, 5.0, 0.4, -1.1, 0.8]))
    R, frames = H[1:].T, np.array(result.frames)
    frames[-1] = frames[-1] @ R.T
    frames[-1, :, 0] += H[0]
    moved = replace(result, frames=frames)
    a, b = (fl.adaptivity.space_error(found, body, scene) for found in (result, moved))
    np.testing.assert_allclose(b.squares, a.squares, rtol=1e-6, atol=1e-8 * a.squares.max())
    assert 0.0 < a.relative < 1.0


@each_scene
def test_pictures(build, tmp_path):
    scene = build()
    error = fl.adaptivity.space_error(fl.statics(scene), scene.bodies[0], scene)
    error.picture(tmp_path / "error.png")
    assert (tmp_path / "error.png").stat().st_size > 5000


@each_scene
def test_the_norm_is_twice_the_energy(build):
    """The stress of the elements is that of their energy.

    Those of ANCF have the energy of linear moments, too, which their constant stress has not.
    """
    scene = build()
    result = fl.statics(scene, load_steps=2)
    model = scene.bodies[0].model
    error = fl.adaptivity.space_error(result, scene.bodies[0], scene)
    term = model.assemble([model])
    H = np.empty_like(result.frames[-1])
    H[term.order] = result.frames[-1]
    assert error.energy == pytest.approx(2 * term.energy(H), rel=0.04)


def test_sections_that_differ_are_not_mixed():
    """Stress jumps between halves that are stretched alike, and a constant one in each is exact."""
    soft, stiff = (fl.sections.SaintVenantKirchhoff(E, 0.0) for E in (1e6, 5e6))
    mesh = fl.mesh.brick((2, 1, 1), (4, 2, 2))
    corners = mesh.mesh.geometry.x[mesh.mesh.geometry.dofmap][..., 1]
    left = corners.mean(axis=1) < 0.5
    halves = {"soft": np.flatnonzero(left), "stiff": np.flatnonzero(~left)}
    mesh, scene = replace(mesh, groups=halves), fl.Scene()
    bar = scene.add(fl.Solid(mesh, {"soft": soft, "stiff": stiff}))
    for face, normal in (("a=0", (1, 0, 0)), ("b=0", (0, 1, 0)), ("c=0", (0, 0, 1))):
        bar.roller(face, normal)
    scene.add(fl.loads.FaceLoad(bar, "a=1", lambda x: (1.0 if x[1] < 0.5 else 5.0, 0.0, 0.0)))
    assert fl.adaptivity.space_error(fl.statics(scene), bar, scene).relative < 1e-5


def test_cables_of_straight_pieces_are_refused():
    scene = cable(formulation=fl.elements.DiscreteCable())
    result = fl.statics(scene, load_steps=4)
    with pytest.raises(ValueError, match="cables of cubics, those of rope are DiscreteCable"):
        fl.adaptivity.space_error(result, scene.bodies[0], scene)


def test_goals_are_refused():
    scene = cable()
    goal = fl.adaptivity.PointDisplacementGoal("rope.end", (0, 0, 1))
    with pytest.raises(ValueError, match="for Beams and Shells, rope is a Cable"):
        fl.adaptivity.goal_error(fl.statics(scene), scene.bodies, scene, goal)
