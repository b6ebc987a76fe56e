"""The two sides of a contact as packed arrays, for compiled code."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple, TypeAlias

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie._jit.packed_arrays import (
    Integers1,
    Integers2,
    Numbers1,
    Numbers2,
    Numbers3,
    Numbers4,
    PackedArrays,
    unpacking,
)
from fem_lie.bodies.body import Body
from fem_lie.contact.sides.surfaces import (
    MOST_NODES,
    Ball,
    Face,
    GapSurface,
    initial_frame,
    owner_of,
)

GROUND, UNUSED = -1, -2
"""Special node numbers: ground, and unused."""

ROUND, PLANE, LEVEL, EDGES, LINE, INACTIVE = range(6)
"""Kinds of pairs of points, see :mod:`.kinematics`; the last has no contact."""

Nodes: TypeAlias = Callable[[Body], Indices]
"""Gives the numbers of the nodes of a body in the scene."""


class Level(NamedTuple):
    """Gap function of surfaces other than planes.

    Attributes:
        address: Address of a compiled function, see :mod:`.gap_functions`; 0: none.
        parameters: Its parameters for each surface, shape (n, q).
    """

    address: int
    parameters: Numbers2


class Side(NamedTuple):
    """One side of a contact: points ``P = Σ (wᵢ xᵢ + Rᵢ cᵢ)`` with a radius, planes or surfaces.

    Attributes:
        nodes: Nodes of each point, :data:`UNUSED` after the last, shape (n, 4).
        weights: ``w``, shape (n, 4).
        arms: ``c``, shape (n, 4, 3).
        radii: Radius, negative for a hollow sphere, zero for a plane, shape (n,).
        normals: Normal of a plane, in the frame of its first node; else zero, shape (n, 3).
        owners: Number of the frame that each point is fixed to, shape (n,).
        level: Gap function of the position relative to the point, along the axes of the first node.
    """

    nodes: Integers2
    weights: Numbers2
    arms: Numbers3
    radii: Numbers1
    normals: Numbers2
    owners: Integers1
    level: Level

    @property
    def arrays(self) -> list[Array | Indices]:
        """All arrays, without the gap function."""
        return [each for each in self if isinstance(each, np.ndarray)]


NO_LEVEL = Level(0, np.empty((0, 0)))
"""For planes, points and balls."""


class Samples(NamedTuple):
    """Points of a surface as balls, over which contact forces are summed.

    Attributes:
        at: The points.
        fixed: Material points that friction springs are fixed to.
        measures: Integration weight of each point: one of a point, a length, an area, shape (n,).
    """

    at: Side
    fixed: Side
    measures: Array


class Sliding(NamedTuple):
    """How closest points on lines and patches move as the first points move, in two directions.

    The gap is stationary at the closest point, so its second derivative has ``−Σ m mᵀ/s`` in
    addition to that at a material point, with ``m = ∂²g/∂σ∂h`` and ``s = ∂²g/∂σ²`` for directions
    with ``∂²g/∂σ∂τ = 0``.

    Attributes:
        slopes: ``Q'``; zero if the closest point stays at an end, shape (m, 2, 3).
        bends: ``|Δ| s = Q'·Q' − Δ·Q''``, shape (m, 2).
        weights: Derivatives of the weights of all nodes, shape (m, 2, 4).
        arms: Derivatives of their moment arms, shape (m, 2, 4, 3).
    """

    slopes: Numbers3
    bends: Numbers2
    weights: Numbers3
    arms: Numbers4


def no_sliding(m: int) -> Sliding:
    """Closest points that stay at the same material point."""
    k = MOST_NODES
    return Sliding(
        np.zeros((m, 2, 3)), np.ones((m, 2)), np.zeros((m, 2, k)), np.zeros((m, 2, k, 3))
    )


class ContactPoints(NamedTuple):
    """Pairs of points between which contact forces act if they overlap.

    Attributes:
        a: Points of the first side.
        b: Points of the second side, or planes.
        kind: Kind of the pairs, see :mod:`.kinematics`.
        pairs: Indices of both points, shape (m, 2).
        weight: Integration weight (length or area), or one, shape (m,).
        first: First matrix block of each pair, shape (m,).
        sliding: Motion of closest points on the second side.
    """

    a: Side
    b: Side
    kind: int
    pairs: Integers2
    weight: Numbers1
    first: Integers1
    sliding: Sliding


contact_points_of = unpacking(ContactPoints)
"""Contact points from their table, in compiled code."""

_OF_SIDE = len(Side._fields) - 1 + len(Level._fields)
_PAIRS = 2 * _OF_SIDE + 1
"""Rows of a side in a table of contact points, and the row of their pairs."""


class Stations(NamedTuple):
    """Material points to which friction springs are attached.

    Attributes:
        at: Pairs of points.
        keys: Identifiers of the pairs, shape (m, 2).
        a: Material points of the first side: weights of the same nodes, and moment arms.
        b: Material points of the second side.
    """

    at: ContactPoints
    keys: Integers2
    a: Side
    b: Side


stations_of = unpacking(Stations)
"""Stations from their table, in compiled code."""

_COUNTED = _PAIRS, _PAIRS + 1, _PAIRS + 3 + len(Sliding._fields)
"""Rows with the number of pairs: of pairs, of weights and, in a table of stations, of keys."""


class KeptTable:
    """Table of contact points or stations for compiled code.

    Those in one space differ by their number alone, and have one table.
    """

    def __init__(self) -> None:
        """Begin without any table."""
        self._space: Sliding | None = None

    def of(self, points: ContactPoints) -> Indices:
        """Table of contact points, valid until the next call."""
        return self._kept(points, points, 2)

    def of_stations(self, stations: Stations) -> Indices:
        """Table of stations, valid until the next call."""
        return self._kept(stations, stations.at, 3)

    def _kept(self, record: ContactPoints | Stations, at: ContactPoints, counted: int) -> Indices:
        if at.sliding is not self._space:
            self._space, self._packed = at.sliding, PackedArrays(record)
        table = self._packed.addresses
        for row in _COUNTED[:counted]:
            table[row, 1] = len(at.pairs)
        return table


def empty_contacts(a: Side, b: Side, kind: int, most: int) -> ContactPoints:
    """Space for contact points, with no sliding yet.

    Args:
        a: First side.
        b: Second side.
        kind: Kind of the pairs.
        most: Largest number of contact points.
    """
    pairs, first = np.zeros((most, 2), dtype=np.int64), np.zeros(most, dtype=np.int64)
    return ContactPoints(a, b, kind, pairs, np.zeros(most), first, no_sliding(most))


class BothSides(NamedTuple):
    """Both sides of a contact of points.

    Attributes:
        a: Points with a radius.
        b: Planes, or points with a radius.
        kind: Kind of the pairs, :data:`INACTIVE` for slots of contact manifolds.
        same: Whether both sides are the same.
    """

    a: Side
    b: Side
    kind: int
    same: bool


def balls_side(balls: Sequence[Ball], nodes: Nodes) -> Side:
    """Balls as a side.

    Args:
        balls: The balls.
        nodes: Gives the numbers of the nodes of a body in the scene.
    """
    found = empty_side(len(balls))
    for i, ball in enumerate(balls):
        k = len(ball.owners)
        found.nodes[i, :k] = [number_of(*owner, nodes) for owner in ball.owners]
        found.weights[i, :k], found.arms[i, :k] = ball.weights, ball.arms
        found.radii[i], found.owners[i] = ball.radius, _frame_of(*ball.owners[0], nodes)
    return found


def point_samples(balls: Sequence[Ball], nodes: Nodes) -> Samples:
    """Balls as samples; arguments as for :func:`balls_side`."""
    at = balls_side(balls, nodes)
    return Samples(at, at, np.ones(len(balls)))


def planes_side(faces: Sequence[Face], nodes: Nodes) -> Side:
    """Planes as a side; arguments as for :func:`balls_side`."""
    found = empty_side(len(faces))
    for i, face in enumerate(faces):
        found.nodes[i, 0] = number_of(*face.owner, nodes)
        found.weights[i, 0], found.arms[i, 0] = 1.0, face.origin
        found.normals[i], found.owners[i] = face.normal, _frame_of(*face.owner, nodes)
    return found


def level_side(surface: GapSurface, nodes: Nodes) -> Side:
    """A surface with a gap function as a side; ``nodes`` as for :func:`balls_side`."""
    body, node = owner_of(surface.point)
    H, found = initial_frame(body, node), empty_side(1)
    found.nodes[0, 0], found.weights[0, 0] = number_of(body, node, nodes), 1.0
    found.arms[0, 0] = H[1:] @ (surface.point.position - H[0])
    found.owners[0] = _frame_of(body, node, nodes)
    parameters = np.array([surface.parameters], dtype=np.float64)
    return found._replace(level=Level(surface.gap.address, parameters))


def joined_sides(sides: Sequence[Side]) -> Side:
    """Several sides as one."""
    parts = zip(*(side.arrays for side in sides), strict=True)
    return Side._make([*(np.concatenate(part) for part in parts), NO_LEVEL])


def joined_samples(samples: Sequence[Samples]) -> Samples:
    """Samples of several surfaces as one."""
    at, fixed, measures = zip(*samples, strict=True)
    return Samples(joined_sides(at), joined_sides(fixed), np.concatenate(measures))


def empty_side(n: int) -> Side:
    """Uninitialised side of ``n`` points."""
    return Side(
        np.full((n, MOST_NODES), UNUSED),
        np.zeros((n, MOST_NODES)),
        np.zeros((n, MOST_NODES, 3)),
        np.zeros(n),
        np.zeros((n, 3)),
        np.zeros(n, dtype=np.int64),
        NO_LEVEL,
    )


def on_masters(side: Side, master: Indices, offset: Array) -> Side:
    """The same points, expressed by the master nodes of rigidly attached nodes.

    Args:
        side: On all nodes.
        master: Master of each node, shape (N,).
        offset: Frame of each node in that of its master, shape (N, 4, 3).
    """
    moved = side._replace(
        nodes=side.nodes.copy(), arms=side.arms.copy(), normals=side.normals.copy()
    )
    for i, k in np.argwhere(side.nodes >= 0):
        node = side.nodes[i, k]
        x, R = lie.position(offset[node]), lie.rotation(offset[node])
        moved.nodes[i, k] = master[node]
        moved.arms[i, k] = side.weights[i, k] * x + R @ side.arms[i, k]
        if k == 0:
            moved.normals[i] = R @ side.normals[i]
    return moved


def least(*radii: Array) -> float:
    """Least positive radius; infinite if there is none."""
    return float(min(each[each > 0.0].min(initial=np.inf) for each in radii))


def number_of(body: Body | None, node: int, nodes: Nodes) -> int:
    """Number of a node in the scene, or of ground."""
    return GROUND if body is None else int(nodes(body)[node])


def _frame_of(body: Body | None, node: int, nodes: Nodes) -> int:
    """Number of the master of a node within its body, or of ground."""
    if body is None:
        return GROUND
    return int(nodes(body)[int(body.model.masters[node])])
