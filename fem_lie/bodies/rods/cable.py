"""Cables: places and slopes along smooth lines."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import instance, positive, text
from fem_lie.bodies.beams.assembly import Damping
from fem_lie.bodies.beams.line_body import LineBody, Placed
from fem_lie.bodies.beams.orientation import Chains, cell_frames, shared_nodes
from fem_lie.bodies.body import Point
from fem_lie.bodies.points import require_point
from fem_lie.elements.beams.element import Formulation
from fem_lie.elements.rods.cable import HermiteCable
from fem_lie.lie.kinds import NodeKind
from fem_lie.mesh.curves import curve, straight
from fem_lie.mesh.lines import LineMesh
from fem_lie.sections.section import Section


class Cable(LineBody):
    """A cable along smooth lines: it resists stretch and bending, but neither shear nor torsion.

    Its nodes are the points of the mesh, each with a place and a slope ``x' = dx/ds`` per
    unstretched length, rows 0 and 1 of ``frames``; the others are carried along by the smallest
    rotation, for drawing. Velocities, and what is held, are along ``x'/|x'|`` and these rows. It is
    naturally straight: laid along a curve, it is bent.

    A :class:`~fem_lie.Clamp` holds place and direction, :meth:`pin` the place alone. Joints see a
    node as a frame along its tangent that does not turn about it: :class:`~fem_lie.Spherical` holds
    the place, :class:`~fem_lie.Revolute` about the tangent the direction, too. Forces may act at
    nodes and along the cable, moments may not.
    """

    def __init__(
        self,
        mesh: LineMesh,
        section: Section,
        *,
        length: float | None = None,
        formulation: Formulation | None = None,
        damping: Damping | None = None,
        name: str = "",
    ) -> None:
        """Place the nodes.

        Args:
            mesh: The line as it lies at the start, without corners and branches.
            section: Of which stretch ``EA``, bending ``EI``, alike about both axes, and the mass
                per length count.
            length: Of all of it, unstretched; default: that of the line.
            formulation: The element; default: :class:`~fem_lie.HermiteCable`. Others may have nodes
                of another kind, but no frames.
            damping: Of its motion in space, and of stretch and bending; of six times of damping
                with strain the first and the last two count, which are alike.
            name: How messages and results call it.

        Raises:
            ValueError: The line has corners or branches, the element has no unknowns for the
                section or is one of frames, damping with bending is not alike about all axes, or
                there is damping with strain and the element has none.
            TypeError: An argument is of another kind than wanted.
        """
        instance(mesh, LineMesh, "Cable: mesh", "a LineMesh")
        instance(section, Section, "Cable: section", "a Section")
        instance(damping, Damping | None, "Cable: damping", "a Damping or None")
        text(name, "Cable: name")
        instance(formulation, Formulation | None, "Cable: formulation", "an element or None")
        formulation = HermiteCable() if formulation is None else formulation
        if formulation.node_kind == NodeKind.FRAME:
            raise ValueError(
                f"a Cable has nodes of places and slopes, those of {formulation} are frames"
            )
        formulation.check(section.stiffness)
        if damping is not None:
            _check_damping(damping, formulation)
        chains = Chains(mesh)
        ends = cell_frames(mesh, chains, None, None)
        frames, elements, leaders = shared_nodes(mesh, ends)
        if len(frames) != len(mesh.points) or np.bincount(mesh.cells.ravel()).max() > 2:
            raise ValueError(
                "a Cable goes along smooth lines, but this one has corners or branches: make one "
                "Cable of each smooth piece"
            )
        lengths, stretch = np.diff(chains.arc, axis=1)[:, 0], 1.0
        if length is not None:
            stretch = lengths.sum() / positive(length, "Cable: length")
            lengths = lengths / stretch
        placed = Placed(formulation.placed(frames, stretch), elements, lengths, leaders, elements)
        sections = [section] * len(elements)
        super().__init__(mesh, placed, sections, formulation, damping, name)

    @classmethod
    def straight(
        cls,
        start: npt.ArrayLike,
        end: npt.ArrayLike,
        section: Section,
        *,
        cells: int,
        length: float | None = None,
        damping: Damping | None = None,
        name: str = "",
    ) -> Cable:
        """Straight cable with ``cells`` equal elements; points "start" and "end"."""
        mesh = straight(start, end, cells)
        return cls(mesh, section, length=length, damping=damping, name=name)

    @classmethod
    def curve(
        cls,
        function: Callable[[float], npt.ArrayLike],
        section: Section,
        *,
        cells: int,
        length: float | None = None,
        damping: Damping | None = None,
        name: str = "",
    ) -> Cable:
        """Cable along ``function(s)``, s from 0 to 1; points "start" and "end"."""
        mesh = curve(function, cells)
        return cls(mesh, section, length=length, damping=damping, name=name)

    def pin(self, *points: Point) -> None:
        """Hold the places of points of this cable, and leave its directions there free.

        Raises:
            ValueError: One is not a point of this cable.
            TypeError: One is no point.
        """
        for point in points:
            require_point(point, "Cable.pin: a point")
            if point.body is not self:
                raise ValueError(f"{self.label} cannot hold {point.label}: it is not its own")
        for point in points:
            self.held[point.node, :3] = True


def _check_damping(damping: Damping, formulation: Formulation) -> None:
    """Refuse what the element has no forces for."""
    factors = damping.factors()
    if factors.any() and not formulation.viscous:
        raise ValueError(
            f"{formulation} has damping with mass only, got stiffness = {damping.stiffness!r}"
        )
    if factors[4] != factors[5]:
        raise ValueError(
            "a Cable has no direction across, so bending must be damped alike about all axes, got "
            f"stiffness = {damping.stiffness!r}"
        )
