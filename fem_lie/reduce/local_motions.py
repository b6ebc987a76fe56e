"""What is left of a motion when its rigid part is taken out, as increments in nodal frames."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, instance
from fem_lie.bodies.body import Body
from fem_lie.lie.kinds import NodeKind
from fem_lie.reduce.axes import Axes
from fem_lie.results.states import StateSeries


class LocalMotion(NamedTuple):
    """Motion of a body as ``Hᵢ = G Hᵢ⁰ exp(hᵢ)``.

    Attributes:
        rigid: ``G``, shape (k, 4, 3).
        increments: ``h``: translation, rotation in the nodes' initial frames, shape (k, n, 6).
    """

    rigid: Array
    increments: Array


def frames_of(result: StateSeries, body: Body) -> Array:
    """Frames of a body's nodes in all states of a result, shape (k, n, 4, 3).

    Raises:
        ValueError: The result has no such body, or one with another mesh, or its nodes are no
            frames.
    """
    instance(result, StateSeries, "result", "states that an integrator or statics has found")
    instance(body, Body, "body", "a body of the scene")
    if body.node_kind != NodeKind.FRAME:
        raise ValueError(f"local motion is that of frames, and nodes of {body.label} are none")
    nodes = result.info.body(body.name).nodes
    if len(nodes) != len(body.frames):
        raise ValueError(
            f"{body.label} has {len(body.frames)} nodes, and in the result {len(nodes)}: that is "
            "of another mesh"
        )
    return np.asarray(result.frames[:, nodes])


def local_motion(body: Body, frames: Array, axes: Axes) -> LocalMotion:
    """Take the rigid motion out of frames (k, n, 4, 3) of a body's nodes."""
    G = axes.motion(body, frames)
    back = lie.se3_compose(lie.se3_inverse(G)[:, np.newaxis], frames)
    relative = lie.se3_compose(lie.se3_inverse(body.frames), back)
    if body.uncoupled:
        relative[:, :, 1:] = _tilted(relative[:, :, 3])
    return LocalMotion(G, np.asarray(lie.se3_log(relative)))


def expanded(body: Body, motion: LocalMotion) -> Array:
    """Frames of all nodes, shape (k, n, 4, 3)."""
    moved = lie.se3_retract(body.frames, motion.increments)
    return np.asarray(lie.se3_compose(motion.rigid[:, np.newaxis], moved))


def _tilted(third: Array) -> Array:
    """Directors, (…, 3, 3) as rows, of the smallest rotation of the third axis to ``third``."""
    tilt = np.cross((0.0, 0.0, 1.0), third)
    hat = lie.hat(tilt)
    factor = 1.0 / (1.0 + third[..., 2, np.newaxis, np.newaxis])
    return np.swapaxes(np.eye(3) + hat + factor * hat @ hat, -1, -2)
