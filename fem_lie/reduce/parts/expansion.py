"""Full fields of bodies that moved in few shapes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fem_lie._arrays import Array, Indices, instance
from fem_lie.bodies.catalogue import BodyInfo, SupportInfo
from fem_lie.bodies.reduced.reduced_body import ReducedBody
from fem_lie.results.history import Result
from fem_lie.results.record import Record, with_others


def expand(result: Result, *bodies: ReducedBody) -> Result:
    """The result with the full bodies in the place of reduced ones: fields, stresses, pictures.

    Frames and velocities of all their nodes are those that the shapes make; everything else stays.

    Args:
        result: Of a scene with the bodies; all frames and velocities are recorded.
        bodies: Which; the full ones have the names that they had where they were reduced.

    Raises:
        ValueError: The result has no such body.
    """
    instance(result, Result, "result", "what an integrator has found")
    for body in bodies:
        instance(body, ReducedBody, "a body", "a reduced body")
        result.info.body(body.name)
    reduced = {body.name: body for body in bodies}
    moving = Record.VELOCITIES in result.recorded
    infos: list[BodyInfo] = []
    frames: list[Array] = []
    twists: list[Array] = []
    node_of, at = np.full(1 + result.frames.shape[1], -1), 0  # the last: no node
    for info in result.info.bodies:
        H, few = result.frames[:, info.nodes], reduced.get(info.name)
        v = result.velocities[:, info.nodes] if moving else np.empty((len(H), 0, 6))
        if few is None:
            node_of[info.nodes] = at + np.arange(len(info.nodes))
            infos.append(renumbered(info, node_of))
        else:
            node_of[info.nodes[: len(few.interfaces)]] = at + few.interfaces
            infos.append(BodyInfo.of(few.full, at + np.arange(len(few.full.frames))))
            v = few.expand_twists(H, v) if moving else v
            H = few.expand(H)
        frames.append(H)
        twists.append(v)
        at += H.shape[1]
    joints = tuple(replace(j, node=int(node_of[j.node])) for j in result.info.joints)
    old = result.info.supports
    supports = SupportInfo(node_of[old.at], node_of[old.nodes], old.rows)
    catalogue = replace(result.info, bodies=tuple(infos), joints=joints, supports=supports)
    others = {"frames": np.concatenate(frames, axis=1), "info": catalogue}
    if moving:
        others["velocities"] = np.concatenate(twists, axis=1)
    return with_others(result, others)


def renumbered(info: BodyInfo, node_of: Indices) -> BodyInfo:
    """A body whose nodes have other numbers."""
    points = {name: int(node_of[node]) for name, node in info.points.items()}
    cells, faces = node_of[info.cells], node_of[info.faces]
    return replace(info, nodes=node_of[info.nodes], cells=cells, faces=faces, points=points)
