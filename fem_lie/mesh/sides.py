"""Which cells of a surface have to be turned round, so that all look to one side."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import breadth_first_order, connected_components

from fem_lie._arrays import Flags, Indices

_AROUND = {
    "triangle": [(0, 1), (1, 2), (2, 0)],
    "quadrilateral": [(0, 1), (1, 3), (3, 2), (2, 0)],
}
"""Sides, one after the other around a cell."""


def turned_round(cells: Indices, cell: str) -> Flags:
    """Cells to be turned round, the first of each piece stays as it is; shape (m,).

    Neighbours that look to the same side go along their common edge in opposite directions. Edges
    at which other than two cells meet say nothing. Of a surface with one side, as Möbius's strip,
    no choice is right, and what is left is for others to refuse.

    Args:
        cells: Points of each cell in DOLFINx's order, shape (m, k).
        cell: ``"triangle"`` or ``"quadrilateral"``.
    """
    around = np.array(_AROUND[cell])
    sides = cells[:, around].reshape(-1, 2)
    owner = np.repeat(np.arange(len(cells)), len(around))
    _, edge, count = np.unique(
        np.sort(sides, axis=1), axis=0, return_inverse=True, return_counts=True
    )
    order = np.argsort(edge.ravel(), kind="stable")
    first = np.searchsorted(edge.ravel()[order], np.flatnonzero(count == 2))
    a, b = order[first], order[first + 1]
    opposite = sides[a, 0] == sides[b, 0]
    # cells with two edges in common are one pair
    pairs, once = np.unique(np.stack([owner[a], owner[b]], 1), axis=0, return_index=True)
    looks = np.where(opposite[once], 2, 1)
    graph = sp.csr_matrix((looks, pairs.T), shape=(len(cells), len(cells)))
    graph = (graph + graph.T).tocsr()
    turned = np.zeros(len(cells), dtype=bool)
    _, piece = connected_components(graph, directed=False)
    for start in np.unique(piece, return_index=True)[1]:
        ordered, before = breadth_first_order(graph, start, directed=False)
        link = np.asarray(graph[before[ordered[1:]], ordered[1:]]).ravel() == 2
        for k, other in zip(ordered[1:], link, strict=True):
            turned[k] = turned[before[k]] ^ other
    return turned


def turn(cells: Indices, cell: str, chosen: Flags) -> Indices:
    """The cells (m, 3 or 4), with the chosen ones turned round."""
    swapped = {"triangle": [0, 2, 1], "quadrilateral": [0, 2, 1, 3]}[cell]
    return np.where(chosen[:, np.newaxis], cells[:, swapped], cells)
