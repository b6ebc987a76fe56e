"""Floating frames of deformable bodies, and the motion of a body relative to its floating frame."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, instance, whole
from fem_lie.bodies.body import Body
from fem_lie.lie.node_types import NodeType
from fem_lie.results.states import StateSeries


class Axes(Protocol):
    """Choice of the floating frame of a body."""

    def motion(self, body: Body, frames: Array) -> Array:
        """The rigid motion ``G`` of the body from its initial configuration, shape (k, 4, 3).

        Args:
            body: The body.
            frames: Frames of its nodes in k states, shape (k, n, 4, 3).
        """
        ...


@dataclass(frozen=True)
class MeanAxes:
    """Mean axes: the rigid motion closest to positions and directors of all nodes.

    It minimises ``Σ |xᵢ − G Xᵢ|² + ℓ² |dᵢ − G Dᵢ|²`` with the body's radius of gyration ``ℓ``. All
    nodes have the same weight, and a straight line has a rotation about its own axis, too.
    """

    def motion(self, body: Body, frames: Array) -> Array:
        """Mean rigid motion, shape (k, 4, 3).

        Args:
            body: A body of the scene.
            frames: Nodal frames, shape (n, 4, 3).
        """
        initial = body.frames
        start, now = initial[:, 0].mean(axis=0), frames[:, :, 0].mean(axis=1)
        arms = initial[:, 0] - start
        weight = float(np.einsum("ni,ni->n", arms, arms).mean())
        known = directors(body)
        pairs = np.einsum("kni,nj->kij", frames[:, :, 0] - now[:, np.newaxis], arms)
        pairs += weight * np.einsum("kndi,ndj->kij", frames[:, :, known], initial[:, known])
        left, _, right = np.linalg.svd(pairs)
        turned = np.tile(np.eye(3), (len(frames), 1, 1))
        turned[:, 2, 2] = np.sign(np.linalg.det(left @ right))
        R = left @ turned @ right
        return np.asarray(lie.frame(now - R @ start, R))


@dataclass(frozen=True)
class FixedAxes:
    """The initial axes: no rigid motion is separated; for a clamped body."""

    def motion(self, body: Body, frames: Array) -> Array:
        """Identity, shape (k, 4, 3).

        Args:
            body: A body of the scene.
            frames: Nodal frames, shape (n, 4, 3).
        """
        return np.asarray(lie.se3_exp(np.zeros((len(frames), 6))))


@dataclass(frozen=True)
class NodeAxes:
    """The frame of one node, such as that of a joint, is the floating frame.

    Attributes:
        node: Number of the node in the body.
    """

    node: int = 0

    def __post_init__(self) -> None:
        """Raise ``ValueError`` or ``TypeError`` if ``node`` is not the number of a node."""
        whole(self.node, "NodeAxes: node", 0)

    def motion(self, body: Body, frames: Array) -> Array:
        """Rigid motion of the node, (k, 4, 3); ``ValueError`` if the body has no such node.

        Args:
            body: A body of the scene.
            frames: Nodal frames, shape (n, 4, 3).
        """
        if body.model.separates_director:
            raise ValueError(
                f"nodes of {body.label} have no drilling rotation, so their frames are no floating "
                "frame: use MeanAxes()"
            )
        start = body.point(self.node).frame
        return np.asarray(lie.se3_compose(frames[:, self.node], lie.se3_inverse(start)))


def directors(body: Body) -> list[int]:
    """Rows of frames that follow the rigid motion: for shells only the third director."""
    return [3] if body.model.separates_director else [1, 2, 3]


class LocalMotion(NamedTuple):
    """Motion of a body as ``Hᵢ = G Hᵢ⁰ exp(hᵢ)``.

    Attributes:
        rigid: Rigid motion ``G`` of the floating frame, shape (k, 4, 3).
        increments: ``h``: translation and rotation in the nodes' initial frames, shape (k, n, 6).
    """

    rigid: Array
    increments: Array


def frames_of(result: StateSeries, body: Body) -> Array:
    """Frames of a body's nodes in all states of a result, shape (k, n, 4, 3).

    Raises:
        ValueError: The result has no such body, or one with another mesh, or its nodes have no
            frames.
    """
    instance(result, StateSeries, "result", "a result of dynamics or statics")
    instance(body, Body, "body", "a body of the scene")
    if body.model.node_type != NodeType.FRAME:
        raise ValueError(
            f"local motion needs nodes with frames, and nodes of {body.label} have none"
        )
    nodes = result.info.body(body.name).nodes
    if len(nodes) != len(body.frames):
        raise ValueError(
            f"{body.label} has {len(body.frames)} nodes, and {len(nodes)} in the result, which "
            "has another mesh"
        )
    return np.asarray(result.frames[:, nodes])


def local_motion(body: Body, frames: Array, axes: Axes) -> LocalMotion:
    """Separate frames (k, n, 4, 3) of a body's nodes into rigid and local motion."""
    G = axes.motion(body, frames)
    back = lie.se3_compose(lie.se3_inverse(G)[:, np.newaxis], frames)
    relative = lie.se3_compose(lie.se3_inverse(body.frames), back)
    if body.model.separates_director:
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
