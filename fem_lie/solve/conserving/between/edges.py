"""Frames along the edges of discrete rods over a step; compiled.

Such a frame has the tangent of the edge ``e = x_j − x_i`` from its node i to another node j, and a
single unknown, its rotation α about that. Elements see it turn with its edge, by the vector of
Cayley's map::

    ψ = e̅ × Δe/|e̅|² + α e̅/|e̅|

A moment ``m`` on it is the couple ``∓ m × e̅/|e̅|²`` on both nodes and the torque ``m·e̅/|e̅|`` on
α. These do the work ``m·ψ`` exactly and have, where there is no torque, the moment ``m``. The rigid
rotation of a rod is one of all its frames. Where the edge is stretched, ψ turns one tangent into
the other to third order: the frame at the end of the step is turned on to its edge by the smallest
rotation, of which no energy depends, and rates of its directors with it.

The inertia of the frame is that of its rotation α about the tangent at the start of the step. What
the tangent turns of its moment of momentum is left out of this inertia
(:mod:`fem_lie.elements.rods.discrete_rod`).
"""

from __future__ import annotations

from math import sqrt

from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined, uncounted
from fem_lie.lie.edges import turn_on_to
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
from fem_lie.solve.conserving.between.cayley import half as half_of
from fem_lie.solve.conserving.between.cayley import mean_of, turned


@inlined
def _edge(rows: Array, i: int, j: int) -> Vector:
    return minus(load_row(rows[j], 0), load_row(rows[i], 0))


@uncounted
def turn_edges(
    edges: Indices, start: Array, rows: tuple[Array, Array, Array, Array, Array], steps: Array
) -> None:
    """Let frames turn with their edges.

    Args:
        edges: Nodes with such frames and the other nodes of their edges, (k, 2).
        start: All nodes at the start of the step, (N, 4, 3).
        rows: Increments, means, ends, nodes in the middle of the step, and increments with all
            digits, (N, 4, 3) each, of which directors of such frames are overwritten.
        steps: Translations and rotations, (N, 6), with the rotation of such a node about its
            tangent alone, which is overwritten.
    """
    delta, mean, end, middle, exact = rows
    for k in range(edges.shape[0]):
        i, j = edges[k, 0], edges[k, 1]
        edge, own = _edge(mean, i, j), load(steps[i], 3)
        square = dot(edge, edge)
        about = dot(own, load_row(start[i], 1)) / sqrt(square)
        ψ = combined(1.0 / square, cross(edge, _edge(delta, i, j)), about, edge)
        φ = half_of(ψ)
        store(steps[i], 3, ψ)
        for r in range(1, 4):
            d = load_row(start[i], r)
            d_mean = mean_of(ψ, d)
            change = cross(ψ, d_mean)
            store_row(mean[i], r, d_mean)
            store_row(delta[i], r, change)
            store_row(exact[i], r, change)
            store_row(end[i], r, plus(d, change))
            store_row(middle[i], r, turned(φ, d))


@uncounted
def pull_edges(
    edges: Indices,
    start: Array,
    mean: Array,
    leaders: tuple[Indices, Array],
    on_all: Array,
    forces: Array,
) -> None:
    """Replace moments on frames that turn with their edges, in the forces on the leaders.

    Args:
        edges: As of :func:`turn_edges`.
        start: All nodes at the start of the step, (N, 4, 3).
        mean: Means of these.
        leaders: Who leads each of them, (N,), and means of these, (≥ n, 4, 3).
        on_all: Forces on all nodes, (N, 6).
        forces: Sums of these on the leaders, (n, 6), updated.
    """
    leader, led = leaders
    for k in range(edges.shape[0]):
        i, j = edges[k, 0], edges[k, 1]
        edge, m, a, b = _edge(mean, i, j), load(on_all[i], 3), leader[i], leader[j]
        square = dot(edge, edge)
        couple = scaled(1.0 / square, cross(m, edge))
        torque = scaled(dot(m, edge) / sqrt(square), load_row(start[i], 1))
        store(forces[a], 0, minus(load(forces[a], 0), couple))
        store(forces[a], 3, plus(load(forces[a], 3), minus(torque, m)))
        arm = minus(load_row(mean[j], 0), load_row(led[b], 0))
        store(forces[b], 0, plus(load(forces[b], 0), couple))
        store(forces[b], 3, plus(load(forces[b], 3), cross(arm, couple)))


@uncounted
def go_along_edge(rows: Array, i: int, j: int, out: Array) -> None:
    """Axes of node ``i``, turned on to its edge by the smallest rotation, into ``out`` (4, 3)."""
    for r in range(1, 4):
        store_row(out, r, load_row(rows[i], r))
    turn_on_to(out, _edge(rows, i, j))


@inlined
def turned_with(before: Array, after: Array, a: Vector) -> Vector:
    """A vector along the axes of rows ``before``, along those of ``after``."""
    own = rotate_back(load_row(before, 1), load_row(before, 2), load_row(before, 3), a)
    return rotate(load_row(after, 1), load_row(after, 2), load_row(after, 3), own)
