"""Model of shells with triangles and quadrilaterals."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.bodies.canonical import data_of_model
from fem_lie.bodies.model import BodyModel, HeldRotation, RotationLimit
from fem_lie.bodies.shells.model import ModelPart, ShellModel
from fem_lie.bodies.shells.surface_nodes import GivenShell, SurfaceNodes
from fem_lie.mesh.mixed_surfaces import MixedSurfaceMesh


class MixedShellModel(SurfaceNodes):
    """Model of a shell whose cells have several types.

    Cells of one type have nodes of their own and are assembled with those of other shells of that
    type. Where types meet on a smooth side of the surface, the nodes of one have the frames of the
    other, to which they are rigidly attached: the unknowns are the same, without multipliers.

    Attributes:
        parts: Cells of each type.
        has_mass: Whether all cells have inertia.
    """

    mesh: MixedSurfaceMesh

    def __init__(self, given: GivenShell[MixedSurfaceMesh]) -> None:
        """Create the nodes and the models of the cells of each type.

        Args:
            given: The surface and what is on it.

        Raises:
            ValueError: A surface with ``drilling=False`` has a kink or branch, or the axes are to
                be convected.
        """
        mesh, sections = given.mesh, given.sections
        if given.convected_axes:
            raise ValueError(
                f"{given.name or given.class_name}: convected_axes=True needs cells of one type, "
                "got " + " and ".join(f"{part.mesh.cell}s" for part in mesh.parts)
            )
        super().__init__(given)
        self.parts = tuple(self._part(given, number) for number in range(len(mesh.parts)))
        self.has_mass = all(part.model.has_mass for part in self.parts)
        self.thickness = np.array([s.thickness for s in sections], dtype=np.float64)
        # where types meet, faces have one node: edges between them are no rim
        one = (self.frames == self.frames[self.masters]).all(axis=(1, 2))
        drawn = np.where(one, self.masters, np.arange(len(one)))
        # triangles end with their last corner twice
        corners = [drawn[part.nodes[part.model.faces]] for part in self.parts]
        most = max(each.shape[1] for each in corners)
        self.faces = np.concatenate(
            [np.pad(each, ((0, 0), (0, most - each.shape[1])), mode="edge") for each in corners]
        )

    def _part(self, given: GivenShell[MixedSurfaceMesh], number: int) -> ModelPart:
        mesh, points, cells = self.mesh.parts[number]
        patches, nodes = given.patches.of_block(number, points)
        own = GivenShell(
            mesh,
            patches,
            given.directors[nodes],
            [given.sections[cell] for cell in cells],
            given.axes[cells],
            given.formulation,
            drilling=None,
            convected_axes=False,
            damping=given.damping,
            class_name=given.class_name,
            name=f"{given.name or given.class_name}, {mesh.cell}s",
        )
        return ModelPart(ShellModel(own), nodes, points, cells)

    def present(self, holds: Sequence[HeldRotation] = ()) -> Iterator[ModelPart]:
        """Parts on the present nodes, with the drilling rotations of the whole.

        Args:
            holds: Rotations of nodes that joints, motions and moments act on.
        """
        _, drilling = self.drilling_for(holds)
        for part in self.parts:
            own = None if drilling is None else drilling[part.cells]
            yield part._replace(model=part.model.of_shell(self, part.nodes, own))

    def pieces(self, holds: Sequence[HeldRotation]) -> Iterator[tuple[BodyModel, Indices]]:
        """Models of the cells of each type, and the numbers of their nodes.

        Args:
            holds: Rotations of nodes that joints, motions and moments act on.
        """
        yield from ((part.model, part.nodes) for part in self.present(holds))

    def require_eigenstrain(self, what: str) -> None:
        """Raise ``ValueError``: strains belong to cells of one type.

        Args:
            what: What the user asked for, for the message.
        """
        cells = " and ".join(f"{part.mesh.cell}s" for part in self.mesh.parts)
        raise ValueError(f"{what} needs cells of one type, but {self.label} has {cells}")

    @property
    def contents(self) -> list[Any]:
        """Data of the parts on which the equations depend."""
        return [(part.nodes, data_of_model(part.model)) for part in self.parts]

    def drilling_around(self, points: Sequence[int]) -> Array:
        """Drilling stiffness of each cell, shape (m,), N/m.

        Args:
            points: Points of the mesh with moments about their normals only.
        """
        found = np.empty(len(self.thickness))
        for part in self.parts:
            own = np.flatnonzero(np.isin(part.points, points))
            found[part.cells] = part.model.drilling_around([int(point) for point in own])
        return found

    def rotation_limit(self) -> RotationLimit:
        """Edges of all cells, along which rotations are limited: the smallest limit of a type."""
        each = [part.model.rotation_limit() for part in self.parts]
        pairs = list(zip(self.parts, each, strict=True))
        return RotationLimit(
            np.concatenate([part.nodes[limit.nodes] for part, limit in pairs]),
            np.concatenate([part.cells[limit.elements] for part, limit in pairs]),
            min(limit.limit for limit in each),
            whole=False,
        )
