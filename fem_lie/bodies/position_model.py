"""What models of bodies with positions as nodes share: supports along directions."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array
from fem_lie.bodies.model import BodyModel
from fem_lie.lie.node_types import NodeType

_SAME = 1e-9  # sine, as of directions that are meant to be equal


class PositionModel(BodyModel):
    """Model of a body whose nodes have positions only; axes are those of their unknowns."""

    @property
    def node_type(self) -> NodeType:
        """Nodes with positions only."""
        return NodeType.POSITION

    def hold_along(self, node: int, along: Array) -> None:
        """Hold one more translation of a node, whose axes are rotated if none is along it.

        Args:
            node: Number of the node.
            along: Unit vector, global components, shape (3,).
        """
        held, axes = self.held[node, :3], self.frames[node, 1:]
        before = axes[held]
        rest = along - before.T @ (before @ along)
        size = np.linalg.norm(rest)
        if size <= _SAME:
            return
        rest /= size
        free = axes[~held]
        match = np.abs(free @ rest)
        if match.max() < 1.0 - _SAME:
            free = _perpendicular(np.vstack([before, rest]))
            known = np.vstack([before, rest])
            turned = np.vstack([known, free])
            turned[2] *= np.sign(np.linalg.det(turned))
            velocity = axes.T @ self.velocities[node, :3]
            self.frames[node, 1:] = turned
            self.velocities[node, :3] = turned @ velocity
            held[:] = np.arange(3) < len(known)
            return
        held[np.flatnonzero(~held)[match.argmax()]] = True


def _perpendicular(known: Array) -> Array:
    """Unit vectors perpendicular to ``known`` (k, 3), which is orthonormal, shape (3 − k, 3)."""
    return np.asarray(np.linalg.svd(known)[2][len(known) :])
