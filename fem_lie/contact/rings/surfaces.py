"""Ropes, as smooth curves through their nodes, and rings that they run through.

Along its undeformed length ``σ`` a rope is a cubic between nodes, see :mod:`.cubics`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices, indices_of, instance, numbers
from fem_lie.bodies.beams.line_body import LineBody
from fem_lie.bodies.body import Point
from fem_lie.bodies.points import require_node, require_point
from fem_lie.contact.rings.cubics import Cubics, cubics
from fem_lie.contact.sides.surfaces import ContactSurface, initial_frame
from fem_lie.lie.node_types import NodeType


@dataclass(frozen=True, eq=False)
class Rope(ContactSurface):
    """Contact surface: a cable, a cable of a net, or a beam that runs through rings.

    Attributes:
        body: Body with the nodes.
        nodes: Nodes of the rope in order; default: all nodes of the body.

    Example:
        >>> steel = fl.Material(E=2.1e11, nu=0.3, density=7800.0)
        >>> tube = fl.Section.circle(0.001, steel)
        >>> rope = fl.Cable.straight((0, 0, 0), (1, 0, 0), tube, cells=4)
        >>> bead = fl.RigidBody(0.1, (1e-4, 1e-4, 1e-4), position=(0.5, 0, 0))
        >>> scene = fl.Scene()
        >>> for body in (rope, bead):
        ...     _ = scene.add(body)
        ...
        >>> rings, law = fl.contact.Rings([bead.point("centre")]), fl.contact.Penalty(1e5,
        ...     friction=0.2)
        >>> _ = scene.add(fl.contact.Contact(fl.contact.Rope(rope), rings, law))
        >>> len(scene.contacts)
        1
    """

    body: LineBody
    nodes: Sequence[int] | None = None

    def __post_init__(self) -> None:
        """Raise ``TypeError`` or ``ValueError`` if an argument has a wrong type or value."""
        instance(self.body, LineBody, "Rope: body", "a Cable, a Net or a Beam")
        if self.nodes is not None:
            indices_of(self.nodes, len(self.body.frames), "Rope: nodes")

    @property
    def points(self) -> Sequence[Point]:
        """Both ends."""
        path = self.path
        return [Point(self.body, int(path[0])), Point(self.body, int(path[-1]))]

    @property
    def path(self) -> Indices:
        """Nodes in order."""
        given = range(len(self.body.frames)) if self.nodes is None else self.nodes
        return np.array(given, dtype=np.int64)

    @property
    def lengths(self) -> Array:
        """Undeformed distances of consecutive nodes.

        Raises:
            ValueError: Two consecutive nodes have no element between them.
        """
        known: dict[frozenset[int], float] = {}
        first, second = self.body.model.elements[:, 0], self.body.model.elements[:, 1]
        for one, other, length in zip(first, second, self.body.model.lengths, strict=True):
            known[frozenset((int(one), int(other)))] = float(length)
        path = [int(node) for node in self.path]
        pairs = [frozenset(pair) for pair in pairwise(path)]
        for pair, (a, b) in zip(pairs, pairwise(path), strict=True):
            if pair not in known:
                raise ValueError(
                    f"{self.label}: nodes {a} and {b} follow each other, but no element has them as"
                    " ends; give nodes=... along the rope"
                )
        return np.array([known[pair] for pair in pairs])

    def check(self) -> None:
        """Raise an error unless the rope is an open line of nodes of one type.

        Raises:
            ValueError: It is not, or its nodes have neither positions nor position gradients.
        """
        path, kinds = self.path, self.body.model.node_types[self.path]
        if len(path) < 3 or len(np.unique(path)) < len(path) or (kinds != kinds[0]).any():
            raise ValueError(
                f"{self.label}: a rope has three nodes or more of one type, each once, got "
                f"{len(path)}"
            )
        if kinds[0] not in (NodeType.FRAME, NodeType.POSITION_GRADIENT, NodeType.POSITION):
            self.body.model.require_frames(self.label)
        _ = self.lengths

    @property
    def positions(self) -> Array:
        """Initial positions of the nodes, shape (n, 3)."""
        return np.asarray(self.body.frames[self.path, 0])

    def controls(self) -> Cubics:
        """Cubic of each segment."""
        path = self.path
        types = np.asarray(self.body.model.node_types[path], dtype=np.int64)
        return cubics(self.body.frames[path], types, self.lengths)


@dataclass(frozen=True, eq=False)
class Rings(ContactSurface):
    """Contact surface: rings of zero width that a rope runs through, each fixed to a point.

    Attributes:
        of: The points: nodes of any type, points of rigid bodies, or ground.
        at: Initial positions of the rings, shape (k, 3); default: those of the points.

    Example:
        >>> hook = fl.RigidBody(0.1, (1e-4, 1e-4, 1e-4))
        >>> rings = fl.contact.Rings([hook.point("centre"), fl.ground()], at=[(0, 0, 0.1), (1, 0,
        ...     0)])
        >>> len(rings.positions)
        2
    """

    of: Sequence[Point]
    at: npt.ArrayLike | None = None

    def __post_init__(self) -> None:
        """Raise ``TypeError`` or ``ValueError`` if an argument has a wrong type or value."""
        instance(self.of, Sequence, "Rings: of", "points in a list")
        for point in self.of:
            require_point(point, "Rings: of")
        if not len(self.of):
            raise ValueError("Rings: of: expected at least one point, got none")
        if self.at is not None and numbers(self.at, "Rings: at").shape != (len(self.of), 3):
            raise ValueError(f"Rings: at must be {len(self.of)} positions, got {self.at!r}")

    @property
    def positions(self) -> Array:
        """Initial positions, shape (k, 3)."""
        if self.at is None:
            return np.array([point.position for point in self.of])
        return numbers(self.at, "Rings: at")

    @property
    def points(self) -> Sequence[Point]:
        """All points."""
        return self.of

    def check(self) -> None:
        """Raise an error if a ring cannot be fixed to its point.

        Raises:
            ValueError: A point is not a node, or a ring has an offset from a node without a frame.
        """
        for point, position in zip(self.of, self.positions, strict=True):
            require_node(point, self.label)
            if point.body is not None and (position != point.body.frames[point.node, 0]).any():
                point.body.model.require_frames(
                    f"{self.label}: a ring with an offset from its node"
                )

    def factors(self) -> Array:
        """Weights of coordinate vectors (x, d₁, d₂, d₃); positions of rings on ground; (k, 4)."""
        found = np.zeros((len(self.of), 4))
        for k, (point, position) in enumerate(zip(self.of, self.positions, strict=True)):
            H = initial_frame(point.body, point.node)
            found[k, 0] = float(point.body is not None)
            if point.body is None or (position != H[0]).any():
                found[k, 1:] = H[1:] @ (position - H[0])
        return found
