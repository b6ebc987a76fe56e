"""What all results have in common: functions, files and tables, by the same names."""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, TypeAlias, TypeVar

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie.bodies.body import Body, Point
from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.lie.node_types import all_axes
from fem_lie.pictures.vtk import write_series
from fem_lie.ranks.files import before_reading, write_once
from fem_lie.results.files.functions import BodyMesh, NodalFields
from fem_lie.results.files.records import read_record, write_record
from fem_lie.results.files.tables import Columns, Table

if TYPE_CHECKING:
    from dolfinx import fem

Located = Point | str | int
"""A point of a body, its name such as "beam 1.end", or a node's number."""


Nodes: TypeAlias = Indices | slice
"""Numbers of nodes, shape (n,), or a range of them."""

EVERY = slice(None)
"""All nodes."""


class Rows(NamedTuple):
    """What the k states or modes of a result are counted by.

    Attributes:
        label: "time", "load factor" or "mode".
        values: Time, load factor or number of each, shape (k,).
    """

    label: str
    values: Array


class Written(ABC):
    """Output of a result with k states or modes."""

    info: SceneInfo

    @abstractmethod
    def _rows(self) -> Rows:
        """Times, load factors or numbers of modes."""

    @abstractmethod
    def _frames_of(self, row: int, nodes: Nodes = EVERY) -> Array:
        """Frames of some nodes in a state, shape (n, 4, 3)."""

    @abstractmethod
    def _fields_of(self, row: int, nodes: Nodes = EVERY) -> NodalFields:
        """Vectors of some nodes in a state or mode, global components, each of shape (n, 3)."""

    @abstractmethod
    def _quantities(self) -> Columns:
        """Quantities of the states or modes, each of shape (k,)."""

    @abstractmethod
    def _quantities_at(self, point: Located) -> Columns:
        """Quantities of a point, each of shape (k,); names begin with that of the point."""

    def write_vtx(self, path: str | os.PathLike[str], body: Body | str) -> None:
        """Write all states or modes of a body as a series for ParaView's VTX reader, by ADIOS2.

        The fields are those of :meth:`functions`, on the undeformed mesh: ParaView's *Warp by
        vector* with ``displacement`` shows the deformed body.

        Args:
            path: Name of the ``.bp`` folder.
            body: A body of the scene, or its name, see :meth:`functions`.

        Raises:
            ValueError: The name does not end in ``.bp``, or the body has no cells.
        """
        require_suffix(path, ".bp", "series")
        mesh = BodyMesh.of(body, self.info)
        write = partial(mesh.write_vtx, path, self._rows().values, self._fields_of)
        write_once(path, write)

    def to_dataframe(self, points: Sequence[Located] | None = None) -> Any:
        """Quantities and positions of points as a ``pandas.DataFrame``, one row for each state.

        Args:
            points: Points of which there are columns; default: all points with names.

        Raises:
            ValueError: There is no such point.
            ImportError: pandas is not installed.
        """
        return self._table(points).to_dataframe()

    def write_csv(
        self, path: str | os.PathLike[str], points: Sequence[Located] | None = None
    ) -> None:
        """Write the table of :meth:`to_dataframe`, without pandas; values are kept to all digits.

        ``pandas.read_csv(path, float_precision="round_trip")`` reads all of them.

        Args:
            path: Name of the ``.csv`` file.
            points: As for :meth:`to_dataframe`.

        Raises:
            ValueError: There is no such point, or the name does not end in ``.csv``.
        """
        require_suffix(path, ".csv", "file")
        table = self._table(points)
        write_once(path, partial(table.write_csv, path))

    def _table(self, points: Sequence[Located] | None) -> Table:
        columns = self._quantities()
        for point in self._named_points() if points is None else points:
            columns |= self._quantities_at(point)
        return Table(*self._rows(), columns)

    def _named_points(self) -> list[str]:
        return [f"{body.name}.{name}" for body in self.info.bodies for name in body.points]

    def _functions(self, body: Body | str, row: int) -> dict[str, fem.Function]:
        """Functions of one state or mode, see :meth:`functions` of the result."""
        return BodyMesh.of(body, self.info).functions(self._fields_of(row))

    def _write_vtk(self, path: str | os.PathLike[str], in_cells: Mapping[str, Array]) -> None:
        """Write a series, with values of all cells in all states, see :meth:`write_vtk`."""
        require_suffix(path, ".pvd", "series")
        rows = self._rows().values
        write_series(path, self.info, rows, self._frames_of, self._fields_of, in_cells)


AnySaved = TypeVar("AnySaved", bound="Saved")


class Saved:
    """A result, a dataclass, that is saved as a record."""

    _PARTS: ClassVar[tuple[type, ...]] = ()
    """Classes of the records in it."""

    _NOT_SAVED: ClassVar[tuple[str, ...]] = ()
    """Fields that are ``None`` when it is read."""

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write all contents to an HDF5 file, replacing an existing file in one step.

        Statistics of subdomains are left out.

        Args:
            path: Name of the file.

        Raises:
            OSError: The file cannot be written, for example because the disk is full.
        """
        write_once(path, partial(write_record, path, self, self._NOT_SAVED))

    @classmethod
    def load(cls: type[AnySaved], path: str | os.PathLike[str]) -> AnySaved:
        """Read a file that :meth:`save` wrote; all values are bitwise equal.

        Args:
            path: Name of the file.

        Raises:
            FileNotFoundError: There is no such file.
            ValueError: It is a file of another class of results, or it is damaged.
        """
        before_reading(path)
        return read_record(path, cls, cls._PARTS)


def rotation_vectors(info: SceneInfo, frames: Array, nodes: Nodes = EVERY) -> Array:
    """Rotation of some nodes from the undeformed configuration, at most π, rad, shape (n, 3).

    Args:
        info: Nodes of all bodies.
        frames: Frames of these nodes, shape (n, 4, 3).
        nodes: The nodes.
    """
    kinds: Indices = info.node_types[nodes]
    axes = (all_axes(kinds, np.ascontiguousarray(H)) for H in (frames, info.undeformed[nodes]))
    return np.asarray(lie.so3_log(np.einsum("nai,naj->nij", *axes)))


def require_suffix(path: str | os.PathLike[str], suffix: str, what: str) -> None:
    """Raise ``ValueError`` on all ranks if the name of a file or series has another suffix."""
    if Path(path).suffix != suffix:
        raise ValueError(f"the name of the {what} must end in {suffix!r}, got {str(path)!r}")
