"""Beams with sections that distort and warp in few modes."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from fem_lie import lie
from fem_lie._arrays import Array, Flags, Indices, instance, number
from fem_lie.attachments.section_point import on_distorting_section
from fem_lie.bodies.beams.beam import BeamModel
from fem_lie.bodies.beams.line_body import LineBody, Placed
from fem_lie.bodies.body import Point
from fem_lie.bodies.cells.assembly import assemble_cells
from fem_lie.bodies.distorting.element import (
    FUNCTIONS,
    PER_NODE,
    data_of,
    element_of,
    modal_nodes,
)
from fem_lie.bodies.model import NO_HOLDS, Holds, MaterialPoint
from fem_lie.bodies.points import require_point
from fem_lie.elements.beams.directors import DirectorBeam
from fem_lie.forms.small_energy.assembly import ElementAssembly
from fem_lie.forms.small_energy.element import packed
from fem_lie.lie.node_types import NodeType
from fem_lie.mesh.curves import curve, straight_line
from fem_lie.mesh.lines import LineMesh
from fem_lie.mesh.reading import line_of
from fem_lie.sections.distortion.distortion import Distortion
from fem_lie.sections.material import Damping
from fem_lie.sections.orientation import Chains, Twisted, Up, cell_frames, shared_nodes

if TYPE_CHECKING:
    import dolfinx

_LINEAR = np.array([[2.0, 1.0], [1.0, 2.0]]) / 6


class DistortingBeamModel(BeamModel):
    """Model of a beam with sections that distort.

    Nodes with frames come first, then the modal nodes of each of them.

    Attributes:
        distortion: Section of all elements.
    """

    distortion: Distortion

    def __init__(
        self,
        mesh: LineMesh,
        frames: Array,
        elements: Indices,
        distortion: Distortion,
        damping: Damping,
        class_name: str,
        name: str,
    ) -> None:
        """Create the nodes.

        Args:
            mesh: Line mesh with names of points and groups.
            frames: Frames of the points, shape (p, 4, 3).
            elements: Points at the ends of each element, shape (m, 2).
            distortion: Section of all elements.
            damping: Mass-proportional damping.
            class_name: Name of the class of the body.
            name: Name in messages and results.
        """
        self.distortion, self._count = distortion, len(frames)
        lengths = np.linalg.norm(lie.se3_relative(*frames[elements].swapaxes(0, 1))[:, :3], axis=1)
        modal = np.zeros((self._count, modal_nodes(distortion.count), 4, 3))
        modal[:, :, 0] = frames[:, np.newaxis, 0]
        nodes = np.concatenate([frames, modal.reshape(-1, 4, 3)])
        placed = Placed(nodes, elements, lengths, np.arange(len(nodes)), elements)
        sections = [distortion.section] * len(elements)
        super().__init__(mesh, placed, sections, DirectorBeam(), damping, class_name, name)

    @property
    def node_types(self) -> Indices:
        """Type of each node, shape (n,): frames, then modal nodes."""
        kinds = np.full(len(self.frames), int(NodeType.MODAL), dtype=np.int64)
        kinds[: self._count] = int(NodeType.FRAME)
        return kinds

    @property
    def missing_unknowns(self) -> Flags:
        """Mask of the unused amplitudes of modal nodes, shape (n, 6)."""
        found = super().missing_unknowns
        modal = found[self._count :].reshape(self._count, -1)
        modal[:, self.distortion.count :] = True
        found[self._count :] = modal.reshape(-1, PER_NODE)
        return found

    @property
    def node_lengths(self) -> Flags:
        """Mask of vector unknowns that are lengths, shape (n, 2): amplitudes are."""
        lengths = super().node_lengths
        lengths[self._count :] = True
        return lengths

    @property
    def assembly_key(self) -> Hashable:
        """Key of bodies that are assembled together: equal numbers of amplitudes."""
        return type(self), self.distortion.count

    @classmethod
    def assemble(cls, models: Sequence[Any], holds: Holds = NO_HOLDS) -> ElementAssembly:
        """Assembly of all beams of one :attr:`assembly_key`."""
        of = element_of(models[0].distortion.count)
        assembly = assemble_cells(of, FUNCTIONS, models, packed(of.cells))
        assembly.label = "beams with sections that distort"
        return assembly

    @property
    def divisible_cells(self) -> None:
        """``None``: a beam with modal nodes stays in one piece."""

    @property
    def elastic_cells(self) -> Indices:
        """None: cells are not assembled individually."""
        return np.empty((0, 0), dtype=np.int64)

    def modal(self, node: int) -> Indices:
        """Modal nodes of a node with a frame.

        Args:
            node: Number of the node.
        """
        per_node = modal_nodes(self.distortion.count)
        return self._count + per_node * node + np.arange(per_node)

    def numbered(self, node: int) -> MaterialPoint:
        """Material point at a node with a frame; modal nodes have no points.

        Args:
            node: Number of the node; negative ones count from the last with a frame.

        Raises:
            ValueError: There is no such node.
        """
        if not -self._count <= node < self._count:
            raise ValueError(f"{self.label} has points 0 … {self._count - 1}, got {node}")
        return super().numbered(node % self._count)

    @property
    def element_nodes(self) -> Indices:
        """Nodes of each element, shape (m, k): frames of both ends, then their modal nodes."""
        per_node = np.arange(modal_nodes(self.distortion.count))
        modal = self._count + len(per_node) * self.elements[..., np.newaxis] + per_node
        return np.concatenate([self.elements, modal.reshape(len(self.elements), -1)], axis=1)

    def element_data(self) -> Array:
        """Data of the elements."""
        m, of = len(self.elements), element_of(self.distortion.count)
        section = self.distortion.stiffness, self.distortion.second_order
        each = (np.repeat(own[np.newaxis], m, axis=0) for own in section)
        return data_of(of, self.frames[self.elements], self.lengths, *each)

    def element_inertia(self) -> Array:
        """Mass matrix in the nodal coordinates of each element, shape (m, k, 4, k, 4).

        Amplitudes have the inertia of their mean square. It does not couple them with each other or
        with the frames, as their fields are orthogonal in mass.
        """
        m, per_node = len(self.elements), modal_nodes(self.distortion.count)
        weighted = self.lengths[:, np.newaxis, np.newaxis] * self.density
        found = np.zeros((m, 2 + 2 * per_node, 4, 2 + 2 * per_node, 4))
        found[:, :2, :, :2] = np.einsum("ij,eab->eiajb", _LINEAR, weighted)
        modal = np.kron(_LINEAR, np.eye(per_node))
        for row in (1, 2):
            found[:, 2:, row, 2:, row] = np.einsum("ij,e->eij", modal, weighted[:, 0, 0])
        return found


class DistortingBeam(LineBody):
    """Beam with sections that distort in their plane and warp, in few modes.

    A section moves rigidly with its node and deforms by amplitudes, which are further unknowns. The
    stiffness of both is that of :class:`~fem_lie.sections.Distortion`; where amplitudes are free
    and do not change, it is that of a beam. Axial stress has work in strains of second order: tubes
    flatten when they are bent, and thin walls buckle. The axis may move and rotate arbitrarily,
    amplitudes are small. Their inertia is that of small motions about the section: centrifugal and
    Coriolis forces do not distort it.

    Clamps and joints hold nodes; amplitudes stay free. :meth:`hold_shape` and :meth:`hold_warping`
    hold them. :meth:`section_point` is a point of the section that moves with its distortion.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> box = fl.sections.SectionShape.box(0.4, 0.2, 0.01)
        >>> section = fl.sections.Distortion(box.mesh, steel, modes=1)
        >>> beam = fl.reduction.DistortingBeam.straight((0, 0, 0), (4, 0, 0), section, cells=8)
        >>> beam.hold_shape(beam.point("start"))
        >>> corner = beam.section_point("end", 0.2, 0.1)
        >>> corner.position
        array([4. , 0.2, 0.1])
    """

    model: DistortingBeamModel

    def __init__(
        self,
        mesh: LineMesh | dolfinx.mesh.Mesh,
        section: Distortion,
        *,
        up: Up | Twisted | None = None,
        damping: Damping | None = None,
        name: str = "",
    ) -> None:
        """Create the nodes; arguments are similar to those of a :class:`~fem_lie.Beam`.

        Args:
            mesh: Line mesh without corners and branches; or a DOLFINx mesh of intervals.
            section: Section of all cells.
            up: Direction that e₃ is closest to.
            damping: Mass-proportional damping; there are no viscous forces.
            name: Name in messages and results.

        Raises:
            ValueError: The line has corners or branches, ``up`` is along the line, or there is
                damping of strain.
            TypeError: An argument has an unexpected type.
        """
        mesh = line_of(mesh, "DistortingBeam")
        instance(section, Distortion, "DistortingBeam: section", "a Distortion of a section")
        instance(damping, Damping | None, "DistortingBeam: damping", "a Damping or None")
        damping = Damping.of_mass(damping, "DistortingBeam")
        chains = Chains(mesh)
        twisted = up if isinstance(up, Twisted) else Twisted(None, up)
        frames, elements, _ = shared_nodes(
            mesh, cell_frames(mesh, chains, twisted.up, twisted.angle)
        )
        if len(frames) != len(mesh.points) or np.bincount(mesh.cells.ravel()).max() > 2:
            raise ValueError(
                "DistortingBeam: expected a smooth line, got one with corners or branches: make "
                "one beam of each smooth piece, and join them by fl.joints.Fixed"
            )
        model = DistortingBeamModel(
            mesh, frames, elements, section, damping, type(self).__name__, name
        )
        model.chains = chains
        super().__init__(model)

    @classmethod
    def straight(
        cls,
        start: npt.ArrayLike,
        end: npt.ArrayLike,
        section: Distortion,
        *,
        cells: int,
        up: npt.ArrayLike | Twisted | None = None,
        damping: Damping | None = None,
        name: str = "",
    ) -> DistortingBeam:
        """Straight beam with ``cells`` equal elements; points "start" and "end".

        Args:
            start: First point, shape (3,).
            end: Last point, shape (3,).
            section: Section of all cells.
            cells: Number of equal elements.
            up: Direction nearest to which e₃ is to be, or a twist; default: no twist.
            damping: Damping; default: none.
            name: Name in messages and results.
        """
        mesh = straight_line(start, end, cells)
        return cls(mesh, section, up=up, damping=damping, name=name)

    @classmethod
    def curve(
        cls,
        function: Callable[[float], npt.ArrayLike],
        section: Distortion,
        *,
        cells: int,
        up: npt.ArrayLike | Twisted | None = None,
        damping: Damping | None = None,
        name: str = "",
    ) -> DistortingBeam:
        """Beam along the curve ``function(s)``, s from 0 to 1, with points "start" and "end".

        Args:
            function: Position, shape (3,), as a function of the parameter from 0 to 1.
            section: Section of all cells.
            cells: Number of equal elements.
            up: Direction nearest to which e₃ is to be, or a twist; default: no twist.
            damping: Damping; default: none.
            name: Name in messages and results.
        """
        return cls(curve(function, cells), section, up=up, damping=damping, name=name)

    def hold_shape(self, *points: Point) -> None:
        """Hold the shape of sections in their plane, as diaphragms do; warping stays free.

        Args:
            points: Nodes of the beam.

        Raises:
            ValueError: A point is not a node of this beam.
            TypeError: An argument is not a point.
        """
        self._hold(points, slice(0, self.model.distortion.plane), "hold_shape")

    def hold_warping(self, *points: Point) -> None:
        """Hold the warping of sections, which stay plane.

        Args:
            points: Nodes of the beam.

        Raises:
            ValueError: A point is not a node of this beam.
            TypeError: An argument is not a point.
        """
        own = slice(self.model.distortion.plane, self.model.distortion.count)
        self._hold(points, own, "hold_warping")

    def _hold(self, points: Sequence[Point], amplitudes: slice, what: str) -> None:
        for point in points:
            require_point(point, f"{type(self).__name__}.{what}: a point")
            if point.body is not self or point.attachment is not None:
                raise ValueError(
                    f"{self.label} cannot hold {point.label}, which is not a node of it"
                )
            nodes = self.model.modal(point.node)
            held = self.model.held[nodes].ravel()
            held[amplitudes] = True
            self.model.held[nodes] = held.reshape(-1, PER_NODE)

    def section_point(self, where: str | int, y: float, z: float) -> Point:
        """Point of the section at a node, which moves with distortion and warping.

        Joints, springs and loads act on it; its axes are those of the section.

        Args:
            where: Name or number of a node.
            y: Coordinate along e₂ from the axis.
            z: Coordinate along e₃ from the axis.

        Raises:
            ValueError: There is no such node, or the point is not in the section.
        """
        node, model = self.point(where).node, self.model
        at = number(y, "section_point: y"), number(z, "section_point: z")
        modal = model.modal(node)
        fields = np.zeros((PER_NODE * len(modal), 3))
        fields[: model.distortion.count] = model.distortion.displacement(*at)
        frame = on_distorting_section(node, modal, np.array([0.0, *at]), fields)
        return self._at(MaterialPoint(node, f"{where} at ({y:g}, {z:g})", frame))

    def amplitudes(self, frames: Array) -> Array:
        """Amplitudes at the nodes with frames in states of its nodes, shape (…, p, n), lengths.

        Fields of unit amplitude have the mean square one.

        Args:
            frames: Nodal coordinates, shape (…, nodes, 4, 3), as :meth:`~fem_lie.Result.frames` of
                results.
        """
        count = len(self.model.frames) - self.model.modal(0)[0]
        modal = frames[..., -count:, 1:3, :]
        per_point = modal.reshape(*modal.shape[:-3], self.model.modal(0)[0], -1)
        return np.asarray(per_point[..., : self.model.distortion.count])
