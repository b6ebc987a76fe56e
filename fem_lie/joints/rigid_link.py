"""Rigid links and kinematic couplings: points that move as one rigid body."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from fem_lie import lie
from fem_lie._arrays import Array, flag, text, vector
from fem_lie.bodies.body import Point
from fem_lie.bodies.points import require_node, require_point
from fem_lie.joints.connection import Connection, ConstraintDefinition
from fem_lie.joints.equations import functions as joint_functions
from fem_lie.joints.kinds import Fixed, Spherical
from fem_lie.lie.node_types import TRAITS, NodeType


@dataclass(frozen=True, eq=False)
class RigidLink:
    """Point ``b`` is rigidly attached to point ``a``.

    The link eliminates the unknowns of the node of ``b`` (master–slave elimination): there are no
    multipliers and results report no force. :class:`Fixed` is the same connection as a joint.

    Attributes:
        a: A point of a body.
        b: A point of this or another body, anywhere.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> tube = fl.Section.circle(0.01, steel)
        >>> beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), tube, cells=4)
        >>> wheel = fl.RigidBody(2.0, (0.1, 0.1, 0.2), position=(1, 0, 0))
        >>> scene = fl.Scene()
        >>> for body in (beam, wheel):
        ...     _ = scene.add(body)
        ...
        >>> _ = scene.add(fl.joints.RigidLink(beam.point("end"), wheel.point("centre")))
        >>> len(scene.links)
        1
    """

    a: Point
    b: Point

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if an argument is not a point."""
        require_point(self.a, "RigidLink: a")
        require_point(self.b, "RigidLink: b")

    def check(self) -> None:
        """Raise ``ValueError`` if a point is ground, or both points are the same."""
        if self.a.is_ground or self.b.is_ground:
            raise ValueError("a rigid link needs two points of bodies, got ground; use a Clamp")
        require_node(self.a, "a rigid link")
        require_node(self.b, "a rigid link")
        if self.a.same(self.b):
            raise ValueError(f"the rigid link joins {self.a.label} to itself")

    @property
    def label(self) -> str:
        """Name of the link in messages."""
        return f"RigidLink({self.a.label}, {self.b.label})"


_SELECTIONS = {NodeType.FRAME: Fixed.selection, NodeType.POSITION: Spherical.selection}
"""Components of the relative motion that are held, by the type of the node."""


@dataclass(frozen=True, eq=False)
class KinematicCoupling(Connection):
    """A group of nodes moves as one rigid body with point ``a``: a kinematic coupling, RBE2.

    Nodes with positions (solids) keep their positions in the frame of ``a``, nodes with frames
    (shells, beams) their rotations, too. The group cannot deform, and holds the material around it;
    a joint on ``solid.point("hole")``, the mean frame of the nodes (RBE3), leaves them free to
    deform. Rigid motion is exact for rotations of any size.

    Each position has three constraints with multipliers, each frame six. Results report their
    resultant: the force and the moment about the reference position, that the nodes exert on ``a``,
    along axes that are global at the start and rotate with ``a``.

    Attributes:
        a: A point of a body, or :func:`~fem_lie.bodies.points.ground`.
        group: Nodes that move with it, such as ``solid.points("hole")``, of one or several bodies;
            ``a`` itself may be among them.
        at: Reference position at the start, global components; default: the point ``a``, for ground
            the mean position of the group.
        name: Name in messages and results; default: class name and points.
        active: Whether it acts from the start; :class:`~fem_lie.schemes.Lock` and
            :class:`~fem_lie.schemes.Release` switch it.

    Example:
        >>> rubber = fl.sections.NeoHooke(E=1e6, nu=0.3, density=1100.0)
        >>> block = fl.Solid.brick((0.2, 0.1, 0.1), rubber, cells=(2, 1, 1), name="block")
        >>> held = block.clamp("a=0")
        >>> plate = fl.RigidBody(1.0, (1e-3, 1e-3, 1e-3), position=(0.2, 0.05, 0.05))
        >>> scene = fl.Scene()
        >>> for body in (block, plate):
        ...     _ = scene.add(body)
        ...
        >>> centre = plate.point("centre")
        >>> weld = scene.add(fl.joints.KinematicCoupling(centre, block.points("a=1")))
        >>> _ = scene.add(fl.PointLoad(centre, force=(0.0, 0.0, -10.0)))
        >>> force = fl.statics(scene).joint_force(weld, axes="global")[-1, :3]
        >>> print(force.round(6) + 0.0)
        [ 0.  0. 10.]
    """

    a: Point
    group: Sequence[Point]
    at: npt.ArrayLike | None = None
    name: str = ""
    active: bool = field(default=True, kw_only=True)

    def __post_init__(self) -> None:
        """Raise ``TypeError`` if an argument has a wrong type."""
        require_point(self.a, "KinematicCoupling: a")
        group = tuple(self.group)
        for point in group:
            require_point(point, "KinematicCoupling: group")
        if self.a.attachment is None:
            own = self.a.body, self.a.node
            group = tuple(point for point in group if (point.body, point.node) != own)
        object.__setattr__(self, "group", group)
        text(self.name, "KinematicCoupling: name")
        flag(self.active, "KinematicCoupling: active")

    @property
    def label(self) -> str:
        """Name in messages and results."""
        if self.name or not self.group:
            return self.name or f"KinematicCoupling({self.a.label})"
        first = self.group[0].label
        return f"KinematicCoupling({self.a.label}, {len(self.group)} nodes from {first})"

    @property
    def points(self) -> list[Point]:
        """Point a and the group."""
        return [self.a, *self.group]

    def check(self) -> None:
        """Raise ``ValueError`` if the group is empty, has a node twice, or other nodes."""
        if not self.group:
            raise ValueError(
                f"{self.label}: expected nodes other than {self.a.label} in the group, got none"
            )
        nodes = set()
        for point in self.group:
            if point.body is None or point.attachment is not None:
                raise ValueError(f"{self.label}: expected nodes of bodies, got {point.label}")
            kind = point.body.model.node_types[point.node]
            if kind not in _SELECTIONS:
                has = TRAITS[NodeType(kind)].description
                raise ValueError(
                    f"{self.label}: expected nodes with frames or positions, but those of "
                    f"{point.body.label} have {has}"
                )
            nodes.add((point.body, point.node))
        if len(nodes) < len(self.group):
            raise ValueError(f"{self.label}: a node is in the group twice")
        self._reference()

    def definitions(self) -> list[ConstraintDefinition]:
        """One for each node; all have the same frame A."""
        found, first, reference = [], 0, self._reference()
        for point in self.group:
            assert point.body is not None
            selection = _SELECTIONS[NodeType(point.body.model.node_types[point.node])]
            own, count = lie.frame(point.position, np.eye(3)), len(selection)
            none, of = np.zeros((count, joint_functions.COUNT)), range(first, first + count)
            found.append(ConstraintDefinition(self.a, point, (reference, own), selection, none, of))
            first += count
        return found

    @property
    def size(self) -> int:
        """Number of constraints."""
        return sum(len(definition.rows) for definition in self.definitions())

    @property
    def summed(self) -> bool:
        """Whether results report the sum of the forces of all definitions: yes."""
        return True

    def _reference(self) -> Array:
        """Frame A at the start, with global axes, shape (4, 3)."""
        if self.at is not None:
            position = vector(self.at, 3, f"{self.label}: at")
        elif self.a.is_ground:
            position = np.mean([point.position for point in self.group], axis=0)
        else:
            position = self.a.position
        return lie.frame(position, np.eye(3))
