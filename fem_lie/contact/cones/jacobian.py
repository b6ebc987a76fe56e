"""Sparse contact Jacobian: blocks of one node each, contact by contact.

The same record holds the rows ``B`` of the relative velocities at contacts, and the rows of
``M⁻¹ B̄ᵀ``: the nodal velocities per unit impulse. For free rigid bodies ``M`` is block-diagonal
and both have the same nodes. Joints and elements transmit an impulse to other nodes, so that the
second has more blocks. The velocity of a node is ``ẋ`` in global axes and ``ω`` in its own, for
either group of its motion. Nodes that are no frames have ``ẋ`` only: a contact acts on their
positions, not on their gradients.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled, inlined_uncounted, uncounted
from fem_lie.lie.motions import local_components
from fem_lie.lie.node_types.node_type import POSITION_GRADIENT, axes
from fem_lie.lie.so3 import log_so3
from fem_lie.lie.tuples import Vector, dot, load, load_row, rotate, rotate_back


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
    """Uninitialised rows of at most ``width`` blocks per contact."""
    blocks = contacts * width
    whole = np.zeros(contacts + 1, dtype=np.int64), np.zeros(blocks, dtype=np.int64)
    return BlockRows(*whole, np.zeros((blocks, components, 6)))


@inlined_uncounted
def along(rows: BlockRows, c: int, v: Array, k: int) -> float:
    """One component of ``B v`` at contact ``c``; ``v`` has shape (nodes, 6)."""
    total = 0.0
    for s in range(rows.first[c], rows.first[c + 1]):
        node = rows.nodes[s]
        for at in range(6):
            total += rows.values[s, k, at] * v[node, at]
    return total


@inlined_uncounted
def add_response(responses: BlockRows, c: int, k: int, impulse: float, v: Array) -> None:
    """Add to ``v`` (nodes, 6) the velocities due to component ``k`` of an impulse."""
    for s in range(responses.first[c], responses.first[c + 1]):
        node = responses.nodes[s]
        for at in range(6):
            v[node, at] += impulse * responses.values[s, k, at]


@inlined_uncounted
def along_all(rows: BlockRows, c: int, v: Array) -> Vector:
    """All components of ``B v`` at contact ``c``; each velocity is read once."""
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
def add_responses(responses: BlockRows, c: int, r: Vector, v: Array) -> None:
    """Add to ``v`` (nodes, 6) the velocities due to an impulse at contact ``c``."""
    values = responses.values
    for s in range(responses.first[c], responses.first[c + 1]):
        node = responses.nodes[s]
        for at in range(6):
            more = r[0] * values[s, 0, at] + r[1] * values[s, 1, at] + r[2] * values[s, 2, at]
            v[node, at] += more


@uncounted
def rates(rows: BlockRows, v: Array, out: Array) -> None:
    """Relative velocities ``B v`` of all contacts, shape (m, 3)."""
    for c in range(out.shape[0]):
        out[c, 0], out[c, 1], out[c, 2] = along_all(rows, c, v)


@uncounted
def twist_rates(rows: BlockRows, kinds: Indices, H: Array, twists: Array, out: Array) -> None:
    """:func:`rates` of twists in the axes of nodes at ``H``; nodes without a twist are at rest."""
    for c in range(out.shape[0]):
        u0, u1, u2 = 0.0, 0.0, 0.0
        for s in range(rows.first[c], rows.first[c + 1]):
            node, values = rows.nodes[s], rows.values[s]
            if node >= twists.shape[0]:
                continue
            e1, e2, e3 = axes(kinds[node], H[node])
            v, ω = rotate(e1, e2, e3, load(twists[node], 0)), load(twists[node], 3)
            if kinds[node] >= POSITION_GRADIENT:
                ω = (0.0, 0.0, 0.0)
            u0 += dot(load(values[0], 0), v) + dot(load(values[0], 3), ω)
            u1 += dot(load(values[1], 0), v) + dot(load(values[1], 3), ω)
            u2 += dot(load(values[2], 0), v) + dot(load(values[2], 3), ω)
        out[c, 0], out[c, 1], out[c, 2] = u0, u1, u2


@compiled
def slides(
    rows: tuple[BlockRows, BlockRows], kinds: Indices, H: tuple[Array, Array], out: Array
) -> None:
    """Relative displacements of contacts between two frames, by the mean of ``B``, shape (k, 3)."""
    d, D, θ = np.empty(6), np.empty((3, 3)), np.empty(3)
    first, last = rows
    for c in range(out.shape[0]):
        out[c] = 0.0
        for s in range(first.first[c], first.first[c + 1]):
            node = first.nodes[s]
            before, after = H[0][node], H[1][node]
            for k in range(3):
                d[k] = after[0, k] - before[0, k]
            if kinds[node] >= POSITION_GRADIENT:
                θ[:] = 0.0
            else:
                for k in range(3):
                    axis = local_components(before, load_row(after, 1 + k))
                    D[k, 0], D[k, 1], D[k, 2] = axis
                log_so3(D, θ)
            d[3:] = θ
            for k in range(3):
                for at in range(6):
                    mean = 0.5 * (first.values[s, k, at] + last.values[s, k, at])
                    out[c, k] += mean * d[at]


@uncounted
def add_local_forces(
    nodes: Indices,
    numbers: Indices,
    forces: Array,
    kinds: Indices,
    H: Array,
    free: Flags,
    out: Array,
) -> None:
    """Add blocks of forces to right-hand sides in the axes of nodes at ``H``.

    Args:
        nodes: Node of each block, shape (b,).
        numbers: Index of the right-hand side of each block, shape (b,).
        forces: Blocks of forces, shape (b, 3, 6).
        kinds: Types of the nodes.
        H: Frames of the nodes.
        free: Whether each unknown is free, shape (n, 6).
        out: Right-hand sides, shape (n, 6, s, 3).
    """
    for b in range(nodes.shape[0]):
        node, s = nodes[b], numbers[b]
        e1, e2, e3 = axes(kinds[node], H[node])
        turns = kinds[node] < POSITION_GRADIENT
        for k in range(3):
            local = rotate_back(e1, e2, e3, load(forces[b, k], 0))
            for at in range(3):
                if free[node, at]:
                    out[node, at, s, k] += local[at]
                if turns and free[node, 3 + at]:
                    out[node, 3 + at, s, k] += forces[b, k, 3 + at]


@uncounted
def take_local_velocities(
    nodes: Indices,
    numbers: Indices,
    x: Array,
    kinds: Indices,
    H: Array,
    free: Flags,
    out: Array,
) -> None:
    """Blocks (b, 3, 6) of the solutions (n, 6, s, 3); the inverse of :func:`add_local_forces`."""
    for b in range(nodes.shape[0]):
        node, s = nodes[b], numbers[b]
        e1, e2, e3 = axes(kinds[node], H[node])
        turns = 1.0 if kinds[node] < POSITION_GRADIENT else 0.0
        for k in range(3):
            u = (x[node, 0, s, k], x[node, 1, s, k], x[node, 2, s, k])
            held = free[node, 0], free[node, 1], free[node, 2]
            u = (u[0] * held[0], u[1] * held[1], u[2] * held[2])
            v = rotate(e1, e2, e3, u)
            for at in range(3):
                out[b, k, at] = v[at]
                out[b, k, 3 + at] = turns * x[node, 3 + at, s, k] * free[node, 3 + at]
