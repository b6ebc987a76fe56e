"""Strains of one cell of a thin shell, and the memory in which they are found.

Numbers of all points stand side by side, so that loops run over points.
"""

from __future__ import annotations

from typing import NamedTuple

import numba

from fem_lie._arrays import Array
from fem_lie._jit import inlined
from fem_lie.elements.thin_shells.cell_tables import Data, Rule, derivatives, first_point
from fem_lie.elements.thin_shells.curvature import Derivatives, curvatures
from fem_lie.elements.thin_shells.rows import UNKNOWNS, VECTORS
from fem_lie.forms.kernels.addresses import Pointer, shift
from fem_lie.lie.tuples import Vector, dot


class Work(NamedTuple):
    """What is found of a cell on the way.

    Attributes:
        q: Vectors of the interpolation, shape (3, 16).
        d: Their derivatives, as in :class:`Rule`, shape (3, d).
        samples: Membrane strains at the samples, shape (s,).
        strains: At the points, shape (6, g).
    """

    q: Array
    d: Array
    samples: Array
    strains: Array


@inlined
def column(d: Array, r: int) -> Vector:
    """One derivative."""
    return d[0, r], d[1, r], d[2, r]


@inlined
def at_point(rule: Rule, d: Array, g: int) -> Derivatives:
    """All five at a point."""
    points, r = rule.counts[3], first_point(rule.counts) + g
    return (
        column(d, r),
        column(d, r + points),
        column(d, r + 2 * points),
        column(d, r + 3 * points),
        column(d, r + 4 * points),
    )


@inlined
def differentiate(rule: Rule, q: Array, d: Array) -> None:
    """All derivatives; four vectors at a time, for fewer loads and stores of ``d``."""
    count, T = derivatives(rule.counts), rule.columns
    for j in range(3):
        for r in range(count):
            d[j, r] = 0.0
        for a in range(0, VECTORS, 4):
            x, y, z, w = q[j, a], q[j, a + 1], q[j, a + 2], q[j, a + 3]
            for r in range(count):
                d[j, r] += (x * T[a, r] + y * T[a + 1, r]) + (z * T[a + 2, r] + w * T[a + 3, r])


@inlined
def _spread(table: Array, samples: Array, first: int, rest: float, out: Array) -> None:
    """Add strains at all points (g,) that are interpolated from samples; ``table`` (s, g)."""
    for i in range(table.shape[0]):
        x = rest * samples[first + i]
        for g in range(table.shape[1]):
            out[g] += x * table[i, g]


@inlined
def find_strains(rule: Rule, data: Data, work: Work) -> None:
    """All strains of a cell whose ``q`` is known."""
    n1, n2, n3, points = rule.counts
    d, samples, strains, zero = work.d, work.samples, work.strains, data.unloaded
    differentiate(rule, work.q, d)
    for i in range(n1 + n2):
        own = column(d, i)
        samples[i] = 0.5 * dot(own, own) - data.sampled[i]
    for i in range(n1 + n2, n1 + n2 + n3):
        samples[i] = dot(column(d, i), column(d, i + n3)) - data.sampled[i]
    for g in range(points):
        z = at_point(rule, d, g)
        strains[0, g] = rule.share * (0.5 * dot(z[0], z[0]) - zero[0, g])
        strains[1, g] = rule.share * (0.5 * dot(z[1], z[1]) - zero[1, g])
        strains[2, g] = rule.share * (dot(z[0], z[1]) - zero[2, g])
        bent = curvatures(z)
        for k in range(3):
            strains[3 + k, g] = bent[k] - zero[3 + k, g]
    rest = 1.0 - rule.share
    _spread(rule.spread_columns[0], samples, 0, rest, strains[0])
    _spread(rule.spread_columns[1], samples, n1, rest, strains[1])
    _spread(rule.spread_columns[2], samples, n1 + n2, rest, strains[2])


@inlined
def find_stress(D: Array, strains: Array, out: Array) -> None:
    """``D ε`` at all points, with half of the symmetric ``D`` (21, g) and both others (6, g)."""
    entry = 0
    for i in range(6):
        for g in range(D.shape[1]):
            own = D[entry, g] * strains[i, g]
            out[i, g] = own if i == 0 else out[i, g] + own
        entry += 1
        for j in range(i + 1, 6):
            for g in range(D.shape[1]):
                own = D[entry, g] * strains[i, g]
                out[i, g] += D[entry, g] * strains[j, g]
                out[j, g] = own if i == 0 else out[j, g] + own
            entry += 1


@inlined
def room(place: Pointer, rule: Rule) -> Work:
    """In memory of :func:`room_size`."""
    n1, n2, n3, points = rule.counts
    count = derivatives(rule.counts)
    at = UNKNOWNS + 3 * count
    samples = numba.carray(shift(place, at), (n1 + n2 + n3,))
    strains = numba.carray(shift(place, at + n1 + n2 + n3), (6, points))
    q, d = numba.carray(place, (3, VECTORS)), numba.carray(shift(place, UNKNOWNS), (3, count))
    return Work(q, d, samples, strains)


@inlined
def room_size(rule: Rule) -> int:
    """Numbers that :func:`room` needs."""
    n1, n2, n3, points = rule.counts
    return UNKNOWNS + 3 * derivatives(rule.counts) + n1 + n2 + n3 + 6 * points
