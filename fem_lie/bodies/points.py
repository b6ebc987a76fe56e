"""Points of bodies and of what does not move: what arguments are checked by."""

from __future__ import annotations

from fem_lie._arrays import instance
from fem_lie.bodies.body import Point

A_POINT = "a point such as body.point('end'), body.point(3) or ground()"
"""What a point is, for messages."""


def require_point(value: object, what: str) -> None:
    """Refuse what is no point of a body and not ground.

    Args:
        value: What was given.
        what: For what, as "PointLoad: point".

    Raises:
        TypeError: It is something else.
    """
    instance(value, Point, what, A_POINT)


def require_node(point: Point, what: str) -> None:
    """Refuse points that are no nodes where unknowns of a node are needed.

    Args:
        point: A point.
        what: For what, as "a clamp".

    Raises:
        ValueError: It is none.
    """
    if point.attachment is not None and not point.attachment.kind.rigid:
        raise ValueError(
            f"{what} needs a node, got {point.label}, which is none: hold it by a joint such as "
            "Fixed, or put a node of the mesh there"
        )


def ground() -> Point:
    """What does not move."""
    return Point(None)
