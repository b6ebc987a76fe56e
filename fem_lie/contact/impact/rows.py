"""Gaps of contacts, rows of the matrix ``B`` of their velocities, and what unit impulses do."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined_uncounted, uncounted
from fem_lie.contact.impact.records import Masses, Touch
from fem_lie.contact.sides.kinematics import gap, place
from fem_lie.contact.sides.passage import jumps
from fem_lie.lie.motions import global_components, local_components
from fem_lie.lie.tuples import (
    Vector,
    cross,
    dot,
    load_row,
    minus,
    negative,
    scaled,
    store_row,
)


@uncounted
def set_gaps(touch: Touch, H: Array, out: Array) -> None:
    """Gaps at frames ``H``, shape (m,)."""
    for c in range(touch.pairs.shape[0]):
        i, j = touch.pairs[c]
        out[c], _, _ = gap(H, touch.a, touch.b, i, j, touch.flat[c])


@uncounted
def set_centres(H: Array, touch: Touch, c: int, out: Array) -> None:
    """Centres of both sides of a pair at frames ``H``, shape (2, 3)."""
    i, j = touch.pairs[c]
    store_row(out, 0, place(H, touch.a, i))
    store_row(out, 1, place(H, touch.b, j))


@uncounted
def find_crossed(touch: Touch, before: Array, H: Array) -> int:
    """A pair of balls whose contact was missed between frames, or −1.

    See :func:`~fem_lie.contact.sides.passage.jumps`.
    """
    for c in range(touch.pairs.shape[0]):
        i, j = touch.pairs[c]
        if touch.flat[c] or touch.b.radii[j] < 0.0:
            continue
        D = minus(place(before, touch.a, i), place(before, touch.b, j))
        E = minus(place(H, touch.a, i), place(H, touch.b, j))
        if jumps(D, E, touch.a.radii[i] + touch.b.radii[j]):
            return c
    return -1


@inlined_uncounted
def _local_normal(H: Array, touch: Touch, j: int, n: Vector) -> Vector:
    """In the axes of the second body; of a plane it is constant."""
    node = touch.b.nodes[j, 0]
    if node < 0 or dot(load_row(touch.b.normals, j), load_row(touch.b.normals, j)) > 0.0:
        return n if node < 0 else load_row(touch.b.normals, j)
    return local_components(H[node], n)


@inlined_uncounted
def axis_of(H: Array, touch: Touch, c: int) -> int:
    """The axis of the second body that is most nearly across a normal."""
    i, j = touch.pairs[c]
    _, n, _ = gap(H, touch.a, touch.b, i, j, touch.flat[c])
    local, k = _local_normal(H, touch, j, n), 0
    if abs(local[1]) < abs(local[0]):
        k = 1
    if abs(local[2]) < abs(local[k]):
        k = 2
    return k


@inlined_uncounted
def tangents(H: Array, touch: Touch, j: int, n: Vector, k: int) -> tuple[Vector, Vector]:
    """Two directions across a normal, of which the first is across an axis of the second body."""
    node = touch.b.nodes[j, 0]
    axis = (1.0 if k == 0 else 0.0, 1.0 if k == 1 else 0.0, 1.0 if k == 2 else 0.0)
    first = cross(n, axis if node < 0 else global_components(H[node], axis))
    first = scaled(1.0 / np.sqrt(dot(first, first)), first)
    return first, cross(n, first)


@inlined_uncounted
def set_rows(H: Array, touch: Touch, c: int, axis: int, bodies: Indices, rows: Array) -> None:
    """Bodies and rows of a pair, as many as there is room for: (2,), (2, 1 or 3, 6)."""
    i, j = touch.pairs[c]
    _, n, P = gap(H, touch.a, touch.b, i, j, touch.flat[c])
    at = minus(P, scaled(touch.a.radii[i], n))
    first, second = n, n
    if rows.shape[1] > 1:
        first, second = tangents(H, touch, j, n, axis)
    for side in range(2):
        body = touch.a.nodes[i, 0] if side == 0 else touch.b.nodes[j, 0]
        bodies[side] = body
        if body < 0:
            continue
        lever = minus(at, load_row(H[body], 0))
        for k in range(rows.shape[1]):
            d = n if k == 0 else (first if k == 1 else second)
            if side == 1:
                d = negative(d)
            turning = local_components(H[body], cross(lever, d))
            for at_ in range(3):
                rows[side, k, at_] = d[at_]
                rows[side, k, 3 + at_] = turning[at_]


@inlined_uncounted
def set_pushes(masses: Masses, bodies: Indices, rows: Array, pushes: Array) -> None:
    """``M⁻¹ Bᵀ``."""
    for side in range(2):
        body = bodies[side]
        if body < 0:
            continue
        J = masses.inverse[body]
        for k in range(rows.shape[1]):
            for i in range(3):
                pushes[side, k, i] = rows[side, k, i] / masses.mass[body]
                total = 0.0
                for j in range(3):
                    total += J[i, j] * rows[side, k, 3 + j]
                pushes[side, k, 3 + i] = total
