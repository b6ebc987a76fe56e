"""What takes hold of rotations of nodes: told to bodies, which know nothing of joints."""

from __future__ import annotations

from collections.abc import Hashable
from typing import NamedTuple

from fem_lie._arrays import Array


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
