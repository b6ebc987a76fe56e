"""Meshes of DOLFINx are taken as they are: the user's own mesh is that of the forms."""

from mpi4py import MPI

import dolfinx
import numpy as np
import pytest

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
