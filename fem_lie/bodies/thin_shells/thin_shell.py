"""Thin shells: smooth surfaces without transverse shear, twelve unknowns at each point."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, instance, text
from fem_lie.bodies.model import NO_HOLDS, Holds
from fem_lie.bodies.thin_shells.assembly import ThinShellAssembly, mass_matrices
from fem_lie.bodies.thin_shells.given_sections import ThinSections
from fem_lie.bodies.thin_shells.smooth_surface import Direction, SmoothSurface, SmoothSurfaceModel
from fem_lie.elements.thin_shells.bicubic import BicubicHermite
from fem_lie.elements.thin_shells.coupling import CouplingPoints, CouplingSprings
from fem_lie.forms.assembly import BodyTerm
from fem_lie.mesh.bicubic import hermite
from fem_lie.mesh.bicubic.patch_coupling import Joined, PatchCoupling, coupling_points
from fem_lie.mesh.bicubic.smooth_patch import SmoothPatch
from fem_lie.mesh.bicubic.spline_mesh import SplineMesh, surface_of
from fem_lie.sections.material import Damping


class ThinShellModel(SmoothSurfaceModel):
    """Model of a thin shell.

    Attributes:
        points_count: Number of points; there are twice as many nodes.
        connectivity: Nodes of each cell: four with position and ∂u, then the others, shape (m, 8).
        sizes: For each cell, its sizes along u and v, their product over the area that scales the
            mixed derivative, and a code of its hanging corners, shape (m, 4).
        stiffness: Section stiffness of each cell, shape (m, 8, 8); that against shear is not used.
        density: Mass per area of each cell, shape (m,).
        axes: Vector in each cell whose projection onto the surface is e₁ of its strains, (m, 3).
        formulation: Finite element.
        couplings: Springs that couple patches.
        damping: Mass-proportional damping.
    """

    table = staticmethod(hermite.table)

    def __init__(
        self,
        surface: Joined,
        section: ThinSections,
        along: npt.ArrayLike | Direction | None,
        formulation: BicubicHermite,
        damping: Damping,
        couplings: Sequence[PatchCoupling],
        class_name: str,
        name: str,
    ) -> None:
        """Create the nodes and the springs that couple patches; see the base class.

        Args:
            surface: Patches with joined edges.
            section: One for all cells, one for each patch, or a function of the centre of a cell.
            along: e₁ of the section axes before projection onto the surface.
            formulation: Finite element.
            damping: Mass-proportional damping.
            couplings: Coincident edges with different parametrisations, coupled by springs.
            class_name: Name of the class of the body.
            name: Name in messages and results.
        """
        self.formulation = formulation
        super().__init__(surface, section, along, damping, class_name, name)
        cells = self.connectivity, self.sizes[:, :3]
        self.couplings = [
            coupling_points(coupling, ends, self.hermite_vectors(), cells, self.stiffness)
            for coupling in couplings
            for ends in [(self._edges[coupling.first], self._edges[coupling.second])]
        ]

    def surface_rule(self) -> tuple[Array, Array, Array]:
        """Quadrature rule of the formulation."""
        return self.formulation.surface_rule()

    def fourth_vectors(self, surface: Joined) -> tuple[Array, Array]:
        """Mixed derivative times the mean area of a cell, and its factor in each cell.

        Args:
            surface: The surface.
        """
        areas = surface.sizes.prod(axis=1)
        mean = float(areas.mean())
        return mean * surface.nodal_vectors[:, 3], areas / mean

    @property
    def assembly_key(self) -> Hashable:
        """Key of thin shells that are assembled together: same class and formulation."""
        return type(self), self.formulation

    @classmethod
    def assemble(cls, models: Sequence[Any], holds: Holds = NO_HOLDS) -> BodyTerm:
        """Assembly of bodies of one :attr:`assembly_key`, with springs that couple patches."""
        assembly = ThinShellAssembly(models)
        starts = np.cumsum([0, *(len(model.frames) for model in models)])
        found = [
            part._replace(nodes=part.nodes + start)
            for model, start in zip(models, starts, strict=False)
            for part in model.couplings
        ]
        if found:
            assembly.further_terms.append(
                CouplingSprings(CouplingPoints.joined(found), assembly.count)
            )
        return assembly

    def element_inertia(self) -> Array:
        """Mass matrix in the nodal coordinates of each cell, shape (m, 8, 4, 8, 4)."""
        return self.nodal_matrices(
            mass_matrices(self.formulation, self.hermite_vectors(), self.density)
        )


class ThinShell(SmoothSurface):
    """Thin (Kirchhoff-Love) shell of any section on smooth patches, without transverse shear.

    A point has a position and the derivatives ``∂u, ∂v, ∂u∂v`` in parameters that are lengths,
    which are continuous across cells. It is two nodes: rows 0 and 1 of ``frames[i]`` are position
    and ∂u, rows 1 and 2 of ``frames[points + i]`` ∂u∂v times an area and ∂v. Rows 2 and 3 of the
    first node are axes that rotate with the surface; the last is the normal. Rotary inertia is
    neglected.

    Example:
        >>> flat = fl.mesh.smooth_patch(lambda a, b: np.array([a, b, 0.0]), (2, 2))
        >>> plate = fl.ThinShell(flat, fl.ShellSection.layer(0.01, fl.Material(2e11, 0.3, 7e3)))
    """

    model: ThinShellModel

    def __init__(
        self,
        patches: SmoothPatch | Mapping[str, SmoothPatch] | SplineMesh,
        section: ThinSections,
        *,
        along: npt.ArrayLike | Direction | None = None,
        formulation: BicubicHermite | None = None,
        damping: Damping | None = None,
        joined: bool | None = None,
        couplings: Sequence[PatchCoupling] = (),
        name: str = "",
    ) -> None:
        """Create the nodes.

        Args:
            patches: One patch, with edges "a=0", "a=1", "b=0", "b=1" and corners "00", "10", "01",
                "11"; or several by names, which prefix those of edges and corners: "roof.a=0",
                "roof.00"; or a :func:`spline_mesh` of these, with cells of several sizes.
            section: One for all cells, one for each patch, or a function of the centre of a cell,
                shape (3,).
            along: e₁ of the section axes before projection onto the surface: one vector, or a
                function of the centre of a cell; default: along a.
            formulation: Finite element; default: :class:`~fem_lie.elements.BicubicHermite`.
            damping: Mass-proportional damping.
            joined: Whether coincident edges are joined smoothly; default: if there are several
                patches.
            couplings: Coincident edges with different parametrisations, coupled by springs.
            name: Name in messages and results.

        Raises:
            ValueError: There is no patch, parametrisations of joined edges do not agree, a patch
                has no section, ``along`` is normal to the surface, or there is damping of strain.
            TypeError: An argument has an unexpected type.
        """
        instance(formulation, BicubicHermite | None, "ThinShell: formulation", "an element or None")
        element = BicubicHermite() if formulation is None else formulation
        text(name, "ThinShell: name")
        surface = surface_of(patches, joined, couplings, name or "ThinShell")
        damping, names = Damping.of_mass(damping, "ThinShell"), (type(self).__name__, name)
        super().__init__(
            ThinShellModel(surface, section, along, element, damping, couplings, *names)
        )
