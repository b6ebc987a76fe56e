"""What the assembly sees of a body: nodes, cells, constraints, and how to assemble them.

A model does not depend on points, unknowns, solvers or other bodies. Rotations that joints and
loads act on are passed to it.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from enum import Enum, auto
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, TypeAlias, TypeVar

import numpy as np

from fem_lie import _compat
from fem_lie._arrays import Array, Flags, Indices, text
from fem_lie.attachments.attachment import AttachmentFrame
from fem_lie.lie.motions import Group
from fem_lie.lie.node_types import TRAITS, NodeType, all_axes, rigid_motions
from fem_lie.lie.node_types.floating import FloatingModes
from fem_lie.mesh.shapes import LineQuadrature

if TYPE_CHECKING:
    import dolfinx

    from fem_lie.forms.assembly import BodyTerm


class HeldRotation(NamedTuple):
    """Rotation of a node that a joint, prescribed motion, moment or contact acts on.

    Attributes:
        node: Number of the node.
        other: Key of the rigid part at the other side, equal for all nodes that it holds.
        what: Name of the item in messages.
        axis: Axis of the moment in global components, if it has one axis only.
        needed: Whether the node must be able to rotate about all axes. Contact on a shell without
            drilling rotation may omit the moment about a director.
    """

    node: int
    other: Hashable
    what: str
    axis: Array | None = None
    needed: bool = True


class FoldedElementError(ArithmeticError):
    """Error of a state in which an element rotates by more than it can represent."""


@dataclass(frozen=True, eq=False)
class RotationLimit:
    """Limit of the relative rotation along the elements of a body.

    Attributes:
        nodes: Nodes along each line in an element, from end to end, shape (w, 2 or 3).
        elements: Element of each line, shape (w,).
        limit: Largest sum of the rotations from node to node, rad.
        whole: Whether rotations of whole frames are limited, or of their third directors only.
        lengths: Unloaded arc length of each line, if its axial strain and shear are checked, too.
        elongations: Largest axial strain for which each line has its stiffness, shape (w,), if
            there is such a limit.
    """

    nodes: Indices
    elements: Indices
    limit: float
    whole: bool
    lengths: Array | None = None
    elongations: Array | None = None


_ORTHONORMAL = 1e-8  # as of prescribed motions


def check_nodes(label: str, kinds: Indices, frames: Array, velocities: Array) -> None:
    """Check nodal coordinates and velocities that a user may have set.

    Args:
        label: Label of the body, for messages.
        kinds: Type of each node, shape (n,).
        frames: Nodal coordinates, shape (n, 4, 3).
        velocities: Velocities; expected shape (n, 6).

    Raises:
        ValueError: Axes are not right-handed and orthonormal, or numbers not finite.
    """
    shape, count = velocities.shape, len(frames)
    if shape != (count, 6) or not np.isfinite(velocities).all():
        raise ValueError(
            f"velocities of {label} must be finite and of shape ({count}, 6), got\n{velocities}"
        )
    axes = all_axes(kinds, frames)
    gap = np.abs(axes @ axes.transpose(0, 2, 1) - np.eye(3)).max(axis=(1, 2))
    right = np.linalg.det(axes) > 0.0
    finite = np.isfinite(frames).all(axis=(1, 2))
    bad = np.flatnonzero(~(finite & (gap <= _ORTHONORMAL) & right))
    if len(bad):
        raise ValueError(
            f"frames of {label} must be a position and right-handed orthonormal axes; that of node "
            f"{bad[0]} is\n{frames[bad[0]]}"
        )


AxesUpdate: TypeAlias = Callable[[Array], None]
"""Function that rotates the axes of a body's nodes with its deformation.

It changes their coordinates (n, 4, 3) by :func:`fem_lie.lie.node_types.set_axes`, and may set
vectors that no equation uses.
"""


Holds: TypeAlias = Mapping["BodyModel", Sequence[HeldRotation]]
"""Rotations of nodes of each body that joints, motions and moments act on, if any."""

NO_HOLDS: Holds = MappingProxyType({})


AnyModel = TypeVar("AnyModel", bound="BodyModel")


class MaterialPoint(NamedTuple):
    """Material point of a body.

    Attributes:
        node: Number of its node; for an attachment frame, the first node that it depends on.
        name: Name in messages.
        attachment: Attachment frame as a function of nodal coordinates; ``None`` for a node.
    """

    node: int
    name: str
    attachment: AttachmentFrame | None = None


class LagrangeNodes(NamedTuple):
    """Nodes of a body as degrees of freedom of a Lagrange space.

    Attributes:
        mesh: Mesh from which the body was made.
        degree: Degree of the space.
        nodes: Node of the body at each degree of freedom of each cell, shape (m, k).
    """

    mesh: dolfinx.mesh.Mesh
    degree: int
    nodes: Indices


class MassMatrix(Enum):
    """Mass matrix of a scene.

    Attributes:
        CONSISTENT: Consistent with the interpolation. Drilling rotations of shells have no inertia.
        WITH_DRILLING: The same, with the rotary inertia of
            :func:`~fem_lie.elements.shells.drilling.drilling_inertia`.
        LUMPED: The same, lumped, so that nodes are not coupled by inertia.
    """

    CONSISTENT = auto()
    WITH_DRILLING = auto()
    LUMPED = auto()


class BodyModel:
    """What the assembly sees of a body: its nodes, and the properties in which bodies differ.

    The base has no elastic elements. Subclasses override the properties in which they differ.

    Attributes:
        frames: Initial frames of the nodes, shape (n, 4, 3), see :mod:`fem_lie.lie`.
        velocities: Initial local velocities (translation, rotation), shape (n, 6).
        start_frames: Current configuration at the start of a run, if it is not the strain-free
            configuration ``frames``; shape (n, 4, 3).
        masters: Master node to which each node is rigidly attached, itself if independent, (n,).
        held: Mask of the unknowns (translation, rotation) that are zero, shape (n, 6).
        supports: Axes fixed in space along which ``held`` translations are, nan where they are the
            node's own, shape (n, 3, 3).
        group: Group on which its nodes move in time integration.
        separates_director: Whether statics moves its nodes, their masters and nodes attached to
            them by ``x + R u``, ``R exp(η₁, η₂, 0) exp(η₃)`` instead of ``H exp(h)``.
        has_paired_nodes: Whether a point consists of several nodes.
        dimension: Dimension of its cells.
        size: Characteristic length of the body, for tolerances.
        point_names: Node of each named point.
        name: Name in messages and results; the scene chooses one if it is empty.
        class_name: Name of the class of the body.
        source: DOLFINx mesh from which the body was made, if any.
        cells: Pairs of nodes, for drawing, shape (m, 2).
        outline: Outline of the section in (e₂, e₃), shape (k, 2), or of that of each cell, shape
            (m, k, 2), nan where there is none; or ``None``: for drawing.
        corners: Points in a rigid body's frame, of which it is drawn as the convex hull, shape
            (p, 3), or ``None``.
        faces: Corners of surface cells, for drawing, shape (m, 3 or 4); triangles among
            quadrilaterals have their last corner twice.
        thickness: Thickness of these cells, for drawing, shape (m,).
    """

    separates_director: ClassVar[bool] = False
    has_paired_nodes: ClassVar[bool] = False
    dimension: ClassVar[int] = 1
    group: Group = Group.SE3
    start_frames: Array | None = None
    source: dolfinx.mesh.Mesh | None = None

    def __init__(
        self,
        frames: Array,
        *,
        class_name: str,
        size: float,
        points: Mapping[str, int],
        cells: Indices | None = None,
        outline: Array | None = None,
        corners: Array | None = None,
        masters: Indices | None = None,
        name: str = "",
    ) -> None:
        """Keep copies of the frames; nothing is held, and velocities are zero.

        Args:
            frames: Nodal frames in the reference configuration, shape (n, 4, 3).
            class_name: Name of the class of the body.
            size: Characteristic length of the body, for tolerances.
            points: Node of each named point.
            cells: Pairs of nodes, for drawing, shape (m, 2); default: none.
            outline: Outline of the cross-section, see :attr:`outline`, or ``None``.
            corners: See :attr:`corners`.
            masters: Master node of each node, its own number if it is independent, shape (n,);
                default: all nodes are independent.
            name: Name in messages and results.
        """
        text(name, f"{class_name}: name")
        self.name, self.class_name = name, class_name
        self.frames = np.array(frames, dtype=np.float64)
        count = len(self.frames)
        self.velocities: Array = np.zeros((count, 6))
        self.masters: Indices = np.arange(count) if masters is None else masters
        self.held: Flags = np.zeros((count, 6), dtype=bool)
        self.supports = np.full((count, 3, 3), np.nan)
        self.size, self.point_names = size, dict(points)
        self.cells: Indices = np.empty((0, 2), dtype=np.int64) if cells is None else cells
        self.outline, self.corners = outline, corners
        self.faces: Indices = np.empty((0, 4), dtype=np.int64)
        self.thickness: Array = np.empty(0)

    @property
    def label(self) -> str:
        """Name of the body, or its class if it has none yet: for messages."""
        return self.name or self.class_name

    @property
    def assembly_key(self) -> Hashable:
        """Key of bodies that are assembled together by :meth:`assemble`."""
        return type(self).__name__

    @classmethod
    def assemble(cls, models: Sequence[Any], holds: Holds = NO_HOLDS) -> BodyTerm | None:
        """Assembly of all bodies of one kind, or ``None`` if they are rigid.

        Args:
            models: Models of one :attr:`assembly_key`; all or none of them have drilling rotations.
            holds: Rotations of their nodes that joints, motions and moments act on.
        """
        return None

    def with_strains(self) -> BodyModel:
        """Model whose assembly takes stress-free strains, if its own does not for the cost."""
        return self

    def check_strain(self, strain: Array) -> None:
        """Raise ``ValueError`` if a stress-free strain is not possible; default: all are.

        Args:
            strain: Strain of a cell, shape (s,).
        """

    def pieces(self, holds: Sequence[HeldRotation]) -> Iterator[tuple[BodyModel, Indices]]:
        """Models with one :attr:`assembly_key` each, and the numbers of their nodes.

        Each node belongs to one of them; default: the whole model.

        Args:
            holds: Rotations of nodes that joints, motions and moments act on.
        """
        yield self, np.arange(len(self.frames))

    @property
    def divisible_cells(self) -> Indices | None:
        """Nodes of each cell between which the body may be divided among ranks, shape (m, k).

        ``None``: it stays in one piece.
        """
        return None

    @property
    def neighbour_cells(self) -> Indices:
        """Nodes of cells of other parts, here without stiffness and mass, (c, k); default: none."""
        return np.empty((0, 1), dtype=np.int64)

    def restricted(
        self: AnyModel, cells: Indices, holds: Sequence[HeldRotation]
    ) -> tuple[AnyModel, Indices]:
        """Model of some of the :attr:`divisible_cells`, with their nodes, groups and points.

        Sums over its cells are a part of those over all cells. Data for drawing are left out.

        Args:
            cells: Indices of the cells, ascending, shape (s,): all or none of those at nodes that
                are attached to each other.
            holds: Rotations of nodes of the whole body that joints, motions and moments act on.

        Returns:
            The model, and the number of each of its nodes in the whole body, shape (n,).

        Raises:
            ValueError: The body cannot be divided.
        """
        if self.divisible_cells is None:
            raise ValueError(f"{self.label} cannot be divided between cells")
        nodes: Indices = np.unique(self.divisible_cells[cells])
        return self._on_nodes(nodes), nodes

    def _on_nodes(self: AnyModel, nodes: Indices) -> AnyModel:
        """Copy with some nodes only, which include the master node of each."""
        part = copy(self)
        for name in "frames", "velocities", "held", "supports":
            setattr(part, name, getattr(self, name)[nodes])
        if self.start_frames is not None:
            part.start_frames = self.start_frames[nodes]
        at = {int(node): k for k, node in enumerate(nodes)}
        part.masters = np.array([at[int(master)] for master in self.masters[nodes]], dtype=np.int64)
        part.point_names = {name: at[node] for name, node in self.point_names.items() if node in at}
        part.cells, part.faces = self.cells[:0], self.faces[:0]
        part.thickness, part.outline, part.source = self.thickness[:0], None, None
        return part

    @property
    def elastic_cells(self) -> Indices:
        """Nodes of each cell for :meth:`weighted_cells`, shape (m, k); default: none."""
        return np.empty((0, 0), dtype=np.int64)

    def weighted_cells(self, cells: Indices, weights: Array) -> BodyTerm:
        """Assembly of some elastic cells with weighted energies, each on copies of its nodes.

        Args:
            cells: Indices of the cells, shape (s,).
            weights: Factors of their energies, shape (s,).

        Returns:
            Term on s k nodes, in the order of :attr:`elastic_cells`.

        Raises:
            ValueError: Cells of this body cannot be assembled individually.
        """
        raise ValueError(
            f"cells of {self.label} cannot be assembled individually: expected a beam or a shell "
            "whose nodes are frames"
        )

    def lagrange_nodes(self) -> LagrangeNodes | None:
        """Nodes on the mesh from which the body was made; ``None`` if it was made otherwise.

        The points of a line or surface mesh are the first nodes of its body.
        """
        if self.source is None:
            return None
        nodes = _compat.geometry_dofmap(self.source).astype(np.int64)
        return LagrangeNodes(self.source, _compat.geometry_degree(self.source), nodes)

    def nodes(self, where: str) -> Indices:
        """Numbers of the nodes of a named set.

        Args:
            where: Name of the point, curve, face or group.

        Raises:
            ValueError: There is no such set; the message lists what exists.
        """
        return np.array([self.named(where).node])

    def named(self, name: str) -> MaterialPoint:
        """Material point with a name.

        Args:
            name: Name of the point.

        Raises:
            ValueError: There is no such point; the message lists those that exist.
        """
        if name not in self.point_names:
            known = ", ".join(sorted(self.point_names)) or "none"
            raise ValueError(f"{self.label} has no point {name!r}; it has: {known}")
        return MaterialPoint(self.point_names[name], name)

    def numbered(self, node: int) -> MaterialPoint:
        """Material point at a node.

        Args:
            node: Number of the node; negative ones count from the last.

        Raises:
            ValueError: There is no such node.
        """
        if not -len(self.frames) <= node < len(self.frames):
            raise ValueError(f"{self.label} has nodes 0 … {len(self.frames) - 1}, got {node}")
        return MaterialPoint(node % len(self.frames), f"node {node}")

    def frame_of(self, point: MaterialPoint) -> Array:
        """Initial frame of a material point, shape (4, 3).

        Args:
            point: Material point.
        """
        attachment = point.attachment or self.attachment_of(point.node)
        return self.frames[point.node] if attachment is None else attachment.frame(self.frames)

    def closest(self, position: Array) -> MaterialPoint:
        """Material point closest to a position, among those that joints can act on: nodes.

        Args:
            position: Position in the reference configuration, shape (3,).
        """
        return self.numbered(self.closest_node(position))

    def closest_node(self, position: Array) -> int:
        """Number of the node closest to a position.

        Args:
            position: Position in the reference configuration, shape (3,).
        """
        nodes = np.flatnonzero(self.node_types < NodeType.MIXED_DERIVATIVE)
        away = np.linalg.norm(self.frames[nodes, 0] - position, axis=1)
        return int(nodes[away.argmin()])

    def cells_of(self, group: str | None = None) -> Indices:
        """Elements of a named group (default: all).

        Args:
            group: Name of the group; default: all.

        Raises:
            ValueError: The body has no elements, or no such group.
        """
        raise ValueError(f"{self.label} has no cells for a load")

    def line_quadrature(self) -> LineQuadrature:
        """Integration along the elements of a line, for loads.

        Raises:
            ValueError: The body has no such elements.
        """
        raise ValueError(f"{self.label} has no cells to put a load on")

    @property
    def node_type(self) -> NodeType:
        """Type of the nodes."""
        return NodeType.FRAME

    @property
    def node_types(self) -> Indices:
        """Type of each node, shape (n,); default: all are :attr:`node_type`."""
        return np.full(len(self.frames), int(self.node_type), dtype=np.int64)

    @property
    def node_lengths(self) -> Flags:
        """Mask of the two vector unknowns of each node that are lengths, shape (n, 2).

        Others are dimensionless: rotations, position gradients. Default: the first is a length.
        """
        return np.tile([True, False], (len(self.frames), 1))

    @property
    def edge_frames(self) -> Indices:
        """Nodes with a frame on the edge to another node, and the other nodes, shape (k, 2).

        Such a frame rotates about the edge by its own unknown, and with the edge as both nodes
        move.
        """
        return np.empty((0, 2), dtype=np.int64)

    @property
    def missing_unknowns(self) -> Flags:
        """Mask of unknowns that nodes do not have, beyond those absent in their type, (n, 6)."""
        return np.zeros((len(self.frames), 6), dtype=bool)

    @property
    def separates_rotation(self) -> bool:
        """Whether statics moves its frames, too, by ``x + R u``, ``R exp(η)``.

        Position nodes move along straight lines. A screw motion by a large rotation would move the
        frame at an end of a rod away from them by more than the length of an edge.
        """
        return False

    def axes_update(self) -> AxesUpdate | None:
        """Function that rotates nodal axes with an accepted state, or ``None`` if nodes do so."""
        return None

    def attachment_of(self, node: int) -> AttachmentFrame | None:
        """Attachment frame by which joints hold a node; ``None`` if it has a frame.

        Args:
            node: Number of the node.
        """
        return None

    @property
    def tension_only(self) -> bool:
        """Whether its elements are tension-only, with an energy that is still convex."""
        return False

    @property
    def laid_short(self) -> bool:
        """Whether it is laid along a line that is shorter than it, and resists compression."""
        return False

    def floating_modes(self) -> FloatingModes | None:
        """Modal mass and stiffness of a body that deforms within one frame; ``None`` for others."""
        return None

    def has_drilling(self, holds: Sequence[HeldRotation] = ()) -> bool:
        """Whether its nodes have rotations about their third directors.

        Args:
            holds: Rotations of nodes that joints, motions and moments act on.

        Raises:
            ValueError: The holds need such rotations, but the nodes cannot have them.
        """
        return True

    def drilling_for(self, holds: Sequence[HeldRotation]) -> tuple[bool, Array | None]:
        """Whether nodes have drilling rotations for these holds, and the stiffness of each cell.

        Args:
            holds: Rotations of nodes that joints, motions and moments act on.
        """
        return self.has_drilling(holds), None

    def check(self) -> None:
        """Raise ``ValueError`` if a user has set invalid frames or velocities."""
        check_nodes(self.label, self.node_types, self.frames, self.velocities)
        if self.start_frames is None:
            return
        if self.start_frames.shape != self.frames.shape:
            raise ValueError(
                f"start_frames of {self.label}: expected shape {self.frames.shape}, got "
                f"{self.start_frames.shape}"
            )
        check_nodes(self.label, self.node_types, self.start_frames, self.velocities)

    def require_frames(self, what: str) -> None:
        """Raise an error if an item acts on frames and the nodes have none.

        Args:
            what: Name of the item in the message.

        Raises:
            ValueError: The nodes are not frames.
        """
        if self.node_type != NodeType.FRAME:
            raise ValueError(
                f"{what} needs nodes with frames, but those of {self.label} have "
                f"{TRAITS[self.node_type].description}: clamps and joints hold them, and forces "
                "fixed in space act on them"
            )

    def require_direction(self, node: int) -> None:
        """Raise ``ValueError`` if a node has no direction that a clamp could hold.

        Args:
            node: Number of the node.
        """
        return

    def rotation_limit(self) -> RotationLimit | None:
        """Limit of rotations along its elements, or ``None`` if it has no such elements."""
        return None

    def add_rigid_motion(self, translation: Array, spin: Array, about: Array) -> None:
        """Add a rigid motion, in global components and about ``about``, to the velocities.

        Args:
            translation: Velocity of translation, global components, shape (3,).
            spin: Angular velocity, global components, shape (3,), rad per time.
            about: Position at rest, shape (3,).
        """
        H = self.frames if self.start_frames is None else self.start_frames
        self.velocities += rigid_motions(self.node_types, H, about) @ [
            *translation,
            *spin,
        ]
