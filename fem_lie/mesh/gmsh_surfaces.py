"""Surfaces of gmsh models in space: cells, normals of the CAD, named groups of all dimensions."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.mesh.gmsh_session import (
    GmshScript,
    chosen_entities,
    logged,
    named_points,
    opened,
    physical,
)

_LINES = {1: 2, 8: 3}  # nodes of gmsh's lines of order 1 and 2


@dataclass(frozen=True, eq=False)
class RawShell:
    """Cells as DOLFINx orders them; points without cells are dropped.

    Attributes:
        points: Coordinates, shape (n, 3).
        cells: Points of each cell, shape (m, k).
        cell: ``triangle`` or ``quadrilateral``.
        normals: Of the CAD at the cells' nodes, shape (m, k, 3), nan where there is no CAD.
        groups: Cells of each physical group of surfaces.
        curves: Edges of each physical group of curves.
        named_points: Points of each physical group of points.
    """

    points: Array
    cells: Indices
    cell: str
    normals: Array
    groups: dict[str, Indices]
    curves: dict[str, Indices]
    named_points: dict[str, Indices]


def read_shell(path: str | os.PathLike[str] | GmshScript) -> RawShell:
    """Surfaces of a file, meshed if it has no mesh.

    Raises:
        FileNotFoundError: There is no such file.
        ValueError: gmsh cannot read it, a parameter is not in it, or it has no usable cells.
    """
    with opened(path) as (gmsh, file):
        if not len(gmsh.model.mesh.getElements(2)[0]):
            logged(gmsh, file, lambda: gmsh.model.mesh.generate(2))
        return model_shell(str(file))


def model_shell(what: str) -> RawShell:
    """Surfaces of the current gmsh model; ``what`` is its name in messages."""
    import gmsh

    chosen, named = chosen_entities(gmsh, 2, what), physical(gmsh, 2)
    block = cell_block(gmsh, named or {"": chosen}, what)
    # a surface in two groups is there once
    _, once = np.unique(np.sort(block.cells, axis=1), axis=0, return_index=True)
    once.sort()
    cells, surfaces = block.cells[once], block.surfaces[once]
    used, local = np.unique(cells, return_inverse=True)
    return RawShell(
        points=coordinates_of(gmsh, used),
        cells=local.reshape(cells.shape).astype(np.int64),
        cell=block.cell,
        normals=_cad_normals(gmsh, cells, surfaces),
        groups={
            name: np.flatnonzero(np.isin(surfaces, entities)) for name, entities in named.items()
        },
        curves=_curves(gmsh, used, block, what),
        named_points=named_points(gmsh, used),
    )


def _curves(gmsh: Any, used: Indices, block: CellBlock, what: str) -> dict[str, Indices]:
    """Edges on the surfaces of each physical group of curves."""
    curves = {}
    for name, entities in physical(gmsh, 1).items():
        edges: list[Indices] = []
        for curve in entities:
            for kind, _, nodes in zip(*gmsh.model.mesh.getElements(1, curve), strict=True):
                if _LINES.get(int(kind)) != block.degree + 1:
                    raise ValueError(f"{what}: curve {curve} and the surfaces differ in order")
                edges.append(nodes.astype(np.int64).reshape(-1, block.degree + 1))
        tags = np.concatenate(edges) if edges else np.empty((0, 2), dtype=np.int64)
        tags = tags[np.isin(tags, used).all(axis=1)]
        if len(tags):
            curves[name] = np.searchsorted(used, tags)
    return curves


def _cad_normals(gmsh: Any, cells: Indices, surfaces: Indices) -> Array:
    """Unit normals of the CAD surface at the nodes of each cell; nan if there is no geometry."""
    normals = np.full((*cells.shape, 3), np.nan)
    for surface in np.unique(surfaces):
        if gmsh.model.getType(2, surface) == "Discrete surface":
            continue
        tags, _, parameters = gmsh.model.mesh.getNodes(2, surface, True, True)
        if len(parameters) != 2 * len(tags):
            continue
        found = np.array(gmsh.model.getNormal(surface, parameters)).reshape(-1, 3)
        size = np.linalg.norm(found, axis=1, keepdims=True)
        found = np.divide(found, size, where=size > 0, out=np.full_like(found, np.nan))
        order, mine = np.argsort(tags), surfaces == surface
        here = found[order[np.searchsorted(tags[order], cells[mine])]]
        normals[mine] = _on_one_side(here, coordinates_of(gmsh, cells[mine].ravel()))
    return normals


def _on_one_side(normals: Array, coordinates: Array) -> Array:
    """The CAD's normals, turned to the side to which the cells' corners go round."""
    x = coordinates.reshape(*normals.shape)
    cross = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    side = np.sign(np.einsum("mj,mkj->mk", cross, normals))
    return np.asarray(normals * side[..., np.newaxis])


# gmsh's element types: shape, degree, and where DOLFINx's nodes stand among gmsh's
_CELLS = {
    2: ("triangle", 1, (0, 1, 2)),
    3: ("quadrilateral", 1, (0, 1, 3, 2)),
    9: ("triangle", 2, (0, 1, 2, 4, 5, 3)),
}


@dataclass(frozen=True, eq=False)
class CellBlock:
    """Cells of one kind by gmsh's node tags, in DOLFINx's order.

    Attributes:
        cells: Node tags, shape (m, k).
        regions: Number of each cell's group, shape (m,).
        surfaces: gmsh's tag of the surface of each cell, shape (m,).
        cell: ``triangle`` or ``quadrilateral``.
        degree: Of the cells' edges.
    """

    cells: Indices
    regions: Indices
    surfaces: Indices
    cell: str
    degree: int


def cell_block(gmsh: Any, groups: Mapping[str, list[int]], what: str) -> CellBlock:
    """Cells of groups of surfaces.

    Raises:
        ValueError: They are of several kinds, of an unknown one, or there are none.
    """
    blocks, owner, kinds = [], [], set()
    for region, surfaces in enumerate(groups.values()):
        for surface in surfaces:
            for kind, _, nodes in zip(*gmsh.model.mesh.getElements(2, surface), strict=True):
                kinds.add(int(kind))
                blocks.append(nodes.astype(np.int64))
                owner.append((region, surface))
    if len(kinds) != 1 or not kinds <= set(_CELLS):
        names = [gmsh.model.mesh.getElementProperties(kind)[0] for kind in sorted(kinds)]
        raise ValueError(
            f"{what} must have triangles of degree 1 or 2, or quadrilaterals of degree 1, got "
            f"{' and '.join(names) or 'no surface cells'}"
        )
    cell, degree, order = _CELLS[kinds.pop()]
    counts = [len(block) // len(order) for block in blocks]
    return CellBlock(
        cells=np.concatenate([block.reshape(-1, len(order)) for block in blocks])[:, order],
        regions=np.repeat([region for region, _ in owner], counts),
        surfaces=np.repeat([surface for _, surface in owner], counts),
        cell=cell,
        degree=degree,
    )


def coordinates_of(gmsh: Any, tags: Indices) -> Array:
    """Coordinates of nodes, shape (n, 3)."""
    known, coordinates, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(known)
    return np.asarray(coordinates.reshape(-1, 3)[order[np.searchsorted(known[order], tags)]])
