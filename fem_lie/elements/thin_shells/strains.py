"""Strains of one cell of a thin shell, and the memory in which they are found."""

from __future__ import annotations

from typing import NamedTuple

import numba

from fem_lie._arrays import Array
from fem_lie._jit import compiled, inlined
from fem_lie._jit.stack import stack
from fem_lie.elements.thin_shells.cell_tables import Data, Rule
from fem_lie.elements.thin_shells.curvature import curvatures
from fem_lie.elements.thin_shells.rows import UNKNOWNS, VECTORS
from fem_lie.forms.kernels.addresses import Pointer, shift
from fem_lie.lie.tuples import Vector, dot, load_row, store, store_row


class Work(NamedTuple):
    """What is found of a cell on the way.

    Attributes:
        q: Vectors of the interpolation, shape (16, 3).
        slopes: r₁ and r₂ at the samples, those that count, shape (s, 2, 3).
        z: Derivatives at the points, shape (g, 5, 3).
        samples: Membrane strains at the samples, shape (s,).
        strains: At the points, shape (g, 6).
    """

    q: Array
    slopes: Array
    z: Array
    samples: Array
    strains: Array


@inlined
def _along(table: Array, q: Array) -> Vector:
    """``Σ table[a] q[a]``."""
    x = y = z = 0.0
    for a in range(VECTORS):
        x += table[a] * q[a, 0]
        y += table[a] * q[a, 1]
        z += table[a] * q[a, 2]
    return x, y, z


@compiled
def differentiate(rule: Rule, q: Array, slopes: Array, z: Array) -> None:
    """Derivatives at the samples and at the points."""
    n1, n2, n3, points = rule.counts
    for i in range(n1):
        store_row(slopes[i], 0, _along(rule.along[i], q))
    for i in range(n2):
        store_row(slopes[n1 + i], 1, _along(rule.across[i], q))
    for i in range(n3):
        for k in range(2):
            store_row(slopes[n1 + n2 + i], k, _along(rule.both[i, k], q))
    for g in range(points):
        for k in range(5):
            store_row(z[g], k, _along(rule.points[g, k], q))


@inlined
def _spread(rule: Rule, samples: Array, g: int, own: Array, out: Array) -> None:
    """Membrane strains at the point ``g`` (3,) from those at the samples and its ``own``."""
    n1, n2, n3, _ = rule.counts
    first, second, third = 0.0, 0.0, 0.0
    for i in range(n1):
        first += rule.spread[0][g, i] * samples[i]
    for i in range(n2):
        second += rule.spread[1][g, i] * samples[n1 + i]
    for i in range(n3):
        third += rule.spread[2][g, i] * samples[n1 + n2 + i]
    rest = 1.0 - rule.share
    out[0] = rest * first + rule.share * own[0]
    out[1] = rest * second + rule.share * own[1]
    out[2] = rest * third + rule.share * own[2]


@inlined
def membrane(r1: Vector, r2: Vector) -> Vector:
    """``(½ r₁·r₁, ½ r₂·r₂, r₁·r₂)``."""
    return 0.5 * dot(r1, r1), 0.5 * dot(r2, r2), dot(r1, r2)


@compiled
def find_strains(rule: Rule, data: Data, work: Work) -> None:
    """All strains of a cell whose ``q`` is known."""
    n1, n2, n3, points = rule.counts
    differentiate(rule, work.q, work.slopes, work.z)
    for i in range(n1 + n2 + n3):
        r1, r2 = load_row(work.slopes[i], 0), load_row(work.slopes[i], 1)
        E = 0.5 * dot(r1, r1) if i < n1 else 0.5 * dot(r2, r2) if i < n1 + n2 else dot(r1, r2)
        work.samples[i] = E - data.sampled[i]
    own = numba.carray(stack(3), (3,))
    for g in range(points):
        z, out, zero = work.z[g], work.strains[g], data.unloaded[g]
        store(own, 0, membrane(load_row(z, 0), load_row(z, 1)))
        for k in range(3):
            own[k] -= zero[k]
        _spread(rule, work.samples, g, own, out)
        store(out, 3, curvatures(z))
        for k in range(3, 6):
            out[k] -= zero[k]


@inlined
def room(place: Pointer, samples: int, points: int) -> Work:
    """In memory of :func:`room_size`."""
    q = numba.carray(place, (VECTORS, 3))
    slopes = numba.carray(shift(place, UNKNOWNS), (samples, 2, 3))
    z = numba.carray(shift(place, UNKNOWNS + 6 * samples), (points, 5, 3))
    at = UNKNOWNS + 6 * samples + 15 * points
    found = numba.carray(shift(place, at), (samples,))
    strains = numba.carray(shift(place, at + samples), (points, 6))
    return Work(q, slopes, z, found, strains)


@inlined
def room_size(samples: int, points: int) -> int:
    """Numbers that :func:`room` needs."""
    return UNKNOWNS + 7 * samples + 21 * points
