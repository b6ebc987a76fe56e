"""Axes of the edges of discrete rods."""

from __future__ import annotations

from math import sqrt

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie.lie.tuples import (
    combined,
    cross,
    dot,
    load_row,
    minus,
    plus,
    scaled,
    store_rows,
)

_OPPOSITE = 1e-12  # 1 + cosine: there is no smallest rotation to the opposite direction


@compiled
def edge_axes(rows: Array, a: Indices, b: Indices) -> Array:
    """Axes of edges from nodes to nodes, or of nodes themselves, shape (k, 3, 3): as rows.

    Args:
        rows: Of the nodes, shape (n, 4, 3).
        a: First nodes, whose axes are turned on to the edges by the smallest rotation, shape (k,).
        b: Second nodes; where one is the first, the axes of the node, shape (k,).
    """
    out = np.empty((a.shape[0], 3, 3))
    for k in range(a.shape[0]):
        D, beside = load_row(rows[a[k]], 1), load_row(rows[a[k]], 2)
        way = D
        if a[k] != b[k]:
            way = minus(load_row(rows[b[k]], 0), load_row(rows[a[k]], 0))
        t = scaled(1.0 / sqrt(dot(way, way)), way)
        near = max(1.0 + dot(D, t), _OPPOSITE)
        second = combined(1.0, beside, -dot(beside, t) / near, plus(D, t))
        store_rows(out[k], 0, t, second, cross(t, second))
    return out
