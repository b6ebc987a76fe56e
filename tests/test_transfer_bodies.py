"""States on other meshes of all bodies: momenta, energy, rigid and homogeneous motions."""

from collections.abc import Callable

import numpy as np
import pytest

import fem_lie as fl
from fem_lie import lie
from tests.test_mixed_surfaces import mixed

SOFT = fl.Material(E=2.1e9, nu=0.3, density=7800.0)
TUBE = fl.Section.circle(0.02, SOFT)
THIN, THICK = (fl.ShellSection.layer(t, SOFT) for t in (0.01, 0.05))
MIXED = 7  # nodes without a position of their own
RUBBER = fl.sections.NeoHooke(1e8, 0.3, 1000.0)


def arc(s):
    return np.sin(2 * s), 0.1 * s, 1 - np.cos(2 * s)


def bump(a, b):
    return np.array([a, b, 0.2 * np.sin(2 * a)])


def surface(*cells, cell="quadrilateral"):
    return fl.mesh.parametric_surface(bump, cells, cell=cell)


def patches(*cells):
    return fl.mesh.spline_mesh(fl.mesh.smooth_patch(bump, cells))


def partly_refined(mesh):
    return fl.adaptivity.refine(mesh, [0, 3])


def net(parts):
    """Threads on the lines 0, 1, 2 along x and y, with some edges between two crossings."""
    lines, knots, cables = range(3), {}, []
    along = np.linspace(0.0, 2.0, 2 * parts + 1)
    for x in lines:
        for places in ([(x, y) for y in along], [(y, x) for y in along]):
            cables.append([knots.setdefault(place, len(knots)) for place in places])
    return fl.Net([(x, y, 0.1 * x * y) for x, y in knots], cables, TUBE)


def solid(cells, degree, cell):
    return fl.Solid(fl.mesh.brick((1.0, 0.3, 0.2), cells, cell=cell), RUBBER, degree=degree)


LINE, SQUARES, PATCHES = fl.mesh.curve(arc, 8), surface(3, 3), patches(3, 3)
DISCRETE = fl.elements.DiscreteCable()
BODIES: dict[str, tuple[Callable[[], fl.extend.Body], Callable[[], fl.extend.Body], float]] = {
    "cable, another mesh": (
        lambda: fl.Cable(LINE, TUBE),
        lambda: fl.Cable.curve(arc, TUBE, cells=11),
        1e-2,
    ),
    "cable, made coarse": (
        lambda: fl.Cable(partly_refined(LINE), TUBE),
        lambda: fl.Cable(LINE, TUBE),
        2e-2,
    ),
    "discrete cable": (
        lambda: fl.Cable(LINE, TUBE, formulation=DISCRETE),
        lambda: fl.Cable(fl.mesh.curve(arc, 16), TUBE, formulation=DISCRETE),
        2e-2,
    ),
    "spline cable": (
        lambda: fl.SplineCable.circle((0, 0, 0), 1.0, (0, 0, 1), TUBE, cells=8),
        lambda: fl.SplineCable.circle((0, 0, 0), 1.0, (0, 0, 1), TUBE, cells=11),
        1e-2,
    ),
    "net": (lambda: net(1), lambda: net(2), 1e-2),
    "quadrilaterals, refined": (
        lambda: fl.Shell(SQUARES, THIN),
        lambda: fl.Shell(partly_refined(SQUARES), THIN),
        1e-3,
    ),
    "quadrilaterals, another mesh": (
        lambda: fl.Shell(SQUARES, THIN),
        lambda: fl.Shell(surface(4, 5), THIN),
        1e-2,
    ),
    "triangles of degree 2": (
        lambda: fl.Shell(fl.mesh.parametric_surface(bump, (2, 2), cell="triangle", degree=2), THIN),
        lambda: fl.Shell(fl.mesh.parametric_surface(bump, (3, 3), cell="triangle", degree=2), THIN),
        1e-2,
    ),
    "mixed cells": (
        lambda: fl.Shell(mixed(SQUARES), THIN),
        lambda: fl.Shell(mixed(surface(4, 4)), THIN),
        1e-2,
    ),
    "thin shell, refined": (
        lambda: fl.ThinShell(PATCHES, THIN),
        lambda: fl.ThinShell(fl.adaptivity.refine(PATCHES, [0, 4]), THIN),
        1e-5,
    ),
    "thin shell, another mesh": (
        lambda: fl.ThinShell(PATCHES, THIN),
        lambda: fl.ThinShell(patches(4, 5), THIN),
        1e-4,
    ),
    "ANCF shell": (
        lambda: fl.AncfShell(PATCHES, THICK),
        lambda: fl.AncfShell(patches(4, 5), THICK),
        1e-3,
    ),
    "ANCF beam": (
        lambda: fl.AncfBeam(LINE, TUBE),
        lambda: fl.AncfBeam(partly_refined(LINE), TUBE),
        1e-3,
    ),
    "membrane": (
        lambda: fl.Membrane(SQUARES, THIN),
        lambda: fl.Membrane(surface(4, 5), THIN),
        1e-2,
    ),
    "hexahedra": (
        lambda: solid((3, 2, 2), 1, "hexahedron"),
        lambda: solid((4, 2, 3), 1, "hexahedron"),
        1e-2,
    ),
    "tetrahedra of degree 2": (
        lambda: solid((2, 1, 1), 2, "tetrahedron"),
        lambda: solid((3, 1, 2), 2, "tetrahedron"),
        1e-2,
    ),
}


def thrown(body: fl.extend.Body) -> fl.Scene:
    """Free, spinning about no axis of its own."""
    body.name = "body"
    scene = fl.Scene()
    scene.add(body)
    body.add_velocity(omega=(3.0, -2.0, 5.0), about=(0.2, 0.1, 0.0))
    body.add_velocity((1.0, 2.0, -3.0))
    return scene


@pytest.mark.parametrize("name", BODIES)
def test_momenta_and_energy(name):
    """The next motion begins with the momenta that the last one ended with."""
    first, second, lost = BODIES[name]
    before, after = thrown(first()), thrown(second())
    scheme = fl.GeneralisedAlpha()
    result = scheme.run(before, duration=4e-4, step=1e-4)
    changes = fl.adaptivity.transfer(result, before, after)
    assert changes.momentum_error < 1e-12
    total = result.kinetic[-1] + result.elastic[-1]
    assert abs(changes.energy_change) < lost * total
    again = scheme.run(after, duration=1e-4, step=1e-4)
    np.testing.assert_allclose(again.momentum[0], result.momentum[-1], rtol=1e-12)
    np.testing.assert_allclose(again.angular_momentum[0], result.angular_momentum[-1], rtol=1e-12)
    assert again.kinetic[0] == pytest.approx(changes.kinetic[1], rel=1e-12)


@pytest.mark.parametrize("name", BODIES)
def test_rigid_motions_are_transferred_exactly(name):
    """Rotated by more than a right angle, with the velocities of a rigid motion."""
    first, second, _ = BODIES[name]
    (old, new, other), turn = (first(), second(), second()), lie.so3_exp((1.0, -1.5, 0.7))
    motion = {"velocity": (0.4, 0.1, -0.3), "omega": (2.0, -1.0, 0.5), "about": (0, 0, 0)}
    moved = old.frames @ turn.T
    update = old.model.axes_update()
    if update is not None:
        update(moved)
    old.model.start_frames = moved
    scenes = fl.Scene(), fl.Scene()
    for scene, body in zip(scenes, (old, new), strict=True):
        body.name = "body"
        scene.add(body)
    old.add_velocity(**motion)
    result = fl.GeneralisedAlpha().run(scenes[0], duration=1e-11, step=1e-11)
    changes = fl.adaptivity.transfer(result, *scenes)
    found = new.model.start_frames
    positions = new.model.node_types != MIXED
    wanted = new.frames[positions, 0] @ turn.T
    np.testing.assert_allclose(found[positions, 0], wanted, atol=2e-10)
    if "cable" not in name:  # these are bent where they begin
        assert changes.elastic[1] < 1e-12 * changes.kinetic[1]
    # momenta are kept, and the inertia of curved bodies is that of their meshes
    other.model.start_frames = found
    other.add_velocity(**motion)
    speed = np.abs(other.velocities).max()
    np.testing.assert_allclose(new.velocities, other.velocities, atol=0.02 * speed)


def test_statics_restarts_on_another_mesh():
    """A cable that sags under its weight, to the state of the finer mesh."""

    def hanging(cells):
        scene = fl.Scene(gravity=(0, 0, -9.81))
        rope = scene.add(
            fl.Cable.straight((0, 0, 0), (1, 0, 0), TUBE, cells=cells, length=0.99, name="rope")
        )
        rope.pin(rope.point("start"), rope.point("end"))
        scene.add(fl.PointLoad(rope.point((0.5, 0, 0)), force=(0, 0, -100.0)))
        return scene

    coarse, fine, direct = hanging(4), hanging(8), hanging(8)
    half = fl.statics(coarse, levels=[0.5])
    fl.adaptivity.transfer(half, coarse, fine)
    there, wanted = fl.statics(fine, levels=[1.0]), fl.statics(direct)
    np.testing.assert_allclose(there.frames[-1, :, 0], wanted.frames[-1, :, 0], atol=1e-8)


def test_rates_of_gradients_are_those_of_the_last_state():
    """Earlier states and files do not have them."""
    first, second, _ = BODIES["cable, another mesh"]
    before, after = thrown(first()), thrown(second())
    result = fl.GeneralisedAlpha().run(before, duration=2e-4, step=1e-4)
    with pytest.raises(ValueError, match="body has position gradients"):
        fl.adaptivity.transfer(result, before, after, state=0)
    with pytest.raises(ValueError, match="only the last state"):
        fl.adaptivity.transfer(result.resampled(result.times), before, after)


def test_bodies_on_other_lines_are_refused():
    first, _, _ = BODIES["cable, another mesh"]
    before, after = thrown(first()), thrown(fl.Cable.straight((0, 0, 0), (5, 0, 0), TUBE, cells=3))
    result = fl.GeneralisedAlpha().run(before, duration=1e-4, step=1e-4)
    with pytest.raises(ValueError, match="meshes of the same line"):
        fl.adaptivity.transfer(result, before, after)
