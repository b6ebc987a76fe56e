"""Two sides of which the second are patches of shells."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.contact.sides.detection import first_crossing
from fem_lie.contact.sides.facing import set_facing
from fem_lie.contact.sides.gauss_points import Meeting, no_sliding
from fem_lie.contact.sides.kinematics import places
from fem_lie.contact.sides.meeting import Sides, Stations, copied
from fem_lie.contact.sides.pairs import NearPairs
from fem_lie.contact.sides.passage import Passage
from fem_lie.contact.sides.patches import NET, ROWS, VALUE, Patches, set_nets, set_shapes
from fem_lie.contact.sides.surfaces import MOST_NODES
from fem_lie.contact.sides.table import GROUND, Side, empty_side, least

_STILL = 0.5
"""Part of the radii: by less nobody moves through another in a step."""


class Facing(Sides):
    """Places that meet patches."""

    def __init__(self, a: Side, fixed: Side, areas: Array, b: Patches, left_out: Indices) -> None:
        """Keep both sides.

        Args:
            a: Balls, or places of shells with half of their thickness.
            fixed: What anchors of friction are fixed to there.
            areas: That each of these stands for, or one.
            b: Patches.
            left_out: Pairs of both that never touch, shape (m, 2).
        """
        self._a, self._fixed, self._areas, self._b = a, fixed, areas, b
        self._middles = middles_of(b)
        self.near = NearPairs(a, self._middles, flat=False, same=False, left_out=left_out)
        self.radius = least(a.radii, b.radii)
        self.on_ground = bool((a.owners == GROUND).any())
        self._version = -1

    def meet(self, H: Array) -> Meeting:
        """See the base class."""
        self.near.update(H)
        return self._meet(H)

    def _meet(self, H: Array) -> Meeting:
        if self.near.version != self._version:
            self._version = self.near.version
            self._room = self._space(len(self.near.now))
        return self._found(H, self._room, empty_side(0), np.zeros((0, 2), dtype=np.int64))

    def _space(self, most: int) -> Meeting:
        return Meeting(
            self._a,
            empty_side(most),
            False,
            np.zeros((most, 2), dtype=np.int64),
            np.zeros(most),
            np.zeros(most, dtype=np.int64),
            no_sliding(most),
        )

    def _found(self, H: Array, room: Meeting, fixed: Side, keys: Indices) -> Meeting:
        set_nets(H, self._b)
        near = self.near.now, self.near.first
        k = set_facing(H, self._a, self._areas, self._b, *near, room, fixed, keys)
        return room._replace(pairs=room.pairs[:k])

    def stations(self, H: Array) -> Stations:
        """See the base class: where places are near, one for each face of a sheet."""
        self.near.update(H)
        most = len(self.near.now)
        fixed, keys = empty_side(most), np.zeros((most, 2), dtype=np.int64)
        at = self._found(H, self._space(most), fixed, keys)
        return Stations(at, keys[: len(at.pairs)], self._fixed, fixed)

    def meet_ends(self, start: Array, end: Array, *, known: bool) -> list[Meeting]:
        """See the base class."""
        if not known:
            self.near.cover(start, end)
        return [copied(self._meet(H)) for H in (start, end)]

    def passed(self, start: Array, end: Array) -> Passage | None:
        """See the base class: on straight ways, with all that moves alike taken away."""
        X = np.empty((2, len(self._a.radii), 3))
        N = np.empty((2, *self._b.nets.shape))
        for k, H in enumerate((start, end)):
            places(H, self._a, X[k])
            set_nets(H, self._b._replace(nets=N[k]))
        corners = self._b.nodes >= 0
        x = N[:, :, :MOST_NODES]
        common = 0.5 * ((X[1] - X[0]).mean(axis=0) + (x[1] - x[0])[corners].mean(axis=0))
        ways = np.linalg.norm(X[1] - X[0] - common, axis=1)
        moved = np.linalg.norm(x[1] - x[0] - common, axis=2)
        turned = np.where(corners, moved, 0.0).max(axis=1)
        least_reach = self._a.radii.min() + self._b.radii.min()
        if not ways.max() + turned.max() > _STILL * least_reach:
            return None
        Y = np.empty((2, len(self._b.radii), 3))
        for k, H in enumerate((start, end)):
            places(H, self._middles, Y[k])
        at = 0.5 * np.concatenate([X.sum(axis=0), Y.sum(axis=0)])
        reach = np.concatenate([self._a.radii, self._middles.radii])
        pairs = self.near.within(at, reach + 0.5 * np.concatenate([ways, turned]))
        triangle = bool((self._b.nodes[:, 3] < 0).all())
        e = first_crossing(X, (self._a.radii, self._b.radii), N, triangle, self._b.straight, pairs)
        if e < 0:
            return None
        i, j = pairs[e]
        moved = float(np.linalg.norm(X[1, i] - X[0, i] - (Y[1, j] - Y[0, j])))
        return Passage(moved, float(self._a.radii[i] + self._b.radii[j]))

    def settle(self) -> None:
        """See the base class; there is nothing."""


def middles_of(patches: Patches) -> Side:
    """Balls about the middles of patches of one sort that have all of them within."""
    triangle = bool((patches.nodes[:, 3] < 0).all())
    k, u = (3, 1.0 / 3.0) if triangle else (4, 0.5)
    found, W = empty_side(len(patches.nodes)), np.zeros((ROWS, NET))
    set_shapes(triangle, patches.straight, u, u, W)
    found.nodes[:] = patches.nodes
    found.weights[:] = W[VALUE, :MOST_NODES]
    parts = W[VALUE, MOST_NODES:].reshape(MOST_NODES, 2, 1)
    found.levers[:] = (parts * patches.tangents).sum(axis=2)
    middles = W[VALUE] @ patches.nets
    reach = np.linalg.norm(patches.nets[:, :k] - middles[:, np.newaxis], axis=2).max(axis=1)
    found.radii[:], found.owners[:] = patches.radii + _BULGE * reach, patches.nodes[:, 0]
    return found


_BULGE = 1.1
"""Reach of patches from their middles over that at first: by how much they may be stretched."""
