"""Cubic curves with a radius: closest points, and intervals of a curve that overlap another.

Along a segment the gap to the opposite curve is split at its extrema. Two straight segments have
one at most; curved ones may have several, which steps separate: they are halved until the gap is
nearly a cubic along each. In each interval between extrema the zero of the gap bounds the part with
a negative gap, and Gauss points are placed in connected parts. So the integrand and its derivative
vanish at ends that are free, wherever along an element these are.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import inlined_uncounted, uncounted
from fem_lie.contact.sides.kinematics import normal_of, position
from fem_lie.contact.sides.surfaces import MOST_NODES
from fem_lie.contact.sides.table import GROUND, UNUSED, Side
from fem_lie.lie.motions import global_components
from fem_lie.lie.tuples import Vector, combined, dot, load_row, minus, plus, scaled, store_row


class Strands(NamedTuple):
    """Segments of lines; see :class:`~fem_lie.contact.sides.surfaces.Piece`.

    Attributes:
        nodes: Nodes that a segment depends on, :data:`UNUSED` after the last, shape (m, 4).
        weights: Weights of their positions in the ends and in the tangents, shape (m, 4, 4).
        arms: Weights of their directors in the same, shape (m, 4, 4, 3).
        lengths: Undeformed arc lengths, shape (m,).
        chords: Undeformed distances of the ends, zero for tangents that stretch with the nodes,
            shape (m,).
        stretches: Stretches of the chords, by which the tangents are multiplied. They are updated
            in increments of :data:`_STRETCH`, so that points are linear in frames, shape (m,).
        radii: Radii, shape (m,).
        before: Segment that the segment continues, −1: none, shape (m,).
        after: Segment that continues the segment, −1: none, shape (m,).
        curves: Present ends and tangents, shape (m, 4, 3).
        bulges: Largest distances of the curves from their chords, shape (m,).
    """

    nodes: Indices
    weights: Array
    arms: Array
    lengths: Array
    chords: Array
    stretches: Array
    radii: Array
    before: Indices
    after: Indices
    curves: Array
    bulges: Array


Station: TypeAlias = tuple[float, float, float]
"""Position on a curve, gap there, and scaled derivative of the gap."""


class Opposite(NamedTuple):
    """What a segment may touch: segments ``first … last`` of another line, or a plane.

    Attributes:
        first: First segment.
        last: Last segment; less than ``first`` for a plane.
        m: Normal of the plane.
        O: A point in the plane.
        reach: Sum of the radii.
    """

    first: int
    last: int
    m: Vector
    O: Vector  # noqa: E741
    reach: float


_ZERO = 1e-14
"""Accuracy of a position on a segment, relative to its length."""

_SEAM = 1e-9
"""Parameter within which a position is at an end of a segment."""

_TURNS = 60
"""Largest number of iterations; each at least halves the interval."""


_CUBIC = 0.1
"""Difference of a gap from a cubic, over the sum of the radii, up to which it has its extrema."""

_STRETCH = 1e-4
"""Change of the stretch of a segment at which its tangents are updated."""


@uncounted
def set_curves(H: Array, strands: Strands, stretched: bool) -> None:
    """Set ends and tangents at frames ``H``; if ``stretched``, update the stretches."""
    for i in range(strands.nodes.shape[0]):
        C = strands.curves[i]
        C[:] = 0.0
        for a in range(MOST_NODES):
            node = strands.nodes[i, a]
            if node == UNUSED:
                break
            for q in range(4):
                part = load_row(strands.arms[i, a], q)
                if node != GROUND:
                    x = scaled(strands.weights[i, a, q], load_row(H[node], 0))
                    part = plus(x, global_components(H[node], part))
                store_row(C, q, plus(load_row(C, q), part))
        chord = minus(load_row(C, 1), load_row(C, 0))
        if stretched and strands.chords[i] > 0.0:
            stretch = np.sqrt(dot(chord, chord)) / strands.chords[i]
            if abs(stretch - strands.stretches[i]) > _STRETCH:
                strands.stretches[i] = stretch
        for k in range(2):
            store_row(C, 2 + k, scaled(strands.stretches[i], load_row(C, 2 + k)))
        strands.bulges[i] = _bulge(chord, load_row(C, 2), load_row(C, 3))


@inlined_uncounted
def _bulge(chord: Vector, t0: Vector, t1: Vector) -> float:
    """Upper bound of the distance of a curve from its chord."""
    a, b = minus(t0, chord), minus(t1, chord)
    return 0.25 * np.sqrt(max(dot(a, a), dot(b, b)))


@inlined_uncounted
def weights(s: float) -> tuple[float, float, float, float]:
    """Hermite's shape functions: of both ends, then of the tangents there."""
    r = 1.0 - s
    return (1.0 + 2.0 * s) * r * r, s * s * (3.0 - 2.0 * s), s * r * r, -s * s * r


@inlined_uncounted
def slopes(s: float) -> tuple[float, float, float, float]:
    """Derivatives of :func:`weights`."""
    r = 6.0 * s * (s - 1.0)
    return r, -r, (1.0 - s) * (1.0 - 3.0 * s), s * (3.0 * s - 2.0)


@inlined_uncounted
def _sum(C: Array, w: tuple[float, float, float, float]) -> Vector:
    a = plus(scaled(w[0], load_row(C, 0)), scaled(w[1], load_row(C, 1)))
    return plus(a, plus(scaled(w[2], load_row(C, 2)), scaled(w[3], load_row(C, 3))))


@inlined_uncounted
def at(C: Array, s: float) -> Vector:
    """Position on a curve (4, 3)."""
    return _sum(C, weights(s))


@inlined_uncounted
def slope(C: Array, s: float) -> Vector:
    """First derivative of the position."""
    return _sum(C, slopes(s))


@inlined_uncounted
def bend(C: Array, s: float) -> Vector:
    """Second derivative of the position."""
    return _sum(C, (12.0 * s - 6.0, 6.0 - 12.0 * s, 6.0 * s - 4.0, 6.0 * s - 2.0))


@inlined_uncounted
def between(C: Array, s: float, r: float) -> Vector:
    """``P(s) − P(r)`` without cancellation."""
    a, b = s + r, s * s + s * r + r * r
    chord = minus(load_row(C, 1), load_row(C, 0))
    first = combined(1.0 - 2.0 * a + b, load_row(C, 2), b - a, load_row(C, 3))
    return scaled(s - r, combined(3.0 * a - 2.0 * b, chord, 1.0, first))


@inlined_uncounted
def pull(C: Array, s: float, P: Vector) -> tuple[float, float]:
    """Derivatives of half the squared distance to ``P`` along a curve: first and second."""
    separation, t = minus(at(C, s), P), slope(C, s)
    return dot(separation, t), dot(t, t) + dot(separation, bend(C, s))


@uncounted
def stationary(C: Array, P: Vector, low: float, high: float, s: float, known: float) -> float:
    """Parameter at which the distance to ``P`` is least, between bounds where it falls and rises.

    Args:
        C: The curve, shape (4, 3).
        P: The point.
        low: Lower bound.
        high: Upper bound.
        s: First guess.
        known: Accuracy.
    """
    for _ in range(_TURNS):
        f, df = pull(C, s, P)
        if f > 0.0:
            high = s
        else:
            low = s
        new = s - f / df if df > 0.0 else 0.5 * (low + high)
        if not low <= new <= high:
            new = 0.5 * (low + high)
        if abs(new - s) <= known:
            return new
        s = new
    return s


@uncounted
def project(C: Array, P: Vector) -> float:
    """Parameter in [0, 1] of the point of a curve that is closest to ``P``."""
    f0, _ = pull(C, 0.0, P)
    if f0 >= 0.0:
        return 0.0
    f1, _ = pull(C, 1.0, P)
    if f1 <= 0.0:
        return 1.0
    return stationary(C, P, 0.0, 1.0, f0 / (f0 - f1), _ZERO)


@inlined_uncounted
def _is_beyond(C: Array, P: Vector) -> bool:
    """Whether the closest point to ``P`` is after the start of a curve, not before.

    Both lists of segments that meet there ask this of the same curve, so that round-off does not
    give the point to both of them, or to none.
    """
    return bool(pull(C, 0.0, P)[0] < 0.0)


@uncounted
def nearest(strands: Strands, other: Opposite, P: Vector) -> tuple[float, int, float]:
    """Squared distance, segment and parameter of the closest point of a line."""
    best, found, where = np.inf, -1, 0.0
    for j in range(other.first, other.last + 1):
        s = project(strands.curves[j], P)
        separation = minus(P, at(strands.curves[j], s))
        square = dot(separation, separation)
        if square < best:
            best, found, where = square, j, s
    # at an end of the list where the line continues, another segment may be closer
    begins = found == other.first and where < _SEAM and strands.before[found] >= 0
    if begins and not _is_beyond(strands.curves[found], P):
        return np.inf, -1, 0.0
    ends = found == other.last and where > 1.0 - _SEAM and strands.after[found] >= 0
    if ends and _is_beyond(strands.curves[strands.after[found]], P):
        return np.inf, found, where
    return best, found, where


@uncounted
def _gap(C: Array, strands: Strands, other: Opposite, s: float) -> tuple[float, float, float]:
    """Gap at a point of a curve, and two derivatives, both scaled by a positive number."""
    P, t = at(C, s), slope(C, s)
    if other.last < other.first:
        g = dot(other.m, minus(P, other.O)) - other.reach
        return g, dot(other.m, t), dot(other.m, bend(C, s))
    square, j, σ = nearest(strands, other, P)
    if j < 0 or square == np.inf:
        return np.inf, 1.0, 1.0
    D = strands.curves[j]
    separation, u = minus(P, at(D, σ)), slope(D, σ)
    f, df = dot(separation, t), dot(t, t) + dot(separation, bend(C, s))
    if 0.0 < σ < 1.0:
        df -= dot(t, u) ** 2 / (dot(u, u) - dot(separation, bend(D, σ)))
    return np.sqrt(square) - other.reach, f, df


@uncounted
def _turning(
    C: Array, strands: Strands, other: Opposite, low: float, f0: float, high: float, f1: float
) -> float:
    """Extremum of the gap, in an interval whose ends have derivatives of opposite sign."""
    s = low + f0 / (f0 - f1) * (high - low)
    for _ in range(_TURNS):
        _, f, df = _gap(C, strands, other, s)
        if (f > 0.0) == (f0 > 0.0):
            low = s
        else:
            high = s
        new = s - f / df if df != 0.0 else 0.5 * (low + high)
        if not low <= new <= high:
            new = 0.5 * (low + high)
        if abs(new - s) < 1e-9:
            return new
        s = new
    return s


@uncounted
def _zero(
    C: Array, strands: Strands, other: Opposite, a: float, ga: float, b: float, gb: float
) -> float:
    """Zero of the gap, in an interval whose ends have gaps of opposite sign (Illinois method)."""
    last = 0
    for _ in range(_TURNS):
        s = (a * gb - b * ga) / (gb - ga) if gb < np.inf and ga < np.inf else 0.5 * (a + b)
        g, _, _ = _gap(C, strands, other, s)
        if abs(b - a) < 1e-10 or g == 0.0:
            return s
        if (g > 0.0) == (gb > 0.0):
            if abs(s - b) < 1e-12:
                return s
            b, gb = s, g
            ga = 0.5 * ga if last == 1 else ga
            last = 1
        else:
            if abs(s - a) < 1e-12:
                return s
            a, ga = s, g
            gb = 0.5 * gb if last == 2 else gb
            last = 2
    return 0.5 * (a + b)


@inlined_uncounted
def _part(
    C: Array, strands: Strands, other: Opposite, a: float, ga: float, b: float, gb: float
) -> tuple[float, float]:
    """Part with a negative gap of an interval in which the gap is monotonic."""
    if ga >= 0.0 and gb >= 0.0:
        return a, a
    if ga < 0.0 and gb < 0.0:
        return a, b
    s = _zero(C, strands, other, a, ga, b, gb)
    return (a, s) if ga < 0.0 else (s, b)


@uncounted
def _edge(C: Array, strands: Strands, other: Opposite, out: float, within: float) -> float:
    """Last point with a closest point of the opposite segments, from one without to one with it."""
    for _ in range(_TURNS):
        s = 0.5 * (out + within)
        if abs(out - within) < _ZERO:
            break
        if _gap(C, strands, other, s)[0] < np.inf:
            within = s
        else:
            out = s
    return within


@inlined_uncounted
def _append(parts: Array, count: int, low: float, high: float) -> int:
    """Append an interval to disjoint ones, or continue the last of them; return their number."""
    if not high > low:
        return count
    if count > 0 and parts[count - 1, 1] == low:
        parts[count - 1, 1] = high
        return count
    parts[count, 0], parts[count, 1] = low, high
    return count + 1


@uncounted
def _fastest(C: Array) -> float:
    """Upper bound of the derivative of the position along a curve."""
    t0, t1 = load_row(C, 2), load_row(C, 3)
    # the derivative is in the convex hull of its Bézier points
    chord = minus(load_row(C, 1), load_row(C, 0))
    middle = minus(scaled(3.0, chord), plus(t0, t1))
    return float(np.sqrt(max(dot(t0, t0), dot(middle, middle), dot(t1, t1))))


@uncounted
def _add_parts(
    C: Array, strands: Strands, other: Opposite, ends: tuple[Station, Station], parts: Array, k: int
) -> int:
    """Add the parts with a negative gap of an interval with one extremum of the gap at most."""
    (a, ga, fa), (b, gb, fb) = ends
    if ga == np.inf and gb == np.inf:
        return k
    if ga == np.inf:
        a = _edge(C, strands, other, a, b)
        ga, fa, _ = _gap(C, strands, other, a)
    elif gb == np.inf:
        b = _edge(C, strands, other, b, a)
        gb, fb, _ = _gap(C, strands, other, b)
    if (fa < 0.0) == (fb < 0.0):
        low, high = _part(C, strands, other, a, ga, b, gb)
        return _append(parts, k, low, high)
    s = _turning(C, strands, other, a, fa, b, fb)
    g, _, _ = _gap(C, strands, other, s)
    low, high = _part(C, strands, other, a, ga, s, g)
    k = _append(parts, k, low, high)
    low, high = _part(C, strands, other, s, g, b, gb)
    return _append(parts, k, low, high)


@inlined_uncounted
def _station(C: Array, strands: Strands, other: Opposite, s: float) -> Station:
    """Position on a curve, gap there, and scaled derivative of the gap."""
    g, f, _ = _gap(C, strands, other, s)
    return s, g, f


@inlined_uncounted
def _is_cubic(other: Opposite, a: Station, middle: Station, b: Station) -> bool:
    """Whether the gap in the middle is that of the cubic with the values and slopes at the ends."""
    if a[1] == np.inf or middle[1] == np.inf or b[1] == np.inf:
        return False
    if other.last < other.first:
        return True
    # the derivatives are scaled by the distance of the axes
    fa, fb = a[2] / max(a[1] + other.reach, _ZERO), b[2] / max(b[1] + other.reach, _ZERO)
    expected = 0.5 * (a[1] + b[1]) + 0.125 * (b[0] - a[0]) * (fa - fb)
    return bool(abs(middle[1] - expected) <= _CUBIC * other.reach)


@uncounted
def set_overlaps(C: Array, strands: Strands, other: Opposite, steps: int, parts: Array) -> int:
    """Set the intervals of a curve where the gap is negative; return their number.

    A step is halved until the gap along it is nearly a cubic; its halves have one extremum of the
    gap at most. Steps that are too far from the opposite line for an overlap are left at once.

    Args:
        C: The curve, shape (4, 3).
        strands: Segments of the opposite line.
        other: What it may touch.
        steps: 1: there is one extremum at most; else the largest number of steps, a power of two.
        parts: Intervals, overwritten, at least four times as many as steps, shape (·, 2).
    """
    count, fastest = 0, _fastest(C)
    a, b = _station(C, strands, other, 0.0), _station(C, strands, other, 1.0)
    if steps == 1:
        return _add_parts(C, strands, other, (a, b), parts, count)
    first, size = 0, steps
    while True:
        near = a[1] + b[1] if a[1] < np.inf and b[1] < np.inf else min(a[1], b[1])
        if near < fastest * size / steps or near == np.inf:
            middle = _station(C, strands, other, (first + 0.5 * size) / steps)
            halved = size == steps or not _is_cubic(other, a, middle, b)
            if halved and size > 1:
                size, b = size // 2, middle
                continue
            count = _add_parts(C, strands, other, (a, middle), parts, count)
            count = _add_parts(C, strands, other, (middle, b), parts, count)
        first += size
        if first == steps:
            return count
        # the largest step that begins here when steps are halved
        size, a = first & -first, b
        b = _station(C, strands, other, (first + size) / steps)


@inlined_uncounted
def plane_of(H: Array, b: Side, j: int, radius: float) -> Opposite:
    """A plane as the opposite of a segment with this radius."""
    return Opposite(j, j - 1, normal_of(H, b, j), position(H, b, j), radius)
