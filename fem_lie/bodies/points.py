"""Points of bodies and of ground, and checks of arguments that are points."""

from __future__ import annotations

import numpy.typing as npt

from fem_lie._arrays import instance, vector
from fem_lie.bodies.body import Point

A_POINT = "a point such as body.point('end'), body.point(3) or ground()"
"""Description of a point, for messages."""


def require_point(value: object, what: str) -> None:
    """Raise an error unless ``value`` is a point of a body or of ground.

    Args:
        value: Value to check.
        what: Name of the argument, as "PointLoad: point".

    Raises:
        TypeError: It is something else.
    """
    instance(value, Point, what, A_POINT)


def require_node(point: Point, what: str) -> None:
    """Raise an error unless the point is a node, where unknowns of a node are needed.

    Args:
        point: A point.
        what: What needs it, as "a clamp".

    Raises:
        ValueError: It is not a node.
    """
    if point.attachment is not None and not point.attachment.kind.rigid:
        raise ValueError(
            f"{what} needs a node, got {point.label}, which is not a node: hold it by a joint "
            "such as Fixed, or place a node of the mesh there"
        )


def ground(position: npt.ArrayLike | None = None) -> Point:
    """Point of the ground, which is fixed in space.

    Args:
        position: Its position, global components, shape (3,); default: the ground is everywhere: a
            joint to it is where its other point is, and a contact surface at the origin.

    Raises:
        ValueError: The position has another shape.
    """
    return Point(None, place=None if position is None else vector(position, 3, "ground: position"))
