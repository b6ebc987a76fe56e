"""Polyhedra in contact as packed arrays, for compiled code."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.contact.convex.polyhedron import Hull, hull_of
from fem_lie.contact.sides.surfaces import Ball, Face, Owner, Polyhedron
from fem_lie.contact.sides.table import Nodes, Side, balls_side, planes_side

BITS = 2**24
"""More than the number of corners of faces."""


class Polyhedra(NamedTuple):
    """All polyhedra, and the pairs that may touch.

    A contact of two polyhedra has a few pairs of points of its own, its slots, into which the
    contact manifold of each step is written.

    Attributes:
        corners: Corners of all polyhedra.
        faces: Faces of all polyhedra.
        centres: A point inside each polyhedron, with the radius of the enclosing ball.
        first: First corner, face and edge of each polyhedron, and after the last, shape (p + 1, 3).
        edges: Both corners and both faces of each edge, shape (E, 4).
        loops: Corners of all faces, one face after the other.
        begins: First index of each face in ``loops``, and after the last, shape (F + 1,).
        at: A corner of each face, shape (F,).
        pairs: Polyhedra that may touch, −1 instead of the first: a ball, shape (m, 2).
        thin: Sum of the radii of inscribed balls of each pair, shape (m,).
        slots: First slot of each pair among all pairs of points, and after the last, (m + 1,).
        ids: Identifier of the feature in each slot, for the next step, shape (s,).
        X: Present corners, shape (V, 3).
        N: Present normals of faces, shape (F, 3).
        polygon: Workspace for a polygon and the same one clipped, shape (2, ·, 3).
        marks: Identifiers of their corners and of the edges from these, shape (2, ·, 2).
        impulses: Workspace for the impulses of the last step, shape (·, 3).
        known: Workspace for the features that were in the slots, shape (·,).
    """

    corners: Side
    faces: Side
    centres: Side
    first: Indices
    edges: Indices
    loops: Indices
    begins: Indices
    at: Indices
    pairs: Indices
    thin: Array
    slots: Indices
    ids: Indices
    X: Array
    N: Array
    polygon: Array
    marks: Indices
    impulses: Array
    known: Indices


class ConvexSolid(ABC):
    """A ball or a polyhedron in contact with a polyhedron."""

    @property
    @abstractmethod
    def owners(self) -> tuple[Owner, ...]:
        """Bodies and nodes that it is fixed to."""

    @property
    @abstractmethod
    def polyhedra(self) -> Sequence[ConvexPolyhedron]:
        """The polyhedron itself; a ball has none."""

    @property
    @abstractmethod
    def inner(self) -> float:
        """Radius of the inscribed ball about the centre."""

    @property
    @abstractmethod
    def point(self) -> Ball:
        """Initial point in the slots of its contacts."""

    @abstractmethod
    def slots(self, other: ConvexPolyhedron) -> int:
        """Largest number of points in the contact manifold with a polyhedron."""


@dataclass(frozen=True, eq=False)
class ConvexBall(ConvexSolid):
    """A ball.

    Attributes:
        ball: The ball.
    """

    ball: Ball

    @property
    def owners(self) -> tuple[Owner, ...]:
        """Bodies and nodes that the ball is fixed to."""
        return self.ball.owners

    @property
    def polyhedra(self) -> Sequence[ConvexPolyhedron]:
        """None."""
        return ()

    @property
    def point(self) -> Ball:
        """The ball as a point with a radius."""
        return self.ball

    @property
    def inner(self) -> float:
        """The radius."""
        return self.ball.radius

    def slots(self, other: ConvexPolyhedron) -> int:
        """A ball touches a polyhedron at one point."""
        return 1


@dataclass(frozen=True, eq=False)
class ConvexPolyhedron(ConvexSolid):
    """A polyhedron, with its convex hull in the frame that it is fixed to.

    Attributes:
        polyhedron: The polyhedron.
    """

    polyhedron: Polyhedron

    @cached_property
    def hull(self) -> Hull:
        """Convex hull of the corners."""
        return hull_of(self.polyhedron.corners)

    @property
    def key(self) -> tuple[object, ...]:
        """Equal for polyhedra of the same shape on the same frame."""
        body, node = self.polyhedron.owner
        return id(body), node, self.polyhedron.corners.tobytes()

    @property
    def owners(self) -> tuple[Owner, ...]:
        """Body and node that the polyhedron is fixed to."""
        return (self.polyhedron.owner,)

    @property
    def polyhedra(self) -> Sequence[ConvexPolyhedron]:
        """The polyhedron itself."""
        return (self,)

    def balls(self) -> list[Ball]:
        """The corners."""
        return [self._ball(corner, 0.0) for corner in self.hull.corners]

    def faces(self) -> list[Face]:
        """The faces."""
        firsts = [self.hull.corners[loop[0]] for loop in self.hull.loops]
        return [
            Face(self.polyhedron.owner, first, np.asarray(normal))
            for first, normal in zip(firsts, self.hull.normals, strict=True)
        ]

    def centre(self) -> Ball:
        """Enclosing ball about the mean of the corners."""
        middle = self.hull.corners.mean(axis=0)
        return self._ball(middle, float(np.linalg.norm(self.hull.corners - middle, axis=1).max()))

    @property
    def inner(self) -> float:
        """Radius of the inscribed ball about the centre."""
        middle = self.hull.corners.mean(axis=0)
        firsts = np.array([self.hull.corners[loop[0]] for loop in self.hull.loops])
        return float(((firsts - middle) * self.hull.normals).sum(axis=1).min())

    @property
    def longest(self) -> int:
        """Largest number of corners of a face."""
        return max(map(len, self.hull.loops))

    @property
    def point(self) -> Ball:
        """The corner that is farthest from the origin of the frame."""
        corners = self.hull.corners
        return self._ball(corners[np.linalg.norm(corners, axis=1).argmax()], 0.0)

    def slots(self, other: ConvexPolyhedron) -> int:
        """A face clipped by another, and the closest corner."""
        return self.longest + other.longest + 1

    def _ball(self, position: Array, radius: float) -> Ball:
        return Ball(self.owners, np.ones(1), position[np.newaxis], radius)


class PolyhedronPair(NamedTuple):
    """A polyhedron, and a ball or polyhedron that touches it.

    Attributes:
        first: A ball, or a polyhedron.
        second: The polyhedron.
    """

    first: ConvexSolid
    second: ConvexPolyhedron

    @property
    def slots(self) -> int:
        """Largest number of points in the contact manifold."""
        return self.first.slots(self.second)

    @property
    def polyhedra(self) -> Sequence[ConvexPolyhedron]:
        """The one polyhedron, or both."""
        return (*self.first.polyhedra, *self.second.polyhedra)


def slots_of(pair: PolyhedronPair, nodes: Nodes) -> tuple[Side, Side]:
    """Points of the contact manifold of a pair: first and second ones.

    Args:
        pair: Pair that may touch.
        nodes: Gives the numbers of the nodes of a body in the scene.
    """
    first, second = (balls_side([each.point] * pair.slots, nodes) for each in pair)
    return first, second


def polyhedra_of(
    pairs: Sequence[PolyhedronPair], nodes: Nodes, on_masters: Callable[[Side], Side] | None
) -> Polyhedra:
    """All polyhedra of pairs, each once, and workspace for their contact manifolds.

    Args:
        pairs: Pairs that may touch.
        nodes: Gives the numbers of the nodes of a body in the scene.
        on_masters: Expresses a side by the master nodes of its nodes; default: no node is rigidly
            attached to another.
    """
    found = {each.key: each for pair in pairs for each in pair.polyhedra}
    number, shapes = {key: k for k, key in enumerate(found)}, list(found.values())
    sizes = [(len(s.hull.corners), len(s.hull.loops), len(s.hull.edges)) for s in shapes]
    first: Indices = np.cumsum([(0, 0, 0), *sizes], axis=0, dtype=np.int64)
    numbered: list[tuple[ConvexPolyhedron, Indices]] = list(zip(shapes, list(first), strict=False))
    loops = [loop + at[0] for shape, at in numbered for loop in shape.hull.loops]
    edges = [shape.hull.edges + np.repeat(at[:2], 2) for shape, at in numbered]
    sides = [
        balls_side([ball for shape in shapes for ball in shape.balls()], nodes),
        planes_side([face for shape in shapes for face in shape.faces()], nodes),
        balls_side([shape.centre() for shape in shapes], nodes),
    ]
    corners, faces, centres = sides if on_masters is None else map(on_masters, sides)
    counts = [pair.slots for pair in pairs]
    # -1 in front for a ball
    of = [[-1, *(number[each.key] for each in pair.polyhedra)][-2:] for pair in pairs]
    most, whole = 2 * max((shape.longest for shape in shapes), default=0) + 2, np.int64
    return Polyhedra(
        corners,
        faces,
        centres,
        first,
        edges=np.concatenate([np.empty((0, 4), whole), *edges]),
        loops=np.concatenate([np.empty(0, whole), *loops]),
        begins=np.cumsum([0, *map(len, loops)], dtype=whole),
        at=np.array([loop[0] for loop in loops], whole),
        pairs=np.array(of, whole).reshape(-1, 2),
        thin=np.array([a.inner + b.inner for a, b in pairs]),
        slots=np.cumsum([0, *counts], dtype=whole),
        ids=np.zeros(sum(counts), whole),
        X=np.empty((len(corners.radii), 3)),
        N=np.empty((len(faces.radii), 3)),
        polygon=np.empty((2, most, 3)),
        marks=np.empty((2, most, 2), whole),
        impulses=np.empty((most, 3)),
        known=np.empty(most, whole),
    )
