"""Cables: places and slopes along smooth lines."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices, instance, log_coincident, positive, text
from fem_lie.bodies.beams.assembly import BeamAssembly, Damping
from fem_lie.bodies.beams.orientation import Chains, cell_frames, shared_nodes
from fem_lie.bodies.body import NO_HOLDS, Body, Holds, Point
from fem_lie.bodies.points import require_point
from fem_lie.elements.beams.element import Formulation
from fem_lie.elements.rods.cable import HermiteCable
from fem_lie.forms.assembly import Assembly
from fem_lie.grips.grip import Grip
from fem_lie.grips.tangent import along_tangent
from fem_lie.lie.kinds import NodeKind
from fem_lie.mesh.curves import curve, straight
from fem_lie.mesh.lines import LineMesh
from fem_lie.sections.section import Section

_ALIKE = 1e-9  # relative, as sections that are meant to be round


class Cable(Body):
    """A cable along smooth lines: it resists stretch and bending, but neither shear nor torsion.

    Its nodes are the points of the mesh, each with a place and a slope ``x' = dx/ds`` per
    unstretched length, rows 0 and 1 of ``frames``; the others are carried along by the smallest
    rotation, for drawing. Velocities, and what is held, are along ``x'/|x'|`` and these rows. It is
    naturally straight: laid along a curve, it is bent.

    A :class:`~fem_lie.Clamp` holds place and direction, :meth:`pin` the place alone. Joints see a
    node as a frame along its tangent that does not turn about it: :class:`~fem_lie.Spherical` holds
    the place, :class:`~fem_lie.Revolute` about the tangent the direction, too. Forces may act at
    nodes and along the cable, moments may not.

    Attributes:
        elements: Nodes of each element, shape (m, 2).
        lengths: Unstretched length of each element, shape (m,).
        stiffness: Section stiffness of each element, shape (m, 6, 6).
        density: Gram matrix of inertia per length of each element, shape (m, 4, 4).
        has_mass: Whether the section has inertia.
        formulation: The element.
        damping: Of all elements; with mass only.
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
            formulation: The element; default: :class:`~fem_lie.HermiteCable`.
            damping: Of its motion in space.
            name: How messages and results call it.

        Raises:
            ValueError: The line has corners or branches, the section bends otherwise about other
                axes, or couples stretch and bending, there is damping with strain, or the element
                has nodes without slopes.
            TypeError: An argument is of another kind than wanted.
        """
        instance(mesh, LineMesh, "Cable: mesh", "a LineMesh")
        instance(section, Section, "Cable: section", "a Section")
        instance(damping, Damping | None, "Cable: damping", "a Damping or None")
        text(name, "Cable: name")
        _check_section(section)
        instance(formulation, Formulation | None, "Cable: formulation", "an element or None")
        self.formulation = HermiteCable() if formulation is None else formulation
        if self.formulation.node_kind != NodeKind.SLOPE:
            raise ValueError(
                f"a Cable has nodes of places and slopes, those of {self.formulation} are others"
            )
        self.damping = Damping() if damping is None else damping
        if self.damping.factors().any():
            raise ValueError("a Cable has damping with mass only, got Damping(stiffness=…)")
        chains = Chains(mesh)
        ends = cell_frames(mesh, chains, None, None)
        frames, self.elements, leaders = shared_nodes(mesh, ends)
        if len(frames) != len(mesh.points) or np.bincount(mesh.cells.ravel()).max() > 2:
            raise ValueError(
                "a Cable goes along smooth lines, but this one has corners or branches: make one "
                "Cable of each smooth piece"
            )
        self.lengths = np.diff(chains.arc, axis=1)[:, 0]
        if length is not None:
            stretch = self.lengths.sum() / positive(length, "Cable: length")
            self.lengths = self.lengths / stretch
            frames[:, 1] *= stretch
        count = len(self.elements)
        self.stiffness = np.tile(section.stiffness, (count, 1, 1))
        self.has_mass = section.inertia is not None
        density = np.zeros((4, 4)) if section.inertia is None else section.inertia
        self.density = np.tile(density, (count, 1, 1))
        named = {key: int(nodes[0]) for key, nodes in mesh.named_points.items() if len(nodes) == 1}
        super().__init__(
            frames,
            cells=self.elements,
            outline=section.outline,
            size=float(self.lengths.sum()),
            points=named,
            leaders=leaders,
            name=name,
        )
        log_coincident(self.label, mesh.points)

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

    @property
    def node_kind(self) -> NodeKind:
        """What the element says."""
        return self.formulation.node_kind

    @property
    def kind(self) -> Hashable:
        """Cables of one element are assembled together."""
        return type(self), self.formulation

    @classmethod
    def assemble(cls, bodies: Sequence[Cable], holds: Holds = NO_HOLDS) -> Assembly:
        """All cables together."""
        return BeamAssembly(bodies)

    @property
    def start(self) -> Point:
        """The point named "start"."""
        return self["start"]

    @property
    def end(self) -> Point:
        """The point named "end"."""
        return self["end"]

    def grip_of(self, node: int) -> Grip:
        """By what joints hold a node: place and tangent, without a rotation about it."""
        return along_tangent(node)

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

    def cells_of(self, group: str | None = None) -> Indices:
        """All elements; there are no groups.

        Raises:
            ValueError: A group is named.
        """
        if group is not None:
            raise ValueError(f"{self.label} has no group of cells {group!r}; it has: none")
        return np.arange(len(self.elements))

    def consistent_shares(self) -> tuple[Indices, Array]:
        """Nodes of each element, and the length that each carries: half of it."""
        return self.elements, np.outer(self.lengths, [0.5, 0.5])

    def consistent_levers(self) -> Array:
        """On slopes, shape (m, 2, 3): ``±ℓ²/12``, integrals of their cubics."""
        levers = np.zeros((len(self.elements), 2, 3))
        levers[:, 0, 0] = self.lengths**2 / 12
        levers[:, 1, 0] = -levers[:, 0, 0]
        return levers


def _check_section(section: Section) -> None:
    """Refuse what a cable has no unknowns for."""
    EA, EI, other = (float(section.stiffness[k, k]) for k in (0, 4, 5))
    if abs(EI - other) > _ALIKE * max(EI, other):
        raise ValueError(
            f"a Cable has no direction across, so its section must bend alike about all axes, got "
            f"EI = {EI:g} and {other:g}"
        )
    coupling = np.abs(section.stiffness[[0, 0, 4], [4, 5, 5]]).max()
    if coupling > _ALIKE * max(EI, np.sqrt(EA * EI)):
        raise ValueError(
            "a Cable is stretched along its centre: its section must not couple stretch and "
            f"bending, got the stiffness\n{section.stiffness}"
        )
