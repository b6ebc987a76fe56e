"""Sparse LU factors of a matrix of 6×6 blocks, one block row for each node.

Nodes are eliminated in the order of least degree (W. F. Tinney & J. W. Walker, Proc. IEEE 55 (1967)
1801), without exchanges of rows between blocks: the matrix is a positive definite one times a
block-diagonal one, or close to that.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, inlined_uncounted, uncounted
from fem_lie.contact.cones.jacobian import BlockRows

DEAR = 500
"""Products of blocks per contact in a factorisation above which sweeps are cheaper."""


class Pattern(NamedTuple):
    """Blocks of the factors, by the positions of nodes in the order of elimination.

    Attributes:
        position: Position of each node, shape (n,).
        first: First block of each position, then the end of the last one, shape (n + 1,).
        later: Positions that are coupled to an earlier one, in ascending order, shape (b,).
    """

    position: Indices
    first: Indices
    later: Indices


class Factors(NamedTuple):
    """Matrix, then its factors ``L`` and ``U``.

    Attributes:
        diagonal: Diagonal blocks, then the inverses of those of ``U``, shape (n, 6, 6).
        lower: Blocks of later rows in the column of a position, shape (b, 6, 6).
        upper: Blocks of later columns in the row of a position, shape (b, 6, 6).
    """

    diagonal: Array
    lower: Array
    upper: Array


@compiled
def empty_factors(n: int, blocks: int) -> Factors:
    """Uninitialised matrix of ``n`` nodes."""
    return Factors(np.empty((n, 6, 6)), np.empty((blocks, 6, 6)), np.empty((blocks, 6, 6)))


@compiled
def pattern_of(first: Indices, neighbours: Indices) -> Pattern:
    """Pattern of the factors of a matrix with a symmetric pattern.

    Args:
        first: First neighbour of each node, then the end of the last one, shape (n + 1,).
        neighbours: Neighbours of each node; several times, or the node itself, does no harm.
    """
    n = len(first) - 1
    pool: Indices = np.empty(2 * len(neighbours) + 8 * n + 8, np.int64)
    end = 0
    start, length, seen = np.empty(n, np.int64), np.empty(n, np.int64), np.full(n, -1)
    for i in range(n):
        start[i] = end
        seen[i] = i
        for at in range(first[i], first[i + 1]):
            j = neighbours[at]
            if seen[j] != i:
                seen[j] = i
                pool[end] = j
                end += 1
        length[i] = end - start[i]
    seen[:] = -1
    position, ends = np.full(n, -1), np.zeros(n + 1, np.int64)
    nodes: Indices = np.empty(4 * n + end, np.int64)
    left, stamp = np.arange(n), 0
    for step in range(n):
        best = 0
        for at in range(1, n - step):
            if length[left[at]] < length[left[best]]:
                best = at
        p = left[best]
        left[best] = left[n - step - 1]
        position[p], count = step, length[p]
        ends[step + 1] = ends[step] + count
        while ends[step + 1] > len(nodes):
            nodes = np.concatenate((nodes, np.empty_like(nodes)))
        own = pool[start[p] : start[p] + count].copy()
        nodes[ends[step] : ends[step + 1]] = own
        for i in own:
            while end + length[i] + count > len(pool):
                pool = np.concatenate((pool, np.empty_like(pool)))
            begin = end
            stamp += 1
            seen[i] = seen[p] = stamp
            for at in range(start[i], start[i] + length[i]):
                j = pool[at]
                if j != p:
                    seen[j] = stamp
                    pool[end] = j
                    end += 1
            for j in own:
                if seen[j] != stamp:
                    pool[end] = j
                    end += 1
            start[i], length[i] = begin, end - begin
    later = position[nodes[: ends[n]]]
    for p in range(n):
        later[ends[p] : ends[p + 1]].sort()
    return Pattern(position, ends, later)


@compiled
def neighbours_of(rows: BlockRows, responses: BlockRows, k: int, n: int) -> tuple[Indices, Indices]:
    """Nodes that the first ``k`` contacts couple to each of ``n`` nodes, for :func:`pattern_of`."""
    first: Indices = np.zeros(n + 1, np.int64)
    for c in range(k):
        for s in range(rows.first[c], rows.first[c + 1]):
            for t in range(responses.first[c], responses.first[c + 1]):
                if rows.nodes[s] != responses.nodes[t]:
                    first[1 + rows.nodes[s]] += 1
                    first[1 + responses.nodes[t]] += 1
    first = np.cumsum(first)
    at, out = first.copy(), np.empty(first[n], np.int64)
    for c in range(k):
        for s in range(rows.first[c], rows.first[c + 1]):
            for t in range(responses.first[c], responses.first[c + 1]):
                i, j = rows.nodes[s], responses.nodes[t]
                if i != j:
                    out[at[i]], out[at[j]] = j, i
                    at[i] += 1
                    at[j] += 1
    return first, out


@uncounted
def set_identity(into: Factors) -> None:
    """Make the matrix the identity."""
    into.diagonal[:], into.lower[:], into.upper[:] = 0.0, 0.0, 0.0
    for p in range(into.diagonal.shape[0]):
        for a in range(6):
            into.diagonal[p, a, a] = 1.0


@uncounted
def products_of(pattern: Pattern) -> int:
    """Number of products of blocks in a factorisation."""
    total = 0
    for p in range(len(pattern.first) - 1):
        count = pattern.first[p + 1] - pattern.first[p]
        total += count * (count + 1)
    return total


@inlined_uncounted
def add_block(pattern: Pattern, into: Factors, i: int, j: int, left: Array, right: Array) -> None:
    """Add ``leftᵀ right``, of blocks (1 or 3, 6), to the block of positions ``i`` and ``j``."""
    blocks, at = into.diagonal, i
    if i != j:
        p, wanted = (i, j) if i < j else (j, i)
        blocks = into.upper if i < j else into.lower
        at, above = pattern.first[p], pattern.first[p + 1] - 1
        while at < above:
            middle = (at + above) // 2
            if pattern.later[middle] < wanted:
                at = middle + 1
            else:
                above = middle
    for k in range(left.shape[0]):
        for a in range(6):
            for b in range(6):
                blocks[at, a, b] += left[k, a] * right[k, b]


@inlined_uncounted
def _subtract(a: Array, b: Array, out: Array) -> None:
    """``out ← out − a b`` of blocks."""
    for i in range(6):
        for k in range(6):
            here = a[i, k]
            for j in range(6):
                out[i, j] -= here * b[k, j]


@uncounted
def _invert(A: Array, workspace: Array) -> None:
    """``A ← A⁻¹`` of a block by elimination with row exchanges; ``workspace`` has shape (6, 12)."""
    for i in range(6):
        for j in range(6):
            workspace[i, j], workspace[i, 6 + j] = A[i, j], 1.0 if i == j else 0.0
    for k in range(6):
        best = k
        for i in range(k + 1, 6):
            if abs(workspace[i, k]) > abs(workspace[best, k]):
                best = i
        if best != k:
            for j in range(12):
                workspace[k, j], workspace[best, j] = workspace[best, j], workspace[k, j]
        part = 1.0 / workspace[k, k]
        for j in range(12):
            workspace[k, j] *= part
        for i in range(6):
            part = workspace[i, k]
            if i != k and part != 0.0:
                for j in range(12):
                    workspace[i, j] -= part * workspace[k, j]
    for i in range(6):
        for j in range(6):
            A[i, j] = workspace[i, 6 + j]


@uncounted
def factorise(pattern: Pattern, of: Factors, where: Indices, workspace: Array) -> None:
    """Replace the matrix by its factors.

    Args:
        pattern: Pattern of the factors.
        of: Matrix, overwritten.
        where: Workspace, shape (n,).
        workspace: Workspace, shape (6, 12).
    """
    first, later = pattern.first, pattern.later
    for p in range(len(first) - 1):
        _invert(of.diagonal[p], workspace)
        for s in range(first[p], first[p + 1]):
            for i in range(6):
                for j in range(6):
                    workspace[i, j], workspace[i, 6 + j] = of.lower[s, i, j], 0.0
            for i in range(6):
                for k in range(6):
                    for j in range(6):
                        workspace[i, 6 + j] += workspace[i, k] * of.diagonal[p, k, j]
            for i in range(6):
                for j in range(6):
                    of.lower[s, i, j] = workspace[i, 6 + j]
        for s in range(first[p], first[p + 1]):
            i = later[s]
            for t in range(first[i], first[i + 1]):
                where[later[t]] = t
            _subtract(of.lower[s], of.upper[s], of.diagonal[i])
            for t in range(s + 1, first[p + 1]):
                at = where[later[t]]
                _subtract(of.lower[s], of.upper[t], of.upper[at])
                _subtract(of.lower[t], of.upper[s], of.lower[at])


@uncounted
def _substitute(pattern: Pattern, of: Factors, x: Array, workspace: Array) -> None:
    """``x ← A⁻¹ x``, shape (n, 6), by positions; ``workspace`` has shape (6, 12)."""
    first, later = pattern.first, pattern.later
    n = len(first) - 1
    for p in range(n):
        for s in range(first[p], first[p + 1]):
            i = later[s]
            for a in range(6):
                for b in range(6):
                    x[i, a] -= of.lower[s, a, b] * x[p, b]
    for p in range(n - 1, -1, -1):
        for s in range(first[p], first[p + 1]):
            i = later[s]
            for a in range(6):
                for b in range(6):
                    x[p, a] -= of.upper[s, a, b] * x[i, b]
        for a in range(6):
            workspace[0, a] = 0.0
            for b in range(6):
                workspace[0, a] += of.diagonal[p, a, b] * x[p, b]
        for a in range(6):
            x[p, a] = workspace[0, a]


@uncounted
def solve_nodes(pattern: Pattern, of: Factors, W: Array, w: Array, workspace: Array) -> None:
    """``W ← A⁻¹ W``, shape (n, 6), by nodes; workspaces of shapes (n, 6) and (6, 12)."""
    for node in range(W.shape[0]):
        for a in range(6):
            w[pattern.position[node], a] = W[node, a]
    _substitute(pattern, of, w, workspace)
    for node in range(W.shape[0]):
        for a in range(6):
            W[node, a] = w[pattern.position[node], a]
