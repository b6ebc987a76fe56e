"""Surface cells: normals, orientation, folded cells, quadrature."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import basix
import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import breadth_first_order, connected_components

from fem_lie._arrays import Array, Flags, Indices


class LineQuadrature(NamedTuple):
    """Integration along cells of lines or edges of surfaces, in the unloaded configuration.

    Attributes:
        nodes: Nodes of each cell, shape (m, k).
        positions: Positions of the integration points, shape (m, g, 3).
        shares: Weights, lengths, times the shape functions of the nodes, shape (m, g, k).
        on_directors: The same for the three directors, or position gradients, of each node, shape
            (m, g, k, 3); none: positions depend on those of the nodes alone.
    """

    nodes: Indices
    positions: Array
    shares: Array
    on_directors: Array | None = None

    @property
    def lengths(self) -> Array:
        """Length that each node of a cell carries, shape (m, k)."""
        return np.asarray(self.shares.sum(axis=1))


_CORNERS_AROUND = {
    "triangle": [(0, 1), (1, 2), (2, 0)],
    "quadrilateral": [(0, 1), (1, 3), (3, 2), (2, 0)],
}

"""Sides in cyclic order around a cell."""


_REVERSED = {"triangle": [0, 2, 1, 3, 5, 4], "quadrilateral": [0, 2, 1, 3, 5, 4, 7, 6, 8]}
"""Nodes of a cell that looks to the other side, those of first order first."""


def turned_round(cells: Indices, cell: str) -> Flags:
    """Mask of the cells to reverse; the first of each piece is kept; shape (m,).

    Neighbours with the same orientation run along their common edge in opposite directions. Edges
    with other than two cells are ignored. On a surface with one side, such as a Möbius strip, no
    choice is consistent; later checks refuse it.

    Args:
        cells: Points of each cell in DOLFINx's order, shape (m, k).
        cell: ``"triangle"`` or ``"quadrilateral"``.
    """
    around = np.array(_CORNERS_AROUND[cell])
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
    """Cells of first or second order, shape (m, k), with the chosen ones reversed."""
    swapped = _REVERSED[cell][: cells.shape[1]]
    return np.where(chosen[:, np.newaxis], cells[:, swapped], cells)


# exact for hydrostatic pressure: two slopes, a position and a shape function
_DEGREES = {
    ("triangle", 1): 2,
    ("quadrilateral", 1): 3,
    ("triangle", 2): 6,
    ("quadrilateral", 2): 7,
}


def tabulated(cell: str, degree: int, points: Array) -> Array:
    """Shape functions at points of the reference cell, and their derivatives, shape (3, p, k).

    Args:
        cell: ``"triangle"`` or ``"quadrilateral"``.
        degree: Degree of its edges.
        points: Points, shape (p, 2).
    """
    return np.asarray(_element(cell, degree).tabulate(1, points), dtype=np.float64)[..., 0]


def nodes_of(cell: str, degree: int) -> Array:
    """Nodes of the reference cell, shape (k, 2)."""
    return np.asarray(_element(cell, degree).points, dtype=np.float64)


def rule(cell: str, degree: int) -> tuple[Array, Array]:
    """Quadrature points of the reference cell, shape (g, 2), and their weights (g,)."""
    points, weights = basix.make_quadrature(basix.CellType[cell], degree)
    return np.asarray(points, dtype=np.float64), np.asarray(weights, dtype=np.float64)


def _element(cell: str, degree: int) -> basix.finite_element.FiniteElement:
    return basix.create_element(
        basix.ElementFamily.P, basix.CellType[cell], degree, basix.LagrangeVariant.gll_warped
    )


@dataclass(frozen=True, eq=False)
class FaceRule:
    """Quadrature rule of a reference cell.

    Attributes:
        values: Shape functions, shape (g, k).
        slopes: Their derivatives in the two reference coordinates, shape (2, g, k).
        weights: Quadrature weights, shape (g,).
    """

    values: Array
    slopes: Array
    weights: Array

    @classmethod
    def of(cls, cell: str, degree: int) -> FaceRule:
        """Rule for the Lagrange cells of :class:`~fem_lie.mesh.surfaces.SurfaceMesh`."""
        points, weights = rule(cell, _DEGREES[cell, degree])
        table = tabulated(cell, degree, points)
        parts = table[0], table[1:], weights
        return cls(*(np.ascontiguousarray(part) for part in parts))

    def positions(self, x: Array, cells: Indices) -> Array:
        """Quadrature points of cells with nodes at ``x`` (n, 3), shape (m, g, 3)."""
        return np.einsum("gk,mkj->mgj", self.values, x[cells])

    def normals(self, x: Array, cells: Indices) -> Array:
        """Area vectors: weight times ``x,₁ × x,₂`` at the points, shape (m, g, 3)."""
        g1, g2 = np.einsum("agk,mkj->amgj", self.slopes, x[cells])
        return np.asarray(self.weights[:, np.newaxis] * np.cross(g1, g2))


DEGREES = {"triangle": {3: 1, 6: 2}, "quadrilateral": {4: 1, 9: 2}}
"""Degree of each cell type by its number of points."""

_AROUND = [0, 1, 3, 2]  # corners given one after the other, in DOLFINx's order
_CROSSED = [0, 2, 3, 1]
_NO_ANGLE = 1e-9  # sine, at a corner
_FOLDED = 1e-6  # cosine; cells of a smooth surface are far from it


def cell_normals(points: Array, cells: Indices, cell: str) -> Array:
    """Unit normals of each cell's interpolation at its nodes, shape (m, k, 3).

    Args:
        points: Coordinates, shape (n, 3).
        cells: Points of each cell in DOLFINx's order, shape (m, k).
        cell: ``"triangle"`` or ``"quadrilateral"``.

    Raises:
        ValueError: A cell has no area at a corner, or folds over: it crosses itself, has a
            re-entrant corner, or nodes on its edges that are far off.
    """
    k = cells.shape[1]
    nodes, inside = _nodes_inside(cell, DEGREES[cell][k])
    normal, sine = _normals(points, cells, cell, nodes)
    size = np.linalg.norm(normal, axis=-1)
    bad = np.flatnonzero((sine <= _NO_ANGLE).any(axis=1))
    if len(bad):
        raise ValueError(f"cell {bad[0]} (points {cells[bad[0]]}) has no area at a corner")
    within = _normals(points, cells, cell, inside)[0]
    _refuse_folded(points, cells, cell, np.concatenate([normal, within], axis=1))
    return np.asarray(normal / size[..., np.newaxis])


def _nodes_inside(cell: str, degree: int) -> tuple[Array, Array]:
    """Nodes of the reference cell, and points inside."""
    return nodes_of(cell, degree), rule(cell, 2 * degree)[0]


def _normals(points: Array, cells: Indices, cell: str, positions: Array) -> tuple[Array, Array]:
    """``x,₁ × x,₂`` at points of the reference cell, (m, p, 3), and the sine of the two, (m, p)."""
    slopes = tabulated(cell, DEGREES[cell][cells.shape[1]], positions)[1:]
    # about a point of the cell: far from the origin differences of positions are small
    x = points[cells] - points[cells[:, :1]]
    g1, g2 = np.einsum("apk,mkj->ampj", slopes, x)
    normal = np.cross(g1, g2)
    scale = np.linalg.norm(g1, axis=-1) * np.linalg.norm(g2, axis=-1)
    return normal, np.linalg.norm(normal, axis=-1) / np.maximum(scale, 1e-300)


def _cosines(normals: Array) -> Array:
    """Cosine between each normal and their mean, shape (m, p)."""
    mean = normals.mean(axis=1, keepdims=True)
    size = np.linalg.norm(normals, axis=-1) * np.linalg.norm(mean, axis=-1)
    return np.asarray((normals * mean).sum(axis=-1) / np.maximum(size, 1e-300))


def _refuse_folded(points: Array, cells: Indices, cell: str, normals: Array) -> None:
    cosine = _cosines(normals)
    bad = np.flatnonzero((cosine <= _FOLDED).any(axis=1))
    if not len(bad):
        return
    first = bad[0]
    what = f"cell {first} (points {cells[first]})"
    if cell == "quadrilateral" and cells.shape[1] == 4:
        for order in (_AROUND, _CROSSED):
            turned = cells[first : first + 1, order]
            if (
                _cosines(_normals(points, turned, cell, _nodes_inside(cell, 1)[0])[0]) > _FOLDED
            ).all():
                raise ValueError(
                    f"{what} crosses itself like a bow tie, as {len(bad)} of {len(cells)} cells do "
                    "or nearly so: corners of a quadrilateral are expected row by row, as DOLFINx "
                    f"has them, not one after the other around it; here that is {turned[0]}"
                )
        corner = cells[first, int(cosine[first, :4].argmin())]
        raise ValueError(f"{what} has a re-entrant corner at point {corner}, {points[corner]}")
    k = cells.shape[1]
    worst = int(cosine[first].argmin())
    where = f"at point {cells[first, worst]}" if worst < k else "inside"
    raise ValueError(
        f"{what} folds over {where}: are its points in DOLFINx's order, and those on its edges "
        "near the middle of them?"
    )
