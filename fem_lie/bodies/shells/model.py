"""Model of shells with shear: nodes, cells, drilling rotations, assembly."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from typing import Any, NamedTuple

import basix
import numpy as np

from fem_lie._arrays import Array, Indices, number
from fem_lie.bodies.model import NO_HOLDS, HeldRotation, Holds, RotationLimit
from fem_lie.bodies.per_cell import of_cells, of_sections
from fem_lie.bodies.shells.assembly import (
    SurfaceAssembly,
    assembly_of,
    weighted_surface_cells,
)
from fem_lie.bodies.shells.placing import cut_mesh
from fem_lie.bodies.shells.surface_nodes import GivenShell, SurfaceNodes
from fem_lie.bodies.surface_model import CellsOnSurface
from fem_lie.elements.shells.drilling import (
    MEMBRANE_SHEAR,
    TWIST,
    drilling_inertia,
    drilling_stiffness,
)
from fem_lie.mesh.surfaces import SurfaceMesh


class ModelPart(NamedTuple):
    """Cells of one type of a shell.

    Attributes:
        model: Model of these cells on their nodes.
        nodes: Number in the shell of each of these nodes, shape (n,).
        points: Point of the mesh of the shell of each point of the mesh of the model, shape (p,).
        cells: Number in the shell of each cell, shape (m,).
    """

    model: ShellModel
    nodes: Indices
    points: Indices
    cells: Indices


class ShellModel(SurfaceNodes, CellsOnSurface):
    """Model of a shell with shear.

    Attributes:
        mesh: Surface mesh; its points are the first nodes of the body.
        connectivity: Nodes of each cell, shape (m, k).
        cut_mesh: Surface mesh on these nodes, cut along kinks and branches.
        stiffness: Section stiffness of each cell, shape (m, 8, 8).
        density: Mass matrix per area in (position, director) of each cell, shape (m, 2, 2).
        has_mass: Whether all cells have inertia.
        axes: Vector in each cell whose projection onto the surface is e₁ of its strains, (m, 3).
        formulation: Finite element of the cells.
        drilling: Whether nodes have a drilling rotation; ``None``: only if something needs it.
        convected_axes: Whether frames rotate about their directors with the mid-surface.
    """

    _drilling_of_whole: Array | None = None
    """Drilling stiffness of each cell, if these are some cells of a shell."""

    def __init__(self, given: GivenShell[SurfaceMesh]) -> None:
        """Create the nodes and the data of the cells.

        Args:
            given: The surface and what is on it.

        Raises:
            ValueError: A surface with ``drilling=False`` has a kink or branch.
        """
        mesh, patches, sections = given.mesh, given.patches, given.sections
        self.source, self.axes = mesh.source, given.axes
        self.stiffness = of_sections(sections, lambda s: s.stiffness)
        self.density = of_sections(sections, lambda s: s.inertia)
        self.has_mass = all(s.inertia[0, 0] > 0 for s in sections)
        (self.connectivity,) = patches.cells
        super().__init__(given)
        self.cut_mesh = cut_mesh(mesh, patches)
        self.faces = mesh.corners_of(self.connectivity)
        self.thickness = np.array([s.thickness for s in sections], dtype=np.float64)

    @property
    def assembly_key(self) -> Hashable:
        """Key of shells that are assembled together: same formulation, damping and cell type."""
        return type(self), self.formulation, self.damping, self.mesh.cell, self.mesh.degree

    @property
    def strains_shape(self) -> tuple[int, int]:
        """Shape (m, 8) of stress-free strains of the cells."""
        return len(self.stiffness), 8

    def require_eigenstrain(self, what: str) -> None:
        """Raise ``ValueError`` if the elements do not take stress-free strains.

        Args:
            what: What the user asked for, for the message.
        """
        self.formulation.require_eigenstrain(what)

    def thermal_strain(
        self, expansion: float, rise: float, gradient: Array | float, what: str
    ) -> Array:
        """Stress-free strain of a section that is warmer by ``rise + gradient z``, shape (8,).

        Args:
            expansion: Coefficient of thermal expansion, in all directions.
            rise: Temperature change at the mid-surface.
            gradient: Temperature gradient along the director.
            what: Name of the gradient, for messages.
        """
        extension, slope = expansion * rise, expansion * number(gradient, what)
        # Green's strain of the fibres, linear in z
        membrane, bending = extension + 0.5 * extension**2, (1.0 + extension) * slope
        return np.array([membrane, membrane, 0, bending, bending, 0, 0, 0])

    @property
    def element_stiffness(self) -> Array:
        """Section stiffness of each cell, shape (m, 8, 8).

        Raises:
            ValueError: The law is the user's, not that of the section.
        """
        if not self.formulation.quadratic:
            raise ValueError(
                f"{self.label}: stress resultants of a law of the user are not linear in the "
                "strains: give the strains themselves, fl.loads.Eigenstrain"
            )
        return self.stiffness

    def restricted(self, cells: Indices, holds: Sequence[HeldRotation]) -> tuple[Any, Indices]:
        """Model of some of its cells, with the drilling rotations and their stiffness of all.

        Args:
            cells: Indices of the cells, ascending, shape (s,).
            holds: Rotations of nodes of the whole body that joints, motions and moments act on.
        """
        part, nodes = super().restricted(cells, holds)
        part.mesh = self.mesh.restricted(cells)
        part.connectivity = np.searchsorted(nodes, self.connectivity[cells])
        for name in "stiffness", "density", "axes":
            setattr(part, name, of_cells(getattr(self, name), cells))
        part.thickness = self.thickness[cells]
        part.drilling, stiffness = self.drilling_for(holds)
        part._drilling_of_whole = None if stiffness is None else stiffness[cells]
        part.cut_mesh = part.mesh  # of the whole shell for results
        return part, nodes

    def drilling_stiffness(self, holds: Sequence[HeldRotation]) -> Array:
        """Drilling stiffness γ of each cell, that of the whole shell if these are some of its.

        Args:
            holds: Rotations of nodes that joints, motions and moments act on.
        """
        known = self._drilling_of_whole
        return super().drilling_stiffness(holds) if known is None else known

    def drilling_around(self, points: Sequence[int]) -> Array:
        """Drilling stiffness of each cell, shape (m,), N/m.

        Args:
            points: Points of the mesh with moments about their normals only.
        """
        if self.formulation.whole_frames:
            return self.stiffness[:, MEMBRANE_SHEAR, MEMBRANE_SHEAR]
        areas = self._measure()[1].sum(axis=1)
        return drilling_stiffness(self.stiffness, areas, self.mesh.cells, points)

    def present(self) -> Iterator[ModelPart]:
        """The whole model, as the only part."""
        counts = len(self.frames), len(self.mesh.points), len(self.connectivity)
        yield ModelPart(self, *map(np.arange, counts))

    def of_shell(self, shell: SurfaceNodes, nodes: Indices, drilling: Array | None) -> ShellModel:
        """Copy on the present nodes of a shell with cells of other types, too.

        Args:
            shell: The shell.
            nodes: Number in the shell of each node, shape (n,).
            drilling: Drilling stiffness of each cell, shape (m,); ``None``: no drilling rotation.
        """
        part = self._on_nodes(np.arange(len(self.frames)))
        part.frames, part.drilling = shell.frames[nodes], drilling is not None
        part.faces, part.thickness = self.faces, self.thickness
        part._drilling_of_whole = drilling
        return part

    @classmethod
    def assemble(cls, models: Sequence[ShellModel], holds: Holds = NO_HOLDS) -> SurfaceAssembly:
        """Assembly of shells of one :attr:`assembly_key`, with drilling if the first needs it."""
        if not models[0].has_drilling(holds.get(models[0], ())):
            return assembly_of(models)
        each = [model.drilling_stiffness(holds.get(model, ())) for model in models]
        return assembly_of(models, np.concatenate(each))

    @property
    def elastic_cells(self) -> Indices:
        """Nodes of each cell with strain energy, shape (m, k)."""
        return self.connectivity

    def weighted_cells(self, cells: Indices, weights: Array) -> SurfaceAssembly:
        """Assembly of some cells with weighted energies, without drilling.

        Args:
            cells: Indices of the cells, shape (s,).
            weights: Factor of the energy of each, shape (s,).
        """
        return weighted_surface_cells(self, cells, weights)

    def rotation_limit(self) -> RotationLimit:
        """Edges of the cells, along which rotations are limited."""
        ends = np.array(basix.topology(basix.CellType[self.mesh.cell])[1])
        along, limit = self.connectivity[:, ends], self._largest_turn()
        if self.mesh.degree == 2:
            corners = len(self.mesh.corners[0])
            inside = self.connectivity[:, corners : corners + len(ends), np.newaxis]
            along = np.concatenate([along[:, :, :1], inside, along[:, :, 1:]], axis=2)
        elements = np.repeat(np.arange(len(along)), len(ends))
        return RotationLimit(along.reshape(len(elements), -1), elements, limit, whole=False)

    def _largest_turn(self) -> float:
        """Largest rotation along an edge of a cell that the element represents, rad."""
        return self.formulation.measures_for(self.mesh.cell, self.mesh.degree).largest_turn

    def element_drilling_inertia(self, drilling: Array) -> Array:
        """Rotary inertia of drilling rotations of each cell, shape (m, k, 4, k, 4).

        The rotary inertia about axes in the surface does not change.

        Args:
            drilling: Drilling stiffness γ of each cell, shape (m,), N/m.
        """
        areas, twist = self._measure()[1].sum(axis=1), self.stiffness[:, TWIST, TWIST]
        J = drilling_inertia(self.density, drilling, twist, areas)
        diagonal = np.array([0.0, 0.5, 0.5, -0.5])
        return self._integrated(J[:, np.newaxis, np.newaxis] * np.diag(diagonal))
