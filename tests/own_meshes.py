"""Meshes of DOLFINx as users make them, from points and cells on this process."""

from mpi4py import MPI

import basix.ufl
import dolfinx
import numpy as np


def own_mesh(points, cells, cell: str, comm=MPI.COMM_SELF) -> dolfinx.mesh.Mesh:
    """Mesh in space of first degree, of cells in DOLFINx's order."""
    element = basix.ufl.element("Lagrange", cell, 1, shape=(3,))
    cells = np.asarray(cells, dtype=np.int64)
    return dolfinx.mesh.create_mesh(comm, cells=cells, x=np.asarray(points, float), e=element)


def mesh_of(body) -> dolfinx.mesh.Mesh:
    """Mesh of the forms of a body that is alone."""
    return body.model.assemble([body.model]).forms.increment.function_space.mesh
