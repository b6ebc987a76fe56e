"""Both sides of a contact, and the contact points between them, for compiled code.

For points and balls the contact points are the near pairs. For lines they are the Gauss points of
overlapping intervals, recomputed for each set of frames
(:mod:`~fem_lie.contact.sides.gauss_points`); contact forces, energy and derivatives are then the
same as for balls.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.contact.sides.curves import set_curves
from fem_lie.contact.sides.gauss_points import (
    GAUSS,
    intervals,
    lines_of,
    middles_of,
    runs_of,
    set_points,
    set_stations,
    strands_of,
)
from fem_lie.contact.sides.pairs import NearPairs
from fem_lie.contact.sides.passage import Passage, first_jump, first_line_through, polygon
from fem_lie.contact.sides.surfaces import Piece
from fem_lie.contact.sides.table import (
    GROUND,
    PLANE,
    ROUND,
    ContactPoints,
    Nodes,
    Side,
    Sliding,
    Stations,
    empty_contacts,
    empty_side,
    least,
    no_sliding,
)


class Sides(ABC):
    """Both sides of a contact.

    Attributes:
        near: List of near pairs.
        on_ground: Whether a side is fixed to ground.
        radius: Least radius, infinite if there is none.
        of_balls: Whether contact points are material points, not closest points of curves.
    """

    of_balls = False
    near: NearPairs
    on_ground: bool
    radius: float

    @abstractmethod
    def meet(self, H: Array) -> ContactPoints:
        """Contact points at frames ``H``, with an update of the list of pairs."""

    def meet_ends(self, start: Array, end: Array, *, known: bool) -> tuple[ContactPoints, ...]:
        """Contact points at the start of a step, and at its end if these are other material points.

        ``known``: use the present list of pairs.
        """
        if not known:
            self.near.cover(start, end)
        return (self._meet(start),)

    def meet_again(self, H: Array) -> ContactPoints:
        """Contact points at frames, for the present list of pairs."""
        return self._meet(H)

    @abstractmethod
    def _meet(self, H: Array) -> ContactPoints:
        """Contact points at frames, for the present list of pairs."""

    def stations(self, H: Array) -> Stations:
        """Pairs of points that have friction springs at frames ``H``."""
        self.near.update(H)
        return self._stations(H)

    def stations_over_step(self, end: Array) -> Stations:
        """The same at the end of a step, of the present list of pairs."""
        return self._stations(end)

    @abstractmethod
    def _stations(self, H: Array) -> Stations:
        """Pairs of points that have friction springs, of the present list of pairs."""

    def passed(self, start: Array, end: Array) -> Passage | None:
        """A pair that passed through each other between frames; default: none can."""
        return None

    @abstractmethod
    def keep_stretches(self) -> None:
        """Keep the stretches of the last contact points for the forces of steps."""

    @abstractmethod
    def take_kept_stretches(self) -> None:
        """Take the stretches that were kept, from which others are updated."""

    @property
    def pair_positions(self) -> Array:
        """State of :meth:`meet`, for checkpoints, shape (n, 3)."""
        return self.near.pair_positions

    def restore_pairs(self, pair_positions: Array) -> None:
        """Restore the state :attr:`pair_positions`."""
        self.near.restore_pairs(pair_positions)


class Balls(Sides):
    """Balls that touch balls or planes."""

    of_balls = True

    def __init__(
        self,
        a: Side,
        b: Side,
        *,
        kind: int,
        same: bool,
        areas: Array | None = None,
        fixed: Side | None = None,
    ) -> None:
        """Store both sides; see :class:`~fem_lie.contact.sides.pairs.NearPairs`.

        ``areas`` are the areas of the first points; default: one. ``fixed`` are their material
        points for friction springs; default: the points themselves.
        """
        self._a, self._b, self._kind = a, b, kind
        self._fixed = a if fixed is None else fixed
        self._areas = np.ones(len(a.radii)) if areas is None else areas
        self.near = NearPairs(a, b, kind=kind, same=same)
        self.on_ground = bool((a.owners == GROUND).any() or (b.owners == GROUND).any())
        self.radius = least(a.radii, b.radii)
        self._version = -1

    def meet(self, H: Array) -> ContactPoints:
        """Contact points at frames ``H``."""
        self.near.update(H)
        return self._meet(H)

    def passed(self, start: Array, end: Array) -> Passage | None:
        """A pair that passed through each other on straight paths."""
        # nothing can pass through a half-space or a hollow sphere
        if self.near.fixed:
            return None
        before, after, pairs = self.near.in_step(start, end)
        radii = self._a.radii, self._b.radii
        e = first_jump(before, after, radii, pairs)
        if e < 0:
            return None
        i, j = pairs[e]
        way = after[0][i] - before[0][i] - (after[1][j] - before[1][j])
        return Passage(float(np.linalg.norm(way)), float(radii[0][i] + radii[1][j]))

    def _meet(self, H: Array) -> ContactPoints:
        if self.near.version != self._version:
            self._version, count = self.near.version, len(self.near.now)
            self._meeting = ContactPoints(
                self._a,
                self._b,
                self._kind,
                self.near.now,
                self._areas[self.near.now[:, 0]],
                self.near.first,
                no_sliding(count),
            )
            at = self._meeting
            self._all_near = Stations(at, at.pairs, self._fixed, at.b)
        return self._meeting

    def _stations(self, H: Array) -> Stations:
        """All near pairs."""
        self._meet(H)
        return self._all_near

    def keep_stretches(self) -> None:
        """Do nothing."""

    def take_kept_stretches(self) -> None:
        """Do nothing."""


NOW, START, END = range(3)
"""Frames of contact points: those of the last call, and both ends of a step."""


class ClosestPoints(Sides):
    """Sides whose contact points are found anew for each set of frames, as closest points are.

    Those of the start of a step are found once for all of its iterations.
    """

    def __init__(self) -> None:
        """Begin without any contact points."""
        self._version = -1
        self._rooms: dict[int, ContactPoints] = {}
        self._known: tuple[Array, ContactPoints] | None = None
        self._station_room: Stations | None = None

    def meet(self, H: Array) -> ContactPoints:
        """Contact points at frames ``H``."""
        self.near.update(H)
        return self._meet(H)

    def meet_ends(self, start: Array, end: Array, *, known: bool) -> tuple[ContactPoints, ...]:
        """Contact points at both ends of a step, which are valid until the next call."""
        if not known:
            self.near.cover(start, end)
        self._follow()
        if self._known is None or not np.array_equal(start, self._known[0]):
            self._known = start.copy(), self._find(start, START)
        return self._known[1], self._find(end, END)

    def _meet(self, H: Array) -> ContactPoints:
        self._follow()
        return self._find(H, NOW)

    def _follow(self) -> None:
        """Follow the list of near pairs."""
        if self.near.version != self._version:
            self._version, self._known = self.near.version, None
            self._rooms.clear()
            self._station_room = None
            self._take_pairs()

    def _room(self, place: int) -> ContactPoints:
        """Space for the contact points at given frames."""
        if place not in self._rooms:
            self._rooms[place] = self._space()
        return self._rooms[place]

    def _stations(self, H: Array) -> Stations:
        self._follow()
        if self._station_room is None:
            self._station_room = self._space_of_stations()
        room = self._station_room
        k = self._set_stations(H, room)
        return room._replace(at=first_of(room.at, k), keys=room.keys[:k])

    @abstractmethod
    def _space_of_stations(self) -> Stations:
        """Space for the stations of the present list of pairs."""

    @abstractmethod
    def _set_stations(self, H: Array, room: Stations) -> int:
        """Set the stations at frames ``H``; their number."""

    @abstractmethod
    def _take_pairs(self) -> None:
        """Take the present list of near pairs."""

    @abstractmethod
    def _space(self) -> ContactPoints:
        """Space for the contact points between near pairs."""

    @abstractmethod
    def _find(self, H: Array, place: int) -> ContactPoints:
        """Contact points at frames ``H``, in the space of ``place``."""


class Lines(ClosestPoints):
    """A line, and another line or planes near it."""

    def __init__(
        self,
        a: Sequence[Piece],
        b: Sequence[Piece],
        planes: Side | None,
        nodes: Nodes,
        *,
        left_out: Indices | None = None,
    ) -> None:
        """Store both sides.

        Args:
            a: Segments of the first line.
            b: Segments of the second line.
            planes: Planes instead of the second line.
            nodes: Gives the numbers of the nodes of a body in the scene.
            left_out: For a line that touches itself: pairs of segments that do not touch, (k, 2).
        """
        super().__init__()
        self._a, self._b = strands_of(a, nodes), strands_of(b, nodes)
        middles = middles_of(a, self._a), middles_of(b, self._b) if planes is None else planes
        self._planes, self._kind = middles[1], ROUND if planes is None else PLANE
        self.near = NearPairs(*middles, kind=self._kind, same=False, left_out=left_out)
        if left_out is not None:
            # each pair of segments is integrated over both of them
            self._a = self._a._replace(lengths=0.5 * self._a.lengths)
        self.radius = least(self._a.radii, self._b.radii)
        self.on_ground = bool(any((side.owners == GROUND).any() for side in middles))
        self._chains = lines_of(self._b) if b else None
        self._parts = intervals()
        self._frozen = self._stretches

    def meet(self, H: Array) -> ContactPoints:
        """Contact points at frames ``H``, with the stretches there."""
        self.near.update(H)
        self._follow()
        return self._find(H, NOW, stretched=True)

    def _take_pairs(self) -> None:
        after = self._b.after if self._kind == ROUND else None
        self._runs = runs_of(self.near.now, after)
        # two intervals of a segment for each run of opposite segments, or for a plane, since most
        # runs have none and few have more
        self._most = 2 * GAUSS * len(self._runs) + GAUSS

    def _find(self, H: Array, place: int, *, stretched: bool = False) -> ContactPoints:
        set_curves(H, self._a, stretched)
        set_curves(H, self._b, stretched)
        given = H, self._a, self._b, self._planes, self._runs, self.near.first
        room = self._room(place)
        while (k := set_points(*given, self._parts, room)) == len(room.weight):
            self._most = 2 * k
            self._rooms[place] = room = self._space()
        return first_of(room, k)

    def _space(self) -> ContactPoints:
        return self._points(self._most)

    def _points(self, most: int) -> ContactPoints:
        b = empty_side(most) if self._kind == ROUND else self._planes
        return empty_contacts(empty_side(most), b, self._kind, most)

    def passed(self, start: Array, end: Array) -> Passage | None:
        """A pair of segments that passed through each other on straight paths."""
        if self._kind == PLANE:
            return None
        before, after, pairs = self.near.in_step(start, end)
        curves = []
        for strands in (self._a, self._b):
            ends = np.empty((2, *strands.curves.shape))
            for k, H in enumerate((start, end)):
                workspace = strands._replace(curves=ends[k], bulges=np.empty_like(strands.bulges))
                set_curves(H, workspace, False)
            curves.append(ends)
        radii = self._a.radii, self._b.radii
        e = first_line_through(curves[0], curves[1], radii, pairs, polygon(), polygon())
        if e < 0:
            return None
        i, j = pairs[e]
        way = after[0][i] - before[0][i] - (after[1][j] - before[1][j])
        return Passage(float(np.linalg.norm(way)), float(radii[0][i] + radii[1][j]))

    def stations(self, H: Array) -> Stations:
        """Pairs of points that have friction springs at frames ``H``."""
        self.meet(H)
        return self._stations(H)

    def stations_over_step(self, end: Array) -> Stations:
        """The same at the end of a step, with the kept stretches."""
        stretches = self._stretches
        self._stretch(self._frozen)
        self._follow()
        found = self._stations(end)
        self._stretch(stretches)
        return found

    def _space_of_stations(self) -> Stations:
        most = GAUSS * len(self._runs)
        at = self._points(most)
        return Stations(at, np.zeros((most, 2), dtype=np.int64), at.a, at.b)

    def _set_stations(self, H: Array, room: Stations) -> int:
        """Set Gauss points of whole elements, which are material points."""
        set_curves(H, self._a, False)
        set_curves(H, self._b, False)
        given = H, self._a, self._b, self._planes, self._runs, self.near.first
        k, keys = set_stations(*given, room.at, room.keys), room.keys
        if self._chains is not None:
            keys[:k, 1] = self._chains[keys[:k, 1]]
        return k

    def meet_ends(self, start: Array, end: Array, *, known: bool) -> tuple[ContactPoints, ...]:
        """Contact points at both ends of a step, with the kept stretches."""
        stretches = self._stretches
        self._stretch(self._frozen)
        found = super().meet_ends(start, end, known=known)
        self._stretch(stretches)
        return found

    def keep_stretches(self) -> None:
        """Keep the stretches of the last contact points for the forces of steps."""
        self._frozen, self._known = self._stretches, None

    def take_kept_stretches(self) -> None:
        """Take the stretches that were kept, from which others are updated."""
        self._stretch(self._frozen)

    @property
    def _stretches(self) -> Array:
        return np.concatenate([self._a.stretches, self._b.stretches])

    def _stretch(self, stretches: Array) -> None:
        self._a.stretches[:], self._b.stretches[:] = np.split(stretches, [len(self._a.stretches)])

    @property
    def pair_positions(self) -> Array:
        """State of the list of pairs, and of the stretches."""
        stretches = np.stack([self._stretches, self._frozen, self._frozen], axis=1)
        return np.concatenate([self.near.pair_positions, stretches])

    def restore_pairs(self, pair_positions: Array) -> None:
        """Restore the state :attr:`pair_positions`."""
        n = len(pair_positions) - len(self._frozen)
        self._stretch(pair_positions[n:, 0])
        self._frozen, self._known = pair_positions[n:, 1].copy(), None
        self.near.restore_pairs(pair_positions[:n])


def first_of(room: ContactPoints, count: int) -> ContactPoints:
    """The first contact points of a space for more."""
    return room._replace(pairs=room.pairs[:count], weight=room.weight[:count])


def copied(at: ContactPoints) -> ContactPoints:
    """A copy of contact points, which stays valid when others are computed."""
    a, b = _copied_side(at.a), _copied_side(at.b) if at.kind == ROUND else at.b
    slides = Sliding(*(array.copy() for array in at.sliding))
    return ContactPoints(a, b, at.kind, at.pairs.copy(), at.weight.copy(), at.first.copy(), slides)


def _copied_side(side: Side) -> Side:
    return Side._make([*(array.copy() for array in side.arrays), side.level])
