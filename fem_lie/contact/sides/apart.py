"""Which pieces of lines cannot meet: of most that are near no place has to be looked for.

A piece is within its bulge of its chord, and where a direction parts two chords by more than the
bulges and radii, curves are apart. The direction is that of the nearest places of the chords; it
need not be exact for what it shows.
"""

from __future__ import annotations

from fem_lie._arrays import Array
from fem_lie._jit import inlined_uncounted, uncounted
from fem_lie.contact.sides.curves import Opposite, Strands
from fem_lie.lie.tuples import Vector, dot, load_row, minus, plus, scaled

_MARGIN = 1.0 + 1e-12
"""Of what is compared: nothing that touches is apart by round-off."""


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
