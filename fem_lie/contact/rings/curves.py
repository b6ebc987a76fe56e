"""Curves of ropes, and the places on them that are nearest to rings; compiled.

With ``P(σ)`` the curve, ``X`` a ring and ``Δ = P − X``, a place on the rope stays in the ring by
``½ k d²`` of ``d² = min |Δ(σ)|²``, near the place where it was last. Over a step there is one
place ``σ*`` between those of both ends, ``σ₀`` and ``σ₁``, where ::

    |Δ₁(σ*)|² − |Δ₀(σ*)|² = d₁² − d₀²

since the difference of both sides is not negative at ``σ₀`` and not positive at ``σ₁``. So the
force ``k Δ̄(σ*)`` between rope and ring at their mean places has neither resultant nor moment, and
does exactly the work ``½ k (d₁² − d₀²)``.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined_uncounted, uncounted
from fem_lie.lie.tuples import Vector, combined, dot, load_row, minus, plus, scaled, store_row

_TURNS = 60
"""Iterations, at most: each at least halves."""
_KNOWN = 1e-15
"""Part of a piece by which a place on it is known."""

_THERE = 1e-14
"""Likewise, by which a guess is the place itself."""


class Ropes(NamedTuple):
    """One rope and the rings on it.

    Attributes:
        slots: Nodes that pieces depend on, −1: none, shape (m, 4).
        powers: Of the factors of their rows 0 and 1, shape (m, 4, 2, 4).
        starts: Unloaded length before each piece, and in all, shape (m + 1,).
        rings: Nodes of the rings, −1: ground, shape (r,).
        factors: Of their rows, of those on ground places, shape (r, 4).
        kinds: Of all nodes of the bodies, by number.
    """

    slots: Indices
    powers: Array
    starts: Array
    rings: Indices
    factors: Array
    kinds: Indices


@inlined_uncounted
def set_curve(H: Array, ropes: Ropes, p: int, C: Array) -> None:
    """Powers (4, 3) of a piece."""
    C[:] = 0.0
    for a in range(4):
        node = ropes.slots[p, a]
        for row in range(2 if node >= 0 else 0):
            for q in range(4):
                w = ropes.powers[p, a, row, q]
                for j in range(3):
                    C[q, j] += w * H[node, row, j]


@inlined_uncounted
def at(C: Array, s: float) -> Vector:
    """A place."""
    a = combined(1.0, load_row(C, 2), s, load_row(C, 3))
    return combined(1.0, load_row(C, 0), s, combined(1.0, load_row(C, 1), s, a))


@inlined_uncounted
def slope(C: Array, s: float) -> Vector:
    """Its derivative."""
    a = combined(2.0, load_row(C, 2), 3.0 * s, load_row(C, 3))
    return combined(1.0, load_row(C, 1), s, a)


@inlined_uncounted
def bend(C: Array, s: float) -> Vector:
    """And that of this."""
    return combined(2.0, load_row(C, 2), 6.0 * s, load_row(C, 3))


@inlined_uncounted
def between(C: Array, s: float, r: float) -> Vector:
    """``P(s) − P(r)`` without the digits that both have in common."""
    first = combined(1.0, load_row(C, 1), s + r, load_row(C, 2))
    return scaled(s - r, combined(1.0, first, s * s + s * r + r * r, load_row(C, 3)))


@inlined_uncounted
def ring(H: Array, ropes: Ropes, k: int) -> Vector:
    """Place of a ring."""
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
    """The piece that a place is on."""
    p = int(np.searchsorted(ropes.starts, σ, side="right")) - 1
    return min(max(p, 0), int(ropes.slots.shape[0]) - 1)


@inlined_uncounted
def part_of(ropes: Ropes, p: int, σ: float) -> float:
    """Where on the piece."""
    return (σ - ropes.starts[p]) / (ropes.starts[p + 1] - ropes.starts[p])


@uncounted
def foot(H: Array, ropes: Ropes, guess: float, X: Vector, C: Array) -> float:
    """The place that is nearest to ``X``, downhill from a guess; ``C`` (4, 3) is overwritten."""
    last = ropes.slots.shape[0] - 1
    p = piece_of(ropes, guess)
    set_curve(H, ropes, p, C)
    s = min(max(part_of(ropes, p, guess), 0.0), 1.0)
    separation, t = minus(at(C, s), X), slope(C, s)
    f, df = dot(separation, t), dot(t, t) + dot(separation, bend(C, s))
    if df > 0.0 and abs(f) <= _THERE * df:
        return guess  # by the sign of round-off it would look for another place beyond
    back = f > 0.0
    low, high = (0.0, s) if back else (s, 1.0)
    while True:
        end = low if back else high
        f = dot(minus(at(C, end), X), slope(C, end))
        if (f <= 0.0) if back else (f >= 0.0):
            break
        if p == (0 if back else last):
            return ropes.starts[0] if back else ropes.starts[last + 1]
        p += -1 if back else 1
        set_curve(H, ropes, p, C)
        low, high, s = 0.0, 1.0, 0.5
    for _ in range(_TURNS):
        separation, t = minus(at(C, s), X), slope(C, s)
        f, df = dot(separation, t), dot(t, t) + dot(separation, bend(C, s))
        if f > 0.0:
            high = s
        else:
            low = s
        new = s - f / df if df > 0.0 else 0.5 * (low + high)
        if not low <= new <= high:
            new = 0.5 * (low + high)
        if abs(new - s) <= _KNOWN:
            s = new
            break
        s = new
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
    """By how much more the square of a distance is, ``|moved + separation|² − |separation|²``."""
    return dot(moved, combined(1.0, moved, 2.0, separation))


@uncounted
def position_between(
    start: Array, end: Array, ropes: Ropes, σ: Vector, separation: tuple[Vector, Vector], C: Array
) -> float:
    """``σ*`` of a step.

    Args:
        start: Rows at its start.
        end: At its end.
        ropes: The rope.
        σ: Places at start and end; the third number counts for nothing.
        separation: ``Δ`` there.
        C: Room, (4, 3).
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
    """Factors of rows in ``Δ`` and in ``P'`` at a place, slots of the rope and the ring last.

    Args:
        ropes: The rope.
        k: The ring.
        σ: The place.
        out: Nodes (5,), factors and their derivatives, (5, 4) each; overwritten.

    Returns:
        The piece.
    """
    nodes, W, by_place = out
    p = piece_of(ropes, σ)
    s, length = part_of(ropes, p, σ), ropes.starts[p + 1] - ropes.starts[p]
    W[:] = 0.0
    by_place[:] = 0.0
    for a in range(4):
        nodes[a] = ropes.slots[p, a]
        for row in range(2):
            c = ropes.powers[p, a, row]
            W[a, row] = c[0] + s * (c[1] + s * (c[2] + s * c[3]))
            by_place[a, row] = (c[1] + s * (2.0 * c[2] + s * 3.0 * c[3])) / length
    nodes[4] = ropes.rings[k]
    for row in range(4 if nodes[4] >= 0 else 0):
        W[4, row] = -ropes.factors[k, row]
    return p


@inlined_uncounted
def store_position(H: Array, ropes: Ropes, σ: float, C: Array, out: Array) -> None:
    """``P``, ``P'`` and ``P''`` at a place, (3, 3)."""
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
    """Factors of rows at a place, and ``m`` on the rows of the nodes, (5, 4, 3).

    Args:
        H: Rows of nodes.
        ropes: The rope.
        k: The ring.
        σ: The place on the rope.
        G: See :func:`_set_factors`; overwritten.
        workspace: Of shapes (4, 3) and (3, 3); overwritten.
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
