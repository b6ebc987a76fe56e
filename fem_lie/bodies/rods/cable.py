"""Cables: positions and position gradients along smooth lines."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import instance, positive
from fem_lie.bodies.beams.line_body import Placed
from fem_lie.bodies.rods.cable_body import CableBody, CableModel, successive
from fem_lie.elements.beams.element import BeamFormulation
from fem_lie.elements.rods.cable import HermiteCable
from fem_lie.mesh.curves import curve, straight_line
from fem_lie.mesh.lines import LineMesh
from fem_lie.mesh.reading import line_of
from fem_lie.sections.material import Damping
from fem_lie.sections.orientation import Chains, cell_frames, shared_nodes
from fem_lie.sections.section import Section

if TYPE_CHECKING:
    import dolfinx


class Cable(CableBody):
    """Cable along smooth lines: axial and bending stiffness, without shear and torsion.

    Its nodes are the points of the mesh. Each has a position and a position gradient ``x' = dx/ds``
    per unstretched length, rows 0 and 1 of ``frames``; rows 2 and 3 complete the axes, which rotate
    with the tangent by the smallest rotation. Velocities and constraints are along ``x'/|x'|`` and
    these rows. The cable is naturally straight: laid along a curve, it has bending moments.

    :meth:`clamp` and :class:`~fem_lie.Clamp` hold position and direction, :meth:`pin` the position
    only. Joints act on a node as on a frame along its tangent that does not rotate about it:
    :class:`~fem_lie.joints.Spherical` holds the position, :class:`~fem_lie.joints.Revolute` about
    the tangent the direction, too. Forces may act at nodes and along the cable, moments may not.
    This holds for :class:`~fem_lie.elements.HermiteCable`; nodes of
    :class:`~fem_lie.elements.DiscreteCable` have positions only, which :meth:`clamp`, :meth:`pin`
    and spherical joints hold.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> tube = fl.Section.circle(0.01, steel)
        >>> rope = fl.Cable.straight((0, 0, 0), (1, 0, 0), tube, cells=4)
        >>> rope.pin(rope.point("start"), rope.point("end"))
        >>> len(rope.frames)
        5
    """

    def __init__(
        self,
        mesh: LineMesh | dolfinx.mesh.Mesh,
        section: Section,
        *,
        length: float | None = None,
        formulation: BeamFormulation | None = None,
        damping: Damping | None = None,
        name: str = "",
    ) -> None:
        """Create the nodes.

        Args:
            mesh: Line in its initial position, without corners and branches; or a DOLFINx mesh of
                intervals in space.
            section: Its axial stiffness ``EA``, bending stiffness ``EI``, equal about all axes, and
                mass per length are used.
            length: Unstretched length of the whole cable; default: that of the line.
            formulation: Finite element: :class:`~fem_lie.elements.HermiteCable` (default) or
                :class:`~fem_lie.elements.DiscreteCable`.
            damping: Damping of motion, axial strain and bending; of the six relaxation times the
                first and the last two are used, and the last two must be equal.
            name: Name in messages and results.

        Raises:
            ValueError: The line has corners or branches, the element does not support the section,
                the nodes of the element are frames, bending damping differs between axes, or the
                element does not support damping of strain.
            TypeError: An argument has an unexpected type.
        """
        mesh = line_of(mesh, "Cable")
        instance(section, Section, "Cable: section", "a Section")
        instance(formulation, BeamFormulation | None, "Cable: formulation", "an element or None")
        element = HermiteCable() if formulation is None else formulation
        chains = Chains(mesh)
        ends = cell_frames(mesh, chains, None, None)
        frames, elements, masters = shared_nodes(mesh, ends)
        if len(frames) != len(mesh.points) or np.bincount(mesh.cells.ravel()).max() > 2:
            raise ValueError(
                "Cable: expected a smooth line, got one with corners or branches: make one Cable "
                "of each smooth piece, or a Net"
            )
        lengths, stretch = np.diff(chains.arc, axis=1)[:, 0], 1.0
        if length is not None:
            stretch = lengths.sum() / positive(length, "Cable: length")
            lengths = lengths / stretch
        placed = Placed(element.placed(frames, stretch), elements, lengths, masters, elements)
        names = type(self).__name__, name
        super().__init__(
            CableModel(mesh, placed, successive(elements), section, element, damping, *names)
        )

    @classmethod
    def straight(
        cls,
        start: npt.ArrayLike,
        end: npt.ArrayLike,
        section: Section,
        *,
        cells: int,
        length: float | None = None,
        formulation: BeamFormulation | None = None,
        damping: Damping | None = None,
        name: str = "",
    ) -> Cable:
        """Straight cable with ``cells`` equal elements; points "start" and "end".

        Args:
            start: First point, shape (3,).
            end: Last point, shape (3,).
            section: Cross-section.
            cells: Number of equal elements.
            length: Unstretched length; default: that of the line.
            formulation: The element; default: that of the class.
            damping: Damping; default: none.
            name: Name in messages and results.
        """
        mesh = straight_line(start, end, cells)
        return cls(
            mesh, section, length=length, formulation=formulation, damping=damping, name=name
        )

    @classmethod
    def curve(
        cls,
        function: Callable[[float], npt.ArrayLike],
        section: Section,
        *,
        cells: int,
        length: float | None = None,
        formulation: BeamFormulation | None = None,
        damping: Damping | None = None,
        name: str = "",
    ) -> Cable:
        """Cable along the curve ``function(s)``, s from 0 to 1, with points "start" and "end".

        Args:
            function: Position, shape (3,), as a function of the parameter from 0 to 1.
            section: Cross-section.
            cells: Number of equal elements.
            length: Unstretched length; default: that of the line.
            formulation: The element; default: that of the class.
            damping: Damping; default: none.
            name: Name in messages and results.
        """
        mesh = curve(function, cells)
        return cls(
            mesh, section, length=length, formulation=formulation, damping=damping, name=name
        )
