"""Shape functions at points of integration of surface cells, for the sums of loads on shells."""

from __future__ import annotations

from dataclasses import dataclass

import basix
import numpy as np

from fem_lie._jit import Array, Indices

# exact for hydrostatic pressure: two slopes, a place and a shape function
_DEGREES = {
    ("triangle", 1): 2,
    ("quadrilateral", 1): 3,
    ("triangle", 2): 6,
    ("quadrilateral", 2): 7,
}


@dataclass(frozen=True, eq=False)
class FaceRule:
    """Points of integration of a reference cell.

    Attributes:
        values: Shape functions, shape (g, k).
        slopes: Their derivatives in the two reference coordinates, shape (2, g, k).
        weights: Shape (g,).
    """

    values: Array
    slopes: Array
    weights: Array

    @classmethod
    def of(cls, cell: str, degree: int) -> FaceRule:
        """For the Lagrange cells of :class:`~fem_lie.surface.SurfaceMesh`."""
        kind = basix.CellType[cell]
        element = basix.create_element(
            basix.ElementFamily.P, kind, degree, basix.LagrangeVariant.gll_warped
        )
        rule = basix.make_quadrature(kind, _DEGREES[cell, degree])
        points, weights = (np.asarray(part, dtype=np.float64) for part in rule)
        table = np.asarray(element.tabulate(1, points), dtype=np.float64)[..., 0]
        parts = table[0], table[1:], weights
        return cls(*(np.ascontiguousarray(part) for part in parts))

    def places(self, x: Array, cells: Indices) -> Array:
        """Points of integration of cells with nodes at ``x`` (n, 3), shape (m, g, 3)."""
        return np.einsum("gk,mkj->mgj", self.values, x[cells])

    def normals(self, x: Array, cells: Indices) -> Array:
        """Weight times ``x,₁ × x,₂`` there, shape (m, g, 3): vectors of area."""
        g1, g2 = np.einsum("agk,mkj->amgj", self.slopes, x[cells])
        return np.asarray(self.weights[:, np.newaxis] * np.cross(g1, g2))
