"""Coulomb's law as a return mapping, and the springs of friction by penalty; compiled.

When a step is accepted, each pair of points that are near each other gets two anchors: the material
points that meet in the middle of the next step if the motion goes on steadily. The second is offset
so that ``u`` is the elongation of the tangential spring at the accepted frames. For later frames,
``u = P − Q`` is the difference of the positions of the anchors, linear in the nodal coordinates;
``n`` and ``p`` are the normal and the normal force::

    τ = k u_T,  u_T = u − n n·u          while |τ| ≤ μ p, else τ = μ p u_T/|u_T|

Anchors are material points and rotate with their nodes, so rolling moves them from step to step
without slip. Points that meet in the middle approach and separate symmetrically: of the slip of
surfaces that roll and pivot, or rotate both, the error is of third order in the step. Points that
met at its start would slip at second order, at every step in the same direction.

A node without rotations takes no moment: there the anchor is on the axis of the line, not on its
surface, and that of the other side, which rotates, is the material point at the same position and
has the elongation.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined_uncounted, uncounted
from fem_lie._jit.packed_arrays import Integers2, Numbers1, Numbers2, Numbers3
from fem_lie.contact.laws.energy import PenaltyConstants
from fem_lie.contact.sides.kinematics import (
    SLOTS,
    add_pulled_back,
    contact_point,
    position,
    touched,
)
from fem_lie.contact.sides.surfaces import MOST_NODES
from fem_lie.contact.sides.table import GROUND, UNUSED, ContactPoints, Side
from fem_lie.lie.motions import global_components, local_components
from fem_lie.lie.node_types import POSITION_GRADIENT
from fem_lie.lie.tuples import (
    Vector,
    combined,
    dot,
    load_row,
    minus,
    plus,
    scaled,
    store_row,
)


class CoulombLaw(NamedTuple):
    """Constants of a penalty contact with friction, for an integration weight of one.

    Attributes:
        normal: Stiffness and damping along the normal.
        μ: Coefficient of friction.
        holding: Stiffness of the tangential springs.
    """

    normal: PenaltyConstants
    μ: float
    holding: float


@inlined_uncounted
def limit(law: CoulombLaw, depth: float) -> float:
    """Largest traction of a tangential spring at an overlap ``depth``."""
    return law.μ * law.normal.k * depth


@inlined_uncounted
def returned(law: CoulombLaw, stretch: float, most: float) -> tuple[float, bool]:
    """Magnitude of the traction of a tangential spring, and whether the contact slips.

    Args:
        law: Constants.
        stretch: Elongation of the spring, not negative.
        most: The :func:`limit` of the traction.
    """
    trial = law.holding * stretch
    if trial <= most or stretch == 0.0:
        return trial, False
    return most, True


class Anchors(NamedTuple):
    """Anchors of pairs of points: ``u = Σ (w x + R c) + o`` is the elongation of the spring.

    Attributes:
        keys: Identifies the pair from step to step, shape (m, 2).
        nodes: Nodes of both sides, negative if unused, shape (m, 8).
        weights: ``w``, negative on the second side, shape (m, 8).
        arms: ``c``, with the sign of the side, shape (m, 8, 3).
        fixed: ``o``, contribution of ground, shape (m, 3).
        forces: Forces of the springs on the second side in the state of the anchors, shape (m,
            3), N.
        gaps: Gaps in the state of the anchors, shape (m,).
    """

    keys: Integers2
    nodes: Integers2
    weights: Numbers2
    arms: Numbers3
    fixed: Numbers2
    forces: Numbers2
    gaps: Numbers1


_COLUMNS = 2 + SLOTS + SLOTS + 3 * SLOTS + 3 + 3 + 1


@compiled
def empty_anchors(m: int) -> Anchors:
    """Anchors of ``m`` pairs on no nodes."""
    return Anchors(
        np.zeros((m, 2), dtype=np.int64),
        np.full((m, SLOTS), UNUSED, dtype=np.int64),
        np.zeros((m, SLOTS)),
        np.zeros((m, SLOTS, 3)),
        np.zeros((m, 3)),
        np.zeros((m, 3)),
        np.zeros(m),
    )


@uncounted
def clear(anchors: Anchors) -> None:
    """Detach all anchors from their nodes."""
    for e in range(anchors.nodes.shape[0]):
        store_row(anchors.fixed, e, (0.0, 0.0, 0.0))
        for s in range(SLOTS):
            anchors.nodes[e, s], anchors.weights[e, s] = UNUSED, 0.0
            store_row(anchors.arms[e], s, (0.0, 0.0, 0.0))


def packed(anchors: Anchors) -> Array:
    """Anchors as a flat array."""
    m = len(anchors.keys)
    if not m:
        return np.empty(0)
    return np.concatenate([part.reshape(m, -1) for part in anchors], axis=1).ravel()


def unpacked(numbers: Array) -> Anchors:
    """Anchors from the array that :func:`packed` returned."""
    rows = numbers.reshape(-1, _COLUMNS)
    ends = np.cumsum([2, SLOTS, SLOTS, 3 * SLOTS, 3, 3])
    keys, nodes, weights, arms, fixed, forces, gaps = np.split(rows, ends, axis=1)
    return Anchors(
        keys.astype(np.int64),
        nodes.astype(np.int64),
        weights.copy(),
        arms.reshape(-1, SLOTS, 3).copy(),
        fixed.copy(),
        forces.copy(),
        gaps[:, 0].copy(),
    )


@compiled
def found(known_keys: Indices, keys: Indices) -> Indices:
    """Index of each key among the known keys, −1 if it is not among them.

    Pairs mostly follow each other as in the step before.
    """
    count, m, most, following = len(known_keys), len(keys), 1, 0
    index: Indices = np.full(m, -1, np.int64)
    for i in range(count):
        most = max(most, 1 + known_keys[i, 1])
    order: Indices = np.empty(0, np.int64)
    for i in range(m):
        a, b = keys[i, 0], keys[i, 1]
        if following < count and known_keys[following, 0] == a and known_keys[following, 1] == b:
            index[i] = following
            following += 1
            continue
        if b >= most:
            continue
        if not len(order):
            order = np.argsort(known_keys[:, 0] * most + known_keys[:, 1], kind="mergesort")
        low, high = 0, count
        while low < high:
            middle = (low + high) // 2
            k = order[middle]
            if known_keys[k, 0] * most + known_keys[k, 1] < a * most + b:
                low = middle + 1
            else:
                high = middle
        if low < count:
            k = order[low]
            if known_keys[k, 0] == a and known_keys[k, 1] == b:
                index[i], following = k, k + 1
    return index


@inlined_uncounted
def stretch_of(H: Array, anchors: Anchors, q: int) -> Vector:
    """Elongation vector ``u`` of a spring."""
    u = load_row(anchors.fixed, q)
    for s in range(SLOTS):
        node = anchors.nodes[q, s]
        if node >= 0:
            u = plus(u, scaled(anchors.weights[q, s], load_row(H[node], 0)))
            u = plus(u, global_components(H[node], load_row(anchors.arms[q], s)))
    return u


@inlined_uncounted
def _rotates(types: Indices, side: Side, i: int) -> bool:
    """Whether a point is on nodes with rotations, or on ground."""
    node = side.nodes[i, 0]
    return node < 0 or types[node] < POSITION_GRADIENT


@inlined_uncounted
def _held(H: Array, types: Indices, at: ContactPoints, e: int) -> Vector:
    """Position at which the tractions of a pair act on both sides, one of which rotates."""
    i, j = at.pairs[e]
    point = contact_point(H, at.a, at.b, i, j, at.kind)
    if not _rotates(types, at.b, j):
        return point.second
    return touched(at.a, i, point) if _rotates(types, at.a, i) else point.first


@inlined_uncounted
def _add_point(
    H: Array,
    types: Indices,
    side: Side,
    i: int,
    off: Vector,
    sign: float,
    out: Anchors,
    e: int,
) -> None:
    """Add a point of a side, displaced by ``off``, as a material point, to anchors.

    There is no displacement at nodes without rotations.
    """
    first = 0 if sign > 0.0 else MOST_NODES
    for k in range(MOST_NODES):
        node = side.nodes[i, k]
        if node == UNUSED:
            break
        w, c = side.weights[i, k], load_row(side.arms[i], k)
        if node == GROUND:
            moved = combined(sign, c, sign * w, off)
            store_row(out.fixed, e, plus(load_row(out.fixed, e), moved))
            continue
        out.nodes[e, first + k], out.weights[e, first + k] = node, sign * w
        moved = scaled(sign, c)
        if types[node] < POSITION_GRADIENT:
            moved = combined(1.0, moved, sign * w, local_components(H[node], off))
        store_row(out.arms[e], first + k, moved)


@inlined_uncounted
def _displace(
    H: Array, types: Indices, side: Side, i: int, d: Vector, sign: float, out: Anchors, e: int
) -> None:
    """Add ``d`` to the difference of two anchors: displace that of a side with rotations."""
    first = 0 if sign > 0.0 else MOST_NODES
    for k in range(MOST_NODES):
        node, w = side.nodes[i, k], side.weights[i, k]
        if node == UNUSED:
            break
        if node == GROUND:
            store_row(out.fixed, e, combined(1.0, load_row(out.fixed, e), w, d))
        elif types[node] < POSITION_GRADIENT:
            arm = load_row(out.arms[e], first + k)
            moved = combined(1.0, arm, w, local_components(H[node], d))
            store_row(out.arms[e], first + k, moved)


@compiled
def set_anchors(
    H: Array,
    middle: Array,
    types: Indices,
    at: ContactPoints,
    a: Side,
    b: Side,
    springs: Array,
    out: Anchors,
) -> None:
    """Set anchors so that springs have the elongations ``springs`` (m, 3) at frames ``H``.

    Args:
        H: Frames.
        middle: Frames at which the points of both sides meet.
        types: Types of all nodes, shape (n,).
        at: Pairs of points.
        a: Material points for anchors of the first side.
        b: Material points for anchors of the second side.
        springs: Elongations of the springs.
        out: Overwritten.
    """
    for e in range(at.pairs.shape[0]):
        i, j = at.pairs[e]
        out.gaps[e] = contact_point(H, at.a, at.b, i, j, at.kind).gap
        X = _held(middle, types, at, e)
        P, Q = minus(X, position(middle, a, i)), minus(X, position(middle, b, j))
        _add_point(middle, types, a, i, P, 1.0, out, e)
        _add_point(middle, types, b, j, Q, -1.0, out, e)
        d = minus(load_row(springs, e), stretch_of(H, out, e))
        if _rotates(types, b, j):
            _displace(H, types, b, j, d, -1.0, out, e)
        else:
            _displace(H, types, a, i, d, 1.0, out, e)


@compiled
def slip_work(H: Array, anchors: Anchors, now: Indices, forces: Array, springs: Array) -> float:
    """Energy dissipated by slip since the anchors were set, by the trapezoidal rule, J.

    The work ``½ (τ₀ + τ₁)·(u₁ − e₀)`` on both sides is stored, ``½ k (e₁² − e₀²)``, or dissipated,
    ``½ (τ₀ + τ₁)·(u₁ − e₁)``. The springs of contacts that opened have ``τ₁ = e₁ = 0``.

    Args:
        H: Frames at the end of the step.
        anchors: Anchors at its start.
        now: Index of each of their pairs in the next two arguments, −1: none.
        forces: Friction forces on the second side at the end, shape (m, 3).
        springs: Elongations of the springs there, shape (m, 3).
    """
    total = 0.0
    for q in range(now.shape[0]):
        slip, force, e = stretch_of(H, anchors, q), load_row(anchors.forces, q), now[q]
        if e >= 0:
            slip = minus(slip, load_row(springs, e))
            force = plus(force, load_row(forces, e))
        total += 0.5 * dot(force, slip)
    return total


@compiled
def set_rows(
    H: Array, types: Indices, at: ContactPoints, which: Indices, forces: Array, out: Array
) -> None:
    """Numbers of points, gaps, positions, and friction forces on the first side.

    Args:
        H: Frames.
        types: Types of all nodes, shape (n,).
        at: Pairs of points.
        which: Index of the anchors of each pair, −1: none.
        forces: Friction forces on the second side, shape (m, 3).
        out: Rows of pairs with anchors are set, shape (m, 9).
    """
    for e in range(at.pairs.shape[0]):
        if which[e] < 0:
            continue
        i, j = at.pairs[e]
        out[e, 0], out[e, 1] = i, j
        out[e, 2] = contact_point(H, at.a, at.b, i, j, at.kind).gap
        X, f = _held(H, types, at, e), load_row(forces, e)
        for k in range(3):
            out[e, 3 + k], out[e, 6 + k] = X[k], -f[k]


class Traction(NamedTuple):
    """Tangential traction of one pair, for an integration weight of one.

    Attributes:
        τ: Traction, global components.
        along: Direction of slip, if the contact slips.
        size: ``|u_T|``.
        slips: Whether the contact slips.
    """

    τ: Vector
    along: Vector
    size: float
    slips: bool


@inlined_uncounted
def traction(law: CoulombLaw, g: float, n: Vector, u: Vector) -> Traction:
    """Tangential traction of an overlapping pair."""
    across = combined(1.0, u, -dot(n, u), n)
    size = np.sqrt(dot(across, across))
    τ, slips = returned(law, size, limit(law, -g))
    if not slips:
        return Traction(scaled(law.holding, across), (0.0, 0.0, 0.0), size, False)
    along = scaled(1.0 / size, across)
    return Traction(scaled(τ, along), along, size, True)


@compiled
def tractions(
    H: Array, at: ContactPoints, anchors: Anchors, which: Indices, law: CoulombLaw, out: Array
) -> None:
    """Tractions on the second side, zero for pairs without anchors, shape (m, 3)."""
    for e in range(at.pairs.shape[0]):
        i, j = at.pairs[e]
        store_row(out, e, (0.0, 0.0, 0.0))
        g, n, _, _ = contact_point(H, at.a, at.b, i, j, at.kind)
        if g < 0.0 and which[e] >= 0:
            store_row(out, e, traction(law, g, n, stretch_of(H, anchors, which[e])).τ)


@compiled
def overlap_energy(H: Array, at: ContactPoints, law: PenaltyConstants) -> float:
    """Energy of the overlaps at some points."""
    total = 0.0
    for e in range(at.pairs.shape[0]):
        i, j = at.pairs[e]
        depth = max(0.0, -contact_point(H, at.a, at.b, i, j, at.kind).gap)
        total += 0.5 * at.weight[e] * law.k * depth * depth
    return total


@compiled
def add_tractions(
    H: Array,
    types: Indices,
    at: ContactPoints,
    anchors: Anchors,
    which: Indices,
    τ: Array,
    grounded: bool,
    out: Array,
) -> None:
    """Add tractions to nodal forces, for all pairs or for pairs with ground only."""
    for e in range(at.pairs.shape[0]):
        i, j = at.pairs[e]
        q, t = which[e], scaled(at.weight[e], load_row(τ, e))
        separation = at.a.owners[i] != GROUND and at.b.owners[j] != GROUND
        if q < 0 or dot(t, t) == 0.0 or (grounded and separation):
            continue
        for s in range(SLOTS):
            node = anchors.nodes[q, s]
            if node < 0:
                continue
            w, c = anchors.weights[q, s], load_row(anchors.arms[q], s)
            add_pulled_back(types[node], H[node], w, c, t, out[node])
