"""Parts of a cell's stiffness on its Hermite vectors: material and geometric.

``K`` is symmetric, shape (3, 16, 3, 16) or (48, 48): components first, so that the innermost loops
are long. Only ``K[i, :, j, :]`` with ``j ≥ i`` is computed.
"""

from __future__ import annotations

from fem_lie._arrays import Array
from fem_lie._jit import inlined_series
from fem_lie.elements.thin_shells.cell_tables import Rule, first_point
from fem_lie.elements.thin_shells.nodal_coordinates import UNKNOWNS, VECTORS


@inlined_series
def add_material(rows: Array, half: Array, g: int, D: Array, stress_rows: Array, K: Array) -> None:
    """Add ``rowsᵀ D rows`` with rows (6, 48) and the upper half of ``D`` (21, :) at point ``g``.

    ``D``, (6, 6), and ``stress_rows``, (6, 48), are workspaces.
    """
    entry = 0
    for i in range(6):
        for j in range(i, 6):
            D[i, j] = D[j, i] = half[entry, g]
            entry += 1
    for i in range(6):
        d0, d1, d2, d3, d4, d5 = D[i, 0], D[i, 1], D[i, 2], D[i, 3], D[i, 4], D[i, 5]
        for b in range(UNKNOWNS):
            plane = d0 * rows[0, b] + d1 * rows[1, b] + d2 * rows[2, b]
            stress_rows[i, b] = plane + d3 * rows[3, b] + d4 * rows[4, b] + d5 * rows[5, b]
    for a in range(UNKNOWNS):
        x0, x1, x2 = rows[0, a], rows[1, a], rows[2, a]
        x3, x4, x5 = rows[3, a], rows[4, a], rows[5, a]
        for j in range(a // VECTORS, 3):
            # of a length known to the compiler
            for k in range(VECTORS):
                b = VECTORS * j + k
                plane = x0 * stress_rows[0, b] + x1 * stress_rows[1, b] + x2 * stress_rows[2, b]
                bent = x3 * stress_rows[3, b] + x4 * stress_rows[4, b] + x5 * stress_rows[5, b]
                K[a, b] += plane + bent


@inlined_series
def add_geometric(rule: Rule, g: int, G: Array, half: Array, K: Array) -> None:
    """Add ``tableᵀ G table`` at a point, with ``G`` (5, 3, 5, 3), to ``K`` (48, 48).

    ``half``: workspace, shape (5, 3, 16).
    """
    points, T = rule.counts[3], rule.table
    r0 = first_point(rule.counts) + g
    r1, r2, r3, r4 = r0 + points, r0 + 2 * points, r0 + 3 * points, r0 + 4 * points
    for i in range(3):
        for k in range(5):
            for j in range(i, 3):
                g0, g1, g2 = G[k, i, 0, j], G[k, i, 1, j], G[k, i, 2, j]
                g3, g4 = G[k, i, 3, j], G[k, i, 4, j]
                for b in range(VECTORS):
                    slopes = g0 * T[r0, b] + g1 * T[r1, b]
                    half[k, j, b] = slopes + g2 * T[r2, b] + g3 * T[r3, b] + g4 * T[r4, b]
        for a in range(VECTORS):
            t0, t1, t2, t3, t4 = T[r0, a], T[r1, a], T[r2, a], T[r3, a], T[r4, a]
            for j in range(i, 3):
                for b in range(VECTORS):
                    slopes = t0 * half[0, j, b] + t1 * half[1, j, b]
                    bent = t2 * half[2, j, b] + t3 * half[3, j, b] + t4 * half[4, j, b]
                    K[VECTORS * i + a, VECTORS * j + b] += slopes + bent


@inlined_series
def add_geometric_of_samples(rule: Rule, s: Array, P: Array, K: Array) -> None:
    """Add the geometric stiffness of stresses (s,) at the samples; ``P``: workspace, (16, 16).

    It is the same for all components.
    """
    n1, n2, n3, _ = rule.counts
    T = rule.table
    P[:] = 0.0
    for i in range(n1 + n2):
        for a in range(VECTORS):
            t = s[i] * T[i, a]
            for b in range(VECTORS):
                P[a, b] += t * T[i, b]
    for i in range(n1 + n2, n1 + n2 + n3):
        for a in range(VECTORS):
            t, u = s[i] * T[i, a], s[i] * T[i + n3, a]
            for b in range(VECTORS):
                P[a, b] += t * T[i + n3, b] + u * T[i, b]
    for j in range(3):
        for a in range(VECTORS):
            for b in range(VECTORS):
                K[VECTORS * j + a, VECTORS * j + b] += P[a, b]
