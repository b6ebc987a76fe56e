"""Where two sides meet: places of both that push each other apart, for compiled code.

Of points and balls that are the pairs that are near. Of lines they are Gauss points of the parts
where lines overlap, made anew at each frames (:mod:`~fem_lie.contact.sides.gauss_points`); so
forces, energy and derivatives are those of balls.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.contact.sides.curves import set_curves
from fem_lie.contact.sides.gauss_points import (
    GAUSS,
    Meeting,
    Sliding,
    middles_of,
    no_sliding,
    set_points,
    set_stations,
    strands_of,
)
from fem_lie.contact.sides.pairs import NearPairs
from fem_lie.contact.sides.passage import Passage, first_jump, first_line_through, polygon
from fem_lie.contact.sides.surfaces import Piece
from fem_lie.contact.sides.table import GROUND, Nodes, Side, empty_side, least


class Stations(NamedTuple):
    """Where anchors of friction stand.

    Attributes:
        at: Pairs of places.
        keys: What tells these apart, shape (m, 2).
        a: What anchors of the first side are fixed to: weights of the same nodes, and levers.
        b: Likewise of the second.
    """

    at: Meeting
    keys: Indices
    a: Side
    b: Side


class Sides(ABC):
    """Two sides of a contact.

    Attributes:
        near: Who is near whom.
        on_ground: Whether a side is on ground.
        radius: The least of what is round, infinite if nothing is.
        of_balls: Whether places are material ones, and not where curves are nearest.
    """

    of_balls = False
    near: NearPairs
    on_ground: bool
    radius: float

    @abstractmethod
    def meet(self, H: Array) -> Meeting:
        """Where they do at frames ``H``."""

    def meet_ends(self, start: Array, end: Array, *, known: bool) -> list[Meeting]:
        """Where they do at the start of a step, and at its end if places move along the sides.

        ``known``: by the list of pairs that there is.
        """
        if not known:
            self.near.cover(start, end)
        return [self._meet(start)]

    def meet_again(self, H: Array) -> Meeting:
        """Where they do at frames, by the list of pairs that there is."""
        return self._meet(H)

    @abstractmethod
    def _meet(self, H: Array) -> Meeting:
        """Likewise at frames, by that list."""

    @abstractmethod
    def stations(self, H: Array) -> Stations:
        """Pairs of places where anchors of friction stand at frames ``H``."""

    def passed(self, start: Array, end: Array) -> Passage | None:
        """A pair that went through each other between frames; default: none can."""
        return None

    @abstractmethod
    def settle(self) -> None:
        """Take what steps see of the sides from where these met last."""

    @property
    def seen(self) -> Array:
        """What :meth:`meet` remembers of frames before, shape (n, 3)."""
        return self.near.seen

    def see_again(self, seen: Array) -> None:
        """Remember what was :attr:`seen` once."""
        self.near.see_again(seen)


class Balls(Sides):
    """Balls that touch balls or planes."""

    of_balls = True

    def __init__(
        self,
        a: Side,
        b: Side,
        *,
        flat: bool,
        same: bool,
        areas: Array | None = None,
        fixed: Side | None = None,
    ) -> None:
        """Keep both sides; see :class:`~fem_lie.contact.sides.pairs.NearPairs`.

        ``areas`` are what first places stand for; default: one. ``fixed`` is what anchors of these
        are fixed to; default: they themselves.
        """
        self._a, self._b, self._flat = a, b, flat
        self._fixed = a if fixed is None else fixed
        self._areas = np.ones(len(a.radii)) if areas is None else areas
        self.near = NearPairs(a, b, flat=flat, same=same)
        self.on_ground = bool((a.owners == GROUND).any() or (b.owners == GROUND).any())
        self.radius = least(a.radii, b.radii)
        self._version = -1

    def meet(self, H: Array) -> Meeting:
        """See the base class."""
        self.near.update(H)
        return self._meet(H)

    def passed(self, start: Array, end: Array) -> Passage | None:
        """See the base class: on straight ways."""
        # behind a plane, and around a hollow, there is no other side to go to
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

    def _meet(self, H: Array) -> Meeting:
        if self.near.version != self._version:
            self._version, count = self.near.version, len(self.near.now)
            self._meeting = Meeting(
                self._a,
                self._b,
                self._flat,
                self.near.now,
                self._areas[self.near.now[:, 0]],
                self.near.first,
                no_sliding(count),
            )
        return self._meeting

    def stations(self, H: Array) -> Stations:
        """See the base class."""
        at = self.meet(H)
        return Stations(at, at.pairs, self._fixed, at.b)

    def settle(self) -> None:
        """See the base class; there is nothing."""


class Lines(Sides):
    """A line along which another, or planes, are near."""

    def __init__(
        self, a: Sequence[Piece], b: Sequence[Piece], planes: Side | None, nodes: Nodes
    ) -> None:
        """Keep pieces of both, or planes instead of the second, and numbers of nodes."""
        self._a, self._b = strands_of(a, nodes), strands_of(b, nodes)
        middles = middles_of(a, self._a), middles_of(b, self._b) if planes is None else planes
        self._planes, self.flat = middles[1], planes is not None
        self.near = NearPairs(*middles, flat=self.flat, same=False)
        self.radius = least(self._a.radii, self._b.radii)
        self.on_ground = bool(any((side.owners == GROUND).any() for side in middles))
        self._chains = np.cumsum(np.append(0, ~self._b.goes_on[:-1])) if b else None
        self._version = -1
        self._settled = self._stretches

    def meet(self, H: Array) -> Meeting:
        """See the base class."""
        self.near.update(H)
        return self._meet(H, stretched=True)

    def _meet(self, H: Array, *, stretched: bool = False) -> Meeting:
        if self.near.version != self._version:
            self._version = self.near.version
            self._runs = self._found_runs()
            # two parts of a piece for each run, or plane
            most = 2 * GAUSS * len(self._runs)
            self._room = Meeting(
                empty_side(most),
                self._planes if self.flat else empty_side(most),
                self.flat,
                np.zeros((most, 2), dtype=np.int64),
                np.zeros(most),
                np.zeros(most, dtype=np.int64),
                no_sliding(most),
            )
        set_curves(H, self._a, stretched)
        set_curves(H, self._b, stretched)
        room = self._room
        k = set_points(H, self._a, self._b, self._planes, self._runs, self.near.first, room)
        return room._replace(pairs=room.pairs[:k])

    def passed(self, start: Array, end: Array) -> Passage | None:
        """See the base class: on straight ways of the ends of pieces and the tangents there."""
        if self.flat:
            return None
        before, after, pairs = self.near.in_step(start, end)
        curves = []
        for strands in (self._a, self._b):
            ends = np.empty((2, *strands.curves.shape))
            for k, H in enumerate((start, end)):
                room = strands._replace(curves=ends[k], bulges=np.empty_like(strands.bulges))
                set_curves(H, room, False)
            curves.append(ends)
        radii = self._a.radii, self._b.radii
        e = first_line_through(curves[0], curves[1], radii, pairs, polygon(), polygon())
        if e < 0:
            return None
        i, j = pairs[e]
        way = after[0][i] - before[0][i] - (after[1][j] - before[1][j])
        return Passage(float(np.linalg.norm(way)), float(radii[0][i] + radii[1][j]))

    def stations(self, H: Array) -> Stations:
        """See the base class: Gauss points of whole elements, which stay where they are."""
        self.meet(H)
        most = GAUSS * len(self._runs)
        room = Meeting(
            empty_side(most),
            self._planes if self.flat else empty_side(most),
            self.flat,
            np.zeros((most, 2), dtype=np.int64),
            np.zeros(most),
            np.zeros(most, dtype=np.int64),
            no_sliding(most),
        )
        keys = np.zeros((most, 2), dtype=np.int64)
        given = H, self._a, self._b, self._planes, self._runs, self.near.first
        k = set_stations(*given, room, keys)
        if self._chains is not None:
            keys[:, 1] = self._chains[keys[:, 1]]
        return Stations(room._replace(pairs=room.pairs[:k]), keys[:k], room.a, room.b)

    def meet_ends(self, start: Array, end: Array, *, known: bool) -> list[Meeting]:
        """See the base class; tangents have the lengths that were settled."""
        kept, found = self._stretches, []
        self._stretch(self._settled)
        if not known:
            self.near.cover(start, end)
        found += [copied(self._meet(H)) for H in (start, end)]
        self._stretch(kept)
        return found

    def settle(self) -> None:
        """See the base class."""
        self._settled = self._stretches

    @property
    def _stretches(self) -> Array:
        return np.concatenate([self._a.stretches, self._b.stretches])

    def _stretch(self, stretches: Array) -> None:
        self._a.stretches[:], self._b.stretches[:] = np.split(stretches, [len(self._a.stretches)])

    @property
    def seen(self) -> Array:
        """See the base class; stretches come last."""
        stretches = np.stack([self._stretches, self._settled, self._settled], axis=1)
        return np.concatenate([self.near.seen, stretches])

    def see_again(self, seen: Array) -> None:
        """See the base class."""
        n = len(seen) - len(self._settled)
        self._stretch(seen[n:, 0])
        self._settled = seen[n:, 1].copy()
        self.near.see_again(seen[:n])

    def _found_runs(self) -> Indices:
        """First piece, first and last of those opposite that follow each other, first pair."""
        i, j = self.near.now.T
        begins = np.ones(len(i), dtype=np.bool_)
        if not self.flat and len(i):
            follows = (i[1:] == i[:-1]) & (j[1:] == j[:-1] + 1) & self._b.goes_on[j[:-1]]
            begins[1:] = ~follows
        first = np.flatnonzero(begins)
        last = np.append(first[1:], len(i))[: len(first)] - 1
        return np.stack([i[first], j[first], j[last], first], axis=1)


def copied(at: Meeting) -> Meeting:
    """One that stays when sides meet elsewhere."""
    a, b = _copied_side(at.a), at.b if at.flat else _copied_side(at.b)
    slides = Sliding(*(array.copy() for array in at.sliding))
    return Meeting(
        a, b, at.flat, at.pairs.copy(), at.weight[: len(at.pairs)].copy(), at.first.copy(), slides
    )


def _copied_side(side: Side) -> Side:
    return Side._make([*(array.copy() for array in side.arrays), side.level])
