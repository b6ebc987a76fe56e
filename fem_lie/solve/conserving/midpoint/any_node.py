"""Mean and increment over a step of nodes of any type, and of frames along edges; compiled.

Frames rotate by the Cayley map (:mod:`.cayley`); the coordinate vectors of other nodes move along
straight lines. An increment of a node is six numbers along global axes: the translation and the
vector of the Cayley map of a frame, or both coordinate vectors of another node.

A frame along an edge of a discrete rod has the tangent of the edge ``e = x_j − x_i`` from its node
i to another node j, and a single unknown, its rotation α about the tangent. In elements it rotates
with its edge, by the vector of the Cayley map::

    ψ = e̅ × Δe/|e̅|² + α e̅/|e̅|

A moment ``m`` on it is the couple ``∓ m × e̅/|e̅|²`` on both nodes and the torque ``m·e̅/|e̅|`` on
α. These do the work ``m·ψ`` exactly and have, if there is no torque, the moment ``m``. The rigid
rotation of a rod rotates all its frames. If the edge is stretched, ψ maps one tangent to the other
to third order: the frame at the end of the step is rotated onto its edge by the smallest rotation,
on which no energy depends, together with the rates of its directors.

The inertia of the frame is that of its rotation α about the tangent at the start of the step. This
inertia omits the change of its angular momentum with the direction of the tangent
(:mod:`fem_lie.elements.rods.discrete_rod`).
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined, inlined_uncounted, uncounted
from fem_lie._jit.stack import stack, vector_at
from fem_lie.forms.fixed_arrays import as_frames, as_sixes
from fem_lie.lie.directors import rotate_onto
from fem_lie.lie.node_types import inertia
from fem_lie.lie.node_types.motion import from_local, to_local
from fem_lie.lie.node_types.node_type import (
    POSITION_GRADIENT,
    add_increment,
    first_vector,
    vector_count,
)
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
from fem_lie.solve.conserving.midpoint.cayley import half as half_of
from fem_lie.solve.conserving.midpoint.cayley import mean_of, span_one, spin, turned


@inlined
def _edge(rows: Array, i: int, j: int) -> Vector:
    return minus(load_row(rows[j], 0), load_row(rows[i], 0))


@uncounted
def turn_edges(
    edges: Indices, start: Array, rows: tuple[Array, Array, Array, Array, Array], steps: Array
) -> None:
    """Rotate frames with their edges.

    Args:
        edges: Nodes with such frames and the other nodes of their edges, (k, 2).
        start: All nodes at the start of the step, (N, 4, 3).
        rows: Increments, means, ends, midpoint nodes, and increments with all digits, (N, 4, 3)
            each, of which directors of such frames are overwritten.
        steps: Translations and rotations, (N, 6); on entry the rotation of such a node is that
            about its tangent only; overwritten.
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
    masters: tuple[Indices, Array],
    on_all: Array,
    forces: Array,
) -> None:
    """Distribute moments on frames along edges to the forces on the master nodes.

    Args:
        edges: As in :func:`turn_edges`.
        start: All nodes at the start of the step, (N, 4, 3).
        mean: Means of these.
        masters: Master node of each node, (N,), and means of the master nodes, (≥ n, 4, 3).
        on_all: Forces on all nodes, (N, 6).
        forces: Sums of these on the master nodes, (n, 6), updated.
    """
    master, led = masters
    for k in range(edges.shape[0]):
        i, j = edges[k, 0], edges[k, 1]
        edge, m, a, b = _edge(mean, i, j), load(on_all[i], 3), master[i], master[j]
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
    """Axes of node ``i``, rotated onto its edge by the smallest rotation, into ``out`` (4, 3)."""
    for r in range(1, 4):
        store_row(out, r, load_row(rows[i], r))
    rotate_onto(out, _edge(rows, i, j))


@inlined
def turned_with(before: Array, after: Array, a: Vector) -> Vector:
    """A vector with the components along axes ``after`` that it had along ``before``."""
    own = rotate_back(load_row(before, 1), load_row(before, 2), load_row(before, 3), a)
    return rotate(load_row(after, 1), load_row(after, 2), load_row(after, 3), own)


@inlined_uncounted
def as_rows(kind: int, coordinates: Array, out: Array) -> None:
    """Both coordinate vectors (6,) of a node other than a frame as rows (4, 3); others are zero."""
    at = first_vector(kind)
    for k in range(4):
        store_row(out, k, (0.0, 0.0, 0.0))
    for k in range(vector_count(kind)):
        store_row(out, at + k, load(coordinates, 3 * k))


@inlined_uncounted
def rates_of(kind: int, H: Array, V: Array, out: Array) -> None:
    """Rates (6,) of increments, from those of the nodal coordinates, (4, 3)."""
    if kind < POSITION_GRADIENT:
        store(out, 0, load_row(V, 0))
        store(out, 3, spin(H, V))
    else:
        at = first_vector(kind)
        store(out, 3, (0.0, 0.0, 0.0))
        for k in range(vector_count(kind)):
            store(out, 3 * k, load_row(V, at + k))


@uncounted
def span_all(
    kinds: Indices, H: Array, step: Array, rows: tuple[Array, Array, Array, Array]
) -> None:
    """Increments, means, ends and midpoint configurations of all nodes that move.

    Args:
        kinds: Types of the nodes, (n,).
        H: Nodes at the start, (≥ n, 4, 3).
        step: Increments, (n, 6).
        rows: Increments, means, ends, and midpoint nodes, whose axes are those of the unknowns, (≥
            n, 4, 3) each, overwritten.
    """
    delta, mean, end, middle = rows
    H, step, delta, mean = as_frames(H), as_sixes(step), as_frames(delta), as_frames(mean)
    end, middle, half = as_frames(end), as_frames(middle), vector_at(stack(6), 6)
    for i in range(step.shape[0]):
        kind = kinds[i]
        if kind < POSITION_GRADIENT:
            span_one(H[i], step[i], delta[i], mean[i], end[i], middle[i])
        else:
            for k in range(6):
                half[k] = 0.5 * step[i, k]
            add_increment(kind, H[i], half, middle[i])
            add_increment(kind, H[i], step[i], end[i])
            for k in range(4):
                store_row(mean[i], k, load_row(middle[i], k))
            as_rows(kind, step[i], delta[i])


@compiled
def span_from_python(
    kinds: Indices, H: Array, step: Array, rows: tuple[Array, Array, Array, Array]
) -> None:
    """:func:`span_all`, from Python."""
    span_all(kinds, H, step, rows)


@compiled
def keep_axes(kinds: Indices, end: Array, H: Array) -> None:
    """Give nodes ``H`` (≥ n, 4, 3) the axes of ``end``, if these follow a position gradient."""
    for i in range(kinds.shape[0]):
        if kinds[i] == POSITION_GRADIENT:
            store_row(H[i], 2, load_row(end[i], 2))
            store_row(H[i], 3, load_row(end[i], 3))


@inlined
def _turned(H: Array, a: Vector) -> Vector:
    return rotate(load_row(H, 1), load_row(H, 2), load_row(H, 3), a)


@compiled
def twists(
    kinds: Indices, turning: Array, H: Array, V: Array, rates: Array, v: Array, a: Array
) -> None:
    """Velocities and their rates (n, 6) along the axes of nodes ``H``.

    Args:
        kinds: Types of the nodes, (n,).
        turning: Angular velocities per rate of the directors, see
            :func:`~fem_lie.lie.node_types.inertia.turning_of`.
        H: Nodes.
        V: Rates of all nodal coordinates, (n, 4, 3).
        rates: Accelerations of increments, (n, 6).
        v: Velocities, overwritten.
        a: Their rates, overwritten.
    """
    own = np.empty(6)
    inertia.local_twists(H, V, turning, v)
    for i in range(v.shape[0]):
        kind = kinds[i]
        if kind < POSITION_GRADIENT:
            d1, d2, d3 = load_row(H[i], 1), load_row(H[i], 2), load_row(H[i], 3)
            for at in (0, 3):
                store(a[i], at, rotate_back(d1, d2, d3, load(rates[i], at)))
            store(a[i], 0, minus(load(a[i], 0), cross(load(v[i], 3), load(v[i], 0))))
        else:
            rates_of(kind, H[i], V[i], own)
            to_local(kind, H[i], own, rates[i], v[i], a[i])


@compiled
def spatial_rates(kinds: Indices, H: Array, v: Array, rates: Array, out: Array) -> None:
    """Accelerations of increments (n, 6), from twists ``v`` and their ``rates`` along the axes."""
    own = np.empty(6)
    for i in range(out.shape[0]):
        if kinds[i] < POSITION_GRADIENT:
            moved = plus(load(rates[i], 0), cross(load(v[i], 3), load(v[i], 0)))
            store(out[i], 0, _turned(H[i], moved))
            store(out[i], 3, _turned(H[i], load(rates[i], 3)))
        else:
            from_local(kinds[i], H[i], v[i], rates[i], own, out[i])
