"""Axes for the components of contact forces on nodes with vector coordinates."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.lie.node_types import NodeType
from fem_lie.lie.node_types.all_nodes import all_axes


class NodeAxes:
    """Position and axes of nodes of all types, as contact kinematics uses them.

    A contact point at a position-gradient node acts on its position only. The directors of such a
    node are not unit vectors, so they are replaced by the node's axes, which rotate with the
    position gradient.
    """

    def __init__(self, kinds: Indices) -> None:
        """Find the nodes whose directors differ from their axes.

        Args:
            kinds: Type of each node, :class:`~fem_lie.lie.node_types.NodeType`, (n,).
        """
        others = (kinds == NodeType.POSITION_GRADIENT) | (kinds == NodeType.SURFACE_GRADIENT)
        self._nodes = np.flatnonzero(others)
        self._kinds = np.ascontiguousarray(kinds[self._nodes])
        self._is_other = others
        self._is_slope = kinds == NodeType.POSITION_GRADIENT

    def frames(self, H: Array) -> Array:
        """Position and axes of all nodes, shape (n, 4, 3).

        Args:
            H: Nodal coordinates, shape (n, 4, 3).
        """
        if not len(self._nodes):
            return H
        found = H.copy()
        found[self._nodes, 1:] = all_axes(self._kinds, np.ascontiguousarray(H[self._nodes]))
        return found

    def correct(
        self, H: Array, v: Array, columns: Indices, blocks: Array, by_twists: Array
    ) -> None:
        """Correct tangents for nodes whose axes depend on their coordinates.

        The axes of a position-gradient node have the angular velocity ``e₁ × Rᵀẋ'/|x'|``; the axes
        of other nodes with vector coordinates do not rotate. Velocities of these nodes are constant
        when the axes rotate.

        Args:
            H: Nodal coordinates, shape (n, 4, 3).
            v: Twists, shape (n, 6).
            columns: Node of the columns of each block, shape (m,).
            blocks: Derivatives for frames that rotate independently, overwritten, shape (m, 6, 6).
            by_twists: Derivatives in twists, shape (m, 6, 6); (0, 6, 6) for forces that do not
                depend on twists.
        """
        if not len(self._nodes):
            return
        which = np.flatnonzero(self._is_other[columns])
        by_rotation, nodes = blocks[which, :, 3:], columns[which]
        if len(by_twists):
            turned = np.cross(v[nodes, np.newaxis, :3], np.eye(3))
            by_rotation = by_rotation - by_twists[which, :, :3] @ turned
        rates = np.where(self._is_slope[nodes], 1.0 / np.linalg.norm(H[nodes, 1], axis=1), 0.0)[
            :, np.newaxis
        ]
        blocks[which, :, 3] = 0.0
        blocks[which, :, 4] = by_rotation[:, :, 2] * rates
        blocks[which, :, 5] = -by_rotation[:, :, 1] * rates
