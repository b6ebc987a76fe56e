"""Beams: nodal frames along lines that may be curved, twisted, kinked and branching."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, ClassVar

import numpy as np
import numpy.typing as npt

from fem_lie import lie
from fem_lie._arrays import Array, flag, instance, vector
from fem_lie.bodies.beams.line_body import LineBody, LineModel, Placed, SmoothLine
from fem_lie.bodies.beams.sectioned import (
    Sections,
    log_open_profiles,
    section_per_cell,
    without_rotary_inertia,
)
from fem_lie.bodies.body import Point
from fem_lie.bodies.model import MaterialPoint, RotationLimit
from fem_lie.elements.beams.element import BeamFormulation
from fem_lie.elements.beams.geodesic import GeodesicBeam
from fem_lie.lie.node_types import NodeType
from fem_lie.mesh.curves import curve, polyline, straight_line
from fem_lie.mesh.lines import LineMesh
from fem_lie.mesh.reading import line_of
from fem_lie.sections.material import Damping
from fem_lie.sections.orientation import (
    Chains,
    Twisted,
    Up,
    cell_frames,
    middle_frames,
    shared_nodes,
)
from fem_lie.sections.section import Section

if TYPE_CHECKING:
    import dolfinx

_AT_NODE = 1e-9  # of an element
_BY_BENDING = 0.1  # significant fraction of the axial compliance of a curved element


class BeamModel(LineModel):
    """Model of a beam or rod whose nodes are frames.

    Attributes:
        chains: Smooth pieces of the lines, and arc length along them.
    """

    chains: Chains

    @property
    def smooth_lines(self) -> list[SmoothLine]:
        """The chains."""
        found = []
        for own in np.split(self.chains.order, self.chains.first[1:]):
            a, b = self.elements[own, 0], self.elements[own, 1]
            found.append(SmoothLine(np.append(a, b[-1]), own))
        return found

    def point_in_cell(self, element: int, part: float) -> MaterialPoint:
        """Material point within an element, as the element interpolates it, or one of its nodes.

        Args:
            element: Index of the element.
            part: Unloaded arc length from its first end over its length, 0 to 1.

        Raises:
            ValueError: There is no such element, or ``part`` is out of range.
        """
        self._check_coordinate(element, part)
        nodes = self.elements[element]
        for node, at in zip(nodes, (0.0, 1.0, 0.5), strict=False):
            if abs(part - at) < _AT_NODE:
                return self.numbered(int(node))
        attachment = self.formulation.attachment_frame(nodes, float(part))
        return MaterialPoint(int(nodes[0]), f"element {element} at {part:g}", attachment)

    @property
    def element_stiffness(self) -> Array:
        """Effective section stiffness of each element in its formulation, shape (m, 6, 6)."""
        a, b = self.frames[self.elements[:, :2]].transpose(1, 0, 2, 3)
        return self.formulation.effective_stiffness(self.stiffness, lie.se3_relative(a, b))

    @property
    def strains_shape(self) -> tuple[int, int]:
        """Shape (m, 6) of stress-free strains (Γ, κ) of the cells."""
        return len(self.stiffness), 6

    def require_eigenstrain(self, what: str) -> None:
        """Raise ``ValueError`` if the elements do not take stress-free strains.

        Args:
            what: What the user asked for, for the message.
        """
        self.formulation.require_bends(what)

    def thermal_strain(
        self, expansion: float, rise: float, gradient: Array | float, what: str
    ) -> Array:
        """Stress-free strain of a section that is warmer by ``rise + gradient · (y, z)``, (6,).

        Args:
            expansion: Coefficient of thermal expansion.
            rise: Temperature change at the axis.
            gradient: Temperature gradient along e₂ and e₃, shape (2,), or 0.
            what: Name of the gradient, for messages.
        """
        # ε(y, z) = Γ₁ + z κ₂ − y κ₃
        y, z = vector(gradient if np.any(gradient) else np.zeros(2), 2, what)
        return expansion * np.array([rise, 0, 0, 0, z, -y])

    def rotation_limit(self) -> RotationLimit:
        """Limit of the relative rotation of the frames at both ends of each element."""
        along = self.elements[:, [0, *range(2, self.elements.shape[1]), 1]]
        limit, numbers = self.formulation.largest_turn, np.arange(len(along))
        # edges joined by rotational springs are inclined to the frames at their ends
        lengths = self.lengths if self.formulation.bends else None
        return RotationLimit(
            along, numbers, limit, whole=True, lengths=lengths, elongations=self._elongations()
        )

    def _elongations(self) -> Array | None:
        """Elongation at which arcs with bending flexibility are straight, shape (m,).

        An arc is longer than its chord by ``θ²/24``. Linear bending, by which an element extends,
        does not end there. It matters only to elements whose sagitta is large compared to the
        radius of gyration: all others are infinite.
        """
        stiffness = self.element_stiffness
        if stiffness is self.stiffness:
            return None
        section, effective = (np.linalg.inv(D)[:, 0, 0] for D in (self.stiffness, stiffness))
        by_bending = 1.0 - section / effective
        soft = by_bending > _BY_BENDING
        if not soft.any():
            return None
        a, b = (self.frames[self.elements[:, k]] for k in (0, 1))
        angles = np.linalg.norm(lie.se3_relative(a, b)[:, 3:], axis=1)
        limits = np.full(len(soft), np.inf)
        limits[soft] = angles[soft] ** 2 / 24 / by_bending[soft]
        return limits


class Beam(LineBody):
    """Shear-deformable beam with a 6×6 section stiffness along straight or curved lines.

    Lines may be twisted, kinked and branching. Nodes ``0 … n−1`` are the points of the mesh. Kinks
    and branches have further nodes, one for each direction, rigidly attached to the first; nodes
    inside elements come last.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> tube = fl.Section.circle(0.01, steel)
        >>> beam = fl.Beam.straight((0, 0, 0), (1, 0, 0), tube, cells=4)
        >>> beam.frames.shape
        (5, 4, 3)
        >>> beam.point("end").position
        array([1., 0., 0.])
    """

    model: BeamModel
    _model_class: ClassVar[type[BeamModel]] = BeamModel
    _default: ClassVar[BeamFormulation] = GeodesicBeam()
    _has_springs: ClassVar[bool] = False

    def __init__(
        self,
        mesh: LineMesh | dolfinx.mesh.Mesh,
        section: Sections,
        *,
        up: Up | Twisted | None = None,
        formulation: BeamFormulation | None = None,
        damping: Damping | None = None,
        rotary_inertia: bool = True,
        name: str = "",
    ) -> None:
        """Create the nodes: e₁ along the line, e₃ as close as possible to ``up``.

        Args:
            mesh: Line mesh, or a DOLFINx mesh, see
                :func:`~fem_lie.mesh.reading.lines_from_dolfinx`. All lines that meet at a point are
                rigidly connected there.
            section: One for all cells, one for each named group of cells, or a function of arc
                length (taper), evaluated at the middle of each cell.
            up: Direction that e₃ is closest to, for all cells or for named groups. Default: frames
                without twist along the line (Bishop), starting with e₃ closest to global z, or to x
                if the line starts along z. :class:`~.orientation.Twisted` rotates the sections
                relative to that.
            formulation: Finite element; default: :class:`~fem_lie.elements.GeodesicBeam`, for
                rods :class:`~fem_lie.elements.KirchhoffRod`.
            damping: Damping of strain and of motion; default: none.
            rotary_inertia: Whether sections have rotary inertia about e₂ and e₃. Without it only
                the fast modes of these rotations vanish; rotary inertia about e₁ remains.
            name: Name in messages and results.

        Raises:
            ValueError: A cell has no section, ``up`` is along the line, or twist or taper is given
                for a mesh of several pieces.
        """
        mesh = line_of(mesh, type(self).__name__)
        known = "a Section, a dict of them by groups of cells or a function of arc length"
        instance(section, Section | Mapping | Callable, "Beam: section", known)
        instance(formulation, BeamFormulation | None, "Beam: formulation", "an element or None")
        instance(damping, Damping | None, "Beam: damping", "a Damping or None")
        flag(rotary_inertia, "Beam: rotary_inertia")
        chains = Chains(mesh)
        twisted = up if isinstance(up, Twisted) else Twisted(None, up)
        ends = cell_frames(mesh, chains, twisted.up, twisted.angle)
        frames, elements, masters = shared_nodes(mesh, ends)
        # the geodesic of an arc with tangent frames is the arc itself
        a, b = frames[elements].transpose(1, 0, 2, 3)
        lengths = np.linalg.norm(lie.se3_relative(a, b)[:, :3], axis=1)
        formulation = self._default if formulation is None else formulation
        if formulation.node_type != NodeType.FRAME:
            raise ValueError(
                f"Beam: expected a formulation whose nodes are frames, got {formulation}, an "
                "element of cables"
            )
        if not (formulation.bends or self._has_springs):
            raise ValueError(
                f"Beam: expected a formulation with bending, got {formulation}: use Rod"
            )
        placed = _refined(Placed(frames, elements, lengths, masters, elements), formulation)
        sections = section_per_cell(mesh, chains, section)
        names = type(self).__name__, name
        model = self._model_class(mesh, placed, sections, formulation, damping, *names)
        model.chains = chains
        if not rotary_inertia:
            model.density = without_rotary_inertia(model.density)
        super().__init__(model)
        log_open_profiles(self.label, sections, float(chains.arc.max(initial=0.0)))

    @classmethod
    def straight(
        cls,
        start: npt.ArrayLike,
        end: npt.ArrayLike,
        section: Section | Callable[[float], Section],
        *,
        cells: int,
        up: npt.ArrayLike | Twisted | None = None,
        formulation: BeamFormulation | None = None,
        damping: Damping | None = None,
        name: str = "",
    ) -> Beam:
        """Straight beam from ``start`` to ``end`` with ``cells`` equal elements.

        Its named points are "start" and "end"; other arguments as of :class:`Beam`.

        Args:
            start: First point, shape (3,).
            end: Last point, shape (3,).
            section: Cross-section: one for all cells, or a function of arc length (taper).
            cells: Number of equal elements.
            up: Direction nearest to which e₃ is to be, or a twist; default: no twist.
            formulation: The element; default: that of the class.
            damping: Damping; default: none.
            name: Name in messages and results.
        """
        return cls(
            straight_line(start, end, cells),
            section,
            up=up,
            formulation=formulation,
            damping=damping,
            name=name,
        )

    @classmethod
    def polyline(
        cls,
        points: Sequence[npt.ArrayLike] | npt.ArrayLike,
        section: Section | Mapping[str, Section],
        *,
        cells: int | Sequence[int],
        up: Up | Twisted | None = None,
        formulation: BeamFormulation | None = None,
        damping: Damping | None = None,
        name: str = "",
    ) -> Beam:
        """Straight segments through points, shape (n, 3), rigidly joined at corners of any angle.

        Named points are "start", "end", "corner 1", "corner 2" and so on, groups of cells "piece 1"
        and so on. If the last point equals the first, the line is closed. ``cells`` is the number
        of equal elements of each segment, one for all or one each.

        Args:
            points: Corners, shape (n, 3); the line is closed if the last one is the first.
            section: Cross-section: one for all cells, or one for each named group.
            cells: Number of equal elements of each piece, one for all or one for each.
            up: Direction nearest to which e₃ is to be, or a twist; default: no twist.
            formulation: The element; default: that of the class.
            damping: Damping; default: none.
            name: Name in messages and results.
        """
        return cls(
            polyline(points, cells),
            section,
            up=up,
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
        formulation: BeamFormulation | None = None,
        damping: Damping | None = None,
        name: str = "",
    ) -> Beam:
        """Beam along the curve ``function(s)``, s from 0 to 1, with points "start" and "end".

        If it ends where and in the direction in which it begins, it is closed and has no "end".

        Args:
            function: Position, shape (3,), as a function of the parameter from 0 to 1.
            section: Cross-section: one for all cells, or a function of arc length (taper).
            cells: Number of equal elements.
            up: Direction nearest to which e₃ is to be, or a twist; default: no twist.
            formulation: The element; default: that of the class.
            damping: Damping; default: none.
            name: Name in messages and results.
        """
        return cls(
            curve(function, cells),
            section,
            up=up,
            formulation=formulation,
            damping=damping,
            name=name,
        )

    def point_in_cell(self, element: int, part: float) -> Point:
        """Point within an element, as the element interpolates it, or one of its nodes.

        Args:
            element: Index of the element.
            part: Unloaded arc length from its first end over its length, 0 to 1.

        Raises:
            ValueError: There is no such element, or ``part`` is out of range.
        """
        return self._at(self.model.point_in_cell(element, part))


def _refined(placed: Placed, formulation: BeamFormulation) -> Placed:
    """Add the nodes inside elements, if the formulation has any."""
    if formulation.degree == 1:
        return placed
    if formulation.degree != 2:
        raise ValueError(f"elements of degree 1 and 2 are known, got {formulation}")
    frames, (a, b) = placed.frames, placed.elements.T
    middle = len(frames) + np.arange(len(a))
    halves = np.stack([np.column_stack([a, middle]), np.column_stack([middle, b])], axis=1)
    return Placed(
        np.concatenate([frames, middle_frames(frames[a], frames[b])]),
        np.column_stack([a, b, middle]),
        placed.lengths,
        np.concatenate([placed.masters, middle]),
        halves.reshape(-1, 2),
    )
