"""What models of bodies on surface meshes share: named sets, edges, areas, products of shapes."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.bodies.model import BodyModel
from fem_lie.mesh.shapes import LineQuadrature, rule, tabulated
from fem_lie.mesh.surfaces import Surface, SurfaceMesh


class SurfaceModel(BodyModel):
    """Model of a body on a surface mesh, whatever types of cells it has.

    Attributes:
        mesh: Surface mesh; its points are the first nodes of the body.
    """

    dimension = 2
    mesh: Surface

    def nodes(self, where: str) -> Indices:
        """Numbers of the nodes of a named curve, group of cells or group of points.

        Where the surface has a kink or branches, one node stands for all at a position: the others
        are rigidly attached to it.

        Args:
            where: Name of the point, curve, face or group.
        """
        return self.mesh.nodes(where)

    def edge_quadrature(self, name: str) -> LineQuadrature:
        """Integration along the edges of a named curve.

        Args:
            name: Name of the curve.

        Raises:
            ValueError: There is no such curve; the message lists those that exist.
        """
        edges = self.mesh.curve(name)
        x = self.frames[edges, 0]
        # straight edges, and parabolas through three points
        s, w = np.polynomial.legendre.leggauss(3)
        N = np.array([0.5 * (1 - s), 0.5 * (1 + s)])
        dN = np.array([-0.5 + 0 * s, 0.5 + 0 * s])
        if edges.shape[1] == 3:
            N = np.array([0.5 * s * (s - 1), 0.5 * s * (s + 1), 1 - s * s])
            dN = np.array([s - 0.5, s + 0.5, -2 * s])
        speed = np.linalg.norm(np.einsum("kg,ekj->egj", dN, x), axis=2)
        positions = np.einsum("kg,ekj->egj", N, x)
        return LineQuadrature(edges, positions, np.einsum("g,kg,eg->egk", w, N, speed))

    def cells_of(self, group: str | None = None) -> Indices:
        """Cells of a named group (default: all cells).

        Args:
            group: Name of the group; default: all.

        Raises:
            ValueError: There is no such group; the message lists those that exist.
        """
        return np.arange(len(self.mesh.centres)) if group is None else self.mesh.group(group)


class CellsOnSurface(SurfaceModel):
    """Model of a body on a surface mesh of one type of cells.

    Attributes:
        connectivity: Nodes of each cell, shape (m, k).
        density: Mass matrix per area in (position, director) of each cell, shape (m, 2, 2).
    """

    mesh: SurfaceMesh
    connectivity: Indices
    density: Array

    @property
    def divisible_cells(self) -> Indices | None:
        """Nodes of each cell."""
        return self.connectivity

    def areas(self) -> Array:
        """Consistent weights in area of the nodes of each cell, shape (m, k), m²."""
        shapes, weights = self._measure()
        return np.einsum("gk,mg->mk", shapes, weights)

    @property
    def mass(self) -> float:
        """Total mass, kg."""
        return float(self.areas().sum(axis=1) @ self.density[:, 0, 0])

    def element_inertia(self) -> Array:
        """Consistent mass matrix in (x, d₁, d₂, d₃) of each cell, shape (m, k, 4, k, 4)."""
        density = np.zeros((len(self.density), 4, 4))
        density[:, ::3, ::3] = self.density
        return self._integrated(density)

    def _integrated(self, density: Array) -> Array:
        """Products of shape functions times densities (m, 4, 4), shape (m, k, 4, k, 4)."""
        shapes, weights = self._measure()
        products = np.einsum("gi,gj,mg->mij", shapes, shapes, weights)
        return np.einsum("mij,mab->miajb", products, density)

    def _measure(self) -> tuple[Array, Array]:
        """Shape functions (g, k), and quadrature weights times area (m, g)."""
        cell, degree = self.mesh.cell, self.mesh.degree
        points, w = rule(cell, 2 * degree + 2)
        table = tabulated(cell, degree, points)
        x = self.frames[self.mesh.cells, 0]
        g1, g2 = np.einsum("agk,mkj->amgj", table[1:], x)
        return table[0], w * np.linalg.norm(np.cross(g1, g2), axis=-1)
