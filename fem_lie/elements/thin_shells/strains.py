"""Strains of one cell of a thin shell, with their derivatives; compiled.

Data of all points are contiguous, so that loops run over points.

Of ``z = (r₁, r₂, r₁₁, r₂₂, r₁₂)``, derivatives of the position, with the normal ``n = m/|m|``,
``m = r₁ × r₂``, changes of curvature are those of ``κ = −(r₁₁·n, r₂₂·n, 2 r₁₂·n)``. For moments
``M`` let ``Q = M₁ r₁₁ + M₂ r₂₂ + 2 M₃ r₁₂``; then ``M·κ = −Q·n`` and, with
``P = (Q − n n·Q)/|m|``::

    d(M·κ)  = −M₁ n·dr₁₁ − M₂ n·dr₂₂ − 2 M₃ n·dr₁₂ − P·dm,    dm = dr₁ × r₂ + r₁ × dr₂
    d²(M·κ) = −2 dQ·dn − dm·B dm − 2 P·(dr₁ × dr₂),           dn = (dm − n n·dm)/|m|
    B       = −(P nᵀ + n Pᵀ)/|m| − n·Q (I − n nᵀ)/|m|²
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numba
import numpy as np

from fem_lie._arrays import Array
from fem_lie._jit import compiled, inlined
from fem_lie.elements.thin_shells.cell_tables import Data, Rule, derivatives, first_point
from fem_lie.elements.thin_shells.nodal_coordinates import UNKNOWNS, VECTORS
from fem_lie.forms.kernels.addresses import Pointer, shift
from fem_lie.lie.tuples import Vector, combined, cross, dot, minus, plus, scaled

Derivatives: TypeAlias = tuple[Vector, Vector, Vector, Vector, Vector]
"""Derivatives ``z``, or forces on them."""


@inlined
def normal(z: Derivatives) -> tuple[Vector, float]:
    """Unit normal, and area ``|m|`` per parameter area."""
    m = cross(z[0], z[1])
    size = np.sqrt(dot(m, m))
    return scaled(1.0 / size, m), size


@inlined
def curvatures(z: Derivatives) -> Vector:
    """Curvatures ``κ`` at ``z``."""
    n, _ = normal(z)
    return -dot(z[2], n), -dot(z[3], n), -2.0 * dot(z[4], n)


@inlined
def _of_moments(z: Derivatives, M: Vector) -> Vector:
    """Vector ``Q`` of moments ``M``."""
    bent = combined(M[0], z[2], M[1], z[3])
    return plus(bent, scaled(2.0 * M[2], z[4]))


@inlined
def pull_moments(z: Derivatives, M: Vector) -> Derivatives:
    """Derivative ``∂(M·κ)/∂z``."""
    n, size = normal(z)
    Q = _of_moments(z, M)
    P = scaled(1.0 / size, minus(Q, scaled(dot(Q, n), n)))
    return (
        cross(P, z[1]),
        cross(z[0], P),
        scaled(-M[0], n),
        scaled(-M[1], n),
        scaled(-2.0 * M[2], n),
    )


@inlined
def _store_hat(A: Array, factor: float, a: Vector) -> None:
    """``A = factor â``, shape (3, 3)."""
    A[0, 0], A[1, 1], A[2, 2] = 0.0, 0.0, 0.0
    A[0, 1], A[1, 0] = -factor * a[2], factor * a[2]
    A[0, 2], A[2, 0] = factor * a[1], -factor * a[1]
    A[1, 2], A[2, 1] = -factor * a[0], factor * a[0]


@compiled
def geometric(z: Derivatives, M: Vector, G: Array, work: Array) -> None:
    """Set ``G = ∂²(M·κ)/∂z²``, shape (5, 3, 5, 3); ``work``: shape (5, 3, 3)."""
    n, size = normal(z)
    Q = _of_moments(z, M)
    along = dot(Q, n)
    P = scaled(1.0 / size, minus(Q, scaled(along, n)))
    B, turn, product = work[0], work[1], work[2]
    for i in range(3):
        for j in range(3):
            flat = (1.0 if i == j else 0.0) - n[i] * n[j]
            B[i, j] = -(P[i] * n[j] + n[i] * P[j]) / size - along * flat / size**2
            turn[i, j] = flat / size
    G[:] = 0.0
    factors = (M[0], M[1], 2.0 * M[2])
    # dm = X₁ dr₁ + X₂ dr₂
    _store_hat(work[3], -1.0, z[1])
    _store_hat(work[4], 1.0, z[0])
    for b in range(2):
        X = work[3 + b]
        _multiply(turn, X, product)
        for k in range(3):
            for i in range(3):
                for j in range(3):
                    G[2 + k, i, b, j] = -factors[k] * product[i, j]
                    G[b, j, 2 + k, i] = -factors[k] * product[i, j]
        _multiply(B, X, product)
        for a in range(2):
            Y = work[3 + a]
            for i in range(3):
                for j in range(3):
                    s = Y[0, i] * product[0, j] + Y[1, i] * product[1, j] + Y[2, i] * product[2, j]
                    G[a, i, b, j] = -s
    _store_hat(product, 1.0, P)
    for i in range(3):
        for j in range(3):
            G[0, i, 1, j] += product[i, j]
            G[1, i, 0, j] += product[j, i]


@inlined
def _multiply(A: Array, X: Array, out: Array) -> None:
    for i in range(3):
        for j in range(3):
            out[i, j] = A[i, 0] * X[0, j] + A[i, 1] * X[1, j] + A[i, 2] * X[2, j]


class Work(NamedTuple):
    """Intermediate quantities of a cell.

    Attributes:
        q: Hermite vectors, shape (3, 16).
        d: Their derivatives, as in :class:`Rule`, shape (3, d).
        samples: Membrane strains at the samples, shape (s,).
        strains: Strains at the points, shape (6, g).
    """

    q: Array
    d: Array
    samples: Array
    strains: Array


@inlined
def column(d: Array, r: int) -> Vector:
    """Derivative ``r`` as a vector."""
    return d[0, r], d[1, r], d[2, r]


@inlined
def at_point(rule: Rule, d: Array, g: int) -> Derivatives:
    """All five derivatives at point ``g``."""
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
    """Add strains at all points (g,), interpolated from samples; ``table`` (s, g)."""
    for i in range(table.shape[0]):
        x = rest * samples[first + i]
        for g in range(table.shape[1]):
            out[g] += x * table[i, g]


@inlined
def find_strains(rule: Rule, data: Data, work: Work) -> None:
    """Set all strains of a cell from its Hermite vectors ``q``."""
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
    """Set ``D ε`` at all points, from the upper half of ``D`` (21, g); both others (6, g)."""
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
def work_at(buffer: Pointer, rule: Rule) -> Work:
    """:class:`Work` in memory of size :func:`work_size`."""
    n1, n2, n3, points = rule.counts
    count = derivatives(rule.counts)
    at = UNKNOWNS + 3 * count
    samples = numba.carray(shift(buffer, at), (n1 + n2 + n3,))
    strains = numba.carray(shift(buffer, at + n1 + n2 + n3), (6, points))
    q, d = numba.carray(buffer, (3, VECTORS)), numba.carray(shift(buffer, UNKNOWNS), (3, count))
    return Work(q, d, samples, strains)


@inlined
def work_size(rule: Rule) -> int:
    """Size of the memory for :func:`work_at`."""
    n1, n2, n3, points = rule.counts
    return UNKNOWNS + 3 * derivatives(rule.counts) + n1 + n2 + n3 + 6 * points


@inlined
def _add(table: Array, r: int, factor: float, direction: Vector, out: Array) -> None:
    """``out += factor direction ⊗ table[r]``, shape (3, 16)."""
    if factor == 0.0:
        # most samples are on other lines than the points
        return
    x, y, z = scaled(factor, direction)
    for a in range(VECTORS):
        t = table[r, a]
        out[0, a] += x * t
        out[1, a] += y * t
        out[2, a] += z * t


@inlined
def change_rows(rule: Rule, work: Work, g: int, out: Array) -> None:
    """Set ``∂ε/∂q`` at a point, shape (6, 3, 16)."""
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
    """Forces at the samples from ``first`` on of stresses at all points (g,); ``spread`` (g, s)."""
    for g in range(spread.shape[0]):
        x = rest * S[g]
        for i in range(spread.shape[1]):
            out[first + i] += x * spread[g, i]


@inlined
def on_samples(rule: Rule, S: Array, out: Array) -> None:
    """Forces at the samples (s,) of stresses at the points (6, g)."""
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
    """Forces on derivatives (3, d) of stresses at points (6, g) and samples (s,)."""
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
    """Forces ``f = F table`` (3, 16) on Hermite vectors of forces on derivatives."""
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
