"""Results as DOLFINx functions on the mesh of a body, and as VTX files.

The mesh is the DOLFINx mesh from which the body was made. Bodies that were made otherwise, and
those of results from files, get a mesh of the cells that are drawn: lines, or the faces of a
surface.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import dolfinx
import numpy as np
from dolfinx import fem

from fem_lie import _compat
from fem_lie._arrays import Array, Indices, instance
from fem_lie.bodies.body import Body
from fem_lie.bodies.catalogue import SceneInfo

NodalFields = Mapping[str, Array]
"""Vectors of all nodes by name, global components, each of shape (N, 3)."""

_AROUND: dict[int, tuple[str, tuple[int, ...]]] = {
    2: ("interval", (0, 1)),
    3: ("triangle", (0, 1, 2)),
    4: ("quadrilateral", (0, 1, 3, 2)),
}
"""Cell with this number of corners, and where each of DOLFINx's corners is in cyclic order."""


@dataclass(frozen=True, eq=False)
class BodyMesh:
    """A mesh of a body for nodal fields.

    Attributes:
        space: Lagrange space of vectors on the undeformed mesh.
        nodes: Node of the scene at each degree of freedom of each cell, shape (m, k).
    """

    space: fem.FunctionSpace
    nodes: Indices

    @classmethod
    def of(cls, body: Body | str, scene: SceneInfo) -> BodyMesh:
        """Mesh of a body.

        Args:
            body: The body, for the mesh that it was made from; or its name.
            scene: Nodes of all bodies, and cells that are drawn.

        Raises:
            ValueError: There is no such body, it has no cells, or no recorded undeformed
                configuration.
            TypeError: It is neither a body nor a name.
        """
        instance(body, Body | str, "body", "a body of the scene, or its name")
        info = scene.body(body if isinstance(body, str) else body.name)
        if isinstance(body, Body) and (own := body.model.lagrange_nodes()) is not None:
            return cls(_vectors(own.mesh, own.degree), info.nodes[own.nodes])
        drawn = _of_one_type(info.faces) if len(info.faces) else info.cells
        cell, order = _AROUND[drawn.shape[1]]
        if not len(drawn):
            raise ValueError(
                f"expected a body with a mesh, got {info.kind} {info.name!r}, which has no cells; "
                "its motion is in to_dataframe() and write_csv()"
            )
        used, cells = np.unique(drawn[:, order], return_inverse=True)
        points, cells = scene.undeformed[used, 0], cells.reshape(drawn.shape).astype(np.int64)
        if cell == "interval":
            mesh = _compat.create_line_mesh(points, cells)
        else:
            mesh = _compat.create_surface_mesh(points, cells, cell, 1)
        numbers = mesh.geometry.input_global_indices[_compat.geometry_dofmap(mesh)]
        return cls(_vectors(mesh, 1), used[numbers])

    def functions(self, fields: NodalFields) -> dict[str, fem.Function]:
        """A function of each field, under its name."""
        return {name: self._function(name, values) for name, values in fields.items()}

    def _function(self, name: str, values: Array) -> fem.Function:
        f = fem.Function(self.space, name=name)
        f.x.array.reshape(-1, 3)[self.space.dofmap.list] = values[self.nodes]
        return f

    def write_vtx(
        self,
        path: str | os.PathLike[str],
        along: Iterable[float],
        fields: Callable[[int], NodalFields],
    ) -> None:
        """Write a time series for ParaView's VTX reader.

        Args:
            path: Name of the ``.bp`` folder.
            along: Time or load factor of each state, or number of each mode.
            fields: Fields of a state; their names are the same for all.
        """
        functions = self.functions(fields(0))
        comm = self.space.mesh.comm
        with dolfinx.io.VTXWriter(comm, Path(path), list(functions.values())) as writer:
            for k, at in enumerate(along):
                for name, f in self.functions(fields(k)).items():
                    functions[name].x.array[:] = f.x.array
                writer.write(float(at))


def _of_one_type(faces: Indices) -> Indices:
    """Faces, all cut into triangles if triangles are among quadrilaterals, with a corner twice."""
    three = faces[:, -1] == faces[:, -2]
    if not three.any():
        return faces
    return np.concatenate([faces[:, :3], faces[~three][:, [0, 2, 3]]])


def _vectors(mesh: dolfinx.mesh.Mesh, degree: int) -> fem.FunctionSpace:
    return fem.functionspace(mesh, ("Lagrange", degree, (3,)))
