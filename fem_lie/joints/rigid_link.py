"""Rigid links: points that move as one rigid body."""

from __future__ import annotations

from dataclasses import dataclass

from fem_lie.bodies.body import Point
from fem_lie.bodies.points import require_node, require_point


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
