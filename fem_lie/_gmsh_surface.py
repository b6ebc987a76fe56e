"""Surfaces of gmsh models: meshes of outlines, and of files with named groups of surfaces."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fem_lie._cell_sizes import GROWTH, CellSizes
from fem_lie._gmsh import _logged, _model, _opened, _physical, _session
from fem_lie._lines import Indices
from fem_lie._outline import Loop, Part
from fem_lie.section import Array

# gmsh's element types: shape, degree, and where DOLFINx's nodes stand among gmsh's
_CELLS = {
    2: ("triangle", 1, (0, 1, 2)),
    3: ("quadrilateral", 1, (0, 1, 3, 2)),
    9: ("triangle", 2, (0, 1, 2, 4, 5, 3)),
}
_DELAUNAY = 5  # gmsh's number; follows sizes that vary strongly
_FAR = 10.0  # outlines have a diameter of about 2
_AREA = 1e-6  # relative; a common surface of two parts is larger


@dataclass(frozen=True, eq=False)
class RawSurface:
    """Cells as DOLFINx orders them.

    Attributes:
        points: Shape (n, 2).
        cells: Points of each cell, shape (m, k).
        regions: Which of ``names`` each cell belongs to, shape (m,).
        names: Names of the regions.
        cell: ``triangle`` or ``quadrilateral``.
        degree: Of the cells' edges.
    """

    points: Array
    cells: Indices
    regions: Indices
    names: tuple[str, ...]
    cell: str
    degree: int


def mesh_parts(parts: Mapping[str, Part], sizes: CellSizes) -> RawSurface:
    """Triangles of degree 2 that follow arcs and interfaces.

    Raises:
        ValueError: Parts overlap, or gmsh cannot mesh them.
    """
    with _session() as gmsh, _model(gmsh):
        owner = _surfaces(gmsh, parts)
        _sizes(gmsh, sizes)
        options = {"MeshSizeExtendFromBoundary": 0, "MeshSizeFromPoints": 0, "Algorithm": _DELAUNAY}
        before = {name: gmsh.option.getNumber(f"Mesh.{name}") for name in options}
        try:
            for name, value in options.items():
                gmsh.option.setNumber(f"Mesh.{name}", value)
            _logged(gmsh, Path("section"), lambda: gmsh.model.mesh.generate(2))
            gmsh.model.mesh.setOrder(2)
        finally:
            for name, value in before.items():
                gmsh.option.setNumber(f"Mesh.{name}", value)
        return _cells(gmsh, owner, "the section")


def read_surface(
    path: str | os.PathLike[str], parameters: Mapping[str, float] | None
) -> RawSurface:
    """Surface cells of a file, meshed if it has no mesh; groups of surfaces are regions.

    Raises:
        FileNotFoundError: There is no such file.
        ValueError: gmsh cannot read it, or it has no usable cells.
    """
    with _opened(path, parameters) as (gmsh, file):
        if not len(gmsh.model.mesh.getElements(2)[0]):
            _logged(gmsh, file, lambda: gmsh.model.mesh.generate(2))
        groups = _physical(gmsh, 2)
        if not groups:
            groups = {"section": [tag for _, tag in gmsh.model.getEntities(2)]}
        return _cells(gmsh, groups, str(file))


def _loop(gmsh: Any, loop: Loop) -> int:
    occ = gmsh.model.occ
    points = [occ.addPoint(start[0], start[1], 0.0) for start, _, _ in loop.edges()]
    curves = []
    for i, (_, _, centre) in enumerate(loop.edges()):
        start, end = points[i], points[(i + 1) % len(points)]
        if np.isnan(centre[0]):
            curves.append(occ.addLine(start, end))
        else:
            curves.append(occ.addCircleArc(start, occ.addPoint(centre[0], centre[1], 0.0), end))
    return int(occ.addCurveLoop(curves))


def _surfaces(gmsh: Any, parts: Mapping[str, Part]) -> dict[str, list[int]]:
    """Surfaces of each part, after parts that touch have been made to share their edges."""
    occ = gmsh.model.occ
    faces = [
        (2, occ.addPlaneSurface([_loop(gmsh, loop) for loop in part.loops]))
        for part in parts.values()
    ]
    pieces = [[face] for face in faces]
    if len(faces) > 1:
        separate = sum(occ.getMass(*face) for face in faces)
        together, pieces = occ.fragment(faces[:1], faces[1:])
        if sum(occ.getMass(*face) for face in together) < (1.0 - _AREA) * separate:
            raise ValueError(f"parts {', '.join(map(repr, parts))} overlap; they may only touch")
    occ.synchronize()
    return {
        name: [tag for dim, tag in piece if dim == 2]
        for name, piece in zip(parts, pieces, strict=True)
    }


def _sizes(gmsh: Any, sizes: CellSizes) -> None:
    """A field: the least of sizes that grow with the distance from sample points.

    The points are in the model, but in none of its surfaces.
    """
    field, thresholds = gmsh.model.mesh.field, []
    for size, points in sizes.samples():
        tags = [gmsh.model.occ.addPoint(y, z, 0.0) for y, z in points]
        gmsh.model.occ.synchronize()
        distance, threshold = field.add("Distance"), field.add("Threshold")
        field.setNumbers(distance, "PointsList", tags)
        numbers = {"InField": distance, "SizeMin": size, "SizeMax": size + GROWTH * _FAR}
        for name, value in {**numbers, "DistMin": 0.0, "DistMax": _FAR}.items():
            field.setNumber(threshold, name, value)
        thresholds.append(threshold)
    least = field.add("Min")
    field.setNumbers(least, "FieldsList", thresholds)
    field.setAsBackgroundMesh(least)


def _cells(gmsh: Any, groups: Mapping[str, list[int]], what: str) -> RawSurface:
    """Cells of groups of surfaces in a plane, with their points from 0 on."""
    block = cell_block(gmsh, groups, what)
    used, local = np.unique(block.cells, return_inverse=True)
    return RawSurface(
        points=_plane(coordinates_of(gmsh, used), what),
        cells=local.reshape(block.cells.shape).astype(np.int64),
        regions=block.regions,
        names=tuple(groups),
        cell=block.cell,
        degree=block.degree,
    )


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


def _plane(points: Array, what: str) -> Array:
    """First two coordinates of points of which the third is everywhere the same."""
    if np.ptp(points[:, 2]) > 1e-9 * np.ptp(points, axis=0).max():
        raise ValueError(f"{what} must lie in a plane of constant third coordinate")
    return np.ascontiguousarray(points[:, :2])
