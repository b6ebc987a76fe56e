"""Bodies, joints and supports of a scene as results need them: names, nodes, drawing data."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING, NamedTuple, Protocol, TypeVar

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices, Scalar, shown
from fem_lie._summary import Summarised
from fem_lie.bodies.points import require_node
from fem_lie.lie.node_types import WITH_GRADIENTS, NodeType

if TYPE_CHECKING:
    from fem_lie.attachments.attachment import AttachmentFrame
    from fem_lie.bodies.body import Body, Point
    from fem_lie.bodies.model import BodyModel


class Labelled(Protocol):
    """A joint, or another item of a scene with a label."""

    @property
    def label(self) -> str:
        """Label in messages and results."""


class Owners(NamedTuple):
    """Ranks that had cells of a scene that was divided.

    Attributes:
        ranks: Rank of each cell, shape (c,).
        parts: Number of ranks among which the scene was divided.
    """

    ranks: Indices
    parts: int


@dataclass(frozen=True, eq=False, repr=False)
class BodyInfo(Summarised):
    """One body; node numbers are those of the whole system.

    Attributes:
        name: Name in the scene.
        kind: Name of its class.
        nodes: Its nodes, shape (n,).
        cells: Pairs of nodes, shape (m, 2); none for a rigid body.
        outline: Outline of the section in (e₂, e₃), shape (k, 2), or of that of each cell, shape
            (m, k, 2); nan where there is none; ``None`` without outlines.
        corners: Points in the body's frame, of which a rigid body is drawn as the convex hull,
            shape (p, 3).
        points: Node of each named point.
        faces: Corners of surface cells, shape (m, 3 or 4); triangles among quadrilaterals have
            their last corner twice.
        thickness: Thickness of these cells, shape (m,).
        node_types: Type of each node, see :mod:`fem_lie.lie.node_types`, shape (n,); a frame whose
            axes the body sets, as on an edge of a discrete rod, counts as a position. ``None`` for
            files of results without node types.
        undeformed: Frames of its nodes in the undeformed configuration, shape (n, 4, 3); ``None``
            for files of results without them.
        element: Name of the class of its formulation; empty if it has none, and for files of
            results without it.
        owners: Rank that had each of ``cells``, then of ``faces``, or each of the nodes if there
            are neither, in a scene that was divided; ``None`` if it was not.
    """

    name: str
    kind: str
    nodes: Indices
    cells: Indices = field(default_factory=lambda: np.empty((0, 2), dtype=np.int64))
    outline: Array | None = None
    corners: Array | None = None
    points: Mapping[str, int] = field(default_factory=dict)
    faces: Indices = field(default_factory=lambda: np.empty((0, 4), dtype=np.int64))
    thickness: Array = field(default_factory=lambda: np.empty(0))
    node_types: Indices | None = None
    undeformed: Array | None = None
    element: str = ""
    owners: Indices | None = None

    @classmethod
    def of(cls, body: Body, nodes: Indices) -> BodyInfo:
        """Record of a body whose nodes have the numbers ``nodes``."""
        model = body.model
        return cls(
            name=model.name,
            kind=type(body).__name__,
            nodes=nodes,
            cells=nodes[model.cells],
            outline=model.outline,
            corners=model.corners,
            points={key: int(nodes[node]) for key, node in model.point_names.items()},
            faces=nodes[model.faces],
            thickness=model.thickness,
            node_types=_recorded_kinds(model),
            undeformed=model.frames.copy(),
            element=element_of(model),
        )


def box_corners(edges: Array) -> Array:
    """Corners of a box about the origin with edges along the axes, shape (8, 3)."""
    return 0.5 * edges * np.array(list(product((-1.0, 1.0), repeat=3)))


def element_of(model: BodyModel) -> str:
    """Name of the class of a body's formulation; empty if it has none."""
    formulation = getattr(model, "formulation", None)
    return "" if formulation is None else type(formulation).__name__


def _recorded_kinds(model: BodyModel) -> Indices:
    """Node types, with FRAME only for nodes whose axes follow from their velocities."""
    kinds = model.node_types
    if model.axes_update() is None:
        return kinds
    set_by_body = (kinds == NodeType.FRAME) & model.held[:, 3:].any(axis=1)
    return np.where(set_by_body, int(NodeType.POSITION), kinds)


@dataclass(frozen=True, eq=False, repr=False)
class JointInfo(Summarised):
    """One joint.

    Attributes:
        name: Its name, or the names of the points that it joins.
        kind: Name of its class.
        node: Node at which it is drawn; −1 if there is none.
        offset: Its position in the frame of that node, shape (3,).
        coordinates: Names of its relative coordinates.
        first: Index of the first of them among those of all joints.
        side: Node of its point ``a``, with which the axes of its force rotate; −1 for ground.
        axes: These axes as rows, in the frame of that node, shape (3, 3); ``None`` if they follow
            an attachment frame or a section along which it slides, and for files of results without
            them.
    """

    name: str
    kind: str
    node: int = -1
    offset: Array = field(default_factory=lambda: np.zeros(3))
    coordinates: tuple[str, ...] = ()
    first: int = 0
    side: int = -1
    axes: Array | None = None

    def renumbered(self, node_of: Indices) -> JointInfo:
        """The joint with other node numbers."""
        node, side = (int(node_of[k]) if k >= 0 else -1 for k in (self.node, self.side))
        return replace(self, node=node, side=side)


@dataclass(frozen=True, eq=False, repr=False)
class SupportInfo(Summarised):
    """Nodes held by clamps and by supports of bodies.

    Attributes:
        at: Node of each reaction, shape (s,).
        nodes: These nodes and nodes rigidly attached to them, shape (q,).
        rows: Index of the reaction of each of ``nodes``, shape (q,).
    """

    at: Indices = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    nodes: Indices = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    rows: Indices = field(default_factory=lambda: np.empty(0, dtype=np.int64))

    def row(self, node: int) -> int | None:
        """Index of the reaction of a node; ``None`` if it is not held."""
        found = self.rows[self.nodes == node]
        return int(found[0]) if len(found) else None


@dataclass(frozen=True, eq=False, repr=False)
class SceneInfo(Summarised):
    """Bodies and joints in the order of the scene, and supports.

    Attributes:
        bodies: All bodies.
        joints: All joints.
        mass: Total mass; 0 if a body has no known inertia.
        supports: Held nodes.
        strained: Names of the bodies with loads that are stress-free strains.
        parts: Number of ranks among which the scene was divided; ``None``: it was not.
    """

    bodies: tuple[BodyInfo, ...]
    joints: tuple[JointInfo, ...] = ()
    mass: float = 0.0
    supports: SupportInfo = field(default_factory=SupportInfo)
    strained: tuple[str, ...] = ()
    parts: int | None = None

    @classmethod
    def of(cls, bodies: Sequence[Body]) -> SceneInfo:
        """Record of bodies without joints, with nodes numbered body after body."""
        ends = np.cumsum([len(body.frames) for body in bodies])
        parts = zip(bodies, ends, strict=True)
        infos = [BodyInfo.of(body, np.arange(end - len(body.frames), end)) for body, end in parts]
        return cls(tuple(infos))

    @property
    def node_types(self) -> Indices:
        """Type of each node of the system, shape (N,).

        Raises:
            ValueError: The types of a body are not recorded; the message names it.
        """
        found = np.empty(self._count, dtype=np.int64)
        for body in self.bodies:
            found[body.nodes] = _known(body, body.node_types, "node types")
        return found

    @property
    def gradient_nodes(self) -> Indices:
        """Nodes with position gradients, ascending, shape (g,)."""
        parts = [
            body.nodes[np.isin(body.node_types, WITH_GRADIENTS)]
            for body in self.bodies
            if body.node_types is not None
        ]
        return np.sort(np.concatenate([np.empty(0, np.int64), *parts]))

    @cached_property
    def undeformed(self) -> Array:
        """Frames of all nodes in the undeformed configuration, shape (N, 4, 3).

        Raises:
            ValueError: That of a body is not recorded; the message names it.
        """
        found = np.empty((self._count, 4, 3))
        for body in self.bodies:
            found[body.nodes] = _known(body, body.undeformed, "undeformed configuration")
        return found

    def renumbered(self, values: Array, nodes: Mapping[Body, Indices]) -> Array:
        """Values of all nodes in another numbering of the same bodies.

        Results of scenes that are divided among ranks number nodes body after body, those of one
        rank as their equations do.

        Args:
            values: Values in the numbering of this record, shape (k, N, …).
            nodes: Numbers of the nodes of each body in the other numbering.

        Returns:
            The values in that numbering; as they are if the bodies differ.
        """
        own = {body.name: body.nodes for body in self.bodies}
        to = {body.name: numbers for body, numbers in nodes.items()}
        if {name: len(n) for name, n in own.items()} != {name: len(n) for name, n in to.items()}:
            return values
        found = np.empty_like(values)
        for name, numbers in to.items():
            found[:, numbers] = values[:, own[name]]
        return found

    @property
    def _count(self) -> int:
        """Number of nodes of the system."""
        return sum(len(body.nodes) for body in self.bodies)

    def body(self, name: str) -> BodyInfo:
        """Body with this name.

        Raises:
            ValueError: There is none; the message lists those that exist.
        """
        return _named(self.bodies, name, "body")

    def node_labels(self) -> list[str]:
        """Name of each node: that of a point at it, or "body.node 3"."""
        found = [""] * self._count
        for body in self.bodies:
            for i, node in enumerate(body.nodes):
                found[node] = f"{body.name}.node {i}"
            for name, at in body.points.items():
                found[at] = f"{body.name}.{name}"
        return found

    def joint(self, joint: Labelled | str) -> int:
        """Index of the joint with this name, or of this joint of the scene.

        Raises:
            ValueError: There is none, and the message lists those that exist; or several have the
                name.
        """
        name = joint if isinstance(joint, str) else joint.label
        found = _named(self.joints, name, "joint")
        if (count := sum(info.name == name for info in self.joints)) > 1:
            raise ValueError(
                f"{count} joints or connections are called {name!r}: expected one; give each its "
                "own name (name=...)"
            )
        return self.joints.index(found)

    def coordinate(self, joint: Labelled | str, name: str | None) -> int:
        """Index of a joint's relative coordinate; without a name, of its first one.

        Raises:
            ValueError: There is none; the message lists those that exist.
        """
        info = self.joints[self.joint(joint)]
        expected = name if name is not None else info.coordinates[0] if info.coordinates else ""
        if expected not in info.coordinates:
            known = ", ".join(info.coordinates) or "none"
            raise ValueError(f"{info.name} has no coordinate {expected!r}; it has: {known}")
        return info.first + info.coordinates.index(expected)

    def node(self, point: Point | str | int) -> int:
        """Node of a point: the point itself, "body.name", "body.node 3", or a node's number.

        Raises:
            ValueError: There is no such point; the message lists those that exist.
        """
        if isinstance(point, str):
            return self._node_of_name(point)
        if isinstance(point, (int, np.integer)):
            count = 1 + max(int(body.nodes.max()) for body in self.bodies)
            if not 0 <= point < count:
                raise ValueError(f"nodes are 0 … {count - 1}, got {point}")
            return int(point)
        if point.body is None:
            raise ValueError("ground does not move; give a point of a body")
        require_node(point, "what is looked up")
        return int(self.body(point.body.name).nodes[point.node])

    def frame(self, point: Point | str | int, frames: Array) -> Array:
        """Frames of a point, shape (…, 4, 3), from those of all nodes, (…, N, 4, 3).

        Args:
            point: As for :meth:`node`, or a point with an attachment frame.
            frames: Frames of all nodes.

        Raises:
            ValueError: There is no such point.
        """
        nodes, attachment = self.located(point)
        return located_frame(attachment, frames[..., nodes, :, :])

    def twist(
        self, point: Point | str | int, frames: Array, v: npt.NDArray[Scalar]
    ) -> npt.NDArray[Scalar]:
        """Twists of a point, (…, 6), from those of all nodes, (…, N, 6); see :meth:`frame`."""
        nodes, attachment = self.located(point)
        return located_twist(attachment, frames[..., nodes, :, :], v[..., nodes, :])

    def located(self, point: Point | str | int) -> tuple[Indices, AttachmentFrame | None]:
        """Nodes on which a point depends, and its attachment frame as one of these nodes.

        Args:
            point: As for :meth:`frame`.

        Returns:
            Numbers of the nodes, shape (k,), and the frame; ``None`` if the point is the only node.

        Raises:
            ValueError: There is no such point.
        """
        attachment = _attachment(point)
        if attachment is None:
            return np.array([self.node(point)]), None
        assert not isinstance(point, str | int | np.integer) and point.body is not None
        nodes = self.body(point.body.name).nodes[list(attachment.nodes)]
        return nodes, attachment._replace(nodes=tuple(range(len(nodes))))

    def _node_of_name(self, label: str) -> int:
        known = {}
        for body in self.bodies:
            known.update({f"{body.name}.{key}": node for key, node in body.points.items()})
            nodes = {f"{body.name}.node {i}": int(node) for i, node in enumerate(body.nodes)}
            if label in nodes:
                return nodes[label]
        if label not in known:
            raise ValueError(
                f"there is no point {label!r}; there are: {', '.join(sorted(known)) or 'none'}, "
                "and 'body.node 0', 'body.node 1', …"
            )
        return int(known[label])


def located_frame(attachment: AttachmentFrame | None, frames: Array) -> Array:
    """Frame of a point, shape (…, 4, 3), from those of its nodes, (…, k, 4, 3).

    Args:
        attachment: See :meth:`SceneInfo.located`.
        frames: Frames of these nodes.
    """
    return frames[..., 0, :, :] if attachment is None else attachment.frame(frames)


def located_twist(
    attachment: AttachmentFrame | None, frames: Array, v: npt.NDArray[Scalar]
) -> npt.NDArray[Scalar]:
    """Twist of a point, shape (…, 6), from those of its nodes, (…, k, 6); as the frame."""
    return v[..., 0, :] if attachment is None else attachment.twist(frames, v)


def _attachment(point: Point | str | int) -> AttachmentFrame | None:
    """Attachment frame of a point, or ``None`` if it is a node.

    Raises:
        TypeError: What is given is no point.
    """
    if isinstance(point, str | int | np.integer):
        return None
    if not hasattr(type(point), "any_attachment"):
        raise TypeError(
            "expected a point of a body, such as body.point('end'), its name, such as 'arm.end', "
            f"or the number of a node, got {shown(point)}"
        )
    return point.any_attachment


SCENE_RECORDS = (SceneInfo, BodyInfo, JointInfo, SupportInfo)
"""Records of which that of a scene consists."""

Item = TypeVar("Item", BodyInfo, JointInfo)
Recorded = TypeVar("Recorded", Array, Indices)


def _known(body: BodyInfo, values: Recorded | None, what: str) -> Recorded:
    if values is None:
        raise ValueError(
            f"{body.kind} {body.name!r} has no recorded {what}: its file of results was written by "
            "an earlier version of fem_lie; run the scene again"
        )
    return values


def _named(items: tuple[Item, ...], name: str, what: str) -> Item:
    for item in items:
        if item.name == name:
            return item
    known = ", ".join(repr(item.name) for item in items) or "none"
    raise ValueError(f"there is no {what} {name!r}; there are: {known}")
