"""Parts of a cell's matrix on its vectors: of the material, and of stresses that turn."""

from __future__ import annotations

from fem_lie._arrays import Array
from fem_lie._jit import compiled
from fem_lie.elements.thin_shells.cell_tables import Rule
from fem_lie.elements.thin_shells.rows import UNKNOWNS, VECTORS


@compiled
def add_material(rows: Array, D: Array, stress_rows: Array, K: Array) -> None:
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
def add_geometric(table: Array, G: Array, half: Array, K: Array) -> None:
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
def add_geometric_of_samples(rule: Rule, s: Array, P: Array, K: Array) -> None:
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
