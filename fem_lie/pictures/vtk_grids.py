"""Files for ParaView of one state: surfaces and volumes with values at points and in cells."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.mesh.surfaces import SurfaceMesh

if TYPE_CHECKING:
    from dolfinx import fem

# type of cell, and its nodes in VTK's order
_VTK_CELLS = {
    ("triangle", 1): (5, (0, 1, 2)),
    ("quadrilateral", 1): (9, (0, 1, 3, 2)),
    ("triangle", 2): (22, (0, 1, 2, 5, 3, 4)),
    ("quadrilateral", 2): (28, (0, 1, 3, 2, 4, 6, 7, 5, 8)),
}


class CellKind(Protocol):
    """What cells of a surface are, as a :class:`~fem_lie.SurfaceMesh` says."""

    @property
    def cell(self) -> str:
        """``triangle`` or ``quadrilateral``."""

    @property
    def degree(self) -> int:
        """Of their edges, 1 or 2."""


def write_surface(
    path: str | os.PathLike[str],
    points: Array,
    cells: Indices,
    mesh: SurfaceMesh,
    point_data: Mapping[str, Array],
    cell_data: Mapping[str, Array],
) -> None:
    """Write one state of a surface as a ``.vtu`` file.

    Args:
        path: Name of the file.
        points: Places, shape (p, 3).
        cells: Points of each cell in DOLFINx's order, shape (m, k).
        mesh: What the cells are.
        point_data: Values at the points.
        cell_data: Values in the cells.

    Raises:
        ValueError: The name does not end in ``.vtu``.
    """
    if Path(path).suffix != ".vtu":
        raise ValueError(f"the name of the file must end in '.vtu', got {str(path)!r}")
    grid = surface_grid(points, cells, mesh)
    for name, values in point_data.items():
        grid.point_data[name] = values
    for name, values in cell_data.items():
        grid.cell_data[name] = values
    grid.save(path)


def write_volume(
    path: str | os.PathLike[str],
    space: fem.FunctionSpace,
    points: Array,
    point_data: Mapping[str, Array],
) -> None:
    """Write one state of a volume as a ``.vtu`` file.

    Args:
        path: Name of the file.
        space: Lagrange's, of numbers, whose nodes are the points.
        points: Places, shape (p, 3).
        point_data: Values at the points.

    Raises:
        ValueError: The name does not end in ``.vtu``.
    """
    import dolfinx.plot
    import pyvista

    if Path(path).suffix != ".vtu":
        raise ValueError(f"the name of the file must end in '.vtu', got {str(path)!r}")
    cells, kinds, _ = dolfinx.plot.vtk_mesh(space)
    grid = pyvista.UnstructuredGrid(cells, kinds, points)
    for name, values in point_data.items():
        grid.point_data[name] = values
    grid.save(Path(path))


def surface_grid(points: Array, cells: Indices, mesh: CellKind) -> Any:
    """A surface as pyvista's grid; arguments as in :func:`write_surface`."""
    import pyvista

    kind, order = _VTK_CELLS[mesh.cell, mesh.degree]
    polygons = np.insert(cells[:, order], 0, cells.shape[1], axis=1)
    return pyvista.UnstructuredGrid(polygons.ravel(), np.full(len(cells), kind), points)
