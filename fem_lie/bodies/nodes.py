"""The nodes of a body: what they are, what holds them, and how they move at first.

What holds rotations of nodes is passed to bodies, which know nothing of joints.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from typing import ClassVar, NamedTuple, TypeAlias

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.attachments.attachment import AttachmentFrame
from fem_lie.lie.node_types import TRAITS, NodeType, all_axes, rigid_motions
from fem_lie.lie.node_types.floating import WithinFrame


class HeldRotation(NamedTuple):
    """Something that takes hold of the rotation of a node.

    Attributes:
        node: Which one.
        other: What holds it, the same for all nodes that are held by the same rigid thing.
        what: Its name for messages.
        axis: The only axis of its moment, if there is but one, global components.
        needed: Whether the node must rotate about all axes for it. A shell of five parameters
            leaves out the moment of a contact about a director.
    """

    node: int
    other: Hashable
    what: str
    axis: Array | None = None
    needed: bool = True


class FoldedElementError(ArithmeticError):
    """An element turns farther than it may."""


@dataclass(frozen=True, eq=False)
class Turning:
    """Along which nodes the elements of a body turn, and how far they may.

    Attributes:
        nodes: Nodes from end to end, shape (w, 2 or 3).
        elements: Number of the element of each of these rows, shape (w,).
        limit: Largest sum of the turns from node to node, rad.
        whole: Whether whole frames turn, or third directors.
        lengths: Unloaded arc length of each row, if its axial strain and shear are to be judged.
    """

    nodes: Indices
    elements: Indices
    limit: float
    whole: bool
    lengths: Array | None = None


_ORTHONORMAL = 1e-8  # as of prescribed motions


def check_nodes(label: str, kinds: Indices, frames: Array, velocities: Array) -> None:
    """Refuse what is no node, and velocities that are none.

    Args:
        label: Of the body, for messages.
        kinds: What its nodes are, shape (n,).
        frames: Their rows, shape (n, 4, 3).
        velocities: Wanted of shape (n, 6).

    Raises:
        ValueError: Axes are not right-handed and orthonormal, or numbers not finite.
    """
    shape, count = velocities.shape, len(frames)
    if shape != (count, 6) or not np.isfinite(velocities).all():
        raise ValueError(
            f"velocities of {label} must be finite and of shape ({count}, 6), got\n{velocities}"
        )
    axes = all_axes(kinds, frames)
    gap = np.abs(axes @ axes.transpose(0, 2, 1) - np.eye(3)).max(axis=(1, 2))
    right = np.linalg.det(axes) > 0.0
    finite = np.isfinite(frames).all(axis=(1, 2))
    bad = np.flatnonzero(~(finite & (gap <= _ORTHONORMAL) & right))
    if len(bad):
        raise ValueError(
            f"frames of {label} must be a place and right-handed orthonormal axes; that of node "
            f"{bad[0]} is\n{frames[bad[0]]}"
        )


Follower: TypeAlias = Callable[[Array], None]
"""Turns the axes of a body's nodes as they have moved, in their rows (n, 4, 3), with
:func:`fem_lie.lie.node_types.set_axes`; it may set rows that nothing depends on, too."""


class Nodes(ABC):
    """Nodes that move, and what differs between those of bodies.

    Attributes:
        frames: Initial frames of the nodes, shape (n, 4, 3), see :mod:`fem_lie.lie`.
        velocities: Initial local velocities (translation, rotation), shape (n, 6).
        masters: The node that each node follows rigidly, itself if it is free, shape (n,).
        held: Which unknowns (translation, rotation) of the nodes are zero, shape (n, 6).
        supports: Axes fixed in space along which ``held`` translations are, nan where they are the
            node's own, shape (n, 3, 3).
        uncoupled: Whether statics moves its nodes, and those that follow them or that they follow,
            by ``x + R u``, ``R exp(η₁, η₂, 0) exp(η₃)``, and not by ``H exp(h)``.
        compound: Whether a point of it is several nodes.
        start_frames: Frames from which solvers go on, if not from ``frames``, where nothing is
            strained; shape (n, 4, 3).
    """

    uncoupled: ClassVar[bool] = False
    compound: ClassVar[bool] = False

    def __init__(self, frames: Array, masters: Indices | None) -> None:
        """Keep copies of the frames; nothing is held, and velocities start at zero."""
        self.frames = np.array(frames, dtype=np.float64)
        count = len(self.frames)
        self.velocities = np.zeros((count, 6))
        self.masters: Indices = np.arange(count) if masters is None else masters
        self.held: Flags = np.zeros((count, 6), dtype=bool)
        self.supports = np.full((count, 3, 3), np.nan)
        self.start_frames: Array | None = None

    @property
    @abstractmethod
    def label(self) -> str:
        """For messages."""

    def cells_of(self, group: str | None = None) -> Indices:
        """Elements of a named group (default: all).

        Raises:
            ValueError: The body has no elements, or no such group.
        """
        raise ValueError(f"{self.label} has no cells to put a load on")

    def consistent_shares(self) -> tuple[Indices, Array]:
        """Nodes of each element, shape (m, k), and the length that each of them carries, (m, k).

        Raises:
            ValueError: The body has no elements.
        """
        raise ValueError(f"{self.label} has no cells to put a load on")

    def consistent_levers(self) -> Array:
        """What a unit line force on each element does on the directors of its nodes, (m, k, 3).

        Raises:
            ValueError: The body has no elements.
        """
        raise ValueError(f"{self.label} has no cells to put a load on")

    @property
    def node_type(self) -> NodeType:
        """What its nodes are."""
        return NodeType.FRAME

    @property
    def node_types(self) -> Indices:
        """What each of them is, shape (n,), where a point is several nodes; default: all alike."""
        return np.full(len(self.frames), int(self.node_type), dtype=np.int64)

    @property
    def node_lengths(self) -> Flags:
        """Which halves of the unknowns of each node are lengths, shape (n, 2).

        The others have no dimension: rotations, slopes. Default: all first ones, no second one.
        """
        return np.tile([True, False], (len(self.frames), 1))

    @property
    def edge_frames(self) -> Indices:
        """Nodes with frames along the edge to another node, and those others, shape (k, 2).

        Such a frame turns about the edge by its own unknown, and with the edge as both nodes move.
        """
        return np.empty((0, 2), dtype=np.int64)

    @property
    def absent(self) -> Flags:
        """Which unknowns its nodes have not, beside those that their kind has not, (n, 6)."""
        return np.zeros((len(self.frames), 6), dtype=bool)

    @property
    def goes_straight(self) -> bool:
        """Whether statics moves its frames, too, by ``x + R u``, ``R exp(η)``.

        The places of its other nodes move along straight lines; what a large rotation would take
        the frame of an end aside is more than the edges beside it are long.
        """
        return False

    def follower(self) -> Follower | None:
        """What turns the axes of its nodes where a state is accepted, if they do not themselves."""
        return None

    def attachment_of(self, node: int) -> AttachmentFrame | None:
        """By what joints hold a node: ``None`` if it has a frame."""
        return None

    @property
    def slackens(self) -> bool:
        """Whether it goes slack, with an energy that is convex all the same."""
        return False

    def within_frame(self) -> WithinFrame | None:
        """Of a body that deforms within one frame, with inertia that nodes do not have each.

        ``None`` of any other body.
        """
        return None

    def drills(self, holds: Sequence[HeldRotation] = ()) -> bool:
        """Whether its nodes turn about their third directors.

        Args:
            holds: What takes hold of their rotations.

        Raises:
            ValueError: They would have to, but cannot.
        """
        return True

    def drilling_given(self, holds: Sequence[HeldRotation]) -> tuple[bool, Array | None]:
        """Whether its nodes drill if these things hold them, and how stiff its cells are then."""
        return self.drills(holds), None

    def check(self) -> None:
        """Raise ``ValueError`` if frames or velocities of nodes have been set to what is none."""
        check_nodes(self.label, self.node_types, self.frames, self.velocities)
        if self.start_frames is None:
            return
        if self.start_frames.shape != self.frames.shape:
            raise ValueError(
                f"{self.label} begins at frames of shape {self.start_frames.shape}, wanted "
                f"{self.frames.shape}"
            )
        check_nodes(self.label, self.node_types, self.start_frames, self.velocities)

    def require_frames(self, what: str) -> None:
        """Refuse what takes hold of frames if the nodes have none.

        Args:
            what: It, for the message.

        Raises:
            ValueError: They have none.
        """
        if self.node_type != NodeType.FRAME:
            raise ValueError(
                f"{what} needs nodes with frames, but those of {self.label} have "
                f"{TRAITS[self.node_type].description}: clamps and joints hold them, and forces "
                "fixed in space act on them"
            )

    def require_direction(self, node: int) -> None:
        """Raise ``ValueError`` if a node has none that a clamp could hold."""
        return

    def turning(self) -> Turning | None:
        """How far its elements may turn from end to end, or ``None`` if it has none."""
        return None

    def add_rigid_motion(self, translation: Array, spin: Array, about: Array) -> None:
        """Add a rigid motion to the initial velocities, global components; ``about`` at rest."""
        self.velocities += rigid_motions(self.node_types, self.frames, about) @ [
            *translation,
            *spin,
        ]
