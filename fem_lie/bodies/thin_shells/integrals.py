"""Quadrature over cells of a thin shell and along its edges."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.mesh.bicubic import hermite
from fem_lie.mesh.bicubic.patch_coupling import Edge

_POINTS = 5
"""Gauss points per direction: for products of cubics on a bicubic surface."""


class Quadrature(NamedTuple):
    """Quadrature points on cells in their initial configuration.

    Attributes:
        cells: Indices of the cells, shape (c,).
        values: Shape functions at the points, shape (c, g, 16).
        positions: Positions of the points, shape (c, g, 3).
        weights: Areas or lengths, shape (c, g).
    """

    cells: Indices
    values: Array
    positions: Array
    weights: Array


Table = Callable[[Array], Array]
"""Values and derivatives along ξ and η at points (g, 2), shape (g, 3 or more, 16)."""


def over_cells(cells: Indices, q: Array, shapes: Table) -> Quadrature:
    """Quadrature over cells with vectors ``q`` (c, 16, 3) and shape functions ``shapes``."""
    x, w = hermite.gauss(_POINTS)
    table = shapes(hermite.products(x, x))
    r1, r2 = (np.einsum("ga,caj->cgj", table[:, k], q) for k in (hermite.ALONG, hermite.ACROSS))
    areas = np.linalg.norm(np.cross(r1, r2), axis=-1) * np.outer(w, w).ravel()
    return _at(cells, np.tile(table[:, hermite.VALUE], (len(q), 1, 1)), q, areas)


def along_edge(edge: Edge, q: Array, shapes: Table) -> Quadrature:
    """Quadrature along an edge of cells with vectors ``q`` (c, 16, 3)."""
    x, w = hermite.gauss(_POINTS)
    points = np.full((_POINTS, 2), float(edge.side))
    points[:, 0 if edge.along == 0 else 1] = x
    table = shapes(points)
    slopes = np.einsum("ga,caj->cgj", table[:, hermite.ALONG + edge.along], q)
    lengths = np.linalg.norm(slopes, axis=-1) * w
    return _at(edge.cells, np.tile(table[:, hermite.VALUE], (len(q), 1, 1)), q, lengths)


def _at(cells: Indices, values: Array, q: Array, weights: Array) -> Quadrature:
    return Quadrature(cells, values, np.einsum("cga,caj->cgj", values, q), weights)
