"""Sparse contact Jacobian: blocks of one node each, of every contact one after the other.

The same record holds the rows ``B`` of the relative velocities at contacts and the rows of
``M⁻¹ B̄ᵀ``, the velocities that unit impulses give the nodes. For free rigid bodies ``M`` is
block-diagonal and both have the same nodes; joints and elements transmit an impulse to other nodes,
so that the second has more.
Velocities of a node are ``ẋ`` in global axes and ``ω`` in its own, whatever group it moves on.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined_uncounted, uncounted
from fem_lie.lie.tuples import Vector


class BlockRows(NamedTuple):
    """Sparse rows of contacts.

    Attributes:
        first: First block of each contact, then the end of the last one, shape (m + 1,).
        nodes: Node of each block, shape (b,).
        values: Blocks along the normal, or along it and two tangents, shape (b, 1 or 3, 6).
    """

    first: Indices
    nodes: Indices
    values: Array


def empty_rows(contacts: int, width: int, components: int) -> BlockRows:
    """Memory for rows of at most ``width`` blocks per contact; there is none yet."""
    blocks = contacts * width
    whole = np.zeros(contacts + 1, dtype=np.int64), np.zeros(blocks, dtype=np.int64)
    return BlockRows(*whole, np.zeros((blocks, components, 6)))


@inlined_uncounted
def along(rows: BlockRows, c: int, v: Array, k: int) -> float:
    """A component of ``B v`` at contact ``c``; ``v`` has shape (nodes, 6)."""
    total = 0.0
    for s in range(rows.first[c], rows.first[c + 1]):
        node = rows.nodes[s]
        for at in range(6):
            total += rows.values[s, k, at] * v[node, at]
    return total


@inlined_uncounted
def push(pushes: BlockRows, c: int, k: int, impulse: float, v: Array) -> None:
    """Add to ``v`` (nodes, 6) what an impulse along a component at contact ``c`` does."""
    for s in range(pushes.first[c], pushes.first[c + 1]):
        node = pushes.nodes[s]
        for at in range(6):
            v[node, at] += impulse * pushes.values[s, k, at]


@inlined_uncounted
def along_all(rows: BlockRows, c: int, v: Array) -> Vector:
    """``B v`` at contact ``c``, with its two tangents; each velocity is read once."""
    values, u0, u1, u2 = rows.values, 0.0, 0.0, 0.0
    for s in range(rows.first[c], rows.first[c + 1]):
        node = rows.nodes[s]
        for at in range(6):
            here = v[node, at]
            u0 += values[s, 0, at] * here
            u1 += values[s, 1, at] * here
            u2 += values[s, 2, at] * here
    return u0, u1, u2


@inlined_uncounted
def push_all(pushes: BlockRows, c: int, r: Vector, v: Array) -> None:
    """Add to ``v`` (nodes, 6) what an impulse at contact ``c`` does, with its two tangents."""
    values = pushes.values
    for s in range(pushes.first[c], pushes.first[c + 1]):
        node = pushes.nodes[s]
        for at in range(6):
            more = r[0] * values[s, 0, at] + r[1] * values[s, 1, at] + r[2] * values[s, 2, at]
            v[node, at] += more


@uncounted
def rates(rows: BlockRows, v: Array, out: Array) -> None:
    """``B v`` of all contacts, shape (m, 3)."""
    for c in range(out.shape[0]):
        out[c, 0], out[c, 1], out[c, 2] = along_all(rows, c, v)
