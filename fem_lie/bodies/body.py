"""Bodies with nodal frames, and points on them.

A body has nodes with frames, inertia, and unless it is rigid an elastic assembly that it shares
with all bodies of its kind. It does not depend on unknowns, solvers or other bodies.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

import numpy as np
import numpy.typing as npt

from fem_lie import lie
from fem_lie._arrays import Array, Indices, choice, instance, number, text, vector
from fem_lie._summary import Summarised
from fem_lie.attachments.attachment import AttachmentFrame
from fem_lie.bodies.nodes import HeldRotation, Nodes
from fem_lie.lie.motions import Group
from fem_lie.lie.node_types import NodeType

if TYPE_CHECKING:
    import dolfinx

    from fem_lie.forms.assembly import BodyTerm

Holds: TypeAlias = Mapping["Body", Sequence[HeldRotation]]
"""Rotations of nodes of each body that joints, motions and moments act on, if any."""

NO_HOLDS: Holds = MappingProxyType({})

Where: TypeAlias = str | int | npt.ArrayLike
"""Point of a body: its name, the number of a node, or a position, shape (3,)."""

_NEAR = 1e-6
"""Largest distance of a position from the point taken for it, per size of the body."""


AnyBody = TypeVar("AnyBody", bound="Body")


class Body(Summarised, Nodes):
    """Body with nodes and named points.

    Attributes:
        cells: Pairs of nodes, for drawing, shape (m, 2).
        outline: Outline of the section in (e₂, e₃), shape (k, 2), or of that of each cell, shape
            (m, k, 2), nan where there is none; or ``None``: for drawing.
        box: Edges of a box about a rigid body's frame, shape (3,), or ``None``: for drawing.
        size: Characteristic length of the body, for tolerances.
        group: Group on which its nodes move in time integration, see :meth:`set_group`.
        faces: Corners of surface cells, for drawing, shape (m, 3 or 4).
        thickness: Thickness of these cells, for drawing, shape (m,).
        source: DOLFINx mesh from which the body was made, if any.
        name: Name in messages and results; the scene chooses one if it is empty.
    """

    group: Group = Group.SE3
    source: dolfinx.mesh.Mesh | None = None

    def __init__(
        self,
        frames: Array,
        *,
        cells: npt.NDArray[np.int64],
        outline: Array | None,
        size: float,
        points: dict[str, int],
        box: Array | None = None,
        masters: npt.NDArray[np.int64] | None = None,
        name: str = "",
    ) -> None:
        """Keep copies of the frames; velocities start at zero.

        Args:
            frames: Nodal frames in the reference configuration, shape (n, 4, 3).
            cells: Pairs of nodes, for drawing, shape (m, 2).
            outline: Outline of the cross-section, see :attr:`outline`, or ``None``.
            size: Characteristic length of the body, for tolerances.
            points: Node of each named point.
            box: Edges of a box about a rigid body's frame, shape (3,), or ``None``.
            masters: Master node of each node, its own number if it is independent, shape (n,);
                default: all nodes are independent.
            name: Name in messages and results.
        """
        text(name, f"{type(self).__name__}: name")
        super().__init__(frames, masters)
        self.cells, self.outline, self.box = cells, outline, box
        self.size, self.name = size, name
        self.faces: npt.NDArray[np.int64] = np.empty((0, 4), dtype=np.int64)
        self.thickness: Array = np.empty(0)
        self._points = points

    def set_group(self: AnyBody, group: Group) -> AnyBody:
        """Choose the group on which the nodes move in time integration, and return the body.

        Args:
            group: SE(3) or R³×SO(3).

        Raises:
            ValueError: ``group`` is not a member of :class:`Group`.
        """
        self.group = choice(group, Group, f"{type(self).__name__}: group")
        return self

    @property
    def kind(self) -> Hashable:
        """Key of bodies that are assembled together by :meth:`assemble`."""
        return type(self).__name__

    @classmethod
    def assemble(cls, bodies: Sequence[Any], holds: Holds = NO_HOLDS) -> BodyTerm | None:
        """Assembly of all bodies of one kind, or ``None`` if they are rigid.

        Args:
            bodies: Bodies of one :attr:`kind`; either all or none of them have drilling rotations.
            holds: Rotations of their nodes that joints, motions and moments act on.
        """
        return None

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

    def point(self, where: Where, *, tolerance: float | None = None) -> Point:
        """Point with a name, at a node or at a position, for joints, loads and results.

        Args:
            where: Name of a point such as "end"; or the number of a node; or a position in the
                reference configuration, shape (3,), for the closest material point.
            tolerance: Largest distance from a position, a length; default: 1e-6 of :attr:`size`.

        Raises:
            ValueError: There is no such point; the message lists those that exist, or gives the
                distance of the closest one.
            TypeError: It is neither a name, nor a whole number, nor a position.
        """
        limit = _NEAR * self.size if tolerance is None else number(tolerance, "point: tolerance")
        if isinstance(where, str):
            return self._named(where)
        if isinstance(where, int | np.integer):
            return self._numbered(int(where))
        position = vector(where, 3, f"a name, a node or the position of a point of {self.label}")
        found = self._closest(position)
        away = float(np.linalg.norm(found.position - position))
        if away > limit:
            raise ValueError(
                f"{self.label} has no point at {position}: the closest one, {found.name}, is at "
                f"{found.position}, {away:.3g} away, and the tolerance is {limit:.3g}"
            )
        return found

    def points(self, where: str) -> list[Point]:
        """All points of a named set: a point, curve, face or group of cells.

        Args:
            where: Name of the point, curve, face or group.

        Raises:
            ValueError: There is no such set; the message lists what exists.
            TypeError: It is not a name.
        """
        return [self._numbered(int(node)) for node in self.nodes(where)]

    def _named(self, name: str) -> Point:
        """Point with a name; raises as :meth:`point`."""
        if name not in self._points:
            known = ", ".join(sorted(self._points)) or "none"
            raise ValueError(f"{self.label} has no point {name!r}; it has: {known}")
        return Point(self, self._points[name], name)

    def _numbered(self, node: int) -> Point:
        """Point at a node; raises as :meth:`point`."""
        if not -len(self.frames) <= node < len(self.frames):
            raise ValueError(f"{self.label} has nodes 0 … {len(self.frames) - 1}, got {node}")
        return Point(self, node % len(self.frames), f"node {node}")

    def _closest(self, position: Array) -> Point:
        """Material point closest to a position, among those that joints can act on: nodes."""
        nodes = np.flatnonzero(self.node_types < NodeType.MIXED_DERIVATIVE)
        away = np.linalg.norm(self.frames[nodes, 0] - position, axis=1)
        return self._numbered(int(nodes[away.argmin()]))

    def nodes(self, where: str) -> Indices:
        """Numbers of the nodes of a named set; arguments and errors as of :meth:`points`.

        Args:
            where: Name of the point, curve, face or group.
        """
        text(where, f"the name of a set of points of {self.label}")
        return np.array([self._named(where).node])

    @property
    def label(self) -> str:
        """Name of the body, or its class if it has none yet."""
        return self.name or type(self).__name__

    def _summary(self) -> Iterator[tuple[str, object]]:
        """Name, numbers of nodes and cells, named points."""
        yield "name", self.name
        yield "nodes", len(self.frames)
        yield from (("cells", len(self.cells)),) if len(self.cells) else ()
        yield "points", sorted(self._points)

    @property
    def point_names(self) -> dict[str, int]:
        """Named points and their nodes."""
        return dict(self._points)

    def add_velocity(
        self,
        velocity: npt.ArrayLike = (0.0, 0.0, 0.0),
        *,
        omega: npt.ArrayLike = (0.0, 0.0, 0.0),
        about: Point | npt.ArrayLike | None = None,
    ) -> None:
        """Add a rigid motion to the initial velocities.

        Args:
            velocity: Translational velocity, global components, shape (3,), length per time.
            omega: Angular velocity, global components, shape (3,), rad per time.
            about: Point of a body, or position, through which the axis of rotation passes.

        Raises:
            ValueError: ``omega`` is not zero and ``about`` is missing.
        """
        translation, spin = vector(velocity, 3, "velocity"), vector(omega, 3, "omega")
        if about is None and np.any(spin):
            raise ValueError(
                f"add_velocity: expected about=..., a point or a position that omega = {spin} "
                "leaves at rest"
            )
        centre = np.zeros(3) if about is None else _position_of(about)
        self.add_rigid_motion(translation, spin, centre)


@dataclass(frozen=True, eq=False)
class Point:
    """Point of a body, or of ground (``body`` is ``None``), for joints and loads.

    It is a node, or a point with an attachment frame, on which joints and loads act as on the frame
    of a node.

    Attributes:
        body: Body of the point.
        node: Number of its node; for an attachment frame, the first node that it depends on.
        name: Name in messages.
        attachment: Attachment frame as a function of nodal coordinates; ``None`` for a node.
    """

    body: Body | None
    node: int = 0
    name: str = ""
    attachment: AttachmentFrame | None = None

    def __post_init__(self) -> None:
        """Check the arguments: ``ValueError`` or ``TypeError`` if there is no such body or node."""
        instance(
            self.attachment,
            AttachmentFrame | None,
            "Point: attachment",
            "an attachment, or None for a node",
        )
        instance(self.body, Body | None, "Point: body", "a body, or None for ground")
        instance(self.node, int | np.integer, "Point: node", "the number of a node")
        text(self.name, "Point: name")
        if self.body is not None and not 0 <= self.node < len(self.body.frames):
            last = len(self.body.frames) - 1
            raise ValueError(f"{self.body.label} has nodes 0 … {last}, got {self.node}")

    @property
    def is_ground(self) -> bool:
        """Whether it is fixed in space."""
        return self.body is None

    @property
    def position(self) -> Array:
        """Initial position, shape (3,)."""
        return np.zeros(3) if self.body is None else self.frame[0]

    @property
    def frame(self) -> Array:
        """Initial frame, shape (4, 3)."""
        if self.body is None:
            return lie.frame(np.zeros(3), np.eye(3))
        attachment = self.any_attachment
        return (
            self.body.frames[self.node]
            if attachment is None
            else attachment.frame(self.body.frames)
        )

    @property
    def any_attachment(self) -> AttachmentFrame | None:
        """Attachment frame of the point, or ``None`` if it has the frame of its node."""
        return self.joint_attachment if self.attachment is None else self.attachment

    @property
    def joint_attachment(self) -> AttachmentFrame | None:
        """Attachment frame for joints, or ``None`` if they act on the frame of the node.

        It is the point's own, unless that is rigid, or the one of a node without a frame.
        """
        if self.body is None:
            return None
        if self.attachment is None:
            return self.body.attachment_of(self.node)
        return None if self.attachment.kind.rigid else self.attachment

    def same(self, other: Point) -> bool:
        """Whether the other point is the same material point.

        Args:
            other: Another point.
        """
        if self.body is not other.body or (self.attachment is None) != (other.attachment is None):
            return False
        return (
            self.node == other.node
            if self.attachment is None
            else self.attachment.same(other.attachment)
        )

    @property
    def size(self) -> float:
        """Characteristic length of the body."""
        return 1.0 if self.body is None else self.body.size

    @property
    def label(self) -> str:
        """For messages and results."""
        return "ground" if self.body is None else f"{self.body.label}.{self.name}"


def _position_of(about: Point | npt.ArrayLike) -> Array:
    return about.position if isinstance(about, Point) else vector(about, 3, "about")
