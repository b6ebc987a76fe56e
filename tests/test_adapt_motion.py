"""Dynamics on meshes that follow the error, with steps that follow theirs."""

from itertools import pairwise

import numpy as np
import pytest

import fem_lie as fl
from demos import adaptive_wave

MATERIAL = fl.Material(E=2e8, nu=0.3, density=7800.0)
SECTION = fl.Section.rectangle(0.01, 0.01, MATERIAL)
CELLS = ["triangle", "quadrilateral"]
LINE = fl.mesh.straight_line((0, 0, 0), (1, 0, 0), 4)


def pendulum(mesh):
    scene = fl.Scene(gravity=(0, 0, -9.81))
    arm = scene.add(fl.Beam(mesh, SECTION, name="arm"))
    scene.add(fl.joints.Revolute(fl.ground(), arm.point("start"), axis=(0, 1, 0), name="hinge"))
    return scene


@pytest.fixture(scope="module")
def swung():
    return fl.adaptivity.adapt_motion(
        pendulum, LINE, duration=0.2, every=0.05, tolerance=0.1, size=1.0
    )


def test_momenta_are_kept_and_energy_as_good_as_the_tolerance(swung):
    assert len(swung.segments) == 4
    assert len(set(swung.cells)) > 1
    assert swung.momentum_error < 1e-12
    total = swung.kinetic + swung.elastic + swung.potential
    assert np.ptp(total) < 0.1**2 * np.abs(swung.potential).max()


def test_one_tolerance_for_space_and_time(swung):
    assert swung.space**2 + swung.time**2 == pytest.approx(swung.tolerance**2)
    assert max(part.error for part in swung.segments) <= swung.space
    assert "7.07 % in space, 7.07 % in time" in str(swung)


def test_one_array_for_what_all_meshes_have(swung):
    count = len(swung.times)
    assert swung.position("arm.end").shape == swung.momentum.shape == (count, 3)
    assert swung.angular_momentum.shape == (count, 3)
    assert swung.elastic.shape == swung.kinetic.shape == (count,)
    assert (np.diff(swung.times) >= 0).all()
    assert swung.times[-1] == pytest.approx(0.2)
    # the position of a point is continuous
    changes = np.flatnonzero(np.diff(swung.times) < 1e-12)
    assert len(changes) == 3
    gaps = np.diff(swung.position("arm.end"), axis=0)[changes]
    assert np.abs(gaps).max() < 1e-12
    start = swung.position("arm.end")[0] - swung.displacement("arm.end")[0]
    moved = swung.position("arm.end") - start
    np.testing.assert_allclose(swung.displacement("arm.end"), moved, atol=1e-12)
    assert swung.iterations.shape == (count,) and (np.diff(swung.iterations) >= 0).all()
    assert swung.iterations[-1] == sum(part.result.total_iterations for part in swung.segments)


def test_as_on_a_fine_mesh_with_small_steps(swung):
    fine = pendulum(fl.mesh.straight_line((0, 0, 0), (1, 0, 0), 64))
    result = fl.GeneralisedAlpha().run(fine, duration=0.2, step=5e-4)
    gap = swung.position("arm.end")[-1] - result.position("arm.end")[-1]
    assert np.linalg.norm(gap) < swung.tolerance * 1.0
    coarse = swung.element_steps
    assert coarse < 64 * 400 / 4


def test_what_is_small_beside_what_comes_needs_no_fine_mesh():
    given = {"duration": 0.1, "every": 0.05, "tolerance": 0.1, "size": 1.0}
    largest = fl.adaptivity.adapt_motion(pendulum, LINE, **given, least=1e3)
    assert (largest.cells == len(LINE.cells)).all()
    assert max(part.error for part in largest.segments) < 0.01


@pytest.mark.parametrize("cell", CELLS)
def test_a_shell(cell):
    """A flap that falls about its clamped edge, against equal cells."""

    def flap(mesh):
        scene = fl.Scene(gravity=(0, 0, -9.81))
        layer = fl.ShellSection.layer(0.01, fl.Material(E=2e7, nu=0.3, density=1000.0))
        scene.add(fl.Shell(mesh, layer, name="flap")).clamp("a=0")
        return scene

    def mesh(a, b):
        return fl.mesh.parametric_surface(lambda s, t: (0.5 * s, 0.2 * t, 0.0), (a, b), cell=cell)

    found = fl.adaptivity.adapt_motion(
        flap, mesh(3, 1), duration=0.1, every=0.05, tolerance=0.3, size=0.5
    )
    assert len(set(found.cells)) > 1
    assert found.momentum_error < 1e-12
    fine = fl.GeneralisedAlpha().run(flap(mesh(12, 5)), duration=0.1, step=2e-3)
    gap = found.position("flap.10")[-1] - fine.position("flap.10")[-1]
    assert np.linalg.norm(gap) < 0.1 * found.tolerance * 0.5


@pytest.mark.parametrize("cell", CELLS)
def test_cells_follow_a_wave(cell):
    """A pulse of tension in a free strip: small cells where it is, large ones where it was."""

    def strip(mesh):
        scene = fl.Scene()
        layer = fl.ShellSection.layer(0.1, fl.Material(E=1.0, nu=0.0, density=1.0))
        shell = scene.add(fl.Shell(mesh, layer, name="strip"))
        pulse = fl.loads.EdgeLoad(
            shell,
            "a=0",
            force=(1e-4, 0.0, 0.0),
            history=lambda t: np.sin(2 * np.pi * t) ** 2 * (t < 0.5),
        )
        scene.add(pulse)
        return scene

    mesh = fl.mesh.parametric_surface(lambda a, b: (3 * a, 0.25 * b, 0.0), (12, 1), cell=cell)
    found = fl.adaptivity.adapt_motion(
        strip, mesh, duration=2.0, every=0.5, tolerance=0.3, size=2.5e-4, ahead=0.5
    )
    centres = [part.mesh.centres[:, 0] for part in found.segments]
    first, second, _ = np.array([np.histogram(x, [0, 1, 2, 3])[0] for x in centres]).T
    assert first[-1] < 0.7 * first.max(), "cells are coarsened"
    assert second[-1] > 10 * second[0], "and refined"
    assert found.momentum_error < 1e-12
    # the impulse of the pulse, but for the error of the steps
    assert found.momentum[-1, 0] == pytest.approx(1e-4 * 0.25 * 0.25, rel=1e-2)
    energy = (found.kinetic + found.elastic)[-1]
    assert abs(found.energy_change) < 0.1 * found.tolerance * energy


def test_a_cable_in_motion():
    """Momenta are those of gravity alone over all meshes."""

    def thrown(mesh):
        scene = fl.Scene(gravity=(0, 0, -9.81))
        section = fl.Section.from_stiffness([1e5, 1e5, 1e5, 10.0, 10.0, 10.0], mass=2.0)
        rope = scene.add(fl.Cable(mesh, section, name="rope"))
        rope.add_velocity((3.0, 0.0, 4.0), omega=(0.0, 20.0, 0.0), about=(0, 0, 0))
        scene.add(fl.PointLoad(rope.point("end"), force=(0.0, 40.0, 0.0)))
        return scene

    line = fl.mesh.straight_line((0, 0, 0), (1, 0, 0), 2)
    found = fl.adaptivity.adapt_motion(
        thrown, line, duration=0.04, every=0.01, tolerance=0.2, size=1.0
    )
    assert len(set(found.cells)) > 1, "the mesh has changed"
    assert found.momentum_error < 1e-12
    results = [part.result for part in found.segments]
    for before, after in pairwise(results):
        np.testing.assert_allclose(after.momentum[0], before.momentum[-1], rtol=1e-12, atol=1e-12)
    # variable steps of the scheme keep momenta to 1e-6
    pushed = np.array([0.0, 40.0, -2.0 * 9.81]) * 0.04
    np.testing.assert_allclose(found.momentum[-1] - found.momentum[0], pushed, atol=1e-4)


def never(mesh):
    pytest.fail("a scene was made")


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"tolerance": 0.0}, "tolerance"),
        ({"tolerance": float("nan")}, "tolerance"),
        ({"duration": -1.0}, "duration"),
        ({"every": 0.0}, "every"),
        ({"size": 0.0}, "size"),
        ({"space_fraction": 1.0}, "space_fraction"),
        ({"ahead": -0.1}, "ahead"),
        ({"least": -1.0}, "least"),
        ({"most": 0}, "most"),
    ],
)
def test_bad_numbers(wrong, message):
    """Before anything is made."""
    given = {"duration": 1.0, "every": 0.1, "tolerance": 0.1, "size": 1.0} | wrong
    with pytest.raises(ValueError, match=message):
        fl.adaptivity.adapt_motion(never, LINE, **given)


def test_what_cannot_be_refined():
    curved = fl.mesh.parametric_surface(lambda a, b: (a, b, 0.0), (2, 2), degree=2)
    given = {"duration": 1.0, "every": 0.1, "tolerance": 0.1, "size": 1.0}
    with pytest.raises(ValueError, match="cells of degree 1"):
        fl.adaptivity.adapt_motion(never, curved, **given)
    with pytest.raises(TypeError, match="mesh"):
        fl.adaptivity.adapt_motion(never, "line", **given)
    with pytest.raises(ValueError, match="build must make one beam, cable or shell"):
        fl.adaptivity.adapt_motion(lambda mesh: fl.Scene(), LINE, **given)


def test_more_elements_than_are_allowed():
    with pytest.raises(fl.ConvergenceError, match="more than 5") as caught:
        fl.adaptivity.adapt_motion(
            pendulum, LINE, duration=0.1, every=0.05, tolerance=0.01, size=1.0, most=5
        )
    assert caught.value.result is None


def test_demo():
    """A third of the way: with as many elements as the wave takes, and none where it is not."""
    record = adaptive_wave.main(duration=3e-4, tolerance=0.2, compare=False, pictures=False)
    assert record["error"] < 3 * record["tolerance"]
    assert record["momentum_error"] < 1e-12
    assert record["cells"][1] < 150
