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
from fem_lie._jit import inlined_uncounted, uncounted
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
from fem_lie.lie.tuples import Vector, combined, dot, load_row, minus, plus, scaled, store_row

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
        factors: Weights of their coordinate vectors; positions on ground, shape (r, 4).
        kinds: Types of all nodes of the bodies, by number.
    """

    slots: Indices
    controls: Array
    starts: Array
    rings: Indices
    factors: Array
    kinds: Indices


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
def ring(H: Array, ropes: Ropes, k: int) -> Vector:
    """Position of a ring."""
    node, f = ropes.rings[k], ropes.factors[k]
    if node < 0:
        return f[1], f[2], f[3]
    x = (0.0, 0.0, 0.0)
    for row in range(4):
        if f[row] != 0.0:
            x = plus(x, scaled(f[row], load_row(H[node], row)))
    return x


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
    own = at(C, part_of(ropes, p, σ))
    set_curve(H, ropes, q, C)
    return minus(own, at(C, part_of(ropes, q, to)))


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
def _set_factors(ropes: Ropes, k: int, σ: float, out: tuple[Indices, Array, Array]) -> int:
    """Weights of coordinate vectors in ``Δ`` and ``P'``; the last slot is the ring.

    Args:
        ropes: The rope.
        k: The ring.
        σ: Position on the rope.
        out: Nodes (5,), weights and their derivatives, (5, 4) each; overwritten.

    Returns:
        The segment.
    """
    nodes, W, by_place = out
    p = piece_of(ropes, σ)
    s, length = part_of(ropes, p, σ), ropes.starts[p + 1] - ropes.starts[p]
    W[:] = 0.0
    by_place[:] = 0.0
    w, by_s = weights(s), slopes(s)
    for a in range(4):
        nodes[a] = ropes.slots[p, a]
        for row in range(2):
            c = ropes.controls[p, a, row]
            W[a, row] = c[0] * w[0] + c[1] * w[1] + c[2] * w[2] + c[3] * w[3]
            by = c[0] * by_s[0] + c[1] * by_s[1] + c[2] * by_s[2] + c[3] * by_s[3]
            by_place[a, row] = by / length
    nodes[4] = ropes.rings[k]
    for row in range(4 if nodes[4] >= 0 else 0):
        W[4, row] = -ropes.factors[k, row]
    return p


@inlined_uncounted
def store_position(H: Array, ropes: Ropes, σ: float, C: Array, out: Array) -> None:
    """``P``, ``P'`` and ``P''`` at a position, shape (3, 3)."""
    p = piece_of(ropes, σ)
    set_curve(H, ropes, p, C)
    s, length = part_of(ropes, p, σ), ropes.starts[p + 1] - ropes.starts[p]
    store_row(out, 0, at(C, s))
    store_row(out, 1, scaled(1.0 / length, slope(C, s)))
    store_row(out, 2, scaled(1.0 / (length * length), bend(C, s)))


@inlined_uncounted
def set_pair(
    H: Array,
    ropes: Ropes,
    k: int,
    σ: float,
    G: tuple[Indices, Array, Array],
    workspace: tuple[Array, Array],
    m: Array,
) -> tuple[Vector, float]:
    """Weights of coordinate vectors at a position, and ``m`` on these vectors, (5, 4, 3).

    Args:
        H: Nodal coordinates.
        ropes: The rope.
        k: The ring.
        σ: Position on the rope.
        G: See :func:`_set_factors`; overwritten.
        workspace: Shapes (4, 3) and (3, 3); overwritten.
        m: Overwritten.

    Returns:
        ``Δ`` and ``s``.
    """
    nodes, W, by_place = G
    C, at = workspace
    store_position(H, ropes, σ, C, at)
    _set_factors(ropes, k, σ, G)
    t, separation = load_row(at, 1), minus(load_row(at, 0), ring(H, ropes, k))
    for a in range(5):
        for row in range(4 if nodes[a] >= 0 else 0):
            store_row(m[a], row, combined(by_place[a, row], separation, W[a, row], t))
    return separation, dot(t, t) + dot(separation, load_row(at, 2))
