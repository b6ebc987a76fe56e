"""Results in an HDF5 file: one data set for each array, one group for each body and joint."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np

from fem_lie._arrays import Array
from fem_lie.bodies.catalogue import BodyInfo, JointInfo, SceneInfo, SupportInfo
from fem_lie.results.rows import write_all
from fem_lie.results.steps import ContactSteps, StepHistory

Record = TypeVar("Record", StepHistory, ContactSteps)

_FORMAT, _VERSION = "fem_lie results", 10
NUMBERS = ("factorisations", "k_updates", "phi_updates", "divided", "seconds")
"""What a result says of the work, the last in seconds."""


class Stored(NamedTuple):
    """What is in a file.

    Attributes:
        arrays: By their names in :class:`~fem_lie.Result`, one row for each time.
        numbers: Those of :data:`NUMBERS`.
        info: Bodies and joints.
        steps: The steps that were made, if they changed.
        contacts: What contacts by impacts did in each step, if there are any.
    """

    arrays: dict[str, Array]
    numbers: dict[str, float]
    info: SceneInfo
    steps: StepHistory | None
    contacts: ContactSteps | None


def write(path: str | os.PathLike[str], result: Stored) -> None:
    """Write a file that appears under its name only when it is whole."""
    import h5py

    target = Path(path)
    # made in memory: a library that cannot write to a full disk ends the process
    with h5py.File(target.name, "w", driver="core", backing_store=False) as file:
        file.attrs.update({"format": _FORMAT, "version": _VERSION})
        for name, values in result.arrays.items():
            file[name] = values
        for name in NUMBERS:
            file.attrs[name] = result.numbers[name]
        for group, record in (("steps", result.steps), ("contacts", result.contacts)):
            if record is not None:
                for field in fields(record):
                    file[f"{group}/{field.name}"] = getattr(record, field.name)
        _write_info(file, result.info)
        file.flush()
        image = file.id.get_file_image()
    unfinished = target.with_name(f".{target.name}.{os.getpid()}.part")
    try:
        with unfinished.open("wb", buffering=0) as place:
            write_all(place.fileno(), image, 0)
            os.fsync(place.fileno())
        os.replace(unfinished, target)
    except OSError as error:
        raise OSError(error.errno, error.strerror, str(target)) from error
    finally:
        unfinished.unlink(missing_ok=True)


def create(path: Path, info: SceneInfo, shapes: Mapping[str, tuple[int, ...]], rows: int) -> None:
    """Write a file with room for rows of arrays, see :mod:`fem_lie.results.rows`.

    Args:
        path: Of the file.
        info: Bodies and joints.
        shapes: Of a row of each array.
        rows: How many of each there will be at most.
    """
    import h5py

    kinds = dict.fromkeys(shapes, np.dtype(np.float64)) | {"iterations": np.dtype(np.int64)}
    unfinished = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        with h5py.File(unfinished, "w") as file:
            file.attrs.update({"format": _FORMAT, "version": _VERSION})
            for name in NUMBERS:
                file.attrs[name] = 0.0
            properties = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
            properties.set_alloc_time(h5py.h5d.ALLOC_TIME_EARLY)
            whole = {name: (rows, *shape) for name, shape in shapes.items()}
            for name, shape in (*whole.items(), ("rows", (1,))):
                kind = h5py.h5t.py_create(kinds.get(name, np.dtype(np.int64)), logical=True)
                space = h5py.h5s.create_simple(shape)
                h5py.h5d.create(file.id, name.encode(), kind, space, properties)
            _write_info(file, info)
        os.replace(unfinished, path)
    finally:
        unfinished.unlink(missing_ok=True)


def finish(path: Path, numbers: dict[str, float]) -> None:
    """Set factorisations and seconds of a file made by :func:`create`, where they are."""
    import h5py

    with h5py.File(path, "r+") as file:
        for name in NUMBERS:
            file.attrs.modify(name, float(numbers[name]))


def add_contacts(path: Path, contacts: ContactSteps) -> None:
    """Put what contacts did into a file made by :func:`create`."""
    import h5py

    with h5py.File(path, "r+") as file:
        if "contacts" in file:
            del file["contacts"]
        for field in fields(contacts):
            file[f"contacts/{field.name}"] = getattr(contacts, field.name)


def _write_info(file: Any, info: SceneInfo) -> None:
    file.attrs["mass"] = info.mass
    for i, body in enumerate(info.bodies):
        _write_body(file.create_group(f"bodies/{i}"), body)
    for i, joint in enumerate(info.joints):
        _write_joint(file.create_group(f"joints/{i}"), joint)
    for field in fields(SupportInfo):
        file[f"supports/{field.name}"] = getattr(info.supports, field.name)


def read(path: str | os.PathLike[str], names: Sequence[str]) -> Stored:
    """Read arrays of these names, and all else that :func:`write` wrote.

    For errors see :meth:`fem_lie.Result.load`.
    """
    import h5py

    source = Path(path)
    if not source.is_file():
        raise FileNotFoundError(f"no file of results {str(source)!r}")
    if not h5py.is_hdf5(source):
        raise ValueError(f"{str(source)!r} is not a file of results (not HDF5)")
    try:
        with h5py.File(source, "r") as file:
            _check_format(file, source)
            return _read(file, names)
    except (OSError, KeyError) as error:
        raise ValueError(f"{str(source)!r} is damaged: {error}") from error


def _check_format(file: Any, source: Path) -> None:
    given = file.attrs.get("format"), file.attrs.get("version")
    if given != (_FORMAT, _VERSION):
        raise ValueError(
            f"{str(source)!r} is not a file of results of version {_VERSION}: "
            f"format {given[0]!r}, version {given[1]}"
        )


def _read(file: Any, names: Sequence[str]) -> Stored:
    steps = _read_record(file, "steps", StepHistory)
    contacts = _read_record(file, "contacts", ContactSteps)
    rows = slice(int(file["rows"][0]) if "rows" in file else None)
    arrays = {name: file[name][rows] for name in names if name in file}
    *counts, seconds = NUMBERS
    numbers: dict[str, float] = {name: int(file.attrs[name]) for name in counts}
    info = SceneInfo(
        tuple(_read_body(group) for group in _groups(file, "bodies")),
        tuple(_read_joint(group) for group in _groups(file, "joints")),
        float(file.attrs["mass"]),
        SupportInfo(**{f.name: file[f"supports/{f.name}"][()] for f in fields(SupportInfo)}),
    )
    return Stored(arrays, numbers | {seconds: float(file.attrs[seconds])}, info, steps, contacts)


def _read_record(file: Any, name: str, kind: type[Record]) -> Record | None:
    if name not in file:
        return None
    return kind(**{field.name: file[name][field.name][()] for field in fields(kind)})


def _groups(file: Any, name: str) -> list[Any]:
    if name not in file:
        return []
    return [file[name][str(i)] for i in range(len(file[name]))]


def _write_body(group: Any, body: BodyInfo) -> None:
    group.attrs.update({"name": body.name, "kind": body.kind})
    group["nodes"], group["cells"] = body.nodes, body.cells
    group["faces"], group["thickness"] = body.faces, body.thickness
    group["point_names"] = list(body.points) or np.empty(0, dtype="S1")
    group["point_nodes"] = np.array(list(body.points.values()), dtype=np.int64)
    for name in ("outline", "box", "node_kinds"):
        if getattr(body, name) is not None:
            group[name] = getattr(body, name)


def _read_body(group: Any) -> BodyInfo:
    names = [name.decode() for name in group["point_names"][()]]
    return BodyInfo(
        name=group.attrs["name"],
        kind=group.attrs["kind"],
        nodes=group["nodes"][()],
        cells=group["cells"][()],
        faces=group["faces"][()],
        thickness=group["thickness"][()],
        outline=group["outline"][()] if "outline" in group else None,
        box=group["box"][()] if "box" in group else None,
        node_kinds=group["node_kinds"][()] if "node_kinds" in group else None,
        points={n: int(i) for n, i in zip(names, group["point_nodes"][()], strict=True)},
    )


def _write_joint(group: Any, joint: JointInfo) -> None:
    group.attrs.update({"name": joint.name, "kind": joint.kind})
    group.attrs.update({"node": joint.node, "first": joint.first})
    group["coordinates"] = list(joint.coordinates) or np.empty(0, dtype="S1")
    group["offset"] = joint.offset


def _read_joint(group: Any) -> JointInfo:
    return JointInfo(
        name=group.attrs["name"],
        kind=group.attrs["kind"],
        node=int(group.attrs["node"]),
        offset=group["offset"][()],
        coordinates=tuple(name.decode() for name in group["coordinates"][()]),
        first=int(group.attrs["first"]),
    )
