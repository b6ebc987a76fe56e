"""Common base of cables and nets, and convected axes of their nodes.

The axes of a position-gradient node rotate with the tangent by the smallest rotation, which does
not include rotation about the tangent; those of a position node do not rotate. A curved cable that
rotates about its chord therefore has a matrix that changes. Convected axes remove the mean rotation
``Q`` of the whole body since the start::

    A = Σ e ⊗ E over all edges,  Q = polar A,    R_i = polar(t ⊗ T + μ Q),  polar(Σ e ⊗ E + μ Q)

with edges ``e`` and tangents ``t``, and ``E`` and ``T`` at the start; the first ``R_i`` is that of
a position-gradient node, the second that of a position node with its adjacent edges. For small
``μ`` it is the smallest rotation relative to ``Q``, without its singularity. A superposed rigid
motion rotates all axes equally, so that components do not change. The axes depend on the current
state only.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeVar

import numpy as np

from fem_lie._arrays import Array, Indices, instance, members_within
from fem_lie._jit import compiled
from fem_lie.bodies.beams.assembly import BeamAssembly
from fem_lie.bodies.beams.line_body import LineBody, LineModel, Placed, SmoothLine
from fem_lie.bodies.body import Point
from fem_lie.bodies.model import NO_HOLDS, AxesUpdate, HeldRotation, Holds, MaterialPoint
from fem_lie.bodies.points import require_point
from fem_lie.elements.beams.element import BeamFormulation
from fem_lie.elements.rods.bends import BendingSprings, Bends, Successive
from fem_lie.elements.rods.discrete import DiscreteCable
from fem_lie.forms.assembly import Assembly
from fem_lie.lie.node_types import TRAITS, NodeType
from fem_lie.lie.polar import polar_rotation
from fem_lie.mesh.lines import LineMesh
from fem_lie.sections.material import Damping
from fem_lie.sections.section import Section

_MEAN = 0.1
"""Weight ``μ`` of the mean rotation."""

_TAUT = 1.0 - 1e-3  # chords of a curved line are shorter than it, too
_STRAIGHT = 1e-6  # second singular value of A at the start over the first


@compiled
def _rotate(
    coordinates: Array, edges: Indices, begun: tuple[Array, Array], slopes: bool, moments: Array
) -> None:
    """Rotate the axes in ``coordinates`` (n, 4, 3); ``moments`` is a work array (n + 1, 3, 3).

    ``begun`` are unit edges (m, 3) and axes (n, 3, 3) at the start.
    """
    E, axes = begun
    n = coordinates.shape[0]
    moments[:] = 0.0
    R, Q = np.empty((3, 3)), np.empty((3, 3))
    for k in range(edges.shape[0]):
        a, b = edges[k]
        e = coordinates[b, 0] - coordinates[a, 0]
        e /= np.sqrt((e * e).sum())
        part = np.outer(e, E[k])
        moments[n] += part
        if not slopes:
            moments[a] += part
            moments[b] += part
    if not polar_rotation(moments[n], Q):
        return
    for i in range(n):
        F = moments[i]
        tangent = coordinates[i, 1] / np.sqrt((coordinates[i, 1] * coordinates[i, 1]).sum())
        if slopes:
            F += np.outer(tangent, axes[i, 0])
        if not polar_rotation(F + _MEAN * Q, R):
            continue
        new = axes[i] @ R.T
        if slopes:
            second = new[1] - (new[1] * tangent).sum() * tangent
            size = np.sqrt((second * second).sum())
            if not size > _MEAN:
                continue
            coordinates[i, 2] = second / size
            coordinates[i, 3] = np.cross(tangent, coordinates[i, 2])
        else:
            coordinates[i, 1:] = new


def axes_rotation(frames: Array, edges: Indices, slopes: bool) -> AxesUpdate | None:
    """Function that rotates the axes; ``None`` for a straight body, whose rotation is undefined.

    Args:
        frames: Nodal coordinates at the start, shape (n, 4, 3).
        edges: Pairs of nodes, shape (m, 2).
        slopes: Whether nodes are position-gradient nodes.
    """
    chords = np.diff(frames[edges, 0], axis=1)[:, 0]
    E = chords / np.linalg.norm(chords, axis=1, keepdims=True)
    values = np.linalg.svd(E.T @ E, compute_uv=False)
    if values[1] <= _STRAIGHT * values[0]:
        return None
    axes = frames[:, 1:].copy()
    axes[:, 0] /= np.linalg.norm(axes[:, 0], axis=1, keepdims=True)
    moments = np.empty((len(frames) + 1, 3, 3))

    def rotate(coordinates: Array) -> None:
        _rotate(coordinates, edges, (E, axes), slopes, moments)

    return rotate


_EI = 4
"""Index of ``EI`` in the section stiffness on (Γ, κ)."""


class CableModel(LineModel):
    """Model of a body along lines without directions across them.

    Attributes:
        clamped_nodes: Nodes whose directions are held by rotational springs.
        convects_axes: Whether nodal axes rotate with the body.
        successive: Pairs of elements with a rotational spring.
        inner_springs: These springs; ``None`` if elements bend.
        own: Number of elements with stiffness and mass; those after them, which a part of a body
            may have, hold the nodes of its springs only.
    """

    def __init__(
        self,
        mesh: LineMesh,
        placed: Placed,
        successive: Successive,
        section: Section,
        formulation: BeamFormulation,
        damping: Damping | None,
        class_name: str,
        name: str,
    ) -> None:
        """Check that the element supports the section and the damping.

        Args:
            mesh: Line mesh.
            placed: Nodes and elements.
            successive: Pairs of elements with a rotational spring, for elements without bending
                stiffness.
            section: Section of all elements.
            formulation: Finite element.
            damping: Damping; default: none.
            class_name: Name of the class of the body.
            name: Name in messages and results.

        Raises:
            ValueError: The element does not support the section or the damping, or its nodes are
                frames.
            TypeError: An argument has an unexpected type.
        """
        instance(section, Section, f"{class_name}: section", "a Section")
        instance(damping, Damping | None, f"{class_name}: damping", "a Damping or None")
        if formulation.node_type == NodeType.FRAME:
            raise ValueError(
                f"{class_name}: expected a formulation with positions and position gradients, got "
                f"{formulation}, whose nodes are frames"
            )
        formulation.check(section.stiffness)
        if damping is not None:
            _check_damping(damping, formulation)
        sections = [section] * len(placed.elements)
        super().__init__(mesh, placed, sections, formulation, damping, class_name, name)
        self.clamped_nodes: list[int] = []
        self.convects_axes, self.own, self.successive = False, len(self.elements), successive
        self.inner_springs: Bends | None = None
        if isinstance(formulation, DiscreteCable):
            positions = self.frames[:, 0]
            self.inner_springs = Bends.between(
                positions, successive, self._flexibility(), formulation.natural
            )

    @classmethod
    def assemble(cls, models: Sequence[Any], holds: Holds = NO_HOLDS) -> Assembly:
        """Assembly of all bodies of one kind, with the springs between their elements."""
        assembly = BeamAssembly(models)
        starts = np.cumsum([0, *(len(model.frames) for model in models)])
        found = [
            part._replace(nodes=assembly.order[part.nodes + start])
            for model, start in zip(models, starts, strict=False)
            for part in model.bending_springs
        ]
        if found:
            assembly.further_terms.append(BendingSprings(Bends.joined(found), assembly.count))
        return assembly

    @property
    def laid_short(self) -> bool:
        """Whether it is laid along a line that is shorter than it, and resists compression."""
        chords = np.linalg.norm(np.diff(self.frames[self.elements[:, :2], 0], axis=1)[:, 0], axis=1)
        return not self.tension_only and bool(chords.sum() < _TAUT * self.lengths.sum())

    @property
    def smooth_lines(self) -> list[SmoothLine]:
        """Lines of successive elements."""
        links: dict[tuple[int, int], int] = {}
        both = np.column_stack([self.successive.nodes[:, 1], self.successive.edges])
        for k in range(len(both)):
            node, one, other = (int(number) for number in both[k])
            links[one, node], links[other, node] = other, one
        cells = self.elements[:, :2]
        ends = [(e, int(cells[e, k])) for e in range(len(cells)) for k in range(2)]
        found: list[SmoothLine] = []
        done: set[int] = set()
        # closed lines have no end: start them at the first node of their first element
        for start, node in [end for end in ends if end not in links] + ends[::2]:
            if start in done:
                continue
            nodes, e = [node], start
            own: list[int] = []
            while e not in done:
                done.add(e)
                own.append(e)
                a, b = (int(number) for number in cells[e])
                nodes.append(b if nodes[-1] == a else a)
                e = links.get((e, nodes[-1]), e)
            found.append(SmoothLine(np.array(nodes), np.array(own)))
        return found

    @property
    def divisible_cells(self) -> Indices | None:
        """Nodes of each element, and of those after it with a spring in between.

        ``None`` if nodal axes rotate with the whole body.
        """
        if self.convects_axes:
            return None
        if self.inner_springs is None:
            return self.elements
        first, second = self.successive.edges.T
        order = np.argsort(first, kind="stable")
        column = np.arange(len(order)) - np.searchsorted(first[order], first[order])
        after = np.tile(self.elements, 1 + column.max(initial=-1) + 1)
        for side in range(2):
            after[first[order], 2 * (1 + column) + side] = self.elements[second[order], side]
        return after

    def restricted(self, cells: Indices, holds: Sequence[HeldRotation]) -> tuple[Any, Indices]:
        """Model of some of its elements, with the springs of which they are the first.

        Args:
            cells: Indices of the elements, ascending, shape (s,).
            holds: Rotations of nodes of the whole body that joints, motions and moments act on.
        """
        if self.inner_springs is None:
            part, nodes = super().restricted(cells, holds)
            part.own = len(cells)
            return part, nodes
        held = np.flatnonzero(np.isin(self.successive.edges[:, 0], cells))
        after = np.setdiff1d(self.successive.edges[held, 1], cells)
        every = np.concatenate([cells, after])
        part, nodes = super().restricted(every, holds)
        part.own = len(cells)
        for name in "stiffness", "density":
            values = getattr(part, name).copy()
            values[part.own :] = 0.0
            setattr(part, name, values)
        part._groups = members_within(self._groups, cells)
        springs = self.inner_springs
        part.inner_springs = Bends(
            np.searchsorted(nodes, springs.nodes[held]), *(values[held] for values in springs[1:])
        )
        ends = [node for node in self.clamped_nodes if self.edge_at(node) in cells]
        part.clamped_nodes = [int(node) for node in np.searchsorted(nodes, ends)]
        return part, nodes

    @property
    def neighbour_cells(self) -> Indices:
        """Nodes of the elements of other parts to which springs of this part reach, (c, 2)."""
        return self.elements[self.own :]

    def cells_of(self, group: str | None = None) -> Indices:
        """Elements of a named group (default: all that have stiffness and mass).

        Args:
            group: Name of the group; default: all.
        """
        return np.arange(self.own) if group is None else super().cells_of(group)

    @property
    def bending_springs(self) -> list[Bends]:
        """Rotational springs between its elements, and at clamped ends; empty if elements bend."""
        if self.inner_springs is None:
            return []
        edges = np.array([self.edge_at(node) for node in self.clamped_nodes], dtype=np.int64)
        ends = self.elements[edges]
        nodes = np.array(self.clamped_nodes, dtype=np.int64)
        other = np.where(ends[:, 0] == nodes, ends[:, 1], ends[:, 0])
        # along the line into the body; scaled to the length of the edge, so that its round-off is
        # that of the edge in all units
        tangents, inwards = self.frames[nodes, 1], self.frames[other, 0] - self.frames[nodes, 0]
        signs = np.sign(np.einsum("bj,bj->b", tangents, inwards))
        fixed = tangents * (signs * np.linalg.norm(inwards, axis=1))[:, np.newaxis]
        pairs = np.column_stack([nodes, other])
        return [self.inner_springs, Bends.at_ends(pairs, fixed, self._flexibility(edges))]

    def closest(self, position: Array) -> MaterialPoint:
        """Closest node: joints and loads act at nodes only.

        Args:
            position: Position in the reference configuration, shape (3,).
        """
        return self.numbered(self.closest_node(position))

    def axes_update(self) -> AxesUpdate | None:
        """Function that rotates the axes, after a call of :meth:`convect_axes`."""
        return self.rotating_axes() if self.convects_axes else None

    def rotating_axes(self) -> AxesUpdate | None:
        """Function that rotates the axes; ``None`` if the body is straight."""
        return axes_rotation(
            self.frames, self.elements, self.node_type == NodeType.POSITION_GRADIENT
        )

    def has_drilling(self, holds: Sequence[HeldRotation] = ()) -> bool:
        """Whether nodes rotate about their third axes: true unless they have positions only.

        Raises:
            ValueError: Nodes have positions only, and a joint or load acts on their rotations.
        """
        if self.inner_springs is not None and any(hold.needed for hold in holds):
            self.require_direction(0)
        return True

    def require_direction(self, node: int) -> None:
        """Raise ``ValueError`` if its nodes have no direction that a clamp could hold.

        Args:
            node: Number of the node.
        """
        if self.inner_springs is not None:
            raise ValueError(
                f"{self.label} has positions and no directions at its nodes: clamp its ends by "
                "clamp(point), or hold positions by pin(point) and spherical joints"
            )

    def _flexibility(self, elements: Indices | slice = slice(None)) -> Array:
        """Bending flexibility ``ℓ/EI`` of some elements, by default of all, shape (m,)."""
        return np.asarray(self.lengths[elements] / self.stiffness[elements, _EI, _EI])

    def edge_at(self, node: int) -> int:
        """Element that ends at a node.

        Args:
            node: Number of the node.

        Raises:
            ValueError: The node is not an end of the body.
        """
        edges = np.flatnonzero((self.elements == node).any(axis=1))
        if len(edges) != 1:
            raise ValueError(
                f"the direction of {self.label} can be held at ends, but node {node} has "
                f"{len(edges)} elements"
            )
        return int(edges[0])


AnyCableBody = TypeVar("AnyCableBody", bound="CableBody")


class CableBody(LineBody):
    """Body along lines without directions across them."""

    model: CableModel

    def convect_axes(self: AnyCableBody) -> AnyCableBody:
        """Let nodal axes rotate with the body: ``Cable.curve(…).convect_axes()``.

        It is for cables that rotate or tumble, and for falling nets. The motion does not depend on
        it, but the iteration matrix stays valid longer. See :mod:`fem_lie.bodies.rods.cable_body`.

        Raises:
            ValueError: The body is straight, so that its rotation about the line is undefined.
        """
        if self.model.rotating_axes() is None:
            raise ValueError(
                f"follow: expected a body that is not straight, got {self.label}, whose rotation "
                "about its line is undefined: give it a small curvature"
            )
        self.model.convects_axes = True
        return self

    def pin(self, *points: Point) -> None:
        """Hold the positions of points of this body, not its directions there.

        Args:
            points: Points of the body.

        Raises:
            ValueError: A point is not on this body.
            TypeError: An argument is not a point.
        """
        for node in self._own(points, "pin"):
            self.model.held[node, :3] = True

    def clamp(self, *points: Point) -> None:
        """Hold the positions of points of this body, and its directions there.

        Args:
            points: Points of the body.

        Raises:
            ValueError: A point is not on this body, or is not an end of a discrete cable.
            TypeError: An argument is not a point.
        """
        model, nodes = self.model, self._own(points, "clamp")
        if model.inner_springs is not None:
            for node in nodes:
                model.edge_at(node)
            model.clamped_nodes += [node for node in nodes if node not in model.clamped_nodes]
        for node in nodes:
            model.held[node] |= np.array(TRAITS[model.node_type].clamp_holds)

    def _own(self, points: Sequence[Point], what: str) -> list[int]:
        for point in points:
            require_point(point, f"{type(self).__name__}.{what}: a point")
            if point.body is not self:
                raise ValueError(f"{self.label} cannot hold {point.label}, a point of another body")
        return [point.node for point in points]


def successive(elements: Indices) -> Successive:
    """Pairs of elements (m, 2) that meet at a node without other elements."""
    order = np.argsort(elements.ravel(), kind="stable")
    node = elements.ravel()[order]
    first = np.flatnonzero(node[:-1] == node[1:])
    edges = np.column_stack([order[first] // 2, order[first + 1] // 2])
    sides = np.column_stack([order[first] % 2, order[first + 1] % 2])
    ends = np.take_along_axis(elements[edges], (1 - sides)[:, :, np.newaxis], axis=2)[:, :, 0]
    return Successive(np.column_stack([ends[:, 0], node[first], ends[:, 1]]), edges)


def _check_damping(damping: Damping, formulation: BeamFormulation) -> None:
    """Raise ``ValueError`` if the element does not support the damping."""
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
