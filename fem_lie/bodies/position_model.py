"""What bodies with positions as nodes share, and their models: supports of named sets."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, direction
from fem_lie.bodies.body import Body, Point
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


class PositionBody(Body):
    """Body whose nodes have positions only, with supports of named sets."""

    model: PositionModel

    def clamp(self, name: str) -> list[Point]:
        """Hold all nodes of a named face, curve, point or group of cells.

        Args:
            name: Name of a face, curve, point or group of cells.

        Returns:
            Held points, for :meth:`fem_lie.Result.reaction`.

        Raises:
            ValueError: There is no such set; the message lists what exists.
        """
        self.model.held[self.nodes(name), :3] = True
        return self.points(name)

    def roller(self, name: str, normal: npt.ArrayLike) -> list[Point]:
        """Hold displacements along a direction fixed in space, as on a plane of symmetry.

        Nodal axes are rotated so that one is that direction, and do not rotate any more.
        Constraints of earlier calls remain.

        Args:
            name: A named face, curve, point or group of cells.
            normal: The direction, global components.

        Returns:
            Held points, for :meth:`fem_lie.Result.reaction`.

        Raises:
            ValueError: There is no such set, or the direction is zero.
        """
        n = direction(normal, f"the direction of roller {name!r}")
        for node in self.nodes(name):
            self.model.hold_along(int(node), n)
        return self.points(name)


def _perpendicular(known: Array) -> Array:
    """Unit vectors perpendicular to ``known`` (k, 3), which is orthonormal, shape (3 − k, 3)."""
    return np.asarray(np.linalg.svd(known)[2][len(known) :])
