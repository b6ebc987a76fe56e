"""Closest points of many cells of any shape to positions, by Newton's method in their parameters.

Cells are curves, surfaces or volumes with parameters from 0 to 1: intervals, squares and cubes, or
simplices, prisms and pyramids. A few cells with the closest centres are tried for each position.
The parameters of a position outside all cells are those of the closest point of a cell.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import NamedTuple

import basix
import numpy as np
from scipy.spatial import cKDTree

from fem_lie._arrays import Array, Indices

_NEAR = 24  # candidate cells
_ROUNDS = 20
_DONE = 1e-14
_SAME = 9  # digits to which distances are compared

Evaluation = Callable[[Indices, Array], tuple[Array, Array]]
"""Positions (p, 3) and derivatives (p, d, 3) at parameters (p, d) of cells (p,)."""


def _box(ξ: Array) -> Array:
    return np.clip(ξ, 0.0, 1.0)


def _simplex(ξ: Array) -> Array:
    inside = np.maximum(ξ, 0.0)
    return np.asarray(inside / np.maximum(inside.sum(axis=-1, keepdims=True), 1.0))


def _prism(ξ: Array) -> Array:
    return np.concatenate([_simplex(ξ[..., :2]), _box(ξ[..., 2:])], axis=-1)


def _pyramid(ξ: Array) -> Array:
    height = _box(ξ[..., 2:])
    return np.concatenate([np.clip(ξ[..., :2], 0.0, 1.0 - height), height], axis=-1)


_INSIDE: Mapping[str, Callable[[Array], Array]] = MappingProxyType(
    {
        "interval": _box,
        "quadrilateral": _box,
        "hexahedron": _box,
        "triangle": _simplex,
        "tetrahedron": _simplex,
        "prism": _prism,
        "pyramid": _pyramid,
    }
)
"""Projection of parameters onto the reference cell."""


class Closest(NamedTuple):
    """Points of cells, one for each position.

    Attributes:
        cells: Cell of each point, shape (n,).
        at: Its parameters there, shape (n, d).
        away: Distance of the position over the size of the cell, shape (n,).
        near: The cells that were tried, the closest centres first, shape (n, k).
    """

    cells: Indices
    at: Array
    away: Array
    near: Indices


@dataclass(frozen=True, eq=False)
class Cells:
    """Cells with parameters.

    Attributes:
        shape: Name of the reference cell.
        corners: Positions of corners or nodes of the cells, for their centres and sizes, (m, k, 3).
        evaluate: Positions and derivatives in the parameters.
    """

    shape: str
    corners: Array
    evaluate: Evaluation

    def closest(self, positions: Array, directions: Array | None = None) -> Closest:
        """Closest points to positions.

        Args:
            positions: Shape (n, 3).
            directions: Directions (n, 3): of cells as close as each other, that with the normal
                along them counts, as at kinks of surfaces.
        """
        centres = self.corners.mean(axis=1)
        sizes = np.linalg.norm(np.ptp(self.corners, axis=1), axis=1)
        count = min(_NEAR, len(centres))
        _, near = cKDTree(centres).query(positions, k=count)
        near = np.asarray(near, dtype=np.int64).reshape(len(positions), count)
        ξ, x, tangents = self._solved(near.ravel(), np.repeat(positions, count, axis=0))
        off = x.reshape(*near.shape, 3) - positions[:, np.newaxis]
        away = np.linalg.norm(off, axis=2) / sizes[near]
        keys = [np.round(away, _SAME)]
        if directions is not None:
            normals = np.cross(*tangents.swapaxes(0, 1)).reshape(*near.shape, 3)
            normals /= np.linalg.norm(normals, axis=2, keepdims=True)
            keys.insert(0, -np.einsum("nki,ni->nk", normals, directions))
        best = np.lexsort(keys, axis=1)[:, 0]
        rows = np.arange(len(positions))
        at = ξ.reshape(*near.shape, -1)[rows, best]
        return Closest(near[rows, best], at, away[rows, best], near)

    def _solved(self, cells: Indices, positions: Array) -> tuple[Array, Array, Array]:
        """Parameters (p, d) of the closest points, positions and derivatives there."""
        inside = _INSIDE[self.shape]
        dimension = basix.topology(basix.CellType[self.shape])
        ξ = inside(np.full((len(cells), len(dimension) - 1), 0.3))
        for _ in range(_ROUNDS):
            x, tangents = self.evaluate(cells, ξ)
            metric = np.einsum("pai,pbi->pab", tangents, tangents)
            slope = np.einsum("pai,pi->pa", tangents, positions - x)
            moved = inside(ξ + np.linalg.solve(metric, slope[..., np.newaxis])[..., 0])
            done = np.abs(moved - ξ).max(initial=0.0) <= _DONE
            ξ = moved
            if done:
                break
        return ξ, *self.evaluate(cells, ξ)


@dataclass(frozen=True, eq=False)
class LagrangeCells:
    """Cells whose positions are interpolated between those of their nodes.

    Attributes:
        shape: Name of the reference cell.
        degree: Degree of the interpolation.
        connectivity: Nodes of each cell, shape (m, k).
        positions: Positions of the nodes, shape (n, 3).
    """

    shape: str
    degree: int
    connectivity: Indices
    positions: Array

    def shapes(self, ξ: Array) -> Array:
        """Shape functions (p, k) at parameters (p, d), and derivatives, shape (1 + d, p, k)."""
        element = basix.create_element(
            basix.ElementFamily.P,
            basix.CellType[self.shape],
            self.degree,
            basix.LagrangeVariant.gll_warped,
        )
        return np.asarray(element.tabulate(1, ξ), dtype=np.float64)[..., 0]

    @property
    def cells(self) -> Cells:
        """The cells, to look for closest points."""
        x = self.positions[self.connectivity]

        def evaluate(cells: Indices, ξ: Array) -> tuple[Array, Array]:
            table = self.shapes(ξ)
            return (
                np.einsum("pk,pki->pi", table[0], x[cells]),
                np.einsum("apk,pki->pai", table[1:], x[cells]),
            )

        return Cells(self.shape, x, evaluate)
