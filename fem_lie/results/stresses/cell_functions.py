"""Values in the cells of a surface mesh as DOLFINx functions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import basix.ufl
import dolfinx
import numpy as np
from dolfinx import fem

from fem_lie import _compat
from fem_lie._arrays import Array
from fem_lie.mesh.surfaces import SurfaceMesh

ElementMaker = Callable[[str, int, tuple[int, ...]], Any]
"""From cell, degree and shape of the values to an element."""


def LAGRANGE(cell: str, degree: int, shape: tuple[int, ...]) -> Any:
    """Continuous."""
    return basix.ufl.element("Lagrange", cell, degree, shape=shape)


def DISCONTINUOUS(cell: str, degree: int, shape: tuple[int, ...]) -> Any:
    """The same nodes in each cell for itself."""
    return basix.ufl.element("DG", cell, degree, shape=shape)


def quadrature(points: int) -> ElementMaker:
    """The points of integration of a rule of this degree."""

    def element(cell: str, degree: int, shape: tuple[int, ...]) -> Any:
        return basix.ufl.quadrature_element(cell, value_shape=shape, degree=points)

    return element


def dolfinx_surface(mesh: SurfaceMesh, places: Array) -> dolfinx.mesh.Mesh:
    """The mesh with its nodes at ``places`` (n, 3); DOLFINx gives cells another order."""
    return _compat.create_surface_mesh(
        np.array(places, dtype=np.float64), mesh.cells, mesh.cell, mesh.degree
    )


def cells_function(
    mesh: dolfinx.mesh.Mesh, of: SurfaceMesh, values: Array, element: ElementMaker, name: str
) -> fem.Function:
    """A function by its values in each cell.

    Args:
        mesh: From :func:`dolfinx_surface`.
        of: What that was made of.
        values: At the nodes or points of each cell of the surface, shape (m, q) or (m, q, b).
        element: What the function is made of.
        name: Its name.
    """
    chosen = element(of.cell, of.degree, values.shape[2:])
    f = fem.Function(fem.functionspace(mesh, chosen), name=name)
    rows = f.x.array.reshape(-1, *values.shape[2:])
    rows[f.function_space.dofmap.list] = values[mesh.topology.original_cell_index]
    return f
