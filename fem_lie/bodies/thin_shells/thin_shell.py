"""Thin shells: smooth surfaces without shear, twelve unknowns at each point."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, instance
from fem_lie.bodies.body import NO_HOLDS, Holds
from fem_lie.bodies.thin_shells.assembly import ThinShellAssembly, mass_matrices
from fem_lie.bodies.thin_shells.given_sections import ThinSections
from fem_lie.bodies.thin_shells.smooth_surface import Direction, SmoothSurface
from fem_lie.elements.thin_shells.bicubic import BicubicHermite
from fem_lie.elements.thin_shells.seam import SeamPoints, SeamSprings
from fem_lie.forms.assembly import BodyTerm
from fem_lie.mesh.bicubic import hermite
from fem_lie.mesh.bicubic.patch_coupling import Joined, Seam, seam_points
from fem_lie.mesh.bicubic.smooth_patch import SmoothPatch
from fem_lie.mesh.bicubic.spline_mesh import SplineMesh
from fem_lie.sections.material import Damping


class ThinShell(SmoothSurface):
    """A thin shell of any section on smooth patches; it is not sheared across its thickness.

    A point of it has a place and the derivatives ``∂u, ∂v, ∂u∂v`` in parameters that are lengths,
    which are continuous from cell to cell. It is two nodes: row 0 and 1 of ``frames[i]`` are place
    and ∂u, rows 1 and 2 of ``frames[points + i]`` ∂u∂v times an area and ∂v. Rows 2 and 3 of the
    first are axes that follow the surface: the last is the normal. Rotary inertia is left out, as
    shear is.

    Attributes:
        points_count: Number of points; nodes are twice as many.
        connectivity: Nodes of each cell: four places with ∂u, and the others, shape (m, 8).
        sizes: Of each cell: along u, along v, their product over the area that the mixed derivative
            is multiplied by, and which of its corners hang, shape (m, 4).
        stiffness: Section stiffness of each cell, shape (m, 8, 8); shear does not count.
        density: Mass per area of each cell, shape (m,).
        axes: Vector in each cell whose projection onto the surface is e₁ of its strains, (m, 3).
        formulation: The element.
        damping: Of its motion in space.

    Example:
        >>> flat = fl.smooth_patch(lambda a, b: np.array([a, b, 0.0]), (2, 2))
        >>> plate = fl.ThinShell(flat, fl.ShellSection.layer(0.01, fl.Material(2e11, 0.3, 7e3)))
    """

    table = staticmethod(hermite.table)

    def __init__(
        self,
        patches: SmoothPatch | Mapping[str, SmoothPatch] | SplineMesh,
        section: ThinSections,
        *,
        along: npt.ArrayLike | Direction | None = None,
        formulation: BicubicHermite | None = None,
        damping: Damping | None = None,
        joined: bool | None = None,
        seams: Sequence[Seam] = (),
        name: str = "",
    ) -> None:
        """Place the nodes.

        Args:
            patches: One, whose edges are "a=0", "a=1", "b=0", "b=1" and whose corners are "00",
                "10", "01", "11"; or several by names, which stand before: "roof.a=0", "roof.00"; or
                a :func:`spline_mesh` of these, whose cells are of several sizes.
            section: One for all cells, one for each patch, or a function of the middle of a cell,
                shape (3,).
            along: e₁ of the sections' axes before projection onto the surface: one vector, or a
                function of the middle of a cell; default: along a.
            formulation: The element.
            damping: With mass only.
            joined: Whether edges that lie on each other are one, as smooth surfaces go on; default:
                those of several patches.
            seams: Edges that lie on each other with other parameters, and are sewn together.
            name: For messages and results.

        Raises:
            ValueError: There is no patch, parametrisations of edges that are to be one do not
                agree, a patch has no section, ``along`` is normal to the surface, or there is
                damping with strain.
            TypeError: An argument is of another kind than wanted.
        """
        instance(formulation, BicubicHermite | None, "ThinShell: formulation", "an element or None")
        self.formulation = BicubicHermite() if formulation is None else formulation
        super().__init__(
            patches,
            section,
            along=along,
            damping=damping,
            joined=joined,
            seams=seams,
            name=name,
        )
        cells = self.connectivity, self.sizes[:, :3]
        self.seams = [
            seam_points(seam, ends, self.vectors(), cells, self.stiffness)
            for seam in seams
            for ends in [(self._edges[seam.first], self._edges[seam.second])]
        ]

    def surface_rule(self) -> tuple[Array, Array, Array]:
        """As the element says."""
        return self.formulation.surface_rule()

    def fourth(self, surface: Joined) -> tuple[Array, Array]:
        """The mixed derivative, times the mean area of a cell."""
        areas = surface.sizes.prod(axis=1)
        mean = float(areas.mean())
        return mean * surface.rows[:, 3], areas / mean

    @property
    def kind(self) -> Hashable:
        """Thin shells of one element go together."""
        return type(self), self.formulation

    @classmethod
    def assemble(cls, bodies: Sequence[Any], holds: Holds = NO_HOLDS) -> BodyTerm:
        """All of one :attr:`kind` together, with their seams."""
        assembly = ThinShellAssembly(bodies)
        starts = np.cumsum([0, *(len(body.frames) for body in bodies)])
        found = [
            part._replace(nodes=part.nodes + start)
            for body, start in zip(bodies, starts, strict=False)
            for part in body.seams
        ]
        if found:
            assembly.further_terms.append(SeamSprings(SeamPoints.joined(found), assembly.count))
        return assembly

    def element_inertia(self) -> Array:
        """Constant matrix of the rows of each cell's nodes, shape (m, 8, 4, 8, 4)."""
        return self.on_nodes(mass_matrices(self.formulation, self.vectors(), self.density))
