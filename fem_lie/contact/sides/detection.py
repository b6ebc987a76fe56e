"""Who is near whom: cells of the size of the largest pair, in a list that is kept for a while.

Places are sorted by their cells, and half of the 27 cells about each are looked at, three in a row
at a time. The list has all pairs nearer than their radii and a skin; as long as no place has moved
by half the skin it has all that touch. Pairs are sorted: sums over them are the same to the last
bit, whatever the cells.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled

_MOST_CELLS = 2.0**20
"""Along an axis: numbers of cells are whole numbers of 64 bits."""


@compiled
def _search(
    X: Array, reach: Array, keys: Indices, order: Indices, dims: Indices, out: Indices
) -> int:
    """Pairs (i, j) of places within the sum of their reaches; counts those without room, too."""
    found, n = 0, order.shape[0]
    for p in range(n):
        i, key = order[p], keys[p]
        z, y, x = key % dims[2], (key // dims[2]) % dims[1], key // (dims[2] * dims[1])
        for column in range(5):
            dx = 0 if column < 2 else 1
            dy = column if column < 2 else column - 3
            if x + dx >= dims[0] or y + dy < 0 or y + dy >= dims[1]:
                continue
            base = ((x + dx) * dims[1] + y + dy) * dims[2]
            last = base + min(z + 1, dims[2] - 1)
            q = p + 1 if column == 0 else np.searchsorted(keys, base + max(z - 1, 0))
            while q < n and keys[q] <= last:
                j = order[q]
                a, b, c = X[i, 0] - X[j, 0], X[i, 1] - X[j, 1], X[i, 2] - X[j, 2]
                near = reach[i] + reach[j]
                if a * a + b * b + c * c < near * near:
                    if found < out.shape[0]:
                        out[found, 0], out[found, 1] = min(i, j), max(i, j)
                    found += 1
                q += 1
    return found


def near(X: Array, reach: Array) -> Indices:
    """Pairs ``i < j`` of places with ``|X_i − X_j| < reach_i + reach_j``, sorted, shape (m, 2).

    Args:
        X: Places, shape (n, 3).
        reach: Of each, shape (n,).
    """
    if not len(X):
        return np.empty((0, 2), dtype=np.int64)
    low, extent = X.min(axis=0), np.ptp(X, axis=0).max()
    size = max(2.0 * float(reach.max()), float(extent) / _MOST_CELLS, np.finfo(float).tiny)
    cells = np.floor((X - low) / size).astype(np.int64)
    dims = cells.max(axis=0) + 1
    keys = (cells[:, 0] * dims[1] + cells[:, 1]) * dims[2] + cells[:, 2]
    order = np.argsort(keys, kind="stable")
    keys = keys[order]
    out = np.empty((8 * len(X) + 64, 2), dtype=np.int64)
    found = _search(X, reach, keys, order, dims, out)
    if found > len(out):
        out = np.empty((found, 2), dtype=np.int64)
        _search(X, reach, keys, order, dims, out)
    pairs = out[:found]
    return np.ascontiguousarray(pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))])


@compiled
def moved_by(X: Array, before: Array) -> float:
    """The largest distance between places, shapes (n, 3); nan is as far as can be."""
    largest = 0.0
    for i in range(X.shape[0]):
        a, b, c = X[i, 0] - before[i, 0], X[i, 1] - before[i, 1], X[i, 2] - before[i, 2]
        square = a * a + b * b + c * c
        if not square <= largest:
            largest = square if square == square else np.inf
    return np.sqrt(largest)
