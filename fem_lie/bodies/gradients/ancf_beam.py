"""ANCF beams: positions and all three position gradients; sections stretch, shear and rotate."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from fem_lie import lie
from fem_lie._arrays import Array, Indices, instance, positive
from fem_lie.bodies.beams.sectioned import Sections, outline_of, section_per_cell
from fem_lie.bodies.body import Point
from fem_lie.bodies.cells.assembly import assemble_cells
from fem_lie.bodies.gradients.axes import second_nodes
from fem_lie.bodies.gradients.section_points import SectionPoints, SectionPointsModel
from fem_lie.bodies.model import NO_HOLDS, Holds, MaterialPoint
from fem_lie.elements.gradients import ancf
from fem_lie.elements.gradients.ancf import AncfElement, check_poisson
from fem_lie.elements.gradients.warping import Warping, WarpingSprings
from fem_lie.elements.rods.cable import hermite_shapes
from fem_lie.forms.small_energy.assembly import ElementAssembly
from fem_lie.mesh.curves import curve, straight_line
from fem_lie.mesh.lines import LineMesh
from fem_lie.mesh.reading import line_of
from fem_lie.mesh.shapes import LineQuadrature
from fem_lie.sections.material import Damping
from fem_lie.sections.orientation import Chains, Twisted, Up, cell_frames, shared_nodes
from fem_lie.sections.section import Section

if TYPE_CHECKING:
    import dolfinx


class AncfBeamModel(SectionPointsModel):
    """Model of an ANCF beam.

    Attributes:
        elements: Nodes of each element: positions with ``r_x`` of both ends, then the others, (m,
            4).
        unloaded: Unloaded nodal coordinates, shape (n, 4, 3).
        ends: Unloaded frames of both ends of each element, shape (m, 2, 4, 3).
        poisson: Poisson's ratio of each element, shape (m,).
        formulation: Finite element.
        warping: Warping stiffness ``EI_ω``, or ``None``.
        chains: Smooth pieces of the lines, and arc length along them.
        damping: Mass-proportional damping.
    """

    chains: Chains
    warping: float | None = None

    def __init__(
        self,
        mesh: LineMesh,
        frames: Array,
        corners: Indices,
        sections: Sequence[Section],
        formulation: AncfElement,
        damping: Damping,
        length: float | None,
        class_name: str,
        name: str,
    ) -> None:
        """Create the nodes.

        Args:
            mesh: Line mesh with names of points and groups.
            frames: Frames of the points, shape (p, 4, 3).
            corners: Points at the ends of each element, shape (m, 2).
            sections: Section of each element.
            formulation: Finite element.
            damping: Mass-proportional damping.
            length: Unloaded length of the whole beam; default: that of the line.
            class_name: Name of the class of the body.
            name: Name in messages and results.
        """
        self.formulation, self.damping, self.source = formulation, damping, mesh.source
        self.points_count = count = len(frames)
        self.elements = np.concatenate([corners, count + corners], axis=1)
        lengths = np.linalg.norm(lie.se3_relative(*frames[corners].swapaxes(0, 1))[:, :3], axis=1)
        total = float(lengths.sum())
        stretch = 1.0 if length is None else total / positive(length, "AncfBeam: length")
        self.lengths, own = lengths / stretch, frames.copy()
        own[:, 0] /= stretch
        self.ends, self.unloaded = own[corners], np.concatenate([own, second_nodes(own)])
        self._take(sections, mesh)
        self.poisson = np.array([_poisson(each, formulation.poisson) for each in sections])
        named = {key: int(nodes[0]) for key, nodes in mesh.named_points.items() if len(nodes) == 1}
        laid = np.concatenate([frames, second_nodes(frames)])
        laid[:count, 1] *= stretch
        super().__init__(
            laid,
            class_name=class_name,
            cells=corners,
            outline=outline_of(sections, 1),
            size=total,
            points=named,
            name=name,
        )

    @property
    def assembly_key(self) -> Hashable:
        """Key of beams that are assembled together: same class and formulation."""
        return type(self), self.formulation

    @classmethod
    def assemble(cls, models: Sequence[Any], holds: Holds = NO_HOLDS) -> ElementAssembly:
        """Assembly of all beams of one :attr:`assembly_key`, with their warping springs."""
        assembly = assemble_cells(ancf.ELEMENT, ancf.FUNCTIONS, models)
        starts = np.cumsum([0, *(len(model.frames) for model in models)])
        found = [
            part._replace(nodes=part.nodes + start)
            for model, start in zip(models, starts, strict=False)
            for part in model.warping_springs
        ]
        if found:
            assembly.further_terms.append(Warping(WarpingSprings.joined(found), assembly.count))
        return assembly

    @property
    def element_nodes(self) -> Indices:
        """Nodes of each element, shape (m, 4)."""
        return self.elements

    def element_data(self) -> Array:
        """Data of the elements, with the strains of :attr:`unloaded` as natural strains."""
        C = self.formulation.stiffness(self.stiffness, self.poisson, self.ends, self.lengths)
        return ancf.data(self.unloaded[self.elements], self.lengths, C)

    def element_inertia(self) -> Array:
        """Mass matrix in the nodal coordinates of each element, shape (m, 4, 4, 4, 4)."""
        return self.formulation.inertia(self.density, self.lengths)

    @property
    def warping_springs(self) -> list[WarpingSprings]:
        """Warping springs, if there is a warping stiffness."""
        if self.warping is None:
            return []
        held = self.clamped_sections()
        own = self.unloaded, self.elements[:, 2:], self.lengths, self.warping
        return [WarpingSprings.between(*own, held)]

    def point_in_cell(self, element: int, part: float) -> MaterialPoint:
        """Material point within an element, for joints, springs and loads.

        Args:
            element: Index of the element.
            part: Unloaded arc length from its first end over its length, 0 to 1.

        Raises:
            ValueError: There is no such element, or ``part`` is out of range.
        """
        self._check_coordinate(element, part)
        nodes = self.elements[element].tolist()
        attachment = self.formulation.attachment_frame(
            nodes, float(part), float(self.lengths[element])
        )
        return MaterialPoint(nodes[0], f"element {element} at {part:g}", attachment)

    def line_quadrature(self) -> LineQuadrature:
        """Integration along the elements, for loads: the cubic of positions and ``r_x``."""
        ends = self.frames[self.elements[:, :2]]
        weights, shapes, gradients = hermite_shapes(self.lengths)
        positions = np.einsum("mgk,mkj->mgj", shapes, ends[:, :, 0])
        positions += np.einsum("mga,maj->mgj", gradients[..., 0], ends[:, :, 1])
        shares = np.zeros((*weights.shape, self.elements.shape[1]))
        on_directors = np.zeros((*shares.shape, 3))
        shares[..., :2] = weights[..., np.newaxis] * shapes
        on_directors[:, :, :2] = weights[..., np.newaxis, np.newaxis] * gradients
        return LineQuadrature(self.elements, positions, shares, on_directors)


class AncfBeam(SectionPoints):
    """ANCF beam along smooth lines: twelve unknowns at a point, position and three gradients.

    A point is two nodes: rows 0 and 1 of ``frames[i]`` are position and ``r_x`` per unloaded
    length, rows 1 and 2 of ``frames[points + i]`` ``r_y`` and ``r_z``. Rows 2 and 3 of the first
    node are axes that rotate with the section. Joints, springs, drives and loads, moments included,
    act on the frame of the section, with e₁ normal to it and e₂ along ``r_y``. :meth:`clamp` and
    :meth:`pin` hold points.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> tube = fl.Section.circle(0.01, steel)
        >>> beam = fl.AncfBeam.straight((0, 0, 0), (1, 0, 0), tube, cells=4)
        >>> beam.frames.shape
        (10, 4, 3)
    """

    model: AncfBeamModel

    def __init__(
        self,
        mesh: LineMesh | dolfinx.mesh.Mesh,
        section: Sections,
        *,
        up: Up | Twisted | None = None,
        length: float | None = None,
        warping: float | None = None,
        formulation: AncfElement | None = None,
        damping: Damping | None = None,
        name: str = "",
    ) -> None:
        """Create the nodes; arguments are similar to those of a :class:`~fem_lie.Beam`.

        Args:
            mesh: Line mesh without corners and branches; or a DOLFINx mesh of intervals.
            section: One for all cells, one for each named group, or a function of arc length.
            up: Direction that e₃ is closest to.
            length: Unloaded length of the whole beam; default: that of the line. With another
                length the unloaded beam is the scaled line, and it is strained axially at the
                start.
            warping: Warping stiffness ``EI_ω`` of a thin-walled section (Vlasov), force times
                length⁴; a clamp then holds warping, too. Default: no warping stiffness.
            formulation: Finite element; default: :class:`~fem_lie.elements.AncfElement`.
            damping: Mass-proportional damping; there are no viscous forces.
            name: Name in messages and results.

        Raises:
            ValueError: The line has corners or branches, a cell has no section, ``up`` is along the
                line, or there is damping of strain.
            TypeError: An argument has an unexpected type.
        """
        mesh = line_of(mesh, "AncfBeam")
        known = "a Section, a dict of them by groups of cells or a function of arc length"
        instance(section, Section | Mapping | Callable, "AncfBeam: section", known)
        instance(formulation, AncfElement | None, "AncfBeam: formulation", "an element or None")
        instance(damping, Damping | None, "AncfBeam: damping", "a Damping or None")
        element = AncfElement() if formulation is None else formulation
        damping = Damping.of_mass(damping, "AncfBeam")
        chains = Chains(mesh)
        twisted = up if isinstance(up, Twisted) else Twisted(None, up)
        frames, corners, _ = shared_nodes(
            mesh, cell_frames(mesh, chains, twisted.up, twisted.angle)
        )
        if len(frames) != len(mesh.points) or np.bincount(mesh.cells.ravel()).max() > 2:
            raise ValueError(
                "AncfBeam: expected a smooth line, got one with corners or branches: make one beam "
                "of each smooth piece, and join them by fl.joints.Fixed"
            )
        sections = section_per_cell(mesh, chains, section)
        model = AncfBeamModel(
            mesh, frames, corners, sections, element, damping, length, type(self).__name__, name
        )
        model.chains = chains
        model.warping = None if warping is None else positive(warping, "AncfBeam: warping")
        super().__init__(model)

    @classmethod
    def straight(
        cls,
        start: npt.ArrayLike,
        end: npt.ArrayLike,
        section: Section | Callable[[float], Section],
        *,
        cells: int,
        up: npt.ArrayLike | Twisted | None = None,
        length: float | None = None,
        warping: float | None = None,
        formulation: AncfElement | None = None,
        damping: Damping | None = None,
        name: str = "",
    ) -> AncfBeam:
        """Straight beam with ``cells`` equal elements; points "start" and "end".

        Args:
            start: First point, shape (3,).
            end: Last point, shape (3,).
            section: Cross-section.
            cells: Number of equal elements.
            up: Direction nearest to which e₃ is to be, or a twist; default: no twist.
            length: Unstretched length; default: that of the line.
            warping: Restrained warping of the section; default: none.
            formulation: The element; default: that of the class.
            damping: Damping; default: none.
            name: Name in messages and results.
        """
        mesh = straight_line(start, end, cells)
        return cls(
            mesh,
            section,
            up=up,
            length=length,
            warping=warping,
            formulation=formulation,
            damping=damping,
            name=name,
        )

    @classmethod
    def curve(
        cls,
        function: Callable[[float], npt.ArrayLike],
        section: Section | Callable[[float], Section],
        *,
        cells: int,
        up: npt.ArrayLike | Twisted | None = None,
        length: float | None = None,
        warping: float | None = None,
        formulation: AncfElement | None = None,
        damping: Damping | None = None,
        name: str = "",
    ) -> AncfBeam:
        """Beam along the curve ``function(s)``, s from 0 to 1, with points "start" and "end".

        Args:
            function: Position, shape (3,), as a function of the parameter from 0 to 1.
            section: Cross-section.
            cells: Number of equal elements.
            up: Direction nearest to which e₃ is to be, or a twist; default: no twist.
            length: Unstretched length; default: that of the line.
            warping: Restrained warping of the section; default: none.
            formulation: The element; default: that of the class.
            damping: Damping; default: none.
            name: Name in messages and results.
        """
        mesh = curve(function, cells)
        return cls(
            mesh,
            section,
            up=up,
            length=length,
            warping=warping,
            formulation=formulation,
            damping=damping,
            name=name,
        )

    def point_in_cell(self, element: int, part: float) -> Point:
        """Point within an element, for joints, springs and loads.

        Args:
            element: Index of the element.
            part: Unloaded arc length from its first end over its length, 0 to 1.

        Raises:
            ValueError: There is no such element, or ``part`` is out of range.
        """
        return self._at(self.model.point_in_cell(element, part))


def _poisson(section: Section, given: float | None) -> float:
    """Poisson's ratio: ``given``, or that of the material of the section."""
    if given is not None:
        return given
    known = section.properties
    return 0.0 if known is None else check_poisson(known.E / (2 * known.G) - 1)
