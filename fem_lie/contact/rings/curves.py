"""Curves of ropes, and the points on them that are closest to rings; compiled.

With the curve ``P(σ)``, a ring at ``X`` and ``Δ = P − X``, the rope is held in the ring by the
energy ``½ k d²`` of ``d² = min |Δ(σ)|²``, the minimum near the last position. For a step there is a
position ``σ*`` between those at both ends, ``σ₀`` and ``σ₁``, at which ::

    |Δ₁(σ*)|² − |Δ₀(σ*)|² = d₁² − d₀²

because the difference of both sides is not negative at ``σ₀`` and not positive at ``σ₁``. So the
force ``k Δ̄(σ*)`` between rope and ring at their mean positions has neither resultant nor moment,
and does exactly the work ``½ k (d₁² − d₀²)``.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined, inlined_uncounted, uncounted
from fem_lie.contact.sides.curves import (
    at,
    bend,
    between,
    pull,
    slope,
    slopes,
    stationary,
    weights,
)
from fem_lie.contact.sides.kinematics import position
from fem_lie.contact.sides.surfaces import MOST_NODES
from fem_lie.contact.sides.table import (
    ROUND,
    UNUSED,
    ContactPoints,
    Level,
    Side,
    Sliding,
)
from fem_lie.lie.tuples import Vector, combined, dot, minus, plus, scaled, store_row

_TURNS = 60
"""Largest number of iterations; each at least halves the interval."""
_KNOWN = 1e-15
"""Accuracy of a position on a segment, relative to its length."""

_THERE = 1e-14
"""Relative change below which a guess is accepted as the closest point."""


class Ropes(NamedTuple):
    """One rope and its rings.

    Attributes:
        slots: Nodes that segments depend on, −1: none, shape (m, 4).
        controls: Weights of their coordinate vectors 0 and 1 in both ends and both tangents of the
            segment, shape (m, 4, 2, 4).
        starts: Undeformed length before each segment, and in total, shape (m + 1,).
        rings: Nodes of the rings, −1: ground, shape (r,).
        factors: Weights of their coordinate vectors, ``(w, c)``; one and the position on ground;
            shape (r, 4).
        types: Types of all nodes of the bodies, by number.
    """

    slots: Indices
    controls: Array
    starts: Array
    rings: Indices
    factors: Array
    types: Indices


class RingPoint(NamedTuple):
    """A ring, and a point of the rope.

    Attributes:
        at: Pair of the ring and the point of the rope, which slides along it.
        along: ``P'``, as a point of a side.
        C: Workspace for a segment of the rope, shape (4, 3).
    """

    at: ContactPoints
    along: Side
    C: Array


@inlined
def _one_point() -> Side:
    """Uninitialised side of one point."""
    k, empty = MOST_NODES, Level(0, np.empty((0, 0)))
    nodes, owners = np.full((1, k), UNUSED), np.zeros(1, np.int64)
    arms, normals = np.zeros((1, k, 3)), np.zeros((1, 3))
    return Side(nodes, np.zeros((1, k)), arms, np.zeros(1), normals, owners, empty)


@inlined
def ring_point() -> RingPoint:
    """Space for a ring."""
    k, pairs, first = MOST_NODES, np.zeros((1, 2), np.int64), np.zeros(1, np.int64)
    sliding = Sliding(
        np.zeros((1, 2, 3)), np.ones((1, 2)), np.zeros((1, 2, k)), np.zeros((1, 2, k, 3))
    )
    at = ContactPoints(_one_point(), _one_point(), ROUND, pairs, np.ones(1), first, sliding)
    return RingPoint(at, _one_point(), np.empty((4, 3)))


@inlined_uncounted
def set_curve(H: Array, ropes: Ropes, p: int, C: Array) -> None:
    """Ends and tangents (4, 3) of a segment."""
    C[:] = 0.0
    for a in range(4):
        node = ropes.slots[p, a]
        for row in range(2 if node >= 0 else 0):
            for q in range(4):
                w = ropes.controls[p, a, row, q]
                for j in range(3):
                    C[q, j] += w * H[node, row, j]


@inlined_uncounted
def piece_of(ropes: Ropes, σ: float) -> int:
    """Segment of a position on the rope."""
    p = int(np.searchsorted(ropes.starts, σ, side="right")) - 1
    return min(max(p, 0), int(ropes.slots.shape[0]) - 1)


@inlined_uncounted
def part_of(ropes: Ropes, p: int, σ: float) -> float:
    """Parameter on the segment."""
    return (σ - ropes.starts[p]) / (ropes.starts[p + 1] - ropes.starts[p])


@uncounted
def foot(H: Array, ropes: Ropes, guess: float, X: Vector, C: Array) -> float:
    """Closest point to ``X``, by descent from a guess; ``C`` (4, 3) is overwritten."""
    last = ropes.slots.shape[0] - 1
    p = piece_of(ropes, guess)
    set_curve(H, ropes, p, C)
    s = min(max(part_of(ropes, p, guess), 0.0), 1.0)
    f, df = pull(C, s, X)
    if df > 0.0 and abs(f) <= _THERE * df:
        return guess  # the sign of round-off must not start a search for another position
    back = f > 0.0
    low, high = (0.0, s) if back else (s, 1.0)
    while True:
        f, _ = pull(C, low if back else high, X)
        if (f <= 0.0) if back else (f >= 0.0):
            break
        if p == (0 if back else last):
            return ropes.starts[0] if back else ropes.starts[last + 1]
        p += -1 if back else 1
        set_curve(H, ropes, p, C)
        low, high, s = 0.0, 1.0, 0.5
    s = stationary(C, X, low, high, s, _KNOWN)
    return ropes.starts[p] + s * (ropes.starts[p + 1] - ropes.starts[p])


@uncounted
def _moved(H: Array, ropes: Ropes, σ: float, to: float, C: Array) -> Vector:
    """``P(σ) − P(to)``."""
    p, q = piece_of(ropes, σ), piece_of(ropes, to)
    set_curve(H, ropes, p, C)
    if p == q:
        return between(C, part_of(ropes, p, σ), part_of(ropes, p, to))
    if abs(p - q) == 1:
        knot = ropes.starts[max(p, q)]
        own = between(C, part_of(ropes, p, σ), part_of(ropes, p, knot))
        set_curve(H, ropes, q, C)
        return plus(own, between(C, part_of(ropes, q, knot), part_of(ropes, q, to)))
    return minus(position_at(H, ropes, σ, C), position_at(H, ropes, to, C))


@inlined_uncounted
def _further(moved: Vector, separation: Vector) -> float:
    """Difference of squared distances, ``|moved + apart|² − |apart|²``."""
    return dot(moved, combined(1.0, moved, 2.0, separation))


@uncounted
def position_between(
    start: Array, end: Array, ropes: Ropes, σ: Vector, separation: tuple[Vector, Vector], C: Array
) -> float:
    """Position ``σ*`` of a step.

    Args:
        start: Nodal coordinates at the start.
        end: Nodal coordinates at the end.
        ropes: The rope.
        σ: Positions at start and end; the third component is unused.
        separation: ``Δ`` at start and end.
        C: Workspace, shape (4, 3).
    """
    a, b = σ[0], σ[1]
    known = _KNOWN * (ropes.starts[-1] - ropes.starts[0]) / ropes.slots.shape[0]
    if abs(b - a) <= known:
        return 0.5 * (a + b)
    fa = _further(_moved(end, ropes, a, σ[1], C), separation[1])
    fb = -_further(_moved(start, ropes, b, σ[0], C), separation[0])
    last, x = 0, 0.5 * (a + b)
    if fa <= 0.0 or fb >= 0.0:
        return x
    for _ in range(_TURNS):
        new = (a * fb - b * fa) / (fb - fa)
        fx = _further(_moved(end, ropes, new, σ[1], C), separation[1])
        fx -= _further(_moved(start, ropes, new, σ[0], C), separation[0])
        if fx == 0.0 or abs(new - x) <= known:
            return new
        x = new
        if fx > 0.0:
            a, fa = new, fx
            fb = 0.5 * fb if last == 1 else fb
            last = 1
        else:
            b, fb = new, fx
            fa = 0.5 * fa if last == 2 else fa
            last = 2
    return x


@inlined_uncounted
def position_at(H: Array, ropes: Ropes, σ: float, C: Array) -> Vector:
    """Position of the rope at ``σ``; ``C`` (4, 3) is overwritten."""
    p = piece_of(ropes, σ)
    set_curve(H, ropes, p, C)
    return at(C, part_of(ropes, p, σ))


@inlined_uncounted
def set_ring(ropes: Ropes, k: int, out: RingPoint) -> None:
    """Set the ring."""
    ring, f = out.at.a, ropes.factors[k]
    ring.nodes[0, 0], ring.weights[0, 0] = ropes.rings[k], f[0]
    store_row(ring.arms[0], 0, (f[1], f[2], f[3]))


@uncounted
def set_position(H: Array, ropes: Ropes, σ: float, out: RingPoint) -> float:
    """Set the point of the rope at ``σ``; return ``s = P'·P' − Δ·P''``."""
    at_ends = σ <= ropes.starts[0] or σ >= ropes.starts[-1]
    p, along, C = piece_of(ropes, σ), out.along, out.C
    ring, rope = out.at.a, out.at.b
    set_curve(H, ropes, p, C)
    s, length = part_of(ropes, p, σ), ropes.starts[p + 1] - ropes.starts[p]
    w, by_s, sliding = weights(s), slopes(s), out.at.sliding
    for a in range(MOST_NODES):
        node = ropes.slots[p, a] if ropes.slots[p, a] >= 0 else UNUSED
        rope.nodes[0, a], along.nodes[0, a] = node, node
        x, d = ropes.controls[p, a, 0], ropes.controls[p, a, 1]
        rope.weights[0, a], rope.arms[0, a, 0] = _product(x, w), _product(d, w)
        along.weights[0, a] = sliding.weights[0, 0, a] = _product(x, by_s) / length
        along.arms[0, a, 0] = sliding.arms[0, 0, a, 0] = _product(d, by_s) / length
    t, separation = scaled(1.0 / length, slope(C, s)), minus(position(H, ring, 0), at(C, s))
    store_row(sliding.slopes[0], 0, t)
    bent = dot(t, t) - dot(separation, bend(C, s)) / (length * length)
    # the closest point stays at an end
    sliding.bends[0, 0] = np.inf if at_ends else bent
    return bent


@inlined_uncounted
def _product(c: Array, w: tuple[float, float, float, float]) -> float:
    return c[0] * w[0] + c[1] * w[1] + c[2] * w[2] + c[3] * w[3]
