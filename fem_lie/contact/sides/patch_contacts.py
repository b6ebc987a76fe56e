"""Points and patches of shells: contact points where the distance to the patches is least.

Of patches with a common corner only the closest one counts; and it counts only if no patch that
shares the edge or corner of the closest point has a closer point or is excluded. So a sheet touches
itself where it has folded back, and not in the neighbourhood of a point.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined, inlined_uncounted, uncounted
from fem_lie.contact.sides.kinematics import position
from fem_lie.contact.sides.patches import (
    BY_U,
    BY_V,
    NET,
    ROWS,
    VALUE,
    Nearest,
    Patches,
    bends_at,
    combination,
    edge_ends,
    edge_slope,
    is_triangle,
    linear,
    nearest_on,
    set_shapes,
)
from fem_lie.contact.sides.surfaces import MOST_NODES
from fem_lie.contact.sides.table import UNUSED, ContactPoints, Side, Sliding
from fem_lie.lie.tuples import Vector, dot, load_row, minus, plus, scaled, store_row

_EQUAL = 1.0 - 1e-12
"""Ratio of squared distances that count as equal, for the same point on two patches."""

_LEFT, _TAKEN, _DROPPED = range(3)
"""States of candidates: not yet looked at, a contact point, none."""


class Candidates(NamedTuple):
    """Closest points of one point on the patches near it, each of shape (pairs,).

    Attributes:
        squares: Squared distance, infinite for patches that are far.
        u: First parameter.
        v: Second parameter.
        edges: Edge that the point is on, or −1.
        ends: End of the edge that the point is, 0 or 1, or −1.
        states: Whether the point is a contact point, :data:`_LEFT` and others.
    """

    squares: Array
    u: Array
    v: Array
    edges: Indices
    ends: Indices
    states: Indices


class Workspace(NamedTuple):
    """Workspace for contact points on patches.

    Attributes:
        W: Shape functions, shape (9, 12).
        C: An edge, shape (4, 3).
        found: Closest points on patches.
    """

    W: Array
    C: Array
    found: Candidates


@inlined
def workspace_for(count: int) -> Workspace:
    """Workspace for points with at most ``count`` patches near them."""
    edges, ends = np.empty(count, dtype=np.int64), np.empty(count, dtype=np.int64)
    states = np.empty(count, dtype=np.int64)
    found = Candidates(np.empty(count), np.empty(count), np.empty(count), edges, ends, states)
    return Workspace(np.empty((ROWS, NET)), np.empty((4, 3)), found)


@inlined_uncounted
def far(net: Array, triangle: bool, P: Vector, reach: float) -> bool:
    """Whether a patch is farther than ``reach``, by the box of its control points."""
    count = 3 if triangle else 4
    for r in range(3):
        low, high = np.inf, -np.inf
        for k in range(count):
            x, a, b = net[k, r], abs(net[4 + 2 * k, r]), abs(net[5 + 2 * k, r])
            # inner control points are a third of each tangent from the corners, at most a half
            low, high = min(low, x - 0.5 * (a + b)), max(high, x + 0.5 * (a + b))
        if P[r] < low - reach or P[r] > high + reach:
            return True
    return False


@inlined_uncounted
def _shares(b: Patches, j: int, other: int) -> bool:
    """Whether two patches have a common corner."""
    for k in range(MOST_NODES):
        for q in range(MOST_NODES):
            if b.corners[j, k] >= 0 and b.corners[j, k] == b.corners[other, q]:
                return True
    return False


@inlined_uncounted
def _has(b: Patches, j: int, corner: int) -> bool:
    for k in range(MOST_NODES):
        if b.corners[j, k] == corner:
            return True
    return False


@uncounted
def _least(b: Patches, near: Indices, first: int, last: int, q: int, found: Candidates) -> bool:
    """Whether no neighbour of a patch has a closer point."""
    edge, end, j = found.edges[q], found.ends[q], near[first + q, 1]
    if edge < 0:
        return True
    one, two = edge_ends(is_triangle(b, j), edge)
    if end == 1:
        one = two
    wanted = b.at_edges[j, edge] if end < 0 else b.at_corners[j, one]
    p = b.corners[j, one]
    r = b.corners[j, two] if end < 0 else p
    there = 0
    for other in range(last - first):
        k = near[first + other, 1]
        if _has(b, k, p) and _has(b, k, r):
            there += 1
            if found.squares[other] < _EQUAL * found.squares[q]:
                return False
    return bool(there == wanted)


@uncounted
def _next(b: Patches, near: Indices, first: int, last: int, found: Candidates) -> int:
    """The closest patch that is not taken and shares no corner with those taken, or −1."""
    while True:
        best = -1
        for q in range(last - first):
            if found.states[q] == _LEFT and found.squares[q] < np.inf:
                if best < 0 or found.squares[q] < found.squares[best]:
                    best = q
        if best < 0:
            return best
        free = _least(b, near, first, last, best, found)
        for q in range(last - first):
            if found.states[q] == _TAKEN and _shares(b, near[first + best, 1], near[first + q, 1]):
                free = False
        found.states[best] = _TAKEN if free else _DROPPED
        if free:
            return best


@inlined_uncounted
def _set_position(
    b: Patches, j: int, W: Array, row: int, u: float, weights: Array, c: Array
) -> None:
    """Add ``u`` times the weights and moment arms of shape functions or their derivatives."""
    for k in range(MOST_NODES):
        if b.corners[j, k] < 0:
            break
        slot = b.slots[j, k]
        weights[slot] += u * W[row, k]
        arm = plus(load_row(c, slot), scaled(u * W[row, k], load_row(b.offsets[j], k)))
        for a in range(2):
            t = scaled(u * W[row, MOST_NODES + 2 * k + a], load_row(b.tangents[j, k], a))
            arm = plus(arm, t)
        store_row(c, slot, arm)


@uncounted
def _reset(b: Patches, j: int, side: Side, count: int) -> None:
    """Fix a point of a side to the nodes of a patch, with zero weights."""
    for k in range(MOST_NODES):
        side.nodes[count, k], side.weights[count, k] = UNUSED, 0.0
        store_row(side.arms[count], k, (0.0, 0.0, 0.0))
    for k in range(MOST_NODES):
        if b.corners[j, k] >= 0:
            side.nodes[count, b.slots[j, k]] = b.nodes[j, k]


@uncounted
def _set_fixed(b: Patches, j: int, u: float, v: float, side: Side, count: int) -> None:
    """Set a material point of a patch, by bilinear weights of its corners."""
    _reset(b, j, side, count)
    for k in range(MOST_NODES):
        if b.corners[j, k] >= 0:
            slot, w = b.slots[j, k], linear(is_triangle(b, j), k, u, v)
            side.weights[count, slot] += w
            arm = plus(load_row(side.arms[count], slot), scaled(w, load_row(b.offsets[j], k)))
            store_row(side.arms[count], slot, arm)


@uncounted
def _set_sliding(
    b: Patches, j: int, edge: int, end: int, P: Vector, W: Array, out: Sliding, q: int
) -> None:
    """Set how the closest point, at which ``W`` is evaluated, moves with ``P``."""
    for way in range(2):
        out.bends[q, way] = 1.0
        store_row(out.slopes[q], way, (0.0, 0.0, 0.0))
        for k in range(MOST_NODES):
            out.weights[q, way, k] = 0.0
            store_row(out.arms[q, way], k, (0.0, 0.0, 0.0))
    if end >= 0:
        return
    net = b.nets[j]
    aa, ab, bb = bends_at(net, W, minus(P, combination(net, W, VALUE)))
    ways = 1
    (u0, v0), (u1, v1) = (1.0, 0.0), (-ab / aa, 1.0)
    if edge >= 0:
        u0, v0 = edge_slope(is_triangle(b, j), edge)
    else:
        ways = 2
    for way in range(ways):
        u, v = (u0, v0) if way == 0 else (u1, v1)
        t = plus(scaled(u, combination(net, W, BY_U)), scaled(v, combination(net, W, BY_V)))
        store_row(out.slopes[q], way, t)
        out.bends[q, way] = u * u * aa + 2.0 * u * v * ab + v * v * bb
        _set_position(b, j, W, BY_U, u, out.weights[q, way], out.arms[q, way])
        _set_position(b, j, W, BY_V, v, out.weights[q, way], out.arms[q, way])


@inlined_uncounted
def _face_of(H: Array, a: Side, i: int, separation: Vector) -> int:
    """Face of the sheet on which a point is touched, from ``Δ``; 0 for a point of no sheet."""
    n = load_row(a.normals, i)
    if n[2] == 0.0:
        return 0
    return 1 if dot(separation, load_row(H[a.nodes[i, 0]], 3)) > 0.0 else 0


@inlined_uncounted
def _set_evaluated(
    b: Patches, j: int, found: Nearest, P: Vector, W: Array, out: ContactPoints, count: int
) -> None:
    """Set the closest point to ``P`` on a patch, at which ``W`` is evaluated, as second point."""
    _reset(b, j, out.b, count)
    _set_position(b, j, W, VALUE, 1.0, out.b.weights[count], out.b.arms[count])
    out.b.radii[count], out.b.owners[count] = b.radii[j], b.nodes[j, 0]
    _set_sliding(b, j, found.edge, found.end, P, W, out.sliding, count)


@uncounted
def set_closest(
    b: Patches, j: int, found: Nearest, P: Vector, W: Array, out: ContactPoints, count: int
) -> None:
    """Set the closest point to ``P`` on a patch as second point of a contact; ``W`` overwritten."""
    set_shapes(is_triangle(b, j), b.straight, found.u, found.v, W)
    _set_evaluated(b, j, found, P, W, out, count)


@uncounted
def add_contacts_of(
    H: Array,
    a: Side,
    i: int,
    measure: float,
    b: Patches,
    near: Indices,
    blocks: Indices,
    ends: tuple[int, int],
    workspace: Workspace,
    out: ContactPoints,
    fixed: Side,
    keys: Indices,
    key: int,
    count: int,
) -> int:
    """Add the contact points of one point and the patches near it; the number of all.

    Args:
        H: Frames.
        a: First points.
        i: The point.
        measure: Its integration weight.
        b: Patches, with nets at these frames.
        near: Pairs that are near each other, sorted.
        blocks: First matrix block of each pair.
        ends: First pair of the point, and the one after the last.
        workspace: Overwritten.
        out: Contact points.
        fixed: Material points on patches, see :func:`set_patch_contacts`.
        keys: Identifiers, see :func:`set_patch_contacts`.
        key: Identifier of the point.
        count: Number of contact points before.
    """
    (first, last), (W, C, found), stations = ends, workspace, keys.shape[0] > 0
    P, reach = position(H, a, i), a.radii[i] + b.radii[near[first, 1]]
    if stations:
        reach *= 2.0
    for q in range(last - first):
        j = near[first + q, 1]
        found.squares[q], found.states[q] = np.inf, _LEFT
        if not far(b.nets[j], is_triangle(b, j), P, reach):
            at = nearest_on(is_triangle(b, j), b.straight, b.nets[j], P, W, C)
            found.squares[q], found.u[q], found.v[q] = at.square, at.u, at.v
            found.edges[q], found.ends[q] = at.edge, at.end
    seen = (False, False)
    while True:
        q = _next(b, near, first, last, found)
        if q < 0 or found.squares[q] >= reach * reach or count == out.weight.shape[0]:
            return count
        j = near[first + q, 1]
        set_shapes(is_triangle(b, j), b.straight, found.u[q], found.v[q], W)
        if stations:
            face = _face_of(H, a, i, minus(P, combination(b.nets[j], W, VALUE)))
            if seen[face]:
                continue
            seen = (True, seen[1]) if face == 0 else (seen[0], True)
            keys[count, 0], keys[count, 1] = key, face
            _set_fixed(b, j, found.u[q], found.v[q], fixed, count)
        here = Nearest(found.squares[q], found.u[q], found.v[q], found.edges[q], found.ends[q])
        _set_evaluated(b, j, here, P, W, out, count)
        out.pairs[count, 0], out.pairs[count, 1] = i, count
        out.weight[count], out.first[count] = measure, blocks[first + q]
        count += 1


@uncounted
def _set_patch_contacts(
    H: Array,
    a: Side,
    areas: Array,
    b: Patches,
    near: Indices,
    blocks: Indices,
    workspace: Workspace,
    out: ContactPoints,
    fixed: Side,
    keys: Indices,
) -> int:
    count, last = 0, 0
    while last < near.shape[0]:
        first, i = last, near[last, 0]
        while last < near.shape[0] and near[last, 0] == i:
            last += 1
        given = H, a, i, areas[i], b, near, blocks, (first, last), workspace
        count = add_contacts_of(*given, out, fixed, keys, i, count)
    return count


@compiled
def set_patch_contacts(
    H: Array,
    a: Side,
    areas: Array,
    b: Patches,
    near: Indices,
    blocks: Indices,
    out: ContactPoints,
    fixed: Side,
    keys: Indices,
) -> int:
    """Set contact points on patches, within both radii or for friction springs; their number.

    Args:
        H: Frames.
        a: First points.
        areas: Areas of the first points.
        b: Patches, with nets at these frames.
        near: Pairs that are near each other, sorted.
        blocks: First matrix block of each pair.
        out: Overwritten; its second points and their motion have space for all pairs.
        fixed: Material points on patches for friction springs, overwritten.
        keys: Identifiers of pairs with friction springs, overwritten, (≥ m, 2); none: (0, 2). Such
            pairs are within twice the radii, one for each face.
    """
    space = workspace_for(near.shape[0])
    return _set_patch_contacts(H, a, areas, b, near, blocks, space, out, fixed, keys)
