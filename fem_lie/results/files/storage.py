"""Rows of a results file that are written during a run, and checksums of the contents.

*Checksums.* HDF5's own checksums (Fletcher-32) are per chunk: a process that ends while it fills a
chunk leaves a wrong checksum, and all rows of the chunk are lost. So each row of results has a
CRC-32, which is written before the row is counted, and each group has one of all of its contents. A
single flipped bit is an error when the file is read.

*Rows.* The structure of the file does not change during a run: a process that ends in any way
leaves a readable file with all rows that were counted. Rows are written by system calls that report
a full disk, not through mapped memory, where a full disk ends the process. The number of rows is
stored twice.
"""

from __future__ import annotations

import os
import zlib
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

CHECKSUM = "checksum"
"""Attribute of a group with the checksum of its contents."""

NAMES = "contents"
"""Group, and its attribute, with the names of all contents of the file."""

_BLOCK = 2**20  # bytes of rows per block when checksums are computed


class DamagedError(Exception):
    """Contents do not agree with their checksum."""


def row_checksums(arrays: Mapping[str, npt.NDArray[Any]]) -> npt.NDArray[np.int64]:
    """CRC-32 of each row of arrays, which are concatenated by name; shape (n,).

    Args:
        arrays: Arrays with the same number n of rows.
    """
    count = len(next(iter(arrays.values())))
    parts = [
        np.ascontiguousarray(arrays[name]).reshape(count, -1).view(np.uint8)
        for name in sorted(arrays)
        if arrays[name].size
    ]
    found = np.zeros(count, dtype=np.int64)
    step = max(1, _BLOCK // max(1, sum(part.shape[1] for part in parts)))
    for first in range(0, count if parts else 0, step):
        block = np.concatenate([part[first : first + step] for part in parts], axis=1)
        found[first : first + step] = [zlib.crc32(row) for row in block]
    return found


def check_rows(arrays: Mapping[str, npt.NDArray[Any]], checksums: npt.NDArray[np.int64]) -> None:
    """Compare rows of arrays with their checksums, shape (n,).

    Raises:
        DamagedError: Some rows do not agree; the first of them is named.
    """
    wrong = row_checksums(arrays) != checksums
    if wrong.any():
        raise DamagedError(
            f"{wrong.sum()} of {len(wrong)} rows do not agree with their checksums, the first is "
            f"row {np.argmax(wrong)}"
        )


def seal(file: Any) -> None:
    """Add checksums to all groups of an HDF5 file, and the list of its contents."""
    file[NAMES].attrs[NAMES] = _names(file)
    for group in groups(file):
        group.attrs[CHECKSUM] = _content(group)


def check(file: Any) -> None:
    """Compare the contents of a file and of its groups with the list and the checksums.

    Raises:
        DamagedError: Contents are missing or do not agree; the group is named.
    """
    if file[NAMES].attrs[NAMES] != _names(file):
        raise DamagedError(f"it has {_names(file)}, but should have {file[NAMES].attrs[NAMES]}")
    for group in groups(file):
        if group.attrs[CHECKSUM] != _content(group):
            raise DamagedError(f"group {group.name!r} does not agree with its checksum")


def groups(file: Any) -> list[Any]:
    """Groups of an HDF5 file."""
    return [item for item in file.values() if hasattr(item, "items")]


def _names(file: Any) -> str:
    return ", ".join(sorted(file))


def _content(group: Any) -> int:
    """CRC-32 of attributes, data sets and groups in a group."""
    found = 0
    for name in sorted(set(group.attrs) - {CHECKSUM}):
        found = zlib.crc32(_bytes(name, group.attrs[name]), found)
    for name in sorted(group):
        item = group[name]
        value = item[()] if hasattr(item, "shape") else _content(item)
        found = zlib.crc32(_bytes(name, value), found)
    return found


def _bytes(name: str, value: Any) -> bytes:
    """Name, type, shape and contents of a value, including strings of any length."""
    array = np.asarray(value)
    contents = repr(array.tolist()).encode() if array.dtype.hasobject else array.tobytes()
    return f"{name} {array.dtype.str} {array.shape} ".encode() + contents


def write_in_memory(target: Path, fill: Callable[[Any], None]) -> None:
    """Write an HDF5 file at once; it appears under its name only when it is complete.

    Args:
        target: Name of the file.
        fill: Writes the contents into an open ``h5py.File``.

    Raises:
        OSError: The file cannot be written, for example because the disk is full.
    """
    import h5py

    # the HDF5 library aborts the process when the disk is full
    with h5py.File(target.name, "w", driver="core", backing_store=False) as file:
        fill(file)
        file.flush()
        image = file.id.get_file_image()
    try:
        with unfinished(target) as part, part.open("wb", buffering=0) as opened:
            write_all(opened.fileno(), image, 0)
            os.fsync(opened.fileno())
    except OSError as error:
        raise OSError(error.errno, error.strerror, str(target)) from error


@contextmanager
def unfinished(path: Path) -> Iterator[Path]:
    """Temporary path of a file that is renamed when it is complete."""
    unfinished_path = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        yield unfinished_path
        os.replace(unfinished_path, path)
    finally:
        unfinished_path.unlink(missing_ok=True)


COUNT, CHECKSUMS = "rows", "checksums"
"""Data sets of the number of rows, shape (2,), and of their checksums, shape (rows,)."""


class _Location(NamedTuple):
    """Location of a data set in the file; without an offset it has no values."""

    offset: int | None
    kind: np.dtype[Any]
    shape: tuple[int, ...]


class ResultRows:
    """The data sets of a file made by :func:`fem_lie.results.file.create`."""

    def __init__(self, path: Path) -> None:
        """Find the locations of the data sets."""
        import h5py

        self._path = path
        with h5py.File(path, "r") as file:
            self._locations = {
                name: _Location(item.id.get_offset(), item.dtype, item.shape)
                for name, item in file.items()
                if isinstance(item, h5py.Dataset)
            }

    @property
    def capacity(self) -> int:
        """Largest number of rows."""
        return self._locations[CHECKSUMS].shape[0]

    def write(self, first: int, rows: Mapping[str, npt.NDArray[Any]]) -> None:
        """Write rows from ``first`` on, the same number for each array, and count them.

        Raises:
            OSError: The file cannot be written, for example because the disk is full.
        """
        stored = {
            name: np.ascontiguousarray(values, dtype=self._locations[name].kind)
            for name, values in rows.items()
        }
        checksums = row_checksums(stored)
        with self._path.open("r+b", buffering=0) as file:
            for name, values in (*stored.items(), (CHECKSUMS, checksums)):
                self._write(file.fileno(), name, values, first)
            self._write(file.fileno(), COUNT, np.full(2, first + len(checksums)), 0)

    def _write(self, descriptor: int, name: str, values: npt.NDArray[Any], first: int) -> None:
        offset, kind, shape = self._locations[name]
        if offset is not None:
            row = kind.itemsize * int(np.prod(shape[1:], dtype=np.int64))
            write_all(descriptor, values.tobytes(), offset + first * row)

    def sync(self) -> None:
        """Wait until all data are on the disk."""
        with self._path.open("r+b", buffering=0) as file:
            os.fsync(file.fileno())

    def read(self, count: int) -> dict[str, npt.NDArray[Any]]:
        """The first rows of all arrays, mapped into memory, so that unused arrays cost nothing."""
        found: dict[str, npt.NDArray[Any]] = {}
        for name, (offset, kind, shape) in self._locations.items():
            if offset is None:
                found[name] = np.empty(shape, dtype=kind)[:count]
            elif name not in (COUNT, CHECKSUMS):
                mapped = np.memmap(self._path, dtype=kind, mode="r", offset=offset, shape=shape)
                found[name] = mapped[:count]
        return found


def write_all(descriptor: int, data: bytes | memoryview, offset: int) -> None:
    """Write all of ``data``, in as many calls as needed."""
    view = memoryview(data)
    while len(view):
        done = os.pwrite(descriptor, view, offset)
        view, offset = view[done:], offset + done
