"""Values in the cells of a surface mesh: nodal values, and DOLFINx functions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import basix
import basix.ufl
import dolfinx
import numpy as np
from dolfinx import fem
from scipy.sparse import coo_matrix, csr_matrix
from scipy.sparse.csgraph import connected_components

from fem_lie import _compat
from fem_lie._arrays import Array, Flags, Indices
from fem_lie.mesh.shapes import nodes_of, tabulated
from fem_lie.mesh.surfaces import SurfaceMesh

ElementMaker = Callable[[str, int, tuple[int, ...]], Any]
"""Creates an element from cell, degree and shape of the values."""


def LAGRANGE(cell: str, degree: int, shape: tuple[int, ...]) -> Any:
    """Continuous Lagrange element."""
    return basix.ufl.element("Lagrange", cell, degree, shape=shape)


def DISCONTINUOUS(cell: str, degree: int, shape: tuple[int, ...]) -> Any:
    """Discontinuous Lagrange element with the same nodes."""
    return basix.ufl.element("DG", cell, degree, shape=shape)


def quadrature(points: int) -> ElementMaker:
    """Quadrature element of a rule of this degree."""

    def element(cell: str, degree: int, shape: tuple[int, ...]) -> Any:
        return basix.ufl.quadrature_element(cell, value_shape=shape, degree=points)

    return element


def dolfinx_surface(mesh: SurfaceMesh, positions: Array) -> dolfinx.mesh.Mesh:
    """The mesh with nodes at ``positions`` (n, 3); DOLFINx reorders the cells."""
    return _compat.create_surface_mesh(
        np.array(positions, dtype=np.float64), mesh.cells, mesh.cell, mesh.degree
    )


def cells_function(
    mesh: dolfinx.mesh.Mesh, of: SurfaceMesh, values: Array, element: ElementMaker, name: str
) -> fem.Function:
    """A function from its values in each cell.

    Args:
        mesh: Mesh from :func:`dolfinx_surface`.
        of: The surface mesh that it was made from.
        values: Values at the nodes or points of each cell of the surface, shape (m, q) or (m, q,
            b).
        element: Element of the function.
        name: Name of the function.
    """
    chosen = element(of.cell, of.degree, values.shape[2:])
    f = fem.Function(fem.functionspace(mesh, chosen), name=name)
    rows = f.x.array.reshape(-1, *values.shape[2:])
    rows[f.function_space.dofmap.list] = values[mesh.topology.original_cell_index]
    return f


@dataclass(frozen=True, eq=False)
class CellPoints:
    """The same reference coordinates in all cells.

    Attributes:
        shapes: Values of the shape functions, shape (q, k).
        slopes: Derivatives of the shape functions, shape (2, q, k).
    """

    shapes: Array
    slopes: Array

    @classmethod
    def of(cls, mesh: SurfaceMesh, points: Array) -> CellPoints:
        """Tabulate at reference coordinates, shape (q, 2)."""
        table = tabulated(mesh.cell, mesh.degree, points)
        return cls(table[0], table[1:])

    @classmethod
    def nodes(cls, mesh: SurfaceMesh) -> CellPoints:
        """Tabulate at the nodes of the cells."""
        return cls.of(mesh, node_coordinates(mesh))

    def positions(self, x: Array) -> Array:
        """Positions, shape (m, q, 3), for nodes at ``x`` of each cell, shape (m, k, 3)."""
        return np.einsum("qk,mkj->mqj", self.shapes, x)

    def tangents(self, x: Array) -> Array:
        """``x,1`` and ``x,2``, shape (m, q, 2, 3)."""
        return np.einsum("aqk,mkj->mqaj", self.slopes, x)


def node_coordinates(mesh: SurfaceMesh) -> Array:
    """Reference coordinates of the nodes, shape (k, 2)."""
    return nodes_of(mesh.cell, mesh.degree)


def extrapolation(mesh: SurfaceMesh, points: Array) -> Array:
    """Matrix (k, g) from values at points (g, 2) to the nodes of the cell.

    The field is the least-squares fit of a linear function on a triangle, or a bilinear one on a
    quadrilateral, also for elements of second degree, whose stress is more accurate by one order in
    this part of it.
    """

    def monomials(X: Array) -> Array:
        one, a, b = np.ones(len(X)), X[:, 0], X[:, 1]
        return np.column_stack([one, a, b] + [a * b] * (mesh.cell == "quadrilateral"))

    return np.asarray(monomials(node_coordinates(mesh)) @ np.linalg.pinv(monomials(points)))


def axes_along(normals: Array, direction: Array) -> Array:
    """Axes (e₁, e₂, n), e₁ along the projection of a direction; all (..., 3), result (..., 3, 3).

    Raises:
        ValueError: A direction is zero or normal to the surface.
    """
    e1 = direction - np.einsum("...j,...j->...", direction, normals)[..., np.newaxis] * normals
    size = np.linalg.norm(e1, axis=-1, keepdims=True)
    bad = ~(size > 1e-6 * np.linalg.norm(direction, axis=-1, keepdims=True))
    if bad.any():
        where, given = bad[..., 0], np.broadcast_to(direction, e1.shape)
        raise ValueError(
            "the direction of e₁ must not be zero or normal to the surface; where the normal is "
            f"{normals[where][0]} it is {given[where][0]}"
        )
    e1 = e1 / size
    return np.stack([e1, np.cross(normals, e1), normals], axis=-2)


def unit(v: Array) -> Array:
    """Normalised vectors (..., 3)."""
    return np.asarray(v / np.linalg.norm(v, axis=-1, keepdims=True))


def slopes_along(axes: Array, tangents: Array, slopes: Array) -> Array:
    """Derivatives along e₁ and e₂, shape (..., 2, 3), from those along reference coordinates.

    Args:
        axes: Undeformed axes, shape (..., 3, 3).
        tangents: ``X,α``, shape (..., 2, 3).
        slopes: Derivatives of a vector, shape (..., 2, 3).
    """
    jacobian = np.einsum("...aj,...ij->...ai", tangents, axes[..., :2, :])
    return np.asarray(np.linalg.solve(jacobian, slopes), dtype=np.float64)


def convected_axes(axes: Array, tangents: Array, moved: Array) -> Array:
    """Axes convected by the deformation, orthonormalised by the polar decomposition.

    Args:
        axes: Undeformed axes, shape (..., 3, 3).
        tangents: ``X,α``, shape (..., 2, 3).
        moved: ``x,α``, shape (..., 2, 3).
    """
    U, _, V = np.linalg.svd(slopes_along(axes, tangents, moved), full_matrices=False)
    pair = U @ V
    normal = np.cross(pair[..., 0, :], pair[..., 1, :])
    return np.concatenate([pair, normal[..., np.newaxis, :]], axis=-2)


@dataclass(frozen=True, eq=False)
class SharedValues:
    """Groups of cell nodes that share a nodal value.

    Attributes:
        number: Index of the value of each node of each cell, shape (m, k).
        node: Node of each value, shape (p,), sorted; without a jump these are all nodes.
        edge: Whether each value is at an edge, a kink or a jump, shape (p,).
    """

    number: Indices
    node: Indices
    edge: Flags

    def mean(self, values: Array) -> Array:
        """Means over cells that share a value, shape (p, ...), of values of shape (m, k, ...)."""
        each = values.reshape(self.number.size, -1)
        return np.asarray(self._mean @ each).reshape(-1, *values.shape[2:])

    @cached_property
    def _mean(self) -> csr_matrix:
        """Averaging matrix, shape (p, m k)."""
        number = self.number.ravel()
        share = 1.0 / np.bincount(number, minlength=len(self.node))
        return csr_matrix((share[number], (number, np.arange(len(number)))))


def shared_values(
    mesh: SurfaceMesh, smooth: Callable[[Indices, Indices, Indices, Indices], Flags]
) -> SharedValues:
    """Group cell nodes at which the surface is smooth across edges.

    Args:
        mesh: The surface.
        smooth: For cells ``a`` and ``b`` and the local indices ``i`` and ``j`` of a common node,
            whether they may share its value.
    """
    k = mesh.cells.shape[1]
    a, b, i, j = _common_nodes(mesh)
    chosen = smooth(a, b, i, j)
    rows, columns = (k * a + i)[chosen], (k * b + j)[chosen]
    size = mesh.cells.size
    graph = coo_matrix((np.ones(len(rows)), (rows, columns)), shape=(size, size))
    _, label = connected_components(graph, directed=False)
    # numbered by nodes, so that numbers are those of the nodes if there is no jump
    pairs, number = np.unique(
        np.column_stack([mesh.cells.ravel(), label]), axis=0, return_inverse=True
    )
    number = number.ravel()
    # in the interior there are as many common edges around a node as cells
    links = np.bincount(number[rows], minlength=len(pairs))
    edge = links < np.bincount(number)
    return SharedValues(
        number.reshape(mesh.cells.shape).astype(np.int64), pairs[:, 0].astype(np.int64), edge
    )


def _common_nodes(mesh: SurfaceMesh) -> tuple[Indices, Indices, Indices, Indices]:
    """All ``(a, b, i, j)`` of :func:`shared_values` for edges that two cells share."""
    round_ = _round(mesh)
    c = len(round_)
    ends = np.sort(mesh.cells[:, round_[:, :2]], axis=2).reshape(-1, 2)
    _, edge = np.unique(ends, axis=0, return_inverse=True)
    order = np.argsort(edge.ravel(), kind="stable")
    sorted_edge = edge.ravel()[order]
    found = []
    for step in range(1, int(np.bincount(sorted_edge).max())):
        same = np.flatnonzero(sorted_edge[step:] == sorted_edge[:-step])
        first, second = order[same], order[same + step]
        p, q = round_[first % c], round_[second % c]
        a, b = first // c, second // c
        # the nodes of the edge have the opposite order, or the same if the orientations differ
        for i in range(round_.shape[1]):
            for j in range(round_.shape[1]):
                equal = mesh.cells[a, p[:, i]] == mesh.cells[b, q[:, j]]
                found.append(np.stack([a, b, p[:, i], q[:, j]])[:, equal])
    none: Indices = np.empty((4, 0), dtype=np.int64)
    all_: Indices = np.concatenate([none, *found], axis=1)
    return all_[0], all_[1], all_[2], all_[3]


def _round(mesh: SurfaceMesh) -> Indices:
    """Local indices of the nodes of each edge, ends first, shape (c, 2 or 3)."""
    cell = basix.CellType[mesh.cell]
    ends = np.array(basix.topology(cell)[1], dtype=np.int64)
    if mesh.degree == 1:
        return ends
    return np.column_stack([ends, len(basix.topology(cell)[0]) + np.arange(len(ends))])


def nearby(patches: SharedValues) -> tuple[Indices, Indices]:
    """Pairs of a value at an edge and a cell that shares a value with one of its cells."""
    m, k = patches.number.shape
    rows, columns = patches.number.ravel(), np.repeat(np.arange(m), k)
    around = csr_matrix((np.ones(m * k), (rows, columns)), shape=(len(patches.node), m))
    edge = np.flatnonzero(patches.edge)
    pairs = (around[edge] @ (around.T @ around)).tocoo()
    return edge[pairs.row], pairs.col.astype(np.int64)


def planes(which: Indices, positions: Array, values: Array, count: int) -> Array:
    """Value at the origin of the least-squares plane of each of ``count`` sets of points.

    Where the points of a set are collinear, or there is only one, the plane has no slope in the
    undetermined directions. The result has the shape (count, b).

    Args:
        which: Set of each point, shape (r,).
        positions: Coordinates of the points in the plane, shape (r, 2).
        values: Values at the points, shape (r, b).
        count: Number of sets, each with at least one point.
    """
    number = np.bincount(which, minlength=count)[:, np.newaxis]

    def total(parts: Array) -> Array:
        sums = np.zeros((count, *parts.shape[1:]))
        np.add.at(sums, which, parts)
        return sums

    middle, mean = total(positions) / number, total(values) / number
    d, change = positions - middle[which], values - mean[which]
    matrix = total(np.einsum("ri,rj->rij", d, d))
    slope = np.linalg.pinv(matrix, rcond=1e-6, hermitian=True) @ total(
        np.einsum("ri,rb->rib", d, change)
    )
    return np.asarray(mean - np.einsum("ni,nib->nb", middle, slope))
