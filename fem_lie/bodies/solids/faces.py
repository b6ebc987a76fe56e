"""Faces, curves and points of a solid: nodes, and supports."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import Any

import basix
import dolfinx
import numpy as np
import numpy.typing as npt
from dolfinx import fem

from fem_lie._arrays import Array, Indices, direction
from fem_lie.bodies.body import Body, Point
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


_SAME = 1e-9  # sine, as of directions that are meant to be equal


class SupportedSolid(Body):
    """Body whose nodes have positions only."""

    @abstractmethod
    def nodes(self, where: str) -> Indices:
        """Numbers of the nodes of a named face, curve, point or group of cells."""

    def clamp(self, name: str) -> list[Point]:
        """Hold all nodes of a named face, curve, point or group of cells.

        Args:
            name: Name of a face, curve, point or group of cells.

        Returns:
            Held points, for :meth:`fem_lie.Result.reaction`.

        Raises:
            ValueError: There is no such set; the message lists what exists.
        """
        self.held[self.nodes(name), :3] = True
        return self.points(name)

    def roller(self, name: str, normal: npt.ArrayLike) -> list[Point]:
        """Hold displacements along a direction fixed in space, as on a plane of symmetry.

        Nodal axes are rotated so that one is that direction, and do not rotate any more.
        Constraints of earlier calls remain.

        Args:
            name: A named face, curve, point or group of cells.
            normal: The direction, global components.

        Returns:
            Held points, for :meth:`fem_lie.Result.reaction`.

        Raises:
            ValueError: There is no such set, or the direction is zero.
        """
        n = direction(normal, f"the direction of roller {name!r}")
        for node in self.nodes(name):
            self._hold_along(int(node), n)
        return self.points(name)

    def _hold_along(self, node: int, along: Array) -> None:
        held, axes = self.held[node, :3], self.frames[node, 1:]
        before = axes[held]
        rest = along - before.T @ (before @ along)
        size = np.linalg.norm(rest)
        if size <= _SAME:
            return
        rest /= size
        free = axes[~held]
        match = np.abs(free @ rest)
        if match.max() < 1.0 - _SAME:
            free = _perpendicular(np.vstack([before, rest]))
            known = np.vstack([before, rest])
            turned = np.vstack([known, free])
            turned[2] *= np.sign(np.linalg.det(turned))
            velocity = axes.T @ self.velocities[node, :3]
            self.frames[node, 1:] = turned
            self.velocities[node, :3] = turned @ velocity
            held[:] = np.arange(3) < len(known)
            return
        held[np.flatnonzero(~held)[match.argmax()]] = True


def _perpendicular(known: Array) -> Array:
    """Unit vectors perpendicular to ``known`` (k, 3), which is orthonormal, shape (3 − k, 3)."""
    return np.asarray(np.linalg.svd(known)[2][len(known) :])
