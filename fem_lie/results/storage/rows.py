"""Rows of the arrays of a results file, written while a run goes on.

The structure of the file does not change meanwhile: a process that ends, in whatever way, leaves a
file that can be read, with all rows that were counted. Writing goes by system calls that report a
full disk, never through mapped memory, where that is the end of the process. A row's checksum is
written before the row is counted, and the count stands there twice.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from fem_lie.results.storage.checksums import row_checksums

COUNT, CHECKSUMS = "rows", "checksums"
"""Data sets of the number of rows, shape (2,), and of their checksums, shape (rows,)."""


class _Place(NamedTuple):
    """Where a data set is in the file; without an offset it has no values."""

    offset: int | None
    kind: np.dtype[Any]
    shape: tuple[int, ...]


class ResultRows:
    """The data sets of a file made by :func:`fem_lie.results.file.create`."""

    def __init__(self, path: Path) -> None:
        """Find their places."""
        import h5py

        self._path = path
        with h5py.File(path, "r") as file:
            self._places = {
                name: _Place(item.id.get_offset(), item.dtype, item.shape)
                for name, item in file.items()
                if isinstance(item, h5py.Dataset)
            }

    @property
    def room(self) -> int:
        """Rows that there can be."""
        return self._places[CHECKSUMS].shape[0]

    def write(self, first: int, rows: Mapping[str, npt.NDArray[Any]]) -> None:
        """Write rows from ``first`` on, the same number of each array, and count them.

        Raises:
            OSError: The disk is full, or there is another reason.
        """
        stored = {
            name: np.ascontiguousarray(values, dtype=self._places[name].kind)
            for name, values in rows.items()
        }
        checksums = row_checksums(stored)
        with self._path.open("r+b", buffering=0) as file:
            for name, values in (*stored.items(), (CHECKSUMS, checksums)):
                self._write(file.fileno(), name, values, first)
            self._write(file.fileno(), COUNT, np.full(2, first + len(checksums)), 0)

    def _write(self, descriptor: int, name: str, values: npt.NDArray[Any], first: int) -> None:
        offset, kind, shape = self._places[name]
        if offset is not None:
            row = kind.itemsize * int(np.prod(shape[1:], dtype=np.int64))
            write_all(descriptor, values.tobytes(), offset + first * row)

    def sync(self) -> None:
        """Wait until all that was written is on the disk."""
        with self._path.open("r+b", buffering=0) as file:
            os.fsync(file.fileno())

    def read(self, count: int) -> dict[str, npt.NDArray[Any]]:
        """The first rows of all arrays, mapped into memory: what is not looked at costs nothing."""
        found: dict[str, npt.NDArray[Any]] = {}
        for name, (offset, kind, shape) in self._places.items():
            if offset is None:
                found[name] = np.empty(shape, dtype=kind)[:count]
            elif name not in (COUNT, CHECKSUMS):
                mapped = np.memmap(self._path, dtype=kind, mode="r", offset=offset, shape=shape)
                found[name] = mapped[:count]
        return found


def write_all(descriptor: int, data: bytes | memoryview, offset: int) -> None:
    """Write all of ``data``, however many calls that takes."""
    view = memoryview(data)
    while len(view):
        done = os.pwrite(descriptor, view, offset)
        view, offset = view[done:], offset + done
