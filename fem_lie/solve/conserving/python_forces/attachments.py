"""Attachment frames of joints at nodes without frames, over a step; compiled.

An attachment frame is a function of its nodes. Its position is a linear combination of their
coordinates, so that its increment is ``J_x Δr``, exactly. It rotates by the vector ψ of the Cayley
map between both ends, and ``J_ω Δr``, with the Jacobian at the midpoint of the step, approximates ψ
to second order. The difference is corrected as in :mod:`..vector_cells.cells`: with the increment
``s`` of the attachment's nodes without their rigid part, in their metric ``M``::

    ψ = D Δr,        D = J_ω + (ψ − J_ω Δr) ⊗ M s/|s|²

A moment ``m`` on the attachment is applied as ``Dᵀ m`` on its nodes. It does its exact work on ψ,
and has the resultant and the moment of ``J_ωᵀ m``, because ``M s`` has neither.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import compiled, inlined
from fem_lie.lie.node_types.node_type import POSITION_GRADIENT, axes
from fem_lie.lie.tuples import (
    Vector,
    combined,
    cross,
    dot,
    load,
    load_row,
    minus,
    plus,
    rotate,
    rotate_back,
    scaled,
    store,
    store_row,
)
from fem_lie.solve.conserving.vector_cells.cell_arrays import (
    VectorCells,
    gather,
    has_position,
    largest_cell,
)
from fem_lie.solve.conserving.vector_cells.cells import (
    Work,
    part_of,
    rotation_of,
    take_centre,
    workspace_for,
)

_STILL = 1e-12
"""``|s|²`` over the square of the size below which the correction is round-off."""


class NodalSpan(NamedTuple):
    """Coordinates of all nodes over a step, (n, 4, 3).

    Attributes:
        mean: Means.
        delta: Increments.
        middle: Nodes at the midpoint of the step.
    """

    mean: Array
    delta: Array
    middle: Array


class AttachmentSpan(NamedTuple):
    """Attachments over a step, with an entry for each of their nodes.

    Attributes:
        cells: Their nodes and metric.
        turns: Attachments whose rotation matters, (g,).
        start: Frames at the start, (g, 4, 3).
        middle: Frames with the nodes at the midpoint of the step.
        end: Frames at the end.
        J: Twist of the attachment per motion of each entry along its axes, (e, 6, 6).
        left: ``ψ − J_ω Δr``, global components, (g, 3).
        per_length: ``M s/|s|²``, (e, 2, 3).
    """

    cells: VectorCells
    turns: Flags
    start: Array
    middle: Array
    end: Array
    J: Array
    left: Array
    per_length: Array


@compiled
def set_nodes(kinds: Indices, moved: NodalSpan, step: Array, mean: Array, delta: Array) -> None:
    """Means and increments (n, 4, 3) of frames, and of positions of nodes with constant axes.

    Args:
        kinds: Types of the nodes, (n,).
        moved: Means, increments and midpoint nodes.
        step: Increments, (n, 6).
        mean: Means, overwritten.
        delta: Increments, overwritten.
    """
    delta[: kinds.shape[0]] = 0.0
    for i in range(kinds.shape[0]):
        if kinds[i] < POSITION_GRADIENT:
            mean[i], delta[i] = moved.mean[i], moved.delta[i]
        elif has_position(kinds[i]):
            mean[i] = moved.middle[i]
            store_row(delta[i], 0, load(step[i], 0))


@compiled
def set_attachments(
    span: AttachmentSpan,
    nodes: tuple[Array, Array, Array, Array],
    mean: Array,
    delta: Array,
) -> None:
    """Means and increments (g, 4, 3) of attachments, and their rotations.

    Args:
        span: The attachments; ``left`` and ``per_length`` are overwritten.
        nodes: Nodal coordinates at the start of the step, their digits beyond double precision,
            coordinates at the midpoint, (≥ n, 4, 3), and increments of coordinate vectors, (n, 6).
        mean: Means, overwritten.
        delta: Increments, overwritten.
    """
    cells, (H, rest, middle, step) = span.cells, nodes
    workspace = workspace_for(largest_cell(cells.first))
    span.per_length[:] = 0.0
    for g in range(span.turns.shape[0]):
        moved, turned = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        for e in range(cells.first[g], cells.first[g + 1]):
            i, J = cells.nodes[e], span.J[e]
            d1, d2, d3 = axes(cells.kinds[e], middle[i])
            for at in (0, 3):
                own = rotate_back(d1, d2, d3, load(step[i], at))
                for k in range(3):
                    moved = plus(moved, scaled(own[k], (J[0, at + k], J[1, at + k], J[2, at + k])))
                    column = J[3, at + k], J[4, at + k], J[5, at + k]
                    turned = plus(turned, scaled(own[k], column))
        F = span.middle[g]
        a1, a2, a3 = load_row(F, 1), load_row(F, 2), load_row(F, 3)
        mean[g], delta[g] = F, 0.0
        store_row(delta[g], 0, rotate(a1, a2, a3, moved))
        if span.turns[g]:
            ψ = _turn(span.start[g], span.end[g], mean[g], delta[g])
            store(span.left[g], 0, minus(ψ, rotate(a1, a2, a3, turned)))
            work = part_of(workspace, cells.first[g + 1] - cells.first[g])
            _deform(cells, g, H, rest, step, work, span.per_length)


@inlined
def _turn(before: Array, after: Array, mean: Array, delta: Array) -> Vector:
    """Set means and increments of the axes; returns the vector of the Cayley map."""
    twice, trace = (0.0, 0.0, 0.0), 0.0
    for k in range(1, 4):
        d, other = load_row(before, k), load_row(after, k)
        change = minus(other, d)
        store_row(delta, k, change)
        store_row(mean, k, combined(1.0, d, 0.5, change))
        twice = plus(twice, cross(d, change))
        trace += dot(d, other)
    return scaled(2.0 / (1.0 + trace), twice)


@inlined
def _deform(
    cells: VectorCells, g: int, H: Array, rest: Array, step: Array, work: Work, out: Array
) -> None:
    """``M s/|s|²`` of one attachment into its entries of ``out``, zero at round-off."""
    r, d, begin = work.r, work.d, cells.first[g]
    count = r.shape[0]
    mine, kinds = cells.nodes[begin : begin + count], cells.kinds[begin : begin + count]
    gather(kinds, mine, H, rest, r)
    for a in range(count):
        for k in range(2):
            moved = load(step[mine[a]], 3 * k)
            store_row(d[a], k, moved)
            store_row(r[a], k, combined(1.0, load_row(r[a], k), 0.5, moved))
    take_centre(cells, g, r)
    take_centre(cells, g, d)
    ω, square, size = rotation_of(cells, g, work), 0.0, 0.0
    for a in range(count):
        for k in range(2):
            weight, arm = cells.weights[begin + a, k], load_row(r[a], k)
            s = minus(load_row(d[a], k), cross(ω, arm))
            store_row(d[a], k, scaled(weight, s))
            square += weight * dot(s, s)
            size += weight * dot(arm, arm)
    for a in range(count):
        for k in range(2):
            store_row(out[begin + a], k, scaled(1.0 / (square + _STILL * size), load_row(d[a], k)))


@compiled
def give(
    kinds: Indices, span: AttachmentSpan, middle: Array, on_rows: Array, forces: Array
) -> None:
    """Add forces and moments on nodes and attachments, (n + g, 6), to ``forces`` (n, 6).

    Args:
        kinds: Types of the nodes.
        span: The attachments.
        middle: Nodes at the midpoint of the step.
        on_rows: Forces and moments, global components.
        forces: Forces along increments, updated.
    """
    cells, n = span.cells, forces.shape[0]
    for i in range(n):
        store(forces[i], 0, plus(load(forces[i], 0), load(on_rows[i], 0)))
        if kinds[i] < POSITION_GRADIENT:
            store(forces[i], 3, plus(load(forces[i], 3), load(on_rows[i], 3)))
    own = np.empty(6)
    for g in range(span.turns.shape[0]):
        F, moment = span.middle[g], load(on_rows[n + g], 3)
        a1, a2, a3 = load_row(F, 1), load_row(F, 2), load_row(F, 3)
        store(own, 0, rotate_back(a1, a2, a3, load(on_rows[n + g], 0)))
        store(own, 3, rotate_back(a1, a2, a3, moment))
        left = dot(moment, load(span.left[g], 0)) if span.turns[g] else 0.0
        for e in range(cells.first[g], cells.first[g + 1]):
            i, J = cells.nodes[e], span.J[e]
            d1, d2, d3 = axes(cells.kinds[e], middle[i])
            for k in range(2):
                f = (0.0, 0.0, 0.0)
                for c in range(6):
                    row = J[c, 3 * k], J[c, 3 * k + 1], J[c, 3 * k + 2]
                    f = plus(f, scaled(own[c], row))
                f = combined(1.0, rotate(d1, d2, d3, f), left, load_row(span.per_length[e], k))
                store(forces[i], 3 * k, plus(load(forces[i], 3 * k), f))
