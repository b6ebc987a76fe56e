"""Meshes of beam sections: cells in the plane of e₂ and e₃, each in a named region."""

from __future__ import annotations

import os
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from fem_lie._arrays import Array, Indices, indices_of, points_of
from fem_lie._summary import Summarised
from fem_lie.mesh.gmsh_session import GmshScript
from fem_lie.mesh.shapes import cell_normals

if TYPE_CHECKING:
    import dolfinx

# one after the other round the cell; those of a triangle in DOLFINx's order
_EDGES = {
    "triangle": ((1, 2), (2, 0), (0, 1)),
    "quadrilateral": ((0, 1), (1, 3), (3, 2), (2, 0)),
}

_DEGREES = {("triangle", 3): 1, ("triangle", 6): 2, ("quadrilateral", 4): 1}

_KEPT_TURN = 2.0 * np.pi / 48.0  # a circle is drawn with about 32 corners


@dataclass(frozen=True, eq=False, repr=False)
class SectionMesh(Summarised):
    """Cells of a section.

    Attributes:
        points: Coordinates (y, z), shape (n, 2).
        cells: Points of each cell in DOLFINx's order, shape (m, k).
        regions: Index in ``names`` of each cell's region, shape (m,).
        names: Names of the regions; arbitrary for a section of one material.
        cell: ``triangle`` or ``quadrilateral``.
        degree: Degree of the cells' edges.

    Raises:
        ValueError: There are no cells, one has no area or folds over, or the section is not
            connected.
    """

    points: Array
    cells: Indices
    regions: Indices
    names: tuple[str, ...]
    cell: str = "triangle"
    degree: int = 2

    def __post_init__(self) -> None:
        if not len(self.cells):
            raise ValueError("the section has no cells")
        points = points_of(np.pad(np.asarray(self.points, dtype=np.float64), ((0, 0), (0, 1))))
        cell_normals(points, indices_of(self.cells, len(points), "cells"), self.cell)
        ends, _ = self._edges()
        _, number = np.unique(np.sort(ends, axis=1), axis=0, return_inverse=True)
        cell = np.tile(np.arange(len(self.cells)), len(_EDGES[self.cell]))
        ones = np.ones(len(cell))
        shares = coo_matrix((ones, (cell, number.ravel()))).tocsr()
        count, _ = connected_components(shares @ shares.T, directed=False)
        if count > 1:
            raise ValueError(
                f"the section must be connected, got {count} pieces that share no edge of a cell"
            )

    @classmethod
    def from_gmsh(cls, path: str | os.PathLike[str] | GmshScript) -> SectionMesh:
        """Surface cells of a gmsh file in a plane x₃ = const., with (y, z) = (x₁, x₂).

        Args:
            path: ``.msh`` file, used as it is, or a script
                (:func:`~fem_lie.mesh.run_gmsh_script`), meshed with the sizes it has. Named groups
                of surfaces are the regions; without any all is one region.

        Raises:
            FileNotFoundError: There is no such file.
            ValueError: It is neither a mesh nor CAD, gmsh cannot read it, cells are not
                triangles or quadrilaterals of degree 1 or 2, they do not lie in such a plane or are
                not connected.
        """
        from fem_lie.sections.gmsh_outlines import read_surface

        raw = read_surface(path)
        return cls(raw.points, raw.cells, raw.regions, raw.names, raw.cell, raw.degree)

    @classmethod
    def from_dolfinx(
        cls,
        mesh: dolfinx.mesh.Mesh,
        cell_tags: dolfinx.mesh.MeshTags | None = None,
        *,
        regions: Mapping[str, int] | None = None,
    ) -> SectionMesh:
        """A DOLFINx mesh of triangles or quadrilaterals, with (y, z) = (x₁, x₂).

        Args:
            mesh: On one process, in a plane x₃ = const.
            cell_tags: Tags of all cells; without them all is one region.
            regions: Name of each tag; default: the tags' numbers are the names.

        Raises:
            ValueError: The mesh has other cells or is spread over processes, a cell has no tag or
                a tag no name or no cell, or anything that the class refuses.
        """
        from fem_lie._compat import cell_name, geometry_dofmap

        if mesh.comm.size > 1:
            raise ValueError(f"the mesh must be on one process, got one on {mesh.comm.size}")
        cells, cell = geometry_dofmap(mesh).astype(np.int64), cell_name(mesh.ufl_domain())
        nodes = cells.shape[1]
        if (cell, nodes) not in _DEGREES:
            raise ValueError(
                "the mesh must consist of triangles of degree 1 or 2, or quadrilaterals of degree "
                f"1, got {cell} cells with {nodes} nodes"
            )
        points = mesh.geometry.x
        if np.ptp(points[:, 2]) > 1e-9 * np.ptp(points, axis=0).max():
            raise ValueError("the mesh must lie in a plane of constant third coordinate")
        region, names = _tagged(len(cells), cell_tags, regions)
        return cls(np.array(points[:, :2]), cells, region, names, cell, _DEGREES[cell, nodes])

    def outline(self) -> Array:
        """Corners of the outer boundary, counter-clockwise, shape (k, 2); arcs as polygons."""
        ends, middles = self._edges()
        pairs = np.sort(ends, axis=1)
        _, first, count = np.unique(pairs, axis=0, return_index=True, return_counts=True)
        following = defaultdict(list)  # two where two loops meet in a point
        for edge in first[count == 1]:
            following[int(ends[edge, 0])].append(edge)
        loops = []
        for start in list(following):
            while following[start]:
                loop = [following[start].pop()]
                while ends[loop[-1], 1] != start:
                    loop.append(following[int(ends[loop[-1], 1])].pop())
                corners = np.stack([self.points[ends[loop, 0]], middles[loop]], axis=1)
                loops.append(corners.reshape(-1, 2))
        outer = max(loops, key=lambda points: np.prod(np.ptp(points, axis=0)))
        return _simplified(outer)

    def borders(self) -> Array:
        """Starts, middles and ends of edges outside and between regions, shape (e, 3, 2)."""
        ends, middles = self._edges()
        region = np.tile(self.regions, len(_EDGES[self.cell]))
        _, first, number, count = np.unique(
            np.sort(ends, axis=1),
            axis=0,
            return_index=True,
            return_inverse=True,
            return_counts=True,
        )
        other = region != region[first][number.ravel()]
        between = np.union1d(first[count == 1], np.flatnonzero(other))
        start, end = self.points[ends[between]].transpose(1, 0, 2)
        return np.stack([start, middles[between], end], axis=1)

    def _edges(self) -> tuple[Indices, Array]:
        """Ends of the cells' edges, counter-clockwise, shape (e, 2), and their middles, (e, 2)."""
        local = np.array(_EDGES[self.cell])
        ends = self.cells[:, local]
        side = np.diff(self.points[ends[:, :2]], axis=2)[:, :, 0]
        turn = side[:, 0, 0] * side[:, 1, 1] - side[:, 0, 1] * side[:, 1, 0]
        ends = np.where(turn[:, np.newaxis, np.newaxis] > 0, ends, ends[:, :, ::-1])
        if self.degree == 2:
            middles = self.points[self.cells[:, 3:]]
        else:
            middles = self.points[ends].mean(axis=2)
        # all first edges, then all second ones, and so on
        return (
            np.ascontiguousarray(ends.transpose(1, 0, 2)).reshape(-1, 2),
            np.ascontiguousarray(middles.transpose(1, 0, 2)).reshape(-1, 2),
        )


def _tagged(
    cells: int, tags: dolfinx.mesh.MeshTags | None, names: Mapping[str, int] | None
) -> tuple[Indices, tuple[str, ...]]:
    """Region of each cell, and the names of the regions."""
    if tags is None:
        if names:
            raise ValueError(f"regions {sorted(names)} need cell_tags, got none")
        return np.zeros(cells, dtype=np.int64), ("section",)
    exist = np.unique(tags.values)
    named_tags = {str(tag): int(tag) for tag in exist} if names is None else names
    if sorted(named_tags.values()) != exist.tolist():
        raise ValueError(
            f"regions must name each of the tags {exist.tolist()} once, got {dict(named_tags)}"
        )
    if not np.array_equal(np.sort(tags.indices), np.arange(cells)):
        raise ValueError(f"cell_tags must tag each of the {cells} cells, got {len(tags.indices)}")
    numbers = {tag: i for i, tag in enumerate(named_tags.values())}
    regions = np.empty(cells, dtype=np.int64)
    regions[tags.indices] = [numbers[int(tag)] for tag in tags.values]
    return regions, tuple(named_tags)


def _simplified(points: Array) -> Array:
    """Outline without points at which its direction has changed little since the last one kept."""
    edges = np.roll(points, -1, axis=0) - points
    before = np.roll(edges, 1, axis=0)
    cross = before[:, 0] * edges[:, 1] - before[:, 1] * edges[:, 0]
    turn = np.arctan2(cross, (before * edges).sum(axis=1))
    kept: list[int] = []
    since = 0.0
    for i in np.roll(np.arange(len(points)), -int(np.abs(turn).argmax())):
        since += turn[i]
        if not kept or abs(since) >= _KEPT_TURN:
            kept.append(int(i))
            since = 0.0
    return points[kept]
