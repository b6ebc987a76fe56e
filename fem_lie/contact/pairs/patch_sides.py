"""Two sides of a contact of which the second consists of patches of shells."""

from __future__ import annotations

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.contact.sides.detection import first_crossing
from fem_lie.contact.sides.gauss_points import ContactPoints, no_sliding
from fem_lie.contact.sides.kinematics import positions
from fem_lie.contact.sides.pairs import NearPairs
from fem_lie.contact.sides.passage import Passage
from fem_lie.contact.sides.patch_contacts import set_patch_contacts
from fem_lie.contact.sides.patches import NET, ROWS, VALUE, Patches, set_nets, set_shapes
from fem_lie.contact.sides.surfaces import MOST_NODES
from fem_lie.contact.sides.table import GROUND, Side, empty_side, least
from fem_lie.contact.sides.two_sides import Sides, Stations, copied

_STILL = 0.5
"""Displacement in a step over the radii below which nothing can pass through a patch."""


class PatchSides(Sides):
    """Points of a first side and patches of a second side."""

    def __init__(self, a: Side, fixed: Side, areas: Array, b: Patches, left_out: Indices) -> None:
        """Store both sides.

        Args:
            a: Balls, or points of shells with half of the thickness as radius.
            fixed: Material points that friction springs of the first side are fixed to.
            areas: Area of each point of the first side, or one.
            b: Patches.
            left_out: Pairs of a point and a patch that never touch, shape (m, 2).
        """
        self._a, self._fixed, self._areas, self._b = a, fixed, areas, b
        self._middles = middles_of(b)
        self.near = NearPairs(a, self._middles, flat=False, same=False, left_out=left_out)
        self.radius = least(a.radii, b.radii)
        self.on_ground = bool((a.owners == GROUND).any())
        self._version = -1

    def meet(self, H: Array) -> ContactPoints:
        """Contact points at frames ``H``."""
        self.near.update(H)
        return self._meet(H)

    def _meet(self, H: Array) -> ContactPoints:
        if self.near.version != self._version:
            self._version = self.near.version
            self._room = self._space(len(self.near.now))
        return self._found(H, self._room, empty_side(0), np.zeros((0, 2), dtype=np.int64))

    def _space(self, most: int) -> ContactPoints:
        return ContactPoints(
            self._a,
            empty_side(most),
            False,
            np.zeros((most, 2), dtype=np.int64),
            np.zeros(most),
            np.zeros(most, dtype=np.int64),
            no_sliding(most),
        )

    def _found(
        self, H: Array, workspace: ContactPoints, fixed: Side, keys: Indices
    ) -> ContactPoints:
        set_nets(H, self._b)
        near = self.near.now, self.near.first
        k = set_patch_contacts(H, self._a, self._areas, self._b, *near, workspace, fixed, keys)
        return workspace._replace(pairs=workspace.pairs[:k])

    def stations(self, H: Array) -> Stations:
        """Points near the patches, at which friction springs act; one for each face of a sheet."""
        self.near.update(H)
        most = len(self.near.now)
        fixed, keys = empty_side(most), np.zeros((most, 2), dtype=np.int64)
        at = self._found(H, self._space(most), fixed, keys)
        return Stations(at, keys[: len(at.pairs)], self._fixed, fixed)

    def meet_ends(self, start: Array, end: Array, *, known: bool) -> list[ContactPoints]:
        """Contact points at the start and at the end of a step."""
        if not known:
            self.near.cover(start, end)
        return [copied(self._meet(H)) for H in (start, end)]

    def passed(self, start: Array, end: Array) -> Passage | None:
        """A pair that passed through each other, on straight relative paths."""
        X = np.empty((2, len(self._a.radii), 3))
        N = np.empty((2, *self._b.nets.shape))
        for k, H in enumerate((start, end)):
            positions(H, self._a, X[k])
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
            positions(H, self._middles, Y[k])
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

    def keep_stretches(self) -> None:
        """Do nothing."""


def middles_of(patches: Patches) -> Side:
    """Balls about the centres of patches that enclose the patches."""
    triangle = bool((patches.nodes[:, 3] < 0).all())
    k, u = (3, 1.0 / 3.0) if triangle else (4, 0.5)
    found, W = empty_side(len(patches.nodes)), np.zeros((ROWS, NET))
    set_shapes(triangle, patches.straight, u, u, W)
    found.nodes[:] = patches.nodes
    found.weights[:] = W[VALUE, :MOST_NODES]
    parts = W[VALUE, MOST_NODES:].reshape(MOST_NODES, 2, 1)
    found.arms[:] = (parts * patches.tangents).sum(axis=2)
    middles = W[VALUE] @ patches.nets
    reach = np.linalg.norm(patches.nets[:, :k] - middles[:, np.newaxis], axis=2).max(axis=1)
    found.radii[:], found.owners[:] = patches.radii + _BULGE * reach, patches.nodes[:, 0]
    return found


_BULGE = 1.1
"""Reach of patches from their centres over the initial reach: allows for stretching."""
