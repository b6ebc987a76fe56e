"""What all cables and nets have: nodes with positions and slopes, and their convected axes.

Axes of threads' nodes that follow the motion of what is around them.

Axes of a slope that go along by the smallest rotation of its tangent do not see a rotation about
it, and those of a place stay as they are: a bent cable that whirls has a matrix that changes. Here
the mean rotation ``Q`` of the whole body since the start is taken out first::

    A = Σ e ⊗ E over all edges,  Q = polar A,    R_i = polar(t ⊗ T + μ Q),  polar(Σ e ⊗ E + μ Q)

with edges ``e`` and tangents ``t``, ``E`` and ``T`` at the start; the first is of a slope, the
second of a place with the edges that it has. For small ``μ`` that is the smallest rotation of what
``Q`` leaves, without its singularity. A superposed rigid motion turns all axes alike, so that
nothing is different in them. It depends on the state alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeVar

import numpy as np

from fem_lie._arrays import Array, Indices, instance
from fem_lie._jit import compiled
from fem_lie.bodies.beams.assembly import BeamAssembly
from fem_lie.bodies.beams.line_body import LineBody, Placed
from fem_lie.bodies.body import NO_HOLDS, Body, Holds, Point
from fem_lie.bodies.nodes import Follower, HeldRotation
from fem_lie.bodies.points import require_point
from fem_lie.elements.beams.element import Formulation
from fem_lie.elements.rods.bends import BendingSprings, Bends, Successive
from fem_lie.elements.rods.discrete import DiscreteCable
from fem_lie.forms.assembly import Assembly
from fem_lie.lie.node_types import TRAITS, NodeType
from fem_lie.lie.polar import polar_rotation
from fem_lie.mesh.lines import LineMesh
from fem_lie.sections.material import Damping
from fem_lie.sections.section import Section

_MEAN = 0.1
"""``μ``."""

_STRAIGHT = 1e-6  # second singular value of A at the start over the first


@compiled
def _turn(
    rows: Array, edges: Indices, begun: tuple[Array, Array], slopes: bool, moments: Array
) -> None:
    """Turn the axes of ``rows`` (n, 4, 3); ``moments`` is room for (n + 1, 3, 3).

    ``begun`` are edges over their lengths (m, 3) and axes (n, 3, 3) at the start.
    """
    E, axes = begun
    n = rows.shape[0]
    moments[:] = 0.0
    R, Q = np.empty((3, 3)), np.empty((3, 3))
    for k in range(edges.shape[0]):
        a, b = edges[k]
        e = rows[b, 0] - rows[a, 0]
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
        tangent = rows[i, 1] / np.sqrt((rows[i, 1] * rows[i, 1]).sum())
        if slopes:
            F += np.outer(tangent, axes[i, 0])
        if not polar_rotation(F + _MEAN * Q, R):
            continue
        new = axes[i] @ R.T
        if slopes:
            beside = new[1] - (new[1] * tangent).sum() * tangent
            size = np.sqrt((beside * beside).sum())
            if not size > _MEAN:
                continue
            rows[i, 2] = beside / size
            rows[i, 3] = np.cross(tangent, rows[i, 2])
        else:
            rows[i, 1:] = new


def following(frames: Array, edges: Indices, slopes: bool) -> Follower | None:
    """What turns the axes, or ``None`` if the body is straight, so that its rotation is not known.

    Args:
        frames: At the start, shape (n, 4, 3).
        edges: Pairs of nodes, shape (m, 2).
        slopes: Whether nodes have slopes, which are in the second rows.
    """
    chords = np.diff(frames[edges, 0], axis=1)[:, 0]
    E = chords / np.linalg.norm(chords, axis=1, keepdims=True)
    values = np.linalg.svd(E.T @ E, compute_uv=False)
    if values[1] <= _STRAIGHT * values[0]:
        return None
    axes = frames[:, 1:].copy()
    axes[:, 0] /= np.linalg.norm(axes[:, 0], axis=1, keepdims=True)
    moments = np.empty((len(frames) + 1, 3, 3))

    def turn(rows: Array) -> None:
        _turn(rows, edges, (E, axes), slopes, moments)

    return turn


AnyThreads = TypeVar("AnyThreads", bound="Threads")

_EI = 4
"""Where it is in a section's stiffness on (Γ, κ)."""


class Threads(LineBody):
    """Lines without directions across."""

    def __init__(
        self,
        mesh: LineMesh,
        placed: Placed,
        successive: Successive,
        section: Section,
        formulation: Formulation,
        damping: Damping | None,
        name: str,
    ) -> None:
        """Refuse what an element has no unknowns for.

        Args:
            mesh: The lines.
            placed: Their nodes.
            successive: Elements that bend together, where elements do not bend themselves.
            section: Of all of it.
            formulation: The element.
            damping: Default: none.
            name: For messages and results.

        Raises:
            ValueError: The element has no unknowns for the section or the damping, or is one of
                frames.
            TypeError: An argument is of another kind than wanted.
        """
        what = type(self).__name__
        instance(section, Section, f"{what}: section", "a Section")
        instance(damping, Damping | None, f"{what}: damping", "a Damping or None")
        if formulation.node_type == NodeType.FRAME:
            raise ValueError(
                f"a {what} has nodes of places and slopes, those of {formulation} are frames"
            )
        formulation.check(section.stiffness)
        if damping is not None:
            _check_damping(damping, formulation)
        sections = [section] * len(placed.elements)
        super().__init__(mesh, placed, sections, formulation, damping, name)
        self._clamped: list[int] = []
        self._follows = False
        self._springs: Bends | None = None
        if isinstance(formulation, DiscreteCable):
            places = self.frames[:, 0]
            self._springs = Bends.between(
                places, successive, self._flexibility, formulation.natural
            )

    @classmethod
    def assemble(cls, bodies: Sequence[Any], holds: Holds = NO_HOLDS) -> Assembly:
        """All of one kind together, with the springs between their elements."""
        assembly = BeamAssembly(bodies)
        starts = np.cumsum([0, *(len(body.frames) for body in bodies)])
        found = [
            part._replace(nodes=assembly.order[part.nodes + start])
            for body, start in zip(bodies, starts, strict=False)
            for part in body.bends
        ]
        if found:
            assembly.beside.append(BendingSprings(Bends.joined(found), assembly.count))
        return assembly

    @property
    def bends(self) -> list[Bends]:
        """Springs between its elements, and at clamped ends, if elements do not bend themselves."""
        if self._springs is None:
            return []
        edges = np.array([self._edge_at(node) for node in self._clamped], dtype=np.int64)
        ends = self.elements[edges]
        nodes = np.array(self._clamped, dtype=np.int64)
        other = np.where(ends[:, 0] == nodes, ends[:, 1], ends[:, 0])
        # along the line at the end, and into it; as long as the edge, so that round-off of its
        # direction is that of the edge in all units
        tangents, inwards = self.frames[nodes, 1], self.frames[other, 0] - self.frames[nodes, 0]
        signs = np.sign(np.einsum("bj,bj->b", tangents, inwards))
        fixed = tangents * (signs * np.linalg.norm(inwards, axis=1))[:, np.newaxis]
        pairs = np.column_stack([nodes, other])
        return [self._springs, Bends.at_ends(pairs, fixed, self._flexibility[edges])]

    def follow(self: AnyThreads) -> AnyThreads:
        """Let axes of the nodes follow the motion: ``Cable.curve(…).follow()``.

        For cables that whirl or tumble, and nets that fall: nothing changes but the components in
        which equations are written, so that the matrix stays good for longer. See
        :mod:`fem_lie.bodies.rods.following`.

        Raises:
            ValueError: It is laid straight, so that its rotation is not known.
        """
        if self._following() is None:
            raise ValueError(
                f"{self.label} is laid straight, and has no rotation about its line that its axes "
                "could follow: lay it a little bent"
            )
        self._follows = True
        return self

    def _closest(self, position: Array) -> Point:
        """The closest node: between nodes nothing is attached."""
        return Body._closest(self, position)

    def follower(self) -> Follower | None:
        """As :meth:`follow` says."""
        return self._following() if self._follows else None

    def _following(self) -> Follower | None:
        return following(self.frames, self.elements, self.node_type == NodeType.POSITION_GRADIENT)

    def pin(self, *points: Point) -> None:
        """Hold the places of points of this body, and leave its directions there free.

        Raises:
            ValueError: One is not a point of this body.
            TypeError: One is no point.
        """
        for node in self._own(points, "pin"):
            self.held[node, :3] = True

    def clamp(self, *points: Point) -> None:
        """Hold the places of points of this body, and its directions there.

        Raises:
            ValueError: One is not a point of this body; one of a discrete rod is no end.
            TypeError: One is no point.
        """
        nodes = self._own(points, "clamp")
        if self._springs is not None:
            for node in nodes:
                self._edge_at(node)
            self._clamped += [node for node in nodes if node not in self._clamped]
        for node in nodes:
            self.held[node] |= np.array(TRAITS[self.node_type].clamped)

    def drills(self, holds: Sequence[HeldRotation] = ()) -> bool:
        """Whether its nodes turn: as all but those that are places.

        Raises:
            ValueError: They are, and something takes hold of their rotations.
        """
        if self._springs is not None and any(hold.needed for hold in holds):
            self.require_direction(0)
        return True

    def require_direction(self, node: int) -> None:
        """Raise ``ValueError`` if its nodes have none that a clamp could hold."""
        if self._springs is not None:
            raise ValueError(
                f"{self.label} has places and no directions at its nodes: clamp its ends by "
                "clamp(point), or hold places by pin(point) and spherical joints"
            )

    @property
    def _flexibility(self) -> Array:
        """``ℓ/EI`` of each element."""
        return np.asarray(self.lengths / self.stiffness[:, _EI, _EI])

    def _own(self, points: Sequence[Point], what: str) -> list[int]:
        for point in points:
            require_point(point, f"{type(self).__name__}.{what}: a point")
            if point.body is not self:
                raise ValueError(f"{self.label} cannot hold {point.label}: it is not its own")
        return [point.node for point in points]

    def _edge_at(self, node: int) -> int:
        edges = np.flatnonzero((self.elements == node).any(axis=1))
        if len(edges) != 1:
            raise ValueError(
                f"the direction of {self.label} can be held at ends, but node {node} has "
                f"{len(edges)} elements"
            )
        return int(edges[0])


def successive(elements: Indices) -> Successive:
    """Elements (m, 2) that meet at a node that no other has."""
    order = np.argsort(elements.ravel(), kind="stable")
    node = elements.ravel()[order]
    first = np.flatnonzero(node[:-1] == node[1:])
    edges = np.column_stack([order[first] // 2, order[first + 1] // 2])
    sides = np.column_stack([order[first] % 2, order[first + 1] % 2])
    ends = np.take_along_axis(elements[edges], (1 - sides)[:, :, np.newaxis], axis=2)[:, :, 0]
    return Successive(np.column_stack([ends[:, 0], node[first], ends[:, 1]]), edges)


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
