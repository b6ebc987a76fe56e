"""Paths of equilibrium on meshes that follow the error."""

import numpy as np
import pytest

import fem_lie as fl

SECTION = fl.Section.from_stiffness([1e7, 5e6, 5e6, 1e6, 2e6, 1e6])
LINE = fl.mesh.straight_line((0, 0, 0), (10, 0, 0), 2)
LEVELS = [0.02, 0.2, 0.6, 1.0]


def cantilever(mesh):
    """Bent far by the last load."""
    scene = fl.Scene()
    beam = scene.add(fl.Beam(mesh, SECTION, formulation=fl.elements.GeodesicBeam(), name="beam"))
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), force=(0, 0, 4e5)))
    return scene


def strip(mesh):
    """A cantilever of shell cells."""
    scene = fl.Scene()
    layer = fl.ShellSection.layer(0.05, fl.Material(1e6, 0.0, 1.0))
    shell = scene.add(fl.Shell(mesh, layer, name="strip"))
    shell.clamp("a=0")
    scene.add(fl.loads.EdgeLoad(shell, "a=1", force=(0.0, 0.0, 2.0)))
    return scene


def test_it_is_the_path_on_a_fine_mesh():
    found = fl.adaptivity.adapt_loads(cantilever, LINE, LEVELS, tolerance=0.05)
    fine = cantilever(fl.mesh.straight_line((0, 0, 0), (10, 0, 0), 128))
    tips = fl.follow_loads(fine, LEVELS).displacement("beam.end")
    size = np.linalg.norm(tips, axis=1)
    assert (np.linalg.norm(found.displacement("beam.end") - tips, axis=1) < 0.05**2 * size).all()
    np.testing.assert_allclose(found.factors, LEVELS)
    away = found.position("beam.end") - found.displacement("beam.end")
    np.testing.assert_allclose(away, np.tile([10.0, 0.0, 0.0], (len(LEVELS), 1)), atol=1e-12)
    assert found.iterations[-1] == sum(part.result.total_iterations for part in found.segments)
    assert (found.relative <= 0.05).all()
    assert len(set(found.cells)) > 1, "the mesh has changed"
    assert found.segments[-1].change is not None
    assert found.solved < 3 * len(LEVELS)
    # the next increment starts from the last state
    again = fl.follow_loads(cantilever(found.segments[-1].mesh)).displacement("beam.end")[-1]
    np.testing.assert_allclose(found.displacement("beam.end")[-1], again, rtol=1e-8)


def test_through_a_limit_point():
    """A shallow arch that snaps through between two load factors, on meshes of its own."""

    soft = fl.Section.from_stiffness([1e7, 5e6, 5e6, 1e6, 2e5, 1e6])

    def arch(mesh):
        scene = fl.Scene()
        beam = scene.add(fl.Beam(mesh, soft, name="arch"))
        for end in ("start", "end"):
            scene.add(fl.Clamp(beam.point(end)))
        scene.add(fl.LineLoad(beam, force=(0.0, 0.0, -3e4)))
        return scene

    def above(x):
        return np.array([x[0], 0.0, 0.4 * x[0] * (1 - x[0] / 10)])

    def line(cells):
        return fl.mesh.curve(lambda s: above([10 * s]), cells)

    with pytest.warns(fl.stability.UnstableEquilibriumWarning, match="maximum"):
        found = fl.adaptivity.adapt_loads(arch, line(4), [0.1, 1.0], tolerance=0.05, onto=above)
    with pytest.warns(fl.stability.UnstableEquilibriumWarning, match="maximum"):
        fine = fl.follow_loads(arch(line(64)), [0.1, 1.0])
    assert fine.load_maxima, "there is a limit point"
    for part, true in zip(found.segments, fine.frames, strict=True):
        low, lowest = (frames[:, 0, 2].min() for frames in (part.result.frames[-1], true))
        assert low == pytest.approx(lowest, abs=0.02)
    assert fine.frames[1, 32, 0, 2] < -1.0


@pytest.mark.parametrize("cell", ["triangle", "quadrilateral"])
def test_shells(cell):
    def mesh(a, b):
        return fl.mesh.parametric_surface(lambda s, t: (2 * s, 0.5 * t, 0.0), (a, b), cell=cell)

    found = fl.adaptivity.adapt_loads(strip, mesh(2, 1), [0.2, 0.6, 1.0], tolerance=0.2)
    fine = fl.follow_loads(strip(mesh(48, 12)), [0.2, 0.6, 1.0])
    for name in ("strip.10", "strip.11"):
        gap = found.displacement(name) - fine.displacement(name)
        size = np.linalg.norm(fine.displacement(name), axis=1)
        assert (np.linalg.norm(gap, axis=1) < 0.2**2 * size).all()
    assert (found.relative <= 0.2).all()
    assert found.cells[-1] > len(mesh(2, 1).cells)
    changes = [part.change for part in found.segments if part.change]
    assert all(abs(each.energy_change) < 1e-2 * each.elastic[0] for each in changes)


def test_thin_shells():
    """The state goes from mesh to mesh, which grows as the strip bends."""

    def held(mesh):
        scene = fl.Scene()
        layer = fl.ShellSection.layer(0.05, fl.Material(1e6, 0.0, 1.0))
        shell = scene.add(fl.ThinShell(mesh, layer, name="strip"))
        shell.clamp("a=0")
        scene.add(fl.loads.EdgeLoad(shell, "a=1", force=(0.0, 0.0, 2.0)))
        return scene

    def mesh(a, b):
        patch = fl.mesh.smooth_patch(lambda s, t: (2 * s, 0.5 * t, 0.0), (a, b))
        return fl.mesh.spline_mesh(patch)

    found = fl.adaptivity.adapt_loads(held, mesh(2, 1), [0.1, 1.0], tolerance=5e-3)
    fine = fl.follow_loads(held(mesh(16, 4)), [0.1, 1.0])
    assert found.cells[-1] > found.cells[0]
    assert found.segments[-1].change is not None
    gap = np.linalg.norm(found.displacement("strip.10") - fine.displacement("strip.10"), axis=1)
    assert (gap < 5e-4 * np.linalg.norm(fine.displacement("strip.10"), axis=1)).all()


def test_as_many_elements_as_are_allowed():
    with pytest.raises(fl.ConvergenceError, match="more than 20") as caught:
        fl.adaptivity.adapt_loads(cantilever, LINE, LEVELS, tolerance=0.05, most=20)
    assert caught.value.result is None or (caught.value.result.cells <= 20).all()


def never(mesh):
    pytest.fail("a scene was made")


@pytest.mark.parametrize("tolerance", [0.0, -1.0, float("nan")])
def test_a_tolerance_that_is_none(tolerance):
    with pytest.raises(ValueError, match="tolerance"):
        fl.adaptivity.adapt_loads(never, LINE, LEVELS, tolerance=tolerance)


@pytest.mark.parametrize("most", [0, -3])
def test_no_elements_at_all(most):
    with pytest.raises(ValueError, match="most"):
        fl.adaptivity.adapt_loads(never, LINE, LEVELS, tolerance=0.1, most=most)


def test_what_was_solved_is_counted():
    """One equilibrium for each load factor where the mesh is fine enough."""
    line = fl.mesh.straight_line((0, 0, 0), (10, 0, 0), 16)
    found = fl.adaptivity.adapt_loads(cantilever, line, [0.01, 0.02], tolerance=0.5)
    assert found.solved == len(found.segments) == 2
    assert (found.cells == 16).all()


@pytest.mark.parametrize("levels", [[], [0.5, 0.2], [-1.0]])
def test_levels_that_do_not_grow(levels):
    with pytest.raises(ValueError, match="load factors must be positive and increase"):
        fl.adaptivity.adapt_loads(never, LINE, levels, tolerance=0.1)


def test_what_is_not_followed():
    curved = fl.mesh.parametric_surface(lambda a, b: (a, b, 0.0), (2, 2), degree=2)
    with pytest.raises(ValueError, match="cells of degree 1"):
        fl.adaptivity.adapt_loads(never, curved, LEVELS, tolerance=0.1)

    def warm(mesh):
        scene = cantilever(mesh)
        scene.add(fl.loads.Temperature(scene.bodies[0], 40.0, 1e-5))
        return scene

    with pytest.raises(ValueError, match="in proportion"):
        fl.adaptivity.adapt_loads(warm, LINE, LEVELS, tolerance=0.1)
