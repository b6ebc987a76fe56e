"""The contact manifold of two polyhedra: points and edges that may touch in a step; compiled.

Along the normal of a face the opposite face is clipped by the sides of that face (I. Sutherland &
G. Hodgman, Commun. ACM 17 (1974) 32). The vertices of the clipped polygon are points of one
polyhedron that must not penetrate the plane of the other. Along a common normal of edges the
manifold consists of these two edges. Features are constant in a step; gaps follow their motion
exactly.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import uncounted
from fem_lie.contact.convex.nearest import set_of_ball
from fem_lie.contact.convex.separation import edge_axis, face_axis, point_between
from fem_lie.contact.convex.slots import set_edge, set_plane, set_point, within
from fem_lie.contact.convex.table import BITS, Polyhedra
from fem_lie.contact.sides.kinematics import normal_of, position, positions
from fem_lie.contact.sides.table import EDGES, INACTIVE, PLANE, Side
from fem_lie.lie.tuples import Vector, cross, dot, load_row, minus, scaled, store_row

_REACH = 0.1
"""Distance relative to the size of a polyhedron beyond which there is no contact manifold."""

_SAME = 1e-6
"""Distance relative to the size within which a vertex lies on the edge of a face."""

_LIKELY = 1e-4
"""Preference, relative to the size, for faces over edges, and for faces of the second
polyhedron."""


@uncounted
def _clip(shapes: Polyhedra, n: Vector, face: int, count: int, slack: float) -> tuple[int, int]:
    """Clip the first polygon by the sides of a face; return its workspace and its size."""
    P, marks, now = shapes.polygon, shapes.marks, 0
    begin, end = shapes.begins[face], shapes.begins[face + 1]
    for side in range(begin, end):
        p = load_row(shapes.X, shapes.loops[side])
        q = load_row(shapes.X, shapes.loops[side + 1 if side + 1 < end else begin])
        out = cross(minus(q, p), n)
        out = scaled(1.0 / np.sqrt(dot(out, out)), out)
        to, found = 1 - now, 0
        for i in range(count):
            k = i + 1 if i + 1 < count else 0
            x, y = load_row(P[now], i), load_row(P[now], k)
            here, there = dot(out, minus(x, p)), dot(out, minus(y, p))
            leaves, enters = here <= slack < there, there <= slack < here
            if here <= slack:
                store_row(P[to], found, x)
                marks[to, found, 0] = marks[now, i, 0]
                # a vertex on the side itself is kept
                along = leaves and here >= -slack
                marks[to, found, 1] = -1 - side if along else marks[now, i, 1]
                found += 1
            if (leaves and here < -slack) or (enters and there < -slack):
                store_row(P[to], found, point_between(x, y, here / (here - there)))
                line = marks[now, i, 1]
                marks[to, found, 0] = -((abs(line) * 2 + (line < 0)) * BITS + side)
                marks[to, found, 1] = -1 - side if leaves else line
                found += 1
        now, count = to, found
    return now, count


@uncounted
def _face_manifold(
    H: Array,
    shapes: Polyhedra,
    face: int,
    other: int,
    corner: int,
    slack: float,
    slots: tuple[int, int],
    pairs: Indices,
    kinds: Indices,
    a: Side,
    b: Side,
    ids: Indices,
) -> int:
    """Set the points of a polyhedron in front of a face of another one; return their number."""
    n = load_row(shapes.N, face)
    opposite, least = shapes.first[other, 1], np.inf
    for g in range(shapes.first[other, 1], shapes.first[other + 1, 1]):
        slope = dot(n, load_row(shapes.N, g))
        if slope < least:
            opposite, least = g, slope
    begin, count = shapes.begins[opposite], 0
    for at in range(begin, shapes.begins[opposite + 1]):
        store_row(shapes.polygon[0], count, load_row(shapes.X, shapes.loops[at]))
        shapes.marks[0, count, 0], shapes.marks[0, count, 1] = shapes.loops[at] + 1, at + 1
        count += 1
    now, count = _clip(shapes, n, face, count, slack)
    seen = False
    for k in range(count):
        seen = seen or shapes.marks[now, k, 0] == corner + 1
    x = load_row(shapes.X, corner)
    if not seen and within(shapes, n, face, x, slack):
        store_row(shapes.polygon[now], count, x)
        shapes.marks[now, count, 0] = corner + 1
        count += 1
    count = min(count, slots[1] - slots[0])
    for k in range(count):
        c = slots[0] + k
        i, j = pairs[c, 0], pairs[c, 1]
        mark = shapes.marks[now, k, 0]
        set_point(H, shapes, corner, mark, load_row(shapes.polygon[now], k), a, i)
        set_plane(shapes, face, b, j)
        kinds[c], ids[k] = PLANE, mark * 1024 + face % 1024
    return count


@uncounted
def _set_of_two(
    H: Array,
    shapes: Polyhedra,
    m: int,
    reach: float,
    pairs: Indices,
    kinds: Indices,
    a: Side,
    b: Side,
    ids: Indices,
) -> None:
    """Set the contact manifold of two polyhedra, in empty slots."""
    one, two = shapes.pairs[m, 0], shapes.pairs[m, 1]
    X, N, first, at = shapes.X, shapes.N, shapes.first, shapes.at
    size = min(shapes.centres.radii[one], shapes.centres.radii[two])
    corners = (first[one, 0], first[one + 1, 0]), (first[two, 0], first[two + 1, 0])
    faces = (first[one, 1], first[one + 1, 1]), (first[two, 1], first[two + 1, 1])
    by_first = face_axis(X, N, at, faces[0], corners[1])
    by_second = face_axis(X, N, at, faces[1], corners[0])
    if max(by_first.separation, by_second.separation) > reach:
        return
    P, Q = position(H, shapes.centres, one), position(H, shapes.centres, two)
    edges = (first[one, 2], first[one + 1, 2]), (first[two, 2], first[two + 1, 2])
    by_edges = edge_axis(X, N, shapes.edges, edges[0], edges[1], P)
    if by_edges.separation > reach:
        return
    best = max(by_first.separation, by_second.separation)
    slots = shapes.slots[m], shapes.slots[m + 1]
    if by_edges.separation <= best + _LIKELY * size:
        of_second = by_second.separation >= by_first.separation - _LIKELY * size
        axis, other = (by_second, one) if of_second else (by_first, two)
        given = pairs, kinds, a, b, ids
        if _face_manifold(H, shapes, axis.face, other, axis.corner, _SAME * size, slots, *given):
            return
    if by_edges.first >= 0:
        i, j = pairs[slots[0], 0], pairs[slots[0], 1]
        set_edge(H, shapes, by_edges.first, P, a, i)
        set_edge(H, shapes, by_edges.second, Q, b, j)
        kinds[slots[0]], ids[0] = EDGES, -1 - by_edges.first * BITS - by_edges.second


@uncounted
def set_manifolds(
    H: Array,
    shapes: Polyhedra,
    pairs: Indices,
    kinds: Indices,
    a: Side,
    b: Side,
    impulses: Array,
) -> None:
    """Set the contact manifolds of all polyhedra at frames ``H``.

    Args:
        H: Frames, shape (n, 4, 3).
        shapes: Polyhedra and pairs of them.
        pairs: All pairs of contact points, shape (M, 2).
        kinds: Kinds of the pairs, shape (M,); those of slots are overwritten.
        a: First points; those of slots are overwritten.
        b: Second points; those of slots are overwritten.
        impulses: Impulses of all pairs, shape (M, 3); those of slots are moved with their features.
    """
    positions(H, shapes.corners, shapes.X)
    for face in range(shapes.N.shape[0]):
        store_row(shapes.N, face, normal_of(H, shapes.faces, face))
    for m in range(shapes.pairs.shape[0]):
        first, last = shapes.slots[m], shapes.slots[m + 1]
        begin = first - shapes.slots[0]
        for k in range(last - first):
            shapes.known[k] = shapes.ids[begin + k]
            store_row(shapes.impulses, k, load_row(impulses, first + k))
            store_row(impulses, first + k, (0.0, 0.0, 0.0))
            kinds[first + k], shapes.ids[begin + k] = INACTIVE, 0
        one, two = shapes.pairs[m, 0], shapes.pairs[m, 1]
        ball = one < 0
        x = position(H, a, pairs[first, 0]) if ball else position(H, shapes.centres, one)
        separation = minus(x, position(H, shapes.centres, two))
        size = shapes.centres.radii[two]
        radius = a.radii[pairs[first, 0]] if ball else shapes.centres.radii[one]
        reach = _REACH * min(size, radius)
        far = size + radius + reach
        if dot(separation, separation) > far * far:
            continue
        ids = shapes.ids[begin:]
        if ball:
            set_of_ball(H, shapes, m, reach, pairs, kinds, a, b, ids)
        else:
            _set_of_two(H, shapes, m, reach, pairs, kinds, a, b, ids)
        for k in range(last - first):
            for old in range(last - first):
                if shapes.ids[begin + k] != 0 and shapes.ids[begin + k] == shapes.known[old]:
                    store_row(impulses, first + k, load_row(shapes.impulses, old))
