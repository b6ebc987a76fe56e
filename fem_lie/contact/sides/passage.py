"""Which balls and pieces of lines meet, and which go through each other in a step: compiled.

Of most pieces that are near no place has to be looked for. A piece is within its bulge of its
chord, and where a direction parts two chords by more than the bulges and radii, curves are apart.
The direction is that of the nearest places of the chords; it need not be exact for what it shows.

A step sees its ends only. Balls that are apart at both ends may have met in between, and balls that
overlap at an end may face the other way there: then the force is missing or has the wrong sign.
Likewise of lines, whose pieces are taken as :data:`_CHORDS` chords each.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined_uncounted, uncounted
from fem_lie.contact.sides.curves import Opposite, Strands, at
from fem_lie.lie.tuples import Vector, combined, dot, load_row, minus, plus, scaled, store_row

_SEEN = 0.95
"""Part of the sum of the radii: centres that stay farther apart on their way only graze."""

_ON = 1e-2
"""Part of the sum of the radii within which centres or axes coincide and have no normal."""

_CHORDS = 4
"""Of each piece of a line."""

_DEEP = 0.75
"""Part of the sum of the radii: axes of lines that do not come nearer do not go through each other.
Chords that slide along each other swing round their ends, but farther away than that."""

_TANGENT = 4.0 / 27.0
"""The largest weight of a tangent in a place on a curve."""

_HALVINGS = 40
"""Of a step, to find when the normal of two chords turns over."""


_MARGIN = 1.0 + 1e-12
"""Of what is compared: nothing that touches is apart by round-off."""


class Passage(NamedTuple):
    """One pair that went through each other.

    Attributes:
        moved: Relative displacement in the step, m.
        thickness: Sum of the radii, or of half thicknesses, of the pair, m.
    """

    moved: float
    thickness: float


@inlined_uncounted
def jumps(D: Vector, E: Vector, reach: float) -> bool:
    """Whether a step misses that two balls meet.

    Args:
        D: From one centre to the other at the start of the step.
        E: The same at its end.
        reach: Sum of the radii.

    Returns:
        Whether the centres coincide at the end, or come nearer than the radii on the straight way,
        and the balls are apart at both ends or the normal has turned by more than 90°.
    """
    if dot(E, E) < (_ON * reach) ** 2:
        return True
    way = minus(E, D)
    length = dot(way, way)
    if not length > 0.0:
        return False
    part = -dot(D, way) / length
    if part <= 0.0:
        return False
    least = plus(D, scaled(min(part, 1.0), way))
    if dot(least, least) >= (_SEEN * reach) ** 2:
        return False
    return bool(dot(D, E) < 0.0 or (part < 1.0 and min(dot(D, D), dot(E, E)) > reach * reach))


@compiled
def first_jump(
    before: tuple[Array, Array],
    after: tuple[Array, Array],
    radii: tuple[Array, Array],
    pairs: Indices,
) -> int:
    """The first pair of balls whose contact a step misses, see :func:`jumps`, or −1.

    Args:
        before: Centres of both sides at the start of the step, shapes (n, 3) and (m, 3).
        after: The same at its end.
        radii: Of both sides, shapes (n,) and (m,).
        pairs: Balls of the first and of the second side, shape (k, 2).
    """
    for e in range(pairs.shape[0]):
        i, j = pairs[e]
        D = minus(load_row(before[0], i), load_row(before[1], j))
        E = minus(load_row(after[0], i), load_row(after[1], j))
        if jumps(D, E, radii[0][i] + radii[1][j]):
            return e
    return -1


@inlined_uncounted
def _between(a: Vector, b: Vector, apart: Vector) -> Vector:
    """From near the second segment to the first: ``b`` and ``a`` long, ``apart`` at starts."""
    aa, bb, ab = dot(a, a), dot(b, b), dot(a, b)
    at, bt = dot(a, apart), dot(b, apart)
    bend = aa * bb - ab * ab
    s = min(1.0, max(0.0, (ab * bt - bb * at) / bend)) if bend > 0.0 else 0.0
    t = min(1.0, max(0.0, (ab * s + bt) / bb)) if bb > 0.0 else 0.0
    s = min(1.0, max(0.0, (ab * t - at) / aa)) if aa > 0.0 else 0.0
    return plus(apart, minus(scaled(s, a), scaled(t, b)))


@inlined_uncounted
def _parted(C: Array, D: Array, reach: float) -> bool:
    """Whether chords of curves (4, 3) are further from each other than that."""
    p, q = load_row(C, 0), load_row(D, 0)
    a, b = minus(load_row(C, 1), p), minus(load_row(D, 1), q)
    apart = minus(p, q)
    w = _between(a, b, apart)
    least = dot(w, apart) + min(0.0, dot(w, a)) - max(0.0, dot(w, b))
    return bool(least > 0.0 and least * least > reach * reach * dot(w, w))


@uncounted
def are_apart(a: Strands, i: int, b: Strands, other: Opposite) -> bool:
    """Whether a piece cannot meet what is opposite."""
    C = a.curves[i]
    if other.last < other.first:
        least = min(
            dot(other.m, minus(load_row(C, 0), other.O)),
            dot(other.m, minus(load_row(C, 1), other.O)),
        )
        return bool(least > _MARGIN * (other.reach + a.bulges[i]))
    for j in range(other.first, other.last + 1):
        reach = _MARGIN * (other.reach + a.bulges[i] + b.bulges[j])
        if not _parted(C, b.curves[j], reach):
            return False
    return True


@inlined_uncounted
def _chords_at(X: Array, i: int, Y: Array, j: int, part: float) -> Vector:
    """Between chords of two polygons (2, n, 3) at a part of the step."""
    p = combined(1.0 - part, load_row(X[0], i), part, load_row(X[1], i))
    r = combined(1.0 - part, load_row(X[0], i + 1), part, load_row(X[1], i + 1))
    q = combined(1.0 - part, load_row(Y[0], j), part, load_row(Y[1], j))
    s = combined(1.0 - part, load_row(Y[0], j + 1), part, load_row(Y[1], j + 1))
    return _between(minus(r, p), minus(s, q), minus(p, q))


@inlined_uncounted
def _chords_pass(X: Array, i: int, Y: Array, j: int, near: float) -> bool:
    """Whether the normal between two chords turns over where they are near each other."""
    first = _chords_at(X, i, Y, j, 0.0)
    last = _chords_at(X, i, Y, j, 1.0)
    if dot(last, last) < (_ON * near) ** 2:
        return True
    if dot(first, last) > 0.0:
        return False
    low, high = 0.0, 1.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        D = _chords_at(X, i, Y, j, middle)
        if dot(D, D) < near * near:
            return True
        if dot(first, D) > 0.0:
            low = middle
        else:
            high = middle
    return False


@inlined_uncounted
def _moved(C: Array, i: int, D: Array, j: int) -> float:
    """By how much places of two pieces move against each other at most."""
    largest, by_tangents = 0.0, 0.0
    for k in range(2):
        u = minus(load_row(C[1, i], k), load_row(C[0, i], k))
        for m in range(2):
            w = minus(u, minus(load_row(D[1, j], m), load_row(D[0, j], m)))
            largest = max(largest, dot(w, w))
        t = minus(load_row(C[1, i], 2 + k), load_row(C[0, i], 2 + k))
        s = minus(load_row(D[1, j], 2 + k), load_row(D[0, j], 2 + k))
        by_tangents += _TANGENT * (dot(t, t) ** 0.5 + dot(s, s) ** 0.5)
    return float(largest**0.5 + by_tangents)


@inlined_uncounted
def _apart(C: Array, i: int, D: Array, j: int) -> float:
    """The distance of the chords of two pieces, less what curves may be off these."""
    p, q = load_row(C[0, i], 0), load_row(D[0, j], 0)
    u, v = minus(load_row(C[0, i], 1), p), minus(load_row(D[0, j], 1), q)
    w, off = _between(u, v, minus(p, q)), 0.0
    for k in range(2):
        t, s = minus(load_row(C[0, i], 2 + k), u), minus(load_row(D[0, j], 2 + k), v)
        off += _TANGENT * (dot(t, t) ** 0.5 + dot(s, s) ** 0.5)
    return float(dot(w, w) ** 0.5 - off)


@uncounted
def _set_polygon(C: Array, i: int, out: Array) -> None:
    """Places on a piece at both ends of the step, shape (2, _CHORDS + 1, 3)."""
    for end in range(2):
        for k in range(_CHORDS + 1):
            store_row(out[end], k, at(C[end, i], k / _CHORDS))


@compiled
def first_line_through(
    C: Array, D: Array, radii: tuple[Array, Array], pairs: Indices, X: Array, Y: Array
) -> int:
    """The first pair of pieces of lines that go through each other, or −1.

    Args:
        C: Ends and tangents of the pieces of the first line at both ends of the step, straight
            ways in between, shape (2, m, 4, 3).
        D: Likewise of the second, shape (2, n, 4, 3).
        radii: Of the pieces, shapes (m,) and (n,).
        pairs: Pieces, shape (k, 2).
        X: Work, see :func:`polygon`.
        Y: Likewise.
    """
    for e in range(pairs.shape[0]):
        i, j = pairs[e]
        near = _DEEP * (radii[0][i] + radii[1][j])
        if _apart(C, i, D, j) > near + _moved(C, i, D, j):
            continue
        _set_polygon(C, i, X)
        _set_polygon(D, j, Y)
        for k in range(_CHORDS):
            for m in range(_CHORDS):
                if _chords_pass(X, k, Y, m, near):
                    return e
    return -1


def polygon() -> Array:
    """Work for :func:`first_line_through`."""
    return np.empty((2, _CHORDS + 1, 3))
