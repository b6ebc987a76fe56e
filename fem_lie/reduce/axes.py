"""The frame of a body that deforms, and its motion without that of the frame."""

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
    """Which frame moves with a body."""

    def motion(self, body: Body, frames: Array) -> Array:
        """The rigid motion ``G`` of the body away from its initial frames, shape (k, 4, 3).

        Args:
            body: Whose nodes they are.
            frames: Of its nodes in k states, shape (k, n, 4, 3).
        """
        ...


@dataclass(frozen=True)
class MeanAxes:
    """Mean axes: of all rigid motions the one that is nearest to places and directors.

    ``Σ |xᵢ − G Xᵢ|² + ℓ² |dᵢ − G Dᵢ|²`` is least, with the body's radius of gyration ``ℓ``: all
    nodes count alike, and a straight line has a rotation about itself, too.
    """

    def motion(self, body: Body, frames: Array) -> Array:
        """See the protocol."""
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
    """No rigid motion is taken out: for a body that clamps hold."""

    def motion(self, body: Body, frames: Array) -> Array:
        """See the protocol."""
        return np.asarray(lie.se3_exp(np.zeros((len(frames), 6))))


@dataclass(frozen=True)
class NodeAxes:
    """The frame of one node, such as that of a joint, moves with the body.

    Attributes:
        node: Its number in the body.
    """

    node: int = 0

    def __post_init__(self) -> None:
        """Raise ``ValueError`` or ``TypeError`` if it is no number of a node."""
        whole(self.node, "NodeAxes: node", 0)

    def motion(self, body: Body, frames: Array) -> Array:
        """See the protocol; ``ValueError`` if the body has no such node."""
        if body.uncoupled:
            raise ValueError(
                f"nodes of {body.label} need not turn about their third directors, and have no "
                "axes for the whole body: take MeanAxes()"
            )
        start = body.point(self.node).frame
        return np.asarray(lie.se3_compose(frames[:, self.node], lie.se3_inverse(start)))


def directors(body: Body) -> list[int]:
    """Rows of frames that follow the body's rigid motion: of shells the third director alone."""
    return [3] if body.uncoupled else [1, 2, 3]


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
    if body.node_type != NodeType.FRAME:
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
