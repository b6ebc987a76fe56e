"""Reduced bodies in files: a library of parts."""

from __future__ import annotations

import os

import numpy as np

from fem_lie._arrays import Array, instance
from fem_lie.bodies.body import Body
from fem_lie.bodies.reduced.reduced_body import ReducedBody

_FORMAT, _VERSION = "fem_lie reduced body", 1
_SAME = 1e-9  # of the body's size
_ARRAYS = ("interfaces", "stiffness", "density", "shapes")


def save_reduced(body: ReducedBody, path: str | os.PathLike[str]) -> None:
    """Write an HDF5 file with a reduced body and the mesh that it was made of.

    Raises:
        OSError: It cannot be written.
    """
    import h5py

    instance(body, ReducedBody, "body", "a reduced body")
    with h5py.File(path, "w") as file:
        file.attrs.update({"format": _FORMAT, "version": _VERSION, "name": body.name})
        for name in _ARRAYS:
            file[name] = getattr(body, name)
        file["frames"] = body.full.frames
        file["points"] = [f"{node} {name}" for name, node in body.point_names.items()]


def load_reduced(path: str | os.PathLike[str], full: Body, *, name: str = "") -> ReducedBody:
    """A reduced body from a file of :func:`save_reduced`, for any scene.

    Args:
        path: Of the file.
        full: The body that it was made of, with the same mesh at the same place; nothing of it is
            solved again.
        name: Of the reduced body; default: that which it had.

    Raises:
        ValueError: The file has no reduced body, one of another version, or of another mesh.
        OSError: It cannot be read.
    """
    import h5py

    instance(full, Body, "full", "a body")
    with h5py.File(path, "r") as file:
        if file.attrs.get("format") != _FORMAT:
            raise ValueError(f"{os.fspath(path)} has no reduced body")
        if file.attrs["version"] != _VERSION:
            raise ValueError(
                f"{os.fspath(path)} has version {file.attrs['version']} of the format, wanted "
                f"{_VERSION}: make it anew"
            )
        interfaces, stiffness, density, shapes = (file[each][()] for each in _ARRAYS)
        frames, told = file["frames"][()], [each.decode() for each in file["points"][()]]
        label = name or str(file.attrs["name"])
    _check(path, frames, full)
    pairs = (each.split(" ", 1) for each in told)
    points = {point: int(node) for node, point in pairs}
    return ReducedBody(interfaces, stiffness, density, shapes, full, points=points, name=label)


def _check(path: str | os.PathLike[str], frames: Array, full: Body) -> None:
    """Refuse another mesh."""
    if frames.shape != full.frames.shape:
        raise ValueError(
            f"{os.fspath(path)} is of another mesh: {len(frames)} nodes, and {full.label} has "
            f"{len(full.frames)}"
        )
    if np.abs(frames - full.frames).max() > _SAME * max(1.0, full.size):
        raise ValueError(f"{os.fspath(path)} is of another mesh: its nodes are elsewhere")
