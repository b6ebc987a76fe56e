"""Cubic curves with a radius: closest points, and where along one of them they overlap.

Along a piece the gap to what is opposite is split where it neither grows nor shrinks; what is
negative of each part is found by its zero, and Gauss points are put there. So the integrand and its
slope vanish at ends that are free, wherever along an element these are.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import inlined_uncounted, uncounted
from fem_lie.contact.sides.kinematics import normal_of, place
from fem_lie.contact.sides.table import GROUND, Side
from fem_lie.lie.motions import global_components
from fem_lie.lie.tuples import Vector, dot, load_row, minus, plus, scaled, store_row


class Strands(NamedTuple):
    """Pieces of lines; the next one in a line follows.

    Attributes:
        nodes: At both ends, shape (m, 2).
        ends: In their frames, shape (m, 2, 3).
        tangents: Likewise, shape (m, 2, 3).
        lengths: Shape (m,).
        chords: From end to end where nothing is stretched, shape (m,).
        stretches: Of the chords; tangents are stretched alike. They follow the present ones by
            steps of :data:`_STRETCH`, so that places are linear in frames, shape (m,).
        radii: Shape (m,).
        goes_on: Whether a piece goes on in the next one, shape (m,).
        curves: At present: both ends and the tangents there, shape (m, 4, 3).
        bulges: How far they are from their chords at most, shape (m,).
    """

    nodes: Indices
    ends: Array
    tangents: Array
    lengths: Array
    chords: Array
    stretches: Array
    radii: Array
    goes_on: Flags
    curves: Array
    bulges: Array


class Opposite(NamedTuple):
    """What is opposite a piece: others of a line, ``first … last``, or a plane.

    Attributes:
        first: Of the pieces.
        last: Of these; less than ``first``: it is a plane.
        m: Normal of the plane.
        O: A place in it.
        reach: Sum of the radii.
    """

    first: int
    last: int
    m: Vector
    O: Vector  # noqa: E741
    reach: float


_ZERO = 1e-14
"""Part of a piece by which a place on it is known."""

_TURNS = 60
"""Iterations, at most: each at least halves."""


_STRETCH = 1e-4
"""By how much a piece may be stretched on until its tangents are."""


@uncounted
def set_curves(H: Array, strands: Strands, stretched: bool) -> None:
    """Ends and tangents at frames ``H``, and, if wanted, stretches if these are others by now."""
    for i in range(strands.nodes.shape[0]):
        for k in range(2):
            node = strands.nodes[i, k]
            p, t = load_row(strands.ends[i], k), load_row(strands.tangents[i], k)
            if node != GROUND:
                p = plus(load_row(H[node], 0), global_components(H[node], p))
                t = global_components(H[node], t)
            store_row(strands.curves[i], k, p)
            store_row(strands.curves[i], 2 + k, t)
        C = strands.curves[i]
        chord = minus(load_row(C, 1), load_row(C, 0))
        stretch = np.sqrt(dot(chord, chord)) / strands.chords[i]
        if stretched and abs(stretch - strands.stretches[i]) > _STRETCH:
            strands.stretches[i] = stretch
        for k in range(2):
            store_row(C, 2 + k, scaled(strands.stretches[i], load_row(C, 2 + k)))
        strands.bulges[i] = _bulge(chord, load_row(C, 2), load_row(C, 3))


@inlined_uncounted
def _bulge(chord: Vector, t0: Vector, t1: Vector) -> float:
    """How far a curve is from its chord at most: tangents make a weight of 1/4 at most."""
    a, b = minus(t0, chord), minus(t1, chord)
    return 0.25 * np.sqrt(max(dot(a, a), dot(b, b)))


@inlined_uncounted
def weights(s: float) -> tuple[float, float, float, float]:
    """Hermite's: of both ends, and of the tangents there."""
    r = 1.0 - s
    return (1.0 + 2.0 * s) * r * r, s * s * (3.0 - 2.0 * s), s * r * r, -s * s * r


@inlined_uncounted
def slopes(s: float) -> tuple[float, float, float, float]:
    """Derivatives of these."""
    r = 6.0 * s * (s - 1.0)
    return r, -r, (1.0 - s) * (1.0 - 3.0 * s), s * (3.0 * s - 2.0)


@inlined_uncounted
def _sum(C: Array, w: tuple[float, float, float, float]) -> Vector:
    a = plus(scaled(w[0], load_row(C, 0)), scaled(w[1], load_row(C, 1)))
    return plus(a, plus(scaled(w[2], load_row(C, 2)), scaled(w[3], load_row(C, 3))))


@inlined_uncounted
def at(C: Array, s: float) -> Vector:
    """A place on a curve (4, 3)."""
    return _sum(C, weights(s))


@inlined_uncounted
def slope(C: Array, s: float) -> Vector:
    """Derivative of the place."""
    return _sum(C, slopes(s))


@inlined_uncounted
def bend(C: Array, s: float) -> Vector:
    """Derivative of that."""
    return _sum(C, (12.0 * s - 6.0, 6.0 - 12.0 * s, 6.0 * s - 4.0, 6.0 * s - 2.0))


@uncounted
def project(C: Array, P: Vector) -> float:
    """The place on a curve that is nearest to ``P``, in [0, 1]."""
    low, high = 0.0, 1.0
    f0 = dot(minus(P, at(C, 0.0)), slope(C, 0.0))
    if f0 <= 0.0:
        return 0.0
    f1 = dot(minus(P, at(C, 1.0)), slope(C, 1.0))
    if f1 >= 0.0:
        return 1.0
    s = f0 / (f0 - f1)
    for _ in range(_TURNS):
        apart, t = minus(P, at(C, s)), slope(C, s)
        f, df = dot(apart, t), dot(apart, bend(C, s)) - dot(t, t)
        if f > 0.0:
            low = s
        else:
            high = s
        new = s - f / df if df < 0.0 else 0.5 * (low + high)
        if not low <= new <= high:
            new = 0.5 * (low + high)
        if abs(new - s) < _ZERO:
            return new
        s = new
    return s


@uncounted
def nearest(strands: Strands, other: Opposite, P: Vector) -> tuple[float, int, float]:
    """Squared distance, piece and place on it that are nearest."""
    best, found, where = np.inf, -1, 0.0
    for j in range(other.first, other.last + 1):
        s = project(strands.curves[j], P)
        apart = minus(P, at(strands.curves[j], s))
        square = dot(apart, apart)
        if square < best:
            best, found, where = square, j, s
    # where the list ends and the line goes on, something else is nearer
    begins = found == other.first and where == 0.0 and found > 0 and strands.goes_on[found - 1]
    if begins or (found == other.last and where == 1.0 and strands.goes_on[found]):
        return np.inf, found, where
    return best, found, where


@uncounted
def _gap(C: Array, strands: Strands, other: Opposite, s: float) -> tuple[float, float, float]:
    """Gap at a place on a curve, its derivative times a positive number, and that of this."""
    P, t = at(C, s), slope(C, s)
    if other.last < other.first:
        g = dot(other.m, minus(P, other.O)) - other.reach
        return g, dot(other.m, t), dot(other.m, bend(C, s))
    square, j, σ = nearest(strands, other, P)
    if j < 0 or square == np.inf:
        return np.inf, 1.0, 1.0
    D = strands.curves[j]
    apart, u = minus(P, at(D, σ)), slope(D, σ)
    f, df = dot(apart, t), dot(t, t) + dot(apart, bend(C, s))
    if 0.0 < σ < 1.0:
        df -= dot(t, u) ** 2 / (dot(u, u) - dot(apart, bend(D, σ)))
    return np.sqrt(square) - other.reach, f, df


@uncounted
def _turning(C: Array, strands: Strands, other: Opposite, f0: float, f1: float) -> float:
    """Where the gap neither grows nor shrinks, between ends where it does the opposite."""
    low, high, s = 0.0, 1.0, f0 / (f0 - f1)
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
    """Where the gap is zero, between ``a`` and ``b`` where its signs differ (Illinois)."""
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
    """Where the gap is negative between two places, between which it grows or shrinks."""
    if ga >= 0.0 and gb >= 0.0:
        return a, a
    if ga < 0.0 and gb < 0.0:
        return a, b
    s = _zero(C, strands, other, a, ga, b, gb)
    return (a, s) if ga < 0.0 else (s, b)


@uncounted
def overlaps(C: Array, strands: Strands, other: Opposite) -> tuple[float, float, float, float]:
    """Two parts of a curve (4, 3) where the gap is negative; some may be empty."""
    g0, f0, _ = _gap(C, strands, other, 0.0)
    g1, f1, _ = _gap(C, strands, other, 1.0)
    if (f0 < 0.0) == (f1 < 0.0):
        a, b = _part(C, strands, other, 0.0, g0, 1.0, g1)
        return a, b, b, b
    s = _turning(C, strands, other, f0, f1)
    g, _, _ = _gap(C, strands, other, s)
    a, b = _part(C, strands, other, 0.0, g0, s, g)
    c, d = _part(C, strands, other, s, g, 1.0, g1)
    if g < 0.0:
        return a, d, d, d
    return a, b, c, d


@inlined_uncounted
def plane_of(H: Array, b: Side, j: int, radius: float) -> Opposite:
    """A plane, opposite a piece with a radius."""
    return Opposite(j, j - 1, normal_of(H, b, j), place(H, b, j), radius)
