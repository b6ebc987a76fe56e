"""Points of a place and three slopes, held by their sections."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.attachments.at_nodes import on_section
from fem_lie.attachments.attachment import AttachmentFrame
from fem_lie.bodies.beams.sectioned import Sectioned
from fem_lie.bodies.body import Point
from fem_lie.bodies.gradients.axes import follow_sections
from fem_lie.bodies.nodes import Follower
from fem_lie.bodies.points import require_point
from fem_lie.lie.node_types import MIXED_DERIVATIVE, NodeType

_PLACE = np.arange(3)
_TURNED = np.array([0, 2, 3, 4])
"""What turns or shears a section: ``r_y`` along e₁ and e₃, ``r_z`` along e₁ and e₂."""
_AT_A_POINT = np.array([[[1.0, 0, 0], [0, 0, 0]], [[0, 1, 0], [0, 0, 1]]])
"""Place, ``r_y`` and ``r_z`` of a point, in its rows."""


class SectionPoints(Sectioned):
    """A body of points that are two nodes each, one of place and ``r_x``, one of ``r_y``, ``r_z``.

    Attributes:
        points_count: Number of points; their second nodes follow the first ones.
    """

    compound = True
    points_count: int

    @property
    def node_type(self) -> NodeType:
        """Of the nodes that have places."""
        return NodeType.SURFACE_GRADIENT

    @property
    def node_types(self) -> Indices:
        """See the base class."""
        kinds = [int(NodeType.SURFACE_GRADIENT), int(NodeType.MIXED_DERIVATIVE)]
        return np.repeat(kinds, self.points_count).astype(np.int64)

    @property
    def node_lengths(self) -> Flags:
        """No slope is a length, nor are those that others have instead of a place."""
        lengths = super().node_lengths
        lengths[self.node_types == MIXED_DERIVATIVE] = False
        return lengths

    def _named(self, name: str) -> Point:
        """The point with a name, by its section."""
        node = super()._named(name).node
        return Point(self, node, name, self.attachment_of(node))

    def _numbered(self, node: int) -> Point:
        """A point by its number, by its section."""
        point = super()._numbered(node)
        return Point(self, point.node, point.name, self.attachment_of(point.node))

    def attachment_of(self, node: int) -> AttachmentFrame:
        """The frame of the section.

        Args:
            node: Number of the node.
        """
        if node >= self.points_count:
            raise ValueError(
                f"{self.label} has points 0 … {self.points_count - 1}, got {node}: the nodes after "
                "these have no places"
            )
        return on_section((node, node + self.points_count), _AT_A_POINT)

    def clamp(self, *points: Point) -> None:
        """Hold places of points, and their sections but for stretching in their plane.

        The slope along the beam stays free, so that it may be sheared there.

        Args:
            points: Points of the body.

        Raises:
            ValueError: One is not a point of this body.
            TypeError: One is no point.
        """
        for node in self._own(points, "clamp"):
            self.held[node, _PLACE] = True
            self.held[node + self.points_count, _TURNED] = True

    def pin(self, *points: Point) -> None:
        """Hold places of points.

        Args:
            points: Points of the body.

        Raises:
            ValueError: One is not a point of this body.
            TypeError: One is no point.
        """
        for node in self._own(points, "pin"):
            self.held[node, _PLACE] = True

    def unwarped(self) -> Indices:
        """Nodes of slopes whose sections are clamped."""
        clamped = self.held[:, _TURNED].all(axis=1)
        return np.flatnonzero(clamped & (self.node_types == MIXED_DERIVATIVE))

    def follower(self) -> Follower:
        """Axes follow the sections, but where components along them are held."""
        parts = self.held.reshape(2, self.points_count, 2, 3).sum(axis=-1) % 3 > 0
        moves: Flags = ~parts.any(axis=(0, 2))

        def follow(rows: Array) -> None:
            follow_sections(rows, moves)

        return follow

    def _own(self, points: Sequence[Point], what: str) -> list[int]:
        for point in points:
            require_point(point, f"{type(self).__name__}.{what}: a point")
            if point.body is not self or not self.attachment_of(point.node).same(
                point.joint_attachment
            ):
                raise ValueError(f"{self.label} cannot hold {point.label}: it is no node of it")
        return [point.node for point in points]
