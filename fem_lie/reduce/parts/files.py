"""Reduced bodies in files: a library of parts."""

from __future__ import annotations

import os

from fem_lie._arrays import instance
from fem_lie.bodies.body import Body
from fem_lie.bodies.reduced.reduced_body import ReducedBody
from fem_lie.reduce.files import check_mesh, write_mesh

_WHAT = "reduced body"
_ARRAYS = ("interfaces", "stiffness", "density", "shapes", "quadratic")


def save_reduced(body: ReducedBody, path: str | os.PathLike[str]) -> None:
    """Write an HDF5 file with a reduced body and the mesh that it was made of.

    Raises:
        OSError: It cannot be written.
    """
    import h5py

    instance(body, ReducedBody, "body", "a reduced body")
    with h5py.File(path, "w") as file:
        write_mesh(file, _WHAT, body.full)
        file.attrs["name"] = body.name
        for name in _ARRAYS:
            file[name] = getattr(body, name)
        file["points"] = [f"{node} {name}" for name, node in body.point_names.items()]


def load_reduced(path: str | os.PathLike[str], full: Body, *, name: str = "") -> ReducedBody:
    """A reduced body from a file of :func:`save_reduced`, for any scene.

    Args:
        path: Of the file.
        full: The body that it was made of, or one with the same mesh anywhere else: shapes know no
            place. Nothing of it is solved again.
        name: Of the reduced body; default: that which it had.

    Raises:
        ValueError: The file has no reduced body, one of another version, or of another mesh.
        OSError: It cannot be read.
    """
    import h5py

    instance(full, Body, "full", "a body")
    with h5py.File(path, "r") as file:
        check_mesh(file, path, _WHAT, full)
        nodes, *matrices, quadratic = [file[each][()] for each in _ARRAYS]
        told = [each.decode() for each in file["points"][()]]
        label = name or str(file.attrs["name"])
    pairs = (each.split(" ", 1) for each in told)
    points = {point: int(node) for node, point in pairs}
    stiffness, density, shapes = matrices
    return ReducedBody(
        nodes, stiffness, density, shapes, full, points=points, quadratic=quadratic, name=label
    )
