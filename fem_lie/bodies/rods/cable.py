"""Cables: places and slopes along smooth lines."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import instance, positive
from fem_lie.bodies.beams.line_body import Placed
from fem_lie.bodies.rods.threads import Threads, successive
from fem_lie.elements.beams.element import Formulation
from fem_lie.elements.rods.cable import HermiteCable
from fem_lie.mesh.curves import curve, straight
from fem_lie.mesh.lines import LineMesh
from fem_lie.mesh.reading import line_of
from fem_lie.sections.material import Damping
from fem_lie.sections.orientation import Chains, cell_frames, shared_nodes
from fem_lie.sections.section import Section

if TYPE_CHECKING:
    import dolfinx


class Cable(Threads):
    """A cable along smooth lines: it resists stretch and bending, but neither shear nor torsion.

    Its nodes are the points of the mesh, each with a place and a slope ``x' = dx/ds`` per
    unstretched length, rows 0 and 1 of ``frames``; the others are carried along by the smallest
    rotation, for drawing. Velocities, and what is held, are along ``x'/|x'|`` and these rows. It is
    naturally straight: laid along a curve, it is bent.

    :meth:`clamp` and :class:`~fem_lie.Clamp` hold place and direction, :meth:`pin` the place alone.
    Joints see a node as a frame along its tangent that does not turn about it:
    :class:`~fem_lie.Spherical` holds the place, :class:`~fem_lie.Revolute` about the tangent the
    direction, too. Forces may act at nodes and along the cable, moments may not. That is so with
    :class:`~fem_lie.HermiteCable`; nodes of :class:`~fem_lie.DiscreteCable` are places, which
    :meth:`clamp`, :meth:`pin` and spherical joints hold.

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
        formulation: Formulation | None = None,
        damping: Damping | None = None,
        name: str = "",
    ) -> None:
        """Place the nodes.

        Args:
            mesh: The line as it lies at the start, without corners and branches; or a DOLFINx
                mesh of intervals in space.
            section: Of which stretch ``EA``, bending ``EI``, alike about both axes, and the mass
                per length count.
            length: Of all of it, unstretched; default: that of the line.
            formulation: The element; default: :class:`~fem_lie.HermiteCable`. Or
                :class:`~fem_lie.DiscreteCable`; not one with frames.
            damping: Of its motion in space, and of stretch and bending; of six times of damping
                with strain the first and the last two count, which are alike.
            name: How messages and results call it.

        Raises:
            ValueError: The line has corners or branches, the element has no unknowns for the
                section or is one of frames, damping with bending is not alike about all axes, or
                there is damping with strain and the element has none.
            TypeError: An argument is of another kind than wanted.
        """
        mesh = line_of(mesh, "Cable")
        self.source = mesh.source
        instance(section, Section, "Cable: section", "a Section")
        instance(formulation, Formulation | None, "Cable: formulation", "an element or None")
        element = HermiteCable() if formulation is None else formulation
        chains = Chains(mesh)
        ends = cell_frames(mesh, chains, None, None)
        frames, elements, masters = shared_nodes(mesh, ends)
        if len(frames) != len(mesh.points) or np.bincount(mesh.cells.ravel()).max() > 2:
            raise ValueError(
                "a Cable goes along smooth lines, but this one has corners or branches: make one "
                "Cable of each smooth piece, or a Net of threads"
            )
        lengths, stretch = np.diff(chains.arc, axis=1)[:, 0], 1.0
        if length is not None:
            stretch = lengths.sum() / positive(length, "Cable: length")
            lengths = lengths / stretch
        placed = Placed(element.placed(frames, stretch), elements, lengths, masters, elements)
        super().__init__(mesh, placed, successive(elements), section, element, damping, name)

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
