"""Bodies along lines whose elements have cross-sections."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar

import numpy as np

from fem_lie._arrays import Array, Indices, instance, members_within, number, text
from fem_lie.bodies.closest import AT_NODE, closest_on_lines
from fem_lie.bodies.model import BodyModel, HeldRotation, MaterialPoint
from fem_lie.bodies.per_cell import of_groups
from fem_lie.mesh.lines import LineMesh
from fem_lie.sections.orientation import Chains
from fem_lie.sections.section import Section

_log = logging.getLogger(__name__)
_OPEN = 2.0  # warping length over polar radius: of solid, closed and angle sections about 1 at most
_FELT = 0.01  # of the length of a beam

Sections = Section | Mapping[str, Section] | Callable[[float], Section]


def section_per_cell(mesh: LineMesh, chains: Chains, section: Sections) -> list[Section]:
    """Section of each cell.

    Raises:
        ValueError: A cell has no section, or a function of arc length is given for several pieces.
        TypeError: An entry is not a section.
    """
    if isinstance(section, Section):
        return [section] * len(mesh.cells)
    if not isinstance(section, Mapping):
        chains.require_one("a section")
        found = [section(float(s)) for s in chains.arc.mean(axis=1)]
        for value in found:
            instance(value, Section, "the section at an arc length", "a Section")
        return found
    return of_groups(section, Section, "a Section", len(mesh.cells), mesh.group)


def log_open_profiles(label: str, sections: Sequence[Section], length: float) -> None:
    """Log open thin-walled sections whose warping stiffness the beam neglects.

    Args:
        label: Label of the beam.
        sections: Sections of its cells.
        length: Its total length.
    """
    for section in {id(each): each for each in sections}.values():
        known = section.properties
        if known is None or known.warping_length <= max(_OPEN * known.polar_radius, _FELT * length):
            continue
        assert known.warping_constant is not None
        _log.warning(
            "%s has an open thin-walled section and no warping stiffness: where warping is held or "
            "changes along the beam, it is too soft in torsion, up to %.2g from there "
            "(√(EI_ω/GJ)); AncfBeam(warping=%.4g) has the EI_ω of this section, and "
            "fl.reduction.DistortingBeam distorts, too",
            label,
            known.warping_length,
            known.E * known.warping_constant,
        )


def outline_of(sections: Sequence[Section], pieces: int) -> Array | None:
    """Outline of all cells, or one for each of their drawn pieces, (m, k, 2); ``None`` if unknown.

    Outlines with fewer corners repeat their last one.
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


def without_rotary_inertia(density: Array) -> Array:
    """Mass matrices with the same centre of mass and J₁ about it, but J₂ = J₃ = 0.

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


class SectionedModel(BodyModel):
    """Model of elements with sections, which are given for named groups of cells of its line.

    Attributes:
        elements: Nodes of each element, shape (m, k).
        lengths: Unloaded arc length of each element, shape (m,).
        stiffness: Section stiffness of each element, shape (m, 6, 6).
        density: Mass matrix of (x, d₁, d₂, d₃) per length of each element, shape (m, 4, 4).
        has_mass: Whether all sections have inertia.
        sections: Section of each element.
    """

    elements: Indices
    lengths: Array
    _of_elements: ClassVar[tuple[str, ...]] = ("lengths", "stiffness", "density")
    """Arrays with a value for each element."""

    def _take(self, sections: Sequence[Section], mesh: LineMesh) -> None:
        """Set the sections of all elements, and the named sets of the mesh."""
        self.sections, self._groups = sections, dict(mesh.groups)
        self._sets = dict(mesh.named_points)
        # many elements share few sections; a single section is stored once
        known = list({id(section): section for section in sections}.values())
        self.has_mass = all(section.inertia is not None for section in known)
        stiffness = np.array([section.stiffness for section in known])
        none = np.zeros((4, 4))
        density = np.array([none if s.inertia is None else s.inertia for s in known])
        if len(known) == 1:
            count = len(sections)
            self.stiffness = np.broadcast_to(stiffness[0], (count, 6, 6))
            self.density = np.broadcast_to(density[0], (count, 4, 4))
        else:
            number = {id(section): k for k, section in enumerate(known)}
            which = [number[id(section)] for section in sections]
            self.stiffness, self.density = stiffness[which], density[which]

    def restricted(self, cells: Indices, holds: Sequence[HeldRotation]) -> tuple[Any, Indices]:
        """Model of some of its elements, see :class:`~fem_lie.bodies.model.BodyModel`.

        Args:
            cells: Indices of the elements, ascending, shape (s,).
            holds: Rotations of nodes of the whole body that joints, motions and moments act on.
        """
        own = self.elements[cells]
        nodes: Indices = np.unique(own)
        part = self._on_nodes(nodes)
        part.elements = np.searchsorted(nodes, own)
        for name in self._of_elements:
            setattr(part, name, getattr(self, name)[cells])
        part.sections = [self.sections[k] for k in cells]
        part._groups = members_within(self._groups, cells)
        part._sets = members_within(self._sets, nodes)
        return part, nodes

    def cells_of(self, group: str | None = None) -> Indices:
        """Elements of a named group (default: all).

        Args:
            group: Name of the group; default: all.

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

    def nodes(self, where: str) -> Indices:
        """Numbers of the nodes of a named point, or of a group of cells.

        Args:
            where: Name of the point, curve, face or group.
        """
        if where in self._groups:
            return np.unique(self.elements[self._groups[where], :2])
        if where not in self._sets:
            known = ", ".join(sorted({*self._sets, *self._groups})) or "none"
            raise ValueError(f"{self.label} has no points or cells {where!r}; it has: {known}")
        return self._sets[where]

    def point_in_cell(self, element: int, part: float) -> MaterialPoint:
        """Material point within an element, if its formulation supports joints between nodes.

        Args:
            element: Index of the element.
            part: Unloaded arc length from its first end over its length, 0 to 1.

        Raises:
            ValueError: There is no such element, ``part`` is out of range, or the formulation
                supports joints at nodes only.
        """
        raise ValueError(f"{self.label} has points at its nodes only, and none between them")

    def closest(self, position: Array) -> MaterialPoint:
        """Closest point of the line: a node, or a point within an element.

        Args:
            position: Position in the reference configuration, shape (3,).
        """
        node = self.closest_node(position)
        if np.linalg.norm(self.frames[node, 0] - position) <= AT_NODE * self.size:
            return self.numbered(node)
        ends = self.frames[self.elements[:, :2], 0]
        return self.point_in_cell(*closest_on_lines(position, ends, self._position_in))

    def _position_in(self, element: int, part: float) -> Array:
        return self.frame_of(self.point_in_cell(element, part))[0]

    def _check_coordinate(self, element: int, part: float) -> None:
        """Raise ``ValueError`` if there is no such element, or ``part`` is not from 0 to 1."""
        instance(element, int | np.integer, f"the number of an element of {self.label}", "whole")
        last = len(self.elements) - 1
        if not 0 <= element <= last:
            raise ValueError(f"{self.label} has elements 0 … {last}, got {element}")
        if not 0.0 <= number(part, f"the part of an element of {self.label}") <= 1.0:
            raise ValueError(f"a part of an element is 0 to 1, got {part}")
