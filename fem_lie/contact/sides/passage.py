"""Which balls and segments of lines meet, and which pass through each other in a step: compiled.

For most segments near each other no closest point has to be computed. A segment is within its bulge
of its chord; where a direction separates two chords by more than the bulges and radii, the curves
do not touch. The direction is that between the closest points of the chords; it need not be exact.

A step only evaluates its ends. Balls that are separate at both ends may have met in between, and
balls that overlap at an end may be on the wrong side there: the contact force is then missing or
has the wrong sign. The same applies to lines, whose segments are approximated by :data:`_CHORDS`
chords each.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined_uncounted, uncounted
from fem_lie.contact.sides.curves import Opposite, Strands, at
from fem_lie.lie.tuples import Vector, combined, dot, load_row, minus, plus, scaled, store_row

_SEEN = 0.95
"""Fraction of the sum of the radii: centres that stay farther apart on their path only graze."""

_ON = 1e-2
"""Fraction of the sum of the radii within which centres or axes coincide and have no normal."""

_CHORDS = 4
"""Number of chords of each segment."""

_DEEP = 0.75
"""Fraction of the sum of the radii: axes of lines that stay farther apart do not pass through each
other. Chords that slide along each other rotate about their ends, but farther apart than that."""

_TANGENT = 4.0 / 27.0
"""Largest weight of a tangent in a position on a curve."""

_HALVINGS = 40
"""Bisections of a step to find when the normal of two chords reverses."""


_MARGIN = 1.0 + 1e-12
"""Safety factor: bodies in contact are never classified as separate by round-off."""


class Passage(NamedTuple):
    """One pair that passed through each other.

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
        D: Vector between the centres at the start of the step.
        E: The same at the end.
        reach: Sum of the radii.

    Returns:
        Whether the centres coincide at the end, or come closer than the radii on the straight path,
        and the balls are separate at both ends or the normal has rotated by more than 90°.
    """
    if dot(E, E) < (_ON * reach) ** 2:
        return True
    way = minus(E, D)
    length = dot(way, way)
    if not 0.0 < length < np.inf:
        return False
    part = -dot(D, way) / length
    if part <= 0.0:
        return False
    least = plus(D, scaled(min(part, 1.0), way))
    if dot(least, least) >= (_SEEN * reach) ** 2:
        return False
    return bool(dot(D, E) < 0.0 or (part < 1.0 and min(dot(D, D), dot(E, E)) > reach * reach))


@compiled
def first_passage(separations: Array, reach: Array) -> int:
    """The first pair whose contact a step misses, see :func:`jumps`, or −1.

    Args:
        separations: Vectors between the points of pairs at both ends of a step, shape (2, m, 3).
        reach: Sum of the radii of each pair, shape (m,).
    """
    for e in range(reach.shape[0]):
        if jumps(load_row(separations[0], e), load_row(separations[1], e), reach[e]):
            return e
    return -1


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
        after: The same at the end.
        radii: Radii of both sides, shapes (n,) and (m,).
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
def _between(a: Vector, b: Vector, separation: Vector) -> Vector:
    """Vector between approximately closest points of two segments, from ``b`` to ``a``."""
    aa, bb, ab = dot(a, a), dot(b, b), dot(a, b)
    at, bt = dot(a, separation), dot(b, separation)
    bend = aa * bb - ab * ab
    s = min(1.0, max(0.0, (ab * bt - bb * at) / bend)) if bend > 0.0 else 0.0
    t = min(1.0, max(0.0, (ab * s + bt) / bb)) if bb > 0.0 else 0.0
    s = min(1.0, max(0.0, (ab * t - at) / aa)) if aa > 0.0 else 0.0
    return plus(separation, minus(scaled(s, a), scaled(t, b)))


@inlined_uncounted
def _parted(C: Array, D: Array, reach: float) -> bool:
    """Whether the chords of curves (4, 3) are farther from each other than ``reach``."""
    p, q = load_row(C, 0), load_row(D, 0)
    a, b = minus(load_row(C, 1), p), minus(load_row(D, 1), q)
    separation = minus(p, q)
    w = _between(a, b, separation)
    least = dot(w, separation) + min(0.0, dot(w, a)) - max(0.0, dot(w, b))
    return bool(least > 0.0 and least * least > reach * reach * dot(w, w))


@uncounted
def are_apart(a: Strands, i: int, b: Strands, other: Opposite) -> bool:
    """Whether a segment cannot touch its opposite."""
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
    """Vector between chords of two polygons (2, n, 3) at a fraction of the step."""
    p = combined(1.0 - part, load_row(X[0], i), part, load_row(X[1], i))
    r = combined(1.0 - part, load_row(X[0], i + 1), part, load_row(X[1], i + 1))
    q = combined(1.0 - part, load_row(Y[0], j), part, load_row(Y[1], j))
    s = combined(1.0 - part, load_row(Y[0], j + 1), part, load_row(Y[1], j + 1))
    return _between(minus(r, p), minus(s, q), minus(p, q))


@inlined_uncounted
def _chords_pass(X: Array, i: int, Y: Array, j: int, near: float) -> bool:
    """Whether the normal between two chords reverses while they are near each other."""
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
    """Largest relative displacement of points of two segments."""
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
def _distance_between(C: Array, i: int, D: Array, j: int) -> float:
    """Distance of the chords of two segments minus the bulges of the curves."""
    p, q = load_row(C[0, i], 0), load_row(D[0, j], 0)
    u, v = minus(load_row(C[0, i], 1), p), minus(load_row(D[0, j], 1), q)
    w, off = _between(u, v, minus(p, q)), 0.0
    for k in range(2):
        t, s = minus(load_row(C[0, i], 2 + k), u), minus(load_row(D[0, j], 2 + k), v)
        off += _TANGENT * (dot(t, t) ** 0.5 + dot(s, s) ** 0.5)
    return float(dot(w, w) ** 0.5 - off)


@uncounted
def _set_polygon(C: Array, i: int, out: Array) -> None:
    """Points on a segment at both ends of the step, shape (2, _CHORDS + 1, 3)."""
    for end in range(2):
        for k in range(_CHORDS + 1):
            store_row(out[end], k, at(C[end, i], k / _CHORDS))


@compiled
def first_line_through(
    C: Array, D: Array, radii: tuple[Array, Array], pairs: Indices, X: Array, Y: Array
) -> int:
    """The first pair of segments of lines that pass through each other, or −1.

    Args:
        C: Ends and tangents of the segments of the first line at both ends of the step, with
            straight paths in between, shape (2, m, 4, 3).
        D: The same for the second line, shape (2, n, 4, 3).
        radii: Radii of the segments, shapes (m,) and (n,).
        pairs: Segments, shape (k, 2).
        X: Workspace, see :func:`polygon`.
        Y: Workspace, see :func:`polygon`.
    """
    for e in range(pairs.shape[0]):
        i, j = pairs[e]
        near = _DEEP * (radii[0][i] + radii[1][j])
        if _distance_between(C, i, D, j) > near + _moved(C, i, D, j):
            continue
        _set_polygon(C, i, X)
        _set_polygon(D, j, Y)
        for k in range(_CHORDS):
            for m in range(_CHORDS):
                if _chords_pass(X, k, Y, m, near):
                    return e
    return -1


def polygon() -> Array:
    """Workspace for :func:`first_line_through`."""
    return np.empty((2, _CHORDS + 1, 3))
