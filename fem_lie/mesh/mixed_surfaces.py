"""Surfaces of triangles and quadrilaterals that share points."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices, indices_of, instance, members_of, points_of
from fem_lie.mesh.patches import CellsOfOneType
from fem_lie.mesh.shapes import DEGREES
from fem_lie.mesh.surfaces import Surface, SurfaceMesh, block_of, refuse_alone

if TYPE_CHECKING:
    from typing_extensions import Self


class SurfacePart(NamedTuple):
    """Cells of one type of a surface.

    Attributes:
        mesh: Mesh of these cells, with all names, also of what is not within them.
        points: Number of each of its points in the whole mesh, shape (n,).
        cells: Number of each of its cells in the whole mesh, shape (m,).
    """

    mesh: SurfaceMesh
    points: Indices
    cells: Indices


@dataclass(frozen=True, eq=False, repr=False)
class MixedSurfaceMesh(Surface):
    """Surfaces divided into triangles and quadrilaterals of one order, as gmsh makes them.

    Cells that meet share points. Cells are numbered one type after the other.

    Attributes:
        points: Coordinates, shape (n, 3); every point belongs to a cell.
        parts: Cells of each type.
        groups: Cells of each named group.
        curves: Edges of each named curve, two ends and the node between, if any, shape (e, 2 or 3).
        named_points: Points of each name.

    Raises:
        ValueError: See :class:`~fem_lie.mesh.SurfaceMesh`.

    Example:
        >>> points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0), (2, 0, 0)]
        >>> mesh = fl.mesh.MixedSurfaceMesh.from_cells(points,
        ...     {"triangle": [(1, 4, 3)], "quadrilateral": [(0, 1, 2, 3)]})
        >>> plate = fl.Shell(mesh, fl.ShellSection.layer(0.01, fl.Material(2e11, 0.3, 7e3)))
        >>> [part.shell.model.mesh.cell for part in plate.parts]
        ['triangle', 'quadrilateral']
    """

    points: Array
    parts: tuple[SurfacePart, ...]
    groups: Mapping[str, Indices] = field(default_factory=dict)
    curves: Mapping[str, Indices] = field(default_factory=dict)
    named_points: Mapping[str, Indices] = field(default_factory=dict)

    @classmethod
    def from_cells(
        cls,
        points: npt.ArrayLike,
        cells: Mapping[str, npt.ArrayLike],
        *,
        normals: Mapping[str, npt.ArrayLike] | None = None,
        groups: Mapping[str, npt.ArrayLike] | None = None,
        curves: Mapping[str, npt.ArrayLike] | None = None,
        named_points: Mapping[str, npt.ArrayLike] | None = None,
    ) -> MixedSurfaceMesh:
        """Mesh from arrays.

        Args:
            points: Coordinates, shape (n, 3).
            cells: Points of the cells of each type in DOLFINx's order, shape (m, k), by its name:
                ``"triangle"`` and ``"quadrilateral"``.
            normals: Unit normals at the nodes of these cells, shape (m, k, 3), nan where they
                follow from the cell; default: all do.
            groups: Cells of each named group, numbered one type after the other.
            curves: Edges of each named curve.
            named_points: Points of each name.

        Raises:
            ValueError: See the class.
        """
        x = points_of(points)
        instance(cells, Mapping, "MixedSurfaceMesh: cells", "cells by the name of their type")
        blocks = [
            block_of(x, of, cell, None if normals is None else normals[cell])
            for cell, of in cells.items()
        ]
        refuse_alone(x, [block.cells for block in blocks])
        degrees = {DEGREES[block.cell][block.cells.shape[1]] for block in blocks}
        if len(degrees) > 1:
            raise ValueError("expected cells of one order, got those of order 1 and 2")
        found = cls(
            x,
            tuple(_parts(x, blocks)),
            members_of(groups or {}, sum(len(block.cells) for block in blocks), "cells"),
            {
                name: indices_of(edges, len(x), f"points of curve {name!r}")
                for name, edges in (curves or {}).items()
            },
            members_of(named_points or {}, len(x), "points"),
        )
        found._check_neighbours()
        return found._pass_names_to_parts()

    def _with_names(self, curves: Mapping[str, Indices], points: Mapping[str, Indices]) -> Self:
        return replace(self, curves=curves, named_points=points)._pass_names_to_parts()

    def _pass_names_to_parts(self) -> Self:
        """The mesh itself, whose parts have its names from now on."""
        edges = self.edges
        named = [
            part._replace(mesh=part.mesh._with(self._part(block, part.cells, edges)))
            for part, block in zip(self.parts, self.blocks, strict=True)
        ]
        object.__setattr__(self, "parts", tuple(named))
        return self

    @property
    def blocks(self) -> tuple[CellsOfOneType, ...]:
        """Cells of each type, by points of the whole mesh."""
        return tuple(
            CellsOfOneType(part.points[part.mesh.cells], part.mesh.cell, part.mesh.normals)
            for part in self.parts
        )

    @property
    def degree(self) -> int:
        """Degree of the cells' edges."""
        return self.parts[0].mesh.degree

    @property
    def cell(self) -> str:
        """Cells have several types: an error for what needs cells of one type.

        Raises:
            ValueError: Always; it says how many cells of which type the mesh has.
        """
        raise ValueError(
            "expected cells of one type, got a surface with "
            + " and ".join(f"{len(part.cells)} {part.mesh.cell}s" for part in self.parts)
        )


def _parts(points: Array, blocks: list[CellsOfOneType]) -> Iterator[SurfacePart]:
    """Meshes of the cells of each type, without names."""
    before = 0
    for cells, cell, normals in blocks:
        used = np.unique(cells)
        mesh = SurfaceMesh(points[used], np.searchsorted(used, cells), cell, normals)
        yield SurfacePart(mesh, used, before + np.arange(len(cells)))
        before += len(cells)
