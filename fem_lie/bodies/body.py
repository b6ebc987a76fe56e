"""Bodies with nodal frames, and points on them.

A body has nodes with frames, inertia, and unless it is rigid an elastic assembly that it shares
with all bodies of its kind. It does not depend on unknowns, solvers or other bodies.
"""

from __future__ import annotations

from collections.abc import Iterator
from copy import copy
from dataclasses import dataclass
from typing import TypeAlias, TypeVar

import numpy as np
import numpy.typing as npt

from fem_lie import lie
from fem_lie._arrays import Array, Indices, choice, instance, number, text, vector
from fem_lie._summary import Summarised
from fem_lie.attachments.attachment import AttachmentFrame
from fem_lie.bodies.model import BodyModel, MaterialPoint
from fem_lie.lie.motions import Group

Where: TypeAlias = str | int | npt.ArrayLike
"""Point of a body: its name, the number of a node, or a position, shape (3,)."""

_NEAR = 1e-6
"""Largest distance of a position from the point taken for it, per size of the body."""


AnyBody = TypeVar("AnyBody", bound="Body")


class Body(Summarised):
    """Body with nodes and named points.

    Attributes:
        model: What the assembly sees of the body: elements, constraints, data of the cells.
    """

    model: BodyModel

    def __init__(self, model: BodyModel) -> None:
        """Take the model of the body.

        Args:
            model: Nodes, elements and how they are assembled.
        """
        self.model = model

    def __copy__(self: AnyBody) -> AnyBody:
        """Body with a copy of the model; both models share their arrays."""
        other = type(self).__new__(type(self))
        Body.__init__(other, copy(self.model))
        return other

    @property
    def name(self) -> str:
        """Name in messages and results; the scene chooses one if it is empty."""
        return self.model.name

    @name.setter
    def name(self, name: str) -> None:
        self.model.name = name

    @property
    def label(self) -> str:
        """Name of the body, or its class if it has none yet."""
        return self.model.label

    @property
    def frames(self) -> Array:
        """Initial frames of the nodes, shape (n, 4, 3), see :mod:`fem_lie.lie`."""
        return self.model.frames

    @property
    def velocities(self) -> Array:
        """Initial velocities of the nodes along their axes: translation, rotation, shape (n, 6)."""
        return self.model.velocities

    @velocities.setter
    def velocities(self, velocities: Array) -> None:
        self.model.velocities = velocities

    def set_group(self: AnyBody, group: Group) -> AnyBody:
        """Choose the group on which the nodes move in time integration, and return the body.

        Args:
            group: SE(3) or R³×SO(3).

        Raises:
            ValueError: ``group`` is not a member of :class:`Group`.
        """
        self.model.group = choice(group, Group, f"{type(self).__name__}: group")
        return self

    def point(self, where: Where, *, tolerance: float | None = None) -> Point:
        """Point with a name, at a node or at a position, for joints, loads and results.

        Args:
            where: Name of a point such as "end"; or the number of a node; or a position in the
                reference configuration, shape (3,), for the closest material point.
            tolerance: Largest distance from a position, a length; default: 1e-6 of the size of the
                body.

        Raises:
            ValueError: There is no such point; the message lists those that exist, or gives the
                distance of the closest one.
            TypeError: It is neither a name, nor a whole number, nor a position.
        """
        size = self.model.size
        limit = _NEAR * size if tolerance is None else number(tolerance, "point: tolerance")
        if isinstance(where, str):
            return self._at(self.model.named(where))
        if isinstance(where, int | np.integer):
            return self._at(self.model.numbered(int(where)))
        position = vector(where, 3, f"a name, a node or the position of a point of {self.label}")
        found = self._at(self.model.closest(position))
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
        return [self._at(self.model.numbered(int(node))) for node in self.nodes(where)]

    def nodes(self, where: str) -> Indices:
        """Numbers of the nodes of a named set; arguments and errors as of :meth:`points`.

        Args:
            where: Name of the point, curve, face or group.
        """
        if isinstance(where, Point):
            raise TypeError(
                f"expected the name of a curve, face or group of {self.label}, got the point "
                f"{where.label!r}: supports of single points are items of the scene, as "
                "scene.add(fl.Clamp(point))"
            )
        text(where, f"the name of a set of points of {self.label}")
        return self.model.nodes(where)

    def _at(self, found: MaterialPoint) -> Point:
        """Point of this body at a material point of its model."""
        return Point(self, *found)

    def _summary(self) -> Iterator[tuple[str, object]]:
        """Name, frames of the nodes, nodes of the cells, named points."""
        model = self.model
        yield "name", self.name
        yield "frames", model.frames
        yield from (("model.cells", model.cells),) if len(model.cells) else ()
        yield "model.point_names", sorted(model.point_names)

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
        self.model.add_rigid_motion(translation, spin, centre)


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
        place: Position of a point of ground, shape (3,); ``None``: ground is everywhere, so that
            joints to it are where their other point is.
    """

    body: Body | None
    node: int = 0
    name: str = ""
    attachment: AttachmentFrame | None = None
    place: Array | None = None

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
    def is_everywhere(self) -> bool:
        """Whether it is ground without a position."""
        return self.body is None and self.place is None

    @property
    def position(self) -> Array:
        """Initial position, shape (3,)."""
        return self.frame[0]

    @property
    def frame(self) -> Array:
        """Initial frame, shape (4, 3)."""
        if self.body is None:
            return lie.frame(np.zeros(3) if self.place is None else self.place, np.eye(3))
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
            return self.body.model.attachment_of(self.node)
        return None if self.attachment.kind.rigid else self.attachment

    def same(self, other: Point) -> bool:
        """Whether the other point is the same material point.

        Args:
            other: Another point.
        """
        if self.is_ground and other.is_ground:
            same_place = np.array_equal(self.position, other.position)
            return same_place and self.is_everywhere == other.is_everywhere
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
        return 1.0 if self.body is None else self.body.model.size

    @property
    def label(self) -> str:
        """For messages and results."""
        if self.body is not None:
            return f"{self.body.label}.{self.name}"
        if self.place is None:
            return "ground"
        return f"ground at ({', '.join(f'{x:g}' for x in self.place)})"


def _position_of(about: Point | npt.ArrayLike) -> Array:
    return about.position if isinstance(about, Point) else vector(about, 3, "about")
