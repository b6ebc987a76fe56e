"""Integrals over the cells of a mesh that fills a volume."""

from __future__ import annotations

from dataclasses import dataclass

import dolfinx
import numpy as np

from fem_lie import _compat
from fem_lie._arrays import Array
from fem_lie.mesh.shapes import nodes_of, rule, tabulated

_GEOMETRY = {4: 1, 10: 2, 8: 1, 27: 2}
"""Degree of a cell's geometry by its number of nodes."""


@dataclass(frozen=True, eq=False)
class VolumeRule:
    """Points of integration in all cells.

    Attributes:
        values: Shape functions of the nodes, shape (g, k).
        jacobian: Determinant of the cell's map, of one sign unless it is inside out, (m, g).
        volumes: Weight times volume, shape (m, g).
        places: Unloaded, shape (m, g, 3).
        mean_slopes: Integrals of the shape functions' gradients, shape (m, k, 3).
    """

    values: Array
    jacobian: Array
    volumes: Array
    places: Array
    mean_slopes: Array

    @classmethod
    def of(cls, mesh: dolfinx.mesh.Mesh, degree: int, *, checked: bool = False) -> VolumeRule:
        """Exact for products of two shape functions on cells with plane faces.

        Args:
            mesh: Of hexahedra or tetrahedra.
            degree: Of the shape functions.
            checked: Take the nodes of a cell, too, with weight one.
        """
        cell, nodes = mesh.topology.cell_name(), _compat.geometry_dofmap(mesh)
        points, weights = rule(cell, 2 * degree + 1)
        if checked:
            corners = nodes_of(cell, degree)
            points, weights = np.concatenate([points, corners]), np.ones(len(points) + len(corners))
        own, shape = (tabulated(cell, p, points) for p in (degree, _GEOMETRY[nodes.shape[1]]))
        x = mesh.geometry.x[nodes]
        tangents = np.einsum("bgk,mka->mgab", shape[1:], x)
        jacobian = np.linalg.det(tangents)
        volumes, mean = weights * np.abs(jacobian), np.zeros((len(x), own.shape[2], 3))
        if not checked:
            inverse = np.linalg.inv(tangents)
            mean = np.einsum("mg,mgba,bgk->mka", volumes, inverse, own[1:], optimize=True)
        return cls(own[0], jacobian, volumes, np.einsum("gk,mka->mga", shape[0], x), mean)
