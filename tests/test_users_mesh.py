"""Meshes of DOLFINx are taken as they are: the user's own mesh is that of the forms."""

from mpi4py import MPI

import dolfinx
import numpy as np
import pytest

import fem_lie as fl
from fem_lie import _compat
from fem_lie.mesh.sides import turn, turned_round
from fem_lie.system import System

MATERIAL = fl.Material(1e7, 0.3, 1e3)
LAYER = fl.ShellSection.layer(0.02, MATERIAL)
SECTION = fl.Section.circle(0.02, MATERIAL)
COMMUNICATORS = pytest.mark.parametrize(
    "comm", [MPI.COMM_SELF, MPI.COMM_WORLD], ids=["self", "world"]
)


def plate(comm: MPI.Intracomm, cell: str) -> dolfinx.mesh.Mesh:
    """A strip in space, bowed."""
    kind = dolfinx.mesh.CellType[cell]
    flat = dolfinx.mesh.create_rectangle(comm, [(0.0, 0.0), (2.0, 0.5)], (8, 2), cell_type=kind)
    x = np.column_stack([flat.geometry.x[:, :2], 0.05 * flat.geometry.x[:, 0] ** 2])
    return _compat.create_surface_mesh(x, _compat.geometry_dofmap(flat).astype(np.int64), cell, 1)


def line(comm: MPI.Intracomm) -> dolfinx.mesh.Mesh:
    """Straight."""
    points = np.outer(np.linspace(0.0, 1.0, 9), (1.0, 0.2, 0.3))
    return _compat.create_line_mesh(comm, points, np.column_stack([np.arange(8), np.arange(1, 9)]))


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


def mesh_of(body: fl.Beam | fl.Cable | fl.Shell) -> dolfinx.mesh.Mesh:
    """On which its forms are."""
    scene = fl.Scene()
    scene.add(body)
    ((_, assembly),) = System(scene, dynamics=False).numbering.assemblies
    return assembly.forms.increment.function_space.mesh


@COMMUNICATORS
@pytest.mark.parametrize("cell", ["triangle", "quadrilateral"])
def test_a_shell_is_on_the_mesh_that_it_was_given(comm, cell):
    mesh = plate(comm, cell)
    shell = fl.Shell(mesh, LAYER)
    cells = _compat.geometry_dofmap(mesh)
    turned = turned_round(cells, cell)
    # DOLFINx's triangles of a rectangle look to both sides
    assert turned.any() == (cell == "triangle")
    assert (mesh_of(shell) is mesh) == (not turned.any())
    other = fl.Shell(fl.SurfaceMesh.from_cells(mesh.geometry.x, shell.mesh.cells, cell), LAYER)
    assert mesh_of(other) is not mesh
    np.testing.assert_allclose(tip(shell), tip(other), atol=1e-9)


@COMMUNICATORS
@pytest.mark.parametrize(
    "formulation", [fl.Geodesic(), fl.Director(1), fl.Director(2), fl.Kirchhoff()], ids=repr
)
def test_a_beam_is_on_the_mesh_that_it_was_given(comm, formulation):
    mesh = line(comm)
    beam = fl.Beam(mesh, SECTION, formulation=formulation)
    # where cells follow each other none has to be turned round
    assert (np.diff(_compat.geometry_dofmap(mesh)) == 1).all() and mesh_of(beam) is mesh
    bare = fl.LineMesh.from_cells(mesh.geometry.x, _compat.geometry_dofmap(mesh))
    np.testing.assert_allclose(
        tip(beam), tip(fl.Beam(bare, SECTION, formulation=formulation)), atol=1e-9
    )


@COMMUNICATORS
@pytest.mark.parametrize("formulation", [fl.HermiteCable(), fl.DiscreteCable()], ids=repr)
def test_a_cable_is_on_the_mesh_that_it_was_given(comm, formulation):
    mesh = line(comm)
    cable = fl.Cable(mesh, SECTION, formulation=formulation)
    assert mesh_of(cable) is mesh
    bare = fl.LineMesh.from_cells(mesh.geometry.x, _compat.geometry_dofmap(mesh))
    other = fl.Cable(bare, SECTION, formulation=formulation)
    assert mesh_of(other) is not mesh
    np.testing.assert_allclose(tip(cable), tip(other), atol=1e-9)


def test_an_ancf_beam_goes_along_a_mesh_that_it_was_given():
    mesh = line(MPI.COMM_SELF)
    bare = fl.LineMesh.from_cells(mesh.geometry.x, _compat.geometry_dofmap(mesh))
    np.testing.assert_array_equal(
        fl.AncfBeam(mesh, SECTION).frames, fl.AncfBeam(bare, SECTION).frames
    )


@pytest.mark.parametrize("kind", [fl.Beam, fl.Rod, fl.Cable, fl.AncfBeam])
def test_a_line_along_a_mesh_of_another_dimension_is_refused(kind):
    with pytest.raises(ValueError, match=r"must consist of intervals.*got quadrilateral"):
        kind(plate(MPI.COMM_SELF, "quadrilateral"), SECTION)
    with pytest.raises(TypeError, match=rf"{kind.__name__}: mesh must be a LineMesh.*SurfaceMesh"):
        kind(fl.surface(lambda a, b: (a, b, 0), (1, 1)), SECTION)


def test_two_bodies_of_a_kind_are_assembled_on_one_mesh_of_their_own():
    scene = fl.Scene()
    for _ in range(2):
        scene.add(fl.Shell(plate(MPI.COMM_SELF, "triangle"), LAYER))
    ((_, assembly),) = System(scene, dynamics=False).numbering.assemblies
    assert assembly.mesh not in [body.source for body in scene.bodies]


def test_a_body_that_was_moved_from_its_mesh_is_not_on_it():
    mesh = plate(MPI.COMM_SELF, "quadrilateral")
    shell = fl.Shell(mesh, LAYER)
    shell.frames[:, 0] += (0.0, 0.0, 1e-3)
    assert mesh_of(shell) is not mesh


def test_cells_with_two_common_edges_are_turned_once():
    """Two quadrilaterals around the corner 4 that they share with both neighbours of it."""
    cells = np.array([[0, 1, 3, 4], [5, 3, 1, 4]])
    for second in ([5, 3, 1, 4], [5, 1, 3, 4]):
        cells[1] = second
        turned = turned_round(cells, "quadrilateral")
        ways = []  # along the edge from 1 to 4 one goes on, and the other comes back
        for cell in turn(cells, "quadrilateral", turned):
            around = [cell[k] for k in (0, 1, 3, 2)]
            at = around.index(1)
            ways.append(around[(at + 1) % 4] == 4)
        assert sorted(ways) == [False, True] and not turned[0]
