"""Meshes of hexahedra and tetrahedra, quadrature over their cells, and meshes of functions."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from itertools import combinations

import dolfinx
import numpy as np
import numpy.typing as npt

from fem_lie import _compat
from fem_lie._arrays import (
    Array,
    Flags,
    Indices,
    Where,
    entities_where,
    find_name,
    instance,
    members_within,
    points_of,
    whole_number,
)
from fem_lie._summary import Summarised
from fem_lie.mesh.parameter_grids import PARAMETERS, ParameterGrid
from fem_lie.mesh.shapes import nodes_of, rule, tabulated

"""Function of positions, shape (3, n), that returns n truth values."""

_GEOMETRY = {4: 1, 10: 2, 8: 1, 27: 2}
"""Degree of a cell's geometry by its number of nodes."""


@dataclass(frozen=True, eq=False)
class VolumeRule:
    """Quadrature rule in all cells.

    Attributes:
        values: Shape functions of the nodes, shape (g, k).
        jacobian: Jacobian determinant of the cell's map, of one sign unless it is inverted, (m, g).
        volumes: Weight times volume, shape (m, g).
        positions: Unloaded positions of the points, shape (m, g, 3).
        mean_slopes: Integrals of the shape functions' gradients, shape (m, k, 3).
    """

    values: Array
    jacobian: Array
    volumes: Array
    positions: Array
    mean_slopes: Array

    @classmethod
    def of(cls, mesh: dolfinx.mesh.Mesh, degree: int, *, checked: bool = False) -> VolumeRule:
        """Rule that is exact for products of two shape functions on cells with plane faces.

        Args:
            mesh: Mesh of hexahedra or tetrahedra.
            degree: Degree of the shape functions.
            checked: Add the nodes of a cell as points with weight one.
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


_KINDS = {"tetrahedron": (4, 10), "hexahedron": (8, 27)}
"""Numbers of nodes of cells of degree 1 and 2."""

_FLAT = 1e-12
"""Volume over the third power of the longest edge below which a cell has no volume."""


@dataclass(frozen=True, eq=False, repr=False)
class VolumeMesh(Summarised):
    """Volume mesh of DOLFINx; see ``parametric_volume``, ``read_gmsh_volume`` and others.

    Attributes:
        mesh: Hexahedra or tetrahedra of degree 1 or 2 in space, on one process.
        groups: Cells of each named group.
        faces: Facets of each named face.
        curves: Edges of each named curve.
        named_points: Vertices of each name.

    Raises:
        ValueError: The mesh has other cells, or a cell is inverted or has no volume.
        TypeError: ``mesh`` is not a DOLFINx mesh.
    """

    mesh: dolfinx.mesh.Mesh
    groups: Mapping[str, Indices] = field(default_factory=dict)
    faces: Mapping[str, Indices] = field(default_factory=dict)
    curves: Mapping[str, Indices] = field(default_factory=dict)
    named_points: Mapping[str, Indices] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Check the mesh."""
        instance(self.mesh, dolfinx.mesh.Mesh, "VolumeMesh: mesh", "a mesh of DOLFINx")
        if self.mesh.comm.size > 1:
            raise ValueError(f"the mesh must be on one process, got one on {self.mesh.comm.size}")
        kinds = _compat.kinds_of_cells(self.mesh)
        nodes = _compat.geometry_dofmap(self.mesh).shape[1] if len(kinds) == 1 else 0
        if len(kinds) != 1 or nodes not in _KINDS.get(kinds[0], ()):
            raise ValueError(
                "a solid needs tetrahedra or hexahedra of order 1 or 2, got "
                f"{' and '.join(kinds)} cells of {nodes} nodes"
            )
        _refuse_inverted(self.mesh, self.degree)

    @property
    def cell(self) -> str:
        """``"tetrahedron"`` or ``"hexahedron"``."""
        return str(self.mesh.topology.cell_name())

    @property
    def degree(self) -> int:
        """Degree of the cells' edges."""
        return int(_KINDS[self.cell].index(_compat.geometry_dofmap(self.mesh).shape[1])) + 1

    @property
    def cells(self) -> int:
        """Number of cells."""
        return int(self.mesh.topology.index_map(3).size_local)

    def group(self, name: str) -> Indices:
        """Cells of a named group.

        Args:
            name: Name of the group.

        Raises:
            ValueError: There is none; the message lists those that exist.
        """
        return find_name(dict(self.groups), name, "group of cells")

    def face(self, name: str) -> Indices:
        """Facets of a named face.

        Args:
            name: Name of the face.

        Raises:
            ValueError: There is none; the message lists those that exist.
        """
        return find_name(dict(self.faces), name, "face")

    def named(
        self,
        *,
        faces: Mapping[str, Where] | None = None,
        points: Mapping[str, Where] | None = None,
    ) -> VolumeMesh:
        """Mesh with further names, given by place, as for CAD without names.

        Args:
            faces: For each name, where all corners of its facets are: a function of positions,
                shape (3, n), that returns n truth values. Only facets of the boundary are meant.
            points: Likewise for vertices.

        Raises:
            ValueError: Nothing is there, or a function returns anything else.

        Example:
            >>> mesh = fl.mesh.brick((1, 1, 2), (2, 2, 4))
            >>> mesh = mesh.named(faces={"top": lambda x: x[2] > 1.999})
            >>> len(mesh.face("top"))
            4
        """
        mesh, vertices = self.mesh, geometry_of_vertices(self.mesh)
        connected = mesh.topology.connectivity
        mesh.topology.create_entities(2)
        for pair in ((2, 0), (2, 3)):
            mesh.topology.create_connectivity(*pair)
        facets = dolfinx.mesh.exterior_facet_indices(mesh.topology).astype(np.int64)
        count = mesh.topology.index_map(2).size_local
        corners = vertices[connected(2, 0).array.reshape(count, -1)][facets]
        x, every = mesh.geometry.x, vertices[:, np.newaxis]
        found = {
            name: facets[entities_where(where, x, corners, f"face {name!r}")]
            for name, where in (faces or {}).items()
        }
        spots = {
            name: entities_where(where, x, every, f"point {name!r}")
            for name, where in (points or {}).items()
        }
        return replace(
            self, faces={**self.faces, **found}, named_points={**self.named_points, **spots}
        )

    def restricted(self, cells: Indices) -> tuple[VolumeMesh, Indices]:
        """Mesh of some cells on this process alone, with all names.

        Faces between two cells go with the cell of the lower number.

        Args:
            cells: Indices of the cells, ascending, shape (s,).

        Returns:
            The mesh, and the number of each of its cells in the whole mesh.
        """
        mesh, numbers, nodes = _compat.submesh(self.mesh, cells)
        at = np.full(len(self.mesh.geometry.x), -1)
        at[nodes] = np.arange(len(nodes))

        def within(dim: int, members: Indices) -> Indices:
            own, corners = _around(self.mesh, dim, members, cells)
            inside = at[corners[own]]
            return entities_at(mesh, dim, inside) if len(inside) else inside.ravel()

        part = copy(self)
        for name, value in (
            ("mesh", mesh),
            ("groups", members_within(self.groups, numbers)),
            ("faces", {name: within(2, members) for name, members in self.faces.items()}),
            ("curves", {name: within(1, members) for name, members in self.curves.items()}),
            (
                "named_points",
                {name: within(0, members) for name, members in self.named_points.items()},
            ),
        ):
            object.__setattr__(part, name, value)
        return part, numbers

    def part(self, name: str) -> tuple[int, Indices]:
        """Dimension and entities of a face, curve, named point or group of cells.

        Args:
            name: Name of a face, curve, point or group of cells.

        Raises:
            ValueError: There is none; the message lists those that exist.
        """
        parts = {2: self.faces, 1: self.curves, 0: self.named_points, 3: self.groups}
        for dim, named in parts.items():
            if name in named:
                return dim, named[name]
        known = {key: values for named in parts.values() for key, values in named.items()}
        return 3, find_name(known, name, "face, curve, point or group")


def entities_at(mesh: dolfinx.mesh.Mesh, dim: int, corners: Indices) -> Indices:
    """Entities whose vertices are the geometry nodes ``corners``, shape (k, corners).

    Raises:
        ValueError: There is no such entity.
    """
    mesh.topology.create_entities(dim)
    mesh.topology.create_connectivity(dim, 0)
    count = mesh.topology.index_map(dim).size_local
    vertices: Indices = geometry_of_vertices(mesh)
    own = vertices[mesh.topology.connectivity(dim, 0).array.reshape(count, -1)]
    keys = np.sort(own, axis=1)
    corner_keys = np.sort(corners.reshape(-1, keys.shape[1]), axis=1)
    both, number = np.unique(np.concatenate([keys, corner_keys]), axis=0, return_inverse=True)
    number = number.ravel()
    at = np.full(len(both), -1)
    at[number[:count]] = np.arange(count)
    found = at[number[count:]]
    if (found < 0).any():
        raise ValueError(f"points {corner_keys[found < 0][0]} are no corners of one part of a cell")
    return np.unique(found)


def _around(
    mesh: dolfinx.mesh.Mesh, dim: int, members: Indices, cells: Indices
) -> tuple[Flags, Indices]:
    """Whether entities belong to some cells (e,), and the geometry nodes of their vertices (e, v).

    A facet belongs to its cell of the lower number, an edge or vertex to all of its cells.
    """
    mesh.topology.create_entities(dim)
    for other in (0, 3):
        mesh.topology.create_connectivity(dim, other)
    to_cells, to_vertices = (mesh.topology.connectivity(dim, other) for other in (3, 0))
    count = mesh.topology.index_map(dim).size_local
    starts = to_cells.offsets[:count]
    if dim == 2:
        own = np.isin(np.minimum.reduceat(to_cells.array, starts), cells)
    else:
        own = np.logical_or.reduceat(np.isin(to_cells.array, cells), starts)
    corners = geometry_of_vertices(mesh)[to_vertices.array.reshape(count, -1)]
    return own[members], corners[members]


def entities_on(mesh: dolfinx.mesh.Mesh, dim: int, nodes: Indices) -> Indices:
    """Entities whose vertices are all among some geometry nodes."""
    mesh.topology.create_entities(dim)
    mesh.topology.create_connectivity(dim, 0)
    count = mesh.topology.index_map(dim).size_local
    own = geometry_of_vertices(mesh)[mesh.topology.connectivity(dim, 0).array.reshape(count, -1)]
    return np.flatnonzero(np.isin(own, nodes).all(axis=1))


def geometry_of_vertices(mesh: dolfinx.mesh.Mesh) -> Indices:
    """Geometry node of each vertex, shape (v,)."""
    mesh.topology.create_connectivity(0, mesh.topology.dim)
    mesh.topology.create_connectivity(mesh.topology.dim, 0)
    count = mesh.topology.index_map(0).size_local
    every = np.arange(count, dtype=np.int32)
    return dolfinx.mesh.entities_to_geometry(mesh, 0, every).ravel().astype(np.int64)


def _refuse_inverted(mesh: dolfinx.mesh.Mesh, degree: int) -> None:
    """Raise ``ValueError`` for inverted cells; all left-handed, as in DOLFINx, is accepted."""
    volumes: Array = VolumeRule.of(mesh, degree, checked=True).jacobian
    edges = np.ptp(mesh.geometry.x[_compat.geometry_dofmap(mesh)], axis=1).max(axis=1)
    turned = volumes * np.sign(volumes[:, :1]) <= _FLAT * edges[:, np.newaxis] ** 3
    bad = np.flatnonzero(turned.any(axis=1))
    if len(bad):
        nodes = _compat.geometry_dofmap(mesh)[bad[0]]
        raise ValueError(
            f"{len(bad)} of {len(volumes)} cells are inverted or have no volume; the "
            f"first is cell {bad[0]} with corners at\n{mesh.geometry.x[nodes]}"
        )


_TETRAHEDRA = ((0, 1, 3, 7), (0, 1, 7, 5), (0, 5, 7, 4), (0, 3, 2, 7), (0, 6, 4, 7), (0, 2, 6, 7))
"""Six tetrahedra of a hexahedron, about its diagonal."""


def parametric_volume(
    function: Callable[[float, float, float], npt.ArrayLike],
    cells: tuple[int, int, int],
    *,
    cell: str = "hexahedron",
    closed: str = "",
) -> VolumeMesh:
    """Volume over the unit cube ``(a, b, c)``, divided at equal steps of the three parameters.

    Its faces are "a=0", "a=1" and so on, its edges the curves "a=0,b=0" and so on, its corners the
    points "000" to "111"; closed parameters have no ends among them but for points at 0. Edges of
    cells are straight; a tetrahedral mesh has six cells for each hexahedron.

    Args:
        function: Point at ``(a, b, c)``, shape (3,).
        cells: Numbers of cells along a, b and c.
        cell: ``"hexahedron"`` or ``"tetrahedron"``.
        closed: Parameters whose ends are one face, with three cells or more, such as ``"a"`` of a
            ring; otherwise ends at the same place are not joined.

    Raises:
        ValueError: A cell has no volume, closed ends do not meet, or an argument is out of range.
    """
    if cell not in ("hexahedron", "tetrahedron"):
        raise ValueError(f"expected cells 'hexahedron' or 'tetrahedron', got {cell!r}")
    instance(function, Callable, "a block", "a function of a, b and c from 0 to 1")
    if not isinstance(cells, Sequence) or len(cells) != 3:
        raise ValueError(f"cells must be three numbers, along a, b and c, got {cells!r}")
    grid = ParameterGrid([whole_number(count) for count in cells], 1, closed)
    points, cell_nodes = grid.points(function), _grid_cells(grid.number, cell)
    mesh = _compat.create_surface_mesh(points, cell_nodes, cell, 1)
    return _named(mesh, grid)


def brick(
    lengths: npt.ArrayLike,
    cells: tuple[int, int, int],
    *,
    origin: npt.ArrayLike = (0.0, 0.0, 0.0),
    cell: str = "hexahedron",
) -> VolumeMesh:
    """Box of equal cells with a corner at ``origin``; a, b and c go along x, y and z.

    Args:
        lengths: Lengths of its edges, shape (3,).
        cells: Numbers of cells along x, y and z.
        origin: Corner with the smallest coordinates.
        cell: ``"hexahedron"`` or ``"tetrahedron"``.

    Raises:
        ValueError: A length is not positive, or something is out of range.
    """
    edges, start = (points_of([value])[0] for value in (lengths, origin))
    if not (edges > 0.0).all():
        raise ValueError(f"a box needs three positive lengths, got {lengths!r}")
    return parametric_volume(lambda a, b, c: start + edges * np.array([a, b, c]), cells, cell=cell)


def _named(mesh: dolfinx.mesh.Mesh, grid: ParameterGrid) -> VolumeMesh:
    """Mesh with names of faces, edges and corners of a grid."""
    order = mesh.geometry.input_global_indices
    node = np.empty(len(order), dtype=np.int64)
    node[order] = np.arange(len(order))
    sides = {
        f"{PARAMETERS[k]}={end}": node[np.moveaxis(grid.number, k, 0)[-end].ravel()]
        for k in grid.open
        for end in (0, 1)
    }
    edges = {
        f"{one},{other}": np.intersect1d(sides[one], sides[other])
        for one, other in combinations(sides, 2)
        if one[0] != other[0]
    }
    corners = {name: node[points] for name, points in grid.corners.items()}
    return VolumeMesh(
        mesh,
        faces={name: entities_on(mesh, 2, nodes) for name, nodes in sides.items()},
        curves={name: entities_on(mesh, 1, nodes) for name, nodes in edges.items()},
        named_points={name: entities_on(mesh, 0, nodes) for name, nodes in corners.items()},
    )


def _grid_cells(number: Indices, cell: str) -> Indices:
    """Cells on a grid of points, in DOLFINx's order."""
    counts = [n - 1 for n in number.shape]
    ends = [number[i:n, j:m, k:p] for i, n, j, m, k, p in _corners(counts)]
    hexahedra = np.stack([each.ravel() for each in ends], axis=1)
    if cell == "hexahedron":
        return hexahedra
    return hexahedra[:, np.array(_TETRAHEDRA)].reshape(-1, 4)


def _corners(counts: Sequence[int]) -> list[tuple[int, int, int, int, int, int]]:
    """Slices of the grid that hold each corner of all cells, the first parameter fastest."""
    n, m, p = counts
    return [(i, n + i, j, m + j, k, p + k) for k in (0, 1) for j in (0, 1) for i in (0, 1)]
