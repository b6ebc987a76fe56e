"""Some cells of a shell, each on nodes of its own, with weights."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.bodies.shells.assembly import ShellAssembly, ShellData
from fem_lie.elements.shells.element import ShellFormulation
from fem_lie.mesh.surfaces import SurfaceMesh

if TYPE_CHECKING:
    import dolfinx


@dataclass(eq=False)
class SurfaceCellsApart:
    """See :class:`~fem_lie.bodies.shells.assembly.ShellData`; the mesh tells the kind of cells."""

    frames: Array
    mesh: SurfaceMesh
    connectivity: Indices
    stiffness: Array
    axes: Array
    formulation: ShellFormulation
    has_mass: bool = False
    source: dolfinx.mesh.Mesh | None = None

    def element_inertia(self) -> Array:
        """None."""
        return np.empty((0, 0, 4, 0, 4))


def surface_cells_apart(body: ShellData, cells: Indices, weights: Array) -> ShellAssembly:
    """Some cells, their energy times weights (s,); see :meth:`~.body.Body.cells_apart`."""
    nodes = body.connectivity[cells]
    apart = SurfaceCellsApart(
        frames=body.frames[nodes.ravel()],
        mesh=body.mesh,
        connectivity=np.arange(nodes.size).reshape(nodes.shape),
        stiffness=weights[:, np.newaxis, np.newaxis] * body.stiffness[cells],
        axes=body.axes[cells],
        formulation=body.formulation,
    )
    return ShellAssembly([apart])
