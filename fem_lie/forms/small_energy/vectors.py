"""Vectors of a cell, their scalar products, and derivatives of both in the unknowns; compiled.

Each function evaluates one cell, with the constants ``E`` of its element. Derived vectors are in
:mod:`.derived`.
"""

from __future__ import annotations

from typing import NamedTuple

import numba

from fem_lie._arrays import Array
from fem_lie._jit import inlined
from fem_lie._jit.stack import matrix_at, stack
from fem_lie.forms.kernels.addresses import Pointer, shift
from fem_lie.forms.small_energy.derived import (
    add_change,
    find_derived_changes,
    pull_derived,
)
from fem_lie.forms.small_energy.element import Cells, CompiledFunction
from fem_lie.lie.motions import add_turning as add_symmetric_part
from fem_lie.lie.node_types.forces import pull_back_derivative
from fem_lie.lie.node_types.node_type import POSITION_GRADIENT, axes
from fem_lie.lie.tuples import Vector, combined, load_row, negative, plus, scaled, store


class CellData(NamedTuple):
    """Data of one cell.

    Attributes:
        H: Nodal coordinates, shape (k, 4, 3).
        numbers: Address of the nodal coordinates.
        tables: ``T``, shape (points, vectors, r).
        offsets: ``z₀``, shape (points, vectors or none, 3).
        constants: Constant vectors, shape (points, constants, 3).
        parameters: Address of the parameters of the first point.
        viscosity: ``η``, shape (points, strains or none, strains).
        stress: Linearised stress, that of products of strains last, shape (points, strains + c).
    """

    H: Array
    numbers: Pointer
    tables: Array
    offsets: Array
    constants: Array
    parameters: Pointer
    viscosity: Array
    stress: Array


@inlined
def read(E: Cells, w: Pointer) -> CellData:
    """Data of the cell at the address ``w``."""
    k, r, n = E.types.shape[0], E.starts.shape[0], E.strains
    at = 12 * k
    tables = numba.carray(shift(w, at), (E.points, E.vectors, r))
    at += E.points * E.vectors * r
    offsets = numba.carray(shift(w, at), (E.points, E.offsets, 3))
    at += E.points * E.offsets * 3
    constants = numba.carray(shift(w, at), (E.points, E.constants, 3))
    at += E.points * E.constants * 3
    parameters = shift(w, at)
    at += E.points * E.parameters
    viscosity = numba.carray(shift(w, at), (E.points, n if E.viscosities > 0 else 0, n))
    widths = E.points, n + E.pairs.shape[0]
    stress = numba.carray(shift(w, at + E.points * E.viscosities), widths)
    H = numba.carray(w, (k, 4, 3))
    return CellData(H, w, tables, offsets, constants, parameters, viscosity, stress)


@inlined
def all_vectors(E: Cells) -> int:
    """Number of vectors at each point: linear, constant and derived ones."""
    return E.vectors + E.constants + E.inputs.shape[0]


@inlined
def clear(a: Array) -> None:
    """Set a matrix to zero."""
    for i in range(a.shape[0]):
        for k in range(a.shape[1]):
            a[i, k] = 0.0


@inlined
def find_vectors(E: Cells, data: CellData, p: int, z: Array) -> None:
    """Set the linear and constant vectors at a point, the first of ``z`` (all, 3)."""
    T, q = data.tables[p], data.numbers
    for v in range(E.vectors):
        x, y, w = load_row(data.offsets[p], v) if E.offsets > 0 else (0.0, 0.0, 0.0)
        for r in range(E.starts.shape[0]):
            t, at = T[v, r], E.starts[r]
            x += t * q[at]
            y += t * q[at + 1]
            w += t * q[at + 2]
        store(z[v], 0, (x, y, w))
    for c in range(E.constants):
        store(z[E.vectors + c], 0, load_row(data.constants[p], c))


@inlined
def find_sums(E: Cells, z: Array, s: Array) -> None:
    """Set the sums of products: strains, or single products."""
    for i in range(s.shape[0]):
        s[i] = 0.0
    for t in range(E.terms.shape[0]):
        a, b = E.terms[t, 1], E.terms[t, 2]
        product = z[a, 0] * z[b, 0] + z[a, 1] * z[b, 1] + z[a, 2] * z[b, 2]
        s[E.terms[t, 0]] += E.factors[t] * product


@inlined
def find_rates(
    E: Cells,
    derive: CompiledFunction | None,
    T: Array,
    z: Array,
    Y: Array,
    dq: Array,
    dz: Array,
    ds: Array,
) -> None:
    """Set changes ``ds`` of :func:`find_sums` from changes ``dq`` (r, 3) of coordinates.

    ``dz``: workspace for changes of the vectors, shape (all, 3).
    """
    clear(dz)
    for v in range(T.shape[0]):
        for r in range(T.shape[1]):
            store(dz[v], 0, plus(load_row(dz, v), scaled(T[v, r], load_row(dq, r))))
    if derive is not None:
        find_derived_changes(E, Y, dz)
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
def find_vector_forces(E: Cells, z: Array, g: Array, fz: Array) -> None:
    """Set forces ``fz`` (all, 3) on all vectors from forces ``g`` on sums of products."""
    clear(fz)
    for t in range(E.terms.shape[0]):
        a, b, s = E.terms[t, 1], E.terms[t, 2], E.factors[t] * g[E.terms[t, 0]]
        for j in range(3):
            fz[a, j] += s * z[b, j]
            fz[b, j] += s * z[a, j]


@inlined
def add_pulled(
    E: Cells, derive: CompiledFunction | None, T: Array, Y: Array, fz: Array, f: Array
) -> None:
    """Add forces ``fz`` on vectors as forces on coordinate vectors to ``f`` (r, 3).

    Forces on derived vectors are added to ``fz`` of their inputs.
    """
    if derive is not None:
        pull_derived(E, Y, fz)
    for r in range(T.shape[1]):
        x, y, w = load_row(f, r)
        for v in range(E.vectors):
            t = T[v, r]
            x += t * fz[v, 0]
            y += t * fz[v, 1]
            w += t * fz[v, 2]
        store(f[r], 0, (x, y, w))


@inlined
def _direction(own: tuple[Vector, Vector, Vector], director: int, m: int) -> Vector:
    """Derivative of a coordinate vector of a node in the m-th unknown of its group.

    ``own`` are the axes of the node; ``director``: 1 to 3 for those of frames, zero for others.
    """
    d1, d2, d3 = own
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
def _axes(E: Cells, H: Array, r: int) -> tuple[Vector, Vector, Vector]:
    """Axes of the node of a coordinate vector."""
    node = E.coordinates[r, 0]
    return axes(E.types[node], H[node])


@inlined
def add_local(E: Cells, H: Array, f: Array, out: Array) -> None:
    """Add forces on coordinate vectors (r, 3) as forces along nodal axes, (6 k,)."""
    for r in range(E.starts.shape[0]):
        first, own = E.groups[E.coordinates[r, 2]], _axes(E, H, r)
        for m in range(3):
            x, y, w = _direction(own, E.coordinates[r, 3], m)
            out[first + m] += x * f[r, 0] + y * f[r, 1] + w * f[r, 2]


@inlined
def push_local(E: Cells, H: Array, h: Array, dq: Array) -> None:
    """Changes (r, 3) of coordinate vectors by increments or twists of the nodes, (6 k,)."""
    for r in range(E.starts.shape[0]):
        first, own = E.groups[E.coordinates[r, 2]], _axes(E, H, r)
        moved = 0.0, 0.0, 0.0
        for m in range(3):
            moved = plus(moved, scaled(h[first + m], _direction(own, E.coordinates[r, 3], m)))
        store(dq[r], 0, moved)


# --- matrices -------------------------------------------------------------------------------------


@inlined
def find_directions(E: Cells, H: Array, D: Array) -> None:
    """Derivatives of all coordinate vectors in the unknowns of their groups, (r, 3, 3)."""
    for r in range(E.starts.shape[0]):
        own = _axes(E, H, r)
        for m in range(3):
            store(D[r, m], 0, _direction(own, E.coordinates[r, 3], m))


@inlined
def find_changes(
    E: Cells,
    derive: CompiledFunction | None,
    T: Array,
    z: Array,
    Y: Array,
    D: Array,
    B: Array,
    S: Array,
) -> None:
    """Derivatives ``S`` of sums of products in the unknowns, shape (sums, groups, 3).

    ``B``: workspace for those in the coordinate vectors, shape (sums, r, 3).
    """
    count, r = B.shape[0], E.starts.shape[0]
    for i in range(count):
        clear(B[i])
        clear(S[i])
    for t in range(E.terms.shape[0]):
        i, a, b = E.terms[t]
        za, zb = scaled(E.factors[t], load_row(z, a)), scaled(E.factors[t], load_row(z, b))
        if derive is None and E.constants == 0:
            for k in range(r):
                moved = combined(T[a, k], zb, T[b, k], za)
                store(B[i, k], 0, plus(load_row(B[i], k), moved))
        else:
            add_change(E, T, Y, a, zb, B[i])
            add_change(E, T, Y, b, za, B[i])
    for i in range(count):
        for k in range(r):
            x, y, w = load_row(B[i], k)
            group = E.coordinates[k, 2]
            for m in range(3):
                S[i, group, m] += x * D[k, m, 0] + y * D[k, m, 1] + w * D[k, m, 2]


@inlined
def add_congruent(M: Array, S: Array, MS: Array, K: Array) -> None:
    """Add ``Sᵀ M S`` of a symmetric ``M`` to ``K`` on and above its diagonal; ``S`` (n, any).

    ``MS``: workspace for the product. Four rows at a time, for fewer loads and stores.
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
    """Add second derivatives of products at forces ``g`` on their sums to ``G`` (r, r).

    They are equal for all three components.
    """
    for t in range(E.terms.shape[0]):
        a, b, s = E.terms[t, 1], E.terms[t, 2], E.factors[t] * g[E.terms[t, 0]]
        if max(a, b) >= E.vectors:
            continue
        for i in range(T.shape[1]):
            first, second = s * T[a, i], s * T[b, i]
            if first == 0.0 and second == 0.0:
                continue
            for k in range(T.shape[1]):
                G[i, k] += first * T[b, k] + second * T[a, k]


@inlined
def add_local_matrix(E: Cells, D: Array, K: Array, G: Array, out: Array) -> None:
    """Add ``K`` (3 groups, 3 groups) and ``G`` (r, r) of all components to (6 k, 6 k).

    ``K`` is read on and above its diagonal, and overwritten.
    """
    for a in range(K.shape[0]):
        for b in range(a):
            K[a, b] = K[b, a]
    for i in range(E.starts.shape[0]):
        for k in range(E.starts.shape[0]):
            if G[i, k] == 0.0:
                continue
            first, second = 3 * E.coordinates[i, 2], 3 * E.coordinates[k, 2]
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
    """Add the change of forces ``f`` (r, 3) by rotation of nodal axes to (6 k, 6 k)."""
    k = E.types.shape[0]
    out, own = numba.carray(A, (k, 6, k, 6)), matrix_at(stack(12), 4, 3)
    for node in range(k):
        if E.types[node] <= POSITION_GRADIENT:
            clear(own)
            for r in range(E.starts.shape[0]):
                if E.coordinates[r, 0] == node:
                    store(own[E.coordinates[r, 1]], 0, load_row(f, r))
            pull_back_derivative(E.types[node], H[node], own, 1.0, out[node, :, node])


@inlined
def add_turning_of_frames(E: Cells, H: Array, f: Array, A: Pointer) -> None:
    """Add the terms by which the matrix of frames at forces ``f`` becomes symmetric."""
    k = E.types.shape[0]
    out, local_at = numba.carray(A, (k, 6, k, 6)), stack(6 * k)
    local = matrix_at(local_at, k, 6)
    clear(local)
    add_local(E, H, f, numba.carray(local_at, (6 * k,)))
    for node in range(k):
        if E.types[node] < POSITION_GRADIENT:
            add_symmetric_part(local[node], 1.0, out[node, :, node])
