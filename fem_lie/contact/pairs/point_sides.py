"""Sides of a contact: points as the first, patches of surfaces or lines as the second."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.contact.sides.curves import set_curves
from fem_lie.contact.sides.detection import first_crossing
from fem_lie.contact.sides.gauss_points import (
    lines_of,
    runs_of,
    set_nearest_of_lines,
    set_separations,
    strands_of,
)
from fem_lie.contact.sides.gauss_points import middles_of as middles_of_lines
from fem_lie.contact.sides.kinematics import positions
from fem_lie.contact.sides.pairs import NearPairs
from fem_lie.contact.sides.passage import Passage, first_passage
from fem_lie.contact.sides.patch_contacts import set_patch_contacts
from fem_lie.contact.sides.patches import NET, ROWS, VALUE, Patches, set_nets, set_shapes
from fem_lie.contact.sides.surfaces import MOST_NODES, Piece
from fem_lie.contact.sides.table import (
    GROUND,
    ROUND,
    UNUSED,
    ContactPoints,
    Nodes,
    Samples,
    Side,
    Stations,
    empty_contacts,
    empty_side,
    least,
)
from fem_lie.contact.sides.two_sides import ClosestPoints, first_of

_STILL = 0.5
"""Displacement in a step over the radii below which nothing can pass through a patch."""


class PointSides(ClosestPoints):
    """Points of a first side, and the closest points of a second side.

    Attributes:
        samples: Points of the first side.
    """

    def __init__(self, samples: Samples, middles: Side, radii: Array, left_out: Indices) -> None:
        """Store the first side.

        Args:
            samples: Points of the first side.
            middles: Balls that enclose the parts of the second side.
            radii: Radius of each part of the second side, shape (m,).
            left_out: Pairs of a point and a part that never touch, shape (k, 2).
        """
        super().__init__()
        self.samples, self._middles = samples, middles
        self.near = NearPairs(samples.at, middles, kind=ROUND, same=False, left_out=left_out)
        self.radius = least(samples.at.radii, radii)
        self.on_ground = bool(any((side.owners == GROUND).any() for side in (samples.at, middles)))

    @abstractmethod
    def _found(
        self, H: Array, workspace: ContactPoints, fixed: Side, keys: Indices
    ) -> ContactPoints:
        """Contact points at frames; with space for them, those of friction springs, too."""

    def _take_pairs(self) -> None:
        """Do nothing: closest points depend on the list alone."""

    def _find(self, H: Array, place: int) -> ContactPoints:
        return self._found(H, self._room(place), empty_side(0), np.zeros((0, 2), dtype=np.int64))

    def _space(self) -> ContactPoints:
        most = len(self.near.now)
        return empty_contacts(self.samples.at, empty_side(most), ROUND, most)

    def _space_of_stations(self) -> Stations:
        at = self._space()
        keys = np.zeros((len(at.weight), 2), dtype=np.int64)
        return Stations(at, keys, self.samples.fixed, empty_side(len(at.weight)))

    def _set_stations(self, H: Array, room: Stations) -> int:
        """Set points near the second side, at which friction springs act."""
        return len(self._found(H, room.at, room.b, room.keys).pairs)

    @property
    def near_balls(self) -> Side:
        """Balls that enclose the parts of the second side."""
        return self._middles

    def keep_stretches(self) -> None:
        """Do nothing."""

    def take_kept_stretches(self) -> None:
        """Do nothing."""


class CurveSides(PointSides):
    """Points, and lines."""

    def __init__(self, samples: Samples, pieces: Sequence[Piece], nodes: Nodes) -> None:
        """Store both sides.

        Args:
            samples: Points of the first side.
            pieces: Segments of the lines.
            nodes: Gives the numbers of the nodes of a body in the scene.
        """
        self._b = strands_of(pieces, nodes)
        self._chains = lines_of(self._b)
        none = np.empty((0, 2), dtype=np.int64)
        super().__init__(samples, middles_of_lines(pieces, self._b), self._b.radii, none)

    def _found(
        self, H: Array, workspace: ContactPoints, fixed: Side, keys: Indices
    ) -> ContactPoints:
        return self._nearest(H, workspace, keys, 1.0)

    def _nearest(
        self, H: Array, workspace: ContactPoints, keys: Indices, beyond: float
    ) -> ContactPoints:
        set_curves(H, self._b, False)
        runs = runs_of(self.near.now, self._b.after)
        given = H, self.samples, self._b, runs, self.near.first, beyond
        k = set_nearest_of_lines(*given, workspace, keys)
        return first_of(workspace, k)

    def _space_of_stations(self) -> Stations:
        found = super()._space_of_stations()
        return found._replace(b=found.at.b)

    def _set_stations(self, H: Array, room: Stations) -> int:
        """Set points near the lines; the closest points on these are material points."""
        keys = room.keys
        k = len(self._nearest(H, room.at, keys, 2.0).pairs)
        keys[:k, 1] = self._chains[keys[:k, 1]]
        return k

    def passed(self, start: Array, end: Array) -> Passage | None:
        """A point that passed through a line, on a straight path from its closest point there."""
        runs = runs_of(self.near.in_step(start, end)[2], self._b.after)
        separations, feet = np.empty((2, len(runs), 3)), empty_side(len(runs))
        set_curves(start, self._b, False)
        set_separations(start, end, self.samples.at, self._b, runs, feet, separations)
        reach = self.samples.at.radii[runs[:, 0]] + self._b.radii[runs[:, 1]]
        e = first_passage(separations, reach)
        if e < 0:
            return None
        moved = np.linalg.norm(separations[1, e] - separations[0, e])
        return Passage(float(moved), float(reach[e]))


class PatchSides(PointSides):
    """Points, and patches of surfaces."""

    def __init__(
        self,
        samples: Samples,
        b: Patches,
        left_out: Indices,
        of: tuple[Indices, Indices] | None = None,
    ) -> None:
        """Store both sides.

        Args:
            samples: Points of the first side.
            b: Patches.
            left_out: Pairs of a point and a patch that never touch, shape (k, 2).
            of: Surface of each point and of each patch, shapes (n,) and (m,), if both sides have
                points and patches of both surfaces: those of the same surface do not touch.
        """
        self._b, middles = b, middles_of(b)
        if of is not None:
            samples = samples._replace(at=samples.at._replace(owners=of[0]))
            middles = middles._replace(owners=of[1])
        super().__init__(samples, middles, b.radii, left_out)
        self.on_ground = bool((samples.fixed.owners == GROUND).any() or (b.nodes == GROUND).any())

    def _found(
        self, H: Array, workspace: ContactPoints, fixed: Side, keys: Indices
    ) -> ContactPoints:
        set_nets(H, self._b)
        a, _, areas = self.samples
        near = self.near.now, self.near.first
        k = set_patch_contacts(H, a, areas, self._b, *near, workspace, fixed, keys)
        return first_of(workspace, k)

    def passed(self, start: Array, end: Array) -> Passage | None:
        """A pair that passed through each other, on straight relative paths."""
        a = self.samples.at
        X = np.empty((2, len(a.radii), 3))
        N = np.zeros((2, *self._b.nets.shape))
        for k, H in enumerate((start, end)):
            positions(H, a, X[k])
            set_nets(H, self._b._replace(nets=N[k]))
        corners = self._b.corners >= 0
        x = N[:, :, :MOST_NODES]
        common = 0.5 * ((X[1] - X[0]).mean(axis=0) + (x[1] - x[0])[corners].mean(axis=0))
        ways = np.linalg.norm(X[1] - X[0] - common, axis=1)
        moved = np.linalg.norm(x[1] - x[0] - common, axis=2)
        turned = np.where(corners, moved, 0.0).max(axis=1)
        least_reach = a.radii.min() + self._b.radii.min()
        if not ways.max() + turned.max() > _STILL * least_reach:
            return None
        Y = np.empty((2, len(self._b.radii), 3))
        for k, H in enumerate((start, end)):
            positions(H, self._middles, Y[k])
        at = 0.5 * np.concatenate([X.sum(axis=0), Y.sum(axis=0)])
        reach = np.concatenate([a.radii, self._middles.radii])
        pairs = self.near.within(at, reach + 0.5 * np.concatenate([ways, turned]))
        e = first_crossing(X, a.radii, N, self._b, pairs)
        if e < 0:
            return None
        i, j = pairs[e]
        moved = float(np.linalg.norm(X[1, i] - X[0, i] - (Y[1, j] - Y[0, j])))
        return Passage(moved, float(a.radii[i] + self._b.radii[j]))


def middles_of(patches: Patches) -> Side:
    """Balls about the centres of patches that enclose the patches."""
    found, W = empty_side(len(patches.nodes)), np.zeros((ROWS, NET))
    found.nodes[:], found.owners[:] = UNUSED, patches.nodes[:, 0]
    triangles = patches.corners[:, 3] < 0
    for triangle, k, u in ((True, 3, 1.0 / 3.0), (False, 4, 0.5)):
        own = np.flatnonzero(triangles == triangle)
        set_shapes(triangle, patches.straight, u, u, W)
        parts, w = W[VALUE, MOST_NODES:].reshape(MOST_NODES, 2, 1), W[VALUE, :MOST_NODES]
        arms = w[:, np.newaxis] * patches.offsets[own]
        arms += (parts * patches.tangents[own]).sum(axis=2)
        for corner in range(k):
            slots = patches.slots[own, corner]
            found.nodes[own, slots] = patches.nodes[own, corner]
            found.weights[own, slots] += w[corner]
            found.arms[own, slots] += arms[:, corner]
        nets = patches.nets[own]
        reach = np.linalg.norm(nets[:, :k] - (W[VALUE] @ nets)[:, np.newaxis], axis=2).max(axis=1)
        found.radii[own] = patches.radii[own] + _BULGE * reach
    return found


_BULGE = 1.1
"""Reach of patches from their centres over the initial reach: allows for stretching."""
