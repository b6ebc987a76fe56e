"""Points and bodies to which items of a scene refer, and items that refer to parts of bodies."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from copy import copy
from dataclasses import fields, is_dataclass
from functools import cache, cached_property
from typing import Any, TypeVar

from fem_lie._arrays import Indices
from fem_lie.bodies.body import Body, Point

Item = TypeVar("Item")


def references(item: object) -> Iterator[Body | Point]:
    """Points to which an item refers, and bodies to which it refers other than by a point.

    Args:
        item: A joint, spring, drive, gear, link, contact, load or support.
    """
    if isinstance(item, Body | Point):
        yield item
    elif is_dataclass(item) and not isinstance(item, type):
        for field in fields(item):
            yield from references(getattr(item, field.name))
    elif isinstance(item, tuple | list):
        for each in item:
            yield from references(each)


def nodes_of(point: Point) -> list[int]:
    """Nodes of its body on which a point depends."""
    attachment = point.any_attachment
    return [point.node] if attachment is None else [point.node, *attachment.nodes]


@cache
def cached_names(of: type) -> tuple[str, ...]:
    """Names of the properties of a class that its objects compute once from their fields."""
    named = (pair for base in of.__mro__ for pair in vars(base).items())
    return tuple(name for name, value in named if isinstance(value, cached_property))


class Restricted:
    """Items of a scene as items on parts of its bodies.

    Attributes:
        bodies: Part of each divided body, and the numbers of its nodes in the body.
    """

    def __init__(self, bodies: Mapping[Body, tuple[Body, Indices]]) -> None:
        """Store the parts."""
        self.bodies = bodies
        # coordinates refer to joints of the scene, which stay one object each
        self._known: dict[int, tuple[object, Any]] = {}

    def item(self, item: Item) -> Item:
        """The item, or one that refers to the parts of divided bodies instead; without checks.

        Args:
            item: An item of a scene all of whose points are in these parts.
        """
        if id(item) not in self._known:
            self._known[id(item)] = item, self._made(item)
        found: Item = self._known[id(item)][1]
        return found

    def _made(self, item: Any) -> Any:
        if isinstance(item, Body):
            return self.bodies[item][0] if item in self.bodies else item
        if isinstance(item, Point):
            return self._point(item)
        if isinstance(item, tuple | list):
            parts = [self.item(each) for each in item]
            if all(new is old for new, old in zip(parts, item, strict=True)):
                return item
            return type(item)(*parts) if hasattr(item, "_fields") else type(item)(parts)
        if not is_dataclass(item) or isinstance(item, type):
            return item
        given = {field.name: getattr(item, field.name) for field in fields(item)}
        made = {name: self.item(value) for name, value in given.items()}
        if all(made[name] is given[name] for name in given):
            return item
        found = copy(item)
        for name in cached_names(type(item)):  # such as the pair of surfaces of a contact
            vars(found).pop(name, None)
        for name, value in made.items():
            object.__setattr__(found, name, value)
        return found

    def _point(self, point: Point) -> Point:
        if point.body is None or point.body not in self.bodies:
            return point
        body, nodes = self.bodies[point.body]
        at = {int(node): k for k, node in enumerate(nodes)}
        attachment = point.attachment
        if attachment is not None:
            own = tuple(at[node] for node in attachment.nodes)
            attachment = attachment._replace(nodes=own)
        return Point(body, at[point.node], point.name, attachment)
