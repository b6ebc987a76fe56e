"""Files for ParaView: time series of nodes and cells, and surfaces and volumes of one state."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices
from fem_lie.bodies.catalogue import BodyInfo, Owners, SceneInfo
from fem_lie.mesh.surfaces import SurfaceMesh
from fem_lie.pictures.grid_files import (
    Grid,
    own_cells,
    state_names,
    write_collection,
    write_grid,
    write_states,
    writers,
)
from fem_lie.ranks.files import write_once

if TYPE_CHECKING:
    from dolfinx import fem

    from fem_lie.bodies.beams.beam import Beam

# type of cell, and its nodes in VTK's order
_VTK_CELLS = {
    ("triangle", 1): (5, (0, 1, 2)),
    ("quadrilateral", 1): (9, (0, 1, 3, 2)),
    ("triangle", 2): (22, (0, 1, 2, 5, 3, 4)),
    ("quadrilateral", 2): (28, (0, 1, 3, 2, 4, 6, 7, 5, 8)),
}


class CellKind(Protocol):
    """Cell shape and degree of a surface, as of a :class:`~fem_lie.mesh.SurfaceMesh`."""

    @property
    def cell(self) -> str:
        """``triangle`` or ``quadrilateral``."""

    @property
    def degree(self) -> int:
        """Polynomial degree of the cells, 1 or 2."""


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
        points: Positions, shape (p, 3).
        cells: Points of each cell in DOLFINx's order, shape (m, k).
        mesh: Shape and degree of the cells.
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
    write_once(path, partial(write_grid, Path(path), grid))


def write_volume(
    path: str | os.PathLike[str],
    space: fem.FunctionSpace,
    points: Array,
    point_data: Mapping[str, Array],
) -> None:
    """Write one state of a volume as a ``.vtu`` file.

    Args:
        path: Name of the file.
        space: Scalar Lagrange space whose nodes are the points.
        points: Positions, shape (p, 3).
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
    write_once(path, partial(write_grid, Path(path), grid))


def surface_grid(points: Array, cells: Indices, mesh: CellKind) -> Any:
    """A surface as a PyVista grid; arguments as for :func:`write_surface`."""
    import pyvista

    kind, order = _VTK_CELLS[mesh.cell, mesh.degree]
    polygons = np.insert(cells[:, order], 0, cells.shape[1], axis=1)
    return pyvista.UnstructuredGrid(polygons.ravel(), np.full(len(cells), kind), points)


class ForcesInBeam(Protocol):
    """Section forces in the middle of each element, see :func:`fem_lie.post.section_forces`."""

    @property
    def beam(self) -> Beam:
        """The beam, with m elements."""

    @property
    def times(self) -> Array:
        """Times, shape (T,)."""

    @property
    def components(self) -> tuple[str, ...]:
        """Names of the six components."""

    @property
    def middle(self) -> Array:
        """Section forces, shape (T, m, 6)."""


class Writable(Protocol):
    """Results that can write a file, see :func:`fem_lie.post.resultants`."""

    def write_vtk(self, path: str | os.PathLike[str]) -> None:
        """Write a ``.vtu`` file."""


def write_series(
    path: str | os.PathLike[str],
    info: SceneInfo,
    times: Array,
    frames: Callable[[int, Indices], Array],
    fields: Callable[[int, Indices], Mapping[str, Array]],
    in_cells: Mapping[str, Array],
) -> None:
    """Write all states of a scene, see :func:`.write_states`.

    Point data: directors ``e1``, ``e2``, ``e3`` and the fields; cell data: ``body``, the number of
    the body, the values in cells, and ``rank``, that which had the cell in a divided scene. Each
    of several ranks needs the nodes of its own cells only.

    Args:
        path: Name of the ``.pvd`` file.
        info: The scene.
        times: Times, load factors or numbers of modes, shape (k,).
        frames: Frames of n nodes in a state, shape (n, 4, 3).
        fields: Vectors of n nodes in a state, global components, each of shape (n, 3).
        in_cells: Values of all cells in all states, see :func:`forces_in_cells`.

    Raises:
        ValueError: The name does not end in ``.pvd``.
    """
    import pyvista

    cells = SceneCells.of(info)
    ranks = writers(len(cells.nodes), cells.owners)
    own = own_cells(ranks)
    nodes, connectivity, kinds = cells.some(own)

    def grid(k: int) -> Grid:
        H = frames(k, nodes)
        data = pyvista.UnstructuredGrid(connectivity, kinds, H[:, 0])
        for i in (1, 2, 3):
            data.point_data[f"e{i}"] = H[:, i]
        for what, values in fields(k, nodes).items():
            data.point_data[what] = values
        data.cell_data["body"] = cells.bodies[own]
        for what, values in in_cells.items():
            data.cell_data[what] = values[k, own]
        _add_owners(data, cells.owners, own)
        return data

    write_states(Path(path), times, grid, ranks)


def _add_owners(grid: Grid, owners: Owners | None, own: Indices) -> None:
    """Add cell data ``rank``, if the scene was divided."""
    if owners is not None:
        grid.cell_data["rank"] = owners.ranks[own]


def write_resultants(
    path: str | os.PathLike[str], series: Sequence[Writable], times: npt.ArrayLike
) -> None:
    """Write a ``.pvd`` file, and a folder of the same name with a ``.vtu`` file for each state.

    Args:
        path: Name of the ``.pvd`` file.
        series: From :func:`fem_lie.results.stresses.shell_resultants.resultant_series`.
        times: Time or load factor of each state.

    Raises:
        ValueError: The name does not end in ``.pvd``, or there are more or fewer times.
    """
    values = np.atleast_1d(np.asarray(times, dtype=np.float64))
    if values.shape != (len(series),):
        raise ValueError(f"expected one time for each of {len(series)} states, got {values.shape}")
    target = Path(path)
    names = state_names(target, len(series), ".vtu")
    for name, resultants in zip(names, series, strict=True):
        resultants.write_vtk(target.parent / name)
    write_collection(target, names, values)


def forces_in_cells(
    info: SceneInfo, times: Array, forces: Sequence[ForcesInBeam]
) -> dict[str, Array]:
    """Section forces of all cells in VTK's order, each of shape (T, cells); nan where none are.

    Args:
        info: The scene.
        times: Times or load factors, shape (T,).
        forces: Section forces of beams at all of these.

    Raises:
        ValueError: Section forces are at other times.
    """
    if not forces:
        return {}
    count = len(SceneCells.of(info).nodes)
    singles = sum(len(b.nodes) for b in info.bodies if not len(b.cells) and not len(b.faces))
    starts = singles + np.cumsum([0] + [len(body.cells) for body in info.bodies])
    values = np.full((len(times), count, 6), np.nan)
    for found in forces:
        if not np.array_equal(found.times, times):
            raise ValueError(
                f"expected section forces of {found.beam.label} at all {len(times)} times, got "
                f"{len(found.times)}"
            )
        body = info.body(found.beam.name)
        pieces = len(body.cells) // len(found.beam.model.elements)
        start = starts[info.bodies.index(body)]
        values[:, start : start + len(body.cells)] = np.repeat(found.middle, pieces, axis=1)
    return {name: values[..., i] for i, name in enumerate(found.components)}


def write_elements(
    path: str | os.PathLike[str],
    times: Array,
    positions: Array,
    at_ends: Mapping[str, Array],
    in_middle: Mapping[str, Array],
    owners: Owners | None,
) -> None:
    """Write a series of lines with values at their ends and in their middles.

    Args:
        path: Name of the ``.pvd`` file.
        times: Times or load factors, shape (T,).
        positions: Positions of the ends of each line, shape (T, m, 2, 3).
        at_ends: Scalars or vectors at the ends, shape (T, m, 2) or (T, m, 2, 3).
        in_middle: Scalars in the middle, shape (T, m).
        owners: Ranks that had the lines; ``None`` if the scene was not divided.

    Raises:
        ValueError: The name does not end in ``.pvd``.
    """
    import pyvista

    ranks = writers(positions.shape[1], owners)
    own = own_cells(ranks)
    count = 2 * len(own)
    lines = np.insert(np.arange(count).reshape(-1, 2), 0, 2, axis=1)
    kinds = np.full(len(own), _KINDS[2])

    def grid(k: int) -> Grid:
        data = pyvista.UnstructuredGrid(lines.ravel(), kinds, positions[k, own].reshape(-1, 3))
        for what, values in at_ends.items():
            data.point_data[what] = values[k, own].reshape(count, *values.shape[3:])
        for what, values in in_middle.items():
            data.cell_data[what] = values[k, own]
        _add_owners(data, owners, own)
        return data

    write_states(Path(path), times, grid, ranks)


_KINDS = np.array([0, 1, 3, 5, 9])
"""VTK's type of a cell of so many nodes: a vertex, a line, a triangle, a quadrilateral."""


class SceneCells(NamedTuple):
    """Cells of a scene that are drawn: single nodes of bodies without any, lines, then faces.

    Attributes:
        nodes: Nodes of each cell, shape (c, 4); -1 where it has fewer.
        bodies: Number of the body of each cell, shape (c,).
        owners: Ranks that had the cells; ``None`` if the scene was not divided.
        total: Number of nodes of the scene.
    """

    nodes: Indices
    bodies: Indices
    owners: Owners | None
    total: int

    @classmethod
    def of(cls, info: SceneInfo) -> SceneCells:
        """All cells of a scene."""
        groups = [
            [(body, _single(body), 0) for body in info.bodies],
            [(body, body.cells, 0) for body in info.bodies],
            [(body, _polygons(body.faces), len(body.cells)) for body in info.bodies],
        ]
        nodes, bodies, ranks = [], [], []
        for group in groups:
            for number, (body, cells, first) in enumerate(group):
                nodes.append(np.pad(cells, ((0, 0), (0, 4 - cells.shape[1])), constant_values=-1))
                bodies.append(np.full(len(cells), number))
                if body.owners is not None:
                    ranks.append(body.owners[first : first + len(cells)])
        owners = None if info.parts is None else Owners(np.concatenate(ranks), info.parts)
        total = sum(len(body.nodes) for body in info.bodies)
        return cls(np.concatenate(nodes), np.concatenate(bodies), owners, total)

    def some(self, own: Indices) -> tuple[Indices, Indices, Indices]:
        """Nodes of some cells (of all cells: all nodes), and the cells in VTK's notation and types.

        Args:
            own: Numbers of the cells, shape (s,).
        """
        cells = self.nodes[own]
        there = cells >= 0
        every = len(own) == len(self.nodes)
        nodes = np.arange(self.total) if every else np.unique(cells[there])
        count = there.sum(axis=1)
        rows = np.column_stack([count, np.searchsorted(nodes, cells)])
        return nodes, rows[np.insert(there, 0, True, axis=1)], _KINDS[count]


def _single(body: BodyInfo) -> Indices:
    """Nodes of a body without lines and faces, as cells of one node."""
    alone = not len(body.cells) and not len(body.faces)
    return body.nodes[: len(body.nodes) if alone else 0, np.newaxis]


def _polygons(faces: Indices) -> Indices:
    """Faces with -1 in place of the last corner of triangles that have it twice."""
    found = faces.copy()
    found[faces[:, -1] == faces[:, -2], -1] = -1
    return found
