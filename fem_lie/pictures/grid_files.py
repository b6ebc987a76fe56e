"""Grids of VTK in XML files; on several ranks a piece of the cells for each rank, and a list."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from html import escape
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from mpi4py import MPI

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices
from fem_lie.bodies.catalogue import Owners
from fem_lie.ranks.files import write_each, write_once
from fem_lie.ranks.together import several

Grid = Any
"""An unstructured grid of PyVista."""

_TYPES = {"f": "Float", "i": "Int", "u": "UInt"}
"""VTK's names of types, by kinds of NumPy's."""


def write_grid(path: Path, grid: Grid) -> None:
    """Write a grid as a ``.vtu`` file.

    Raises:
        OSError: The file cannot be written, for example because the disk is full.
    """
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

    writer = vtkXMLUnstructuredGridWriter()
    writer.SetInputData(grid)
    writer.SetDataModeToBinary()
    writer.WriteToOutputStringOn()  # VTK 9.3 crashes on a full disk, without an error
    writer.Write()
    path.write_text(writer.GetOutputString())


def writers(count: int, owners: Owners | None) -> Indices:
    """Rank that writes each cell, shape (c,).

    It is the rank that had the cell in a scene that was divided among as many ranks; otherwise each
    rank writes an equal number of cells, in their order.

    Args:
        count: Number of cells.
        owners: Ranks that had them; ``None`` if the scene was not divided.
    """
    ranks = int(MPI.COMM_WORLD.size)
    if owners is not None and owners.parts == ranks:
        return owners.ranks
    return np.arange(count) * min(ranks, count) // max(count, 1)


def own_cells(ranks: Indices) -> Indices:
    """Numbers of the cells that this rank writes, ascending.

    Args:
        ranks: Rank that writes each cell, see :func:`writers`.
    """
    return np.flatnonzero(ranks == MPI.COMM_WORLD.rank)


def write_states(path: Path, times: Array, grid: Callable[[int], Grid], ranks: Indices) -> None:
    """Write a ``.pvd`` file, and a folder of the same name with the files of each state.

    A state is a ``.vtu`` file; on several ranks it is a ``.pvtu`` file, with a ``.vtu`` file of
    each rank that writes cells. All ranks call it together.

    Args:
        path: Name of the ``.pvd`` file.
        times: Times, load factors or numbers of modes, shape (k,).
        grid: Grid of a state, with the cells that this rank writes; all have the same cells and
            fields.
        ranks: Rank that writes each cell, see :func:`writers`.

    Raises:
        ValueError: The name does not end in ``.pvd``.
        OSError: A rank cannot write; raised on all ranks.
    """
    names = state_names(path, len(times), ".pvtu" if several() else ".vtu")
    paths = [path.parent / name for name in names]
    write_each(path, partial(_write_own, paths, grid, [int(rank) for rank in np.unique(ranks)]))
    write_collection(path, names, times)


def state_names(path: Path, count: int, suffix: str) -> list[str]:
    """Names of the files of all states, in the folder of the collection, which is created."""
    if path.suffix != ".pvd":
        raise ValueError(f"the name of the series must end in '.pvd', got {str(path)!r}")
    folder = path.with_suffix("")
    folder.mkdir(parents=True, exist_ok=True)
    digits = len(str(count - 1))
    return [f"{folder.name}/{k:0{digits}}{suffix}" for k in range(count)]


def write_collection(path: Path, names: Sequence[str], times: Array) -> None:
    """Write the ``.pvd`` file of the states, when they are complete; all ranks together."""
    write_once(path, partial(_write_list, path, names, times))


def _write_list(path: Path, names: Sequence[str], times: Array) -> None:
    rows = [
        f'<DataSet timestep="{float(time)!r}" file="{escape(name)}"/>'
        for name, time in zip(names, times, strict=True)
    ]
    path.write_text(
        '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n<Collection>\n'
        + "\n".join(rows)
        + "\n</Collection>\n</VTKFile>\n"
    )


def _write_own(paths: Sequence[Path], grid: Callable[[int], Grid], writing: Sequence[int]) -> None:
    """Write what this rank has of all states: all, or a piece, with the list on one rank.

    Args:
        paths: Names of the files of all states.
        grid: Grid of a state.
        writing: Ranks that have cells, ascending: readers take no empty pieces.
    """
    rank = int(MPI.COMM_WORLD.rank)
    for k, path in enumerate(paths if rank in writing else ()):
        own = grid(k)
        if not several():
            write_grid(path, own)
            continue
        write_grid(path.parent / f"{path.stem}_{rank}.vtu", own)
        if rank == writing[0]:
            path.write_text(_list_of([f"{path.stem}_{piece}.vtu" for piece in writing], own))


def _list_of(names: Sequence[str], piece: Grid) -> str:
    """Contents of a ``.pvtu`` file: the files, and names and types of the arrays of a piece."""
    root = ElementTree.Element("VTKFile", type="PUnstructuredGrid", version="0.1")
    pieces = ElementTree.SubElement(root, "PUnstructuredGrid", GhostLevel="0")
    _add_arrays(pieces, "PPointData", piece.point_data)
    _add_arrays(pieces, "PCellData", piece.cell_data)
    _add_arrays(pieces, "PPoints", {"Points": piece.points})
    for name in names:
        ElementTree.SubElement(pieces, "Piece", Source=name)
    ElementTree.indent(root)
    return f'<?xml version="1.0"?>\n{ElementTree.tostring(root, encoding="unicode")}\n'


def _add_arrays(
    root: ElementTree.Element, kind: str, arrays: Mapping[str, npt.NDArray[Any]]
) -> None:
    """Add types, names and numbers of components of arrays."""
    element = ElementTree.SubElement(root, kind)
    for name, values in arrays.items():
        ElementTree.SubElement(
            element,
            "PDataArray",
            type=f"{_TYPES[values.dtype.kind]}{8 * values.dtype.itemsize}",
            Name=name,
            NumberOfComponents=str(values[0].size),
        )
