r"""Refinement of quadrilaterals into nine, and of their neighbours without hanging nodes.

Nodes are marked, those of cells to be cut; each cell is cut by a pattern of the marks at its
corners (R. Schneiders, Eng. Comput. 12 (1996) 168)::

    one              two              three            four

    ·-----------·    ·-----------·    ·-------*---o    o---*---*---o
    |         / |    | \       / |    | \     |   |    |   |   |   |
    |       /   |    |  *-----*  |    |  *----*---*    *---*---*---*
    |     /     |    |  |     |  |    |  |    |   |    |   |   |   |
    *---*       |    *--*-----*--*    *--*----*---*    *---*---*---*
    |   |       |    |  |     |  |    |  |    |   |    |   |   |   |
    o---*-------·    o--*-----*--o    o--*----*---o    o---*---*---o

Edges are cut in thirds, not in halves: without a hanging node or a triangle, adjacent cells could
not be cut in halves differently.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from fem_lie._arrays import Array, Flags, Indices

_ROUND = np.array([0, 1, 3, 2])  # cyclic order of four nodes in DOLFINx's order
_CORNERS = np.array([[0, 0], [3, 0], [3, 3], [0, 3]])  # in thirds, in cyclic order


def _square(x: int, y: int) -> list[tuple[int, int]]:
    return [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)]


_BOTTOM = [_square(x, 0) for x in range(3)]
_PATTERNS = {
    1: np.array(
        [_square(0, 0), [(1, 0), (3, 0), (3, 3), (1, 1)], [(0, 1), (1, 1), (3, 3), (0, 3)]]
    ),
    2: np.array(
        [
            *_BOTTOM,
            _square(1, 1),
            [(0, 1), (1, 1), (1, 2), (0, 3)],
            [(2, 1), (3, 1), (3, 3), (2, 2)],
            [(1, 2), (2, 2), (3, 3), (0, 3)],
        ]
    ),
    3: np.array(
        [
            *_BOTTOM,
            _square(1, 1),
            _square(2, 1),
            _square(2, 2),
            [(0, 1), (1, 1), (1, 2), (0, 3)],
            [(1, 2), (2, 2), (2, 3), (0, 3)],
        ]
    ),
    4: np.array([_square(x, y) for y in range(3) for x in range(3)]),
}
"""Children by their corners, in thirds and cyclic order, with marks at the first corners of the
parent."""


@dataclass(frozen=True, eq=False)
class CutCells:
    """Result of cutting quadrilaterals.

    Attributes:
        cells: Nodes of the cells, old nodes first, shape (m, 4).
        parents: Parent of each cell, shape (m,).
        weights: Weights of the parent's corners at each node, shape (m, 4, 4).
        positions: Positions of the new points, shape (k, 3).
        on_edges: Number of the new point on an edge, by (its end with the lower number, the other
            end, thirds from the first).
    """

    cells: Indices
    parents: Indices
    weights: Array
    positions: Array
    on_edges: dict[tuple[int, int, int], int]

    def pieces(self, edges: Indices) -> Indices:
        """Edges (e, 2) after cutting."""
        found: list[tuple[int, int]] = []
        for a, b in ((int(a), int(b)) for a, b in edges):
            low, high, along = (a, b, (1, 2)) if a < b else (b, a, (2, 1))
            keys = [(low, high, t) for t in along]
            line = [a, *(self.on_edges[key] for key in keys if key in self.on_edges), b]
            found += pairwise(line)
        return np.array(found, dtype=np.int64).reshape(-1, 2)


def cut_quadrilaterals(points: Array, cells: Indices, marked: Indices) -> CutCells:
    """Cut cells into nine, and those around them by the patterns.

    Args:
        points: Coordinates, shape (n, 3).
        cells: Nodes of the cells in DOLFINx's order, shape (m, 4).
        marked: Cells to be cut.
    """
    round_ = cells[:, _ROUND]
    marks = _closed(round_, np.isin(np.arange(len(points)), cells[marked]))
    whole = np.flatnonzero(~marks.any(axis=1))
    parts, parents, keys = [], [whole], [_keys(round_[whole], whole, _CORNERS)]
    parts.append(np.broadcast_to(_CORNERS, (len(whole), 4, 2)))
    for count, pattern in _PATTERNS.items():
        for turn in range(1 if count == 4 else 4):
            first = np.roll(np.arange(4) < count, turn)
            which = np.flatnonzero((marks == first).all(axis=1))
            turned = _turned(pattern, turn)
            for child in turned:
                parents.append(which)
                parts.append(np.broadcast_to(child, (len(which), 4, 2)))
                keys.append(_keys(round_[which], which, child))
    owner, at, key = np.concatenate(parents), np.concatenate(parts), np.concatenate(keys)
    order = np.argsort(owner, kind="stable")
    owner, at, key = owner[order], at[order][:, _ROUND], key[order][:, _ROUND]
    return _numbered(points, cells, owner, at, key)


def _closed(round_: Indices, nodes: Flags) -> Flags:
    """Marks at the corners of cells; if two opposite corners are marked, all are."""
    while True:
        marks = nodes[round_]
        across = (marks[:, 0] == marks[:, 2]) & (marks[:, 1] == marks[:, 3])
        across &= marks[:, 0] != marks[:, 1]
        if not across.any():
            return np.asarray(marks)
        nodes = nodes.copy()
        nodes[round_[across]] = True


def _turned(at: Indices, times: int) -> Indices:
    """Coordinates in thirds, rotated with the square by right angles."""
    for _ in range(times):
        at = np.stack([3 - at[..., 1], at[..., 0]], axis=-1)
    return at


def _keys(round_: Indices, cells: Indices, at: Indices) -> Indices:
    """Identifiers of the four corners of one child in all cells, shape (m, 4, 3).

    A node is (n, −1, 0), a point on an edge (lower end, higher end, thirds from the lower), a point
    inside a cell (−1 − cell, x, y).
    """
    keys = np.empty((len(cells), 4, 3), dtype=np.int64)
    for k, (x, y) in enumerate((int(x), int(y)) for x, y in at):
        ends = np.flatnonzero((_CORNERS == (x, y)).all(axis=1))
        sides = [i for i, on in enumerate((y == 0, x == 3, y == 3, x == 0)) if on]
        if len(ends):
            keys[:, k, 0], keys[:, k, 1:] = round_[:, ends[0]], (-1, 0)
        elif sides:
            a, b = round_[:, sides[0]], round_[:, (sides[0] + 1) % 4]
            along = (x, y, 3 - x, 3 - y)[sides[0]]
            keys[:, k, 0], keys[:, k, 1] = np.minimum(a, b), np.maximum(a, b)
            keys[:, k, 2] = np.where(a < b, along, 3 - along)
        else:
            keys[:, k, 0], keys[:, k, 1:] = -1 - cells, (x, y)
    return keys


def _numbered(points: Array, cells: Indices, owner: Indices, at: Indices, key: Indices) -> CutCells:
    x, y = np.moveaxis(at / 3.0, -1, 0)
    weights = np.stack([(1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y], axis=-1)
    flat = key.reshape(-1, 3)
    old = (flat[:, 1] < 0) & (flat[:, 0] >= 0)
    rows, first, number = np.unique(flat[~old], axis=0, return_index=True, return_inverse=True)
    numbers = np.empty(len(flat), dtype=np.int64)
    numbers[old], numbers[~old] = flat[old, 0], len(points) + number.ravel()
    source = np.flatnonzero(~old)[first]
    corners = points[cells[owner[source // 4]]]
    positions = np.einsum("rk,rkj->rj", weights.reshape(-1, 4)[source], corners)
    on_edges = {
        (int(rows[i, 0]), int(rows[i, 1]), int(rows[i, 2])): len(points) + int(i)
        for i in np.flatnonzero(rows[:, 0] >= 0)
    }
    return CutCells(numbers.reshape(-1, 4), owner, weights, positions, on_edges)
