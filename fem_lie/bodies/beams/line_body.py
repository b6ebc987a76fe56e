"""Bodies along lines, with elements of one formulation and any node type."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Hashable, Sequence
from typing import Any, NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices, log_coincident
from fem_lie.attachments.attachment import AttachmentFrame
from fem_lie.bodies.beams.assembly import BeamAssembly, weighted_elements
from fem_lie.bodies.beams.sectioned import SectionedModel, outline_of
from fem_lie.bodies.body import Body
from fem_lie.bodies.model import NO_HOLDS, Holds
from fem_lie.elements.beams.element import BeamFormulation
from fem_lie.forms.assembly import Assembly, BodyTerm
from fem_lie.lie.node_types import NodeType
from fem_lie.mesh.lines import LineMesh
from fem_lie.mesh.shapes import LineQuadrature
from fem_lie.sections.material import Damping
from fem_lie.sections.section import Section


class Placed(NamedTuple):
    """Nodes and elements along a line.

    Attributes:
        frames: Nodal coordinates, shape (n, 4, 3).
        elements: Nodes of each element: its two ends, then those inside, shape (m, degree + 1).
        lengths: Unloaded arc length of each element, shape (m,).
        masters: Master node of each node, itself if independent, shape (n,).
        pairs: Pairs of nodes between which lines are drawn, shape (any, 2).
    """

    frames: Array
    elements: Indices
    lengths: Array
    masters: Indices
    pairs: Indices


class SmoothLine(NamedTuple):
    """Elements that continue each other with one tangent.

    Attributes:
        nodes: Nodes along the line; the first one again at the end if the line is closed, (m + 1,).
        elements: The elements, in order, shape (m,).
    """

    nodes: Indices
    elements: Indices

    @property
    def closed(self) -> bool:
        """Whether the line is closed."""
        return bool(self.nodes[0] == self.nodes[-1])


class LineModel(SectionedModel):
    """Model of a body along lines.

    Attributes:
        elements: Nodes of each element: its two ends, then those inside, shape (m, degree + 1).
        formulation: Finite element of all cells.
        damping: Damping of all elements.
        slopes: ``|dr/dξ|`` at both ends of cubic elements, else zero, shape (m, 2).
    """

    _of_elements = (*SectionedModel._of_elements, "slopes")

    def __init__(
        self,
        mesh: LineMesh,
        placed: Placed,
        sections: Sequence[Section],
        formulation: BeamFormulation,
        damping: Damping | None,
        class_name: str,
        name: str,
    ) -> None:
        """Set elements, sections, damping, drawing data and names.

        Args:
            mesh: Line mesh with names of points and groups.
            placed: Nodes and elements.
            sections: Section of each element.
            formulation: Finite element.
            damping: Damping; default: none.
            class_name: Name of the class of the body.
            name: Name in messages and results.
        """
        self.elements, self.lengths = placed.elements, placed.lengths
        self.slopes: Array = np.zeros((len(placed.elements), 2))
        self.formulation = formulation
        self.damping = Damping() if damping is None else damping
        self._take(sections, mesh)
        named = {key: int(nodes[0]) for key, nodes in mesh.named_points.items() if len(nodes) == 1}
        super().__init__(
            placed.frames,
            class_name=class_name,
            cells=placed.pairs,
            outline=outline_of(sections, len(placed.pairs) // len(sections)),
            size=float(self.lengths.sum()),
            points=named,
            masters=placed.masters,
            name=name,
        )
        self.source = mesh.source
        log_coincident(self.label, mesh.points)

    @property
    def node_type(self) -> NodeType:
        """Node type of the formulation."""
        return self.formulation.node_type

    @property
    def assembly_key(self) -> Hashable:
        """Key of bodies that are assembled together: same class and formulation."""
        return type(self), self.formulation

    @property
    def tension_only(self) -> bool:
        """Whether the formulation is tension-only."""
        return self.formulation.tension_only

    @property
    @abstractmethod
    def smooth_lines(self) -> list[SmoothLine]:
        """Lines of elements that continue each other smoothly."""

    @classmethod
    def assemble(cls, models: Sequence[Any], holds: Holds = NO_HOLDS) -> BodyTerm:
        """Assembly of all bodies of one :attr:`assembly_key`."""
        return BeamAssembly(models)

    @property
    def divisible_cells(self) -> Indices | None:
        """Nodes of each element."""
        return self.elements

    @property
    def elastic_cells(self) -> Indices:
        """Nodes of each element, shape (m, k), if they are frames; else none."""
        return self.elements if self.node_type is NodeType.FRAME else super().elastic_cells

    def weighted_cells(self, cells: Indices, weights: Array) -> Assembly:
        """Assembly of some elements with weighted energies.

        Args:
            cells: Indices of the elements, shape (s,).
            weights: Factors of their energies, shape (s,).

        Raises:
            ValueError: The nodes are not frames.
        """
        if self.node_type is not NodeType.FRAME:
            super().weighted_cells(cells, weights)
        return weighted_elements(self, cells, weights)

    def attachment_of(self, node: int) -> AttachmentFrame | None:
        """Attachment frame by which joints hold a node; ``None`` if it has a frame.

        Args:
            node: Number of the node.
        """
        return self.formulation.attachment(node)

    def line_quadrature(self) -> LineQuadrature:
        """Integration along the elements, for loads."""
        nodes, ends = self.elements, self.frames[self.elements[:, :2]]
        weights, shapes, directors = self.formulation.line_shapes(ends, self.lengths)
        positions = np.einsum("mgk,mkj->mgj", shapes, self.frames[nodes, 0])
        positions += np.einsum("mgad,madj->mgj", directors, ends[:, :, 1:])
        on_directors = np.zeros((*shapes.shape, 3))
        on_directors[:, :, :2] = weights[..., np.newaxis, np.newaxis] * directors
        shares = weights[..., np.newaxis] * shapes
        return LineQuadrature(nodes, positions, shares, on_directors)


class LineBody(Body):
    """Body along lines."""

    model: LineModel
