"""State of all bodies from which a run or statics starts, if it is not the undeformed one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.bodies.body import Body


class InitialState(NamedTuple):
    """State of all bodies from which a run or statics starts.

    Attributes:
        path: Frames of all nodes in the states that led to it, itself the last, (k, N, 4, 3).
        velocities: Velocities of all nodes in it, along their axes, shape (N, 6).
        nodes: Numbers of the nodes of each body in these arrays.
    """

    path: Array
    velocities: Array
    nodes: Mapping[Body, Indices]

    @classmethod
    def of(cls, frames: Array, velocities: Array, bodies: Sequence[Body]) -> InitialState:
        """State of nodes that are numbered body after body.

        Args:
            frames: Frames of all nodes, shape (N, 4, 3).
            velocities: Velocities of all nodes, shape (N, 6).
            bodies: The bodies.

        Raises:
            ValueError: The bodies have another number of nodes.
        """
        ends = np.cumsum([len(body.frames) for body in bodies])
        if len(frames) != ends[-1]:
            raise ValueError(f"expected a start of {ends[-1]} nodes, got one of {len(frames)}")
        pairs = zip(bodies, ends, strict=True)
        nodes = {body: np.arange(end - len(body.frames), end) for body, end in pairs}
        return cls(frames[np.newaxis], velocities, nodes)

    def arrays(self, bodies: Sequence[Body]) -> tuple[Array, Array]:
        """Frames and velocities of the state, numbered body after body, as :meth:`of` takes them.

        Args:
            bodies: The bodies.
        """
        order = np.concatenate([self.nodes[body] for body in bodies])
        return np.asarray(self.path[-1, order]), np.asarray(self.velocities[order])

    def restricted(self, parts: Mapping[Body, tuple[Body, Indices]]) -> InitialState:
        """The state of bodies of which some are divided.

        Args:
            parts: Part of each divided body, and the numbers of its nodes in the body.
        """
        divided = {part: self.nodes[body][own] for body, (part, own) in parts.items()}
        return self._replace(nodes={**self.nodes, **divided})
