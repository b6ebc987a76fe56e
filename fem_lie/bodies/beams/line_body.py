"""What all bodies along lines have, whatever their nodes are: elements of one formulation."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from typing import Any, NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices, log_coincident
from fem_lie.attachments.attachment import AttachmentFrame
from fem_lie.bodies.beams.assembly import BeamAssembly, weighted_elements
from fem_lie.bodies.beams.sectioned import Sectioned, outline_of
from fem_lie.bodies.body import NO_HOLDS, Holds
from fem_lie.elements.beams.element import Formulation
from fem_lie.forms.assembly import Assembly
from fem_lie.lie.node_types import NodeType
from fem_lie.mesh.lines import LineMesh
from fem_lie.sections.material import Damping
from fem_lie.sections.section import Section


class Placed(NamedTuple):
    """Nodes and elements along a line.

    Attributes:
        frames: Rows of the nodes, shape (n, 4, 3).
        elements: Nodes of each element: its two ends, then those inside, shape (m, degree + 1).
        lengths: Arc length of each element, unloaded, shape (m,).
        masters: The node that each node follows, itself if it is free, shape (n,).
        pairs: Nodes that lines are drawn between, shape (any, 2).
    """

    frames: Array
    elements: Indices
    lengths: Array
    masters: Indices
    pairs: Indices


class LineBody(Sectioned):
    """A body along lines.

    Attributes:
        elements: Nodes of each element: its two ends, then those inside, shape (m, degree + 1).
        formulation: The element.
        damping: Of all elements.
        slopes: ``|dr/dξ|`` at both ends of elements that are cubics, else zero, shape (m, 2).
    """

    def __init__(
        self,
        mesh: LineMesh,
        placed: Placed,
        sections: Sequence[Section],
        formulation: Formulation,
        damping: Damping | None,
        name: str,
    ) -> None:
        """Take what is the same for all of them from mesh and sections.

        Args:
            mesh: The lines, with names of points and groups.
            placed: The nodes.
            sections: Of each element.
            formulation: The element.
            damping: Default: none.
            name: For messages and results.
        """
        self.elements, self.lengths = placed.elements, placed.lengths
        self.slopes: Array = np.zeros((len(placed.elements), 2))
        self.formulation = formulation
        self.damping = Damping() if damping is None else damping
        self._take(sections, mesh)
        named = {key: int(nodes[0]) for key, nodes in mesh.named_points.items() if len(nodes) == 1}
        super().__init__(
            placed.frames,
            cells=placed.pairs,
            outline=outline_of(sections, len(placed.pairs) // len(sections)),
            size=float(self.lengths.sum()),
            points=named,
            masters=placed.masters,
            name=name,
        )
        log_coincident(self.label, mesh.points)

    @property
    def node_type(self) -> NodeType:
        """What the element says."""
        return self.formulation.node_type

    @property
    def kind(self) -> Hashable:
        """Those of one formulation are assembled together."""
        return type(self), self.formulation

    @property
    def slackens(self) -> bool:
        """As the element says."""
        return self.formulation.slackens

    @classmethod
    def assemble(cls, bodies: Sequence[Any], holds: Holds = NO_HOLDS) -> Assembly:
        """All of one :attr:`kind` together."""
        return BeamAssembly(bodies)

    @property
    def elastic_cells(self) -> Indices:
        """The elements of nodes that are frames."""
        return self.elements if self.node_type is NodeType.FRAME else super().elastic_cells

    def weighted_cells(self, cells: Indices, weights: Array) -> Assembly:
        """See the base class."""
        if self.node_type is not NodeType.FRAME:
            super().weighted_cells(cells, weights)
        return weighted_elements(self, cells, weights)

    def attachment_of(self, node: int) -> AttachmentFrame | None:
        """As the element says."""
        return self.formulation.attachment(node)

    def consistent_shares(self) -> tuple[Indices, Array]:
        """Nodes of each element, and the length that each carries: integrals of their shapes."""
        ends = self.frames[self.elements[:, :2]]
        return self.elements, self.formulation.shares(ends, self.lengths)

    def consistent_levers(self) -> Array:
        """As the element says, shape (m, k, 3)."""
        levers = np.zeros((*self.elements.shape, 3))
        ends = self.frames[self.elements[:, :2]]
        levers[:, :2] = self.formulation.levers(ends, self.lengths)
        return levers
