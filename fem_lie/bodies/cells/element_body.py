"""Bodies of cells of a user's own element, on nodes of any types."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices, instance, numbers
from fem_lie.attachments.at_nodes import along_tangent
from fem_lie.attachments.attachment import AttachmentFrame
from fem_lie.bodies.body import Body, Point
from fem_lie.bodies.cells.assembly import assemble_cells
from fem_lie.bodies.model import NO_HOLDS, BodyModel, Holds
from fem_lie.bodies.points import require_point
from fem_lie.forms.assembly import BodyTerm
from fem_lie.forms.small_energy.assembly import CellFunctions
from fem_lie.forms.small_energy.element import Element
from fem_lie.lie.node_types import TRAITS, NodeType
from fem_lie.sections.material import Damping

_NO_POINTS: Mapping[str, int] = MappingProxyType({})


class ElementModel(BodyModel):
    """Model of a body whose cells have one element of the small-energy kernel.

    Attributes:
        element: Record of the element.
        functions: Compiled functions of the element.
        element_nodes: Nodes of each cell, shape (m, k).
        damping: Mass-proportional damping.
        has_mass: Whether cells have inertia.
    """

    def __init__(
        self,
        frames: Array,
        node_types: Indices,
        cells: Indices,
        *,
        element: Element,
        functions: CellFunctions,
        data: Array,
        inertia: Array | None,
        points: Mapping[str, int],
        lines: Indices,
        damping: Damping,
        class_name: str,
        name: str,
    ) -> None:
        """Take the nodes and the data of the cells; see :class:`ElementBody`."""
        self._types, self.damping = node_types, damping
        self.element, self.functions, self.element_nodes = element, functions, cells
        self._data, self._inertia, self.has_mass = data, inertia, inertia is not None
        positions = frames[node_types < NodeType.MIXED_DERIVATIVE, 0]
        super().__init__(
            frames,
            class_name=class_name,
            cells=lines,
            size=float(np.linalg.norm(np.ptp(positions, axis=0))) or 1.0,
            points=points,
            name=name,
        )

    @property
    def node_type(self) -> NodeType:
        """Type of the first node."""
        return NodeType(self._types[0])

    @property
    def node_types(self) -> Indices:
        """Type of each node, shape (n,)."""
        return self._types

    @property
    def assembly_key(self) -> Hashable:
        """Key of bodies that are assembled together: those of one element."""
        return type(self), self.functions

    @classmethod
    def assemble(cls, models: Sequence[Any], holds: Holds = NO_HOLDS) -> BodyTerm:
        """Assembly of all bodies of one :attr:`assembly_key`."""
        return assemble_cells(models[0].element, models[0].functions, models)

    def element_data(self) -> Array:
        """Data of the cells, shape (m, any)."""
        return self._data

    def element_inertia(self) -> Array:
        """Mass matrix in the nodal coordinates of each cell, shape (m, k, 4, k, 4).

        Raises:
            ValueError: The body has no inertia.
        """
        if self._inertia is None:
            raise ValueError(f"{self.label} has no inertia")
        return self._inertia

    def attachment_of(self, node: int) -> AttachmentFrame | None:
        """Attachment frame at the tangent of a position-gradient node; ``None`` for others.

        Args:
            node: Number of the node.
        """
        return along_tangent(node) if self._types[node] == NodeType.POSITION_GRADIENT else None


class ElementBody(Body):
    """Body whose cells have one element: vectors, strains and a constitutive law.

    An element for the small-energy kernel is a record and four compiled functions, see
    :mod:`fem_lie.forms.small_energy.cell`. Each node may have any type. Joints and loads act on
    nodes with frames, and on the tangents of position-gradient nodes.

    Example:
        >>> from fem_lie.elements.gradients import ancf
        >>> tube = fl.Section.circle(0.01, fl.Material(E=2.1e11, nu=0.3, density=7800.0))
        >>> beam = fl.AncfBeam.straight((0, 0, 0), (1, 0, 0), tube, cells=2)
        >>> own = fl.extend.ElementBody(
        ...     beam.frames,
        ...     beam.model.node_types,
        ...     beam.model.elements,
        ...     element=ancf.ELEMENT,
        ...     functions=ancf.FUNCTIONS,
        ...     data=beam.model.element_data(),
        ... )
        >>> own.model.element_nodes.shape
        (2, 4)
    """

    model: ElementModel

    def __init__(
        self,
        rows: npt.ArrayLike,
        node_types: Sequence[NodeType],
        cells: npt.ArrayLike,
        *,
        element: Element,
        functions: CellFunctions,
        data: Array,
        inertia: Array | None = None,
        points: Mapping[str, int] = _NO_POINTS,
        lines: npt.ArrayLike = (),
        damping: Damping | None = None,
        name: str = "",
    ) -> None:
        """Check the shapes of the arguments.

        Args:
            rows: Nodal coordinates, see :mod:`fem_lie.lie.node_types`, shape (n, 4, 3).
            node_types: Type of each node, n.
            cells: Nodes of each cell, shape (m, k), of the types of the element.
            element: Record of the element.
            functions: Compiled functions of the element.
            data: Data of the cells, see :func:`fem_lie.forms.small_energy.element.cell_data`.
            inertia: Mass matrix in the nodal coordinates of each cell, shape (m, k, 4, k, 4);
                default: none, for statics.
            points: Nodes of named points.
            lines: Pairs of nodes between which lines are drawn, shape (any, 2); default: none.
            damping: Mass-proportional damping; viscous forces belong to the element.
            name: Name in messages and results.

        Raises:
            ValueError: Shapes do not agree, a cell has nodes of other types than the element, or
                there is damping of strain.
            TypeError: An argument has an unexpected type.
        """
        instance(element, Element, "ElementBody: element", "an Element")
        instance(functions, CellFunctions, "ElementBody: functions", "CellFunctions")
        instance(damping, Damping | None, "ElementBody: damping", "a Damping or None")
        frames = numbers(rows, "ElementBody: rows")
        types = np.array([int(each) for each in node_types], dtype=np.int64)
        if frames.shape != (len(types), 4, 3):
            raise ValueError(
                f"ElementBody: rows must have shape ({len(types)}, 4, 3) for "
                f"{len(types)} node types, got {frames.shape}"
            )
        nodes, of = np.asarray(cells, dtype=np.int64), element.cells.types
        if nodes.ndim != 2 or nodes.shape[1] != len(of) or not _within(nodes, len(frames)):
            raise ValueError(
                f"ElementBody: cells must have {len(of)} of {len(frames)} nodes each, got "
                f"{nodes.tolist()}"
            )
        if (types[nodes] != of).any():
            raise ValueError(
                f"ElementBody: cells must have nodes of types {of.tolist()}, got "
                f"{types[nodes].tolist()}"
            )
        shape = (len(nodes), len(of), 4, len(of), 4)
        if inertia is not None and inertia.shape != shape:
            raise ValueError(f"ElementBody: inertia must have shape {shape}, got {inertia.shape}")
        if len(data) != len(nodes):
            raise ValueError(f"ElementBody: {len(nodes)} cells need as many data, got {len(data)}")
        damping = Damping.of_mass(damping, "ElementBody")
        super().__init__(
            ElementModel(
                frames,
                types,
                nodes,
                element=element,
                functions=functions,
                data=data,
                inertia=inertia,
                points=points,
                lines=np.asarray(lines, dtype=np.int64).reshape(-1, 2),
                damping=damping,
                class_name=type(self).__name__,
                name=name,
            )
        )

    def clamp(self, *points: Point) -> None:
        """Hold positions of points, and directions if their nodes have any.

        Args:
            points: Points of the body.

        Raises:
            ValueError: A point is not on this body.
            TypeError: An argument is not a point.
        """
        for point in points:
            require_point(point, "ElementBody.clamp: a point")
            if point.body is not self:
                raise ValueError(f"{self.label} cannot hold {point.label}, a point of another body")
            held = TRAITS[NodeType(self.model.node_types[point.node])].clamp_holds
            self.model.held[point.node] |= np.array(held)


def _within(nodes: Indices, count: int) -> bool:
    return bool(((nodes >= 0) & (nodes < count)).all())
