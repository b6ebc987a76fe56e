"""Smooth patches of a surface mesh: shared nodes within, separate nodes along kinks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, degrees, radians
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from fem_lie._arrays import Array, Indices

# local nodes of the edges, one after the other around a cell: ends, and what may be between
_EDGES = {
    "triangle": ((0, 1, 5), (1, 2, 3), (2, 0, 4)),
    "quadrilateral": ((0, 1, 4), (1, 3, 6), (3, 2, 7), (2, 0, 5)),
}

_FLAT = cos(radians(5.0))


class CellsOfOneType(NamedTuple):
    """Cells of one type of a surface.

    Attributes:
        cells: Points of each cell, shape (m, k).
        cell: ``"triangle"`` or ``"quadrilateral"``.
        normals: Unit normals at the nodes of each cell, shape (m, k, 3).
    """

    cells: Indices
    cell: str
    normals: Array


@dataclass(frozen=True, eq=False)
class Patches:
    """Nodes of a surface whose patches are smooth.

    Cells of different types have nodes of their own, with equal directors where patches are smooth.

    Attributes:
        cells: Nodes of each cell of each block, one of shape (m, k) for each.
        masters: Point of each node, shape (N,), which is also the first node of that point.
        directors: Mean of the cells' normals at each node, shape (N, 3).
        split: Points that have several directors.
    """

    cells: tuple[Indices, ...]
    masters: Indices
    directors: Array
    split: Indices

    def of_block(self, number: int, points: Indices) -> tuple[Patches, Indices]:
        """Nodes of the cells of one block, on a mesh of these cells.

        Args:
            number: Number of the block.
            points: Points of its cells, ascending, shape (p,).

        Returns:
            Nodes on that mesh, and the number of each of them here, shape (n,).
        """
        used = np.unique(self.cells[number])
        point_of = np.searchsorted(points, self.masters[used])
        order = _numbered(point_of, len(points))
        nodes, masters = np.empty_like(used), np.empty_like(used)
        nodes[order], masters[order] = used, point_of
        cells = order[np.searchsorted(used, self.cells[number])]
        split = np.unique(masters[masters != np.arange(len(masters))])
        return Patches((cells,), masters, self.directors[nodes], split), nodes


class Edges:
    """All sides of cells, and the edges where they meet. Cells are numbered block after block.

    Attributes:
        points: Points of the nodes of all cells, one cell after the other, shape (c,).
        normals: Normals there, shape (c, 3).
        owner: Cell of each side, shape (s,).
        nodes: Nodes of each side among those of all cells, its ends first, shape (s, 2 or 3).
        inward: Unit vectors in the surface, perpendicular to the side, into the cell, shape (s, 3).
        edge: Edge of the mesh of each side, shape (s,).
        count: Number of cells at each edge.
    """

    def __init__(self, points: Array, blocks: Sequence[CellsOfOneType]) -> None:
        """Find the edges.

        Args:
            points: Coordinates, shape (n, 3).
            blocks: Cells of all types, all of one order.
        """
        owner, nodes, cells, before = [], [], 0, 0
        for block in blocks:
            m, k = block.cells.shape
            local = np.array(_EDGES[block.cell])[:, : 2 if k <= 4 else 3]
            owner.append(cells + np.repeat(np.arange(m), len(local)))
            first = before + k * np.arange(m)
            nodes.append((first[:, np.newaxis, np.newaxis] + local).reshape(-1, local.shape[1]))
            cells, before = cells + m, before + m * k
        self.owner, self.nodes = np.concatenate(owner), np.concatenate(nodes)
        self.points = np.concatenate([block.cells.ravel() for block in blocks])
        self.normals = np.concatenate([block.normals.reshape(-1, 3) for block in blocks])
        self.directed = self.points[self.nodes[:, :2]]
        along = points[self.directed[:, 1]] - points[self.directed[:, 0]]
        inward = np.cross(self.normals[self.nodes[:, :2]].sum(axis=1), along)
        self.inward = inward / np.linalg.norm(inward, axis=1, keepdims=True)
        _, edge, self.count = np.unique(
            np.sort(self.directed, axis=1), axis=0, return_inverse=True, return_counts=True
        )
        self.edge = edge.ravel()

    def refuse_overlaps(self) -> None:
        """Raise ``ValueError`` if two cells at an edge overlap.

        A surface cannot fold back onto itself; a mesh with an inverted cell does.
        """
        order = np.argsort(self.edge, kind="stable")
        # at a branch, too, those that lie on each other are seen in one of these steps
        for step in range(1, int(self.count.max())):
            pairs = np.stack([order[:-step], order[step:]], axis=1)
            pairs = pairs[self.edge[pairs[:, 0]] == self.edge[pairs[:, 1]]]
            folded = pairs[self._cosine(pairs) < -_FLAT]
            if len(folded):
                a, b = self.owner[folded[0]]
                p, q = self.directed[folded[0, 0]]
                raise ValueError(
                    f"cells {a} and {b} lie on top of each other beside their edge from point {p} "
                    f"to {q}: the surface folds back there, or one of them is turned over"
                )

    def check_curve(self, name: str, curve: Indices) -> None:
        """Raise ``ValueError`` if a curve (e, 2 or 3) is empty or not made of edges of cells."""
        k = self.nodes.shape[1]
        if curve.ndim != 2 or curve.shape[1] != k or not len(curve):
            raise ValueError(
                f"curve {name!r} must be edges of {k} points each, shape (e, {k}), got "
                f"{curve.shape}"
            )
        sides = self.points[self.nodes]
        both = np.concatenate([sides, curve])
        both[:, :2] = np.sort(both[:, :2], axis=1)
        _, number = np.unique(both, axis=0, return_inverse=True)
        number = number.ravel()
        alone = np.flatnonzero(~np.isin(number[len(sides) :], number[: len(sides)]))
        if len(alone):
            raise ValueError(
                f"edge {alone[0]} of curve {name!r}, points {curve[alone[0]]}, is no edge of a cell"
            )

    def first_cell(self, curve: Indices) -> Indices:
        """Cell of the lowest number at each edge of a curve (e, 2 or 3), shape (e,)."""
        count = int(self.points.max()) + 1
        own, sought = (
            count * ends.min(axis=1) + ends.max(axis=1) for ends in (self.directed, curve[:, :2])
        )
        known, first = np.unique(own, return_index=True)  # sides ascend with their cells
        return np.asarray(self.owner[first[np.searchsorted(known, sought)]])

    def smooth_pairs(self, kink_angle: float) -> Indices:
        """Pairs of sides with an angle of at most ``kink_angle``, rad, shape (p, 2).

        Where more than two cells meet, the straightest pairs continue through the branch.

        Raises:
            ValueError: The normals of such a pair point to opposite sides.
        """
        order = np.argsort(self.edge, kind="stable")
        first = np.searchsorted(self.edge[order], np.arange(len(self.count)))
        two = first[self.count == 2]
        pairs = np.stack([order[two], order[two + 1]], axis=1)
        pairs = pairs[self._cosine(pairs) >= cos(kink_angle)]
        branches = [
            self._through(order[first[e] : first[e] + self.count[e]], kink_angle)
            for e in np.flatnonzero(self.count > 2)
        ]
        pairs = np.concatenate([pairs, *branches])
        same = self.directed[pairs[:, 0], 0] == self.directed[pairs[:, 1], 0]
        if same.any():
            a, b = self.owner[pairs[same][0]]
            raise ValueError(
                f"the normals of the neighbouring cells {a} and {b} point to opposite sides of the "
                "surface: turn one of them round (in gmsh: Reverse Surface)"
            )
        return np.asarray(pairs)

    def _through(self, sides: Indices, kink_angle: float) -> Indices:
        """Pairs among the sides of one edge, the straightest first, each side once."""
        i, j = np.triu_indices(len(sides), 1)
        pairs = np.stack([sides[i], sides[j]], axis=1)
        cosine = self._cosine(pairs)
        found: list[Indices] = []
        for k in np.argsort(-cosine, kind="stable"):
            if cosine[k] >= cos(kink_angle) and not np.isin(pairs[k], found).any():
                found.append(pairs[k])
        return np.array(found, dtype=np.int64).reshape(-1, 2)

    def _cosine(self, pairs: Indices) -> Array:
        """Cosine of the angle of the surface between the sides."""
        return np.asarray(
            -np.einsum("pj,pj->p", self.inward[pairs[:, 0]], self.inward[pairs[:, 1]])
        )


def smooth_patches(points: Array, blocks: Sequence[CellsOfOneType], kink_angle: float) -> Patches:
    """Separate nodes on both sides of a kink, for cells that branch off, and for each cell type.

    Args:
        points: Coordinates, shape (n, 3).
        blocks: Cells of all types, all of one order.
        kink_angle: Largest angle between neighbouring cells of a smooth surface, rad.

    Raises:
        ValueError: The sides of smooth neighbours do not agree; the surface has a sharp tip.
    """
    edges = Edges(points, blocks)
    a, b = edges.smooth_pairs(kink_angle).T
    # the ends of a neighbour come the other way round
    turned = edges.nodes[b][:, [1, 0, *range(2, edges.nodes.shape[1])]]
    size = len(edges.points)
    links = (np.ones(turned.size), (edges.nodes[a].ravel(), turned.ravel()))
    _, side = connected_components(sp.coo_matrix(links, shape=(size, size)), directed=False)
    directors = _means(points, edges, side, kink_angle)
    _, at = np.unique(side, return_index=True)
    point_of_side, sides = np.unique(edges.points[at], return_counts=True)
    sizes = [block.cells.size for block in blocks]
    _, first, label = np.unique(
        len(blocks) * side + np.repeat(np.arange(len(blocks)), sizes),
        return_index=True,
        return_inverse=True,
    )
    # nodes in the order in which cells have them
    order = np.argsort(first)
    first, rank = first[order], np.argsort(order)
    number = _numbered(edges.points[first], len(points))
    nodes = np.split(number[rank[label.ravel()]], np.cumsum(sizes)[:-1])
    masters, mean = np.empty(len(first), dtype=np.int64), np.empty((len(first), 3))
    masters[number], mean[number] = edges.points[first], directors[side[first]]
    return Patches(
        tuple(own.reshape(block.cells.shape) for own, block in zip(nodes, blocks, strict=True)),
        masters,
        mean,
        point_of_side[sides > 1],
    )


def _numbered(point_of: Indices, count: int) -> Indices:
    """Number of each node: that of the point for its first node."""
    order = np.argsort(point_of, kind="stable")
    leads = np.append(True, np.diff(point_of[order]) > 0)
    number = np.empty(len(point_of), dtype=np.int64)
    number[order[leads]] = point_of[order[leads]]
    number[order[~leads]] = np.arange(count, len(point_of))
    return number


def _means(points: Array, edges: Edges, side: Indices, kink_angle: float) -> Array:
    """Mean normal of each smooth side of a point, shape (S, 3)."""
    total = np.zeros((int(side.max()) + 1, 3))
    np.add.at(total, side, edges.normals)
    size = np.linalg.norm(total, axis=1, keepdims=True)
    mean = np.divide(total, size, out=np.zeros_like(total), where=size > 0)
    cosine = np.einsum("cj,cj->c", edges.normals, mean[side])
    if cosine.min() < min(cos(kink_angle), 0.99) - 1e-12:
        position = points[edges.points[cosine.argmin()]]
        raise ValueError(
            f"the surface has a tip at {position}, where normals are "
            f"{degrees(np.arccos(cosine.min())):.0f}° away from their mean though neighbours "
            f"differ by less than the kink angle of {degrees(kink_angle):.0f}°"
        )
    return np.asarray(mean)
