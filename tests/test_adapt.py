"""Error in space: what is estimated is the error, and meshes are refined where it is."""

from dataclasses import replace
from importlib import import_module

import numpy as np
import pytest

import fem_lie as fl
from benchmarks import effectivity, refined_quadrilaterals
from demos import adaptive_goals, adaptive_problems, adaptive_shell, deep_arch, goal_problems

SECTION = fl.Section.from_stiffness([1e7, 5e6, 5e6, 1e6, 2e6, 1e6])
PLAIN = fl.elements.GeodesicBeam(bending_flexibility=False)
ELEMENTS = [
    fl.elements.GeodesicBeam(),
    PLAIN,
    fl.elements.DirectorBeam(1),
    fl.elements.DirectorBeam(2),
]


def cantilever(mesh, formulation=PLAIN, force=(0, 2e3, 3e4)):
    """Clamped at its start, bent far."""
    scene = fl.Scene()
    beam = scene.add(fl.Beam(mesh, SECTION, formulation=formulation, name="beam"))
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), force=force))
    return scene


def sheet(mesh):
    """A square in its plane, held at one side, with a pull that grows along the other."""
    scene = fl.Scene()
    section = fl.ShellSection.layer(0.1, fl.Material(1e6, 0.3, 1.0))
    shell = scene.add(fl.Shell(mesh, section, name="sheet"))
    shell.clamp("a=0")
    scene.add(fl.loads.EdgeLoad(shell, "a=1", force=(0.0, 0.0, 1e-3)))
    return scene


def square(cells, cell="triangle"):
    return fl.mesh.parametric_surface(lambda a, b: (a, b, 0.0), (cells, cells), cell=cell)


# --- the estimate ---------------------------------------------------------------------------------


@pytest.mark.parametrize("formulation", ELEMENTS, ids=repr)
@pytest.mark.parametrize("force", effectivity.BEAMS.values(), ids=list(effectivity.BEAMS))
def test_of_beams_it_is_the_error(formulation, force, monkeypatch):
    monkeypatch.setattr(effectivity, "FINEST", 128)
    monkeypatch.setattr(effectivity, "CELLS", (8, 16))
    rows = effectivity.beam_rows(formulation, force)
    assert all(0.95 < ratio < 1.05 for *_, ratio in rows)
    assert rows[1][2] < 0.55 * rows[0][2]


def test_of_shells_it_is_near_the_error():
    case = effectivity.SHELLS["plate with a hole"]
    estimates = fl.adaptivity.RecoveryEstimate(), fl.adaptivity.HierarchicalEstimate()
    for rows in effectivity.all_shell_rows(case._replace(meshes=(8, 16, 48)), estimates):
        for *_, error, ratio in rows:
            assert error < 0.2
            assert 0.8 < ratio < 1.25


@pytest.mark.parametrize("cell", ["quadrilateral", "triangle"])
def test_cut_cells_find_nothing_that_is_not_missing(cell):
    """Pulled evenly: loads on edges go to the nodes that are new, too."""

    scene, layer = fl.Scene(), fl.ShellSection.layer(0.1, fl.Material(1e6, 0.0, 1.0))
    shell = scene.add(fl.Shell(square(3, cell), layer, name="sheet"))
    shell.clamp("a=0")
    scene.add(fl.loads.EdgeLoad(shell, "a=1", force=(1e3, 0.0, 0.0)))
    found = fl.adaptivity.space_error(
        fl.statics(scene), shell, scene, estimate=fl.adaptivity.HierarchicalEstimate()
    )
    assert found.energy > 0
    assert found.relative < 1e-6


@pytest.mark.parametrize("cell", ["quadrilateral", "triangle"])
def test_cut_cells_of_a_plate_that_bends(cell):
    """Half the size, half the error; as much as is recovered."""
    found = []
    for cells in (4, 8):
        scene = sheet(square(cells, cell))
        result = fl.statics(scene)
        body = scene.bodies[0]
        found.append(
            [
                fl.adaptivity.space_error(result, body, scene, estimate=e).relative
                for e in (fl.adaptivity.HierarchicalEstimate(), fl.adaptivity.RecoveryEstimate())
            ]
        )
    (coarse, _), (fine, recovered) = found
    assert fine < 0.65 * coarse
    assert fine == pytest.approx(recovered, rel=0.35)


def test_nothing_is_wrong_with_what_is_constant():
    """Pure bending is in the element; a rigid motion adds nothing."""
    scene = fl.Scene()
    beam = scene.add(fl.Beam.straight((0, 0, 0), (10, 0, 0), SECTION, cells=5, name="beam"))
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), moment=(0, 1e5, 0), following=True))
    found = fl.adaptivity.space_error(fl.statics(scene, load_steps=4), beam, scene)
    assert found.relative < 1e-8
    assert found.energy == pytest.approx(1e10 * 10 / 2e6, rel=1e-6)


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e3])
def test_it_has_the_unit_of_energy(size):
    """Constant curvature for a linear one: ``F² h³ / 12 EI`` in each element, in any unit."""
    force, length, cells = 20.0, 10 * size, 6
    D = np.array([1e7, 5e6, 5e6, 1e6, 2e6, 1e6]) * [1, 1, 1, size**2, size**2, size**2]
    scene = fl.Scene()
    section = fl.Section.from_stiffness(D)
    beam = fl.Beam.straight((0, 0, 0), (length, 0, 0), section, cells=cells, name="beam")
    scene.add(beam)
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), force=(0, 0, force)))
    found = fl.adaptivity.space_error(fl.statics(scene), beam, scene)
    expected = force**2 * (length / cells) ** 3 / (12 * D[4])
    np.testing.assert_allclose(found.squares, expected, rtol=1e-4)


def test_it_holds_in_motion():
    """A pendulum: at each time the error is that of bending, and halves with the elements."""
    found = []
    for cells in (8, 16):
        scene = fl.Scene(gravity=(0, 0, -9.81))
        section = fl.Section.rectangle(0.05, 0.05, fl.Material(1e7, 0.3, 1e3))
        rod = scene.add(fl.Beam.straight((0, 0, 0), (1, 0, 0), section, cells=cells, name="rod"))
        scene.add(fl.joints.Revolute(fl.ground(), rod.point("start"), axis=(0, 1, 0)))
        result = fl.GeneralisedAlpha().run(scene, duration=0.3, step=2e-3)
        found.append(
            [fl.adaptivity.space_error(result, rod, scene, step).relative for step in (80, 150)]
        )
    assert (np.array(found[1]) < 0.6 * np.array(found[0])).all()


def test_forms_of_a_shell_are_made_once(monkeypatch):
    scene = sheet(square(4))
    shell = scene.bodies[0]
    result = fl.statics(scene)
    first = fl.adaptivity.space_error(result, shell, scene)
    monkeypatch.setattr(type(shell.model), "assemble", never)
    np.testing.assert_array_equal(
        fl.adaptivity.space_error(result, shell, scene).squares, first.squares
    )


# --- goals ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("force", [1e2, 3e4])
def test_the_error_of_a_goal_has_size_and_sign(force):
    goal = fl.adaptivity.PointDisplacementGoal("beam.end", (0, 0, 1))
    found = {}
    for cells in (8, 128):
        scene = cantilever(fl.mesh.straight_line((0, 0, 0), (10, 0, 0), cells), force=(0, 0, force))
        result = fl.statics(scene, load_steps=3)
        found[cells] = fl.adaptivity.goal_error(result, scene.bodies, scene, goal)
    error = found[128].value + found[128].estimate - found[8].value
    assert found[8].estimate == pytest.approx(error, rel=0.03)
    assert found[8].relative >= abs(found[8].estimate) / (found[8].value + found[8].estimate)


def test_a_goal_behind_a_joint():
    """A frame of two beams: where one ends a joint holds the next, and the dual goes through it."""
    goal, found = fl.adaptivity.PointDisplacementGoal("b.end", (0, 0, 1)), {}
    for cells in (4, 64):
        scene = fl.Scene()
        line = (
            fl.mesh.straight_line((0, 0, 0), (10, 0, 0), cells),
            fl.mesh.straight_line((10, 0, 0), (15, 0, 0), cells),
        )
        a, b = (
            scene.add(fl.Beam(m, SECTION, formulation=PLAIN, name=n))
            for m, n in zip(line, "ab", strict=True)
        )
        scene.add(fl.Clamp(a.point("start")))
        scene.add(fl.joints.Fixed(a.point("end"), b.point("start")))
        scene.add(fl.PointLoad(b.point("end"), force=(0, 0, 5e3)))
        result = fl.statics(scene, load_steps=2)
        found[cells] = fl.adaptivity.goal_error(result, [a, b], scene, goal)
    error = found[64].value + found[64].estimate - found[4].value
    assert found[4].estimate == pytest.approx(error, rel=0.03)


def test_a_limit_load():
    """The null vector of the tangent is the dual solution; reference by shooting."""
    mesh = fl.adaptivity.refine(goal_problems.arch_line(), np.arange(8))
    scene, goal = goal_problems.arch(mesh), fl.adaptivity.LimitLoadGoal()
    path = goal.solve(scene)
    factors = path.factors.copy()
    found = fl.adaptivity.goal_error(path, scene.bodies, scene, goal)
    error = deep_arch.VARIANTS["stretchable"][2][0] / deep_arch.FORCE - found.value
    assert error < -0.02
    assert found.estimate == pytest.approx(error, rel=0.1)
    np.testing.assert_array_equal(path.factors, factors)
    # loads twice as large, half the factor
    scene.add(fl.PointLoad(scene.bodies[0].point("crown"), force=(0, -deep_arch.FORCE, 0)))
    again = fl.adaptivity.goal_error(goal.solve(scene), scene.bodies, scene, goal)
    assert again.value == pytest.approx(0.5 * found.value, rel=1e-5)
    assert again.estimate == pytest.approx(0.5 * found.estimate, rel=1e-3)


@pytest.mark.parametrize("mode", [1, 3])
def test_a_frequency(mode):
    goal, found = fl.adaptivity.FrequencyGoal(mode), {}
    section = fl.Section.rectangle(0.05, 0.08, fl.Material(1e7, 0.3, 1e3))
    for cells in (8, 64):
        scene = fl.Scene()
        line = fl.mesh.straight_line((0, 0, 0), (1, 0, 0), cells)
        beam = scene.add(fl.Beam(line, section, formulation=PLAIN, name="beam"))
        scene.add(fl.Clamp(beam.point("start")))
        found[cells] = fl.adaptivity.goal_error(goal.solve(scene), [beam], scene, goal)
        assert found[cells].value == pytest.approx(
            fl.vibrations(scene, mode).frequencies[-1], rel=1e-8
        )
    error = found[64].value + found[64].estimate - found[8].value
    assert error < -1e-3 * found[8].value
    assert found[8].estimate == pytest.approx(error, rel=0.15)


def test_the_frequency_of_a_plate_with_a_hole():
    goal, found = fl.adaptivity.FrequencyGoal(1), {}
    mesh = goal_problems.quarter()
    for level in range(3):
        scene = goal_problems.plate(mesh)
        found[level] = fl.adaptivity.goal_error(goal.solve(scene), scene.bodies, scene, goal)
        mesh = fl.adaptivity.refine(
            mesh, np.arange(len(mesh.cells)), onto=goal_problems.out_of_hole
        )
    error = found[2].value + found[2].estimate - found[1].value
    assert found[1].estimate == pytest.approx(error, rel=0.2)


def test_goals_behind_corners():
    """Attached nodes lie between: those of the second branch have other numbers."""
    record = adaptive_goals.main("frame", pictures=False)
    assert 0.0 < record["error"] < 0.01
    assert record["effectivity"] == pytest.approx(1.0, rel=0.1)


# --- refinement -----------------------------------------------------------------------------------


def test_arcs_stay_arcs():
    mesh = fl.mesh.curve(lambda s: (np.cos(s), np.sin(s), 0.0), 4)
    mesh = fl.adaptivity.refine(fl.adaptivity.refine(mesh, [1, 2]), [0, 3])
    assert len(mesh.cells) == 8
    np.testing.assert_allclose(np.linalg.norm(mesh.points, axis=1), 1.0, atol=1e-12)
    across = np.einsum("mkj,mkj->mk", mesh.tangents, mesh.points[mesh.cells])
    np.testing.assert_allclose(across, 0.0, atol=1e-11)
    # along the line, one after the other
    assert (mesh.cells[1:, 0] == mesh.cells[:-1, 1]).all()


@pytest.mark.parametrize(("cell", "times"), [("triangle", 5), ("quadrilateral", 2)])
def test_names_and_area_survive(cell, times):
    mesh = fl.mesh.parametric_surface(lambda a, b: (a, b + 0.2 * a * b, 0.0), (4, 3), cell=cell)
    mesh = replace(mesh, groups={"left": np.flatnonzero(mesh.points[mesh.cells, 0].max(1) < 0.6)})
    fine, rng = mesh, np.random.default_rng(5)
    for _ in range(times):
        fine = fl.adaptivity.refine(fine, rng.choice(len(fine.cells), 6, replace=False))
    around = [[0, 1], [1, 2], [2, 0]] if cell == "triangle" else [[0, 1], [1, 3], [3, 2], [2, 0]]

    def area(m, cells=slice(None)):
        x = m.points[m.cells[cells]][:, np.array(around)]
        return np.cross(x[:, :, 0], x[:, :, 1])[..., 2].sum() / 2

    def length(m, name):
        x = m.points[m.curves[name]]
        return np.linalg.norm(x[:, 1] - x[:, 0], axis=1).sum()

    assert len(fine.cells) > 2 * len(mesh.cells)
    assert area(fine) == pytest.approx(area(mesh), rel=1e-12)
    left = area(fine, fine.groups["left"])
    assert left == pytest.approx(area(mesh, mesh.groups["left"]), rel=1e-12)
    for name in mesh.curves:
        assert length(fine, name) == pytest.approx(length(mesh, name), rel=1e-12)
    for name, points in mesh.named_points.items():
        np.testing.assert_array_equal(fine.points[fine.named_points[name]], mesh.points[points])
    sides = np.sort(fine.cells[:, around].reshape(-1, 2), axis=1)
    _, met = np.unique(sides, axis=0, return_counts=True)
    assert met.max() == 2
    assert (met == 1).sum() == sum(len(edges) for edges in fine.curves.values()), "no hanging node"


def test_quadrilaterals_by_all_patterns():
    """One, two, three and four marks, on every corner; cells between opposite marks are cut."""
    mesh, found = square(6, "quadrilateral"), {}
    for cells in ([14], [14, 20], [14, 21], [14, 15, 20], list(range(36))):
        fine = fl.adaptivity.refine(mesh, cells)
        p = fine.points[fine.cells][:, [0, 1, 3, 2]]
        corners = np.cross(np.roll(p, -1, 1) - p, np.roll(p, 1, 1) - p)[..., 2]
        assert np.abs(corners).min() > 1e-4
        assert (np.sign(corners) == np.sign(corners[0, 0])).all(), "no corner is re-entrant"
        found[tuple(cells)] = len(fine.cells)
    # nine, four neighbours by an edge of seven, four at corners of three, and those far off
    assert found[(14,)] == 9 + 4 * 7 + 4 * 3 + 27
    assert found[tuple(range(36))] == 9 * 36


def test_quadrilaterals_are_refined_where_stress_is_rough():
    """A corner of a plate, re-entrant: fewer cells than with equal ones, and names are kept."""
    mesh = effectivity.l_plate(4).bodies[0].model.mesh
    build, estimate = refined_quadrilaterals.plate, fl.adaptivity.ResidualEstimate()
    found = fl.adaptivity.adapt(build, mesh, tolerance=0.2, solve=fl.statics, estimate=estimate)
    assert found.error.relative <= 0.2
    size = np.ptp(found.mesh.points[found.mesh.cells], axis=1).max(axis=1)
    near = np.linalg.norm(found.mesh.points[found.mesh.cells].mean(axis=1)[:, :2] - 1, axis=1) < 0.1
    assert size[near].max() < 0.5 * np.median(size[~near])


def test_new_points_lie_on_the_true_surface():
    mesh = adaptive_problems.eighth()
    fine = fl.adaptivity.refine(mesh, [0, 7, 30], onto=adaptive_problems.on_cylinder)
    radius = np.hypot(*fine.points[:, 1:].T)
    np.testing.assert_allclose(radius, adaptive_problems.RADIUS, rtol=1e-12)


# --- the loop -------------------------------------------------------------------------------------


def test_a_line_is_refined_where_it_bends():
    found = fl.adaptivity.adapt(
        cantilever,
        fl.mesh.straight_line((0, 0, 0), (10, 0, 0), 4),
        tolerance=0.02,
        solve=lambda scene: fl.statics(scene, load_steps=2),
    )
    assert found.error.relative <= 0.02
    assert (np.diff(found.unknowns) > 0).all()
    assert found.rate == pytest.approx(-1.0, abs=0.15), "of first order"


def test_a_cable_is_refined_at_its_clamps():
    """A taut cable with bending stiffness: its layers there have the width √(EI/T)."""
    EA, EI, T, q = 4e4, 0.1, 400.0, 8.0
    section = fl.Section.from_stiffness([EA, 1e5, 1e5, EI, EI, EI])

    def taut(mesh):
        scene = fl.Scene()
        rope = scene.add(fl.Cable(mesh, section, length=1.0 / (1.0 + T / EA), name="rope"))
        rope.clamp(rope.point("start"), rope.point("end"))
        scene.add(fl.LineLoad(rope, force=(0.0, 0.0, -q)))
        return scene

    line = fl.mesh.straight_line((0, 0, 0), (1, 0, 0), 4)
    found = fl.adaptivity.adapt(taut, line, tolerance=3e-4)
    along = np.sort(found.mesh.points[:, 0])
    sizes = np.diff(along)
    assert (
        sizes[[0, -1]].max() <= 2.0**-7 < 8 * 2.0**-7 < sizes[np.abs(along[:-1] - 0.5) < 0.2].min()
    )
    assert len(sizes) < 64 / 3, "64 equal elements have 3.3e-4"
    # the load is per unloaded length
    k, unloaded = np.sqrt(T / EI), q / (1.0 + T / EA)
    bent = (1.0 - np.cosh(0.5 * k)) / np.sinh(0.5 * k) / (2.0 * T * k)
    sag = unloaded * (1.0 / (8.0 * T) + bent)
    assert -found.result.frames[-1, :, 0, 2].min() == pytest.approx(sag, rel=3e-3)


def test_an_ancf_beam_is_refined_where_it_bends():
    """To the displacement of 64 elements."""
    section = fl.Section.rectangle(0.05, 0.05, fl.Material(2.1e9, 0.3, 1000.0))

    def held(mesh):
        scene = fl.Scene()
        beam = scene.add(fl.AncfBeam(mesh, section, name="beam"))
        beam.clamp(beam.point("start"))
        scene.add(fl.PointLoad(beam.point("end"), force=(0.0, 0.0, -300.0)))
        return scene

    line = fl.mesh.straight_line((0, 0, 0), (1, 0, 0), 4)
    found = fl.adaptivity.adapt(held, line, tolerance=0.05)
    assert found.error.relative <= 0.05
    fine = fl.follow_loads(held(fl.mesh.straight_line((0, 0, 0), (1, 0, 0), 64)))
    wanted = fine.displacement("beam.end")[-1]
    np.testing.assert_allclose(
        found.result.displacement("beam.end")[-1], wanted, atol=1e-4 * np.linalg.norm(wanted)
    )
    assert found.rate == pytest.approx(-1.0, abs=0.3), "of first order"


def test_elements_are_coarsened_where_they_were_too_small():
    """Meshes are generated from the first one: at the end all elements have similar errors."""
    line = fl.mesh.straight_line((0, 0, 0), (10, 0, 0), 4)
    goal = fl.adaptivity.PointDisplacementGoal("beam.end", (0, 0, 1))
    found = fl.adaptivity.adapt(cantilever, line, tolerance=2e-3, goal=goal, fall=0.3)
    cut = fl.adaptivity.adapt(cantilever, line, tolerance=2e-3, goal=goal)
    assert 1e-3 < found.error.relative <= 2e-3
    assert found.unknowns[-1] <= cut.unknowns[-1]
    assert np.ptp(np.log2(found.error.squares)) < 4, "of the third power of sizes, which are halved"


@pytest.mark.parametrize("fall", [0.0, 1.0, -0.5])
def test_a_fall_that_is_none(fall):
    with pytest.raises(ValueError, match="fall"):
        fl.adaptivity.adapt(never, square(2, "triangle"), tolerance=0.1, fall=fall)


@pytest.mark.parametrize("cell", ["triangle", "quadrilateral"])
def test_meshes_change_until_the_tolerance_is_met(cell):
    """Also where all cells are slightly too large, but would be much too small after a cut."""
    mesh = square(2, cell)

    def pressed(mesh):
        scene = fl.Scene()
        shell = scene.add(
            fl.Shell(mesh, fl.ShellSection.layer(0.1, fl.Material(2.1e6, 0.3, 1.0)), name="plate")
        )
        shell.clamp("a=0")
        scene.add(fl.loads.EdgeLoad(shell, "a=1", force=(0.0, 0.0, 1.0)))
        return scene

    found = fl.adaptivity.adapt(pressed, mesh, tolerance=0.07, fall=0.9)
    assert found.relative[-1] <= 0.07 < found.relative[-2]
    counts = [len(mesh.cells) for mesh in found.meshes]
    assert len(set(counts)) == len(counts)


def test_a_tip_is_as_accurate_as_was_asked_for():
    goal = fl.adaptivity.PointDisplacementGoal("beam.end", (0, 0, 1))
    found = fl.adaptivity.adapt(
        cantilever,
        fl.mesh.straight_line((0, 0, 0), (10, 0, 0), 4),
        tolerance=1e-3,
        goal=goal,
        solve=lambda scene: fl.statics(scene, load_steps=2),
    )
    scene = cantilever(
        fl.mesh.straight_line((0, 0, 0), (10, 0, 0), 128), fl.elements.DirectorBeam(2)
    )
    true = goal.value(fl.statics(scene, load_steps=2))
    assert abs(found.error.value / true - 1) < 1e-3
    assert found.error.estimate == pytest.approx(true - found.error.value, rel=0.5)


@pytest.mark.parametrize(
    ("values", "estimates", "factor"),
    [
        ((1.0, 1.6), (0.3, 0.1), 3.0),  # it moved three times as far as was said
        ((1.0, 1.1), (0.3, 0.1), 1.0),  # less far: the estimate is safe
        ((1.0, 0.9), (0.3, 0.1), 1.0),  # the other way: nothing is known
        ((1.0, 1.6), (0.1, 0.1), 1.0),
    ],
)
def test_estimates_are_multiplied_by_what_was_missed(values, estimates, factor):
    class Scripted(fl.adaptivity.PointDisplacementGoal):
        """Its values and estimates on two meshes are given."""

        def found(self, result, bodies, scene):
            (beam,) = bodies
            k = len(beam.model.elements) - 2
            return values[k], [
                np.full(len(beam.model.elements), estimates[k] / len(beam.model.elements))
            ]

    line = fl.mesh.straight_line((0, 0, 0), (1, 0, 0), 2)
    with pytest.raises(fl.ConvergenceError, match="more than 24 unknowns") as caught:
        fl.adaptivity.adapt(
            cantilever, line, tolerance=1e-9, goal=Scripted("beam.end", (0, 0, 1)), most=24
        )
    found = caught.value.result
    np.testing.assert_array_equal(found.values, values)
    assert found.calibration[1] == pytest.approx(factor)
    assert found.value == pytest.approx(values[1] + factor * estimates[1])


@pytest.mark.parametrize("drilling", [False, True])
def test_unknowns_are_those_of_the_nodes(drilling):
    """Five or six of a shell's node, six of a frame, three of a position."""

    def build(mesh):
        scene = sheet(mesh)
        if drilling:
            scene.add(fl.PointLoad(scene.bodies[0].points("a=1")[0], moment=(0.0, 0.0, 1e-6)))
        ends = [(0.0, 0.0, 1.0), (1.0, 0.0, 1.0), (2.0, 0.0, 1.0)]
        section = fl.Section.circle(0.1, fl.Material(1e6, 0.3, 1.0))
        net = scene.add(fl.Net(ends, [[0, 1], [1, 2]], section, name="net"))
        for node in range(3):
            net.pin(net.point(node))
        box = scene.add(fl.RigidBody(1.0, (1.0, 1.0, 1.0), (5.0, 0.0, 0.0), name="box"))
        scene.add(fl.Clamp(box.point("centre")))
        return scene

    mesh = square(2)
    found = fl.adaptivity.adapt(build, mesh, tolerance=0.9, body="sheet")
    assert found.mesh is mesh
    positions = 3 * len(build(mesh).bodies[1].frames)
    assert found.unknowns[0] == (5 + drilling) * len(mesh.points) + positions + 6


def test_a_mesh_that_is_fine_enough_is_never_cut(monkeypatch):
    """Not even into no cells at all, to find out whether it could be."""

    def cut(*_args, **_options):
        raise AssertionError("a mesh was refined")

    monkeypatch.setattr(import_module("fem_lie.adaptivity.loop"), "refine", cut)
    mesh = square(2)
    assert fl.adaptivity.adapt(sheet, mesh, tolerance=0.9).mesh is mesh
    for degree in ({"degree": 2}, {"degree": 2, "cell": "quadrilateral"}):
        curved = fl.mesh.parametric_surface(lambda a, b: (a, b, 0.0), (2, 2), **degree)
        with pytest.raises(ValueError, match="expected cells of degree 1 to refine"):
            fl.adaptivity.adapt(sheet, curved, tolerance=0.9)


def test_too_many_unknowns_end_it_with_what_there_is():
    with pytest.raises(fl.ConvergenceError, match="needs more than 300 unknowns") as caught:
        fl.adaptivity.adapt(
            cantilever, fl.mesh.straight_line((0, 0, 0), (10, 0, 0), 4), tolerance=1e-3, most=300
        )
    assert caught.value.result.unknowns[-1] <= 300


def test_pictures(tmp_path):
    scene = sheet(square(4))
    shell = scene.bodies[0]
    result = fl.statics(scene)
    fl.adaptivity.space_error(result, shell, scene).picture(tmp_path / "shell.png")
    goal = fl.adaptivity.PointDisplacementGoal("sheet.11", (0, 0, 1))
    fl.adaptivity.goal_error(result, [shell], scene, goal).picture(tmp_path / "goal.png")
    line = cantilever(fl.mesh.straight_line((0, 0, 0), (10, 0, 0), 4))
    beam = line.bodies[0]
    fl.adaptivity.space_error(fl.statics(line, load_steps=2), beam, line).picture(
        tmp_path / "beam.png"
    )
    assert all(path.stat().st_size > 5000 for path in tmp_path.glob("*.png"))
    assert len(list(tmp_path.glob("*.png"))) == 3


# --- bad input ------------------------------------------------------------------------------------


def never(mesh):
    pytest.fail("something was solved")


@pytest.mark.parametrize("tolerance", [0.0, -1.0, float("nan")])
def test_a_tolerance_that_is_none(tolerance):
    with pytest.raises(ValueError, match="tolerance"):
        fl.adaptivity.adapt(never, square(2), tolerance=tolerance)


@pytest.mark.parametrize("part", [0.0, 1.5])
def test_a_part_that_is_none(part):
    with pytest.raises(ValueError, match="part"):
        fl.adaptivity.adapt(never, square(2), tolerance=0.1, part=part)


def test_meshes_that_cannot_be_refined():
    with pytest.raises(ValueError, match=r"cells of degree 1 .* got quadrilaterals of degree 2"):
        quadratic = fl.mesh.parametric_surface(lambda a, b: (a, b, 0.0), (2, 2), degree=2)
        fl.adaptivity.adapt(never, quadratic, tolerance=0.1)
    with pytest.raises(TypeError, match="mesh"):
        fl.adaptivity.adapt(never, "plate", tolerance=0.1)
    with pytest.raises(ValueError, match="cells"):
        fl.adaptivity.refine(square(2), [99])


def test_goals_that_are_none():
    scene = cantilever(fl.mesh.straight_line((0, 0, 0), (10, 0, 0), 4))
    result = fl.statics(scene, load_steps=2)
    with pytest.raises(ValueError, match="middle"):
        fl.adaptivity.goal_error(
            result,
            scene.bodies,
            scene,
            fl.adaptivity.PointDisplacementGoal("beam.middle", (0, 0, 1)),
        )
    with pytest.raises(ValueError, match="along"):
        fl.adaptivity.PointDisplacementGoal("beam.end", (0, 0, 0))
    bowed = cantilever(fl.mesh.straight_line((0, 0, 0), (10, 0, 0), 4), fl.elements.GeodesicBeam())
    goal = fl.adaptivity.PointDisplacementGoal("beam.end", (0, 0, 1))
    with pytest.raises(ValueError, match="bending_flexibility=False"):
        fl.adaptivity.goal_error(fl.statics(bowed, load_steps=2), bowed.bodies, bowed, goal)


def test_goals_of_no_use_are_refused_before_anything_is_solved():
    """The scene is made, and not solved."""
    line = fl.mesh.straight_line((0, 0, 0), (10, 0, 0), 4)
    middle = fl.adaptivity.PointDisplacementGoal("beam.middle", (0, 0, 1))
    with pytest.raises(ValueError, match="middle"):
        fl.adaptivity.adapt(cantilever, line, tolerance=0.1, goal=middle, solve=never)

    def warm(mesh):
        scene = cantilever(mesh)
        scene.add(fl.loads.Temperature(scene.bodies[0], 40.0, 1e-5))
        return scene

    with pytest.raises(ValueError, match="in proportion"):
        fl.adaptivity.adapt(
            warm, line, tolerance=0.1, goal=fl.adaptivity.LimitLoadGoal(), solve=never
        )
    with pytest.raises(ValueError, match="inertia"):
        fl.adaptivity.adapt(
            cantilever, line, tolerance=0.1, goal=fl.adaptivity.FrequencyGoal(1), solve=never
        )
    with pytest.raises(ValueError, match="number"):
        fl.adaptivity.LimitLoadGoal(0)
    with pytest.raises(ValueError, match="mode"):
        fl.adaptivity.FrequencyGoal(0)
    with pytest.raises(TypeError, match="goal"):
        fl.adaptivity.adapt(never, line, tolerance=0.1, goal="tip")


def test_critical_loads_that_are_not_there():
    scene = cantilever(fl.mesh.straight_line((0, 0, 0), (10, 0, 0), 4), force=(0, 0, 1e3))
    path = fl.follow_path(scene)
    with pytest.raises(
        ValueError, match="0 limit points and 0 bifurcations, expected limit point 1"
    ):
        fl.adaptivity.goal_error(path, scene.bodies, scene, fl.adaptivity.LimitLoadGoal())
    with pytest.raises(ValueError, match="inertia"):
        fl.adaptivity.goal_error(path, scene.bodies, scene, fl.adaptivity.FrequencyGoal(1))


def test_modes_that_are_not_there():
    scene = goal_problems.frame(goal_problems.frame_line())
    result = fl.statics(scene)
    with pytest.raises(ValueError, match=r"mode must be 1 … 36, .* got 37"):
        fl.adaptivity.goal_error(result, scene.bodies, scene, fl.adaptivity.FrequencyGoal(37))


def test_bodies_without_an_estimate():
    scene = fl.Scene()
    body = scene.add(fl.RigidBody(1.0, (1.0, 1.0, 1.0), name="stone"))
    result = fl.GeneralisedAlpha().run(scene, duration=0.01, step=0.01)
    with pytest.raises(ValueError, match="Beams and Shells"):
        fl.adaptivity.space_error(result, body, scene)
    other = cantilever(fl.mesh.straight_line((0, 0, 0), (10, 0, 0), 4)).bodies[0]
    with pytest.raises(ValueError, match="not in the scene"):
        fl.adaptivity.space_error(result, other, scene)


def test_a_scene_without_a_body_on_the_mesh():
    def twice(mesh):
        scene = cantilever(mesh)
        scene.add(fl.Beam(fl.mesh.straight_line((0, 5, 0), (1, 5, 0), 2), SECTION, name="other"))
        return scene

    line = fl.mesh.straight_line((0, 0, 0), (10, 0, 0), 4)
    with pytest.raises(ValueError, match="'beam', 'other'"):
        fl.adaptivity.adapt(twice, line, tolerance=0.1)
    with pytest.raises(ValueError, match="must be on the mesh"):
        fl.adaptivity.adapt(twice, line, tolerance=0.1, body="other")


def test_demo():
    record = adaptive_shell.main(tolerance=0.04, pictures=False)
    assert abs(record["error"]) < 0.04
    assert 2 / 3 < record["effectivity"] < 1.5
    assert record["unknowns"] < 0.7 * record["unknowns_uniform"]
