"""Interpolation of the plate of places and three slopes: surfaces between cubic edges.

At each corner, (0, 0), (1, 0), (0, 1), (1, 1), are the place, its derivatives along ξ and η, and
the slope across the thickness. Edges are cubics of places and slopes, what is between them is
blended linearly (S. A. Coons 1967; the polynomials are those of A. Adini & R. W. Clough 1960), so
that neighbours fit. The slope across the thickness is bilinear.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array

VALUE, ALONG, ACROSS = range(3)
"""Derivatives in a table: none, ξ, η."""

_H = np.array([[1.0, 0, -3, 2], [0, 1, -2, 1], [0, 0, 3, -2], [0, 0, -1, 1]])
_L = np.array([[1.0, -1, 0, 0], [0, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 0]])
"""By powers: place and slope of the first end, then of the second; cubics, and lines."""


def table(points: Array) -> Array:
    """Values and derivatives of the place at points (g, 2), shape (g, 3, 16)."""
    found = np.zeros((len(points), 3, 4, 4))
    for k, orders in enumerate(((0, 0), (1, 0), (0, 1))):
        (hx, lx), (hy, ly) = (
            (_at(_H, points[:, j], orders[j]), _at(_L, points[:, j], orders[j])) for j in range(2)
        )
        for corner in range(4):
            a, b = 2 * (corner % 2), 2 * (corner // 2)
            found[:, k, corner, 0] = hx[a] * ly[b] + lx[a] * hy[b] - lx[a] * ly[b]
            found[:, k, corner, 1] = hx[a + 1] * ly[b]
            found[:, k, corner, 2] = lx[a] * hy[b + 1]
    return found.reshape(-1, 3, 16)


def directors(points: Array) -> Array:
    """The same of the slope across the thickness."""
    found = np.zeros((len(points), 3, 4, 4))
    for k, orders in enumerate(((0, 0), (1, 0), (0, 1))):
        lx, ly = (_at(_L, points[:, j], orders[j]) for j in range(2))
        for corner in range(4):
            found[:, k, corner, 3] = lx[2 * (corner % 2)] * ly[2 * (corner // 2)]
    return found.reshape(-1, 3, 16)


def _at(powers: Array, x: Array, order: int) -> Array:
    """Derivatives of polynomials at places (g,), shape (4, g)."""
    return np.stack([np.polynomial.Polynomial(c).deriv(order)(x) for c in powers])
