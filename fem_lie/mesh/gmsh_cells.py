"""Lines and surfaces of gmsh models: cells, tangents and normals of CAD, named groups."""

from __future__ import annotations

import logging
import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fem_lie._arrays import Array, Indices, whole_number
from fem_lie.mesh.curves import Spline
from fem_lie.mesh.gmsh_session import (
    GmshScript,
    chosen_entities,
    logged,
    named_points,
    opened,
    physical,
)
from fem_lie.mesh.lines import circle_tangents, flipped
from fem_lie.mesh.patches import CellsOfOneType

_log = logging.getLogger(__name__)

_STRAIGHT = 1e-6  # rad, between tangents that count as equal
_LINES = {1: 2, 8: 3}
"""Nodes of gmsh's lines of first and second order."""
_HALVES = {1: [0, 1], 8: [0, 2, 2, 1]}
"""Nodes of the line, or of its halves: two ends come first."""


@dataclass(frozen=True, eq=False)
class RawLines:
    """Line cells in the order of gmsh; points without cells are removed.

    Attributes:
        points: Coordinates, shape (n, 3).
        cells: Pairs of points, shape (m, 2).
        tangents: Unit tangents from CAD curves, or of circles through a curve's points where there
            is no CAD, shape (m, 2, 3).
        groups: Cells of each physical group of curves.
        named_points: Points of each physical group of points.
    """

    points: Array
    cells: Indices
    tangents: Array
    groups: dict[str, Indices]
    named_points: dict[str, Indices]


def read_lines(path: str | os.PathLike[str] | GmshScript, kink_angle: float) -> RawLines:
    """Lines of a file, read into a temporary gmsh model.

    Raises:
        FileNotFoundError: There is no such file.
        ValueError: gmsh cannot read it, a parameter does not exist, or it has no lines.
    """
    with opened(path) as (gmsh, file):
        if gmsh.model.mesh.getNodes()[0].size == 0:
            logged(gmsh, file, lambda: gmsh.model.mesh.generate(1))
        return model_lines(str(file), kink_angle)


def read_curve(
    path: str | os.PathLike[str] | GmshScript,
    cells: int,
    *,
    curve: int | None = None,
) -> Spline:
    """Curve of a CAD file (STEP, IGES, BREP) or of a script, rational curves (NURBS) included.

    gmsh evaluates the curve, so that positions and derivatives at the knots are exact. Between them
    the cubic approximates it to fourth order; it is exact for a cubic spline with its knots among
    ``u``.

    Args:
        path: File, or a script (:func:`~fem_lie.mesh.run_gmsh_script`).
        cells: Number of equal intervals of the curve's parameter.
        curve: gmsh's number of the curve; default: the only one.

    Raises:
        FileNotFoundError: There is no such file.
        ValueError: The file is neither CAD nor a mesh, gmsh cannot read it, there is no such curve
            or several and no number, or there are no cells.
    """
    count = whole_number(cells) + 1
    with opened(path) as (gmsh, file):
        known = [tag for _, tag in gmsh.model.getEntities(1)]
        chosen = known[0] if curve is None and len(known) == 1 else curve
        if chosen not in known:
            raise ValueError(
                f"{str(file)!r} has the curves {known}, and read_curve takes one of them, got "
                f"curve = {curve}"
            )
        (begin,), (end,) = gmsh.model.getParametrizationBounds(1, chosen)
        u = np.linspace(begin, end, count)
        positions = np.reshape(gmsh.model.getValue(1, chosen, u), (-1, 3))
        slopes = np.reshape(gmsh.model.getDerivative(1, chosen, u), (-1, 3))
    return Spline(u, positions, slopes)


def model_lines(what: str, kink_angle: float) -> RawLines:
    """Lines of the current gmsh model; ``what`` is its name in messages.

    Curves without geometry are smooth where they turn by no more than ``kink_angle``, rad.
    """
    import gmsh

    curves = chosen_entities(gmsh, 1, what)
    cells, tangents, owner = [], [], []
    for curve in curves:
        ends = _line_cells(gmsh, curve, what)
        cells.append(ends)
        known = _cad_tangents(gmsh, curve, ends)
        if len(ends) and np.isnan(known).all():
            known = _circle_tangents(gmsh, ends, kink_angle, f"{what}: curve {curve}")
        tangents.append(known)
        owner.append(np.full(len(ends), curve))
    if not cells or not sum(map(len, cells)):
        raise ValueError(f"{what} has no line cells; give the curves a mesh and a physical group")
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    used, local = np.unique(np.concatenate(cells), return_inverse=True)
    order = np.argsort(tags)
    rows = order[np.searchsorted(tags, used, sorter=order)]
    of_curve = np.concatenate(owner)
    return RawLines(
        points=coordinates.reshape(-1, 3)[rows],
        cells=local.reshape(-1, 2).astype(np.int64),
        tangents=np.concatenate(tangents),
        groups={
            name: np.flatnonzero(np.isin(of_curve, entities))
            for name, entities in physical(gmsh, 1).items()
        },
        named_points=named_points(gmsh, used),
    )


def _line_cells(gmsh: Any, curve: int, what: str) -> Indices:
    """Pairs of node tags of one curve, shape (m, 2); a line of second order is two of them."""
    types, _, nodes = gmsh.model.mesh.getElements(1, curve)
    pairs = [np.empty((0, 2), dtype=np.int64)]
    for kind, tags in zip(types, nodes, strict=True):
        if kind not in _HALVES:
            name = gmsh.model.mesh.getElementProperties(kind)[0]
            raise ValueError(
                f"{what}: curve {curve} has cells of type {name!r}; expected lines of 2 or 3 nodes"
            )
        lines = tags.astype(np.int64).reshape(-1, _LINES[kind])
        pairs.append(lines[:, _HALVES[kind]].reshape(-1, 2))
    return np.concatenate(pairs)


def _cad_tangents(gmsh: Any, curve: int, cells: Indices) -> Array:
    """Unit tangents at both ends of each cell, (m, 2, 3); nan if the curve has no geometry."""
    unknown = np.full((len(cells), 2, 3), np.nan)
    if gmsh.model.getType(1, curve) == "Discrete curve":
        return unknown
    tags, coordinates, parameter = gmsh.model.mesh.getNodes(1, curve, True, True)
    if len(parameter) != len(tags):
        return unknown
    derivative = np.array(gmsh.model.getDerivative(1, curve, parameter)).reshape(-1, 3)
    size = np.linalg.norm(derivative, axis=1, keepdims=True)
    unit = np.divide(derivative, size, where=size > 0, out=np.full_like(derivative, np.nan))
    order = np.argsort(tags)
    rows = order[np.searchsorted(tags, cells, sorter=order)]
    chord = np.diff(coordinates.reshape(-1, 3)[rows], axis=1)
    return unit[rows] * np.where((unit[rows] * chord).sum(axis=-1, keepdims=True) < 0, -1.0, 1.0)


def _circle_tangents(gmsh: Any, cells: Indices, kink_angle: float, what: str) -> Array:
    """Unit tangents of circles through successive points of one curve, shape (m, 2, 3)."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    used, local = np.unique(cells, return_inverse=True)
    order = np.argsort(tags)
    points = coordinates.reshape(-1, 3)[order[np.searchsorted(tags, used, sorter=order)]]
    local = local.reshape(-1, 2)
    flip = flipped(local, len(used))[:, np.newaxis]
    # cells without length are refused with the mesh
    with np.errstate(divide="ignore", invalid="ignore"):
        found = circle_tangents(points, np.where(flip, local[:, ::-1], local), kink_angle)
    turns = np.linalg.norm(found[:, 1] - found[:, 0], axis=1).max()
    if turns > _STRAIGHT:
        angle = np.degrees(kink_angle)
        _log.info("%s has no CAD: it is smooth where it turns by less than %.0f°", what, angle)
    return np.where(flip[..., np.newaxis], -found[:, ::-1], found)


@dataclass(frozen=True, eq=False)
class RawShell:
    """Surface cells in DOLFINx's order; points without cells are removed.

    Attributes:
        points: Coordinates, shape (n, 3).
        blocks: Cells of each type, numbered block after block; normals of the CAD surface at their
            nodes, nan without CAD.
        groups: Cells of each physical group of surfaces.
        curves: Edges of each physical group of curves.
        named_points: Points of each physical group of points.
    """

    points: Array
    blocks: tuple[CellsOfOneType, ...]
    groups: dict[str, Indices]
    curves: dict[str, Indices]
    named_points: dict[str, Indices]


def read_shell(path: str | os.PathLike[str] | GmshScript) -> RawShell:
    """Surfaces of a file, meshed if it has no mesh.

    Raises:
        FileNotFoundError: There is no such file.
        ValueError: gmsh cannot read it, a parameter does not exist, or it has no supported cells.
    """
    with opened(path) as (gmsh, file):
        if not len(gmsh.model.mesh.getElements(2)[0]):
            logged(gmsh, file, lambda: gmsh.model.mesh.generate(2))
        return model_shell(str(file))


def model_shell(what: str) -> RawShell:
    """Surfaces of the current gmsh model; ``what`` is its name in messages."""
    import gmsh

    chosen, named = chosen_entities(gmsh, 2, what), physical(gmsh, 2)
    blocks = [_once(block) for block in cell_blocks(gmsh, named or {"": chosen}, what)]
    used = np.unique(np.concatenate([block.cells.ravel() for block in blocks]))
    surfaces = np.concatenate([block.surfaces for block in blocks])
    return RawShell(
        points=coordinates_of(gmsh, used),
        blocks=tuple(
            CellsOfOneType(
                np.searchsorted(used, block.cells),
                block.cell,
                _cad_normals(gmsh, block.cells, block.surfaces),
            )
            for block in blocks
        ),
        groups={
            name: np.flatnonzero(np.isin(surfaces, entities)) for name, entities in named.items()
        },
        curves=_curves(gmsh, used, blocks[0].degree, what),
        named_points=named_points(gmsh, used),
    )


def _once(block: CellBlock) -> CellBlock:
    """Cells of a block, those of a surface in two groups once."""
    _, once = np.unique(np.sort(block.cells, axis=1), axis=0, return_index=True)
    once.sort()
    return replace(
        block,
        cells=block.cells[once],
        regions=block.regions[once],
        surfaces=block.surfaces[once],
    )


def _curves(gmsh: Any, used: Indices, degree: int, what: str) -> dict[str, Indices]:
    """Edges on the surfaces of each physical group of curves."""
    curves = {}
    for name, entities in physical(gmsh, 1).items():
        edges: list[Indices] = []
        for curve in entities:
            for kind, _, nodes in zip(*gmsh.model.mesh.getElements(1, curve), strict=True):
                if _LINES.get(int(kind)) != degree + 1:
                    raise ValueError(f"{what}: curve {curve} and the surfaces differ in order")
                edges.append(nodes.astype(np.int64).reshape(-1, degree + 1))
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
    """Normals of the CAD surface, oriented like the cells' corners."""
    x = coordinates.reshape(*normals.shape)
    cross = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    side = np.sign(np.einsum("mj,mkj->mk", cross, normals))
    return np.asarray(normals * side[..., np.newaxis])


# gmsh's element types: shape, degree, and where DOLFINx's nodes stand among gmsh's
_CELLS = {
    2: ("triangle", 1, (0, 1, 2)),
    3: ("quadrilateral", 1, (0, 1, 3, 2)),
    9: ("triangle", 2, (0, 1, 2, 4, 5, 3)),
    10: ("quadrilateral", 2, (0, 1, 3, 2, 4, 7, 5, 6, 8)),
}


@dataclass(frozen=True, eq=False)
class CellBlock:
    """Cells of one type by gmsh's node tags, in DOLFINx's order.

    Attributes:
        cells: Node tags, shape (m, k).
        regions: Index of each cell's group, shape (m,).
        surfaces: gmsh's tag of the surface of each cell, shape (m,).
        cell: ``triangle`` or ``quadrilateral``.
        degree: Degree of the cells' edges.
    """

    cells: Indices
    regions: Indices
    surfaces: Indices
    cell: str
    degree: int


def cell_blocks(gmsh: Any, groups: Mapping[str, list[int]], what: str) -> list[CellBlock]:
    """Cells of groups of surfaces, a block for each cell type, all of one degree.

    Raises:
        ValueError: There are no cells, or cells of unsupported types or several degrees.
    """
    found: dict[int, list[tuple[Indices, int, int]]] = {}
    for region, surfaces in enumerate(groups.values()):
        for surface in surfaces:
            for kind, _, nodes in zip(*gmsh.model.mesh.getElements(2, surface), strict=True):
                found.setdefault(int(kind), []).append((nodes.astype(np.int64), region, surface))
    degrees = {_CELLS[kind][1] if kind in _CELLS else 0 for kind in found}
    if len(degrees) != 1 or 0 in degrees:
        names = [gmsh.model.mesh.getElementProperties(kind)[0] for kind in sorted(found)]
        raise ValueError(
            f"{what} must have triangles of 3 and quadrilaterals of 4 nodes, or triangles of 6 and "
            f"quadrilaterals of 9, got {' and '.join(names) or 'no surface cells'}"
        )
    return [_block(kind, found[kind]) for kind in sorted(found)]


def _block(kind: int, parts: list[tuple[Indices, int, int]]) -> CellBlock:
    """Cells of one of gmsh's element types, from node tags, region and surface of each part."""
    cell, degree, order = _CELLS[kind]
    blocks, regions, surfaces = zip(*parts, strict=True)
    counts = [len(block) // len(order) for block in blocks]
    return CellBlock(
        cells=np.concatenate(blocks).reshape(-1, len(order))[:, order],
        regions=np.repeat(regions, counts),
        surfaces=np.repeat(surfaces, counts),
        cell=cell,
        degree=degree,
    )


def coordinates_of(gmsh: Any, tags: Indices) -> Array:
    """Coordinates of nodes, shape (n, 3)."""
    known, coordinates, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(known)
    return np.asarray(coordinates.reshape(-1, 3)[order[np.searchsorted(known[order], tags)]])
