"""ANCF shells: positions and all three position gradients, with transverse shear."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Flags, Indices, instance, text
from fem_lie.bodies.cells.assembly import assemble_cells
from fem_lie.bodies.model import NO_HOLDS, Holds
from fem_lie.bodies.thin_shells.given_sections import ThinSections
from fem_lie.bodies.thin_shells.smooth_surface import Direction, SmoothSurface, SmoothSurfaceModel
from fem_lie.elements.gradients import plate
from fem_lie.elements.gradients.plate import AncfPlate
from fem_lie.forms.small_energy.assembly import ElementAssembly
from fem_lie.mesh.bicubic.patch_coupling import Joined
from fem_lie.mesh.bicubic.smooth_patch import SmoothPatch
from fem_lie.mesh.bicubic.spline_mesh import surface_of
from fem_lie.sections.material import Damping


class AncfShellModel(SmoothSurfaceModel):
    """Model of an ANCF shell.

    Attributes:
        formulation: Finite element.
        section_mass: Mass matrix of (r, d) per area of each cell, shape (m, 2, 2).
    """

    table = staticmethod(plate.table)
    has_thickness_director = True

    def __init__(
        self,
        surface: Joined,
        section: ThinSections,
        along: npt.ArrayLike | Direction | None,
        formulation: AncfPlate,
        damping: Damping,
        class_name: str,
        name: str,
    ) -> None:
        """Create the nodes and the mass of the sections; see the base class.

        Args:
            surface: Patches with joined edges.
            section: One for all cells, one for each patch, or a function of the centre of a cell.
            along: e₁ of the section axes before projection onto the surface.
            formulation: Finite element.
            damping: Mass-proportional damping.
            class_name: Name of the class of the body.
            name: Name in messages and results.
        """
        self.formulation = formulation
        super().__init__(surface, section, along, damping, class_name, name)
        self.section_mass = np.array([section.inertia for section in self.sections])

    def surface_rule(self) -> tuple[Array, Array, Array]:
        """Quadrature rule of the formulation."""
        return self.formulation.surface_rule()

    def fourth_vectors(self, surface: Joined) -> tuple[Array, Array]:
        """Unit normals, and unit factors.

        Args:
            surface: The surface.

        Raises:
            ValueError: The mesh has hanging nodes.
        """
        if surface.hanging.any():
            raise ValueError(
                "AncfShell: expected a mesh without hanging nodes, got a SplineMesh with hanging "
                "nodes, which a ThinShell supports"
            )
        n = np.cross(surface.nodal_vectors[:, 1], surface.nodal_vectors[:, 2])
        sizes = np.linalg.norm(n, axis=1, keepdims=True)
        return np.asarray(n / sizes), np.asarray(np.ones(len(surface.sizes)))

    @property
    def node_lengths(self) -> Flags:
        """Mask of vector unknowns that are lengths: only positions, shape (n, 2)."""
        lengths = super().node_lengths
        lengths[self.points_count :] = False
        return lengths

    @property
    def assembly_key(self) -> Hashable:
        """Key of shells that are assembled together: same class and formulation."""
        return type(self), self.formulation

    @classmethod
    def assemble(cls, models: Sequence[Any], holds: Holds = NO_HOLDS) -> ElementAssembly:
        """Assembly of all bodies of one :attr:`assembly_key`."""
        return assemble_cells(plate.ELEMENT, plate.FUNCTIONS, models)

    @property
    def element_nodes(self) -> Indices:
        """Nodes of each cell, shape (m, 8)."""
        return self.connectivity

    def element_data(self) -> Array:
        """Data of the cells, which are unloaded in their initial configuration."""
        q = self.hermite_vectors()
        C = self.formulation.stiffness(q, self.axes, self.stiffness)
        return plate.data(q, self.hermite_matrices(), C)

    def element_inertia(self) -> Array:
        """Mass matrix in the nodal coordinates of each cell, shape (m, 8, 4, 8, 4)."""
        return self.nodal_matrices(
            self.formulation.inertia(self.hermite_vectors(), self.section_mass)
        )


class AncfShell(SmoothSurface):
    """Shell on smooth patches without rotations: fully parametrised ANCF plate, sheared and thick.

    A point has a position, the derivatives ``∂u, ∂v`` in parameters that are lengths, and the
    gradient ``d`` across the thickness, which is the unit normal without load. It is two nodes:
    rows 0 and 1 of ``frames[i]`` are position and ∂u, rows 1 and 2 of ``frames[points + i]`` ``d``
    and ∂v. Constructors, supports and loads are those of a :class:`~fem_lie.ThinShell`; sections
    have transverse shear, too.

    Example:
        >>> flat = fl.mesh.smooth_patch(lambda a, b: np.array([a, b, 0.0]), (2, 2))
        >>> plate = fl.AncfShell(flat, fl.ShellSection.layer(0.1, fl.Material(2e11, 0.3, 7e3)))
        >>> plate.frames.shape
        (18, 4, 3)
    """

    model: AncfShellModel

    def __init__(
        self,
        patches: SmoothPatch | Mapping[str, SmoothPatch],
        section: ThinSections,
        *,
        along: npt.ArrayLike | Direction | None = None,
        formulation: AncfPlate | None = None,
        damping: Damping | None = None,
        joined: bool | None = None,
        name: str = "",
    ) -> None:
        """Create the nodes; arguments are those of a :class:`~fem_lie.ThinShell`.

        Args:
            patches: One patch, or several by names, which prefix those of edges and corners; or a
                spline mesh without hanging nodes.
            section: One for all cells, one for each patch, or a function of the centre of a cell,
                shape (3,).
            along: e₁ of the section axes before projection onto the surface: one vector, or a
                function of the centre of a cell; default: along a.
            formulation: Finite element; default: :class:`~fem_lie.elements.AncfPlate`.
            damping: Mass-proportional damping.
            joined: Whether coincident edges are joined smoothly; default: if there are several
                patches.
            name: Name in messages and results.

        Raises:
            ValueError: As of a thin shell; or the mesh has hanging nodes.
            TypeError: An argument has an unexpected type.
        """
        instance(formulation, AncfPlate | None, "AncfShell: formulation", "an AncfPlate or None")
        element = AncfPlate() if formulation is None else formulation
        text(name, "AncfShell: name")
        surface = surface_of(patches, joined, (), name or "AncfShell")
        damping, names = Damping.of_mass(damping, "AncfShell"), (type(self).__name__, name)
        super().__init__(AncfShellModel(surface, section, along, element, damping, *names))
