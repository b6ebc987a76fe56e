"""Axes of the edges of discrete rods."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie._jit import compiled
from fem_lie.lie.edges import turn_on_to
from fem_lie.lie.tuples import load_row, minus


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
        own, way = rows[a[k]].copy(), load_row(rows[a[k]], 1)
        if a[k] != b[k]:
            way = minus(load_row(rows[b[k]], 0), load_row(own, 0))
        turn_on_to(own, way)
        out[k] = own[1:]
    return out
