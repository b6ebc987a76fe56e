"""Where two sides meet: places of both that push each other apart, for compiled code.

Of points and balls that are the pairs that are near. Of lines they are Gauss points of the parts
where lines overlap, made anew at each frames, each as a ball whose place is linear in the rows of
two nodes; so forces, energy and derivatives are those of balls.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie._jit import inlined_uncounted, uncounted
from fem_lie.contact.curves import (
    Opposite,
    Strands,
    bend,
    nearest,
    overlaps,
    plane_of,
    set_curves,
    slope,
    slopes,
    weights,
)
from fem_lie.contact.curves import at as place_at
from fem_lie.contact.pairs import NearPairs
from fem_lie.contact.surfaces import Piece
from fem_lie.contact.table import GROUND, Nodes, Side, empty_side, least, number_of
from fem_lie.lie.tuples import Vector, dot, load_row, minus, plus, scaled, store_row

_GAUSS = 3
_AT, _WEIGHT = np.polynomial.legendre.leggauss(_GAUSS)

_BULGE = 1.1
"""Half lengths of pieces over half their lengths at first: by how much they may be stretched."""


class Sliding(NamedTuple):
    """How second places on lines follow the first ones: by ``δσ`` along their pieces.

    ``g`` is least there, so its second derivative has ``−m mᵀ/s`` beside that at constant σ, with
    ``m = ∂²g/∂σ∂h`` and ``s = ∂²g/∂σ²``.

    Attributes:
        slopes: ``Q'``; zero where the second place stays at an end, shape (m, 3).
        bends: ``|Δ| s = Q'·Q' − Δ·Q''``, shape (m,).
        weights: Derivatives of the weights of both nodes, shape (m, 2).
        levers: And of their levers, shape (m, 2, 3).
    """

    slopes: Array
    bends: Array
    weights: Array
    levers: Array


def _sliding(m: int) -> Sliding:
    return Sliding(np.zeros((m, 3)), np.ones(m), np.zeros((m, 2)), np.zeros((m, 2, 3)))


class Meeting(NamedTuple):
    """Places that push each other apart, where they overlap.

    Attributes:
        a: First places.
        b: Second ones, or planes.
        flat: Whether they are planes.
        pairs: Of places, shape (m, 2).
        weight: Length that each stands for, or one, shape (m,).
        first: The first block of a matrix of each, shape (m,).
        sliding: Of second places.
    """

    a: Side
    b: Side
    flat: bool
    pairs: Indices
    weight: Array
    first: Indices
    sliding: Sliding


class Sides(ABC):
    """Two sides of a contact.

    Attributes:
        near: Who is near whom.
        on_ground: Whether a side is on ground.
        radius: The least of what is round, infinite if nothing is.
    """

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

    @abstractmethod
    def _meet(self, H: Array) -> Meeting:
        """Likewise at frames, by that list."""

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

    def __init__(self, a: Side, b: Side, *, flat: bool, same: bool) -> None:
        """Keep both sides; see :class:`~fem_lie.contact.pairs.NearPairs`."""
        self._a, self._b, self._flat = a, b, flat
        self.near = NearPairs(a, b, flat=flat, same=same)
        self.on_ground = bool((a.owners == GROUND).any() or (b.owners == GROUND).any())
        self.radius = least(a.radii, b.radii)
        self._version = -1

    def meet(self, H: Array) -> Meeting:
        """See the base class."""
        self.near.update(H)
        return self._meet(H)

    def _meet(self, H: Array) -> Meeting:
        if self.near.version != self._version:
            self._version, count = self.near.version, len(self.near.now)
            self._meeting = Meeting(
                self._a,
                self._b,
                self._flat,
                self.near.now,
                np.ones(count),
                self.near.first,
                _sliding(count),
            )
        return self._meeting

    def settle(self) -> None:
        """See the base class; there is nothing."""


class Lines(Sides):
    """A line along which another, or planes, are near."""

    def __init__(
        self, a: Sequence[Piece], b: Sequence[Piece], planes: Side | None, nodes: Nodes
    ) -> None:
        """Keep pieces of both, or planes instead of the second, and numbers of nodes."""
        self._a, self._b = _strands(a, nodes), _strands(b, nodes)
        middles = _middles(a, self._a), _middles(b, self._b) if planes is None else planes
        self._planes, self.flat = middles[1], planes is not None
        self.near = NearPairs(*middles, flat=self.flat, same=False)
        self.radius = least(self._a.radii, self._b.radii)
        self.on_ground = bool(any((side.owners == GROUND).any() for side in middles))
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
            most = 2 * _GAUSS * len(self._runs)
            self._room = Meeting(
                empty_side(most),
                self._planes if self.flat else empty_side(most),
                self.flat,
                np.zeros((most, 2), dtype=np.int64),
                np.zeros(most),
                np.zeros(most, dtype=np.int64),
                _sliding(most),
            )
        set_curves(H, self._a, stretched)
        set_curves(H, self._b, stretched)
        room = self._room
        k = _set_points(H, self._a, self._b, self._planes, self._runs, self.near.first, room)
        return room._replace(pairs=room.pairs[:k])

    def meet_ends(self, start: Array, end: Array, *, known: bool) -> list[Meeting]:
        """See the base class; tangents have the lengths that were settled."""
        kept, found = self._stretches, []
        self._stretch(self._settled)
        if not known:
            self.near.cover(start, end)
        found += [_copied(self._meet(H)) for H in (start, end)]
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


def _copied(at: Meeting) -> Meeting:
    """One that stays when sides meet elsewhere."""
    a, b = _copied_side(at.a), at.b if at.flat else _copied_side(at.b)
    slides = Sliding(*(array.copy() for array in at.sliding))
    return Meeting(
        a, b, at.flat, at.pairs.copy(), at.weight[: len(at.pairs)].copy(), at.first.copy(), slides
    )


def _copied_side(side: Side) -> Side:
    return Side(
        side.nodes.copy(),
        side.weights.copy(),
        side.levers.copy(),
        side.radii.copy(),
        side.normals.copy(),
        side.owners.copy(),
    )


def _strands(pieces: Sequence[Piece], nodes: Nodes) -> Strands:
    numbers = [[number_of(*owner, nodes) for owner in piece.owners] for piece in pieces]
    goes_on: Flags = np.array([piece.goes_on for piece in pieces], dtype=np.bool_)
    return Strands(
        np.array(numbers, dtype=np.int64).reshape(-1, 2),
        np.array([piece.ends for piece in pieces]).reshape(-1, 2, 3),
        np.array([piece.tangents for piece in pieces]).reshape(-1, 2, 3),
        np.array([piece.length for piece in pieces]),
        np.array([piece.chord for piece in pieces]),
        np.ones(len(pieces)),
        np.array([piece.radius for piece in pieces]),
        goes_on,
        np.zeros((len(pieces), 4, 3)),
    )


def _middles(pieces: Sequence[Piece], strands: Strands) -> Side:
    """Balls about the middles of pieces that have all of them within."""
    found = empty_side(len(pieces))
    found.nodes[:, :2] = strands.nodes
    w = weights(0.5)
    found.weights[:, :2] = w[:2]
    found.levers[:, :2] = 0.5 * strands.ends
    found.levers[:, 0] += w[2] * strands.tangents[:, 0]
    found.levers[:, 1] += w[3] * strands.tangents[:, 1]
    found.radii[:] = strands.radii + 0.5 * _BULGE * strands.lengths
    # those of a body are a frame of its own for each piece: it is the other side that they touch
    found.owners[:] = np.where(strands.nodes[:, 0] == GROUND, GROUND, strands.nodes[:, 0])
    return found


@uncounted
def _set_place(strands: Strands, i: int, s: float, out: Side, q: int) -> None:
    """A place on a piece as a ball."""
    w = weights(s)
    out.nodes[q, 0], out.nodes[q, 1] = strands.nodes[i, 0], strands.nodes[i, 1]
    out.weights[q, 0], out.weights[q, 1] = w[0], w[1]
    _set_levers(strands, i, w, out.levers[q])
    out.radii[q] = strands.radii[i]
    out.owners[q] = strands.nodes[i, 0]


@uncounted
def _set_sliding(b: Strands, j: int, σ: float, P: Vector, out: Sliding, q: int) -> None:
    """How a place follows ``P``."""
    D, (w0, w1, m0, m1) = b.curves[j], slopes(σ)
    apart, t = minus(P, place_at(D, σ)), slope(D, σ)
    store_row(out.slopes, q, scaled(1.0 if 0.0 < σ < 1.0 else 0.0, t))
    out.bends[q] = dot(t, t) - dot(apart, bend(D, σ))
    out.weights[q, 0], out.weights[q, 1] = w0, w1
    _set_levers(b, j, (w0, w1, m0, m1), out.levers[q])


@inlined_uncounted
def _set_levers(strands: Strands, i: int, w: tuple[float, float, float, float], out: Array) -> None:
    ends, tangents = strands.ends[i], strands.tangents[i]
    for k in range(2):
        p, t = load_row(ends, k), load_row(tangents, k)
        w_, m = (w[0], w[2]) if k == 0 else (w[1], w[3])
        store_row(out, k, plus(scaled(w_, p), scaled(m * strands.stretches[i], t)))


@uncounted
def _set_points(
    H: Array, a: Strands, b: Strands, planes: Side, runs: Indices, blocks: Indices, out: Meeting
) -> int:
    """Gauss points of all that overlap; how many."""
    count = 0
    for run in range(runs.shape[0]):
        i, first, last, e = runs[run, 0], runs[run, 1], runs[run, 2], runs[run, 3]
        if out.flat:
            other = plane_of(H, planes, first, a.radii[i])
        else:
            nowhere = (0.0, 0.0, 0.0)
            other = Opposite(first, last, nowhere, nowhere, a.radii[i] + b.radii[first])
        C = a.curves[i]
        from_, to, later, end = overlaps(C, a if out.flat else b, other)
        for part in range(2):
            low, high = (from_, to) if part == 0 else (later, end)
            for p in range(_GAUSS if high > low else 0):
                s = 0.5 * (low + high) + 0.5 * (high - low) * _AT[p]
                if out.flat:
                    out.pairs[count, 1], out.first[count] = first, blocks[e]
                else:
                    square, j, σ = nearest(b, other, place_at(C, s))
                    if square == np.inf:
                        continue
                    _set_place(b, j, σ, out.b, count)
                    out.pairs[count, 1], out.first[count] = count, blocks[e + j - first]
                    _set_sliding(b, j, σ, place_at(C, s), out.sliding, count)
                _set_place(a, i, s, out.a, count)
                out.pairs[count, 0] = count
                out.weight[count] = 0.5 * (high - low) * _WEIGHT[p] * a.lengths[i]
                count += 1
    return count
