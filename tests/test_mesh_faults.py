"""Meshes that are none, and choices that a reader of meshes makes and says."""

import logging

from mpi4py import MPI

import dolfinx
import gmsh
import numpy as np
import pytest
from dolfinx import cpp

import fem_lie as fl

MATERIAL = fl.Material(1e9, 0.3, 1000.0)
SECTION = fl.Section.circle(0.01, MATERIAL)
LAYER = fl.ShellSection.layer(0.01, MATERIAL)
SQUARE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]  # around it
PLATE = fl.mesh.parametric_surface(lambda a, b: (2 * a, b, 0), (3, 2))


def quadrilateral(points, cells=((0, 1, 2, 3),)) -> fl.mesh.SurfaceMesh:
    return fl.mesh.SurfaceMesh.from_cells(points, cells, "quadrilateral")


def with_cell(cell: int, points) -> np.ndarray:
    cells = PLATE.cells.copy()
    cells[cell] = points
    return cells


def quadratic(cell: str, node: int, position) -> fl.mesh.SurfaceMesh:
    """A cell of degree 2 with one of its nodes moved."""
    mesh = fl.mesh.parametric_surface(lambda a, b: (a, b, 0), (1, 1), cell=cell, degree=2)
    points = mesh.points.copy()
    points[mesh.cells[0, node]] = position
    return fl.mesh.SurfaceMesh.from_cells(points, mesh.cells, cell)


def tangled() -> fl.mesh.SurfaceMesh:
    """A corner of triangles is moved over their opposite sides."""
    mesh = fl.mesh.parametric_surface(lambda a, b: (a, b, 0), (2, 2), cell="triangle")
    points = mesh.points.copy()
    points[4] = (1.4, 1.3, 0)
    return fl.mesh.SurfaceMesh.from_cells(points, mesh.cells, "triangle")


def tilted(angle: float) -> fl.Shell:
    return fl.Shell(PLATE, LAYER, director=lambda x: (np.sin(angle), 0, np.cos(angle)))


CASES = {
    "corners one after the other": (
        lambda: quadrilateral(SQUARE),
        r"cell 0 \(points \[0 1 2 3\]\) crosses itself.*row by row.*here that is \[0 1 3 2\]",
    ),
    "one bow tie among cells": (
        lambda: quadrilateral(PLATE.points, with_cell(2, PLATE.cells[2][[0, 1, 3, 2]])),
        "cell 2 .*crosses itself like a bow tie, as 1 of 6",
    ),
    "the other bow tie": (
        lambda: quadrilateral([SQUARE[i] for i in (0, 2, 1, 3)]),
        "crosses itself",
    ),
    "re-entrant corner": (
        lambda: quadrilateral([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0.3, 0.3, 0)]),
        r"re-entrant corner at point 3, \[0\.3 0\.3 0",
    ),
    "re-entrant corner in a fold": (
        lambda: quadrilateral([(0, 0, 0), (1, 0, 0.2), (0, 1, 0.2), (0.2, 0.2, 0.1)]),
        "re-entrant corner at point 3",
    ),
    "corner on a side": (
        lambda: quadrilateral([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0.5, 0.5, 0)]),
        "no area at a corner|re-entrant",
    ),
    "far off, and flat": (
        lambda: quadrilateral(1e6 + np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0.5, 0.5, 0)])),
        "no area at a corner|re-entrant",
    ),
    "middle of an edge outside": (
        lambda: quadratic("quadrilateral", 4, (3.0, 0.5, 0)),
        "folds over",
    ),
    "middle of an edge of a triangle outside": (
        lambda: quadratic("triangle", 4, (-2.0, 0.5, 0)),
        "folds over",
    ),
    "turned over": (tangled, "lie on top of each other"),
    "two flat cells on each other": (
        lambda: fl.mesh.SurfaceMesh.from_cells(
            [*SQUARE[:3], (0.4, 0.2, 0)], [(0, 1, 2), (0, 1, 3)], "triangle"
        ),
        r"cells 0 and 1 lie on top of each other beside their edge from point 0 to 1",
    ),
    "two points at one position": (
        lambda: fl.mesh.SurfaceMesh.from_cells(
            [(0, 0, 0), (1, 0, 0), (1, 0, 0)], [(0, 1, 2)], "triangle"
        ),
        "no area",
    ),
    "a point that is infinite": (
        lambda: quadrilateral([*SQUARE[:3], (0, np.inf, 0)]),
        "points must be finite; point 3",
    ),
    "points that are words": (
        lambda: quadrilateral([("a", "b", "c")] * 4),
        "points must be numbers",
    ),
    "a point without cell": (
        lambda: quadrilateral([*PLATE.points, (9, 9, 9)], PLATE.cells),
        "1 points have no cell, the first is 12",
    ),
    "normals of another surface": (
        lambda: fl.mesh.SurfaceMesh.from_cells(
            PLATE.points,
            PLATE.cells,
            "quadrilateral",
            normals=np.tile((np.sin(1.2), 0, np.cos(1.2)), (6, 4, 1)),
        ),
        "69° off that of its points",
    ),
    "a curve between cells": (
        lambda: fl.mesh.SurfaceMesh.from_cells(
            PLATE.points, PLATE.cells, "quadrilateral", curves={"side": [(0, 1), (0, 5)]}
        ),
        r"edge 1 of curve 'side', points \[0 5\], is no edge of a cell",
    ),
    "a curve of triples": (
        lambda: fl.mesh.SurfaceMesh.from_cells(
            PLATE.points, PLATE.cells, "quadrilateral", curves={"side": [(0, 1, 2)]}
        ),
        "edges of 2 points",
    ),
    "a group of nothing": (
        lambda: fl.mesh.SurfaceMesh.from_cells(
            PLATE.points, PLATE.cells, "quadrilateral", groups={"skin": []}
        ),
        "cells of 'skin' are none",
    ),
    "a director 45° off": (lambda: tilted(np.pi / 4), "is 45° off.*kink angle of 40°"),
    "a section of bow ties": (
        lambda: fl.sections.SectionMesh(
            np.array(SQUARE)[:, :2], np.array([[0, 1, 2, 3]]), np.array([0]), ("a",),
            "quadrilateral", 1,
        ),
        "crosses itself",
    ),
    "a polyline that turns back": (
        lambda: fl.mesh.polyline([(0, 0, 0), (1, 0, 0), (0.5, 0, 0)], 2),
        r"cells 1 and 2 lie on top of each other at \[1\. 0\. 0\.\].* goes back",
    ),
    "two members on each other": (
        lambda: fl.mesh.LineMesh.from_cells(
            [(0, 0, 0), (1, 0, 0), (2, 0, 0), (1, 1, 0)], [(3, 0), (0, 1), (0, 2)]
        ),
        r"cells 1 and 2 lie on top of each other at \[0\. 0\. 0\.\]",
    ),
    "a polyline of one point": (
        lambda: fl.mesh.polyline([(0, 0, 0)], 2),
        "two points or more, got 1",
    ),
    "a polyline that stands still": (
        lambda: fl.mesh.polyline([(0, 0, 0), (1, 0, 0), (1, 0, 0)], 2),
        "must have a length",
    ),
    "numbers of cells of other pieces": (
        lambda: fl.mesh.polyline([(0, 0, 0), (1, 0, 0), (1, 1, 0)], [2, 2, 2]),
        "of 2 pieces, got 3",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_a_mesh_that_is_none_is_refused(name):
    make, message = CASES[name]
    with pytest.raises(ValueError, match=f"(?s){message}"):
        make()


@pytest.mark.parametrize("offset", [0.0, 1e6])
@pytest.mark.parametrize("size", [1e-6, 1.0, 1e3])
def test_cells_that_are_only_distorted_are_taken(offset, size):
    """Warped, nearly re-entrant, slender; and quadratic ones that follow a third of a circle."""
    points = [(0, 0, 0), (1, 0, 0.3), (0, 1, 0.3), (0.55, 0.55, 0)]
    quadrilateral(offset * size + size * np.array(points))
    fl.mesh.parametric_surface(
        lambda a, b: size * np.array([a, 1e-3 * b, 0]) + offset * size, (1, 1)
    )
    for cell in ("triangle", "quadrilateral"):
        fl.mesh.parametric_surface(
            lambda a, b: size * np.array([np.cos(2 * a), np.sin(2 * a), b]),
            (1, 1),
            cell=cell,
            degree=2,
        )


def test_a_mesh_of_two_kinds_of_cells_is_refused():
    kinds = [cpp.mesh.CellType.triangle, cpp.mesh.CellType.quadrilateral]
    x = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0), (2, 0, 0)], dtype=np.float64)
    elements = [cpp.fem.CoordinateElement_float64(kind, 1) for kind in kinds]
    limit = () if dolfinx.__version__.startswith("0.9") else (2,)
    partitioner = cpp.mesh.create_cell_partitioner(cpp.mesh.GhostMode.none, *limit)
    cells = [np.array([1, 4, 3]), np.array([0, 1, 2, 3])]
    mixed = cpp.mesh.create_mesh(MPI.COMM_SELF, cells, elements, x.ravel(), partitioner, *limit)
    with pytest.raises(ValueError, match="one kind, got triangle and quadrilateral"):
        fl.mesh.surface_from_dolfinx(dolfinx.mesh.Mesh(mixed, None))


def test_a_director_between_is_said(caplog):
    with caplog.at_level(logging.INFO, logger="fem_lie"):
        tilted(np.radians(30))
    assert "plate" not in caplog.text and "30° off" in caplog.text


def test_points_at_one_position_are_said(caplog):
    points = [(0, 0, 0), (1, 0, 0), (1, 0, 0), (2, 0, 0)]
    with caplog.at_level(logging.WARNING, logger="fem_lie"):
        fl.Beam(fl.mesh.LineMesh.from_cells(points, [(0, 1), (2, 3)]), SECTION, name="two")
    assert "two has 1 pairs of points at the same position, the first are 1 and 2" in caplog.text


# --- gmsh -----------------------------------------------------------------------------------------

BOX = """
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 1, 1, 1};
MeshSize {:} = 1;
"""
FLOOR = 'Physical Surface("floor") = {5};'
MIXED = """
Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {2, 0, 0};
Point(4) = {0, 1, 0}; Point(5) = {1, 1, 0}; Point(6) = {2, 1, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {4, 5}; Line(4) = {5, 6};
Line(5) = {1, 4}; Line(6) = {2, 5}; Line(7) = {3, 6};
Curve Loop(1) = {1, 6, -3, -5}; Plane Surface(1) = {1};
Curve Loop(2) = {2, 7, -4, -6}; Plane Surface(2) = {2};
Transfinite Curve {1:7} = 3; Transfinite Surface {1, 2}; Recombine Surface {2};
"""


def written(tmp_path, text: str, dim: int | None = None):
    """A file; meshed if a dimension is given."""
    path = tmp_path / "model.geo"
    path.write_text(text)
    if dim is None:
        return fl.mesh.run_gmsh_script(path)
    gmsh.initialize(["gmsh", "-v", "0"], readConfigFiles=False)
    try:
        gmsh.open(str(path))
        gmsh.option.setNumber("Mesh.SaveAll", 1)
        gmsh.model.mesh.generate(dim)
        gmsh.write(str(tmp_path / "model.msh"))
    finally:
        gmsh.finalize()
    return tmp_path / "model.msh"


@pytest.mark.parametrize("dim", [None, 3])
def test_the_boundary_of_a_solid_is_a_shell_only_if_it_is_named(tmp_path, caplog, dim):
    with pytest.raises(ValueError, match="1 volumes and no physical group of surfaces"):
        fl.mesh.read_gmsh_surface(written(tmp_path, BOX, dim))
    with caplog.at_level(logging.INFO, logger="fem_lie"):
        mesh = fl.mesh.read_gmsh_surface(written(tmp_path, BOX + FLOOR, dim))
    assert np.ptp(mesh.points[:, 2]) == 0
    assert (
        "the 1 surfaces of physical groups are taken; 5 other surfaces and 1 volumes are left"
        in (caplog.text)
    )


@pytest.mark.parametrize("dim", [None, 3])
def test_a_surface_next_to_a_solid_is_meant_without_a_name(tmp_path, caplog, dim):
    sheet = "Rectangle(99) = {5, 0, 0, 2, 1};"
    with caplog.at_level(logging.INFO, logger="fem_lie"):
        mesh = fl.mesh.read_gmsh_surface(written(tmp_path, BOX + sheet, dim))
    ends = mesh.points.min(axis=0), mesh.points.max(axis=0)
    np.testing.assert_allclose(ends, ((5, 0, 0), (7, 1, 0)), atol=1e-12)
    assert "1 surfaces that bound none of higher dimension are taken; 6 other" in caplog.text


@pytest.mark.parametrize("dim", [None, 2])
def test_edges_of_a_surface_are_beams_only_if_they_are_named(tmp_path, caplog, dim):
    with pytest.raises(ValueError, match="2 surfaces and volumes and no physical group of curves"):
        fl.mesh.read_gmsh_lines(written(tmp_path, MIXED, dim))
    with caplog.at_level(logging.INFO, logger="fem_lie"):
        mesh = fl.mesh.read_gmsh_lines(
            written(tmp_path, MIXED + 'Physical Curve("rib") = {5};', dim)
        )
    assert len(mesh.cells) == 2
    assert "the 1 curves of physical groups are taken" in caplog.text


def test_triangles_alone_of_two_kinds_of_cells_are_said(tmp_path, caplog):
    both = fl.mesh.read_gmsh_surface(written(tmp_path, MIXED))
    assert [part.mesh.cell for part in both.parts] == ["triangle", "quadrilateral"]
    with caplog.at_level(logging.INFO, logger="fem_lie"):
        mesh = fl.mesh.read_gmsh_surface(
            written(tmp_path, MIXED + 'Physical Surface("left") = {1};')
        )
    assert mesh.cell == "triangle"
    assert "1 other surfaces and 0 volumes are left out" in caplog.text


# --- corners --------------------------------------------------------------------------------------


@pytest.mark.parametrize("angle", [2.0, 10.0, 30.0, 39.0, 90.0, 150.0])
@pytest.mark.parametrize("cells", [1, 4])
def test_a_corner_is_a_corner_at_any_angle(angle, cells):
    """Two pieces of 10 are 20 long, whatever they turn by; on an arc they were 20.03 at 30°."""
    turn = np.radians(angle)
    corners = [(0, 0, 0), (10, 0, 0), (10 + 10 * np.cos(turn), 10 * np.sin(turn), 0)]
    beam = fl.Beam.polyline(corners, SECTION, cells=cells)
    np.testing.assert_allclose(beam.model.lengths, 10 / cells, rtol=1e-13)
    np.testing.assert_allclose(beam.point("corner 1").position, corners[1], atol=1e-14)
    np.testing.assert_allclose(beam.point("end").position, corners[2], atol=1e-14)
    s = np.linspace(0, 1, cells + 1)[:, np.newaxis]
    points = np.concatenate(
        [(1 - s) * a + s * b for a, b in zip(*np.array([corners[:-1], corners[1:]]), strict=True)]
    )
    points = np.delete(points, cells + 1, axis=0)
    pairs = [(i, i + 1) for i in range(2 * cells)]
    bare = fl.Beam(fl.mesh.LineMesh.from_cells(points, pairs), SECTION)
    np.testing.assert_allclose(bare.model.lengths, 10 / cells, rtol=1e-13)
    np.testing.assert_allclose(bare.frames, beam.frames, atol=1e-13)
    # one node more on the other side of the corner, which follows
    assert len(beam.frames) == 2 * cells + 2
    assert np.count_nonzero(beam.model.masters != np.arange(len(beam.frames))) == 1
    if cells == 4 and angle < 40.0:
        asked = fl.Beam(
            fl.mesh.LineMesh.from_cells(points, pairs, kink_angle=np.radians(40.0)), SECTION
        )
        assert asked.model.lengths.sum() > 20.0 + 1e-5


def test_a_closed_polyline_has_its_pieces_and_corners():
    mesh = fl.mesh.polyline([(0, 0, 0), (3, 0, 0), (3, 4, 0), (0, 0, 0)], [3, 4, 5])
    assert mesh.points.shape == (12, 3) and set(mesh.named_points) == {
        "start",
        "corner 1",
        "corner 2",
    }
    assert [len(mesh.group(f"piece {k}")) for k in (1, 2, 3)] == [3, 4, 5]
    np.testing.assert_array_equal(mesh.points[mesh.named("corner 2")], [[3, 4, 0]])
    beam = fl.Beam(mesh, {"piece 1": SECTION, "piece 2": SECTION, "piece 3": SECTION})
    np.testing.assert_allclose(beam.model.lengths, 1.0, rtol=1e-14)


def test_a_bent_cantilever_is_two_straight_ones():
    """A load out of plane at the end of a right angle, against Castigliano without shear."""
    E, nu, a, b, force = 1e9, 0.3, 1.0, 0.7, 1e-3
    section = fl.Section.circle(0.01, fl.Material(E, nu, 1.0))
    EI, GJ = section.stiffness[4, 4], section.stiffness[3, 3]
    scene = fl.Scene()
    beam = scene.add(fl.Beam.polyline([(0, 0, 0), (a, 0, 0), (a, b, 0)], section, cells=(10, 7)))
    scene.add(fl.Clamp(beam.point("start")))
    scene.add(fl.PointLoad(beam.point("end"), (0, 0, force)))
    tip = fl.statics(scene).position(beam.point("end"))[-1, 2]
    exact = force * ((a**3 + b**3) / (3 * EI) + b**2 * a / GJ)
    assert tip == pytest.approx(exact, rel=2e-3)
