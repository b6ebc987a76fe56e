"""Surfaces of gmsh models: meshes of outlines, and of files with named groups of surfaces."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.mesh.gmsh_session import GmshScript, logged, model, opened, physical, session
from fem_lie.mesh.gmsh_surfaces import cell_block, coordinates_of
from fem_lie.sections.outlines.cell_sizes import GROWTH, CellSizes
from fem_lie.sections.outlines.outline import Loop, Part

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
    with session() as gmsh, model(gmsh):
        owner = _surfaces(gmsh, parts)
        _sizes(gmsh, sizes)
        options = {"MeshSizeExtendFromBoundary": 0, "MeshSizeFromPoints": 0, "Algorithm": _DELAUNAY}
        before = {name: gmsh.option.getNumber(f"Mesh.{name}") for name in options}
        try:
            for name, value in options.items():
                gmsh.option.setNumber(f"Mesh.{name}", value)
            logged(gmsh, Path("section"), lambda: gmsh.model.mesh.generate(2))
            gmsh.model.mesh.setOrder(2)
        finally:
            for name, value in before.items():
                gmsh.option.setNumber(f"Mesh.{name}", value)
        return _cells(gmsh, owner, "the section")


def read_surface(path: str | os.PathLike[str] | GmshScript) -> RawSurface:
    """Surface cells of a file, meshed if it has no mesh; groups of surfaces are regions.

    Raises:
        FileNotFoundError: There is no such file.
        ValueError: gmsh cannot read it, or it has no usable cells.
    """
    with opened(path) as (gmsh, file):
        if not len(gmsh.model.mesh.getElements(2)[0]):
            logged(gmsh, file, lambda: gmsh.model.mesh.generate(2))
        groups = physical(gmsh, 2)
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


def _plane(points: Array, what: str) -> Array:
    """First two coordinates of points of which the third is everywhere the same."""
    if np.ptp(points[:, 2]) > 1e-9 * np.ptp(points, axis=0).max():
        raise ValueError(f"{what} must lie in a plane of constant third coordinate")
    return np.ascontiguousarray(points[:, :2])
