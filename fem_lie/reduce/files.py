"""The mesh of a body in files of what was made of it, and checks of both."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import numpy as np

from fem_lie import lie
from fem_lie.bodies.body import Body

if TYPE_CHECKING:
    import h5py

VERSION = 2
_SAME = 1e-9  # of the body's size


def write_mesh(file: h5py.File, what: str, body: Body) -> None:
    """Write what the file has, such as ``basis``, its version, and the body's nodes and cells."""
    file.attrs.update({"format": f"fem_lie {what}", "version": VERSION})
    file["frames"], file["cells"] = body.frames, body.cells


def check_mesh(file: h5py.File, path: str | os.PathLike[str], what: str, body: Body) -> None:
    """Refuse a file that is not of this body; where the body is does not matter.

    Raises:
        ValueError: It has something else, or another version of it, or another mesh.
    """
    name = os.fspath(path)
    if file.attrs.get("format") != f"fem_lie {what}":
        raise ValueError(f"{name} has no {what}")
    if file.attrs["version"] != VERSION:
        raise ValueError(
            f"{name} has version {file.attrs['version']} of the format, wanted {VERSION}: make it "
            "anew"
        )
    frames, cells = file["frames"][()], file["cells"][()]
    if frames.shape != body.frames.shape or not np.array_equal(cells, body.cells):
        raise ValueError(
            f"{name} is of another mesh: {len(frames)} nodes and {len(cells)} cells, and "
            f"{body.label} has {len(body.frames)} and {len(body.cells)}"
        )
    here, there = (lie.se3_compose(lie.se3_inverse(H[0]), H) for H in (body.frames, frames))
    if np.abs(here - there).max() > _SAME * max(1.0, body.size):
        raise ValueError(f"{name} is of another mesh: its nodes are elsewhere in the body")
