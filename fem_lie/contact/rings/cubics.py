"""Cubics through the nodes of a line, linear in the coordinates of at most four nodes.

Between two nodes a line is a Hermite cubic. At a frame its tangent is the first director, at a
position-gradient node the slope, and at nodes without either the slope of the parabola through a
node and its two neighbours. So the curve has no kinks.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.contact.sides.surfaces import MOST_NODES
from fem_lie.lie.node_types import NodeType

WITH_TANGENTS = (NodeType.FRAME, NodeType.POSITION_GRADIENT)
"""Types of nodes that have a tangent of their own."""


class Cubics(NamedTuple):
    """Ends and tangents of the cubic of each segment, in a parameter from 0 to 1.

    Attributes:
        slots: Indices along the line of the nodes that it depends on, −1: none, shape (m, 4).
        weights: Weights of their coordinate vectors 0 and 1 in both ends, then in both tangents,
            shape (m, 4, 2, 4).
    """

    slots: Indices
    weights: Array


def cubics(frames: Array, types: Indices, lengths: Array, *, closed: bool = False) -> Cubics:
    """Cubics of the segments between successive nodes.

    Args:
        frames: Initial nodal coordinates along the line, shape (n, 4, 3); a closed line has its
            first node at the end again.
        types: Types of the nodes, shape (n,).
        lengths: Undeformed lengths of the segments, shape (n − 1,).
        closed: Whether the line is closed.
    """
    m, own = len(lengths), bool(np.isin(types, WITH_TANGENTS).all())
    slots, found = np.full((m, MOST_NODES), -1), np.zeros((m, MOST_NODES, 2, 4))
    for k in range(m):
        chord = frames[k + 1, 0] - frames[k, 0]
        factors: list[dict[int, float]] = []
        for end in (k, k + 1):
            along = 1.0 if frames[end, 1] @ chord > 0.0 else -1.0
            factors.append({end: along} if own else _slope(lengths, end, closed))
        nodes = list(dict.fromkeys([k, k + 1, *factors[0], *factors[1]]))
        slots[k, : len(nodes)] = [node % m if closed else node for node in nodes]
        for end in range(2):
            found[k, end, 0, end] = 1.0
            for node, factor in factors[end].items():
                found[k, nodes.index(node), int(own), 2 + end] = lengths[k] * factor
    return Cubics(slots, found)


def _slope(lengths: Array, k: int, closed: bool) -> dict[int, float]:
    """Weights of positions in the slope at a node, that of the parabola through three nodes."""
    m = len(lengths)
    if m == 1:
        return {0: -1.0 / lengths[0], 1: 1.0 / lengths[0]}
    if k in (0, m) and not closed:
        # at an end: the slope of the neighbour's parabola
        inner, side = (1, 0) if k == 0 else (m - 1, m - 1)
        found = {node: -factor for node, factor in _slope(lengths, inner, closed).items()}
        found[side + 1] = found.get(side + 1, 0.0) + 2.0 / lengths[side]
        found[side] = found.get(side, 0.0) - 2.0 / lengths[side]
        return found
    a, b = lengths[(k - 1) % m], lengths[k % m]
    before, after = b / (a * (a + b)), a / (b * (a + b))
    return {k - 1: -before, k: before - after, k + 1: after}
