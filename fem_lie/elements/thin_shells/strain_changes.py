"""First derivatives of a cell's strains, and by them what its stresses are on its vectors."""

from __future__ import annotations

from fem_lie._arrays import Array
from fem_lie._jit import inlined
from fem_lie.elements.thin_shells.cell_tables import Rule, first_point
from fem_lie.elements.thin_shells.curvature import Derivatives, pull_moments
from fem_lie.elements.thin_shells.rows import VECTORS
from fem_lie.elements.thin_shells.strains import Work, at_point, column
from fem_lie.lie.tuples import Vector, combined, plus, scaled


@inlined
def _add(table: Array, r: int, factor: float, direction: Vector, out: Array) -> None:
    """``out += factor direction ⊗ table[r]``, shape (3, 16)."""
    if factor == 0.0:
        # most samples are on other lines of points
        return
    x, y, z = scaled(factor, direction)
    for a in range(VECTORS):
        t = table[r, a]
        out[0, a] += x * t
        out[1, a] += y * t
        out[2, a] += z * t


@inlined
def change_rows(rule: Rule, work: Work, g: int, out: Array) -> None:
    """``∂ε/∂q`` at a point, shape (6, 3, 16)."""
    n1, n2, n3, points = rule.counts
    rest, share, d, T = 1.0 - rule.share, rule.share, work.d, rule.table
    out[:] = 0.0
    for i in range(n1):
        _add(T, i, rest * rule.spread[0][g, i], column(d, i), out[0])
    for i in range(n2):
        _add(T, n1 + i, rest * rule.spread[1][g, i], column(d, n1 + i), out[1])
    for i in range(n3):
        factor, first = rest * rule.spread[2][g, i], n1 + n2 + i
        _add(T, first, factor, column(d, first + n3), out[2])
        _add(T, first + n3, factor, column(d, first), out[2])
    z, r = at_point(rule, d, g), first_point(rule.counts) + g
    _add(T, r, share, z[0], out[0])
    _add(T, r + points, share, z[1], out[1])
    _add(T, r, share, z[1], out[2])
    _add(T, r + points, share, z[0], out[2])
    for c in range(3):
        unit = (1.0 if c == 0 else 0.0), (1.0 if c == 1 else 0.0), (1.0 if c == 2 else 0.0)
        f = pull_moments(z, unit)
        _add(T, r, 1.0, f[0], out[3 + c])
        _add(T, r + points, 1.0, f[1], out[3 + c])
        _add(T, r + (2 + c) * points, 1.0, f[2 + c], out[3 + c])


@inlined
def _gathered(spread: Array, S: Array, first: int, rest: float, out: Array) -> None:
    """Stresses at all points (g,) on the samples from ``first`` on; ``spread`` (g, s)."""
    for g in range(spread.shape[0]):
        x = rest * S[g]
        for i in range(spread.shape[1]):
            out[first + i] += x * spread[g, i]


@inlined
def on_samples(rule: Rule, S: Array, out: Array) -> None:
    """What stresses (6, g) at the points are on the samples, shape (s,)."""
    n1, n2, _, _ = rule.counts
    rest = 1.0 - rule.share
    out[:] = 0.0
    _gathered(rule.spread[0], S[0], 0, rest, out)
    _gathered(rule.spread[1], S[1], n1, rest, out)
    _gathered(rule.spread[2], S[2], n1 + n2, rest, out)


@inlined
def _store(F: Array, r: int, a: Vector) -> None:
    F[0, r], F[1, r], F[2, r] = a


@inlined
def on_derivatives(rule: Rule, d: Array, S: Array, s: Array, F: Array) -> None:
    """What stresses at the points (6, g) and samples (s,) are on the derivatives, (3, d)."""
    n1, n2, n3, points = rule.counts
    for i in range(n1 + n2):
        _store(F, i, scaled(s[i], column(d, i)))
    for i in range(n1 + n2, n1 + n2 + n3):
        _store(F, i, scaled(s[i], column(d, i + n3)))
        _store(F, i + n3, scaled(s[i], column(d, i)))
    first = first_point(rule.counts)
    for g in range(points):
        z = at_point(rule, d, g)
        f: Derivatives = pull_moments(z, (S[3, g], S[4, g], S[5, g]))
        n11, n22, n12 = rule.share * S[0, g], rule.share * S[1, g], rule.share * S[2, g]
        _store(F, first + g, plus(f[0], combined(n11, z[0], n12, z[1])))
        _store(F, first + points + g, plus(f[1], combined(n22, z[1], n12, z[0])))
        _store(F, first + 2 * points + g, f[2])
        _store(F, first + 3 * points + g, f[3])
        _store(F, first + 4 * points + g, f[4])


@inlined
def on_vectors(table: Array, F: Array, f: Array) -> None:
    """``f = F table``, shape (3, 16): what forces on the derivatives are on the vectors."""
    f[:] = 0.0
    even = 4 * (table.shape[0] // 4)
    # four at a time, for fewer loads and stores of ``f``
    for j in range(3):
        for r in range(0, even, 4):
            x, y, z, w = F[j, r], F[j, r + 1], F[j, r + 2], F[j, r + 3]
            for a in range(table.shape[1]):
                first = x * table[r, a] + y * table[r + 1, a]
                f[j, a] += first + (z * table[r + 2, a] + w * table[r + 3, a])
    for r in range(even, table.shape[0]):
        _add(table, r, 1.0, column(F, r), f)
