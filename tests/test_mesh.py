"""Line meshes: exact tangents, names that survive, and what is refused."""

import math
from pathlib import Path

from mpi4py import MPI

import dolfinx
import gmsh
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import fem_lie as fl
from fem_lie import lie
from tests.drawn import empty_model

BEND = Path(__file__).parents[1] / "meshes" / "bend45.geo"
SPACE_FRAME = BEND.with_name("frame.geo")


def _circle(angle):
    """Unit circle in a plane in space, and its unit tangent."""
    R = lie.so3_exp([0.3, -0.5, 0.7])
    return (
        lambda s: R @ [np.sin(angle * s), 1 - np.cos(angle * s), 0.0],
        lambda s: R @ [np.cos(angle * s), np.sin(angle * s), 0.0],
    )


def _circle_centre():
    return lie.so3_exp([0.3, -0.5, 0.7]) @ [0, 1, 0]


def _exact_ends(mesh, tangent, s):
    return np.array([tangent(si) for si in s])[mesh.cells]


# --- helpers -------------------------------------------------------------------------------------


def test_straight_line_in_equal_cells():
    mesh = fl.mesh.straight_line((1, 2, 3), (1, 2, 7), 4)
    np.testing.assert_array_equal(mesh.points[:, 2], [3, 4, 5, 6, 7])
    np.testing.assert_array_equal(mesh.cells, [[0, 1], [1, 2], [2, 3], [3, 4]])
    np.testing.assert_array_equal(mesh.tangents, np.broadcast_to([0, 0, 1.0], (4, 2, 3)))
    assert (mesh.named("start"), mesh.named("end")) == ([0], [4])


def test_tangents_of_a_curve_by_differences():
    point, tangent = _circle(2 * math.pi)
    mesh = fl.mesh.curve(point, 8)
    exact = _exact_ends(mesh, tangent, np.linspace(0, 1, 9))
    # one-sided differences at the ends amplify round-off most: about 20 eps / step
    np.testing.assert_allclose(mesh.tangents, exact, atol=2e-11)


def test_the_function_of_a_curve_is_called_within_its_range_only():
    asked = []

    def point(s):
        asked.append(s)
        return [s, s**2, 0]

    fl.mesh.curve(point, 3)
    assert 0.0 <= min(asked) and max(asked) <= 1.0


def test_a_given_derivative_is_used_and_normalised():
    point, tangent = _circle(1.0)
    mesh = fl.mesh.curve(point, 3, derivative=lambda s: 7 * tangent(s))
    exact = _exact_ends(mesh, tangent, np.linspace(0, 1, 4))
    np.testing.assert_allclose(mesh.tangents, exact, atol=1e-15)


# --- bare arrays ---------------------------------------------------------------------------------


@given(
    s=st.lists(st.floats(0.01, 1.0), min_size=2, max_size=8),
    flip=st.lists(st.booleans(), min_size=8, max_size=8),
)
@settings(max_examples=50)
def test_tangents_of_any_circle_are_exact_for_uneven_cells_in_any_direction(s, flip):
    step = np.cumsum([0.0, *s]) / 8  # angles between nodes at most 1/8 of 2.5 rad
    point, tangent = _circle(2.5)
    n = len(step)
    cells = [[i + 1, i] if i and flip[i] else [i, i + 1] for i in range(n - 1)]
    mesh = fl.mesh.LineMesh.from_cells(
        [point(si) for si in step], cells, kink_angle=np.radians(40.0)
    )
    # chords of 3e-3 between points that are exact to 1e-16
    np.testing.assert_allclose(mesh.tangents, _exact_ends(mesh, tangent, step), atol=1e-12)


def test_tangents_converge_with_second_order_on_other_curves():
    def error(cells):
        s = np.linspace(0, 1, cells + 1)
        mesh = fl.mesh.LineMesh.from_cells(
            np.column_stack([s, s**3, np.exp(s)]),
            np.column_stack([np.arange(cells), np.arange(1, cells + 1)]),
            kink_angle=np.radians(40.0),
        )
        exact = np.column_stack([np.ones_like(s), 3 * s**2, np.exp(s)])
        exact /= np.linalg.norm(exact, axis=1, keepdims=True)
        return np.abs(mesh.tangents - exact[mesh.cells]).max()

    errors = np.array([error(n) for n in (16, 32, 64)])
    assert (np.log2(errors[:-1] / errors[1:]) > 1.8).all(), errors


def test_cells_follow_each_other_and_the_lowest_keeps_its_direction():
    x = np.column_stack([np.arange(5.0), np.zeros(5), np.zeros(5)])
    mesh = fl.mesh.LineMesh.from_cells(x, [[3, 2], [0, 1], [3, 4], [1, 2]])
    np.testing.assert_array_equal(mesh.cells, [[3, 2], [1, 0], [4, 3], [2, 1]])
    np.testing.assert_array_equal(mesh.tangents, np.broadcast_to([-1.0, 0, 0], (4, 2, 3)))


def test_known_tangents_turn_with_their_cells():
    known = np.full((2, 2, 3), np.nan)
    known[1] = [[0, -0.6, -0.8], [0, -0.6, -0.8]]
    mesh = fl.mesh.LineMesh.from_cells(
        [[0, 0, 0], [0, 1, 1], [0, 2, 2]], [[0, 1], [2, 1]], tangents=known
    )
    np.testing.assert_array_equal(mesh.cells, [[0, 1], [1, 2]])
    # nearer than a degree to the circle's: no, 8 degrees, so it stays as it is
    np.testing.assert_allclose(mesh.tangents[1], [[0, 0.6, 0.8]] * 2)


def test_a_corner_keeps_the_chords_and_a_closed_ring_has_no_end():
    square = fl.mesh.LineMesh.from_cells(
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1], [1, 2], [2, 3], [3, 0]]
    )
    np.testing.assert_array_equal(square.tangents[:, 0], square.tangents[:, 1])
    ring = fl.mesh.LineMesh.from_cells(square.points, square.cells, kink_angle=math.pi)
    assert ring.tangents[0, 0] == pytest.approx([math.sqrt(0.5), -math.sqrt(0.5), 0])


def test_a_branch_is_recorded_and_its_sides_are_straight():
    mesh = fl.mesh.LineMesh.from_cells(
        [[0, 0, 0], [1, 0, 0], [2, 0.1, 0], [2, -0.1, 0]], [[0, 1], [1, 2], [1, 3]]
    )
    np.testing.assert_array_equal(mesh.branching_points, [1])
    np.testing.assert_array_equal(mesh.tangents[0], [[1, 0, 0], [1, 0, 0]])


def test_a_part_keeps_its_names():
    mesh = fl.mesh.LineMesh.from_cells(
        np.eye(3)[[0, 1, 2]],
        [[0, 1], [1, 2]],
        groups={"all": [0, 1], "second": [1], "first": [0]},
        named_points={"a": [0], "b": [1, 2]},
    )
    part = mesh.part("second")
    np.testing.assert_array_equal(part.points, np.eye(3)[1:])
    assert set(part.groups) == {"all", "second"} and set(part.named_points) == {"b"}
    np.testing.assert_array_equal(part.tangents[0], mesh.tangents[1])


# --- gmsh ----------------------------------------------------------------------------------------


def test_bend_from_its_geo_file_has_exact_tangents_and_names():
    mesh = fl.mesh.read_gmsh_lines(fl.mesh.run_gmsh_script(BEND, {"cells": 6}))
    assert len(mesh.cells) == 6 and mesh.group("arc").tolist() == list(range(6))
    np.testing.assert_allclose(mesh.points[mesh.named("clamp")], [[0, 0, 0]], atol=1e-12)
    np.testing.assert_allclose(
        mesh.points[mesh.named("tip")], [[100 / math.sqrt(2), 100 * (1 - math.sqrt(0.5)), 0]]
    )
    radius = mesh.points[mesh.cells] - [0, 100, 0]
    np.testing.assert_allclose(np.linalg.norm(radius, axis=-1), 100, rtol=1e-13)
    exact = np.cross([0, 0, 1], radius / 100)
    np.testing.assert_allclose(mesh.tangents, exact, atol=1e-13)


def test_the_default_of_a_parameter_stands_after_another_was_given():
    assert len(fl.mesh.read_gmsh_lines(fl.mesh.run_gmsh_script(BEND, {"cells": 3})).cells) == 3
    assert len(fl.mesh.read_gmsh_lines(fl.mesh.run_gmsh_script(BEND)).cells) == 8
    assert not gmsh.isInitialized()


def test_a_msh_file_gives_the_same_line(tmp_path):
    geo, msh = fl.mesh.read_gmsh_lines(fl.mesh.run_gmsh_script(BEND)), _written(BEND, tmp_path)
    np.testing.assert_array_equal(msh.cells, geo.cells)
    assert msh.groups.keys() == geo.groups.keys() and msh.named("tip") == geo.named("tip")
    # 16 digits in the file, chords of a tenth of the radius
    np.testing.assert_allclose(msh.tangents, geo.tangents, atol=1e-13)


def test_a_branching_frame_is_the_same_in_its_msh_file(tmp_path):
    """Several groups and points; cells of each group head the same way in both files."""
    geo, msh = (
        fl.mesh.read_gmsh_lines(fl.mesh.run_gmsh_script(SPACE_FRAME)),
        _written(SPACE_FRAME, tmp_path),
    )
    assert set(geo.groups) == {"columns", "girder", "outrigger"}
    assert len(geo.named_points) == 6 and geo.named_points.keys() == msh.named_points.keys()
    np.testing.assert_array_equal(geo.branching_points, geo.named("middle"))
    for name, cells in geo.groups.items():
        np.testing.assert_array_equal(msh.group(name), cells)
        np.testing.assert_allclose(msh.tangents[cells], geo.tangents[cells], atol=1e-14)
    for name, points in geo.named_points.items():
        np.testing.assert_allclose(msh.points[msh.named(name)], geo.points[points], atol=1e-14)
    part = geo.part("girder")
    assert len(part.cells) == 8 and set(part.named_points) == {
        "left corner",
        "middle",
        "right corner",
    }
    assert not len(part.branching_points), "the branch is another part"


def _written(geo, folder):
    gmsh.initialize(["gmsh", "-v", "0"], readConfigFiles=False)
    try:
        gmsh.open(str(geo))
        gmsh.model.mesh.generate(1)
        gmsh.write(str(folder / "line.msh"))
    finally:
        gmsh.finalize()
    return fl.mesh.read_gmsh_lines(folder / "line.msh")


FRAME = """
SetFactory("OpenCASCADE");
DefineConstant[ count = 4 ];
Point(1) = {0, 0, 0}; Point(2) = {0, 0, 2}; Point(3) = {3, 0, 2}; Point(4) = {9, 9, 9};
Line(1) = {1, 2}; Line(2) = {3, 2}; Line(3) = {3, 4};
fixed = 1;
Transfinite Curve {1:3} = count + 1;
Physical Curve("column") = {1}; Physical Curve("girder") = {2};
Physical Curve("frame") = {1, 2}; Physical Point("foot") = {1}; Physical Point("away") = {4};
"""


@pytest.fixture
def frame_file(tmp_path):
    path = tmp_path / "frame.geo"
    path.write_text(FRAME)
    return path


def test_a_frame_has_a_kink_shared_groups_and_no_orphans(frame_file):
    mesh = fl.mesh.read_gmsh_lines(fl.mesh.run_gmsh_script(frame_file))
    assert mesh.points.shape == (9, 3), "the curve outside of groups is left out"
    assert set(mesh.groups) == {"column", "girder", "frame"} and len(mesh.group("frame")) == 8
    np.testing.assert_allclose(mesh.tangents[mesh.group("column")], [[[0, 0, 1]] * 2] * 4)
    # the girder was drawn towards the column: it is turned round
    np.testing.assert_allclose(mesh.tangents[mesh.group("girder")], [[[1, 0, 0]] * 2] * 4)
    assert set(mesh.named_points) == {"foot"}
    with pytest.raises(
        ValueError, match=r"no group of cells 'beam'; it has: column, frame, girder"
    ):
        mesh.group("beam")
    with pytest.raises(ValueError, match=r"no named point 'away'; it has: foot"):
        mesh.named("away")


def test_the_current_model_of_the_user_is_read_and_left_alone(frame_file):
    gmsh.initialize(["gmsh", "-v", "0"], readConfigFiles=False)
    try:
        gmsh.model.add("mine")
        a, b = (gmsh.model.occ.addPoint(x, 0, 0) for x in (0, 1))
        gmsh.model.occ.addLine(a, b)
        gmsh.model.occ.synchronize()
        gmsh.model.mesh.generate(1)
        mine = fl.mesh.read_gmsh_lines()
        assert (
            len(fl.mesh.read_gmsh_lines(fl.mesh.run_gmsh_script(frame_file, {"count": 2})).cells)
            == 4
        )
        assert gmsh.model.getCurrent() == "mine" and gmsh.model.list() == ["", "mine"]
        np.testing.assert_array_equal(fl.mesh.read_gmsh_lines().points, mine.points)
    finally:
        gmsh.finalize()
    np.testing.assert_array_equal(mine.tangents[:, 0], [[1, 0, 0]] * len(mine.cells))


# --- DOLFINx -------------------------------------------------------------------------------------


def test_a_mesh_of_triangles_is_refused():
    mesh = dolfinx.mesh.create_unit_square(MPI.COMM_SELF, 1, 1)
    with pytest.raises(ValueError, match="intervals of order 1 or 2, got triangle"):
        fl.mesh.lines_from_dolfinx(mesh)


# --- what is refused -----------------------------------------------------------------------------

LINE = [[0, 0, 0], [1, 0, 0], [2, 0, 0]]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: fl.mesh.straight_line((0, 0, 0), (0, 0, 0), 2), "both"),
        (lambda: fl.mesh.straight_line((0, 0, 0), (1, 0, 0), 0), "at least 1, got 0"),
        (
            lambda: fl.mesh.straight_line((0, 0, 0), (1, 0, 0), 1.5),
            r"whole number of at least 1, got 1\.5",
        ),
        (lambda: fl.mesh.straight_line((0, 0, np.nan), (1, 0, 0), 2), "point 0 is .*nan"),
        (lambda: fl.mesh.straight_line((0, 0), (1, 0), 2), r"shape \(n, 3\), got \(2, 2\)"),
        (lambda: fl.mesh.curve(lambda s: (0, 0, 0), 2), "no tangent at s = 0"),
        (
            lambda: fl.mesh.LineMesh.from_cells(LINE, [[0, 1], [1, 1], [1, 2]]),
            "cell 1 has no length",
        ),
        (
            lambda: fl.mesh.LineMesh.from_cells([*LINE, LINE[0]], [[0, 1], [0, 3], [1, 2]]),
            "cell 1.*both",
        ),
        (lambda: fl.mesh.LineMesh.from_cells(LINE, [[0, 1], [1, 2], [1, 0]]), "cell 0 .*twice"),
        (
            lambda: fl.mesh.LineMesh.from_cells(LINE, [[0, 1]]),
            "1 points have no cell, the first is 2",
        ),
        (lambda: fl.mesh.LineMesh.from_cells(LINE, [[0, 1], [1, 3]]), r"0 … 2, got 0 … 3"),
        (lambda: fl.mesh.LineMesh.from_cells(LINE, [[0, 1, 2]]), r"shape \(m, 2\), got \(1, 3\)"),
        (
            lambda: fl.mesh.LineMesh.from_cells(LINE, [[0, 1.0], [1, 2]]),
            "whole numbers, got float64",
        ),
        (
            lambda: fl.mesh.LineMesh.from_cells(LINE, [[0, 1], [1, 2]], groups={"g": [2]}),
            "cells of 'g'",
        ),
        (
            lambda: fl.mesh.LineMesh.from_cells(LINE, [[0, 1], [1, 2]], kink_angle=20),
            "kink_angle.*got 20",
        ),
        (lambda: fl.mesh.LineMesh(LINE, [[0, 1], [1, 2]], np.ones((2, 2, 3))), "unit vectors"),
        (
            lambda: fl.mesh.read_gmsh_lines(fl.mesh.run_gmsh_script(BEND, {"cell": 3})),
            "no parameter 'cell'; it has: cells, radius",
        ),
    ],
)
def test_bad_input_is_named(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_bad_gmsh_files_are_named(tmp_path, frame_file):
    with pytest.raises(FileNotFoundError, match=r"no mesh file .*missing\.geo"):
        fl.mesh.read_gmsh_lines(fl.mesh.run_gmsh_script(tmp_path / "missing.geo"))
    with pytest.raises(ValueError, match=r"sets 'fixed' itself"):
        fl.mesh.read_gmsh_lines(fl.mesh.run_gmsh_script(frame_file, {"fixed": 2}))
    (tmp_path / "broken.geo").write_text("Point(1) = {0, 0;\n")
    with pytest.raises(ValueError, match=r"gmsh cannot read .*broken\.geo.*syntax error"):
        fl.mesh.read_gmsh_lines(fl.mesh.run_gmsh_script(tmp_path / "broken.geo"))
    (tmp_path / "empty.geo").write_text("Point(1) = {0, 0, 0};\n")
    with pytest.raises(ValueError, match="has no line cells"):
        fl.mesh.read_gmsh_lines(fl.mesh.run_gmsh_script(tmp_path / "empty.geo"))
    (tmp_path / "cubic.geo").write_text(FRAME + "Mesh.ElementOrder = 3;\n")
    with pytest.raises(ValueError, match="curve 1 has cells of type 'Line 4'; expected lines of 2"):
        fl.mesh.read_gmsh_lines(fl.mesh.run_gmsh_script(tmp_path / "cubic.geo"))
    assert not gmsh.isInitialized()


@pytest.mark.parametrize("ending", ["geo", "msh"])
def test_lines_of_second_order_are_two_cells(tmp_path, ending):
    """A quarter of a circle: middle nodes are points, with tangents of the circle."""
    path = tmp_path / f"arc.{ending}"
    text = (
        "Point(1)={1,0,0}; Point(2)={0,0,0}; Point(3)={0,1,0}; Circle(1)={1,2,3};"
        'Transfinite Curve {1} = 4; Physical Curve("arc")={1}; Mesh.ElementOrder = 2;\n'
    )
    if ending == "geo":
        path.write_text(text)
        mesh = fl.mesh.read_gmsh_lines(fl.mesh.run_gmsh_script(path))
    else:
        with empty_model() as session:
            (tmp_path / "arc.geo").write_text(text)
            session.merge(str(tmp_path / "arc.geo"))
            session.model.mesh.generate(1)
            session.write(str(path))
        mesh = fl.mesh.read_gmsh_lines(path)
    assert len(mesh.cells) == 6 == len(mesh.group("arc"))
    x = mesh.points[mesh.cells]
    np.testing.assert_allclose(np.linalg.norm(x, axis=2), 1.0, atol=1e-12)
    np.testing.assert_allclose(np.abs((x * mesh.tangents).sum(axis=2)), 0.0, atol=1e-7)


def test_names_by_place_in_a_volume_mesh():
    """Facets of the boundary and vertices, added to the names that the mesh has."""
    mesh = fl.mesh.brick((1, 1, 2), (2, 2, 4))
    named = mesh.named(
        faces={"top": lambda x: x[2] > 1.999, "middle or side": lambda x: x[0] < 1e-9},
        points={"corner": lambda x: (x < 1e-9).all(axis=0)},
    )
    np.testing.assert_array_equal(named.face("top"), np.sort(mesh.face("c=1")))
    np.testing.assert_array_equal(named.face("middle or side"), np.sort(mesh.face("a=0")))
    assert set(named.faces) == {*mesh.faces, "top", "middle or side"}
    solid = fl.Solid(named, fl.sections.NeoHooke(1e6, 0.3))
    np.testing.assert_array_equal(solid.nodes("corner"), solid.nodes("000"))


@pytest.mark.parametrize(
    ("where", "message"),
    [
        (lambda x: x[2] > 5.0, "face 'top': nothing is there; 0 nodes are"),
        (lambda x: np.isclose(x[2], 1.0), "face 'top': nothing is there; 9 nodes are"),
        (lambda x: x[2], "face 'top': expected a function of positions"),
        (lambda x: True, "face 'top': expected a function of positions"),
    ],
)
def test_places_without_parts_have_a_message(where, message):
    mesh = fl.mesh.brick((1, 1, 2), (2, 2, 2))
    with pytest.raises(ValueError, match=message):
        mesh.named(faces={"top": where})
