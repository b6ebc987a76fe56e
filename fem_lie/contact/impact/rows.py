"""Gaps of contacts, and the rows of the contact Jacobian ``B``."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined_uncounted, uncounted
from fem_lie.contact.cones.jacobian import BlockRows
from fem_lie.contact.convex.manifold import set_manifolds
from fem_lie.contact.convex.passage import first_passed
from fem_lie.contact.convex.table import Polyhedra
from fem_lie.contact.impact.records import FIRST, SECOND, Masses, Touch
from fem_lie.contact.sides.kinematics import (
    SLOTS,
    ContactPoint,
    contact_point,
    position,
    slot,
    touched,
)
from fem_lie.contact.sides.kinematics import set_gaps as gaps_of_pairs
from fem_lie.contact.sides.passage import jumps
from fem_lie.contact.sides.surfaces import MOST_NODES
from fem_lie.contact.sides.table import ROUND
from fem_lie.lie.motions import global_components, local_components
from fem_lie.lie.tuples import (
    Vector,
    cross,
    dot,
    load_row,
    minus,
    plus,
    scaled,
    store_row,
)


@uncounted
def set_gaps(touch: Touch, H: Array, first: int, out: Array) -> None:
    """Gaps of all pairs from ``first`` on at frames ``H``, shape (m,)."""
    gaps_of_pairs(H, touch.a, touch.b, touch.pairs, touch.kinds, first, out)


@uncounted
def set_ahead(
    touch: Touch, polyhedra: Polyhedra, start: Array, end: Array, gaps: Array, impulses: Array
) -> None:
    """Set the contact manifolds of polyhedra, and the gaps of their features at the start.

    Args:
        touch: Pairs.
        polyhedra: Polyhedra whose contact manifolds are among the pairs.
        start: Frames at the start of the step.
        end: Frames at the end without contacts.
        gaps: Gaps at the start, shape (m,); those of polyhedra are overwritten.
        impulses: Impulses of the last step, shape (m, 3); see
            :func:`~fem_lie.contact.convex.manifold.set_manifolds`.
    """
    if polyhedra.pairs.shape[0] > 0:
        set_manifolds(end, polyhedra, touch.pairs, touch.kinds, touch.a, touch.b, impulses)
        set_gaps(touch, start, polyhedra.slots[0], gaps)


@uncounted
def set_centres(H: Array, touch: Touch, c: int, out: Array) -> None:
    """Positions of both points of a pair at frames ``H``, shape (2, 3)."""
    i, j = touch.pairs[c]
    store_row(out, 0, position(H, touch.a, i))
    store_row(out, 1, position(H, touch.b, j))


@uncounted
def find_jump(touch: Touch, before: Array, H: Array) -> int:
    """A pair of points whose contact was missed between two frames, or −1.

    See :func:`~fem_lie.contact.sides.passage.jumps`.
    """
    for c in range(touch.pairs.shape[0]):
        i, j = touch.pairs[c]
        if touch.kinds[c] != ROUND or touch.b.radii[j] < 0.0:
            continue
        D = minus(position(before, touch.a, i), position(before, touch.b, j))
        E = minus(position(H, touch.a, i), position(H, touch.b, j))
        if jumps(D, E, touch.a.radii[i] + touch.b.radii[j]):
            return c
    return -1


@uncounted
def find_crossed(touch: Touch, polyhedra: Polyhedra, before: Array, H: Array) -> int:
    """:func:`find_jump`, and :func:`.first_passed` for polyhedra."""
    found = find_jump(touch, before, H)
    if found < 0 and polyhedra.pairs.shape[0] > 0:
        return first_passed(before, H, polyhedra, touch.pairs, touch.a)
    return found


@inlined_uncounted
def _local_normal(H: Array, touch: Touch, j: int, n: Vector) -> Vector:
    """Normal in the axes of the second body; constant for a plane."""
    node = touch.b.nodes[j, 0]
    if node < 0 or dot(load_row(touch.b.normals, j), load_row(touch.b.normals, j)) > 0.0:
        return n if node < 0 else load_row(touch.b.normals, j)
    return local_components(H[node], n)


@inlined_uncounted
def axis_of(H: Array, touch: Touch, c: int) -> int:
    """The axis of the second body that is closest to perpendicular to the normal."""
    local, k = _local_normal(H, touch, touch.pairs[c, 1], point_of(H, touch, c).normal), 0
    if abs(local[1]) < abs(local[0]):
        k = 1
    if abs(local[2]) < abs(local[k]):
        k = 2
    return k


@inlined_uncounted
def tangents(H: Array, touch: Touch, j: int, n: Vector, k: int) -> tuple[Vector, Vector]:
    """Two tangents; the first is perpendicular to axis ``k`` of the second body."""
    node = touch.b.nodes[j, 0]
    axis = (1.0 if k == 0 else 0.0, 1.0 if k == 1 else 0.0, 1.0 if k == 2 else 0.0)
    first = cross(n, axis if node < 0 else global_components(H[node], axis))
    first = scaled(1.0 / np.sqrt(dot(first, first)), first)
    return first, cross(n, first)


@inlined_uncounted
def point_of(H: Array, touch: Touch, c: int) -> ContactPoint:
    """Contact point of a pair."""
    i, j = touch.pairs[c]
    return contact_point(H, touch.a, touch.b, i, j, touch.kinds[c])


@inlined_uncounted
def set_rows(H: Array, touch: Touch, c: int, axis: int, rows: BlockRows, block: int) -> int:
    """Store the blocks of a pair from ``block`` on, one row per component; number of blocks."""
    (i, j), kind, point = touch.pairs[c], touch.kinds[c], point_of(H, touch, c)
    n, components, count = point.normal, rows.values.shape[1], 0
    first, second, own = n, n, scaled(-touch.a.radii[i], n)
    if touch.friction_at[c] == FIRST:
        own = (0.0, 0.0, 0.0)
    elif touch.friction_at[c] == SECOND:
        own = minus(point.second, point.first)
    if components > 1:
        first, second = tangents(H, touch, j, n, axis)
    for s in range(SLOTS):
        node, sign, w, arm = slot(H, touch.a, touch.b, i, j, kind, point, s)
        if node < 0:
            continue
        # the point of friction is this far from the point of the side, and rotates with the body
        off = own
        if s >= MOST_NODES:
            off = plus(own, minus(point.first, point.second))
        arm = plus(arm, scaled(w, local_components(H[node], off)))
        rows.nodes[block + count] = node
        values = rows.values[block + count]
        for k in range(components):
            d = scaled(sign, n if k == 0 else (first if k == 1 else second))
            moment = cross(arm, local_components(H[node], d))
            for x in range(3):
                values[k, x], values[k, 3 + x] = w * d[x], moment[x]
        count += 1
    return count


@inlined_uncounted
def set_response(masses: Masses, body: int, force: Array, out: Array) -> None:
    """``M⁻¹`` of one free rigid body times a block of forces, shapes (1 or 3, 6)."""
    J = masses.inverse[body]
    for k in range(force.shape[0]):
        for i in range(3):
            out[k, i] = force[k, i] / masses.mass[body]
            total = 0.0
            for j in range(3):
                total += J[i, j] * force[k, 3 + j]
            out[k, 3 + i] = total


@uncounted
def append_rows(H: Array, touch: Touch, chosen: Indices, axis: Indices, rows: BlockRows) -> None:
    """Rows of the chosen pairs, shape (k,), with tangents from these axes."""
    for e in range(chosen.shape[0]):
        block = rows.first[e]
        rows.first[e + 1] = block + set_rows(H, touch, chosen[e], axis[e], rows, block)


@uncounted
def choose_axes(H: Array, touch: Touch, chosen: Indices, axis: Indices) -> None:
    """Axes from which the tangents of the chosen pairs are made, shape (k,)."""
    for e in range(chosen.shape[0]):
        axis[e] = axis_of(H, touch, chosen[e])


@uncounted
def show_positions(H: Array, touch: Touch, chosen: Indices, axis: Indices, out: Array) -> None:
    """Closest points of the first side, normals and tangents, shape (k, 4, 3)."""
    for e in range(chosen.shape[0]):
        point = point_of(H, touch, chosen[e])
        at, n = touched(touch.a, touch.pairs[chosen[e], 0], point), point.normal
        t1, t2 = tangents(H, touch, touch.pairs[chosen[e], 1], n, axis[e])
        for k in range(3):
            out[e, 0, k], out[e, 1, k], out[e, 2, k], out[e, 3, k] = at[k], n[k], t1[k], t2[k]
