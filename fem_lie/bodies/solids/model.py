"""Model of a solid: nodes with positions, cells, materials, assembly."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from copy import copy
from functools import cached_property
from typing import Any

import dolfinx
import numpy as np
import numpy.typing as npt
from dolfinx import fem

from fem_lie._arrays import Array, Indices, diameter, instance, log_coincident, numbers
from fem_lie.attachments.attachment import AttachmentFrame
from fem_lie.attachments.patch import averaging_attachment
from fem_lie.bodies.model import NO_HOLDS, HeldRotation, Holds, LagrangeNodes
from fem_lie.bodies.per_cell import of_groups
from fem_lie.bodies.position_model import PositionModel
from fem_lie.bodies.solids.assembly import SolidAssembly
from fem_lie.bodies.solids.faces import Faces, faces_of, nodes_on
from fem_lie.elements.solids.element import SolidFormulation, default_formulation
from fem_lie.elements.solids.stretch import inverse_stretch
from fem_lie.mesh.volumes import VolumeMesh, VolumeRule
from fem_lie.sections.material import Damping
from fem_lie.sections.solid_materials import SolidMaterial

_ORTHONORMAL = 1e-8

SolidMaterials = SolidMaterial | Mapping[str, SolidMaterial]


class SolidModel(PositionModel):
    """Model of a solid.

    Attributes:
        mesh: Unloaded mesh.
        degree: Degree of the interpolation of positions.
        connectivity: Nodes of each cell, shape (m, k).
        positions: Unloaded positions of the nodes, shape (n, 3).
        material: Constitutive law of all cells.
        parameters: Parameters of the law in each cell, shape (m, p).
        density: Mass density of each cell, shape (m,).
        has_mass: Whether all cells have a density.
        formulation: Finite element.
        damping: Damping of motion and of strain.
        space: Lagrange space on the unloaded mesh whose nodes are those of the body.
        rule: Quadrature rule of the cells.
        strained: Whether its assembly takes stress-free strains.
    """

    dimension = 3
    strained: bool = False

    def __init__(
        self,
        mesh: VolumeMesh,
        degree: int,
        material: SolidMaterials,
        formulation: SolidFormulation | None,
        damping: Damping,
        class_name: str,
        name: str,
    ) -> None:
        """Create the nodes.

        Args:
            mesh: Volume mesh.
            degree: Degree of the interpolation, 1 or 2.
            material: Material of all cells, or one for each named group, all of one law.
            formulation: Finite element; default: that of the cells and materials.
            damping: Damping of motion and of strain.
            class_name: Name of the class of the body.
            name: Name in messages and results.

        Raises:
            ValueError: A cell has no material or another law, or the element does not support the
                cells.
            TypeError: A material has an unexpected type.
        """
        self.degree, self.mesh, self.source = degree, mesh, mesh.mesh
        materials = self._take(material)
        if formulation is None:
            formulation = default_formulation(mesh.cell, degree, materials)
        self.formulation, self.damping = formulation, damping
        self.formulation.check(mesh.cell, degree)
        self.space = fem.functionspace(mesh.mesh, ("P", degree))
        self.connectivity: Indices = self.space.dofmap.list.astype(np.int64)
        self.rule = VolumeRule.of(mesh.mesh, degree)
        positions: Array = self.space.tabulate_dof_coordinates()
        self.positions = positions
        frames = np.concatenate(
            [positions[:, np.newaxis], np.tile(np.eye(3), (len(positions), 1, 1))], 1
        )
        super().__init__(
            frames,
            class_name=class_name,
            size=diameter(positions),
            points=self._points_by_name(),
            name=name,
        )
        log_coincident(self.label, positions)
        self.faces = self.boundary.drawn()
        self.thickness = np.zeros(len(self.faces))

    def _take(self, material: SolidMaterials) -> list[SolidMaterial]:
        """Set law, parameters and density of the cells; return the distinct materials."""
        count = self.mesh.cells
        expected = (
            "a SolidMaterial such as fl.sections.SaintVenantKirchhoff(E, nu, density) or NeoHooke"
        )
        if isinstance(material, Mapping):
            kind: Any = SolidMaterial
            each = of_groups(material, kind, expected, count, self.mesh.group)
        else:
            instance(material, SolidMaterial, "Solid: material", expected + " or one per group")
            each = [material] * count
        self.material = each[0]
        for other in each:
            alike = len(other.parameters) == len(self.material.parameters)
            if other.law != self.material.law or not alike:
                raise ValueError(
                    "all cells of a Solid have one law, and differ in its parameters and density: "
                    f"got {self.material} and {other}; join two Solids instead"
                )
        self.parameters = np.array([of.parameters for of in each], dtype=np.float64)
        self.has_mass = all(bool(of.density) for of in each)
        self.density = np.array([0.0 if of.density is None else of.density for of in each])
        return list({id(of): of for of in each}.values())

    def _points_by_name(self) -> dict[str, int]:
        """Nodes of the named points that are one node each."""
        named = {key: nodes_on(self.space, *self.mesh.part(key)) for key in self.mesh.named_points}
        return {key: int(nodes[0]) for key, nodes in named.items() if len(nodes) == 1}

    @cached_property
    def boundary(self) -> Faces:
        """All facets of the boundary."""
        topology = self.mesh.mesh.topology
        topology.create_connectivity(2, 3)
        facets = dolfinx.mesh.exterior_facet_indices(topology)
        return faces_of(self.space, facets.astype(np.int64), self.degree)

    @property
    def assembly_key(self) -> Hashable:
        """The solid itself: each solid is assembled on its own mesh."""
        return self

    @property
    def divisible_cells(self) -> Indices | None:
        """Nodes of each cell."""
        return self.connectivity

    def restricted(self, cells: Indices, holds: Sequence[HeldRotation]) -> tuple[Any, Indices]:
        """Model of some of its cells, see :class:`~fem_lie.bodies.model.BodyModel`.

        Args:
            cells: Indices of the cells, ascending, shape (s,).
            holds: Rotations of nodes of the whole body that joints, motions and moments act on.
        """
        mesh, numbers = self.mesh.restricted(cells)
        space = fem.functionspace(mesh.mesh, ("P", self.degree))
        connectivity: Indices = space.dofmap.list.astype(np.int64)
        nodes: Indices = np.empty(int(connectivity.max()) + 1, dtype=np.int64)
        nodes[connectivity] = self.connectivity[numbers]
        part = self._on_nodes(nodes)
        part.mesh, part.space, part.connectivity = mesh, space, connectivity
        part.positions, part.rule = self.positions[nodes], VolumeRule.of(mesh.mesh, self.degree)
        part.parameters, part.density = self.parameters[numbers], self.density[numbers]
        part.__dict__.pop("boundary", None)
        return part, nodes

    @property
    def strains_shape(self) -> tuple[int, int]:
        """Shape (m, 6) of stress-free strains (E₁₁, E₂₂, E₃₃, 2E₁₂, 2E₁₃, 2E₂₃) of the cells."""
        return self.mesh.cells, 6

    def require_eigenstrain(self, what: str) -> None:
        """Raise ``ValueError`` if the elements do not take stress-free strains.

        Args:
            what: What the user asked for, for the message.
        """
        self.formulation.require_eigenstrain(what)

    def check_strain(self, strain: Array) -> None:
        """Raise ``ValueError`` if a stress-free strain, shape (6,), is not that of a stretch.

        Args:
            strain: The strain.
        """
        inverse_stretch(strain[np.newaxis], self.label)

    def thermal_strain(
        self, expansion: float, rise: float, gradient: Array | float, what: str
    ) -> Array:
        """Green's strain of a cell that is warmer by ``rise`` and free of stress, shape (6,).

        Args:
            expansion: Coefficient of thermal expansion, in all directions.
            rise: Temperature change.
            gradient: 0.
            what: Name of the gradient, for messages.

        Raises:
            ValueError: A gradient is given.
        """
        if np.any(gradient):
            raise ValueError(
                f"{what} needs a section, which a Solid does not have: give groups of cells "
                "a Temperature each"
            )
        extension = expansion * rise
        return (extension + 0.5 * extension**2) * np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])

    def with_strains(self) -> SolidModel:
        """The same model, whose assembly takes stress-free strains."""
        strained = copy(self)
        strained.strained = True
        return strained

    @classmethod
    def assemble(cls, models: Sequence[Any], holds: Holds = NO_HOLDS) -> SolidAssembly:
        """Assembly of the only body."""
        (model,) = models
        return SolidAssembly(model)

    @property
    def volume(self) -> float:
        """Unloaded volume."""
        return float(self.rule.volumes.sum())

    def lagrange_nodes(self) -> LagrangeNodes:
        """Degrees of freedom of the space."""
        return LagrangeNodes(self.mesh.mesh, self.degree, self.connectivity)

    def nodes(self, where: str) -> Indices:
        """Numbers of the nodes of a named face, curve, point or group of cells.

        Args:
            where: Name of the point, curve, face or group.
        """
        return nodes_on(self.space, *self.mesh.part(where))

    def facets(self, name: str) -> Faces:
        """Facets of a named face, as surface cells.

        Args:
            name: Name of the face.

        Raises:
            ValueError: There is no such face; the message lists those that exist.
        """
        return faces_of(self.space, self.mesh.face(name), self.degree)

    def mean_frame(self, name: str, axes: npt.ArrayLike) -> AttachmentFrame:
        """Mean frame of the nodes of a named set.

        Args:
            name: Name of the set.
            axes: Unloaded axes of the frame as rows, shape (3, 3).

        Raises:
            ValueError: The nodes are collinear, or the axes are not right-handed and orthonormal.
        """
        nodes = self.nodes(name)
        weights: Array = np.ones(len(nodes))
        if name in self.mesh.faces:
            faces, total = self.facets(name), np.zeros(len(self.frames))
            np.add.at(total, faces.nodes, faces.consistent_areas(self.positions))
            weights = total[nodes]
        chosen = numbers(axes, f"axes of {self.label}.{name}")
        if chosen.shape != (3, 3) or not _is_rotation(chosen):
            raise ValueError(
                f"axes of {self.label}.{name}: expected three orthonormal, right-handed rows, "
                f"got\n{chosen}"
            )
        return averaging_attachment(
            [int(node) for node in nodes], self.positions[nodes], weights, chosen
        )

    def cells_of(self, group: str | None = None) -> Indices:
        """Cells of a named group (default: all).

        Args:
            group: Name of the group; default: all.

        Raises:
            ValueError: There is no such group; the message lists those that exist.
        """
        return np.arange(self.mesh.cells) if group is None else self.mesh.group(group)


def _is_rotation(axes: Array) -> bool:
    gap = np.abs(axes @ axes.T - np.eye(3)).max()
    return bool(gap <= _ORTHONORMAL and np.linalg.det(axes) > 0.0)
