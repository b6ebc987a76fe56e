"""Result files in HDF5: one data set for each array, one group for each body and joint.

Since version 11 all contents have checksums, see :mod:`fem_lie.results.files.storage`; since
version 12 bodies have their undeformed configuration. Files of version 10 and later can be read.
"""

from __future__ import annotations

import os
import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from math import prod
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np

from fem_lie._arrays import Array
from fem_lie.bodies.catalogue import BodyInfo, JointInfo, SceneInfo, SupportInfo, box_corners
from fem_lie.results.files.records import opened
from fem_lie.results.files.storage import (
    CHECKSUMS,
    COUNT,
    NAMES,
    DamagedError,
    ResultRows,
    check,
    check_rows,
    row_checksums,
    seal,
    unfinished,
    write_in_memory,
)
from fem_lie.results.record import ContactSteps, FrictionForces, StepHistory

Record = TypeVar("Record", StepHistory, ContactSteps, FrictionForces)

_FORMAT, _VERSION = "fem_lie results", 12
_NUMBERS = "numbers"
_BLOCK = 2**26  # bytes of rows that are copied together
NUMBERS = ("factorisations", "k_updates", "phi_updates", "divided", "seconds")
"""Scalar statistics of a run; the last one is in seconds."""


class Stored(NamedTuple):
    """Contents of a file.

    Attributes:
        arrays: Arrays by their names in :class:`~fem_lie.Result`, with one row for each time.
        numbers: Values of :data:`NUMBERS`.
        info: Bodies and joints.
        steps: History of the steps, if the step size was variable.
        contacts: History of contacts with impacts, if there are any.
        friction: Friction forces of contacts by penalty, if there are any.
    """

    arrays: dict[str, Array]
    numbers: dict[str, float]
    info: SceneInfo
    steps: StepHistory | None
    contacts: ContactSteps | None
    friction: FrictionForces | None

    @property
    def records(self) -> tuple[StepHistory | ContactSteps | FrictionForces, ...]:
        """Those of the last three that there are."""
        given = self.steps, self.contacts, self.friction
        return tuple(record for record in given if record is not None)


def write(path: str | os.PathLike[str], result: Stored) -> None:
    """Write a file; it appears under its name only when it is complete."""

    def fill(file: Any) -> None:
        file.attrs.update({"format": _FORMAT, "version": _VERSION})
        for name, values in result.arrays.items():
            file[name] = values
        file[CHECKSUMS] = row_checksums(result.arrays)
        file[COUNT] = np.full(2, len(file[CHECKSUMS]))
        file.attrs[_NUMBERS] = _packed(result.numbers)
        for record in result.records:
            for field in fields(record):
                file[f"{_GROUPS[type(record)]}/{field.name}"] = getattr(record, field.name)
        _write_info(file, result.info)
        seal(file)

    write_in_memory(Path(path), fill)


def create(path: Path, info: SceneInfo, shapes: Mapping[str, tuple[int, ...]], rows: int) -> None:
    """Create a file with space for rows of arrays, see :mod:`fem_lie.results.files.storage`.

    Args:
        path: Name of the file.
        info: Bodies and joints.
        shapes: Shape of a row of each array.
        rows: Largest number of rows.
    """
    with unfinished(path) as unfinished_path:
        _write_empty(unfinished_path, info, shapes, rows)


def enlarge(
    path: Path, info: SceneInfo, shapes: Mapping[str, tuple[int, ...]], filled: int, rows: int
) -> None:
    """Replace a file that :func:`create` made by one with space for more rows.

    Args:
        path: Name of the file.
        info: Bodies and joints.
        shapes: Shape of a row of each array.
        filled: Number of rows that the file has.
        rows: Largest number of rows of the new file.
    """
    size = 8 * sum(prod(shape) for shape in shapes.values())
    many = max(1, _BLOCK // size)
    with unfinished(path) as unfinished_path:
        _write_empty(unfinished_path, info, shapes, rows)
        new, known = ResultRows(unfinished_path), ResultRows(path).read(filled)
        for first in range(0, filled, many):
            new.write(first, {name: rows[first : first + many] for name, rows in known.items()})
        new.sync()


_OF_FILE, _OF_ITEM = 2**16, 2**12
"""Bytes that the structure of a file takes at most, and that of a body or joint."""


def _size(info: SceneInfo) -> int:
    """Bytes that bodies and joints take in a file."""
    items = *info.bodies, *info.joints
    values = (value for item in items for value in vars(item).values())
    arrays = sum(value.nbytes for value in values if isinstance(value, np.ndarray))
    return _OF_FILE + _OF_ITEM * len(items) + arrays


def _reserve(path: Path, size: int) -> None:
    """Raise ``OSError`` if there is no space: the HDF5 library aborts the process at its close."""
    with path.open("wb") as file:
        os.posix_fallocate(file.fileno(), 0, size)


def _write_empty(
    path: Path, info: SceneInfo, shapes: Mapping[str, tuple[int, ...]], rows: int
) -> None:
    import h5py

    _reserve(path, _size(info) + 8 * rows * (1 + sum(prod(shape) for shape in shapes.values())))
    kinds = dict.fromkeys(shapes, np.dtype(np.float64)) | {"iterations": np.dtype(np.int64)}
    with h5py.File(path, "w") as file:
        file.attrs.update({"format": _FORMAT, "version": _VERSION})
        file.attrs[_NUMBERS] = _packed(dict.fromkeys(NUMBERS, 0.0))
        properties = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
        properties.set_alloc_time(h5py.h5d.ALLOC_TIME_EARLY)
        whole = {name: (rows, *shape) for name, shape in shapes.items()}
        for name, shape in (*whole.items(), (CHECKSUMS, (rows,)), (COUNT, (2,))):
            kind = h5py.h5t.py_create(kinds.get(name, np.dtype(np.int64)), logical=True)
            space = h5py.h5s.create_simple(shape)
            h5py.h5d.create(file.id, name.encode(), kind, space, properties)
        _write_info(file, info)
        seal(file)


def finish(path: Path, numbers: dict[str, float]) -> None:
    """Set the number of factorisations and the wall time of a file that :func:`create` made."""
    import h5py

    with h5py.File(path, "r+") as file:
        file.attrs.modify(_NUMBERS, _packed(numbers))


_GROUPS: dict[type, str] = {
    StepHistory: "steps",
    ContactSteps: "contacts",
    FrictionForces: "friction",
}


def add(path: Path, record: StepHistory | ContactSteps | FrictionForces) -> None:
    """Add the history of steps, contacts or friction to a file that :func:`create` made."""
    import h5py

    group = _GROUPS[type(record)]
    with h5py.File(path, "r+") as file:
        if group in file:
            del file[group]
        for field in fields(record):
            file[f"{group}/{field.name}"] = getattr(record, field.name)
        seal(file)


_NOT_DIVIDED = 0
"""Number of parts of a scene that was not divided."""


def _write_info(file: Any, info: SceneInfo) -> None:
    names = file.create_group(NAMES)
    names.attrs["mass"], names.attrs["strained"] = info.mass, list(info.strained)
    names.attrs["parts"] = info.parts or _NOT_DIVIDED
    for i, body in enumerate(info.bodies):
        _write_body(file.create_group(f"bodies/{i}"), body)
    for i, joint in enumerate(info.joints):
        _write_joint(file.create_group(f"joints/{i}"), joint)
    for field in fields(SupportInfo):
        file[f"supports/{field.name}"] = getattr(info.supports, field.name)


def read(path: str | os.PathLike[str], names: Sequence[str]) -> Stored:
    """Read arrays of these names, and all other contents that :func:`write` wrote.

    For errors see :meth:`fem_lie.Result.load`.
    """
    with opened(path) as file:
        given = file.attrs.get("format"), file.attrs.get("version")
        if given[0] == _FORMAT and given[1] in _READERS:
            return _READERS[given[1]](file, names)
    other = str(given[0]).removeprefix("fem_lie ")
    hint = f"; fl.{other}.load reads it" if other == "StaticResult" else ""
    raise ValueError(
        f"{str(path)!r} is not a file of results of versions {min(_READERS)} to {_VERSION}: "
        f"format {given[0]!r}, version {given[1]}{hint}"
    )


def require_version(path: Path) -> None:
    """Refuse a file of an older version, because rows cannot be added to it.

    Raises:
        ValueError: The file has another version than the present one.
    """
    import h5py

    with h5py.File(path, "r") as file:
        version = file.attrs.get("version")
    if version != _VERSION:
        raise ValueError(
            f"cannot resume: {str(path)!r} is a file of results of version {version}, and rows can "
            f"only be added to version {_VERSION}; Result.load reads it"
        )


def _read_version_10(file: Any, names: Sequence[str]) -> Stored:
    rows = slice(int(file[COUNT][0]) if COUNT in file else None)
    arrays = {name: file[name][rows] for name in names if name in file}
    numbers = _named([float(file.attrs[name]) for name in NUMBERS])
    return _with_info(file, arrays, numbers, file.attrs["mass"])


def _read_version_11(file: Any, names: Sequence[str]) -> Stored:
    check(file)
    *values, checksum = file.attrs[_NUMBERS]
    if checksum != _packed(_named(values))[-1]:
        raise DamagedError("the numbers of the run do not agree with their checksum")
    count, again = file[COUNT][()]
    if count != again:
        raise DamagedError(f"the file says that it has {count} rows, and {again}")
    arrays = {name: item[:count] for name, item in file.items() if not hasattr(item, "items")}
    del arrays[COUNT]
    check_rows(arrays, arrays.pop(CHECKSUMS))
    arrays = {name: arrays[name] for name in names if name in arrays}
    return _with_info(file, arrays, _named(values), file[NAMES].attrs["mass"])


_READERS: dict[int, Callable[[Any, Sequence[str]], Stored]] = {
    10: _read_version_10,
    11: _read_version_11,
    12: _read_version_11,
}


def _named(values: Sequence[float]) -> dict[str, float]:
    """Statistics of the run by name; all except the seconds are integers."""
    return {
        name: float(value) if name == NUMBERS[-1] else int(value)
        for name, value in zip(NUMBERS, values, strict=True)
    }


def _packed(numbers: Mapping[str, float]) -> Array:
    """Statistics of the run and their checksum, as one attribute."""
    values = np.array([float(numbers[name]) for name in NUMBERS])
    return np.append(values, zlib.crc32(values.tobytes()))


def _with_info(file: Any, arrays: dict[str, Array], numbers: dict[str, float], mass: Any) -> Stored:
    """Contents of a file of any version, with these arrays and statistics."""
    steps = _read_record(file, "steps", StepHistory)
    contacts = _read_record(file, "contacts", ContactSteps)
    friction = _read_record(file, "friction", FrictionForces)
    # files of earlier versions have fewer attributes, or none
    attributes = file[NAMES].attrs if NAMES in file else {}
    info = SceneInfo(
        tuple(_read_body(group) for group in _groups(file, "bodies")),
        tuple(_read_joint(group) for group in _groups(file, "joints")),
        float(mass),
        SupportInfo(**{f.name: file[f"supports/{f.name}"][()] for f in fields(SupportInfo)}),
        tuple(map(str, attributes.get("strained", ()))),
        int(attributes.get("parts", _NOT_DIVIDED)) or None,
    )
    return Stored(arrays, numbers, info, steps, contacts, friction)


def _read_record(file: Any, name: str, kind: type[Record]) -> Record | None:
    if name not in file:
        return None
    # files of earlier versions have fewer fields
    given = [field.name for field in fields(kind) if field.name in file[name]]
    return kind(**{each: file[name][each][()] for each in given})


def _groups(file: Any, name: str) -> list[Any]:
    if name not in file:
        return []
    return [file[name][str(i)] for i in range(len(file[name]))]


_OF_SOME_BODIES = "outline", "corners", "node_types", "undeformed", "owners"


def _write_body(group: Any, body: BodyInfo) -> None:
    group.attrs.update({"name": body.name, "kind": body.kind, "element": body.element})
    group["nodes"], group["cells"] = body.nodes, body.cells
    group["faces"], group["thickness"] = body.faces, body.thickness
    group["point_names"] = list(body.points) or np.empty(0, dtype="S1")
    group["point_nodes"] = np.array(list(body.points.values()), dtype=np.int64)
    for name in _OF_SOME_BODIES:
        if getattr(body, name) is not None:
            group[name] = getattr(body, name)


def _read_body(group: Any) -> BodyInfo:
    names = [name.decode() for name in group["point_names"][()]]
    given = {name: group[name][()] for name in _OF_SOME_BODIES if name in group}
    if "box" in group:  # of earlier versions, which had edges
        given["corners"] = box_corners(group["box"][()])
    return BodyInfo(
        name=group.attrs["name"],
        kind=group.attrs["kind"],
        element=group.attrs.get("element", ""),
        nodes=group["nodes"][()],
        cells=group["cells"][()],
        faces=group["faces"][()],
        thickness=group["thickness"][()],
        points={n: int(i) for n, i in zip(names, group["point_nodes"][()], strict=True)},
        **given,
    )


def _write_joint(group: Any, joint: JointInfo) -> None:
    group.attrs.update({"name": joint.name, "kind": joint.kind})
    group.attrs.update({"node": joint.node, "first": joint.first})
    group["coordinates"] = list(joint.coordinates) or np.empty(0, dtype="S1")
    group["offset"] = joint.offset
    if joint.axes is not None:
        group["axes"] = joint.axes
        group.attrs["side"] = joint.side


def _read_joint(group: Any) -> JointInfo:
    return JointInfo(
        name=group.attrs["name"],
        kind=group.attrs["kind"],
        node=int(group.attrs["node"]),
        offset=group["offset"][()],
        coordinates=tuple(name.decode() for name in group["coordinates"][()]),
        first=int(group.attrs["first"]),
        side=int(group.attrs.get("side", -1)),
        axes=group["axes"][()] if "axes" in group else None,
    )
