"""Meshes of lines, surfaces and volumes from gmsh and from DOLFINx."""

from __future__ import annotations

import logging
import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from fem_lie import _compat
from fem_lie._arrays import Indices, instance
from fem_lie.mesh.collected import collected
from fem_lie.mesh.gmsh_cells import (
    coordinates_of,
    model_lines,
    model_shell,
    read_lines,
    read_shell,
)
from fem_lie.mesh.gmsh_session import GmshScript, chosen_entities, logged, opened, physical
from fem_lie.mesh.lines import (
    CORNER_ANGLE,
    JOINT_ANGLE,
    KINK_ANGLE,
    LineMesh,
    check_kink_angle,
    halved,
)
from fem_lie.mesh.mixed_surfaces import MixedSurfaceMesh
from fem_lie.mesh.shapes import DEGREES, turn, turned_round
from fem_lie.mesh.surfaces import SurfaceMesh
from fem_lie.mesh.volumes import VolumeMesh, entities_at

if TYPE_CHECKING:
    import dolfinx

_log = logging.getLogger(__name__)

_CELLS = {
    4: ("tetrahedron", 1),
    5: ("hexahedron", 1),
    11: ("tetrahedron", 2),
    12: ("hexahedron", 2),
}
"""Cell type and degree by gmsh's element type."""


def read_gmsh_lines(
    path: str | os.PathLike[str] | GmshScript | None = None,
    *,
    kink_angle: float = KINK_ANGLE,
) -> LineMesh:
    """Lines of a gmsh file or model, with the names of its physical groups.

    Physical groups of curves become groups of cells, those of points named points; a group without
    a name is called by its number. Curves outside of groups count only if no curve is in one and
    they are no edges of surfaces; the log says what is left out. CAD and scripts are meshed
    here; their tangents are those of the CAD curves. A ``.msh`` file has no CAD any more: where
    one of its curves turns from cell to cell it is taken as smooth, with tangents of circles
    through successive points, and where two curves meet there is a corner unless their tangents
    agree to a degree. A line of second order becomes two cells, which meet at its middle node.

    Args:
        path: ``.msh`` or CAD file (STEP, IGES, BREP), or a script
            (:func:`~fem_lie.mesh.run_gmsh_script`); default: the current model of a running gmsh,
            as it is.
        kink_angle: Largest angle, rad, by which a curve without CAD turns at a point and is smooth.

    Raises:
        FileNotFoundError: There is no such file.
        ValueError: The file is neither a mesh nor CAD, gmsh cannot read it, it has no lines,
            lines of third order, or anything that the class refuses.
    """
    check_kink_angle(kink_angle)
    if path is None:
        raw = model_lines("the gmsh model", kink_angle)
    else:
        raw = read_lines(path, kink_angle)
    return LineMesh.from_cells(
        raw.points,
        raw.cells,
        tangents=raw.tangents,
        groups=raw.groups,
        named_points=raw.named_points,
    )


def line_of(mesh: LineMesh | dolfinx.mesh.Mesh, what: str) -> LineMesh:
    """Line mesh of a body: a :class:`LineMesh`, or one from a DOLFINx mesh.

    Raises:
        ValueError: See :func:`lines_from_dolfinx`.
        TypeError: It is something else.
    """
    import dolfinx

    if isinstance(mesh, dolfinx.mesh.Mesh):
        return lines_from_dolfinx(mesh)
    known = "a LineMesh, see straight, polyline and curve of its class, or a DOLFINx mesh"
    instance(mesh, LineMesh, f"{what}: mesh", known)
    return mesh


def lines_from_dolfinx(
    mesh: dolfinx.mesh.Mesh,
    cell_tags: dolfinx.mesh.MeshTags | None = None,
    vertex_tags: dolfinx.mesh.MeshTags | None = None,
    *,
    groups: Mapping[str, int] | None = None,
    named_points: Mapping[str, int] | None = None,
    kink_angle: float | None = None,
) -> LineMesh:
    """A DOLFINx mesh of intervals; cells keep DOLFINx's numbers, points those of its geometry.

    A cell of second order is two of this mesh, ``2 k`` and ``2 k + 1``, with the tangents of the
    circle through its three nodes. Each process has the whole of a distributed mesh, whose cells
    and points are numbered anew.

    Args:
        mesh: Mesh of intervals of first or second order; all processes of a distributed one call
            together.
        cell_tags: Tags of cells.
        vertex_tags: Tags of vertices (the facets of a line).
        groups: Name of each tag of cells; default: the tags' numbers are the names.
        named_points: Name of each tag of vertices; default: the tags' numbers.
        kink_angle: Of cells of first order see :meth:`~fem_lie.mesh.lines.LineMesh.from_cells`,
            default: one degree. Of second order the angle between the tangents of successive cells,
            rad, above which the line has a corner; default: ten degrees.

    Raises:
        ValueError: The mesh has other cells, a tag does not exist, or anything that the class
            refuses.
    """
    from dolfinx.mesh import entities_to_geometry

    mesh, (cell_tags, vertex_tags) = collected(mesh, cell_tags, vertex_tags)
    cells: Indices = _compat.geometry_dofmap(mesh).astype(np.int64)
    if mesh.topology.dim != 1 or cells.shape[1] not in (2, 3):
        raise ValueError(
            "the mesh must consist of intervals of order 1 or 2, got "
            f"{mesh.topology.cell_name()} cells with {cells.shape[1]} nodes"
        )
    found = tagged(cell_tags, groups, "cell_tags")
    group_cells: Mapping[str, npt.ArrayLike] = found
    tangents = None
    if cells.shape[1] == 3:
        cells, tangents = halved(mesh.geometry.x, cells)
        halves = np.array([0, 1])
        group_cells = {k: (2 * c[:, np.newaxis] + halves).ravel() for k, c in found.items()}
    if kink_angle is None:
        kink_angle = CORNER_ANGLE if tangents is None else JOINT_ANGLE
    names = tagged(vertex_tags, named_points, "vertex_tags")
    mesh.topology.create_connectivity(0, 1)
    return LineMesh.from_cells(
        mesh.geometry.x,
        cells,
        tangents=tangents,
        groups=group_cells,
        named_points={
            name: entities_to_geometry(mesh, 0, vertices).ravel()
            for name, vertices in names.items()
        },
        kink_angle=kink_angle,
        source=mesh,
    )


def read_gmsh_surface(
    path: str | os.PathLike[str] | GmshScript | None = None,
) -> SurfaceMesh | MixedSurfaceMesh:
    """Surfaces of a gmsh file or model, with the names of its physical groups.

    Physical groups of surfaces become groups of cells, those of curves named curves, those of
    points named points; a group without a name is called by its number. Surfaces outside of groups
    count only if no surface is in one and they are no faces of volumes; the log says what is left
    out. CAD and scripts are meshed here; their normals are those of the
    CAD surfaces. A ``.msh`` file has no surfaces any more; normals come from its cells. Triangles
    and quadrilaterals of one order may be mixed.

    Args:
        path: ``.msh`` or CAD file (STEP, IGES, BREP), or a script
            (:func:`~fem_lie.mesh.run_gmsh_script`); default: the current model of a running gmsh,
            as it is.

    Raises:
        FileNotFoundError: There is no such file.
        ValueError: The file is neither a mesh nor CAD, gmsh cannot read it, it has no surface
            cells or those of several orders, or anything that the class refuses.
    """
    raw = model_shell("the gmsh model") if path is None else read_shell(path)
    names = {"groups": raw.groups, "curves": raw.curves, "named_points": raw.named_points}
    if len(raw.blocks) > 1:
        cells, normals = ({each.cell: each[i] for each in raw.blocks} for i in (0, 2))
        return MixedSurfaceMesh.from_cells(raw.points, cells, normals=normals, **names)
    (block,) = raw.blocks
    return SurfaceMesh.from_cells(
        raw.points, block.cells, block.cell, normals=block.normals, **names
    )


def surface_from_dolfinx(
    mesh: dolfinx.mesh.Mesh,
    cell_tags: dolfinx.mesh.MeshTags | None = None,
    facet_tags: dolfinx.mesh.MeshTags | None = None,
    vertex_tags: dolfinx.mesh.MeshTags | None = None,
    *,
    groups: Mapping[str, int] | None = None,
    curves: Mapping[str, int] | None = None,
    named_points: Mapping[str, int] | None = None,
) -> SurfaceMesh:
    """A DOLFINx mesh of a surface; cells keep DOLFINx's numbers, points those of its geometry.

    Each process has the whole of a distributed mesh, whose cells and points are numbered anew.

    To DOLFINx no cell has a side. Here all of a piece look to that to which its first one looks,
    and the nodes of the others are taken the other way round.

    Args:
        mesh: Triangles (3 or 6 nodes) or quadrilaterals (4 or 9 nodes) in space; all processes of a
            distributed mesh call together. Geometry of serendipity elements, with 8 nodes, is
            refused: to DOLFINx their edges have moments, and the nodes between corners are no
            points of the geometry.
        cell_tags: Tags of cells.
        facet_tags: Tags of edges.
        vertex_tags: Tags of vertices.
        groups: Name of each tag of cells; default: the tags' numbers are the names.
        curves: Name of each tag of edges; default: the tags' numbers.
        named_points: Name of each tag of vertices; default: the tags' numbers.

    Raises:
        ValueError: The mesh has other cells or lies in a plane of two dimensions, a tag does not
            exist, or anything that the class refuses.
    """
    from dolfinx.mesh import entities_to_geometry

    kinds = _compat.kinds_of_cells(mesh)
    if len(kinds) != 1:
        raise ValueError(f"the mesh must have cells of one kind, got {' and '.join(kinds)}")
    mesh, (cell_tags, facet_tags, vertex_tags) = collected(mesh, cell_tags, facet_tags, vertex_tags)
    cell = mesh.topology.cell_name()
    cells: Indices = _compat.geometry_dofmap(mesh).astype(np.int64)
    if cells.shape[1] not in DEGREES.get(cell, {}) or mesh.geometry.dim != 3:
        raise ValueError(
            "the mesh must consist of triangles (3 or 6 nodes) or quadrilaterals (4 or 9 nodes) in "
            f"space (gdim 3), got {cell} cells with {cells.shape[1]} nodes and gdim "
            f"{mesh.geometry.dim}"
        )
    mesh.topology.create_connectivity(0, 2)
    mesh.topology.create_connectivity(1, 2)
    edges = tagged(facet_tags, curves, "facet_tags")
    vertices = tagged(vertex_tags, named_points, "vertex_tags")
    turned = turned_round(cells, cell)
    if turned.any():
        _log.info("%d of %d cells are reversed, for a common orientation", turned.sum(), len(cells))
    return SurfaceMesh.from_cells(
        mesh.geometry.x,
        turn(cells, cell, turned),
        cell,
        groups=tagged(cell_tags, groups, "cell_tags"),
        curves={name: entities_to_geometry(mesh, 1, found) for name, found in edges.items()},
        named_points={
            name: entities_to_geometry(mesh, 0, found).ravel() for name, found in vertices.items()
        },
        source=mesh,
    )


def tagged(
    tags: dolfinx.mesh.MeshTags | None, names: Mapping[str, int] | None, what: str
) -> dict[str, npt.NDArray[np.int32]]:
    """Entities of each name."""
    if tags is None:
        if names:
            raise ValueError(f"names {sorted(names)} need {what}, got none")
        return {}
    exist = np.unique(tags.values)
    named_tags = {str(tag): int(tag) for tag in exist} if names is None else names
    for name, tag in named_tags.items():
        if tag not in exist:
            raise ValueError(f"{what} has no tag {tag} (for {name!r}); it has: {exist.tolist()}")
    return {name: tags.find(tag) for name, tag in named_tags.items()}


def read_gmsh_volume(
    path: str | os.PathLike[str] | GmshScript | None = None,
) -> VolumeMesh:
    """Volumes of a gmsh file or model, with the names of its physical groups.

    Physical groups of volumes become groups of cells, those of surfaces faces, those of curves
    curves and those of points named points; a group without a name is called by its number. Volumes
    outside of groups count only if no volume is in one; the log says what is left out. CAD and
    scripts are meshed here.

    Args:
        path: ``.msh`` or CAD file (STEP, IGES, BREP), or a script
            (:func:`~fem_lie.mesh.run_gmsh_script`); default: the current model of a running gmsh,
            as it is.

    Raises:
        FileNotFoundError: There is no such file.
        ValueError: The file is neither a mesh nor CAD, gmsh cannot read it, it has no volumes
            or cells of several kinds, or anything that the class refuses.
    """
    if path is None:
        return _model_volume("the gmsh model")
    with opened(path) as (gmsh, file):
        if not len(gmsh.model.mesh.getElements(3)[0]):
            logged(gmsh, file, lambda: gmsh.model.mesh.generate(3))
        return _model_volume(str(file))


def volume_from_dolfinx(
    mesh: dolfinx.mesh.Mesh,
    cell_tags: dolfinx.mesh.MeshTags | None = None,
    facet_tags: dolfinx.mesh.MeshTags | None = None,
    edge_tags: dolfinx.mesh.MeshTags | None = None,
    vertex_tags: dolfinx.mesh.MeshTags | None = None,
    *,
    groups: Mapping[str, int] | None = None,
    faces: Mapping[str, int] | None = None,
    curves: Mapping[str, int] | None = None,
    named_points: Mapping[str, int] | None = None,
) -> VolumeMesh:
    """Volume mesh of a DOLFINx mesh, with names for tagged entities.

    Args:
        mesh: Hexahedra or tetrahedra of degree 1 or 2 in space; all processes of a distributed
            mesh call together, and each has the whole of it, numbered anew.
        cell_tags: Tags of cells.
        facet_tags: Tags of facets.
        edge_tags: Tags of edges.
        vertex_tags: Tags of vertices.
        groups: Name of each tag of cells; default: the tags' numbers are the names.
        faces: Name of each tag of facets; default: the tags' numbers.
        curves: Name of each tag of edges; default: the tags' numbers.
        named_points: Name of each tag of vertices; default: the tags' numbers.
    """
    mesh, tags = collected(mesh, cell_tags, facet_tags, edge_tags, vertex_tags)
    cell_tags, facet_tags, edge_tags, vertex_tags = tags
    names = (
        (cell_tags, groups, "cell_tags"),
        (facet_tags, faces, "facet_tags"),
        (edge_tags, curves, "edge_tags"),
        (vertex_tags, named_points, "vertex_tags"),
    )
    found = [
        {name: np.asarray(of, dtype=np.int64) for name, of in tagged(*each).items()}
        for each in names
    ]
    return VolumeMesh(mesh, *found)


def _model_volume(what: str) -> VolumeMesh:
    """Volumes of the current gmsh model; ``what`` is its name in messages."""
    import gmsh

    chosen = chosen_entities(gmsh, 3, what)
    cells, volumes, cell, degree = _cell_block(gmsh, chosen, what)
    used, local = np.unique(cells, return_inverse=True)
    local = local.reshape(cells.shape).astype(np.int64)
    mesh = _compat.create_surface_mesh(coordinates_of(gmsh, used), local, cell, degree)
    node = np.argsort(mesh.geometry.input_global_indices)
    at = np.argsort(mesh.topology.original_cell_index)
    groups = {name: np.sort(at[np.isin(volumes, of)]) for name, of in physical(gmsh, 3).items()}
    parts: list[dict[str, Indices]] = []
    for dim in (2, 1, 0):
        named = {name: _corners(gmsh, dim, of, used) for name, of in physical(gmsh, dim).items()}
        parts.append(
            {
                name: entities_at(mesh, dim, node[np.searchsorted(used, corners)])
                for name, corners in named.items()
                if len(corners)
            }
        )
    return VolumeMesh(mesh, {name: of for name, of in groups.items() if len(of)}, *parts)


def _cell_block(gmsh: Any, chosen: list[int], what: str) -> tuple[Indices, Indices, str, int]:
    """Node tags of all cells in DOLFINx's order, volume of each, cell type and degree.

    Raises:
        ValueError: There are no cells, or cells of several or unsupported types.
    """
    blocks, owner, kinds = [], [], set()
    for volume in chosen:
        for kind, _, nodes in zip(*gmsh.model.mesh.getElements(3, volume), strict=True):
            kinds.add(int(kind))
            blocks.append(nodes.astype(np.int64))
            owner.append(volume)
    names = [gmsh.model.mesh.getElementProperties(kind)[0] for kind in sorted(kinds)]
    if not kinds or not kinds <= set(_CELLS):
        raise ValueError(
            f"{what} must have tetrahedra of 4 or 10 nodes, or hexahedra of 8 or 27, got "
            f"{' and '.join(names) or 'no volume cells'}"
        )
    if len(kinds) > 1:
        raise ValueError(
            f"{what} has {' and '.join(names)}: a solid needs cells of one type, as displacements "
            "of a tetrahedron and of a hexahedron at a common face differ between their nodes, and "
            "DOLFINx has no pyramids that fit between. Mesh it with tetrahedra of 10 nodes"
        )
    kind = kinds.pop()
    cell, degree = _CELLS[kind]
    size = gmsh.model.mesh.getElementProperties(kind)[3]
    cells = np.concatenate([block.reshape(-1, size) for block in blocks])
    volumes = np.repeat(owner, [len(block) // size for block in blocks])
    return cells[:, _compat.gmsh_order(cell, size)], volumes, cell, degree


def _corners(gmsh: Any, dim: int, entities: list[int], used: Indices) -> Indices:
    """Node tags of the corners of all elements of entities that are on the volumes, (e, c)."""
    found: list[Indices] = []
    for entity in entities:
        for kind, _, nodes in zip(*gmsh.model.mesh.getElements(dim, entity), strict=True):
            *_, size, _, corners = gmsh.model.mesh.getElementProperties(kind)
            found.append(nodes.astype(np.int64).reshape(-1, size)[:, :corners])
    if not found:
        return np.empty((0, 1), dtype=np.int64)
    tags = np.concatenate(found)
    return tags[np.isin(tags, used).all(axis=1)]
