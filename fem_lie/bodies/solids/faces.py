"""Faces, curves and points of a solid, and their nodes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import basix
import dolfinx
import numpy as np
from dolfinx import fem

from fem_lie._arrays import Array, Indices
from fem_lie.mesh.shapes import FaceRule, nodes_of

FACETS = {"tetrahedron": "triangle", "hexahedron": "quadrilateral"}
"""Cell type of the facets of each cell type."""

_DRAWN = {
    ("triangle", 1): ((0, 1, 2),),
    ("quadrilateral", 1): ((0, 1, 3, 2),),
    ("triangle", 2): ((0, 5, 4), (5, 1, 3), (4, 3, 2), (3, 4, 5)),
    ("quadrilateral", 2): ((0, 4, 8, 5), (4, 1, 6, 8), (5, 8, 7, 2), (8, 6, 3, 7)),
}
"""Plane pieces of a facet, by indices of its nodes: corners in cyclic order."""


@dataclass(frozen=True, eq=False)
class Faces:
    """Some facets of a mesh, as surface cells.

    Attributes:
        nodes: Nodes of each facet, in the order of Lagrange elements, shape (f, k).
        outward: 1 or −1 where ``x,₁ × x,₂`` points out of the body or into it; 0 between two cells.
        cell: ``"triangle"`` or ``"quadrilateral"``.
        degree: Degree of the interpolation.
    """

    nodes: Indices
    outward: Array
    cell: str
    degree: int

    @property
    def rule(self) -> FaceRule:
        """Quadrature rule on a facet."""
        return FaceRule.of(self.cell, self.degree)

    def consistent_areas(self, x: Array) -> Array:
        """Consistent areas of the nodes of each facet at positions ``x`` (n, 3), shape (f, k)."""
        rule = self.rule
        areas = np.linalg.norm(rule.normals(x, self.nodes), axis=2)
        return np.einsum("gk,fg->fk", rule.values, areas)

    def drawn(self) -> Indices:
        """Corners of plane pieces of the facets, oriented outwards, shape (any, 3 or 4)."""
        pieces = self.nodes[:, np.array(_DRAWN[self.cell, self.degree])]
        pieces = np.where(self.outward[:, None, None] < 0, pieces[:, :, ::-1], pieces)
        return np.asarray(pieces.reshape(-1, pieces.shape[2]))


def faces_of(V: fem.FunctionSpace, facets: Indices, degree: int) -> Faces:
    """Facets of the mesh of a Lagrange space, with its nodes."""
    mesh = V.mesh
    cell, x = mesh.topology.cell_name(), V.tabulate_dof_coordinates()
    to_cells, to_facets = connected(mesh)
    local, outer = _facet_nodes(cell, degree), np.empty(len(facets))
    nodes = np.empty((len(facets), local.shape[1]), dtype=np.int64)
    for row, facet in enumerate(facets):
        owners = to_cells.links(facet)
        here = V.dofmap.list[owners[0]]
        nodes[row] = here[local[np.flatnonzero(to_facets.links(owners[0]) == facet)[0]]]
        corner = x[nodes[row, :3]]
        normal = np.cross(corner[1] - corner[0], corner[2] - corner[0])
        out = np.sign(normal @ (x[nodes[row]].mean(axis=0) - x[here].mean(axis=0)))
        outer[row] = out if len(owners) == 1 else 0.0
    return Faces(nodes, outer, FACETS[cell], degree)


def connected(mesh: dolfinx.mesh.Mesh) -> tuple[Any, Any]:
    """Connectivity from facets to cells, and from cells to facets."""
    mesh.topology.create_entities(2)
    mesh.topology.create_connectivity(2, 3)
    mesh.topology.create_connectivity(3, 2)
    return mesh.topology.connectivity(2, 3), mesh.topology.connectivity(3, 2)


def nodes_on(V: fem.FunctionSpace, dim: int, entities: Indices) -> Indices:
    """Nodes of mesh entities and their boundaries."""
    V.mesh.topology.create_entities(dim)
    V.mesh.topology.create_connectivity(dim, 3)
    V.mesh.topology.create_connectivity(3, dim)
    found = fem.locate_dofs_topological(V, dim, entities.astype(np.int32))
    return np.unique(found).astype(np.int64)


def _facet_nodes(cell: str, degree: int) -> Indices:
    """Nodes of each facet of the reference cell, in the order of Lagrange elements, (f, k)."""
    kind = basix.CellType[cell]
    corners = np.asarray(basix.geometry(kind), dtype=np.float64)
    positions = nodes_of(cell, degree)
    on_facet = nodes_of(FACETS[cell], degree)
    found = []
    for vertices in basix.topology(kind)[2]:
        three: Array = corners[vertices[:3]]
        expected = three[0] + on_facet @ (three[1:] - three[0])
        gaps = np.abs(positions[np.newaxis] - expected[:, np.newaxis]).max(axis=2)
        found.append(gaps.argmin(axis=1))
    return np.array(found)
