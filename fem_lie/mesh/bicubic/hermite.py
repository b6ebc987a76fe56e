"""Bicubic Hermite interpolation on the unit square.

The surface on a cell is ``r(ξ, η) = Σ Nₐ(ξ, η) qₐ`` with sixteen vectors: at each corner, (0, 0),
(1, 0), (0, 1), (1, 1), the position, its derivatives along ξ and η, and the mixed derivative.
"""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array

VALUE, ALONG, ACROSS, BENT_ALONG, BENT_ACROSS, TWISTED = range(6)
"""Indices of a table: value, and derivatives in ξ, η, ξξ, ηη, ξη."""

_ORDERS = ((0, 0), (1, 0), (0, 1), (2, 0), (0, 2), (1, 1))
_CUBICS = np.array([[1.0, 0, -3, 2], [0, 1, -2, 1], [0, 0, 3, -2], [0, 0, -1, 1]])
"""Coefficients by powers: of value and derivative at the first end, then at the second."""


def table(points: Array) -> Array:
    """Values and derivatives of the sixteen functions at points (g, 2), shape (g, 6, 16).

    Args:
        points: Points in reference coordinates, shape (g, 2).
    """
    found = np.empty((len(points), 6, 16))
    for k, (first, second) in enumerate(_ORDERS):
        along = _cubics(points[:, 0], first).reshape(-1, 2, 2)
        across = _cubics(points[:, 1], second).reshape(-1, 2, 2)
        # corners: ξ runs first; at each of them value, ξ, η, ξη
        found[:, k] = np.einsum("gai,gbj->gbaji", along, across).reshape(-1, 16)
    return found


def _cubics(x: Array, order: int) -> Array:
    """Derivatives of the four cubics at points (g,), shape (g, 4)."""
    found = [np.polynomial.Polynomial(c).deriv(order)(x) for c in _CUBICS]
    return np.stack(found, axis=1)


def gauss(count: int) -> tuple[Array, Array]:
    """Points and weights of the Gauss rule on (0, 1)."""
    x, w = np.polynomial.legendre.leggauss(count)
    return 0.5 * (1.0 + x), 0.5 * w


def lobatto() -> Array:
    """Points of the three-point Lobatto rule on (0, 1)."""
    return np.array([0.0, 0.5, 1.0])


def products(first: Array, second: Array) -> Array:
    """All pairs of points, the second index first, shape (a b, 2)."""
    return np.stack([a.ravel() for a in np.meshgrid(first, second, indexing="ij")], axis=1)


def lagrange(nodes: Array, at: Array) -> Array:
    """Values at points (g,) of the Lagrange polynomials of the nodes, shape (g, k)."""
    found = np.ones((len(at), len(nodes)))
    for k, node in enumerate(nodes):
        for other in np.delete(nodes, k):
            found[:, k] *= (at - other) / (node - other)
    return found
