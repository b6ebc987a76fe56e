"""Vectors of a cell, their scalar products, and how both move with the nodes: compiled.

All functions are of one cell, and are merged into those of an element with its constants ``E``.
"""

from __future__ import annotations

from typing import NamedTuple

import numba

from fem_lie._arrays import Array
from fem_lie._jit import inlined
from fem_lie._jit.stack import stack
from fem_lie.forms.kernels.addresses import Pointer, shift
from fem_lie.forms.small_energy.element import Cells
from fem_lie.lie.kinds.forces import pull_derivative
from fem_lie.lie.kinds.kind import SLOPE, axes
from fem_lie.lie.tuples import Vector, combined, load_row, negative, plus, scaled, store


class CellData(NamedTuple):
    """Data of one cell.

    Attributes:
        H: Rows of the nodes, shape (k, 4, 3).
        coordinates: The same, flat.
        tables: ``T``, shape (points, vectors, rows).
        offsets: ``z₀``, shape (points, vectors or none, 3).
        parameters: Where those of the first point are.
        viscosity: ``η``, shape (points, strains or none, strains).
        stress: Linearised stress, shape (points, strains).
    """

    H: Array
    coordinates: Array
    tables: Array
    offsets: Array
    parameters: Pointer
    viscosity: Array
    stress: Array


@inlined
def read(E: Cells, w: Pointer) -> CellData:
    """Data of the cell at ``w``."""
    k, r, n = E.types.shape[0], E.rows.shape[0], E.strains
    at = 12 * k
    tables = numba.carray(shift(w, at), (E.points, E.vectors, r))
    at += E.points * E.vectors * r
    offsets = numba.carray(shift(w, at), (E.points, E.offsets, 3))
    at += E.points * E.offsets * 3
    parameters = shift(w, at)
    at += E.points * E.parameters
    viscosity = numba.carray(shift(w, at), (E.points, n if E.viscosities > 0 else 0, n))
    stress = numba.carray(shift(w, at + E.points * E.viscosities), (E.points, n))
    H, flat = numba.carray(w, (k, 4, 3)), numba.carray(w, (12 * k,))
    return CellData(H, flat, tables, offsets, parameters, viscosity, stress)


@inlined
def multiply(T: Array, q: Array, z: Array) -> None:
    """``z = T q``, shape (vectors, 3)."""
    for v in range(T.shape[0]):
        x = y = w = 0.0
        for r in range(T.shape[1]):
            t = T[v, r]
            x += t * q[r, 0]
            y += t * q[r, 1]
            w += t * q[r, 2]
        store(z[v], 0, (x, y, w))


@inlined
def find_vectors(E: Cells, data: CellData, p: int, z: Array) -> None:
    """``z`` at a point, shape (vectors, 3)."""
    T, q = data.tables[p], data.coordinates
    for v in range(E.vectors):
        x = y = w = 0.0
        for r in range(E.places.shape[0]):
            t, at = T[v, r], E.places[r]
            x += t * q[at]
            y += t * q[at + 1]
            w += t * q[at + 2]
        store(z[v], 0, (x, y, w))
    for v in range(E.offsets):
        for j in range(3):
            z[v, j] += data.offsets[p, v, j]


@inlined
def find_sums(E: Cells, z: Array, s: Array) -> None:
    """Sums of products: strains, or each product by itself."""
    for i in range(s.shape[0]):
        s[i] = 0.0
    for t in range(E.terms.shape[0]):
        a, b = E.terms[t, 1], E.terms[t, 2]
        product = z[a, 0] * z[b, 0] + z[a, 1] * z[b, 1] + z[a, 2] * z[b, 2]
        s[E.terms[t, 0]] += E.factors[t] * product


@inlined
def find_rates(E: Cells, z: Array, dz: Array, ds: Array) -> None:
    """Changes of :func:`find_sums` of changes ``dz`` of the vectors."""
    for i in range(ds.shape[0]):
        ds[i] = 0.0
    for t in range(E.terms.shape[0]):
        i, a, b = E.terms[t]
        moved = 0.0
        for j in range(3):
            moved += dz[a, j] * z[b, j] + z[a, j] * dz[b, j]
        ds[i] += E.factors[t] * moved


# --- forces ---------------------------------------------------------------------------------------


@inlined
def add_pulled(E: Cells, T: Array, z: Array, g: Array, fz: Array, f: Array) -> None:
    """Add forces ``g`` on sums of products to those on coordinate vectors, ``f`` (rows, 3).

    ``fz``: room for forces on the vectors, shape (vectors, 3).
    """
    for v in range(E.vectors):
        store(fz[v], 0, (0.0, 0.0, 0.0))
    for t in range(E.terms.shape[0]):
        a, b, s = E.terms[t, 1], E.terms[t, 2], E.factors[t] * g[E.terms[t, 0]]
        for j in range(3):
            fz[a, j] += s * z[b, j]
            fz[b, j] += s * z[a, j]
    for r in range(T.shape[1]):
        x, y, w = load_row(f, r)
        for v in range(E.vectors):
            t_ = T[v, r]
            x += t_ * fz[v, 0]
            y += t_ * fz[v, 1]
            w += t_ * fz[v, 2]
        store(f[r], 0, (x, y, w))


@inlined
def direction(E: Cells, H: Array, r: int, m: int) -> Vector:
    """How a coordinate vector moves with the m-th unknown of its group."""
    d1, d2, d3 = axes(E.types[E.rows[r, 0]], H[E.rows[r, 0]])
    director = E.rows[r, 3]
    if director == 0:
        return d1 if m == 0 else d2 if m == 1 else d3
    # R (e_m × e_k)
    k = director - 1
    if m == k:
        return 0.0, 0.0, 0.0
    third = 3 - m - k
    along = d1 if third == 0 else d2 if third == 1 else d3
    return along if (m + 1) % 3 == k else negative(along)


@inlined
def add_local(E: Cells, H: Array, f: Array, out: Array) -> None:
    """Add forces on coordinate vectors (rows, 3) as forces along the axes of nodes, (6 k,)."""
    for r in range(E.rows.shape[0]):
        first = E.groups[E.rows[r, 2]]
        for m in range(3):
            x, y, w = direction(E, H, r, m)
            out[first + m] += x * f[r, 0] + y * f[r, 1] + w * f[r, 2]


@inlined
def push_local(E: Cells, H: Array, h: Array, dq: Array) -> None:
    """Changes of coordinate vectors, (rows, 3), of increments or twists of the nodes, (6 k,)."""
    for r in range(E.rows.shape[0]):
        first = E.groups[E.rows[r, 2]]
        moved = 0.0, 0.0, 0.0
        for m in range(3):
            moved = plus(moved, scaled(h[first + m], direction(E, H, r, m)))
        store(dq[r], 0, moved)


# --- matrices -------------------------------------------------------------------------------------


@inlined
def find_directions(E: Cells, H: Array, D: Array) -> None:
    """:func:`direction` of all coordinate vectors and unknowns, shape (rows, 3, 3)."""
    for r in range(E.rows.shape[0]):
        for m in range(3):
            store(D[r, m], 0, direction(E, H, r, m))


@inlined
def find_changes(E: Cells, T: Array, z: Array, D: Array, B: Array, S: Array) -> None:
    """Derivatives ``S`` of sums of products in the unknowns, shape (sums, groups, 3).

    ``B``: room for those in the coordinate vectors, shape (sums, rows, 3).
    """
    count, r = B.shape[0], E.rows.shape[0]
    for i in range(count):
        for k in range(r):
            store(B[i, k], 0, (0.0, 0.0, 0.0))
        for u in range(S.shape[1]):
            store(S[i, u], 0, (0.0, 0.0, 0.0))
    for t in range(E.terms.shape[0]):
        i, a, b = E.terms[t]
        za, zb = scaled(E.factors[t], load_row(z, a)), scaled(E.factors[t], load_row(z, b))
        for k in range(r):
            moved = combined(T[a, k], zb, T[b, k], za)
            store(B[i, k], 0, plus(load_row(B[i], k), moved))
    for i in range(count):
        for k in range(r):
            x, y, w = load_row(B[i], k)
            group = E.rows[k, 2]
            for m in range(3):
                S[i, group, m] += x * D[k, m, 0] + y * D[k, m, 1] + w * D[k, m, 2]


@inlined
def add_congruent(M: Array, S: Array, MS: Array, K: Array) -> None:
    """Add ``Sᵀ M S`` of a symmetric ``M`` to ``K`` on and above its diagonal; ``S`` (n, any).

    ``MS``: room for the product. Four rows at a time, for fewer loads and stores.
    """
    n, size = S.shape
    even = 4 * (n // 4)
    for i in range(n):
        for a in range(size):
            MS[i, a] = 0.0
        for k in range(0, even, 4):
            x, y, v, w = M[i, k], M[i, k + 1], M[i, k + 2], M[i, k + 3]
            for a in range(size):
                first = x * S[k, a] + y * S[k + 1, a]
                MS[i, a] += first + (v * S[k + 2, a] + w * S[k + 3, a])
        for k in range(even, n):
            for a in range(size):
                MS[i, a] += M[i, k] * S[k, a]
    for a in range(size):
        for k in range(0, even, 4):
            x, y, v, w = S[k, a], S[k + 1, a], S[k + 2, a], S[k + 3, a]
            for b in range(a, size):
                first = x * MS[k, b] + y * MS[k + 1, b]
                K[a, b] += first + (v * MS[k + 2, b] + w * MS[k + 3, b])
        for k in range(even, n):
            x = S[k, a]
            for b in range(a, size):
                K[a, b] += x * MS[k, b]


@inlined
def add_second(E: Cells, T: Array, g: Array, G: Array) -> None:
    """Add second derivatives of products at forces ``g`` on their sums to ``G`` (rows, rows).

    They are the same for all components.
    """
    for t in range(E.terms.shape[0]):
        a, b, s = E.terms[t, 1], E.terms[t, 2], E.factors[t] * g[E.terms[t, 0]]
        for i in range(E.rows.shape[0]):
            first, second = s * T[a, i], s * T[b, i]
            if first == 0.0 and second == 0.0:
                continue
            for k in range(E.rows.shape[0]):
                G[i, k] += first * T[b, k] + second * T[a, k]


@inlined
def add_local_matrix(E: Cells, D: Array, K: Array, G: Array, out: Array) -> None:
    """Add ``K`` (3 groups, 3 groups) and ``G`` (rows, rows) of all components to (6 k, 6 k).

    ``K`` is read on and above its diagonal, and overwritten.
    """
    for a in range(K.shape[0]):
        for b in range(a):
            K[a, b] = K[b, a]
    for i in range(E.rows.shape[0]):
        for k in range(E.rows.shape[0]):
            first, second = 3 * E.rows[i, 2], 3 * E.rows[k, 2]
            for m in range(3):
                for n in range(3):
                    along = D[i, m, 0] * D[k, n, 0] + D[i, m, 1] * D[k, n, 1]
                    K[first + m, second + n] += G[i, k] * (along + D[i, m, 2] * D[k, n, 2])
    for i in range(E.groups.shape[0]):
        for k in range(E.groups.shape[0]):
            for m in range(3):
                for n in range(3):
                    out[E.groups[i] + m, E.groups[k] + n] += K[3 * i + m, 3 * k + n]


@inlined
def add_turning(E: Cells, H: Array, f: Array, A: Pointer) -> None:
    """What the turning of nodal axes does to forces ``f`` (rows, 3), to a matrix (6 k, 6 k)."""
    k = E.types.shape[0]
    out, own = numba.carray(A, (k, 6, k, 6)), numba.carray(stack(12), (4, 3))
    for node in range(k):
        if E.types[node] <= SLOPE:
            for i in range(4):
                store(own[i], 0, (0.0, 0.0, 0.0))
            for r in range(E.rows.shape[0]):
                if E.rows[r, 0] == node:
                    store(own[E.rows[r, 1]], 0, load_row(f, r))
            pull_derivative(E.types[node], H[node], own, 1.0, out[node, :, node])
