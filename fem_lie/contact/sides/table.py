"""The two sides of a contact as arrays, for compiled code."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple, TypeAlias

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie.bodies.body import Body
from fem_lie.contact.sides.surfaces import MOST_NODES, Ball, Face

GROUND, UNUSED = -1, -2
"""Instead of a node: the frame that does not move, and none."""

Nodes: TypeAlias = Callable[[Body], Indices]
"""Numbers of a body's nodes."""


class Side(NamedTuple):
    """Places ``P = Σ (wᵢ xᵢ + Rᵢ cᵢ)`` with a radius, or in a plane.

    Attributes:
        nodes: Of each place, :data:`UNUSED` after the last, shape (n, 4).
        weights: ``w``, shape (n, 4).
        levers: ``c``, shape (n, 4, 3).
        radii: Negative around a hollow, zero in a plane, shape (n,).
        normals: Of a plane, in the frame of its first node; else zero, shape (n, 3).
        owners: The frame that each is fixed to, the same number for the same frame, shape (n,).
    """

    nodes: Indices
    weights: Array
    levers: Array
    radii: Array
    normals: Array
    owners: Indices


class BothSides(NamedTuple):
    """Both sides of a contact of points.

    Attributes:
        a: Points with a radius.
        b: Planes, or points with a radius.
        flat: Whether the second are planes.
        same: Whether the second side is the first one again.
    """

    a: Side
    b: Side
    flat: bool
    same: bool


def balls_side(balls: Sequence[Ball], nodes: Nodes) -> Side:
    """Balls as a side.

    Args:
        balls: All of them.
        nodes: Numbers of the nodes of a body.
    """
    found = empty_side(len(balls))
    for i, ball in enumerate(balls):
        k = len(ball.owners)
        found.nodes[i, :k] = [number_of(*owner, nodes) for owner in ball.owners]
        found.weights[i, :k], found.levers[i, :k] = ball.weights, ball.levers
        found.radii[i], found.owners[i] = ball.radius, _frame_of(*ball.owners[0], nodes)
    return found


def planes_side(faces: Sequence[Face], nodes: Nodes) -> Side:
    """Planes as a side; arguments as :func:`balls_side`."""
    found = empty_side(len(faces))
    for i, face in enumerate(faces):
        found.nodes[i, 0] = number_of(*face.owner, nodes)
        found.weights[i, 0], found.levers[i, 0] = 1.0, face.origin
        found.normals[i], found.owners[i] = face.normal, _frame_of(*face.owner, nodes)
    return found


def joined_sides(sides: Sequence[Side]) -> Side:
    """Several sides as one."""
    return Side(*(np.concatenate(parts) for parts in zip(*sides, strict=True)))


def empty_side(n: int) -> Side:
    """Room for ``n`` places."""
    return Side(
        np.full((n, MOST_NODES), UNUSED),
        np.zeros((n, MOST_NODES)),
        np.zeros((n, MOST_NODES, 3)),
        np.zeros(n),
        np.zeros((n, 3)),
        np.zeros(n, dtype=np.int64),
    )


def on_leaders(side: Side, leader: Indices, offset: Array) -> Side:
    """The same places, by the nodes that their nodes follow.

    Args:
        side: On all nodes.
        leader: Of each node, shape (N,).
        offset: Its frame in that of its leader, shape (N, 4, 3).
    """
    moved = side._replace(
        nodes=side.nodes.copy(), levers=side.levers.copy(), normals=side.normals.copy()
    )
    for i, k in np.argwhere(side.nodes >= 0):
        node = side.nodes[i, k]
        x, R = lie.position(offset[node]), lie.rotation(offset[node])
        moved.nodes[i, k] = leader[node]
        moved.levers[i, k] = side.weights[i, k] * x + R @ side.levers[i, k]
        if k == 0:
            moved.normals[i] = R @ side.normals[i]
    return moved


def least(*radii: Array) -> float:
    """Of those of what is round; infinite if nothing is."""
    return float(min(each[each > 0.0].min(initial=np.inf) for each in radii))


def number_of(body: Body | None, node: int, nodes: Nodes) -> int:
    """Of a node among all, or of ground."""
    return GROUND if body is None else int(nodes(body)[node])


def _frame_of(body: Body | None, node: int, nodes: Nodes) -> int:
    """The node that a node follows within its body."""
    if body is None:
        return GROUND
    return int(nodes(body)[int(body.leaders[node])])
