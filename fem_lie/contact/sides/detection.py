"""Detection of near pairs, and of points that passed through a patch: compiled.

Points are sorted into cells of the size of the largest pair; half of the 27 cells around each point
are searched, three in a row at a time. The list contains all pairs that are closer than the sum of
their radii plus a margin. As long as no point has moved by half of the margin, it contains all
pairs in contact. Pairs are sorted, so that sums over them have the same round-off for any choice of
cells.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled, uncounted
from fem_lie.contact.sides.patches import (
    BY_U,
    BY_V,
    NET,
    ROWS,
    VALUE,
    Patches,
    combination,
    is_triangle,
    nearest_on,
    set_shapes,
)
from fem_lie.lie.tuples import combined, cross, dot, load_row, minus

_MOST_CELLS = 2.0**20
"""Largest number of cells along an axis; cell numbers are 64-bit integers."""

_FEW = 64
"""Number of points of one side above which a check of all pairs takes longer than cells."""


@compiled
def _search(
    X: Array, reach: Array, keys: Indices, order: Indices, dims: Indices, out: Indices
) -> int:
    """Pairs (i, j) within the sum of their reaches; counts those beyond ``out``, too."""
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
    """Sorted pairs ``i < j`` with ``|X_i − X_j| < reach_i + reach_j``, shape (m, 2).

    Args:
        X: Positions, shape (n, 3).
        reach: Reach of each point, shape (n,).
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
def _all_between(X: Array, reach: Array, first: int, out: Indices) -> int:
    """Pairs of one of the first points and one of the others; counts beyond the size, too."""
    found = 0
    for i in range(first):
        for j in range(first, X.shape[0]):
            a, b, c = X[i, 0] - X[j, 0], X[i, 1] - X[j, 1], X[i, 2] - X[j, 2]
            both = reach[i] + reach[j]
            if a * a + b * b + c * c < both * both:
                if found < out.shape[0]:
                    out[found, 0], out[found, 1] = i, j
                found += 1
    return found


def near_between(X: Array, reach: Array, first: int) -> Indices:
    """As :func:`near`, for pairs of one of the ``first`` points and one of the others.

    A large ball among many points would put all of them into the same cells, so all pairs are
    checked if one side has few points.
    """
    if first * (len(X) - first) > _FEW * len(X):
        pairs = near(X, reach)
        return np.ascontiguousarray(pairs[(pairs[:, 0] < first) & (pairs[:, 1] >= first)])
    out = np.empty((len(X), 2), dtype=np.int64)
    found = _all_between(X, reach, first, out)
    if found > len(out):
        out = np.empty((found, 2), dtype=np.int64)
        _all_between(X, reach, first, out)
    return out[:found]


@compiled
def moved_by(X: Array, before: Array) -> float:
    """Largest distance between corresponding points, shapes (n, 3); nan counts as infinite."""
    largest = 0.0
    for i in range(X.shape[0]):
        a, b, c = X[i, 0] - before[i, 0], X[i, 1] - before[i, 1], X[i, 2] - before[i, 2]
        square = a * a + b * b + c * c
        if not square <= largest:
            largest = square if square == square else np.inf
    return np.sqrt(largest)


_ON, _HALVINGS = 1e-2, 40
"""Distance relative to the radii within which a point is on a patch; bisections to find when."""


@uncounted
def _side_of(
    X: Array,
    N: Array,
    i: int,
    j: int,
    part: float,
    triangle: bool,
    straight: bool,
    net: Array,
    W: Array,
    C: Array,
) -> tuple[float, float]:
    """Height of a point above the closest point of a patch during a step; squared distance."""
    P = combined(1.0 - part, load_row(X[0], i), part, load_row(X[1], i))
    for k in range(NET):
        for r in range(3):
            net[k, r] = (1.0 - part) * N[0, j, k, r] + part * N[1, j, k, r]
    at = nearest_on(triangle, straight, net, P, W, C)
    set_shapes(triangle, straight, at.u, at.v, W)
    across = cross(combination(net, W, BY_U), combination(net, W, BY_V))
    return dot(across, minus(P, combination(net, W, VALUE))), at.square


@compiled
def first_crossing(X: Array, radii: Array, N: Array, patches: Patches, pairs: Indices) -> int:
    """First pair whose point passes through the middle surface of its patch, or −1.

    Args:
        X: Positions at the start and at the end of a step, shape (2, n, 3).
        radii: Radii of the points, shape (n,).
        N: Control nets of patches at both ends of the step, shape (2, m, 12, 3).
        patches: The patches.
        pairs: Points and patches, shape (·, 2).
    """
    net, W, C = np.empty((NET, 3)), np.empty((ROWS, NET)), np.empty((4, 3))
    for e in range(pairs.shape[0]):
        i, j = pairs[e]
        triangle, straight = is_triangle(patches, j), patches.straight
        first = _side_of(X, N, i, j, 0.0, triangle, straight, net, W, C)[0]
        last = _side_of(X, N, i, j, 1.0, triangle, straight, net, W, C)[0]
        if first == 0.0 or first * last > 0.0:
            continue
        low, high, on = 0.0, 1.0, _ON * (radii[i] + patches.radii[j])
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            height, square = _side_of(X, N, i, j, middle, triangle, straight, net, W, C)
            if square < on * on:
                return e
            if first * height > 0.0:
                low = middle
            else:
                high = middle
    return -1
