"""First derivatives of a cell's strains, and by them what its stresses are on its vectors."""

from __future__ import annotations

from fem_lie._arrays import Array
from fem_lie._jit import compiled, inlined
from fem_lie.elements.thin_shells.cell_tables import Rule
from fem_lie.elements.thin_shells.curvature import pull_moments
from fem_lie.elements.thin_shells.rows import VECTORS
from fem_lie.elements.thin_shells.strains import Work


@compiled
def change_rows(rule: Rule, work: Work, g: int, fz: Array, out: Array) -> None:
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


@inlined
def add_to_samples(rule: Rule, g: int, S: Array, out: Array) -> None:
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
def pull_samples(rule: Rule, slopes: Array, s: Array, f: Array) -> None:
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
