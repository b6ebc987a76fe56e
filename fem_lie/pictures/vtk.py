"""Files for ParaView: time series of nodes and cells, and surfaces and volumes of one state."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices
from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.mesh.surfaces import SurfaceMesh
from fem_lie.pictures.grid_files import (
    Grid,
    state_names,
    write_collection,
    write_grid,
    write_states,
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
    frames: Callable[[int], Array],
    fields: Callable[[int], Mapping[str, Array]],
    in_cells: Mapping[str, Array],
) -> None:
    """Write all states of a scene, see :func:`.write_states`.

    Point data: directors ``e1``, ``e2``, ``e3`` and the fields; cell data: ``body``, the number of
    the body, and the values in cells.

    Args:
        path: Name of the ``.pvd`` file.
        info: The scene.
        times: Times, load factors or numbers of modes, shape (k,).
        frames: Frames of all nodes in a state, shape (N, 4, 3).
        fields: Vectors of all nodes in a state, global components, each of shape (N, 3).
        in_cells: Values of all cells in all states, see :func:`forces_in_cells`.

    Raises:
        ValueError: The name does not end in ``.pvd``.
    """
    import pyvista

    lines, vertices, faces, bodies = _cells(info)

    def grid(k: int) -> Grid:
        H = frames(k)
        data = pyvista.PolyData(H[:, 0], faces, lines=lines, verts=vertices)
        for i in (1, 2, 3):
            data.point_data[f"e{i}"] = H[:, i]
        for what, values in fields(k).items():
            data.point_data[what] = values
        data.cell_data["body"] = bodies
        for what, values in in_cells.items():
            data.cell_data[what] = values[k]
        return data.cast_to_unstructured_grid()  # which meshio reads, too

    write_states(Path(path), times, grid)


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
    owners = _cells(info)[3]
    singles = sum(len(b.nodes) for b in info.bodies if not len(b.cells) and not len(b.faces))
    starts = singles + np.cumsum([0] + [len(body.cells) for body in info.bodies])
    values = np.full((len(times), len(owners), 6), np.nan)
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
) -> None:
    """Write a series of lines with values at their ends and in their middles.

    Args:
        path: Name of the ``.pvd`` file.
        times: Times or load factors, shape (T,).
        positions: Positions of the ends of each line, shape (T, m, 2, 3).
        at_ends: Scalars or vectors at the ends, shape (T, m, 2) or (T, m, 2, 3).
        in_middle: Scalars in the middle, shape (T, m).

    Raises:
        ValueError: The name does not end in ``.pvd``.
    """
    import pyvista

    count = 2 * positions.shape[1]
    lines = np.insert(np.arange(count).reshape(-1, 2), 0, 2, axis=1)

    def grid(k: int) -> Grid:
        data = pyvista.PolyData(positions[k].reshape(-1, 3), lines=lines.ravel())
        for what, values in at_ends.items():
            data.point_data[what] = values[k].reshape(count, *values.shape[3:])
        for what, values in in_middle.items():
            data.cell_data[what] = values[k]
        return data.cast_to_unstructured_grid()

    write_states(Path(path), times, grid)


def _cells(info: SceneInfo) -> tuple[Indices | None, Indices | None, Indices | None, Indices]:
    """Lines, single nodes and faces in VTK's notation, and the body of each in VTK's order."""
    lines = [np.insert(body.cells, 0, 2, axis=1) for body in info.bodies if len(body.cells)]
    single = [
        np.column_stack([np.ones_like(body.nodes), body.nodes])
        for body in info.bodies
        if not len(body.cells) and not len(body.faces)
    ]
    faces = [_polygons(body.faces) for body in info.bodies if len(body.faces)]
    # VTK has vertices first, then lines, then faces
    owners = [
        np.full(len(b.nodes), i)
        for i, b in enumerate(info.bodies)
        if not len(b.cells) and not len(b.faces)
    ]
    owners += [np.full(len(b.cells), i) for i, b in enumerate(info.bodies)]
    owners += [np.full(len(b.faces), i) for i, b in enumerate(info.bodies)]
    return _joined(lines), _joined(single), _joined(faces), np.concatenate(owners)


def _polygons(faces: Indices) -> Indices:
    """Faces in VTK's notation, flat; quadrilaterals with one corner twice are triangles."""
    three = faces[:, -1] == faces[:, -2]
    rows = np.insert(faces, 0, faces.shape[1] - three, axis=1)
    kept = np.ones(rows.shape, dtype=bool)
    kept[three, -1] = False
    return np.asarray(rows[kept])


def _joined(parts: list[Indices]) -> Indices | None:
    return np.concatenate([part.ravel() for part in parts]) if parts else None
