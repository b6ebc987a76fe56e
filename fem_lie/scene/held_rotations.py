"""Items of a scene that act on rotations of nodes.

A node of a shell on which such an item acts needs a drilling rotation, see
:mod:`fem_lie.elements.shells.drilling`. This is a property of the scene and not of the body, which
may be in several scenes.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TypeAlias

import numpy as np

from fem_lie.bodies.body import Body, Point
from fem_lie.bodies.model import BodyModel, HeldRotation, Holds
from fem_lie.bodies.points import ground
from fem_lie.contact.contact import Contact
from fem_lie.joints.connection import Connection
from fem_lie.joints.rigid_link import RigidLink
from fem_lie.lie.node_types import NodeType
from fem_lie.scene.load import Load
from fem_lie.scene.nodal_loads import PointLoad
from fem_lie.scene.supports import Clamp, PrescribedMotion

Holding: TypeAlias = Connection | RigidLink | Load | Clamp | PrescribedMotion | Contact


def held_by(item: Holding) -> Iterator[tuple[Body, HeldRotation]]:
    """Bodies on whose nodal rotations an item acts, with the node and the item."""
    if isinstance(item, Connection):
        yield from _by_connection(item)
    elif isinstance(item, RigidLink):
        yield from _by_each_other(item.label, item.a, item.b)
    elif isinstance(item, PrescribedMotion):
        yield from _by_each_other(type(item).__name__, item.point, ground())
    elif isinstance(item, Contact):
        yield from item.held_rotations
    elif isinstance(item, PointLoad) and np.any(item.moment):
        what = f"the moment at {item.point.label}"
        yield item.body, HeldRotation(item.point.node, item, what, item.axis())


def held_in(items: Iterable[Holding]) -> Holds:
    """Items that act on the nodal rotations of each body, in the order of the items."""
    holds: dict[BodyModel, list[HeldRotation]] = {}
    for item in items:
        for body, hold in held_by(item):
            holds.setdefault(body.model, []).append(hold)
    return holds


def _by_connection(item: Connection) -> Iterator[tuple[Body, HeldRotation]]:
    # shells choose by it whether they drill; nodes of positions only have no rotation at all
    if not any(body is not None and _asks(body) for body in item.bodies):
        return
    turns = item.turns
    for definition in item.definitions():
        if turns:
            yield from _by_each_other(item.label, definition.a, definition.b)
        elif not definition.reversible:
            # the axes of the joint are those of frame a
            yield from _by_each_other(item.label, definition.a, ground())
    for rolling in item.velocity_definitions():
        yield from _by_each_other(item.label, rolling.a, rolling.b)
    if bushing := item.bushing_definition():
        yield from _by_each_other(item.label, bushing.a, bushing.b)


def _asks(body: Body) -> bool:
    return body.model.separates_director or body.model.node_type == NodeType.POSITION


def _by_each_other(what: str, a: Point, b: Point) -> Iterator[tuple[Body, HeldRotation]]:
    """Each of the two points acts on the rotation of the other."""
    for point, other in ((a, b), (b, a)):
        if point.body is not None:
            yield point.body, HeldRotation(point.node, (other.body, other.node), what)
