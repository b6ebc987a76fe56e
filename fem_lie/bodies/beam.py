"""Beams: nodal frames along lines that may be curved, twisted, kinked and branching."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence

import numpy as np
import numpy.typing as npt

from fem_lie import lie
from fem_lie._arrays import Array, Indices, flag, instance, log_coincident, text
from fem_lie.bodies.beam_assembly import BeamAssembly, Damping
from fem_lie.bodies.body import NO_HOLDS, Body, Holds, Point
from fem_lie.bodies.orientation import Chains, Up, cell_frames, middle_frames, shared_nodes
from fem_lie.bodies.turning import Turning
from fem_lie.elements.beams.element import Formulation
from fem_lie.elements.beams.geodesic import Geodesic
from fem_lie.forms.assembly import Assembly
from fem_lie.lie.motions import Group
from fem_lie.mesh.lines import LineMesh, curve, polyline, straight
from fem_lie.sections.section import Section

Sections = Section | Mapping[str, Section] | Callable[[float], Section]


class Beam(Body):
    """A beam of any 6×6 section along lines: straight or curved, twisted, kinked, branching.

    Nodes ``0 … n−1`` are the points of the mesh; at kinks and branches further nodes, one for each
    direction, follow them rigidly; nodes inside of elements come last.

    Attributes:
        elements: Nodes of each element: its two ends, then those inside, shape (m, degree + 1).
        lengths: Arc length of each element, unloaded, shape (m,).
        stiffness: Section stiffness of each element, shape (m, 6, 6).
        density: Gram matrix of inertia per length of each element, shape (m, 4, 4).
        has_mass: Whether all sections have inertia.
        formulation: The element.
        damping: Of all elements.
        sections: Of each element.
        chains: Smooth pieces of the lines, and arc length along them.
    """

    def __init__(
        self,
        mesh: LineMesh,
        section: Sections,
        *,
        up: Up | None = None,
        twist: Callable[[float], float] | None = None,
        formulation: Formulation | None = None,
        damping: Damping | None = None,
        rotary_inertia: bool = True,
        group: Group = Group.SE3,
        name: str = "",
    ) -> None:
        """Place nodal frames: e₁ along the line, e₃ as near as can be to ``up``.

        Args:
            mesh: The lines. All that meet at a point are rigidly connected there.
            section: One for all cells, one for each named group of cells, or a function of arc
                length (taper), evaluated in the middle of each cell.
            up: Direction nearest to which e₃ is to be, for all cells or for named groups. Default:
                no twist (Bishop's frame), from e₃ nearest to global z where the line begins, or
                nearest to x if it begins along z.
            twist: Angle by which the section is turned about e₁ after that, rad, as a function of
                arc length.
            formulation: The element; default: :class:`~fem_lie.elements.beams.geodesic.Geodesic`.
            damping: Default: none.
            rotary_inertia: Whether the section resists turning about e₂ and e₃; without, only about
                e₁. Nothing is saved by it but a fast mode that is hardly ever wanted.
            group: On which the nodes move in time integration.
            name: For messages and results.

        Raises:
            ValueError: A cell without section, ``up`` along the line, or twist or taper on a mesh
                of several pieces.
        """
        instance(mesh, LineMesh, "Beam: mesh", "a LineMesh; see Beam.straight, polyline and curve")
        known = "a Section, a dict of them by groups of cells or a function of arc length"
        instance(section, Section | Mapping | Callable, "Beam: section", known)
        instance(formulation, Formulation | None, "Beam: formulation", "an element or None")
        instance(damping, Damping | None, "Beam: damping", "a Damping or None")
        if twist is not None:
            instance(twist, Callable, "Beam: twist", "a function of arc length or None")
        flag(rotary_inertia, "Beam: rotary_inertia")
        self.chains = chains = Chains(mesh)
        ends = cell_frames(mesh, chains, up, twist)
        frames, self.elements, leaders = shared_nodes(mesh, ends)
        # the geodesic of an arc with tangent frames is the arc itself
        a, b = frames[self.elements].transpose(1, 0, 2, 3)
        self.lengths = np.linalg.norm(lie.se3_relative(a, b)[:, :3], axis=1)
        self.formulation = Geodesic() if formulation is None else formulation
        self.damping = Damping() if damping is None else damping
        self._groups = dict(mesh.groups)
        self.sections = sections = _section_per_cell(mesh, chains, section)
        self.stiffness = np.array([s.stiffness for s in sections])
        self.has_mass = all(s.inertia is not None for s in sections)
        self.density = np.array(
            [np.zeros((4, 4)) if s.inertia is None else s.inertia for s in sections]
        )
        if not rotary_inertia:
            self.density = _without_rotary_inertia(self.density)
        frames, leaders, cells = self._refine(frames, leaders)
        named = {key: int(nodes[0]) for key, nodes in mesh.named_points.items() if len(nodes) == 1}
        super().__init__(
            frames,
            cells=cells,
            outline=_outline(sections, len(cells) // len(sections)),
            size=float(self.lengths.sum()),
            points=named,
            leaders=leaders,
            group=group,
            name=name,
        )
        log_coincident(self.label, mesh.points)

    def _refine(self, frames: Array, leaders: Indices) -> tuple[Array, Indices, Indices]:
        """Add nodes inside of the elements; returns frames, leaders and pairs for drawing."""
        degree, count = self.formulation.degree, len(frames)
        if degree == 1:
            return frames, leaders, self.elements
        if degree != 2:
            raise ValueError(f"elements of degree 1 and 2 are known, got {self.formulation}")
        a, b = self.elements.T
        middle = count + np.arange(len(a))
        self.elements = np.column_stack([a, b, middle])
        frames = np.concatenate([frames, middle_frames(frames[a], frames[b])])
        halves = np.stack([np.column_stack([a, middle]), np.column_stack([middle, b])], axis=1)
        return frames, np.concatenate([leaders, middle]), halves.reshape(-1, 2)

    @classmethod
    def straight(
        cls,
        start: npt.ArrayLike,
        end: npt.ArrayLike,
        section: Section | Callable[[float], Section],
        *,
        cells: int,
        up: npt.ArrayLike | None = None,
        twist: Callable[[float], float] | None = None,
        formulation: Formulation | None = None,
        damping: Damping | None = None,
        group: Group = Group.SE3,
        name: str = "",
    ) -> Beam:
        """Straight beam with ``cells`` equal elements; points "start" and "end"."""
        return cls(
            straight(start, end, cells),
            section,
            up=up,
            twist=twist,
            formulation=formulation,
            damping=damping,
            group=group,
            name=name,
        )

    @classmethod
    def polyline(
        cls,
        points: Sequence[npt.ArrayLike] | npt.ArrayLike,
        section: Section | Mapping[str, Section],
        *,
        cells: int | Sequence[int],
        up: Up | None = None,
        formulation: Formulation | None = None,
        damping: Damping | None = None,
        group: Group = Group.SE3,
        name: str = "",
    ) -> Beam:
        """Straight pieces through points, shape (n, 3), rigidly joined at corners of any angle.

        Points are "start", "end", "corner 1", "corner 2" and so on, groups of cells "piece 1" and
        so on. If the last point is the first the line is closed. ``cells`` is the number of equal
        elements of each piece, one for all or one each.
        """
        return cls(
            polyline(points, cells),
            section,
            up=up,
            formulation=formulation,
            damping=damping,
            group=group,
            name=name,
        )

    @classmethod
    def curve(
        cls,
        function: Callable[[float], npt.ArrayLike],
        section: Section | Callable[[float], Section],
        *,
        cells: int,
        up: npt.ArrayLike | None = None,
        twist: Callable[[float], float] | None = None,
        formulation: Formulation | None = None,
        damping: Damping | None = None,
        group: Group = Group.SE3,
        name: str = "",
    ) -> Beam:
        """Beam along ``function(s)``, s from 0 to 1; points "start" and "end"."""
        return cls(
            curve(function, cells),
            section,
            up=up,
            twist=twist,
            formulation=formulation,
            damping=damping,
            group=group,
            name=name,
        )

    @property
    def kind(self) -> Hashable:
        """Beams of one formulation are assembled together."""
        return type(self), self.formulation

    @classmethod
    def assemble(cls, bodies: Sequence[Beam], holds: Holds = NO_HOLDS) -> Assembly:
        """All beams of one :attr:`kind` together."""
        return BeamAssembly(bodies)

    @property
    def start(self) -> Point:
        """The point named "start"."""
        return self["start"]

    @property
    def end(self) -> Point:
        """The point named "end"."""
        return self["end"]

    @property
    def element_stiffness(self) -> Array:
        """What the formulation makes of the section stiffness of each element, (m, 6, 6)."""
        a, b = self.frames[self.elements[:, :2]].transpose(1, 0, 2, 3)
        return self.formulation.effective_stiffness(self.stiffness, lie.se3_relative(a, b))

    def turning(self) -> Turning:
        """Elements may turn as far as their formulation says, and are named as a whole."""
        along = self.elements[:, [0, *range(2, self.elements.shape[1]), 1]]
        return Turning(along, np.arange(len(along)), self.formulation.largest_turn, whole=True)

    def cells_of(self, group: str | None = None) -> Indices:
        """Elements of a named group (default: all).

        Raises:
            ValueError: There is no such group; the message lists those that exist.
        """
        if group is None:
            return np.arange(len(self.elements))
        text(group, f"the name of a group of cells of {self.label}")
        if group not in self._groups:
            known = ", ".join(sorted(self._groups)) or "none"
            raise ValueError(f"{self.label} has no group of cells {group!r}; it has: {known}")
        return self._groups[group]

    def consistent_shares(self) -> tuple[Indices, Array]:
        """Nodes of each element, and the length that each carries: integrals of their shapes."""
        shares = {1: [1 / 2, 1 / 2], 2: [1 / 6, 1 / 6, 2 / 3]}[self.formulation.degree]
        return self.elements, np.outer(self.lengths, shares)

    def consistent_levers(self) -> Array:
        """On directors, shape (m, k, 3): ``∫ ½ (s − s²) (t_A − t_B) ℓ ds`` of a bowed axis."""
        levers = np.zeros((*self.elements.shape, 3))
        if self.formulation.bows:
            a, b = self.frames[self.elements].transpose(1, 0, 2, 3)
            moved = lie.se3_relative(a, b)[:, :3]  # ℓ times the slope
            along = self.lengths[:, np.newaxis] * moved / 12
            levers[:, 0], levers[:, 1] = along, -along
        return levers


def _section_per_cell(mesh: LineMesh, chains: Chains, section: Sections) -> list[Section]:
    if isinstance(section, Section):
        return [section] * len(mesh.cells)
    if not isinstance(section, Mapping):
        chains.require_one("a section")
        found = [section(float(s)) for s in chains.arc.mean(axis=1)]
        for value in found:
            instance(value, Section, "the section at an arc length", "a Section")
        return found
    chosen: list[Section | None] = [None] * len(mesh.cells)
    for group, value in section.items():
        instance(value, Section, f"the section of {group!r}", "a Section")
        for cell in mesh.group(group):
            chosen[cell] = value
    missing = [i for i, value in enumerate(chosen) if value is None]
    if missing:
        raise ValueError(f"{len(missing)} cells have no section, the first is cell {missing[0]}")
    return [value for value in chosen if value is not None]


def _outline(sections: Sequence[Section], pieces: int) -> Array | None:
    """Outline of all cells, or one for each piece of them, (m, k, 2): for drawing.

    Those with fewer corners repeat their last one.
    """
    given = [section.outline for section in sections]
    if all(outline is given[0] for outline in given):
        return given[0]
    corners = max(0 if outline is None else len(outline) for outline in given)
    outlines = np.full((len(given), corners, 2), np.nan)
    for padded, outline in zip(outlines, given, strict=True):
        if outline is not None:
            padded[:] = outline[-1]
            padded[: len(outline)] = outline
    return np.repeat(outlines, pieces, axis=0)


def _without_rotary_inertia(density: Array) -> Array:
    """The same centre of mass and polar inertia J₁ about it, but J₂ = J₃ = 0.

    ``G_kl = ½ tr(J) δ_kl − J_kl`` about the centre of mass.
    """
    mass = density[:, 0, 0]
    centre = density[:, 0] / np.where(mass > 0, mass, 1.0)[:, np.newaxis]
    reduced = np.einsum("m,mk,ml->mkl", mass, centre, centre)
    about_centre = density - reduced
    polar = about_centre[:, 2, 2] + about_centre[:, 3, 3]
    for k, factor in ((1, -0.5), (2, 0.5), (3, 0.5)):
        reduced[:, k, k] += factor * polar
    return reduced
