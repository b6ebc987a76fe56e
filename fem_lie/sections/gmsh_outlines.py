"""Meshes of section outlines by gmsh: cell sizes, and named groups of surfaces."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices
from fem_lie.mesh.gmsh_cells import cell_blocks, coordinates_of
from fem_lie.mesh.gmsh_session import GmshScript, logged, model, opened, physical, session
from fem_lie.sections.outline import TOUCH, Loop, Part, cross

_WALL_CELL = 0.5  # size of cells in a wall over its thickness
_CORNER_CELL = 0.01  # the same at a re-entrant corner
_LARGEST_CELL = 0.125  # size of cells over the diameter of the outline
_MOST_CELLS = 100_000
_SHARP = 0.3  # angle, larger than between chords of an arc
_CLOSE = 1e-6  # of the length of a chord
_SIZE_STEP = 0.1  # sizes that differ by less are the same
GROWTH = 0.35  # of the cell's size per distance


@dataclass(frozen=True, eq=False)
class CellSizes:
    """Cell sizes at segments, which grow with the distance from them.

    Attributes:
        start: First ends of the segments, shape (n, 2).
        along: Vectors to their other ends, shape (n, 2).
        size: Cell size at each segment, shape (n,).
    """

    start: Array
    along: Array
    size: Array

    @classmethod
    def of(cls, parts: Sequence[Part], refinement: float) -> CellSizes:
        """Sizes for some cells across each wall, and small cells where strains peak.

        Raises:
            ValueError: Walls are so thin that there would be too many cells.
        """
        walls = [_Walls.of(part) for part in parts]
        starts, alongs, sizes = [], [], []
        for wall in walls:
            peak = wall.reentrant()
            for other in walls:
                if other is not wall:
                    peak |= wall.ends_on(other)
            starts += [wall.start, wall.start[peak]]
            alongs += [wall.along, np.zeros_like(wall.start[peak])]
            sizes += [_WALL_CELL * wall.thickness, _CORNER_CELL * wall.at_corners()[peak]]
        largest = _LARGEST_CELL * np.linalg.norm(np.ptp(np.concatenate(starts), axis=0))
        size = np.minimum(np.concatenate(sizes), largest) / refinement
        along = np.concatenate(alongs)
        count = 2.0 * (np.linalg.norm(along, axis=1) / size).sum()
        if count > _MOST_CELLS:
            raise ValueError(
                f"walls are too thin to be meshed: about {count:.0f} cells, at most {_MOST_CELLS}; "
                "use less refinement, or a section of known stiffness"
            )
        return cls(np.concatenate(starts), along, size)

    def samples(self) -> Iterator[tuple[float, Array]]:
        """Sizes, rounded down to a geometric series, and points along their segments."""
        steps = np.floor(np.log(self.size) / _SIZE_STEP)
        for step in np.unique(steps):
            size = float(np.exp(step * _SIZE_STEP))
            points = [
                start + np.linspace(0.0, 1.0, count)[:, np.newaxis] * along
                for start, along, count in zip(*self._like(steps == step, size), strict=True)
            ]
            yield size, np.concatenate(points)

    def _like(self, chosen: npt.NDArray[np.bool_], size: float) -> tuple[Array, Array, Any]:
        along = self.along[chosen]
        counts = np.ceil(np.linalg.norm(along, axis=1) / size).astype(int) + 1
        return self.start[chosen], along, counts


@dataclass(frozen=True, eq=False)
class _Walls:
    """Chords of a part's loops with the material on their left, one loop after the other.

    Attributes:
        start: First points of the chords, shape (n, 2).
        along: Vectors to the next chord's start, shape (n, 2).
        before: Index of the previous chord, shape (n,).
        thickness: Thickness of the wall behind each, shape (n,).
    """

    start: Array
    along: Array
    before: npt.NDArray[np.int64]
    thickness: Array

    @classmethod
    def of(cls, part: Part) -> _Walls:
        """All walls of a part."""
        loops = [_oriented(loop.chords(), i == 0) for i, loop in enumerate(part.loops)]
        start = np.concatenate(loops)
        along = np.concatenate([np.roll(points, -1, axis=0) - points for points in loops])
        firsts = np.cumsum([0, *map(len, loops)])
        before = [
            first + np.roll(np.arange(len(points)), 1)
            for first, points in zip(firsts, loops, strict=False)
        ]
        return cls(start, along, np.concatenate(before), _thickness(start, along))

    def at_corners(self) -> Array:
        """Smaller thickness of the walls that meet at each chord's start."""
        return np.minimum(self.thickness, self.thickness[self.before])

    def reentrant(self) -> npt.NDArray[np.bool_]:
        """Starts at re-entrant corners; points within an arc are excluded."""
        before = self.along[self.before]
        turn = np.arctan2(cross(before, self.along), (before * self.along).sum(axis=1))
        return np.asarray(turn < -_SHARP)

    def ends_on(self, other: _Walls) -> npt.NDArray[np.bool_]:
        """Starts within a chord of another part, which continues where this part ends."""
        r = self.start[:, np.newaxis] - other.start
        length = np.linalg.norm(other.along, axis=1)
        unit = other.along / length[:, np.newaxis]
        beside, along = np.abs(cross(unit, r)), (r * unit).sum(axis=-1)
        margin = _CLOSE * length
        return np.asarray(
            ((beside < margin) & (along > margin) & (along < length - margin)).any(axis=1)
        )


def _oriented(points: Array, counter_clockwise: bool) -> Array:
    """Points in the order with the material on the left."""
    area = cross(points, np.roll(points, -1, axis=0)).sum()
    return points if (area > 0) == counter_clockwise else points[::-1]


def _thickness(a: Array, d: Array) -> Array:
    """Thickness of the wall behind each edge: the least of three rays into the material."""
    normal = np.column_stack([-d[:, 1], d[:, 0]]) / np.linalg.norm(d, axis=1, keepdims=True)
    thickness = np.full(len(a), np.inf)
    for part in (0.25, 0.5, 0.75):
        origin = (a + part * d)[:, np.newaxis]
        ray = np.broadcast_to(normal[:, np.newaxis], (len(a), *d.shape))
        edge = np.broadcast_to(d, ray.shape)
        det = cross(ray, edge)
        safe = np.where(np.abs(det) > 1e-12 * np.linalg.norm(edge, axis=-1), det, np.inf)
        r = a - origin
        distance, along = cross(r, edge) / safe, cross(r, ray) / safe
        hit = np.isfinite(safe) & (np.abs(along - 0.5) <= 0.5 + TOUCH)
        np.fill_diagonal(hit, False)
        hit &= distance > 0
        thickness = np.minimum(thickness, np.where(hit, distance, np.inf).min(axis=1))
    return thickness


_DELAUNAY = 5  # gmsh's number of an algorithm that follows strongly varying sizes
_FAR = 10.0  # outlines have a diameter of about 2
_AREA = 1e-6  # relative; a common surface of two parts is larger


@dataclass(frozen=True, eq=False)
class RawSurface:
    """Surface cells in DOLFINx's order of nodes.

    Attributes:
        points: Coordinates, shape (n, 2).
        cells: Points of each cell, shape (m, k).
        regions: Index in ``names`` of each cell's region, shape (m,).
        names: Names of the regions.
        cell: ``triangle`` or ``quadrilateral``.
        degree: Degree of the cells' edges.
    """

    points: Array
    cells: Indices
    regions: Indices
    names: tuple[str, ...]
    cell: str
    degree: int


def mesh_parts(parts: Mapping[str, Part], sizes: CellSizes) -> RawSurface:
    """Mesh of triangles of degree 2 that follow arcs and interfaces.

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
    """Surfaces of each part, after touching parts have been made to share edges."""
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
    """Size field: minimum of sizes that grow with the distance from sample points.

    The points belong to the model, but to none of its surfaces.
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
    """Cells of groups of surfaces in a plane, with points numbered from 0."""
    block, *others = cell_blocks(gmsh, groups, what)
    if others:
        raise ValueError(f"{what} must have cells of one type, got triangles and quadrilaterals")
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
    """First two coordinates of points with a constant third coordinate."""
    if np.ptp(points[:, 2]) > 1e-9 * np.ptp(points, axis=0).max():
        raise ValueError(f"{what} must lie in a plane of constant third coordinate")
    return np.ascontiguousarray(points[:, :2])
