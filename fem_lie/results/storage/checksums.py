"""Checksums of what is in a file of results, so that a flipped bit is an error.

HDF5's own checksums (Fletcher-32) are of chunks: a process that ends while it fills a chunk leaves
one whose checksum is wrong, and with it all rows of the chunk are lost. So each row of results has
a CRC-32, which is written before the row is counted, and each group has one of all that is in it.
"""

from __future__ import annotations

import zlib
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

CHECKSUM = "checksum"
"""Attribute of a group with the checksum of what is in it."""

NAMES = "contents"
"""Group, and its attribute, with the names of all that is in the file."""

_BLOCK = 2**20  # bytes of rows that are copied together for their checksums


class DamagedError(Exception):
    """Contents do not agree with their checksum."""


def row_checksums(arrays: Mapping[str, npt.NDArray[Any]]) -> npt.NDArray[np.int64]:
    """CRC-32 of each row of arrays, which follow each other by name; shape (n,).

    Args:
        arrays: The same number n of rows of each.
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
        DamagedError: Rows do not agree; the first is named.
    """
    wrong = row_checksums(arrays) != checksums
    if wrong.any():
        raise DamagedError(
            f"{wrong.sum()} of {len(wrong)} rows do not agree with their checksums, the first is "
            f"row {np.argmax(wrong)}"
        )


def seal(file: Any) -> None:
    """Give all groups of an HDF5 file checksums, and one of them the names of what is there."""
    file[NAMES].attrs[NAMES] = _names(file)
    for group in groups(file):
        group.attrs[CHECKSUM] = _content(group)


def check(file: Any) -> None:
    """Compare what is in a file and its groups with names and checksums.

    Raises:
        DamagedError: Something is missing, or does not agree; the group is named.
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
    """Name, type, shape and contents of a value, strings of any length included."""
    array = np.asarray(value)
    contents = repr(array.tolist()).encode() if array.dtype.hasobject else array.tobytes()
    return f"{name} {array.dtype.str} {array.shape} ".encode() + contents
