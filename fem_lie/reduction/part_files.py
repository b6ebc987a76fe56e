"""Files of reduced-order bodies, and recovery of the full motion."""

from __future__ import annotations

import os
from dataclasses import replace

import numpy as np

from fem_lie._arrays import Array, Indices, instance
from fem_lie.bodies.body import Body
from fem_lie.bodies.catalogue import BodyInfo, SupportInfo
from fem_lie.bodies.reduced.reduced_body import ReducedOrderBody
from fem_lie.reduction.basis import check_mesh, write_mesh
from fem_lie.results.history import Result
from fem_lie.results.record import Record, with_others

_WHAT = "reduced body"
_ARRAYS = ("interfaces", "stiffness", "density", "modes", "quadratic")


def save_reduced(body: ReducedOrderBody, path: str | os.PathLike[str]) -> None:
    """Write an HDF5 file with a reduced-order body and the mesh of the full body.

    Args:
        body: The reduced-order body.
        path: The HDF5 file.

    Raises:
        OSError: The file cannot be written.
    """
    import h5py

    instance(body, ReducedOrderBody, "body", "a reduced body")
    with h5py.File(path, "w") as file:
        write_mesh(file, _WHAT, body.model.full)
        file.attrs["name"] = body.name
        for name in _ARRAYS:
            file[name] = getattr(body.model, name)
        file["points"] = [f"{node} {name}" for name, node in body.model.point_names.items()]


def load_reduced(path: str | os.PathLike[str], full: Body, *, name: str = "") -> ReducedOrderBody:
    """A reduced-order body from a file of :func:`save_reduced`, for any scene.

    Args:
        path: The HDF5 file.
        full: The full body, or one with the same mesh anywhere else: modes do not depend on the
            position. It is not solved again.
        name: Name of the reduced-order body; default: its original name.

    Raises:
        ValueError: The file has no reduced-order body, or one of another version or mesh.
        OSError: The file cannot be read.
    """
    import h5py

    instance(full, Body, "full", "a body")
    with h5py.File(path, "r") as file:
        check_mesh(file, path, _WHAT, full)
        nodes, *matrices, quadratic = [file[each][()] for each in _ARRAYS]
        names = [each.decode() for each in file["points"][()]]
        label = name or str(file.attrs["name"])
    pairs = (each.split(" ", 1) for each in names)
    points = {point: int(node) for node, point in pairs}
    stiffness, density, modes = matrices
    return ReducedOrderBody(
        nodes, stiffness, density, modes, full, points=points, quadratic=quadratic, name=label
    )


def recover_full_motion(result: Result, *bodies: ReducedOrderBody) -> Result:
    """The result with full bodies instead of reduced-order ones: for fields, stresses, pictures.

    Frames and velocities of all nodes follow from the modes; everything else is unchanged.

    Args:
        result: Result of a scene with the bodies, with all frames and velocities recorded.
        bodies: The reduced-order bodies; the full ones have their original names.

    Raises:
        ValueError: The result has no such body.
    """
    instance(result, Result, "result", "what an integrator has found")
    for body in bodies:
        instance(body, ReducedOrderBody, "a body", "a reduced body")
        result.info.body(body.name)
    reduced = {body.name: body for body in bodies}
    moving = Record.VELOCITIES in result.recorded
    infos: list[BodyInfo] = []
    frames: list[Array] = []
    twists: list[Array] = []
    node_of, at = np.full(1 + result.frames.shape[1], -1), 0  # the last entry: no node
    for info in result.info.bodies:
        H, few = result.frames[:, info.nodes], reduced.get(info.name)
        v = result.velocities[:, info.nodes] if moving else np.empty((len(H), 0, 6))
        if few is None:
            node_of[info.nodes] = at + np.arange(len(info.nodes))
            infos.append(renumbered(info, node_of))
        else:
            node_of[info.nodes[: len(few.model.interfaces)]] = at + few.model.interfaces
            infos.append(BodyInfo.of(few.model.full, at + np.arange(len(few.model.full.frames))))
            v = few.model.expand_twists(H, v) if moving else v
            H = few.model.expand(H)
        frames.append(H)
        twists.append(v)
        at += H.shape[1]
    joints = tuple(joint.renumbered(node_of) for joint in result.info.joints)
    old = result.info.supports
    supports = SupportInfo(node_of[old.at], node_of[old.nodes], old.rows)
    catalogue = replace(result.info, bodies=tuple(infos), joints=joints, supports=supports)
    others = {"frames": np.concatenate(frames, axis=1), "info": catalogue}
    if moving:
        others |= {"velocities": np.concatenate(twists, axis=1), "gradient_velocities": None}
    return with_others(result, others)


def renumbered(info: BodyInfo, node_of: Indices) -> BodyInfo:
    """A body with other node numbers."""
    points = {name: int(node_of[node]) for name, node in info.points.items()}
    cells, faces = node_of[info.cells], node_of[info.faces]
    return replace(info, nodes=node_of[info.nodes], cells=cells, faces=faces, points=points)
