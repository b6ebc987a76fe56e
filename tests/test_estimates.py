"""Estimates of the error in space beside recovered stress: laws that all of them keep."""

from dataclasses import replace

import numpy as np
import pytest

import fem_lie as fl
from benchmarks import effectivity
from demos import hemisphere
from fem_lie import lie

SECTION = fl.Section.from_stiffness([1e7, 5e6, 5e6, 1e6, 2e6, 1e6])
MATERIAL = fl.Material(1e6, 0.3, 1.0)
ESTIMATES = list(effectivity.ESTIMATES)
TWISTING = 1e-6  # force, N
CELLS = ["triangle", "quadrilateral"]
each_estimate = pytest.mark.parametrize("estimate", ESTIMATES, ids=repr)
each_cell = pytest.mark.parametrize("cell", CELLS)
each_of_beams = pytest.mark.parametrize(
    ("estimate", "formulation"),
    [
        (estimate, formulation)
        for estimate in ESTIMATES
        for formulation in (
            fl.elements.GeodesicBeam(),
            fl.elements.DirectorBeam(1),
            fl.elements.DirectorBeam(2),
        )
        if not (
            isinstance(estimate, fl.adaptivity.HierarchicalEstimate) and formulation.degree == 2
        )
    ],
    ids=repr,
)


def sheet(cell, force, cells=4, turn=None):
    """A square held at one side, with a load along the other, turned as a whole."""
    R = np.eye(3) if turn is None else turn
    mesh = fl.mesh.parametric_surface(
        lambda a, b: R @ (a, b, 0.1 * a * b), (cells, cells), cell=cell
    )
    scene = fl.Scene()
    shell = scene.add(fl.Shell(mesh, fl.ShellSection.layer(0.1, MATERIAL), name="sheet"))
    shell.clamp("a=0")
    scene.add(fl.loads.EdgeLoad(shell, "a=1", force=R @ force))
    return scene


def cantilever(formulation, turn=None, force=(0, 2e3, 3e4)):
    """Clamped at its start, bent far, turned as a whole."""
    R = np.eye(3) if turn is None else turn
    mesh = fl.mesh.straight_line((0, 0, 0), R @ (10.0, 0, 0), 6)
    scene = fl.Scene()
    beam = scene.add(fl.Beam(mesh, SECTION, up=R[:, 2], formulation=formulation, name="beam"))
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), force=R @ np.array(force, dtype=float)))
    return scene


def errors(scene, estimate, **options):
    found = fl.statics(scene, **options)
    return fl.adaptivity.space_error(found, scene.bodies[0], scene, estimate=estimate)


# --- zero where the solution is in the space ------------------------------------------------------


@each_of_beams
def test_pure_bending_has_no_error(estimate, formulation):
    scene = fl.Scene()
    beam = scene.add(
        fl.Beam.straight((0, 0, 0), (10, 0, 0), SECTION, cells=5, formulation=formulation, name="b")
    )
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), moment=(0, 2e4, 0), following=True))
    # directors of degree 2 do not bend to an arc; two halves in degree 1 are not quite their whole
    halves = isinstance(
        estimate, fl.adaptivity.HierarchicalEstimate
    ) and formulation == fl.elements.DirectorBeam(1)
    bound = 1e-3 if formulation == fl.elements.DirectorBeam(2) else 1e-4 if halves else 1e-8
    assert errors(scene, estimate, load_steps=2).relative < bound


@each_estimate
@each_cell
def test_constant_stress_has_no_error(estimate, cell):
    """A sheet of cells of any shape, pulled along one side."""

    def position(a, b):
        return a + 0.1 * np.sin(np.pi * a) * (b - 0.3), b + 0.1 * np.sin(np.pi * b) * a, 0.0

    mesh = fl.mesh.parametric_surface(position, (4, 4), cell=cell)
    scene = fl.Scene()
    shell = scene.add(fl.Shell(mesh, fl.ShellSection.layer(0.1, MATERIAL), name="sheet"))
    shell.symmetry("a=0", (1, 0, 0))
    shell.symmetry("b=0", (0, 1, 0))
    shell.roller("00", (0, 0, 1))
    scene.add(fl.loads.EdgeLoad(shell, "a=1", force=(1e-3, 0, 0)))
    assert errors(scene, estimate).relative < 1e-3  # of the strain of large displacements


@each_estimate
@each_cell
def test_rigid_motion_adds_nothing(estimate, cell):
    """States of a shell moved rigidly have the same errors."""
    scene = sheet(cell, (0.0, 0.0, 0.05))
    result, shell = fl.statics(scene), scene.bodies[0]
    rng = np.random.default_rng(2)
    H = lie.se3_exp(np.array([3.0, -2.0, 5.0, *rng.normal(size=3)]))
    moved = np.array(result.frames)
    moved[-1] = lie.se3_compose(np.broadcast_to(H, moved[-1].shape), moved[-1])
    there = replace(result, frames=moved)
    a, b = (fl.adaptivity.space_error(r, shell, scene, estimate=estimate) for r in (result, there))
    np.testing.assert_allclose(b.squares, a.squares, rtol=1e-6, atol=1e-9 * a.squares.max())


# --- objectivity ----------------------------------------------------------------------------------


@pytest.mark.slow
@each_estimate
@each_cell
def test_shells_turned_as_a_whole(estimate, cell):
    turn = lie.so3_exp(np.array([0.5, -1.0, 0.8]))
    a, b = (errors(sheet(cell, (0.0, 0.01, 0.05), turn=R), estimate) for R in (None, turn))
    np.testing.assert_allclose(b.squares, a.squares, rtol=1e-4, atol=1e-7 * a.squares.max())


@each_estimate
def test_beams_turned_as_a_whole(estimate):
    turn = lie.so3_exp(np.array([0.5, -1.0, 0.8]))
    a, b = (
        errors(cantilever(fl.elements.GeodesicBeam(), R), estimate, load_steps=2)
        for R in (None, turn)
    )
    np.testing.assert_allclose(b.squares, a.squares, rtol=1e-6)


# --- order and size -------------------------------------------------------------------------------


@each_of_beams
@pytest.mark.parametrize("force", effectivity.BEAMS.values(), ids=list(effectivity.BEAMS))
def test_of_beams_it_is_the_error(estimate, formulation, force, monkeypatch):
    monkeypatch.setattr(effectivity, "FINEST", 128)
    monkeypatch.setattr(effectivity, "CELLS", (16, 32))
    rows = effectivity.beam_rows(formulation, force, estimate)
    assert all(0.92 < ratio < 1.05 for *_, ratio in rows)


@each_estimate
def test_line_loads_are_seen(estimate):
    """A span between hinges under a constant load: ``EI w⁗ = q``, M misses ``q s (ℓ − s) / 2``."""
    load, length, cells = 50.0, 10.0, 40
    scene = fl.Scene()
    beam = scene.add(fl.Beam.straight((0, 0, 0), (length, 0, 0), SECTION, cells=cells, name="b"))
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.LineLoad(beam, force=(0, 0, load)))
    # the moment is q (L − x)²/2, its slope q (L − x), and it misses that over each element
    h = length / cells
    expected = np.sqrt(load**2 * length**3 / 3 * h**2 / 12 / 2e6)
    assert errors(scene, estimate).total == pytest.approx(expected, rel=0.01)


@each_estimate
def test_of_shells_it_is_near_the_error(estimate):
    case = effectivity.SHELLS["plate with a hole"]._replace(meshes=(8, 16, 48))
    rows = effectivity.shell_rows(case, estimate)
    assert 0.75 < rows[0][3] < 1.25
    assert 0.8 < rows[1][3] < 1.25


@each_estimate
@each_cell
def test_it_falls_with_the_cells(estimate, cell):
    found = [errors(sheet(cell, (0.0, 0.0, 1e-3), cells), estimate).relative for cells in (8, 16)]
    assert 0.4 < found[1] / found[0] < 0.7


def twisted(lines, thickness):
    """A square twisted by forces at its corners: M₁₂ = P/2 up to edges, where none can be."""
    count = len(lines) - 1
    mesh = fl.mesh.parametric_surface(
        lambda a, b: (lines[round(a * count)], lines[round(b * count)], 0.0), (count, count)
    )
    scene = fl.Scene()
    plate = scene.add(fl.Shell(mesh, fl.ShellSection.layer(thickness, MATERIAL), name="plate"))
    for corner, directions in (("00", np.eye(3)), ("10", np.eye(3)[1:]), ("01", np.eye(3)[2:])):
        for direction in directions:
            plate.roller(corner, direction)
    scene.add(fl.PointLoad(plate.point("11"), force=(0, 0, TWISTING)))
    return scene


@pytest.mark.parametrize("thickness", [0.01, 0.04])
@each_estimate
def test_layers_along_free_edges(estimate, thickness):
    """The square of the error is the work that forces do more where cells resolve layers."""
    equal = np.arange(9) / 8
    inside = np.cumsum(0.25 * thickness / np.sqrt(10) * 1.4 ** np.arange(20))
    inside = inside[inside < 0.1]
    scene, dense = (
        twisted(lines, thickness)
        for lines in (equal, np.unique(np.concatenate([equal, inside, 1.0 - inside])))
    )
    coarse, true = (fl.statics(each).displacement("plate.11")[-1, 2] for each in (scene, dense))
    expected = np.sqrt(TWISTING * (true - coarse))
    assert errors(scene, estimate).total == pytest.approx(expected, rel=0.12)


# --- more unknowns --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "formulation", [fl.elements.GeodesicBeam(), fl.elements.DirectorBeam(1)], ids=repr
)
@pytest.mark.parametrize("force", effectivity.BEAMS.values(), ids=list(effectivity.BEAMS))
def test_halves_of_elements_say_the_same(formulation, force):
    solved = effectivity.arc(16, formulation, force)
    a, b = (
        fl.adaptivity.space_error(*solved, estimate=e)
        for e in (fl.adaptivity.RecoveryEstimate(), fl.adaptivity.HierarchicalEstimate())
    )
    assert b.total == pytest.approx(a.total, rel=0.05)
    if formulation == fl.elements.GeodesicBeam():
        np.testing.assert_allclose(b.squares, a.squares, rtol=0.1, atol=1e-3 * a.squares.max())


def test_halves_under_line_loads():
    scene = fl.Scene()
    beam = scene.add(fl.Beam.straight((0, 0, 0), (10, 0, 0), SECTION, cells=20, name="b"))
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.LineLoad(beam, force=(0, 0, 50.0)))
    a, b = (
        errors(scene, e).total
        for e in (fl.adaptivity.RecoveryEstimate(), fl.adaptivity.HierarchicalEstimate())
    )
    assert b == pytest.approx(a, rel=0.02)


def test_halves_of_what_has_more_nodes():
    scene = cantilever(fl.elements.DirectorBeam(2))
    with pytest.raises(ValueError, match=r"two nodes, those of .* have 3"):
        errors(scene, fl.adaptivity.HierarchicalEstimate(), load_steps=2)
    mesh = fl.mesh.parametric_surface(lambda a, b: (a, b, 0.0), (2, 2), degree=2)
    layer, scene = fl.ShellSection.layer(0.1, MATERIAL), fl.Scene()
    shell = scene.add(
        fl.Shell(mesh, layer, formulation=fl.elements.DisplacementBased(), name="sheet")
    )
    shell.clamp("a=0")
    with pytest.raises(ValueError, match="cells of degree 1, those of sheet are of degree 2"):
        errors(scene, fl.adaptivity.HierarchicalEstimate())


@pytest.mark.parametrize("thickness", [0.01, 0.1])
def test_cut_cells_held_by_items_of_the_scene(thickness):
    """A side held by clamps at its nodes: new nodes have loads in place of supports."""
    found = []
    for own in (True, False):
        scene, mesh = fl.Scene(), fl.mesh.parametric_surface(lambda a, b: (a, b, 0.0), (8, 8))
        shell = scene.add(fl.Shell(mesh, fl.ShellSection.layer(thickness, MATERIAL), name="sheet"))
        if own:
            shell.clamp("a=0")
        else:
            for point in shell.points("a=0"):
                scene.add(fl.Clamp(point))
        scene.add(fl.AreaLoad(shell, force=(0, 0, 1e-6)))
        found.append(errors(scene, fl.adaptivity.HierarchicalEstimate()).total)
    assert found[1] == pytest.approx(found[0], rel=0.2)


def test_one_cell_is_cut():
    mesh, scene = fl.mesh.parametric_surface(lambda a, b: (a, b, 0.0), (1, 1)), fl.Scene()
    shell = scene.add(fl.Shell(mesh, fl.ShellSection.layer(0.1, MATERIAL), name="sheet"))
    shell.clamp("a=0")
    scene.add(fl.loads.EdgeLoad(shell, "a=1", force=(0.0, 0.0, 1e-3)))
    # of linear bending, which one cell has as its mean: 1/12 of the square over 1/4 and 1/12
    found = errors(scene, fl.adaptivity.HierarchicalEstimate())
    assert found.relative == pytest.approx(0.5, rel=0.2)


@pytest.mark.parametrize("thickness", [0.04, 0.01])
def test_cut_cells_of_thin_curved_shells(thickness):
    """Places of nodes that are right for large cells are no stress in small ones."""
    scene = hemisphere.pinched(thickness, hemisphere.quarter(16))
    result = fl.follow_loads(scene, [0.1])
    a, b = (
        fl.adaptivity.space_error(result, scene.bodies[0], scene, estimate=e).total
        for e in (fl.adaptivity.RecoveryEstimate(), fl.adaptivity.HierarchicalEstimate())
    )
    assert 0.75 < b / a < 1.35


# --- in the loop, and bad input -------------------------------------------------------------------


def test_a_line_is_refined_by_residuals():
    def build(mesh):
        scene = fl.Scene()
        beam = scene.add(fl.Beam(mesh, SECTION, name="beam"))
        scene.add(fl.Clamp(beam.point("start")))
        scene.add(fl.PointLoad(beam.point("end"), force=(0, 0, 3e3)))
        return scene

    line = fl.mesh.straight_line((0, 0, 0), (10, 0, 0), 4)
    found = fl.adaptivity.adapt(
        build, line, tolerance=0.03, estimate=fl.adaptivity.ResidualEstimate()
    )
    assert found.relative[-1] <= 0.03
    assert found.rate == pytest.approx(-1.0, abs=0.15), "of first order"


def never(mesh):
    pytest.fail("something was solved")


def test_estimates_that_are_none():
    line = fl.mesh.straight_line((0, 0, 0), (10, 0, 0), 4)
    with pytest.raises(TypeError, match="estimate"):
        fl.adaptivity.adapt(never, line, tolerance=0.1, estimate="residual")
    goal = fl.adaptivity.PointDisplacementGoal("beam.end", (0, 0, 1))
    with pytest.raises(ValueError, match="omit Residual"):
        fl.adaptivity.adapt(
            never, line, tolerance=0.1, goal=goal, estimate=fl.adaptivity.ResidualEstimate()
        )
    scene = cantilever(fl.elements.GeodesicBeam())
    result = fl.statics(scene, load_steps=2)
    with pytest.raises(TypeError, match="estimate"):
        fl.adaptivity.space_error(
            result, scene.bodies[0], scene, estimate=fl.adaptivity.ResidualEstimate
        )
    other = cantilever(fl.elements.GeodesicBeam()).bodies[0]
    with pytest.raises(ValueError, match="not in the scene"):
        fl.adaptivity.space_error(result, other, scene, estimate=fl.adaptivity.ResidualEstimate())


def test_cells_without_residual_errors():
    scene = fl.Scene()
    mesh = fl.mesh.parametric_surface(lambda a, b: (a, b, 0.0), (2, 2), degree=2)
    shell = scene.add(
        fl.Shell(
            mesh, fl.ShellSection.layer(0.1, MATERIAL), formulation=fl.elements.DisplacementBased()
        )
    )
    shell.clamp("a=0")
    result = fl.statics(scene)
    with pytest.raises(ValueError, match=r"degree 1, .* degree 2"):
        fl.adaptivity.space_error(result, shell, scene, estimate=fl.adaptivity.ResidualEstimate())
    scene = fl.Scene()
    mesh = fl.mesh.parametric_surface(lambda a, b: (a, b, 0.0), (1, 1))
    shell = scene.add(fl.Shell(mesh, fl.ShellSection.layer(0.1, MATERIAL)))
    shell.clamp("a=0")
    result = fl.statics(scene)
    with pytest.raises(ValueError, match="smooth neighbours, cell 0"):
        fl.adaptivity.space_error(result, shell, scene, estimate=fl.adaptivity.ResidualEstimate())
