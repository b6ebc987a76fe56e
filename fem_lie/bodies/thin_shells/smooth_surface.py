"""Common base of thin shells and ANCF plates: smooth surfaces, twelve unknowns at a point."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from inspect import unwrap
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Flags, Indices, direction, number, text
from fem_lie.attachments.attachment import AttachmentFrame
from fem_lie.attachments.surface import on_surface
from fem_lie.bodies.body import Point
from fem_lie.bodies.closest import AT_NODE, closest_on_surface
from fem_lie.bodies.model import AxesUpdate, MaterialPoint
from fem_lie.bodies.thin_shells.assembly import rotate_surface_axes
from fem_lie.bodies.thin_shells.given_sections import ThinSections, section_per_cell
from fem_lie.bodies.thin_shells.integrals import Quadrature, along_edge, over_cells
from fem_lie.bodies.thin_shells.supports import HeldSurface, HeldSurfaceModel
from fem_lie.elements.thin_shells.nodal_coordinates import (
    CORNERS,
    NODES,
    SIZES,
    VECTORS,
    fill_hanging,
    half_of,
    node_of,
)
from fem_lie.lie.node_types import NodeType
from fem_lie.mesh.bicubic import hermite
from fem_lie.mesh.bicubic.patch_coupling import Joined, frames_of
from fem_lie.sections.material import Damping

# without the compiler, which takes longer than 16 calls
_NODE = np.array([unwrap(node_of)(a) for a in range(VECTORS)])
_HALF = np.array([unwrap(half_of)(a) for a in range(VECTORS)])
_ROW = _HALF + _NODE // CORNERS
_AT_A_POINT = np.array([[[1.0, 0, 0], [0, 1, 0]], [[0, 0, 0], [0, 0, 1]]])
"""Weights of position, ∂u and ∂v in the coordinates of a point."""
Direction = Callable[[Array], npt.ArrayLike]


class SmoothSurfaceModel(HeldSurfaceModel):
    """Model of a body on smooth patches; subclasses define the fourth vector of a point.

    A point has a position, the derivatives ``∂u, ∂v`` in parameters that are lengths, and a fourth
    vector. It is two nodes: rows 0 and 1 of ``frames[i]`` are position and ∂u, rows 1 and 2 of
    ``frames[points + i]`` the fourth vector and ∂v. Rows 2 and 3 of the first node are axes that
    rotate with the surface; the last is the normal.

    Attributes:
        points_count: Number of points; there are twice as many nodes.
        connectivity: Nodes of each cell: four with position and ∂u, then the others, shape (m, 8).
        sizes: Factors of ∂u, ∂v and the fourth vector in each cell, and a code of its hanging
            corners, shape (m, 4).
        sections: Section of each cell.
        stiffness: Section stiffness of each cell, shape (m, 8, 8).
        density: Mass per area of each cell, shape (m,).
        has_mass: Whether all cells have inertia.
        axes: Vector in each cell whose projection onto the surface is e₁ of its strains, (m, 3).
        damping: Mass-proportional damping.
        table: Shape functions and derivatives along ξ and η at points (g, 2), shape (g, 3 or more,
            16).
    """

    table: ClassVar[Callable[[Array], Array]]
    has_paired_nodes = True

    def __init__(
        self,
        surface: Joined,
        section: ThinSections,
        along: npt.ArrayLike | Direction | None,
        damping: Damping,
        class_name: str,
        name: str,
    ) -> None:
        """Create the nodes.

        Args:
            surface: Patches with joined edges.
            section: One for all cells, one for each patch, or a function of the centre of a cell,
                shape (3,).
            along: e₁ of the section axes before projection onto the surface: one vector, or a
                function of the centre of a cell; default: along a.
            damping: Mass-proportional damping.
            class_name: Name of the class of the body.
            name: Name in messages and results.

        Raises:
            ValueError: A patch has no section, or ``along`` is normal to the surface.
            TypeError: An argument has an unexpected type.
        """
        self.damping = damping
        self._edges, self._groups = surface.edges, surface.groups
        self._corners = surface.corners
        self.points_count = count = len(surface.nodal_vectors)
        fourth, sizes = self.fourth_vectors(surface)
        self.connectivity = np.concatenate([self._corners, count + self._corners], axis=1)
        self.sizes = np.column_stack([surface.sizes, sizes, surface.hanging])
        assert self.sizes.shape[1] == SIZES
        super().__init__(
            frames_of(surface.nodal_vectors, fourth),
            class_name=class_name,
            size=float(np.linalg.norm(np.ptp(surface.nodal_vectors[:, 0], axis=0))),
            points=surface.named,
            name=name,
        )
        rotate_surface_axes(self.frames, np.ones(count, dtype=bool))
        middles = self.cell_centres()
        sections = section_per_cell(section, middles, self.cells_of, self.label)
        self.sections = sections
        self.stiffness = np.array([s.stiffness for s in sections])
        self.density = np.array([s.inertia[0, 0] for s in sections])
        self.has_mass = bool((self.density > 0).all())
        self.axes = self._axes_along(along, middles)
        self.faces = self._drawn()[:, [0, 1, 3, 2]]
        self.thickness = np.array([s.thickness for s in sections], dtype=np.float64)

    @abstractmethod
    def surface_rule(self) -> tuple[Array, Array, Array]:
        """Values (g, 16), slopes (g, 2, 16) and weights (g,) of a quadrature rule over a cell."""

    @abstractmethod
    def fourth_vectors(self, surface: Joined) -> tuple[Array, Array]:
        """Fourth vector of each point (n, 3), and its factor in each cell (m,)."""

    @property
    def node_type(self) -> NodeType:
        """Type of the nodes with positions."""
        return NodeType.SURFACE_GRADIENT

    @property
    def node_types(self) -> Indices:
        """Type of each node, shape (n,)."""
        kinds = [int(NodeType.SURFACE_GRADIENT), int(NodeType.MIXED_DERIVATIVE)]
        return np.repeat(kinds, self.points_count).astype(np.int64)

    def attachment_of(self, node: int) -> AttachmentFrame:
        """Attachment frame of the surface: first axis along a, third axis normal.

        Args:
            node: Number of the node.
        """
        if node >= self.points_count:
            raise ValueError(
                f"{self.label} has points 0 … {self.points_count - 1}, got {node}: further nodes "
                "have no positions"
            )
        return on_surface((node, node + self.points_count), _AT_A_POINT)

    def point_in_cell(self, cell: int, ξ: float, η: float) -> MaterialPoint:
        """Material point within a cell, for joints, springs and loads.

        Args:
            cell: Index of the cell.
            ξ: From 0 to 1 along a.
            η: From 0 to 1 along b.

        Raises:
            ValueError: There is no such cell, or ``ξ`` or ``η`` is out of range.
        """
        if not 0 <= cell < len(self.connectivity):
            raise ValueError(f"{self.label} has cells 0 … {len(self.connectivity) - 1}, got {cell}")
        if not (
            0.0 <= number(ξ, "point_in_cell: ξ") <= 1.0
            and 0.0 <= number(η, "point_in_cell: η") <= 1.0
        ):
            raise ValueError(
                f"point_in_cell: ξ and η must lie between 0 and 1, got {ξ!r} and {η!r}"
            )
        shapes = type(self).table(np.array([[ξ, η]]))[0, : hermite.ACROSS + 1]
        shares = np.zeros((NODES, 2, 3))
        shares[_NODE, _HALF] = (shapes @ self.hermite_matrices()[cell]).T
        nodes = self.connectivity[cell]
        name = f"({ξ:g}, {η:g}) in cell {cell}"
        return MaterialPoint(int(nodes[0]), name, on_surface(nodes, shares))

    def closest(self, position: Array) -> MaterialPoint:
        """Closest point of the surface: a node, or a point within a cell.

        Args:
            position: Position in the reference configuration, shape (3,).
        """
        node = self.closest_node(position)
        if np.linalg.norm(self.frames[node, 0] - position) <= AT_NODE * self.size:
            return self.numbered(node)
        vectors = self.hermite_vectors()

        def surface(cell: int, at: Array) -> Array:
            return np.asarray(
                type(self).table(at[np.newaxis])[0, : hermite.ACROSS + 1] @ vectors[cell]
            )

        cell, (ξ, η) = closest_on_surface(position, vectors[:, ::4], surface)
        return self.point_in_cell(cell, float(ξ), float(η))

    def axes_update(self) -> AxesUpdate:
        """Function that rotates the axes with the surface, except where components are held."""
        moves: Flags = ~self.axes_are_held()

        def rotate_axes(coordinates: Array) -> None:
            rotate_surface_axes(coordinates, moves)

        return rotate_axes

    def cells_of(self, group: str | None = None) -> Indices:
        """Cells of a named patch (default: all).

        Args:
            group: Name of the group; default: all.

        Raises:
            ValueError: There is no such patch; the message lists those that exist.
        """
        if group is None:
            return np.arange(len(self.connectivity))
        text(group, f"the name of a patch of {self.label}")
        if group not in self._groups:
            known = ", ".join(self._groups) or "none"
            raise ValueError(f"{self.label} has no patch {group!r}; it has: {known}")
        return self._groups[group]

    def hermite_vectors(self, frames: Array | None = None) -> Array:
        """Hermite vectors of each cell, shape (m, 16, 3).

        Args:
            frames: Nodal coordinates, shape (n, 4, 3); default: initial ones.
        """
        coordinates = (self.frames if frames is None else frames)[self.connectivity]
        return np.asarray(self.hermite_matrices() @ coordinates[:, _NODE, _ROW])

    def hermite_matrices(self) -> Array:
        """Matrix of each cell from nodal coordinates to its Hermite vectors, shape (m, 16, 16)."""
        found = np.zeros((len(self.sizes), VECTORS, VECTORS))
        at = np.arange(VECTORS)
        found[:, at, at] = np.tile(np.insert(self.sizes[:, :3], 0, 1.0, axis=1), 4)
        for cell in np.flatnonzero(self.sizes[:, 3]):
            fill_hanging(int(self.sizes[cell, 3]), found[cell])
        return found

    def nodal_forces(self, cells: Indices, values: Array) -> Array:
        """Forces on nodal coordinates (n, 4, 3) of forces on vectors of cells (c, 16, 3).

        Args:
            cells: Numbers of the cells, shape (c,).
            values: Forces on the vectors of the cells, shape (c, 16, 3).
        """
        found = np.zeros((len(self.frames), 4, 3))
        nodes, back = (
            self.connectivity[cells][:, _NODE],
            self.hermite_matrices()[cells].swapaxes(1, 2),
        )
        np.add.at(found, (nodes, _ROW), back @ values)
        return found

    def cell_quadrature(self, group: str | None = None) -> Quadrature:
        """Quadrature over the cells of a patch (default: all).

        Args:
            group: Name of the group; default: all.
        """
        cells = self.cells_of(group)
        return over_cells(cells, self.hermite_vectors()[cells], type(self).table)

    def edge_quadrature(self, name: str) -> Quadrature:
        """Quadrature along an edge.

        Args:
            name: Name of the edge.

        Raises:
            ValueError: There is no such edge.
        """
        edge = self.edge(name)
        if edge.along < 0:
            raise ValueError(f"{name!r} of {self.label} is a corner, expected an edge")
        return along_edge(edge, self.hermite_vectors()[edge.cells], type(self).table)

    def consistent_forces(self, at: Quadrature, density: Array) -> Array:
        """Consistent nodal forces (n, 4, 3) of force densities (c, g, 3) at quadrature points.

        Args:
            at: Points of integration.
            density: Force densities, shape (c, g, 3).
        """
        on_vectors = np.einsum("cg,cga,cgj->caj", at.weights, at.values, density)
        return self.nodal_forces(at.cells, on_vectors)

    def nodal_matrices(self, M: Array) -> Array:
        """Matrices of cells (m, 16, 16) in nodal coordinates, shape (m, 8, 4, 8, 4).

        Args:
            M: Matrices of the cells, shape (m, 16, 16).
        """
        E, found = self.hermite_matrices(), np.zeros((len(M), NODES, 4, NODES, 4))
        i, a = np.meshgrid(range(VECTORS), range(VECTORS), indexing="ij")
        shares = E.swapaxes(1, 2) @ M @ E
        found[:, _NODE[i], _ROW[i], _NODE[a], _ROW[a]] = shares
        return found

    def _drawn(self) -> Indices:
        """Corners of cells for pictures; a hanging corner is drawn at one end of its edge."""
        found, own = self._corners.copy(), self.sizes[:, 3].astype(np.int64)
        for k in range(2):
            cells = np.flatnonzero(own >> (2 + k) & 1)
            stays = own[cells] & 3
            end = stays ^ (1 << k)
            # the same end for the quarters on both sides
            found[cells, end] = np.maximum(self._corners[cells, stays], self._corners[cells, end])
        return found

    def cell_centres(self) -> Array:
        """Centre of each cell, shape (m, 3)."""
        return np.asarray(self.hermite_vectors()[:, ::4].mean(axis=1))

    def _axes_along(self, along: npt.ArrayLike | Direction | None, middles: Array) -> Array:
        first, second = (self.hermite_vectors()[:, k::4] for k in (1, 2))
        if along is None:
            return np.asarray(first.mean(axis=1))
        given = [along(x) for x in middles] if callable(along) else [along] * len(middles)
        axes = np.array([direction(value, "ThinShell: along") for value in given])
        normals = np.cross(first, second)
        normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
        sine = np.linalg.norm(np.cross(normals, axes[:, np.newaxis]), axis=-1).min(axis=1)
        if sine.min() < 1e-6:
            cell = int(sine.argmin())
            raise ValueError(
                f"along must not be normal to the surface; in the cell at {middles[cell]} it is "
                f"{axes[cell]}"
            )
        return axes


class SmoothSurface(HeldSurface):
    """Body on smooth patches."""

    model: SmoothSurfaceModel

    def point_in_cell(self, cell: int, ξ: float, η: float) -> Point:
        """Point within a cell, for joints, springs and loads.

        Args:
            cell: Index of the cell.
            ξ: From 0 to 1 along a.
            η: From 0 to 1 along b.

        Raises:
            ValueError: There is no such cell, or ``ξ`` or ``η`` is out of range.
        """
        return self._at(self.model.point_in_cell(cell, ξ, η))
