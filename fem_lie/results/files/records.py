"""HDF5 files of records: dataclasses, named tuples, mappings and sequences of arrays and numbers.

A record is a group with one data set or group for each array, record or sequence, and one attribute
for each number, text or flag; ``None`` is left out. A record that occurs several times is written
once, with a link for each further time. All contents have checksums
(:mod:`fem_lie.results.files.storage`).
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import fields, is_dataclass
from enum import Enum
from pathlib import Path
from typing import Any, TypeAlias, TypeVar

import numpy as np

from fem_lie.results.files.storage import NAMES, DamagedError, check, seal, write_in_memory

_FORMAT, _VERSION = "fem_lie", 1
_CONTENT, _CLASS, _KEYS = "result", "class", "keys"
_MAPPING, _TUPLE = "mapping", "tuple"

_DAMAGES = (
    DamagedError,
    # exceptions of h5py for a damaged file structure
    *(OSError, KeyError, ValueError, TypeError, RuntimeError, MemoryError, OverflowError),
    *(AttributeError, IndexError),
)
"""Exceptions that reading a damaged file raises."""

Kind = TypeVar("Kind")

_Written: TypeAlias = dict[int, tuple[object, Any]]
"""Records with their groups, by their ids."""


def write_record(path: str | os.PathLike[str], record: object, leave_out: Iterable[str]) -> None:
    """Write a file; it appears under its name only when it is complete.

    Args:
        path: Name of the file.
        record: A dataclass.
        leave_out: Names of its fields that are not written.

    Raises:
        OSError: The file cannot be written, for example because the disk is full.
    """

    def fill(file: Any) -> None:
        file.attrs.update({"format": _format(type(record)), "version": _VERSION})
        file.create_group(NAMES)
        values = {n: v for n, v in _named_values(record).items() if n not in set(leave_out)}
        _write_group(file.create_group(_CONTENT), type(record).__name__, values, {})
        seal(file)

    write_in_memory(Path(path), fill)


@contextmanager
def opened(path: str | os.PathLike[str]) -> Iterator[Any]:
    """Context with an HDF5 file of results for reading.

    Raises:
        FileNotFoundError: There is no such file.
        ValueError: It is not HDF5, or what is read in the context is damaged.
    """
    import h5py

    source = Path(path)
    if not source.is_file():
        raise FileNotFoundError(f"no file of results {str(source)!r}")
    if not h5py.is_hdf5(source):
        raise ValueError(f"{str(source)!r} is not a file of results (not HDF5)")
    try:
        with h5py.File(source, "r") as file:
            yield file
    except _DAMAGES as error:
        raise ValueError(f"{str(source)!r} is damaged: {error}") from error


def read_record(path: str | os.PathLike[str], kind: type[Kind], parts: Iterable[type]) -> Kind:
    """Read a file of :func:`write_record`.

    Args:
        path: Name of the file.
        kind: Class of the record.
        parts: Classes of the records and enumerations in it.

    Raises:
        FileNotFoundError: There is no such file.
        ValueError: It is a file of something else or of a later version, or it is damaged.
    """
    with opened(path) as file:
        given = file.attrs.get("format"), file.attrs.get("version")
        if given == (_format(kind), _VERSION):
            check(file)
            known = {each.__name__: each for each in (kind, *parts)}
            found: Kind = _read_group(file[_CONTENT], known, {})
            return found
    raise ValueError(
        f"expected a file of a {kind.__name__}, format {_format(kind)!r}, version {_VERSION}, got "
        f"{str(path)!r} with format {given[0]!r}, version {given[1]}"
    )


def _format(kind: type) -> str:
    return f"{_FORMAT} {kind.__name__}"


def _named_values(record: Any) -> dict[str, Any]:
    """Fields of a dataclass or named tuple."""
    if is_dataclass(record):
        return {field.name: getattr(record, field.name) for field in fields(record)}
    named: dict[str, Any] = record._asdict()
    return named


def _write_group(group: Any, kind: str, values: Mapping[str, Any], written: _Written) -> None:
    group.attrs[_CLASS] = kind
    for name, value in values.items():
        _write(group, name, value, written)


def _write(group: Any, name: str, value: Any, written: _Written) -> None:
    if value is None:
        return
    if isinstance(value, Enum):
        part = group.create_group(name)
        part.attrs.update({_CLASS: type(value).__name__, "name": value.name})
    elif isinstance(value, np.ndarray) and value.ndim:
        group[name] = value
    elif np.isscalar(value) or isinstance(value, np.ndarray):
        group.attrs[name] = value
    elif id(value) in written:
        group[name] = written[id(value)][1]
    else:
        part = group.create_group(name)
        written[id(value)] = value, part  # no other object may get its id
        _write_group(part, *_contents(value), written)


def _contents(value: Any) -> tuple[str, dict[str, Any]]:
    """Class of a record, mapping or sequence, and its parts by name."""
    if isinstance(value, Mapping):
        # any text may be a key, but not the name of a data set
        items = {str(k): item for k, item in enumerate(value.values())}
        return _MAPPING, {_KEYS: tuple(value), **items}
    if is_dataclass(value) or hasattr(value, "_asdict"):
        return type(value).__name__, _named_values(value)
    if isinstance(value, tuple | list):
        return _TUPLE, {str(k): item for k, item in enumerate(value)}
    raise TypeError(f"expected records, arrays and numbers in a file, got {value!r}")


def _read_group(group: Any, known: Mapping[str, type], read: dict[int, Any]) -> Any:
    import h5py

    at = h5py.h5o.get_info(group.id).addr
    if at not in read:
        read[at] = _made(group, known, read)
    return read[at]


def _made(group: Any, known: Mapping[str, type], read: dict[int, Any]) -> Any:
    values = {name: value for name, value in group.attrs.items() if name not in _OWN}
    values = {name: getattr(value, "item", lambda v=value: v)() for name, value in values.items()}
    for name, item in group.items():
        values[name] = item[()] if hasattr(item, "shape") else _read_group(item, known, read)
    kind = group.attrs[_CLASS]
    if kind == _TUPLE:
        return tuple(values[str(k)] for k in range(len(values)))
    if kind == _MAPPING:
        keys = values[_KEYS]
        return {key: values[str(k)] for k, key in enumerate(keys)}
    if kind not in known:
        raise DamagedError(f"it has a record of an unknown class {kind!r}")
    if issubclass(known[kind], Enum):
        return getattr(known[kind], values["name"])
    # what is None was left out
    none = dict.fromkeys(_field_names(known[kind]))
    return known[kind](**none | values)


_OWN = (_CLASS, "checksum")
"""Attributes of a group that are no values of the record."""


def _field_names(kind: Any) -> tuple[str, ...]:
    return tuple(field.name for field in fields(kind)) if is_dataclass(kind) else kind._fields
