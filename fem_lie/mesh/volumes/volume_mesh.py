"""Volumes of hexahedra or tetrahedra on meshes of DOLFINx, with names for their parts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import dolfinx
import numpy as np

from fem_lie import _compat
from fem_lie._arrays import Array, Indices, find_name, instance
from fem_lie.mesh.volumes.integrals import VolumeRule

_KINDS = {"tetrahedron": (4, 10), "hexahedron": (8, 27)}
"""Nodes of cells of degree 1 and 2."""

_FLAT = 1e-12
"""Volume over the third power of the longest edge, of cells that have none."""


@dataclass(frozen=True, eq=False)
class VolumeMesh:
    """A mesh of DOLFINx that fills a volume; see ``block``, ``read_gmsh_volume`` and others.

    Attributes:
        mesh: Hexahedra or tetrahedra of degree 1 or 2 in space, on one process.
        groups: Cells of each named group.
        faces: Facets of each named face.
        curves: Edges of each named curve.
        named_points: Vertices of each name.

    Raises:
        ValueError: The mesh is another one, or a cell is turned inside out or has no volume.
        TypeError: It is no mesh of DOLFINx.
    """

    mesh: dolfinx.mesh.Mesh
    groups: Mapping[str, Indices] = field(default_factory=dict)
    faces: Mapping[str, Indices] = field(default_factory=dict)
    curves: Mapping[str, Indices] = field(default_factory=dict)
    named_points: Mapping[str, Indices] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """See the class."""
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
        """Of the cells' edges."""
        return int(_KINDS[self.cell].index(_compat.geometry_dofmap(self.mesh).shape[1])) + 1

    @property
    def cells(self) -> int:
        """How many there are."""
        return int(self.mesh.topology.index_map(3).size_local)

    def group(self, name: str) -> Indices:
        """Cells of a named group.

        Raises:
            ValueError: There is none; the message lists those that exist.
        """
        return find_name(dict(self.groups), name, "group of cells")

    def face(self, name: str) -> Indices:
        """Facets of a named face.

        Raises:
            ValueError: There is none; the message lists those that exist.
        """
        return find_name(dict(self.faces), name, "face")

    def part(self, name: str) -> tuple[int, Indices]:
        """Dimension and entities of a face, curve, named point or group of cells.

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
    """Entities whose vertices are these nodes of the geometry, shape (k, corners).

    Raises:
        ValueError: There is no such entity.
    """
    mesh.topology.create_entities(dim)
    mesh.topology.create_connectivity(dim, 0)
    count = mesh.topology.index_map(dim).size_local
    vertices: Indices = geometry_of_vertices(mesh)
    own = vertices[mesh.topology.connectivity(dim, 0).array.reshape(count, -1)]
    keys = np.sort(own, axis=1)
    wanted = np.sort(corners.reshape(-1, keys.shape[1]), axis=1)
    both, number = np.unique(np.concatenate([keys, wanted]), axis=0, return_inverse=True)
    number = number.ravel()
    at = np.full(len(both), -1)
    at[number[:count]] = np.arange(count)
    found = at[number[count:]]
    if (found < 0).any():
        raise ValueError(f"points {wanted[found < 0][0]} are no corners of one part of a cell")
    return np.unique(found)


def entities_on(mesh: dolfinx.mesh.Mesh, dim: int, nodes: Indices) -> Indices:
    """Entities all of whose vertices are among these nodes of the geometry."""
    mesh.topology.create_entities(dim)
    mesh.topology.create_connectivity(dim, 0)
    count = mesh.topology.index_map(dim).size_local
    own = geometry_of_vertices(mesh)[mesh.topology.connectivity(dim, 0).array.reshape(count, -1)]
    return np.flatnonzero(np.isin(own, nodes).all(axis=1))


def geometry_of_vertices(mesh: dolfinx.mesh.Mesh) -> Indices:
    """Node of the geometry of each vertex, shape (v,)."""
    mesh.topology.create_connectivity(0, 3)
    mesh.topology.create_connectivity(3, 0)
    count = mesh.topology.index_map(0).size_local
    every = np.arange(count, dtype=np.int32)
    return dolfinx.mesh.entities_to_geometry(mesh, 0, every).ravel().astype(np.int64)


def _refuse_inverted(mesh: dolfinx.mesh.Mesh, degree: int) -> None:
    """Cells may be left-handed, as those of DOLFINx are, but of one sense everywhere."""
    volumes: Array = VolumeRule.of(mesh, degree, checked=True).jacobian
    edges = np.ptp(mesh.geometry.x[_compat.geometry_dofmap(mesh)], axis=1).max(axis=1)
    turned = volumes * np.sign(volumes[:, :1]) <= _FLAT * edges[:, np.newaxis] ** 3
    bad = np.flatnonzero(turned.any(axis=1))
    if len(bad):
        nodes = _compat.geometry_dofmap(mesh)[bad[0]]
        raise ValueError(
            f"{len(bad)} of {len(volumes)} cells are turned inside out or have no volume; the "
            f"first is cell {bad[0]} with corners at\n{mesh.geometry.x[nodes]}"
        )
