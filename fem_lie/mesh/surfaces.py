"""Surface meshes in space, and those of functions of two parameters.

A mesh comes from a function (:func:`parametric_surface`), from gmsh or DOLFINx
(:mod:`fem_lie.mesh.reading`), or from arrays (:meth:`SurfaceMesh.from_cells`).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from math import degrees, pi, radians
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import (
    Array,
    Indices,
    Where,
    entities_where,
    find_name,
    indices_of,
    instance,
    members_of,
    members_within,
    numbers,
    points_of,
    text,
    whole_number,
)
from fem_lie._summary import Summarised
from fem_lie.mesh.parameter_grids import PARAMETERS, ParameterGrid
from fem_lie.mesh.patches import CellsOfOneType, Edges, Patches, smooth_patches
from fem_lie.mesh.shapes import DEGREES, cell_normals

if TYPE_CHECKING:
    import dolfinx
    from typing_extensions import Self

# A circle of ten cells is still smooth, a corner of 45 degrees is not.
KINK_ANGLE = radians(40.0)

_FAR_OFF = 0.5  # cosine of 60°: a smooth surface turns by less than twice that in one cell
_ROUND = {"triangle": (0, 1, 2), "quadrilateral": (0, 1, 3, 2)}  # corners, one after the other


class Surface(Summarised, ABC):
    """Surfaces divided into cells, with names: of one type or of several.

    Attributes:
        points: Coordinates, shape (n, 3); every point belongs to a cell.
        groups: Cells of each named group.
        curves: Edges of each named curve, two ends and the node between, if any, shape (e, 2 or 3).
        named_points: Points of each name.
    """

    points: Array
    groups: Mapping[str, Indices]
    curves: Mapping[str, Indices]
    named_points: Mapping[str, Indices]

    @property
    @abstractmethod
    def blocks(self) -> tuple[CellsOfOneType, ...]:
        """Cells of each type, numbered block after block."""

    @property
    @abstractmethod
    def degree(self) -> int:
        """Degree of the cells' edges."""

    @property
    def edges(self) -> Edges:
        """Sides of all cells, and edges where they meet."""
        return Edges(self.points, self.blocks)

    @property
    def centres(self) -> Array:
        """Mean of the corners of each cell, shape (m, 3)."""
        corners = [block.cells[:, _ROUND[block.cell]] for block in self.blocks]
        return np.concatenate([self.points[each].mean(axis=1) for each in corners])

    def group(self, name: str) -> Indices:
        """Cells of a group.

        Args:
            name: Name of the group.

        Raises:
            ValueError: There is no such group; the message lists those that exist.
        """
        return find_name(self.groups, name, "group of cells")

    def curve(self, name: str) -> Indices:
        """Edges of a curve.

        Args:
            name: Name of the curve.

        Raises:
            ValueError: There is no such curve; the message lists those that exist.
        """
        return find_name(self.curves, name, "curve")

    def nodes(self, name: str) -> Indices:
        """Nodes of a named point, curve or group of cells.

        Args:
            name: Name of a point, curve or group of cells.

        Raises:
            ValueError: There is nothing of this name; the message lists what exists.
        """
        text(name, "the name of points, a curve or a group")
        if name in self.named_points:
            return self.named_points[name]
        if name in self.curves:
            return np.unique(self.curves[name])
        if name in self.groups:
            cells, found, before = self.groups[name], [], 0
            for block in self.blocks:
                own = cells[(cells >= before) & (cells < before + len(block.cells))] - before
                found.append(block.cells[own].ravel())
                before += len(block.cells)
            return np.unique(np.concatenate(found))
        known = ", ".join(sorted({*self.named_points, *self.curves, *self.groups})) or "none"
        raise ValueError(f"the mesh has no points, curve or group {name!r}; it has: {known}")

    def named(
        self,
        *,
        curves: Mapping[str, Where] | None = None,
        points: Mapping[str, Where] | None = None,
    ) -> Self:
        """Mesh with further names, given by place, as for CAD without names.

        Args:
            curves: For each name, where both ends of its edges are: a function of positions, shape
                (3, n), that returns n truth values. Only edges of one cell, on the rim, are meant.
            points: Likewise for points.

        Raises:
            ValueError: Nothing is there, or a function returns anything else.

        Example:
            >>> mesh = fl.mesh.parametric_surface(lambda a, b: (a, b, 0.0), (2, 3))
            >>> mesh = mesh.named(curves={"left": lambda x: x[0] < 1e-9})
            >>> len(mesh.curve("left"))
            3
        """
        x, edges = self.points, self.edges
        rim = edges.points[edges.nodes[edges.count[edges.edge] == 1]]
        every = np.arange(len(x))[:, np.newaxis]
        found = {
            name: rim[entities_where(where, x, rim[:, :2], f"curve {name!r}")]
            for name, where in (curves or {}).items()
        }
        spots = {
            name: entities_where(where, x, every, f"point {name!r}")
            for name, where in (points or {}).items()
        }
        return self._with_names({**self.curves, **found}, {**self.named_points, **spots})

    @abstractmethod
    def _with_names(self, curves: Mapping[str, Indices], points: Mapping[str, Indices]) -> Self:
        """Copy with other names of curves and points."""

    def patches(self, kink_angle: float = KINK_ANGLE) -> Patches:
        """Nodes that belong to one smooth patch each.

        Args:
            kink_angle: Largest angle between neighbouring cells of a smooth surface, rad.

        Raises:
            ValueError: The angle is out of range, the sides of smooth neighbours do not agree, or
                the surface has a sharp tip.
        """
        if not 0.0 <= kink_angle <= pi:
            raise ValueError(f"kink_angle must be between 0 and pi, got {kink_angle!r}")
        return smooth_patches(self.points, self.blocks, kink_angle)

    def _check_neighbours(self) -> None:
        """Raise ``ValueError`` if cells overlap or contradict each other, or curves are wrong."""
        edges = self.edges
        edges.refuse_overlaps()
        edges.smooth_pairs(KINK_ANGLE)
        for name, curve in self.curves.items():
            edges.check_curve(name, curve)

    def _part(self, block: CellsOfOneType, numbers: Indices, edges: Edges) -> dict[str, Any]:
        """Data of the mesh of some cells of one type, with all names, see :meth:`restricted`.

        Args:
            block: The cells.
            numbers: Their numbers, ascending, shape (s,).
            edges: Edges of the whole mesh.
        """
        used = np.unique(block.cells)
        return {
            "points": self.points[used],
            "cells": np.searchsorted(used, block.cells),
            "normals": block.normals,
            "groups": members_within(self.groups, numbers),
            "named_points": members_within(self.named_points, used),
            "curves": {
                name: np.searchsorted(used, curve[np.isin(edges.first_cell(curve), numbers)])
                for name, curve in self.curves.items()
            },
            "source": None,
        }


@dataclass(frozen=True, eq=False, repr=False)
class SurfaceMesh(Surface):
    """Surfaces divided into triangles or quadrilaterals, of first or second order.

    Attributes:
        points: Coordinates, shape (n, 3); every point belongs to a cell.
        cells: Points of each cell in DOLFINx's order, shape (m, k).
        cell: ``"triangle"`` or ``"quadrilateral"``.
        normals: Unit normals at the nodes of each cell, shape (m, k, 3).
        groups: Cells of each named group.
        curves: Edges of each named curve, two ends and the node between, if any, shape (e, 2 or 3).
        named_points: Points of each name.
        source: DOLFINx mesh with these points and cells, if any.

    Raises:
        ValueError: A value is not finite, has the wrong shape or is out of range; a cell has no
            area, folds over (corners in cyclic order instead of row by row, a re-entrant corner),
            overlaps its neighbour or occurs twice; a normal is far from that of its cell, or those
            of smooth neighbours point to opposite sides; an edge of a curve is not an edge of a
            cell.
    """

    points: Array
    cells: Indices
    cell: str
    normals: Array
    groups: Mapping[str, Indices] = field(default_factory=dict)
    curves: Mapping[str, Indices] = field(default_factory=dict)
    named_points: Mapping[str, Indices] = field(default_factory=dict)
    source: dolfinx.mesh.Mesh | None = None

    def __post_init__(self) -> None:
        points = points_of(self.points)
        cells = _surface_cells(self.cells, self.cell, len(points))
        refuse_alone(points, [cells])
        normals = numbers(self.normals, "normals")
        if normals.shape != (*cells.shape, 3):
            raise ValueError(f"normals must have shape {(*cells.shape, 3)}, got {normals.shape}")
        # also refuses nan
        if not (np.abs(np.linalg.norm(normals, axis=-1) - 1.0) < 1e-6).all():
            raise ValueError("normals must be unit vectors")
        _check_normals(normals, cell_normals(points, cells, self.cell), points, cells)
        curves = {
            name: indices_of(edges, len(points), f"points of curve {name!r}")
            for name, edges in self.curves.items()
        }
        for name, value in (
            ("points", points),
            ("cells", cells),
            ("normals", normals),
            ("groups", members_of(self.groups, len(cells), "cells")),
            ("curves", curves),
            ("named_points", members_of(self.named_points, len(points), "points")),
        ):
            object.__setattr__(self, name, value)
        self._check_neighbours()

    @classmethod
    def from_cells(
        cls,
        points: npt.ArrayLike,
        cells: npt.ArrayLike,
        cell: str,
        *,
        normals: npt.ArrayLike | None = None,
        groups: Mapping[str, npt.ArrayLike] | None = None,
        curves: Mapping[str, npt.ArrayLike] | None = None,
        named_points: Mapping[str, npt.ArrayLike] | None = None,
        source: dolfinx.mesh.Mesh | None = None,
    ) -> SurfaceMesh:
        """Mesh from arrays.

        Args:
            points: Coordinates, shape (n, 3).
            cells: Points of each cell in DOLFINx's order, shape (m, k).
            cell: ``"triangle"`` or ``"quadrilateral"``.
            normals: Known normals, as in the class, nan elsewhere: those are computed from the
                cell.
            groups: Cells of each named group.
            curves: Edges of each named curve.
            named_points: Points of each name.
            source: DOLFINx mesh with these points and cells.

        Raises:
            ValueError: See the class.
        """
        x = points_of(points)
        block = block_of(x, cells, cell, normals)
        return cls(
            x,
            block.cells,
            cell,
            block.normals,
            members_of(groups or {}, len(block.cells), "cells"),
            {
                name: indices_of(edges, len(x), f"points of curve {name!r}")
                for name, edges in (curves or {}).items()
            },
            members_of(named_points or {}, len(x), "points"),
            source,
        )

    @property
    def blocks(self) -> tuple[CellsOfOneType, ...]:
        """All cells."""
        return (CellsOfOneType(self.cells, self.cell, self.normals),)

    @property
    def degree(self) -> int:
        """Degree of the cells' edges."""
        return DEGREES[self.cell][self.cells.shape[1]]

    @property
    def corners(self) -> Indices:
        """Corners of each cell in cyclic order, shape (m, 3 or 4)."""
        return self.corners_of(self.cells)

    def corners_of(self, cells: Indices) -> Indices:
        """Corners in cyclic order of cells with other node numbers, shape (m, 3 or 4).

        Args:
            cells: Nodes of the cells, shape (m, k).
        """
        return cells[:, _ROUND[self.cell]]

    def restricted(self, cells: Indices) -> SurfaceMesh:
        """Mesh of some cells with all names, also of what is not within them.

        An edge of a curve between two cells goes with the cell of the lower number.

        Args:
            cells: Indices of the cells, ascending, shape (s,).
        """
        block = CellsOfOneType(self.cells[cells], self.cell, self.normals[cells])
        return self._with(self._part(block, cells, self.edges))

    def _with_names(self, curves: Mapping[str, Indices], points: Mapping[str, Indices]) -> Self:
        return replace(self, curves=curves, named_points=points)

    def _with(self, data: Mapping[str, Any]) -> SurfaceMesh:
        """Copy with other data that are known to be valid."""
        part = copy(self)
        for name, value in data.items():
            object.__setattr__(part, name, value)
        return part

    def directors(self, kink_angle: float = KINK_ANGLE) -> Array:
        """Mean of the cells' normals at each point of a smooth surface, shape (n, 3).

        Args:
            kink_angle: Angle between normals, rad, above which the surface has a kink.

        Raises:
            ValueError: See :meth:`patches`; the surface has a kink or a branch.
        """
        patches = self.patches(kink_angle)
        if len(patches.split):
            position = self.points[patches.split[0]]
            raise ValueError(
                f"the surface has a kink of more than {degrees(kink_angle):.0f}°, or a branch, at "
                f"{position}: its sides have directors of their own there"
            )
        return patches.directors

    def _check_neighbours(self) -> None:
        _, count = np.unique(np.sort(self.corners, axis=1), axis=0, return_counts=True)
        if count.max() > 1:
            raise ValueError(f"{count.max()} cells have the same corners")
        super()._check_neighbours()


def _check_normals(given: Array, own: Array, points: Array, cells: Indices) -> None:
    """Raise ``ValueError`` for normals that are inconsistent with the cells."""
    cosine = np.einsum("mkj,mkj->mk", given, own)
    if cosine.min() < _FAR_OFF:
        m, k = np.unravel_index(int(cosine.argmin()), cosine.shape)
        raise ValueError(
            f"the normal of cell {m} at {points[cells[m, k]]} is {given[m, k]}, "
            f"{degrees(np.arccos(np.clip(cosine.min(), -1.0, 1.0))):.0f}° off that of its points, "
            f"{own[m, k]}"
        )


def block_of(
    points: Array, cells: npt.ArrayLike, cell: str, normals: npt.ArrayLike | None
) -> CellsOfOneType:
    """Cells of one type, with normals that are known or computed from the cell.

    Args:
        points: Coordinates, shape (n, 3).
        cells: Points of each cell in DOLFINx's order, shape (m, k).
        cell: ``"triangle"`` or ``"quadrilateral"``.
        normals: Known normals, shape (m, k, 3), nan elsewhere; default: none.

    Raises:
        ValueError: A value has the wrong shape or is out of range.
    """
    connected = _surface_cells(cells, cell, len(points))
    found = cell_normals(points, connected, cell)
    if normals is not None:
        known = numbers(normals, "normals")
        if known.shape != found.shape:
            raise ValueError(f"normals must have shape {found.shape}, got {known.shape}")
        found = np.where(np.isfinite(known), known, found)
    return CellsOfOneType(connected, cell, found)


def refuse_alone(points: Array, cells: Sequence[Indices]) -> None:
    """Raise ``ValueError`` if a point has no cell.

    Args:
        points: Coordinates, shape (n, 3).
        cells: Points of the cells of each type.
    """
    used = np.concatenate([each.ravel() for each in cells])
    alone = np.setdiff1d(np.arange(len(points)), used)
    if len(alone):
        raise ValueError(f"{len(alone)} points have no cell, the first is {alone[0]}")


def _surface_cells(value: npt.ArrayLike, cell: str, points: int) -> Indices:
    cells = np.asarray(value)
    if cell not in DEGREES:
        raise ValueError(f"cell must be 'triangle' or 'quadrilateral', got {cell!r}")
    known = list(DEGREES[cell])
    if cells.ndim != 2 or cells.shape[1] not in known or not len(cells):
        raise ValueError(f"{cell}s must have {known} points each, got an array {cells.shape}")
    return indices_of(cells, points, "cells")


def parametric_surface(
    function: Callable[[float, float], npt.ArrayLike],
    cells: tuple[int, int],
    *,
    cell: str = "quadrilateral",
    degree: int = 1,
    closed: str = "",
) -> SurfaceMesh:
    """Smooth surface over the unit square ``(a, b)``, divided at equal steps of both parameters.

    Its sides are the curves "a=0", "a=1", "b=0" and "b=1", its corners the points "00", "10", "01"
    and "11". A tube that is closed along a has the curves "b=0" and "b=1" and the points "00" and
    "01". Each square has two triangles. The normals are those of the cells; pass a director to
    :class:`~fem_lie.bodies.shells.shell.Shell` if the exact normals are known.

    Args:
        function: Point at ``(a, b)``, shape (3,).
        cells: Numbers of cells along a and b.
        cell: ``"triangle"`` or ``"quadrilateral"``.
        degree: 1 or 2.
        closed: Parameters whose ends are one line, with three cells or more: ``"a"`` or ``"b"`` of
            a tube, ``"ab"`` of a torus; otherwise ends at the same place are not joined.

    Raises:
        ValueError: A cell has no area, closed ends do not meet, or an argument is out of range.

    Example:
        >>> def around(a, b):
        ...     return np.cos(2 * np.pi * a), np.sin(2 * np.pi * a), 3 * b
        >>> tube = fl.mesh.parametric_surface(around, (24, 8), closed="a")
        >>> sorted(tube.curves)
        ['b=0', 'b=1']
    """
    if cell not in DEGREES or degree not in (1, 2):
        raise ValueError(
            "expected cells 'triangle' or 'quadrilateral' of degree 1 or 2, got "
            f"{cell!r} of degree {degree!r}"
        )
    instance(function, Callable, "a surface", "a function of a and b from 0 to 1")
    if not isinstance(cells, Sequence) or len(cells) != 2:
        raise ValueError(f"cells must be two numbers, along a and b, got {cells!r}")
    grid = ParameterGrid([whole_number(count) for count in cells], degree, closed)
    return SurfaceMesh.from_cells(
        grid.points(function),
        _grid_cells(grid.number, cell, degree),
        cell,
        curves={
            f"{PARAMETERS[k]}={end}": _edges(np.moveaxis(grid.number, k, 0)[-end], degree)
            for k in grid.open
            for end in (0, 1)
        },
        named_points=grid.corners,
    )


def _edges(along: Indices, degree: int) -> Indices:
    """Edges of successive points: two ends, and the node between."""
    parts = [along[:-1:degree], along[degree::degree], *([along[1::2]] if degree == 2 else [])]
    return np.column_stack(parts)


def _grid_cells(number: Indices, cell: str, degree: int) -> Indices:
    """Cells on a grid of points, in DOLFINx's order."""
    found = []
    for i in range(0, number.shape[0] - 1, degree):
        for j in range(0, number.shape[1] - 1, degree):
            s = number[i : i + degree + 1, j : j + degree + 1]
            corners = np.array([s[0, 0], s[-1, 0], s[0, -1], s[-1, -1]])
            if cell == "quadrilateral":
                middles = [s[1, 0], s[0, 1], s[-1, 1], s[1, -1], s[1, 1]] if degree == 2 else []
                found.append([*corners, *middles])
                continue
            lower = [s[-1, 1], s[1, 1], s[1, 0]] if degree == 2 else []
            upper = [s[1, -1], s[0, 1], s[1, 1]] if degree == 2 else []
            found.append([*corners[[0, 1, 3]], *lower])
            found.append([*corners[[0, 3, 2]], *upper])
    return np.array(found, dtype=np.int64)
