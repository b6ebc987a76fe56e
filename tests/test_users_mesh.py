"""Meshes of DOLFINx are taken as they are: the user's own mesh is that of the forms."""

from mpi4py import MPI

import basix.ufl
import dolfinx
import numpy as np
import pytest
from scipy import special

import fem_lie as fl
from tests.own_meshes import mesh_of, own_mesh
from tests.test_mesh import _circle, _circle_centre
from tests.test_shells import square

MATERIAL = fl.Material(1e7, 0.3, 1e3)
LAYER = fl.ShellSection.layer(0.02, MATERIAL)
SECTION = fl.Section.circle(0.02, MATERIAL)
COMMUNICATORS = pytest.mark.parametrize(
    "comm", [MPI.COMM_SELF, MPI.COMM_WORLD], ids=["self", "world"]
)


def plate(comm: MPI.Intracomm, cell: str) -> dolfinx.mesh.Mesh:
    """A strip in space, bowed; its triangles look to both sides."""
    mesh = fl.mesh.parametric_surface(lambda a, b: (2 * a, b / 2, 0.2 * a * a), (8, 2), cell=cell)
    cells = mesh.cells.copy()
    if cell == "triangle":
        cells[::3] = cells[::3][:, [0, 2, 1]]
    return own_mesh(mesh.points, cells, cell, comm)


def line(comm: MPI.Intracomm) -> dolfinx.mesh.Mesh:
    """Straight."""
    points = np.outer(np.linspace(0.0, 1.0, 9), (1.0, 0.2, 0.3))
    cells = np.column_stack([np.arange(8), np.arange(1, 9)])
    return own_mesh(points, cells, "interval", comm)


def bare(mesh: dolfinx.mesh.Mesh) -> fl.mesh.LineMesh:
    """The same cells, which come from no mesh of DOLFINx."""
    return fl.mesh.LineMesh.from_cells(mesh.geometry.x, fl.mesh.lines_from_dolfinx(mesh).cells)


def tip(body: fl.Beam | fl.Cable | fl.Shell) -> np.ndarray:
    """Where it ends under a load at one end, held at the other."""
    x = body.frames[:, 0, 0]
    scene = fl.Scene()
    scene.add(body)
    for node in np.flatnonzero(x == x.min()):
        if isinstance(body, fl.Cable):
            body.clamp(body.point(int(node)))
        else:
            scene.add(fl.Clamp(body.point(int(node))))
    for node in np.flatnonzero(x == x.max()):
        scene.add(fl.PointLoad(body.point(int(node)), force=(0.0, 0.0, 0.02)))
    frames = fl.statics(scene).frames[-1]
    return frames[:, 0]


@COMMUNICATORS
@pytest.mark.parametrize("cell", ["triangle", "quadrilateral"])
def test_a_shell_is_on_the_mesh_that_it_was_given(comm, cell):
    mesh = plate(comm, cell)
    shell = fl.Shell(mesh, LAYER)
    # triangles have been turned round
    assert (mesh_of(shell) is mesh) == (cell == "quadrilateral")
    other = fl.Shell(
        fl.mesh.SurfaceMesh.from_cells(mesh.geometry.x, shell.model.mesh.cells, cell), LAYER
    )
    assert mesh_of(other) is not mesh
    np.testing.assert_allclose(tip(shell), tip(other), atol=1e-9)


@COMMUNICATORS
@pytest.mark.parametrize(
    "formulation",
    [
        fl.elements.GeodesicBeam(),
        fl.elements.DirectorBeam(1),
        fl.elements.DirectorBeam(2),
        fl.elements.KirchhoffRod(),
    ],
    ids=repr,
)
def test_a_beam_is_on_the_mesh_that_it_was_given(comm, formulation):
    mesh = line(comm)
    beam = fl.Beam(mesh, SECTION, formulation=formulation)
    # where cells follow each other none has to be turned round
    assert (np.diff(bare(mesh).cells) == 1).all() and mesh_of(beam) is mesh
    other = fl.Beam(bare(mesh), SECTION, formulation=formulation)
    np.testing.assert_allclose(tip(beam), tip(other), atol=1e-9)


@COMMUNICATORS
@pytest.mark.parametrize(
    "formulation", [fl.elements.HermiteCable(), fl.elements.DiscreteCable()], ids=repr
)
def test_a_cable_is_on_the_mesh_that_it_was_given(comm, formulation):
    mesh = line(comm)
    cable = fl.Cable(mesh, SECTION, formulation=formulation)
    assert mesh_of(cable) is mesh
    other = fl.Cable(bare(mesh), SECTION, formulation=formulation)
    assert mesh_of(other) is not mesh
    np.testing.assert_allclose(tip(cable), tip(other), atol=1e-9)


def test_an_ancf_beam_goes_along_a_mesh_that_it_was_given():
    mesh = line(MPI.COMM_SELF)
    np.testing.assert_array_equal(
        fl.AncfBeam(mesh, SECTION).frames, fl.AncfBeam(bare(mesh), SECTION).frames
    )


@pytest.mark.parametrize("kind", [fl.Beam, fl.Rod, fl.Cable, fl.AncfBeam])
def test_a_line_along_a_mesh_of_another_dimension_is_refused(kind):
    with pytest.raises(ValueError, match=r"must consist of intervals.*got quadrilateral"):
        kind(plate(MPI.COMM_SELF, "quadrilateral"), SECTION)
    with pytest.raises(TypeError, match=rf"{kind.__name__}: mesh must be a LineMesh.*SurfaceMesh"):
        kind(fl.mesh.parametric_surface(lambda a, b: (a, b, 0), (1, 1)), SECTION)


def test_two_bodies_of_a_kind_are_assembled_on_one_mesh_of_their_own():
    bodies = [fl.Shell(plate(MPI.COMM_SELF, "quadrilateral"), LAYER) for _ in range(2)]
    assert [mesh_of(body) for body in bodies] == [body.model.source for body in bodies]
    mesh = bodies[0].model.assemble([b.model for b in bodies]).forms.increment.function_space.mesh
    assert mesh not in [body.model.source for body in bodies]


def test_a_body_that_was_moved_from_its_mesh_is_not_on_it():
    mesh = plate(MPI.COMM_SELF, "quadrilateral")
    shell = fl.Shell(mesh, LAYER)
    shell.frames[:, 0] += (0.0, 0.0, 1e-3)
    assert mesh_of(shell) is not mesh


def test_a_dolfinx_mesh_keeps_its_numbers_and_tags():
    point, _ = _circle(2.0)
    s = np.linspace(0, 1, 7)
    cells = np.column_stack([np.arange(6), np.arange(1, 7)]).astype(np.int64)
    mesh = own_mesh([point(si) for si in s], cells, "interval")
    middle = dolfinx.mesh.compute_midpoints(mesh, 1, np.arange(6, dtype=np.int32))
    tags = dolfinx.mesh.meshtags(mesh, 1, np.array([4, 5], np.int32), np.array([3, 3], np.int32))
    tip = dolfinx.mesh.locate_entities(
        mesh, 0, lambda x: np.linalg.norm(x.T - point(1), axis=1) < 1e-9
    )
    vertex_tags = dolfinx.mesh.meshtags(mesh, 0, tip, np.array([1], np.int32))
    lines = fl.mesh.lines_from_dolfinx(
        mesh, tags, vertex_tags, groups={"end": 3}, named_points={"tip": 1}
    )
    np.testing.assert_allclose(lines.points[lines.cells].mean(axis=1), middle, atol=1e-15)
    np.testing.assert_array_equal(lines.group("end"), [4, 5])
    np.testing.assert_allclose(lines.points[lines.named("tip")], [point(1)], atol=1e-15)
    assert set(fl.mesh.lines_from_dolfinx(mesh, tags).groups) == {"3"}
    radius = np.linalg.norm(lines.points - _circle_centre(), axis=1)
    np.testing.assert_allclose(radius, 1, rtol=1e-14)
    with pytest.raises(ValueError, match=r"no tag 9 \(for 'x'\); it has: \[3\]"):
        fl.mesh.lines_from_dolfinx(mesh, tags, groups={"x": 9})
    with pytest.raises(ValueError, match=r"\['x'\] need vertex_tags"):
        fl.mesh.lines_from_dolfinx(mesh, tags, named_points={"x": 9})


def test_dolfinx_mesh_with_tags_is_the_same_mesh():
    plane = dolfinx.mesh.create_rectangle(
        MPI.COMM_SELF, [(0, 0), (2, 1)], [3, 2], dolfinx.mesh.CellType.quadrilateral
    )
    with pytest.raises(ValueError, match="gdim 2"):
        fl.mesh.surface_from_dolfinx(plane)
    given = fl.mesh.parametric_surface(square, (3, 2))
    mesh = own_mesh(given.points, given.cells, "quadrilateral")
    mesh.topology.create_connectivity(1, 2)
    facets = dolfinx.mesh.locate_entities_boundary(mesh, 1, lambda x: x[0] < 1e-9)
    tags = dolfinx.mesh.meshtags(mesh, 1, facets, np.full(len(facets), 7, dtype=np.int32))
    found = fl.mesh.surface_from_dolfinx(mesh, facet_tags=tags, curves={"left": 7})
    np.testing.assert_array_equal(found.points[found.nodes("left"), 0], 0.0)
    assert len(found.curve("left")) == 2
    with pytest.raises(ValueError, match=r"no tag 8 .*it has: \[7\]"):
        fl.mesh.surface_from_dolfinx(mesh, facet_tags=tags, curves={"left": 8})


# --- cells of second order ------------------------------------------------------------------------

CELLS = ["triangle", "quadrilateral"]


def of_second_order(points, cells, cell: str) -> dolfinx.mesh.Mesh:
    element = basix.ufl.element("Lagrange", cell, 2, shape=(3,))
    nodes, x = np.asarray(cells, dtype=np.int64), np.asarray(points, dtype=float)
    return dolfinx.mesh.create_mesh(MPI.COMM_SELF, cells=nodes, x=x, e=element)


def curve_of(function, cells: int, middle: float = 0.53) -> dolfinx.mesh.Mesh:
    """Three-node cells along a function of 0 to 1, by default with nodes off the middle."""
    s = np.linspace(0.0, 1.0, cells + 1)
    points = [function(t) for t in (*s, *((1 - middle) * s[:-1] + middle * s[1:]))]
    ends = np.column_stack([np.arange(cells), np.arange(1, cells + 1)])
    return of_second_order(
        points, np.column_stack([ends, cells + 1 + np.arange(cells)]), "interval"
    )


def arc(t: float) -> tuple[float, float, float]:
    """Three quarters of a circle of radius 2."""
    return 2 * np.sin(1.5 * np.pi * t), 0.0, 2 - 2 * np.cos(1.5 * np.pi * t)


def ellipse(t: float) -> tuple[float, float, float]:
    return 2 * np.cos(np.pi / 2 * t), 0.0, np.sin(np.pi / 2 * t)


def test_a_beam_takes_the_geometry_of_three_node_cells():
    mesh = curve_of(arc, 5)
    beam = fl.Beam(mesh, SECTION)
    np.testing.assert_array_equal(beam.frames[:, 0], mesh.geometry.x)
    from_centre = beam.frames[:, 0] - (0, 0, 2)
    np.testing.assert_allclose(
        np.einsum("nj,nj->n", beam.frames[:, 1], from_centre), 0.0, atol=1e-14
    )
    assert beam.model.lengths.sum() == pytest.approx(3 * np.pi, rel=1e-13)
    # the same points, known to be on a curve
    cells = fl.mesh.lines_from_dolfinx(mesh).cells
    other = fl.Beam(
        fl.mesh.LineMesh.from_cells(mesh.geometry.x, cells, kink_angle=np.radians(40)), SECTION
    )
    np.testing.assert_allclose(beam.frames, other.frames, atol=1e-14)
    np.testing.assert_allclose(tip(beam), tip(other), atol=1e-9)


def test_lines_of_second_order_converge_to_the_curve():
    """Arc lengths of the parts of an ellipse; tangents of circles are of second order."""
    errors = []
    for count in (4, 8, 16, 32):
        model = fl.Beam(curve_of(ellipse, count, 0.5), SECTION).model
        ends = model.frames[model.elements, 0]
        exact = 2 * np.diff(special.ellipeinc(np.arctan2(ends[..., 0] / 2, ends[..., 2]), 0.75))
        errors.append(np.abs(model.lengths - np.abs(exact).ravel()).sum())
    slopes = np.log2(np.divide(errors[:-1], errors[1:]))
    assert errors[0] < 2e-3
    np.testing.assert_allclose(slopes, 3.0, atol=0.1)


@pytest.mark.parametrize("kind", [fl.Rod, fl.Cable, fl.AncfBeam])
def test_other_lines_along_three_node_cells(kind):
    mesh = curve_of(arc, 12)
    np.testing.assert_array_equal(kind(mesh, SECTION).frames[:25, 0], mesh.geometry.x)


def test_corners_between_three_node_cells_stay():
    points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0.5, 0, 0), (1, 0.5, 0)]
    lines = fl.mesh.lines_from_dolfinx(of_second_order(points, [[0, 1, 3], [1, 2, 4]], "interval"))
    np.testing.assert_allclose(np.abs(lines.tangents[:2]), [[(1, 0, 0)] * 2] * 2, atol=1e-15)
    np.testing.assert_allclose(np.abs(lines.tangents[2:]), [[(0, 1, 0)] * 2] * 2, atol=1e-15)
    mesh = curve_of(ellipse, 4)
    smooth, sharp = (fl.mesh.lines_from_dolfinx(mesh, kink_angle=angle) for angle in (None, 0.0))

    def jump(lines: fl.mesh.LineMesh) -> float:
        """Largest, between ends of cells at a vertex."""
        pairs = [np.flatnonzero((lines.cells == node).any(axis=1)) for node in (1, 2, 3)]
        return max(np.abs(lines.tangents[a, 1] - lines.tangents[b, 0]).max() for a, b in pairs)

    jumps = jump(smooth), jump(sharp)
    assert jumps[0] < 1e-14 < 1e-3 < jumps[1]


def test_groups_and_fields_of_three_node_cells():
    mesh = curve_of(arc, 5)
    tags = dolfinx.mesh.meshtags(mesh, 1, np.array([1, 3], np.int32), np.array([3, 3], np.int32))
    found = dolfinx.mesh.locate_entities_boundary(
        mesh, 0, lambda x: np.linalg.norm(x.T - arc(1.0), axis=1) < 1e-9
    )
    ends = dolfinx.mesh.meshtags(mesh, 0, found, np.array([7], np.int32))
    lines = fl.mesh.lines_from_dolfinx(mesh, tags, ends, groups={"mid": 3}, named_points={"end": 7})
    np.testing.assert_array_equal(lines.group("mid"), [2, 3, 6, 7])
    np.testing.assert_allclose(lines.points[lines.named("end")], [arc(1.0)], atol=1e-15)
    beam = fl.Beam(lines, SECTION)
    scene = fl.Scene()
    scene.add(beam)
    scene.add(fl.Clamp(beam.point(arc(0.0))))
    scene.add(fl.PointLoad(beam.point("end"), force=(0, 0.01, 0.02)))
    u = (result := fl.statics(scene)).functions(beam)["displacement"]
    assert u.function_space.mesh is mesh and u.function_space.ufl_element().degree == 2
    moved = result.frames[-1][result.info.body(beam.name).nodes, 0] - beam.frames[:, 0]
    at = u.function_space.tabulate_dof_coordinates()
    nearest = np.linalg.norm(at[:, np.newaxis] - beam.frames[:, 0], axis=2).argmin(axis=1)
    np.testing.assert_allclose(u.x.array.reshape(-1, 3), moved[nearest], atol=1e-14)
    assert np.abs(moved).max() > 1e-3


def curved(cell: str) -> dolfinx.mesh.Mesh:
    """A strip of a cylinder; its triangles look to both sides."""

    def bent(a: float, b: float) -> tuple[float, float, float]:
        return 2 * np.sin(a), b / 2, 2 * np.cos(a)

    mesh = fl.mesh.parametric_surface(bent, (6, 2), cell=cell, degree=2)
    cells = mesh.cells.copy()
    if cell == "triangle":
        cells[::3] = cells[::3][:, [0, 2, 1, 3, 5, 4]]
    return of_second_order(mesh.points, cells, cell)


@pytest.mark.parametrize("cell", CELLS)
def test_a_shell_takes_the_geometry_of_second_order_cells(cell):
    mesh = curved(cell)
    shell = fl.Shell(mesh, LAYER)
    np.testing.assert_array_equal(shell.frames[:, 0], mesh.geometry.x)
    given = shell.model.mesh
    radial = given.points[given.cells] * (0.5, 0.0, 0.5)
    cosines = np.abs(np.einsum("mkj,mkj->mk", given.normals, radial))
    np.testing.assert_allclose(cosines, 1.0, atol=1e-4)  # of flat cells 3e-3
    other = fl.Shell(fl.mesh.SurfaceMesh.from_cells(given.points, given.cells, given.cell), LAYER)
    np.testing.assert_allclose(tip(shell), tip(other), atol=1e-9)
    assert (mesh_of(shell) is mesh) == (cell == "quadrilateral")


@pytest.mark.parametrize("cell", CELLS)
def test_fields_of_second_order_surfaces_are_on_the_given_mesh(cell, tmp_path):
    mesh = curved(cell)
    shell = fl.Shell(mesh, LAYER)
    scene = fl.Scene()
    scene.add(shell)
    for node in np.flatnonzero(shell.frames[:, 0, 0] < 1e-9):
        scene.add(fl.Clamp(shell.point(int(node))))
    scene.add(fl.PointLoad(shell.point(int(shell.frames[:, 0, 0].argmax())), force=(0, 0, 0.1)))
    result = fl.statics(scene)
    u = result.functions(shell)["displacement"]
    space = u.function_space
    assert space.mesh is mesh and space.ufl_element().degree == 2
    moved = result.frames[-1][result.info.body(shell.name).nodes, 0] - shell.frames[:, 0]
    at = space.tabulate_dof_coordinates()
    away = np.linalg.norm(at[:, np.newaxis] - shell.frames[:, 0], axis=2)
    np.testing.assert_allclose(away.min(axis=1), 0.0, atol=1e-12)
    values = u.x.array.reshape(-1, 3)
    np.testing.assert_allclose(values, moved[away.argmin(axis=1)], atol=1e-14)
    assert np.abs(moved).max() > 1e-4
    result.write_vtx(tmp_path / "shell.bp", shell)


@pytest.mark.parametrize("cell", CELLS)
def test_curves_of_second_order_edges(cell):
    mesh = curved(cell)
    mesh.topology.create_connectivity(1, 2)
    facets = dolfinx.mesh.locate_entities_boundary(mesh, 1, lambda x: x[0] < 1e-9)
    tags = dolfinx.mesh.meshtags(mesh, 1, facets, np.full(len(facets), 7, dtype=np.int32))
    found = fl.mesh.surface_from_dolfinx(mesh, facet_tags=tags, curves={"left": 7})
    assert found.curve("left").shape == (2, 3)
    np.testing.assert_allclose(found.points[found.nodes("left"), 0], 0.0, atol=1e-14)
    shell = fl.Shell(found, LAYER)
    shell.clamp("left")
    assert shell.model.held.any(axis=1).sum() == 5


def test_meshes_of_other_orders_are_refused():
    def of(cell: str, degree: int) -> dolfinx.mesh.Mesh:
        element = basix.ufl.element("Lagrange", cell, degree, shape=(3,))
        reference = element.basix_element.points
        x = np.zeros((len(reference), 3))
        x[:, : reference.shape[1]] = reference
        nodes = np.arange(len(x))[np.newaxis]
        return dolfinx.mesh.create_mesh(MPI.COMM_SELF, cells=nodes, x=x, e=element)

    for kind, cell, degree, match in (
        (fl.Beam, "interval", 3, "intervals of order 1 or 2, got interval cells with 4 nodes"),
        (fl.Shell, "triangle", 3, r"triangles \(3 or 6 nodes\).*got triangle cells with 10 nodes"),
        (fl.Shell, "quadrilateral", 3, r"\(4 or 9 nodes\).*quadrilateral cells with 16 nodes"),
        (fl.Shell, "interval", 2, "got interval cells with 3 nodes"),
    ):
        with pytest.raises(ValueError, match=match):
            kind(of(cell, degree), SECTION if kind is fl.Beam else LAYER)
    eight = basix.ufl.element("S", "quadrilateral", 2, shape=(3,))
    x = np.array([(0, 0), (1, 0), (0, 1), (1, 1), (0.5, 0), (0, 0.5), (1, 0.5), (0.5, 1)])
    x, nodes = np.column_stack([x, np.zeros(8)]), np.arange(8)[np.newaxis]
    serendipity = dolfinx.mesh.create_mesh(MPI.COMM_SELF, cells=nodes, x=x, e=eight)
    with pytest.raises(ValueError, match=r"\(4 or 9 nodes\).*cells with 8 nodes"):
        fl.Shell(serendipity, LAYER)
    back = [(0, 0, 0), (1, 0, 0), (2, 0, 0)]
    with pytest.raises(ValueError, match=r"turns by 90° or more at its middle node.*end, end, mid"):
        fl.Beam(of_second_order(back, [[0, 1, 2]], "interval"), SECTION)


def test_mixed_elements_of_second_order_surfaces_are_refused_by_name():
    with pytest.raises(ValueError, match="HellingerReissner"):
        fl.Shell(curved("quadrilateral"), LAYER, formulation=fl.elements.HellingerReissner())
