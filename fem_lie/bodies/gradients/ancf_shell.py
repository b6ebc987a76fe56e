"""ANCF shells: positions and all three position gradients, with transverse shear."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Flags, Indices, instance
from fem_lie.bodies.body import NO_HOLDS, Holds
from fem_lie.bodies.cells.assembly import assemble_cells
from fem_lie.bodies.thin_shells.given_sections import ThinSections
from fem_lie.bodies.thin_shells.smooth_surface import Direction, SmoothSurface
from fem_lie.elements.gradients import plate
from fem_lie.elements.gradients.plate import AncfPlate
from fem_lie.forms.assembly import BodyTerm
from fem_lie.mesh.bicubic.patch_coupling import Joined
from fem_lie.mesh.bicubic.smooth_patch import SmoothPatch
from fem_lie.sections.material import Damping


class AncfShell(SmoothSurface):
    """Shell on smooth patches without rotations: fully parametrised ANCF plate, sheared and thick.

    A point has a position, the derivatives ``∂u, ∂v`` in parameters that are lengths, and the
    gradient ``d`` across the thickness, which is the unit normal without load. It is two nodes:
    rows 0 and 1 of ``frames[i]`` are position and ∂u, rows 1 and 2 of ``frames[points + i]`` ``d``
    and ∂v. Constructors, supports and loads are those of a :class:`~fem_lie.ThinShell`; sections
    have transverse shear, too.

    Attributes:
        formulation: Finite element.
        section_mass: Mass matrix of (r, d) per area of each cell, shape (m, 2, 2).

    Example:
        >>> flat = fl.mesh.smooth_patch(lambda a, b: np.array([a, b, 0.0]), (2, 2))
        >>> plate = fl.AncfShell(flat, fl.ShellSection.layer(0.1, fl.Material(2e11, 0.3, 7e3)))
        >>> plate.frames.shape
        (18, 4, 3)
    """

    table = staticmethod(plate.table)
    fourth_is_director = True

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
        """Create the nodes; arguments as of :class:`~fem_lie.ThinShell`.

        Raises:
            ValueError: As of a thin shell.
            TypeError: An argument has an unexpected type.
        """
        instance(formulation, AncfPlate | None, "AncfShell: formulation", "an AncfPlate or None")
        self.formulation = AncfPlate() if formulation is None else formulation
        super().__init__(patches, section, along=along, damping=damping, joined=joined, name=name)
        self.section_mass = np.array([section.inertia for section in self.sections])

    def surface_rule(self) -> tuple[Array, Array, Array]:
        """Quadrature rule of the formulation."""
        return self.formulation.surface_rule()

    def fourth(self, surface: Joined) -> tuple[Array, Array]:
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
        n = np.cross(surface.rows[:, 1], surface.rows[:, 2])
        sizes = np.linalg.norm(n, axis=1, keepdims=True)
        return np.asarray(n / sizes), np.asarray(np.ones(len(surface.sizes)))

    @property
    def node_lengths(self) -> Flags:
        """Mask of vector unknowns that are lengths: only positions, shape (n, 2)."""
        lengths = super().node_lengths
        lengths[self.points_count :] = False
        return lengths

    @property
    def kind(self) -> Hashable:
        """Key of shells that are assembled together: same class and formulation."""
        return type(self), self.formulation

    @classmethod
    def assemble(cls, bodies: Sequence[Any], holds: Holds = NO_HOLDS) -> BodyTerm:
        """Assembly of all bodies of one :attr:`kind`."""
        return assemble_cells(plate.ELEMENT, plate.FUNCTIONS, bodies)

    @property
    def element_nodes(self) -> Indices:
        """Nodes of each cell, shape (m, 8)."""
        return self.connectivity

    def element_data(self) -> Array:
        """Data of the cells, which are unloaded in their initial configuration."""
        q = self.vectors()
        C = self.formulation.stiffness(q, self.axes, self.stiffness)
        return plate.data(q, self.extraction(), C)

    def element_inertia(self) -> Array:
        """Mass matrix in the nodal coordinates of each cell, shape (m, 8, 4, 8, 4)."""
        return self.on_nodes(self.formulation.inertia(self.vectors(), self.section_mass))
