"""A distributed mesh of DOLFINx on each process, with its tags."""

from __future__ import annotations

from typing import NamedTuple, TypeAlias, TypeVar

from mpi4py import MPI

import dolfinx
import numpy as np
import numpy.typing as npt

from fem_lie import _compat
from fem_lie._arrays import Array, Indices
from fem_lie.mesh.volumes import entities_at

Scalar = TypeVar("Scalar", bound=np.generic)
Tags: TypeAlias = "dolfinx.mesh.MeshTags | None"


class _Input(NamedTuple):
    """Points and cells from which a distributed mesh was created, on each process.

    Attributes:
        numbers: Number of each point in the input, ascending, shape (n,).
        points: The points, shape (n, gdim).
        of_cells: Number of each cell in the input, ascending, shape (m,).
        cells: Points of each cell in DOLFINx's order, as positions in ``numbers``, shape (m, k).
    """

    numbers: Indices
    points: Array
    of_cells: Indices
    cells: Indices

    @classmethod
    def of(cls, mesh: dolfinx.mesh.Mesh) -> _Input:
        """The input of a mesh; points that DOLFINx has cut in two are one again."""
        geometry, comm = mesh.geometry, mesh.comm
        owned, number = geometry.index_map().size_local, geometry.input_global_indices
        numbers, first = np.unique(_joined(comm, number[:owned]), return_index=True)
        points = _joined(comm, geometry.x[:owned, : geometry.dim])[first]
        count = mesh.topology.index_map(mesh.topology.dim).size_local
        of_cells = _joined(comm, np.asarray(mesh.topology.original_cell_index[:count]))
        cells = _joined(comm, number[_compat.geometry_dofmap(mesh)[:count]])
        order = np.argsort(of_cells)
        return cls(numbers, points, of_cells[order], np.searchsorted(numbers, cells[order]))


def _joined(comm: MPI.Intracomm, values: npt.NDArray[Scalar]) -> npt.NDArray[Scalar]:
    """Rows of all processes, in their order."""
    parts: list[npt.NDArray[Scalar]] = comm.allgather(values)
    return np.concatenate(parts)


def collected(mesh: dolfinx.mesh.Mesh, *tags: Tags) -> tuple[dolfinx.mesh.Mesh, list[Tags]]:
    """The mesh and its tags on this process alone: unchanged if it is on one process.

    Otherwise each process gets all of it, in an order of cells and nodes of its own. All processes
    of the mesh have to call it together.

    Args:
        mesh: Mesh of one cell type.
        tags: Tags of its entities, or ``None``.
    """
    if mesh.comm.size == 1 or len(_compat.kinds_of_cells(mesh)) != 1:  # others are refused
        return mesh, list(tags)
    found = _Input.of(mesh)
    if mesh.topology.dim == 1 and mesh.geometry.dim == 3:
        own = _compat.create_line_mesh(found.points, found.cells)
    else:
        degree = mesh.ufl_domain().ufl_coordinate_element().degree
        name = _compat.cell_name(mesh.ufl_domain())
        own = _compat.create_surface_mesh(found.points, found.cells, name, degree)
    return own, [None if each is None else _tags(mesh, each, found, own) for each in tags]


def _tags(
    mesh: dolfinx.mesh.Mesh, tags: dolfinx.mesh.MeshTags, found: _Input, own: dolfinx.mesh.Mesh
) -> dolfinx.mesh.MeshTags:
    """Tags of the distributed mesh for the mesh on this process."""
    topology, dim = mesh.topology, tags.dim
    topology.create_connectivity(dim, topology.dim)
    topology.create_connectivity(topology.dim, dim)
    here = tags.indices < topology.index_map(dim).size_local
    indices, values = tags.indices[here], _joined(mesh.comm, tags.values[here])
    if dim == topology.dim:
        numbers = _joined(mesh.comm, np.asarray(topology.original_cell_index)[indices])
        at = np.argsort(own.topology.original_cell_index)
        entities = at[np.searchsorted(found.of_cells, numbers)]
    else:
        entities, values = _at_corners(own, dim, _corners(mesh, dim, indices, found, own), values)
    order = np.argsort(entities)
    kinds = values[order].astype(np.int32)
    return dolfinx.mesh.meshtags(own, dim, entities[order].astype(np.int32), kinds)


def _corners(
    mesh: dolfinx.mesh.Mesh,
    dim: int,
    indices: npt.NDArray[np.int32],
    found: _Input,
    own: dolfinx.mesh.Mesh,
) -> Indices:
    """Geometry nodes in ``own`` of the corners of entities of all processes, flat."""
    corners = np.empty(0, np.int32)  # DOLFINx divides by the number of entities
    if len(indices):
        nodes = dolfinx.mesh.entities_to_geometry(mesh, dim, indices)
        # those of second order come last
        vertices = len(mesh.topology.connectivity(dim, 0).links(0)) if dim else 1
        corners = nodes[:, :vertices].ravel()
    numbers = _joined(mesh.comm, mesh.geometry.input_global_indices[corners])
    node = np.argsort(own.geometry.input_global_indices)
    return np.asarray(node[np.searchsorted(found.numbers, numbers)])


def _at_corners(
    own: dolfinx.mesh.Mesh, dim: int, corners: Indices, values: npt.NDArray[np.int32]
) -> tuple[Indices, npt.NDArray[np.int32]]:
    """Entities with these corners, and their tags."""
    each = corners.reshape(len(values), len(corners) // max(len(values), 1))
    kinds = np.unique(values)
    entities = [entities_at(own, dim, each[values == kind]) for kind in kinds]
    counts = [len(of_kind) for of_kind in entities]
    return np.concatenate([np.empty(0, np.int64), *entities]), np.repeat(kinds, counts)
