"""Volume meshes from gmsh and from DOLFINx."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

import dolfinx
import numpy as np

from fem_lie import _compat
from fem_lie._arrays import Indices
from fem_lie.mesh.collected import collected
from fem_lie.mesh.gmsh_cells import coordinates_of
from fem_lie.mesh.gmsh_session import GmshScript, chosen_entities, logged, opened, physical
from fem_lie.mesh.reading import tagged
from fem_lie.mesh.volumes import VolumeMesh, entities_at

_CELLS = {
    4: ("tetrahedron", 1),
    5: ("hexahedron", 1),
    11: ("tetrahedron", 2),
    12: ("hexahedron", 2),
}

"""Cell type and degree by gmsh's element type."""


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
    if len(kinds) != 1 or not kinds <= set(_CELLS):
        names = [gmsh.model.mesh.getElementProperties(kind)[0] for kind in sorted(kinds)]
        raise ValueError(
            f"{what} must have tetrahedra or hexahedra of degree 1 or 2, got "
            f"{' and '.join(names) or 'no volume cells'}"
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
