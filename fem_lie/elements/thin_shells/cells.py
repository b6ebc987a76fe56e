r"""Energy, forces and matrix of the cells of a thin shell: kernels of UFCx's signature.

With covariant strains ``ε = (E₁₁, E₂₂, 2 E₁₂, κ₁₁, κ₂₂, 2 κ₁₂)`` at the points of integration,
``W = Σ_g ½ ε·D ε``. Membrane strains are sampled, ``E₁₁`` at the points of one set, ``E₂₂`` and
``2 E₁₂`` at those of others, and interpolated to the points of integration; a share of the strains
there themselves may be mixed in. Curvatures are those at the points. Weights, areas and the
transformation to the section's axes are in ``D``.

The matrix has the geometric part of a stress that is carried from iterate to iterate.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import callback, compiled, inlined
from fem_lie._jit.stack import stack
from fem_lie.elements.thin_shells.curvature import curvatures, geometric, pull_moments
from fem_lie.elements.thin_shells.rows import (
    NODES,
    UNKNOWNS,
    VECTORS,
    gather,
    gather_motion,
    pull,
    pull_matrix,
)
from fem_lie.forms.kernels.addresses import UFCX_SIGNATURE, Pointer, pointer, shift
from fem_lie.lie.tuples import Vector, dot, load, load_row, plus, scaled, store, store_row

HEAD = 5
"""Numbers before the tables of an element: samples of each strain, points, share at the points."""
_ROWS, _SIZES = 12 * NODES, 3


class Rule(NamedTuple):
    """Tables of an element, the same for all cells.

    Attributes:
        counts: Samples of E₁₁, of E₂₂ and of 2 E₁₂, and points of integration.
        share: How much of the membrane strain is that at the points themselves.
        along: ∂ξ at the samples of E₁₁, shape (s₁, 16).
        across: ∂η at those of E₂₂, shape (s₂, 16).
        both: Both at those of 2 E₁₂, shape (s₃, 2, 16).
        spread: Of each strain, values at the points of the polynomials that are one at a sample,
            shapes (g, s₁), (g, s₂), (g, s₃).
        points: (∂ξ, ∂η, ∂ξξ, ∂ηη, ∂ξη) there, shape (g, 5, 16).
    """

    counts: tuple[int, int, int, int]
    share: float
    along: Array
    across: Array
    both: Array
    spread: tuple[Array, Array, Array]
    points: Array

    def packed(self) -> Array:
        """As the kernels read it."""
        tables = self.along, self.across, self.both, *self.spread, self.points
        head = np.array([*self.counts, self.share])
        return np.concatenate([head, *(table.ravel() for table in tables)])


class Data(NamedTuple):
    """What the kernels read of one cell.

    Attributes:
        rows: Of its nodes, shape (8, 4, 3).
        sizes: Of the cell in the patch's parameters, see :mod:`.rows`, shape (3,).
        sampled: Membrane strains of the unloaded cell at the samples, shape (s,).
        unloaded: All strains of the unloaded cell at the points, shape (g, 6).
        stiffness: ``D`` at the points, shape (g, 6, 6).
        stress: What is carried, shape (g, 6).
    """

    rows: Array
    sizes: Array
    sampled: Array
    unloaded: Array
    stiffness: Array
    stress: Array


def stress_at(samples: int, points: int) -> int:
    """Where the carried stress begins in a cell's data; it is the last of them."""
    return _ROWS + _SIZES + samples + 42 * points


@inlined
def _rule(c: Pointer) -> Rule:
    head = numba.carray(c, (HEAD,))
    n1, n2, n3, g = int(head[0]), int(head[1]), int(head[2]), int(head[3])
    at = HEAD
    along = numba.carray(shift(c, at), (n1, VECTORS))
    at += VECTORS * n1
    across = numba.carray(shift(c, at), (n2, VECTORS))
    at += VECTORS * n2
    both = numba.carray(shift(c, at), (n3, 2, VECTORS))
    at += 2 * VECTORS * n3
    first = numba.carray(shift(c, at), (g, n1))
    at += g * n1
    second = numba.carray(shift(c, at), (g, n2))
    at += g * n2
    third = numba.carray(shift(c, at), (g, n3))
    at += g * n3
    points = numba.carray(shift(c, at), (g, 5, VECTORS))
    return Rule((n1, n2, n3, g), head[4], along, across, both, (first, second, third), points)


@inlined
def _data(w: Pointer, samples: int, points: int) -> Data:
    at = _ROWS + _SIZES
    sampled = numba.carray(shift(w, at), (samples,))
    at += samples
    unloaded = numba.carray(shift(w, at), (points, 6))
    at += 6 * points
    stiffness = numba.carray(shift(w, at), (points, 6, 6))
    at += 36 * points
    stress = numba.carray(shift(w, at), (points, 6))
    rows, sizes = numba.carray(w, (NODES, 4, 3)), numba.carray(shift(w, _ROWS), (_SIZES,))
    return Data(rows, sizes, sampled, unloaded, stiffness, stress)


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
def _differentiate(rule: Rule, q: Array, slopes: Array, z: Array) -> None:
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
    _differentiate(rule, work.q, work.slopes, work.z)
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
def _stress(D: Array, strain: Array, out: Array) -> None:
    for i in range(6):
        out[i] = 0.0
        for j in range(6):
            out[i] += D[i, j] * strain[j]


@inlined
def _begin(w: Pointer, c: Pointer) -> tuple[Rule, Data]:
    rule = _rule(c)
    n1, n2, n3, points = rule.counts
    return rule, _data(w, n1 + n2 + n3, points)


@inlined
def _room(place: Pointer, samples: int, points: int) -> Work:
    """In memory of :func:`_room_size`."""
    q = numba.carray(place, (VECTORS, 3))
    slopes = numba.carray(shift(place, UNKNOWNS), (samples, 2, 3))
    z = numba.carray(shift(place, UNKNOWNS + 6 * samples), (points, 5, 3))
    at = UNKNOWNS + 6 * samples + 15 * points
    found = numba.carray(shift(place, at), (samples,))
    strains = numba.carray(shift(place, at + samples), (points, 6))
    return Work(q, slopes, z, found, strains)


@inlined
def _room_size(samples: int, points: int) -> int:
    return UNKNOWNS + 7 * samples + 21 * points


@callback(UFCX_SIGNATURE)
def energy_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Energy of a cell."""
    rule, data = _begin(w, c)
    samples, points = data.sampled.shape[0], data.unloaded.shape[0]
    work = _room(stack(_room_size(samples, points)), samples, points)
    value, S = numba.carray(A, (1,)), numba.carray(stack(6), (6,))
    gather(data.rows, data.sizes, work.q)
    find_strains(rule, data, work)
    for g in range(points):
        _stress(data.stiffness[g], work.strains[g], S)
        for k in range(6):
            value[0] += 0.5 * S[k] * work.strains[g, k]


@callback(UFCX_SIGNATURE)
def force_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Forces on the nodes of a cell."""
    rule, data = _begin(w, c)
    samples, points = data.sampled.shape[0], data.unloaded.shape[0]
    work = _room(stack(_room_size(samples, points)), samples, points)
    f, on_samples = numba.carray(stack(UNKNOWNS), (VECTORS, 3)), work.samples
    S, fz = numba.carray(stack(6), (6,)), numba.carray(stack(15), (5, 3))
    gather(data.rows, data.sizes, work.q)
    find_strains(rule, data, work)
    f[:] = 0.0
    on_samples[:] = 0.0
    for g in range(points):
        _stress(data.stiffness[g], work.strains[g], S)
        _add_to_samples(rule, g, S, on_samples)
        z = work.z[g]
        pull_moments(z, load(S, 3), fz)
        n1, n2, n12 = scaled(rule.share, load(S, 0))
        r1, r2 = load_row(z, 0), load_row(z, 1)
        store(fz[0], 0, plus(load_row(fz, 0), plus(scaled(n1, r1), scaled(n12, r2))))
        store(fz[1], 0, plus(load_row(fz, 1), plus(scaled(n2, r2), scaled(n12, r1))))
        for a in range(VECTORS):
            for k in range(5):
                for j in range(3):
                    f[a, j] += rule.points[g, k, a] * fz[k, j]
    _pull_samples(rule, work.slopes, on_samples, f)
    pull(data.rows, data.sizes, f, numba.carray(A, (NODES, 6)))


@inlined
def _add_to_samples(rule: Rule, g: int, S: Array, out: Array) -> None:
    """What the stress at a point is on the samples, shape (s,)."""
    n1, n2, n3, _ = rule.counts
    rest = 1.0 - rule.share
    for i in range(n1):
        out[i] += rest * rule.spread[0][g, i] * S[0]
    for i in range(n2):
        out[n1 + i] += rest * rule.spread[1][g, i] * S[1]
    for i in range(n3):
        out[n1 + n2 + i] += rest * rule.spread[2][g, i] * S[2]


@compiled
def _pull_samples(rule: Rule, slopes: Array, s: Array, f: Array) -> None:
    """Add the forces that stresses ``s`` on the samples are to ``f`` (16, 3)."""
    n1, n2, n3, _ = rule.counts
    for i in range(n1):
        for a in range(VECTORS):
            for j in range(3):
                f[a, j] += s[i] * rule.along[i, a] * slopes[i, 0, j]
    for i in range(n2):
        for a in range(VECTORS):
            for j in range(3):
                f[a, j] += s[n1 + i] * rule.across[i, a] * slopes[n1 + i, 1, j]
    for i in range(n3):
        k = n1 + n2 + i
        for a in range(VECTORS):
            first, second = rule.both[i, 0, a], rule.both[i, 1, a]
            for j in range(3):
                f[a, j] += s[k] * (first * slopes[k, 1, j] + second * slopes[k, 0, j])


@compiled
def _change_rows(rule: Rule, work: Work, g: int, fz: Array, out: Array) -> None:
    """``∂ε/∂q`` at a point, shape (6, 16, 3)."""
    n1, n2, n3, _ = rule.counts
    rest, z, slopes = 1.0 - rule.share, work.z[g], work.slopes
    out[:] = 0.0
    for i in range(n1):
        factor = rest * rule.spread[0][g, i]
        for a in range(VECTORS):
            for j in range(3):
                out[0, a, j] += factor * rule.along[i, a] * slopes[i, 0, j]
    for i in range(n2):
        factor = rest * rule.spread[1][g, i]
        for a in range(VECTORS):
            for j in range(3):
                out[1, a, j] += factor * rule.across[i, a] * slopes[n1 + i, 1, j]
    for i in range(n3):
        factor, k = rest * rule.spread[2][g, i], n1 + n2 + i
        for a in range(VECTORS):
            first, second = factor * rule.both[i, 0, a], factor * rule.both[i, 1, a]
            for j in range(3):
                out[2, a, j] += first * slopes[k, 1, j] + second * slopes[k, 0, j]
    table = rule.points[g]
    for a in range(VECTORS):
        first, second = rule.share * table[0, a], rule.share * table[1, a]
        for j in range(3):
            out[0, a, j] += first * z[0, j]
            out[1, a, j] += second * z[1, j]
            out[2, a, j] += first * z[1, j] + second * z[0, j]
    for c in range(3):
        unit = (1.0 if c == 0 else 0.0), (1.0 if c == 1 else 0.0), (1.0 if c == 2 else 0.0)
        pull_moments(z, unit, fz)
        for k in range(5):
            for a in range(VECTORS):
                for j in range(3):
                    out[3 + c, a, j] += table[k, a] * fz[k, j]


@compiled
def _add_material(rows: Array, D: Array, stress_rows: Array, K: Array) -> None:
    """``K += rowsᵀ D rows``, rows (6, 48)."""
    for i in range(6):
        for b in range(UNKNOWNS):
            stress_rows[i, b] = 0.0
        for j in range(6):
            d = D[i, j]
            for b in range(UNKNOWNS):
                stress_rows[i, b] += d * rows[j, b]
    for i in range(6):
        for a in range(UNKNOWNS):
            x = rows[i, a]
            for b in range(UNKNOWNS):
                K[a, b] += x * stress_rows[i, b]


@compiled
def _add_geometric(table: Array, G: Array, half: Array, K: Array) -> None:
    """``K += tableᵀ G table`` with ``G`` (5, 3, 5, 3); ``half``: work, shape (16, 3)."""
    for k in range(5):
        for i in range(3):
            half[:] = 0.0
            for m in range(5):
                for b in range(VECTORS):
                    t = table[m, b]
                    for j in range(3):
                        half[b, j] += G[k, i, m, j] * t
            for a in range(VECTORS):
                t = table[k, a]
                for b in range(VECTORS):
                    for j in range(3):
                        K[3 * a + i, 3 * b + j] += t * half[b, j]


@compiled
def _add_geometric_of_samples(rule: Rule, s: Array, P: Array, K: Array) -> None:
    """That of stresses on the samples, the same in all directions; ``P``: work, (16, 16)."""
    n1, n2, n3, _ = rule.counts
    P[:] = 0.0
    for i in range(n1 + n2):
        table = rule.along[i] if i < n1 else rule.across[i - n1]
        for a in range(VECTORS):
            t = s[i] * table[a]
            for b in range(VECTORS):
                P[a, b] += t * table[b]
    for i in range(n3):
        first, second = rule.both[i, 0], rule.both[i, 1]
        for a in range(VECTORS):
            t1, t2 = s[n1 + n2 + i] * first[a], s[n1 + n2 + i] * second[a]
            for b in range(VECTORS):
                P[a, b] += t1 * second[b] + t2 * first[b]
    for a in range(VECTORS):
        for b in range(VECTORS):
            for j in range(3):
                K[3 * a + j, 3 * b + j] += P[a, b]


@callback(UFCX_SIGNATURE)
def tangent_kernel(
    A: Pointer, w: Pointer, c: Pointer, x: Pointer, entity: Pointer, permutation: Pointer
) -> None:
    """Matrix of a cell, with the carried stress."""
    rule, data = _begin(w, c)
    samples, points = data.sampled.shape[0], data.unloaded.shape[0]
    work = _room(stack(_room_size(samples, points)), samples, points)
    K = numba.carray(stack(UNKNOWNS * UNKNOWNS), (UNKNOWNS, UNKNOWNS))
    change = stack(6 * UNKNOWNS)
    rows, rows3 = numba.carray(change, (6, UNKNOWNS)), numba.carray(change, (6, VECTORS, 3))
    stress_rows = numba.carray(stack(6 * UNKNOWNS), (6, UNKNOWNS))
    G, fz = numba.carray(stack(225), (5, 3, 5, 3)), numba.carray(stack(15), (5, 3))
    turn, half = numba.carray(stack(45), (5, 3, 3)), numba.carray(stack(48), (VECTORS, 3))
    P, R = numba.carray(stack(256), (VECTORS, VECTORS)), numba.carray(stack(72), (NODES, 3, 3))
    gather(data.rows, data.sizes, work.q)
    _differentiate(rule, work.q, work.slopes, work.z)
    K[:] = 0.0
    work.samples[:] = 0.0
    for g in range(points):
        S = data.stress[g]
        _change_rows(rule, work, g, fz, rows3)
        _add_material(rows, data.stiffness[g], stress_rows, K)
        _add_to_samples(rule, g, S, work.samples)
        geometric(work.z[g], load(S, 3), G, turn)
        for j in range(3):
            G[0, j, 0, j] += rule.share * S[0]
            G[1, j, 1, j] += rule.share * S[1]
            G[0, j, 1, j] += rule.share * S[2]
            G[1, j, 0, j] += rule.share * S[2]
        _add_geometric(rule.points[g], G, half, K)
    _add_geometric_of_samples(rule, work.samples, P, K)
    pull_matrix(data.rows, data.sizes, K, R, numba.carray(A, (NODES, 6, NODES, 6)))


@compiled
def carry_stress(H: Array, h: Array, cells: Indices, place: tuple[int, int], c: int) -> None:
    """Make the carried stress of all cells ``D (ε + ε' h)``.

    Args:
        H: Rows of all nodes, shape (n, 4, 3).
        h: Their motions, shape (n, 6).
        cells: Nodes of each cell, shape (m, 8).
        place: Address and length of the cells' data.
        c: Address of the tables.
    """
    rule = _rule(pointer(c))
    n1, n2, n3, points = rule.counts
    samples = n1 + n2 + n3
    work = _room(stack(_room_size(samples, points)), samples, points)
    moved, own = np.empty((NODES, 6)), np.empty(6)
    dq, rows, fz = np.empty((VECTORS, 3)), np.empty((6, VECTORS, 3)), np.empty((5, 3))
    for e in range(cells.shape[0]):
        data = _data(pointer(place[0] + 8 * place[1] * e), samples, points)
        for i in range(NODES):
            data.rows[i] = H[cells[e, i]]
            moved[i] = h[cells[e, i]]
        gather(data.rows, data.sizes, work.q)
        find_strains(rule, data, work)
        gather_motion(data.rows, data.sizes, moved, dq)
        for g in range(points):
            _change_rows(rule, work, g, fz, rows)
            for k in range(6):
                own[k] = work.strains[g, k]
                for a in range(VECTORS):
                    for j in range(3):
                        own[k] += rows[k, a, j] * dq[a, j]
            _stress(data.stiffness[g], own, data.stress[g])


@compiled
def all_strains(H: Array, cells: Indices, place: tuple[int, int], c: int, out: Array) -> None:
    """Strains at the points of all cells, shape (m, g, 6); arguments as :func:`carry_stress`."""
    rule = _rule(pointer(c))
    n1, n2, n3, points = rule.counts
    samples = n1 + n2 + n3
    work = _room(stack(_room_size(samples, points)), samples, points)
    for e in range(cells.shape[0]):
        data = _data(pointer(place[0] + 8 * place[1] * e), samples, points)
        for i in range(NODES):
            data.rows[i] = H[cells[e, i]]
        gather(data.rows, data.sizes, work.q)
        find_strains(rule, data, work)
        out[e] = work.strains
