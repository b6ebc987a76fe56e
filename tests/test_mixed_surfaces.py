"""Shells of triangles and quadrilaterals: patch tests, closed forms, files, what is refused."""

import numpy as np
import pytest

import fem_lie as fl
from fem_lie.mesh import MixedSurfaceMesh
from tests.drawn import empty_model

E, NU, T, DENSITY = 2.1e11, 0.3, 0.01, 7800.0
LAYER = fl.ShellSection.layer(T, fl.Material(E, NU, DENSITY))


def mixed(mesh, cut=lambda centre, number: number % 3 == 0, straight=False):
    """Mesh whose chosen quadrilaterals are cut into two triangles each, with the names of sides.

    Where sides are to be straight, nodes of second order are moved to their middles.
    """
    quads, degree, points = mesh.cells, mesh.degree, mesh.points.copy()
    chosen = np.array([bool(cut(x, k)) for k, x in enumerate(mesh.centres)])
    a, b, c, d = quads[chosen, :4].T
    halves = np.concatenate([[a, b, d], [a, d, c]], axis=1)
    if degree == 2:
        e, f, g, h, m = quads[chosen, 4:].T
        if straight:
            ends = quads[:, [[0, 1], [0, 2], [1, 3], [2, 3]]]
            points[quads[:, 4:8]] = points[ends].mean(axis=2)
            points[quads[:, 8]] = points[quads[:, :4]].mean(axis=1)
            points[m] = 0.5 * (points[a] + points[d])
        halves = np.vstack([halves, np.concatenate([[g, m, e], [h, f, m]], axis=1)])
    groups = {"cut": np.arange(halves.shape[1])}
    return MixedSurfaceMesh.from_cells(
        points,
        {"triangle": halves.T, "quadrilateral": quads[~chosen]},
        groups=groups,
        curves=mesh.curves,
        named_points=mesh.named_points,
    )


def flat(a, b):
    """Unit square with points out of line, sides straight."""
    bump = a * (1 - a) * b * (1 - b)
    return np.array([a + 0.5 * bump, b - 0.8 * bump * np.sin(5 * a), 0.0])


def uneven(a, b):
    """Unit square of rectangles of different sizes."""
    return np.array([a**1.5, b**0.8, 0.0])


def sheet(cells=(4, 4), degree=1, function=flat, **how):
    mesh = fl.mesh.parametric_surface(function, cells, degree=degree)
    return fl.Shell(mixed(mesh, straight=True), LAYER, name="sheet", **how)


@pytest.mark.parametrize("degree", [1, 2])
def test_drawn_faces_have_no_rim_between_types(degree):
    """Edges of one face only are those of the square."""
    faces = sheet((4, 4), degree).model.faces
    edges = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    edges = edges[edges[:, 0] != edges[:, 1]]
    _, count = np.unique(edges, axis=0, return_counts=True)
    assert (count == 1).sum() == 16 and count.max() == 2


def everywhere(result, shell, name):
    """A quantity at the points of all cells of all types."""
    along = {"along": (1.0, 0.0, 0.0)}
    found = [fl.post.resultants(result, part.shell, **along).raw(name) for part in shell.parts]
    return np.concatenate([each.ravel() for each in found])


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("drilling", [None, True])
def test_patch_of_membrane_forces(degree, drilling):
    """Uniform tension to 1 % strain: the same stress in all cells, to round-off.

    Assumed strains of quadrilaterals of second order are exact in parallelograms.
    """
    shell = sheet(degree=degree, drilling=drilling, function={1: flat, 2: uneven}[degree])
    shell.roller("a=0", (1, 0, 0))
    shell.roller("b=0", (0, 1, 0))
    for side in ("a=0", "b=0", "a=1", "b=1"):
        shell.roller(side, (0, 0, 1))
    scene, force = fl.Scene(), 2e7
    scene.add(shell)
    scene.add(fl.loads.EdgeLoad(shell, "a=1", force=(force, 0, 0)))
    result = fl.statics(scene)
    # Green's strain: force per reference width is the stretch times N₁₁, N₁₁ = E t ε
    stretch = 1.0 + result.displacement(shell.point("11"))[-1, 0]
    stress = force / stretch
    np.testing.assert_allclose(0.5 * (stretch**2 - 1.0), stress / (E * T), rtol=1e-7)
    np.testing.assert_allclose(everywhere(result, shell, "N11"), stress, rtol=1e-8)
    for name in ("N22", "N12", "M11", "M22"):
        assert abs(everywhere(result, shell, name)).max() < 1e-8 * force


@pytest.mark.parametrize("degree", [1, 2])
def test_patch_of_bending_moments(degree):
    """A small moment on one edge: the same curvature in all cells."""
    moment = 1e-3
    shell = sheet(degree=degree)
    shell.symmetry("a=0", (1, 0, 0))
    shell.roller("00", (0, 0, 1))
    shell.roller("00", (0, 1, 0))
    shell.symmetry("b=0", (0, 1, 0))
    scene = fl.Scene()
    scene.add(shell)
    scene.add(fl.loads.EdgeLoad(shell, "a=1", moment=(0, moment, 0)))
    scene.add(fl.loads.EdgeLoad(shell, "b=1", moment=(-moment, 0, 0)))
    result = fl.statics(scene)
    for name, sign in (("M11", 1.0), ("M22", 1.0), ("M12", 0.0), ("Q1", 0.0)):
        found = everywhere(result, shell, name)
        np.testing.assert_allclose(found, np.sign(found.sum()) * sign * moment, atol=1e-7 * moment)


def square(a, b):
    return np.array([a, b, 0.0])


def simply_supported(mesh):
    plate = fl.Shell(mesh, LAYER, name="plate")
    for side in ("a=0", "a=1", "b=0", "b=1"):
        plate.hinge(side)
    scene = fl.Scene()
    scene.add(plate)
    return scene, plate


def test_plate_against_navier():
    """Simply supported square plate: deflection (Timoshenko) and frequencies, t/a = 1/100."""
    quads = fl.mesh.parametric_surface(square, (12, 12))
    D = E * T**3 / (12 * (1 - NU**2))
    found = {}
    for name, mesh in {"mixed": mixed(quads), "quads": quads}.items():
        scene, plate = simply_supported(mesh)
        scene.add(fl.AreaLoad(plate, (0, 0, -100.0)))
        w = fl.statics(scene).displacement(plate.point((0.5, 0.5, 0.0)))[-1, 2]
        found[name] = w, fl.vibrations(scene, 3).frequencies
    deflection = -0.00406235 * 100.0 / D
    first = 2.0 * np.pi**2 / np.sqrt(DENSITY * T / D)  # rad/s, times (m² + n²) / 2
    np.testing.assert_allclose(found["mixed"][0], deflection, rtol=0.01)
    np.testing.assert_allclose(found["mixed"][1], first * np.array([1, 2.5, 2.5]), rtol=0.03)
    np.testing.assert_allclose(found["mixed"][0], found["quads"][0], rtol=0.005)
    np.testing.assert_allclose(found["mixed"][1], found["quads"][1], rtol=0.03)


def test_cylinder_under_pressure():
    """Quarter of a tube, free along its axis: w = p r²/(E t) and N = p r, with both cell types.

    Cells are of second order and the tube is thick, as uneven loads of triangles bend the ring.
    """
    radius, pressure, thick = 0.5, 1e5, 0.05
    layer = fl.ShellSection.layer(thick, fl.Material(E, NU, DENSITY))

    def tube(a, b):
        return np.array([radius * np.cos(np.pi * a / 2), radius * np.sin(np.pi * a / 2), b])

    mesh = mixed(fl.mesh.parametric_surface(tube, (16, 4), degree=2))
    shell = fl.Shell(mesh, layer, director=lambda x: [*(x[:2] / np.hypot(*x[:2])), 0.0])
    shell.symmetry("a=0", (0, 1, 0))
    shell.symmetry("a=1", (1, 0, 0))
    shell.roller("b=0", (0, 0, 1))
    scene = fl.Scene()
    scene.add(shell)
    scene.add(fl.loads.SurfacePressure(shell, pressure))
    result = fl.statics(scene)
    ends = [result.displacement(shell.point(name))[-1] for name in ("00", "01", "10", "11")]
    growth = np.array([ends[0][0], ends[1][0], ends[2][1], ends[3][1]])
    np.testing.assert_allclose(growth, pressure * radius**2 / (E * thick), rtol=0.03)
    for part in shell.parts:
        found = fl.post.resultants(result, part.shell, along=lambda x: (-x[1], x[0], 0.0))
        np.testing.assert_allclose(found.mean("N11"), pressure * radius, rtol=0.05)


def folded(a, b):
    """An angle of 90°, along a = 1/2."""
    return np.array([min(a, 0.5), b, max(a, 0.5) - 0.5])


def test_types_meet_at_a_fold():
    """Triangles on one side, quadrilaterals on the other: forces, and all quadrilaterals."""
    quads = fl.mesh.parametric_surface(folded, (8, 8))
    tips = []
    for mesh in (mixed(quads, lambda x, k: x[2] > 1e-9), quads):
        shell = fl.Shell(mesh, LAYER, name="angle")
        held = shell.clamp("a=0")
        scene = fl.Scene()
        scene.add(shell)
        scene.add(fl.PointLoad(shell.point("11"), force=(50.0, 20.0, -30.0), moment=(0, 0, 5.0)))
        result = fl.statics(scene)
        np.testing.assert_allclose(result.reaction(*held)[-1, :3], (-50, -20, 30), rtol=1e-8)
        tips.append(result.displacement(shell.point("11"))[-1])
    np.testing.assert_allclose(tips[0], tips[1], atol=0.02 * abs(tips[1]).max())


def test_loads_have_their_sums():
    """Gravity, and loads on one edge, on a group of one type and on all, from the reactions."""
    shell = sheet()
    held = shell.clamp("a=0")
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(shell)
    area = 0.5 * sum(
        np.linalg.norm(np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]), axis=1).sum()
        for x in [shell.parts[0].shell.model.frames[shell.parts[0].shell.model.connectivity, 0]]
    )
    scene.add(fl.AreaLoad(shell, (0, 0, -100.0), cells="cut"))
    scene.add(fl.loads.VolumeLoad(shell, lambda x: (0, 0, -1e3 * x[0])))
    scene.add(fl.loads.MassLoad(shell, (2.0, 0, 0)))
    scene.add(fl.loads.EdgeLoad(shell, "b=1", force=(0, 3.0, 0), following=True))
    scene.add(fl.loads.SurfacePressure(shell, 7.0, cells="cut"))
    result = fl.statics(scene)
    force = result.reaction(*held)[-1, :3]
    moment = 1e3 * T * 0.5  # ∫ x dA of a sheet between a square's sides is nearly 1/2
    weight = DENSITY * T
    np.testing.assert_allclose(force[0], -2.0 * weight, rtol=2e-3)
    np.testing.assert_allclose(force[2], 9.81 * weight + 93.0 * area + moment, rtol=5e-3)
    # outward of the edge: follower loads change sides with the edge's sense
    np.testing.assert_allclose(abs(force[1]), 3.0, rtol=2e-2)


def test_free_flight_conserves(tmp_path):
    """A tumbling mixed sheet in energy-momentum; resumed to the last bit."""
    shell = sheet((3, 2))
    shell.add_velocity((1.0, 0.0, 2.0), omega=(3.0, 20.0, 5.0), about=(0.5, 0.5, 0.0))
    scene = fl.Scene()
    scene.add(shell)
    plan = {"duration": 0.02, "step": 1e-3, "checkpoint_every": 7, "file": tmp_path / "run.h5"}
    result = fl.EnergyMomentum().run(scene, **plan)
    assert result.energy_error < 1e-9
    momentum = result.momentum
    assert abs(momentum - momentum[0]).max() < 1e-9 * abs(momentum).max()
    resumed = fl.EnergyMomentum().resume(scene, plan["file"])
    np.testing.assert_array_equal(resumed.frames, result.frames)
    # nodes at one point on one smooth side are one to the last bit
    nodes = result.info.body("sheet").nodes
    twins = np.flatnonzero(shell.model.masters != np.arange(len(shell.frames)))
    assert len(twins)
    np.testing.assert_array_equal(
        result.frames[-1][nodes[twins]], result.frames[-1][nodes[shell.model.masters[twins]]]
    )


@pytest.mark.parametrize(
    ("scheme", "step"),
    [(fl.GeneralisedAlpha(), 1e-4), (fl.Explicit(), 1.5e-6)],
    ids=["implicit", "explicit"],
)
def test_other_schemes_fall_alike(scheme, step):
    """A cantilever under its weight, against quadrilaterals only."""
    falls = []
    quads = fl.mesh.parametric_surface(flat, (4, 4))
    for mesh in (mixed(quads), quads):
        scene = fl.Scene(gravity=(0, 0, -9.81))
        shell = scene.add(fl.Shell(mesh, LAYER, name="sheet"))
        shell.clamp("a=0")
        run = scheme.run(scene, duration=1.5e-3, step=step, save_every=1000)
        falls.append(run.displacement("sheet.11")[-1, 2])
    np.testing.assert_allclose(falls[0], falls[1], rtol=0.1)


def drawn(tmp_path, order):
    """Two rectangles, one of quadrilaterals, as a file of gmsh."""
    file = tmp_path / "mixed.msh"
    with empty_model() as session:
        occ = session.model.occ
        both = [(2, occ.addRectangle(x, 0, 0, 1, 1)) for x in (0, 1)]
        occ.fragment(both[:1], both[1:])
        occ.synchronize()
        session.model.mesh.setRecombine(2, 1)
        for name, tag in {"left": 1, "right": 2}.items():
            session.model.addPhysicalGroup(2, [tag], name=name)
        ends = {0.0: "start", 2.0: "end"}
        for _, tag in session.model.getEntities(1):
            x = occ.getCenterOfMass(1, tag)[0]
            for at, name in ends.items():
                if abs(x - at) < 1e-9:
                    session.model.addPhysicalGroup(1, [tag], name=name)
        session.option.setNumber("Mesh.MeshSizeMax", 0.25)
        session.option.setNumber("Mesh.ElementOrder", order)
        session.model.mesh.generate(2)
        session.write(str(file))
    return file


@pytest.mark.parametrize("order", [1, 2])
def test_files_of_gmsh(tmp_path, order):
    """Sections and loads by groups, pictures, files for ParaView, functions; a strip in tension."""
    mesh = fl.mesh.read_gmsh_surface(drawn(tmp_path, order))
    assert [part.mesh.cell for part in mesh.parts] == ["triangle", "quadrilateral"]
    assert mesh.degree == order
    thick = fl.ShellSection.layer(2 * T, fl.Material(E, 0.0, DENSITY))
    thin = fl.ShellSection.layer(T, fl.Material(E, 0.0, DENSITY))
    strip = fl.Shell(mesh, {"left": thick, "right": thin}, name="strip")
    strip.clamp("start")
    scene = fl.Scene()
    scene.add(strip)
    scene.add(fl.loads.EdgeLoad(strip, "end", force=(1e3, 0, 0)))
    result = fl.statics(scene)
    end = [result.displacement(point)[-1, 0] for point in strip.points("end")]
    np.testing.assert_allclose(end, 1.5e3 / (E * T), rtol=1e-5)
    result.picture(tmp_path / "strip.png")
    result.page(tmp_path / "strip.html")
    result.write_vtk(tmp_path / "strip.pvd")
    assert result.functions(strip)["displacement"].x.array.max() == pytest.approx(end[0])
    import pyvista

    grid = pyvista.read(next((tmp_path / "strip").glob("*.vtu")))
    counts = {int(kind): int((grid.celltypes == kind).sum()) for kind in set(grid.celltypes)}
    assert counts == {5: len(mesh.parts[0].cells), 9: len(mesh.parts[1].cells)}


def test_results_from_a_file_are_those_of_the_run(tmp_path):
    shell = sheet((2, 2))
    shell.clamp("a=0")
    scene = fl.Scene(gravity=(0, 0, -9.81))
    scene.add(shell)
    result = fl.GeneralisedAlpha().run(scene, duration=0.01, step=1e-3, file=tmp_path / "run.h5")
    loaded = fl.Result.load(tmp_path / "run.h5")
    np.testing.assert_array_equal(loaded.frames, result.frames)
    np.testing.assert_array_equal(loaded.info.bodies[0].faces, result.info.bodies[0].faces)
    thicker = fl.Scene(gravity=(0, 0, -9.81))
    mesh = mixed(fl.mesh.parametric_surface(flat, (2, 2)))
    other = thicker.add(
        fl.Shell(mesh, fl.ShellSection.layer(1.1 * T, fl.Material(E, NU, DENSITY)), name="sheet")
    )
    other.clamp("a=0")
    with pytest.raises(ValueError, match="what differs: contents of sheet"):
        fl.GeneralisedAlpha().resume(thicker, tmp_path / "run.h5")


def test_what_needs_one_type_says_so():
    shell = sheet((2, 2))
    shell.clamp("a=0")
    scene = fl.Scene()
    scene.add(shell)
    result = fl.statics(scene)
    one = "needs cells of one type, but sheet has triangles and quadrilaterals"
    with pytest.raises(ValueError, match=one):
        fl.post.resultants(result, shell)
    with pytest.raises(ValueError, match=one):
        fl.contact.ShellSurface(shell)
    with pytest.raises(ValueError, match="convected_axes=True needs cells of one type"):
        sheet((2, 2), convected_axes=True)
    with pytest.raises(ValueError, match=f"the error in space {one}"):
        fl.adaptivity.space_error(result, shell, scene)
    with pytest.raises(TypeError, match="got MixedSurfaceMesh"):
        fl.adaptivity.refine(shell.model.mesh, [0])


WRONG = {
    "cell": ({"triangles": [(0, 1, 2)]}, "cell must be 'triangle' or 'quadrilateral'"),
    "count": ({"triangle": [(0, 1)]}, "must have"),
    "point": ({"triangle": [(0, 1, 9)]}, r"cells must be in 0 … 4"),
    "alone": ({"triangle": [(1, 4, 3)]}, "2 points have no cell, the first is 0"),
    "side": ({"triangle": [(1, 3, 4)], "quadrilateral": [(0, 1, 2, 3)]}, "point to opposite sides"),
    "overlap": ({"triangle": [(0, 1, 3), (1, 4, 3)], "quadrilateral": [(0, 1, 2, 3)]}, "on top of"),
}


@pytest.mark.parametrize(("cells", "match"), WRONG.values(), ids=WRONG)
def test_wrong_cells(cells, match):
    points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0), (2, 0, 0)]
    with pytest.raises(ValueError, match=match):
        MixedSurfaceMesh.from_cells(points, cells)


def test_orders_are_not_mixed():
    coarse = fl.mesh.parametric_surface(square, (1, 1), degree=2)
    points = np.vstack([coarse.points, [[2, 0, 0]]])
    with pytest.raises(ValueError, match="cells of one order, got those of order 1 and 2"):
        MixedSurfaceMesh.from_cells(
            points, {"quadrilateral": coarse.cells, "triangle": [(coarse.cells[0, 1], 9, 8)]}
        )


@pytest.mark.parametrize("kinds", [("quadrilateral",), ("triangle", "quadrilateral")])
def test_curves_and_points_are_named_by_place(kinds):
    """Curves of the rim alone; parts of the mesh and shells know the names, too."""
    x = [(a, b, 0.0) for b in (0.0, 1.0) for a in (0.0, 1.0, 2.0)]
    cells = {"triangle": [(0, 1, 3), (1, 4, 3)], "quadrilateral": [(1, 2, 4, 5)]}
    if kinds == ("quadrilateral",):
        both = [(0, 1, 3, 4), *cells["quadrilateral"]]
        mesh = fl.mesh.SurfaceMesh.from_cells(x, both, "quadrilateral", curves={"old": [(0, 3)]})
    else:
        mesh = fl.mesh.MixedSurfaceMesh.from_cells(x, cells, curves={"old": [(0, 3)]})
    named = mesh.named(
        curves={"lower": lambda x: x[1] == 0, "rim": lambda x: x[0] >= 0},
        points={"middle": lambda x: x[0] == 1},
    )
    assert sorted(map(tuple, np.sort(named.curve("lower"), axis=1))) == [(0, 1), (1, 2)]
    assert len(named.curve("rim")) == 6, "not the edges between cells"
    np.testing.assert_array_equal(named.nodes("middle"), [1, 4])
    np.testing.assert_array_equal(named.curve("old"), [(0, 3)])
    assert list(mesh.curves) == ["old"], "the mesh itself is as it was"
    shell = fl.Shell(named, fl.ShellSection.layer(0.01, fl.Material(2e11, 0.3, 7e3)))
    assert sorted(point.node for point in shell.points("lower")) == [0, 1, 2]
    for part in shell.parts:
        assert {"lower", "rim", "old"} <= set(part.shell.model.mesh.curves)
    with pytest.raises(ValueError, match="curve 'none': nothing is there"):
        mesh.named(curves={"none": lambda x: x[0] > 5})
    with pytest.raises(ValueError, match="curve 'one': expected a function of positions"):
        mesh.named(curves={"one": lambda x: True})
