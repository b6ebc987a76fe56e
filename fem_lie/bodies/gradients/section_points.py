"""Points with a position and three position gradients, on which joints act by their sections."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.attachments.at_nodes import on_section
from fem_lie.attachments.attachment import AttachmentFrame
from fem_lie.bodies.beams.sectioned import SectionedModel
from fem_lie.bodies.body import Body, Point
from fem_lie.bodies.gradients.axes import rotate_section_axes
from fem_lie.bodies.model import AxesUpdate, MaterialPoint
from fem_lie.bodies.points import require_point
from fem_lie.lie.node_types import MIXED_DERIVATIVE, NodeType

_PLACE = np.arange(3)
_TURNED = np.array([0, 2, 3, 4])
"""Rotation and shear of a section: ``r_y`` along e₁ and e₃, ``r_z`` along e₁ and e₂."""
_AT_A_POINT = np.array([[[1.0, 0, 0], [0, 0, 0]], [[0, 1, 0], [0, 0, 1]]])
"""Weights of position, ``r_y`` and ``r_z`` in the coordinates of a point."""


class SectionPointsModel(SectionedModel):
    """Model of points of two nodes: one with position and ``r_x``, one with ``r_y`` and ``r_z``.

    Attributes:
        points_count: Number of points; their second nodes come after all first nodes.
    """

    has_paired_nodes = True
    points_count: int

    @property
    def node_type(self) -> NodeType:
        """Type of the nodes with positions."""
        return NodeType.SURFACE_GRADIENT

    @property
    def node_types(self) -> Indices:
        """Type of each node, shape (n,)."""
        kinds = [int(NodeType.SURFACE_GRADIENT), int(NodeType.MIXED_DERIVATIVE)]
        return np.repeat(kinds, self.points_count).astype(np.int64)

    @property
    def node_lengths(self) -> Flags:
        """Mask of vector unknowns that are lengths: only positions, shape (n, 2)."""
        lengths = super().node_lengths
        lengths[self.node_types == MIXED_DERIVATIVE] = False
        return lengths

    def named(self, name: str) -> MaterialPoint:
        """Material point with a name, with the attachment frame of its section.

        Args:
            name: Name of the point.
        """
        node = super().named(name).node
        return MaterialPoint(node, name, self.attachment_of(node))

    def numbered(self, node: int) -> MaterialPoint:
        """Material point with a number, with the attachment frame of its section.

        Args:
            node: Number of the node.
        """
        point = super().numbered(node)
        return point._replace(attachment=self.attachment_of(point.node))

    def attachment_of(self, node: int) -> AttachmentFrame:
        """Attachment frame of the section.

        Args:
            node: Number of the node.
        """
        if node >= self.points_count:
            raise ValueError(
                f"{self.label} has points 0 … {self.points_count - 1}, got {node}: further nodes "
                "have no positions"
            )
        return on_section((node, node + self.points_count), _AT_A_POINT)

    def clamped_sections(self) -> Indices:
        """MIXED_DERIVATIVE nodes of clamped sections."""
        clamped = self.held[:, _TURNED].all(axis=1)
        return np.flatnonzero(clamped & (self.node_types == MIXED_DERIVATIVE))

    def axes_update(self) -> AxesUpdate:
        """Function that rotates the axes with the sections, except where components are held."""
        parts = self.held.reshape(2, self.points_count, 2, 3).sum(axis=-1) % 3 > 0
        moves: Flags = ~parts.any(axis=(0, 2))

        def rotate_axes(coordinates: Array) -> None:
            rotate_section_axes(coordinates, moves)

        return rotate_axes


class SectionPoints(Body):
    """Body of points with sections, and its supports."""

    model: SectionPointsModel

    def clamp(self, *points: Point) -> None:
        """Hold positions of points, and rotations and shear of their sections.

        Strains in the plane of a section and the gradient along the beam stay free, so that the
        beam may be sheared there.

        Args:
            points: Points of the body.

        Raises:
            ValueError: A point is not on this body.
            TypeError: An argument is not a point.
        """
        for node in self._own(points, "clamp"):
            self.model.held[node, _PLACE] = True
            self.model.held[node + self.model.points_count, _TURNED] = True

    def pin(self, *points: Point) -> None:
        """Hold positions of points.

        Args:
            points: Points of the body.

        Raises:
            ValueError: A point is not on this body.
            TypeError: An argument is not a point.
        """
        for node in self._own(points, "pin"):
            self.model.held[node, _PLACE] = True

    def _own(self, points: Sequence[Point], what: str) -> list[int]:
        for point in points:
            require_point(point, f"{type(self).__name__}.{what}: a point")
            if point.body is not self or not self.model.attachment_of(point.node).same(
                point.joint_attachment
            ):
                raise ValueError(
                    f"{self.label} cannot hold {point.label}, which is not a node of it"
                )
        return [point.node for point in points]
