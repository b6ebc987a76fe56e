"""Points of a mortar contact: Gauss points of a line with the shape functions of the pressure."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array, Flags, Indices
from fem_lie.contact.mortar.segments import Second, no_patches, set_segments
from fem_lie.contact.pairs.line_patches import LinePatchSides
from fem_lie.contact.sides.curves import set_curves
from fem_lie.contact.sides.gauss_points import (
    GAUSS,
    GAUSS_AT,
    line_samples,
    lines_of,
    middles_of,
    runs_of,
    strands_of,
)
from fem_lie.contact.sides.pairs import NearPairs
from fem_lie.contact.sides.passage import Passage
from fem_lie.contact.sides.patches import Patches, set_nets
from fem_lie.contact.sides.surfaces import Piece
from fem_lie.contact.sides.table import (
    ROUND,
    ContactPoints,
    Nodes,
    Side,
    empty_contacts,
    empty_side,
    least,
)
from fem_lie.contact.sides.two_sides import Balls, Lines, Sides


class MortarPoints(NamedTuple):
    """Integration points of weighted gaps.

    Attributes:
        at: Pairs of points with integration weights.
        pressures: Numbers of the two pressures that are interpolated there, shape (m, 2).
        shapes: Their shape functions, shape (m, 2).
        beyond: Whether the point faces a free end of the second line, shape (m,).
    """

    at: ContactPoints
    pressures: Indices
    shapes: Array
    beyond: Flags


class Couplings(NamedTuple):
    """Which nodes each pressure may act on.

    Attributes:
        pressures: Numbers of pressures, shape (k,).
        nodes: Nodes, shape (k,).
    """

    pressures: Indices
    nodes: Indices


class MortarSides(ABC):
    """A line with a pressure per node, and a second side.

    There is one pressure for each node of the line and each part of the second side: a plane, or a
    line of a body. It is linear along the elements of the line.

    Attributes:
        lengths: Length of the line that belongs to each pressure, ``∫ Φ ds``, shape (n,), m.
        radius: Least radius, up to which gaps count, m.
    """

    lengths: Array
    radius: float

    def __init__(self, pieces: Sequence[Piece], nodes: Nodes, parts: int) -> None:
        """Number the pressures.

        Args:
            pieces: Elements of the line.
            nodes: Gives the numbers of the nodes of a body in the scene.
            parts: Number of parts of the second side.
        """
        self.a, self._parts = strands_of(pieces, nodes), parts
        m = len(pieces)
        begins = self.a.before < 0
        first = np.cumsum(begins) - 1
        starts = np.arange(m) + first
        ends = np.where(self.a.after >= 0, starts[self.a.after], starts + 1)
        self._ends = np.stack([starts, ends], axis=1)
        lengths = np.zeros(m + int(begins.sum()))
        np.add.at(lengths, self._ends, 0.5 * self.a.lengths[:, np.newaxis])
        self.lengths = np.repeat(lengths, parts)

    @property
    @abstractmethod
    def near(self) -> NearPairs:
        """List of near elements and parts."""

    @property
    @abstractmethod
    def couplings(self) -> Couplings:
        """Nodes that pressures act on, for the present list of pairs."""

    @abstractmethod
    def points(self, H: Array) -> MortarPoints:
        """Integration points at frames ``H``, with an update of the list of pairs."""

    @property
    @abstractmethod
    def sides(self) -> Sides:
        """Both sides as for other laws."""

    def passed(self, start: Array, end: Array) -> Passage | None:
        """A pair that passed through each other between frames."""
        return self.sides.passed(start, end)

    def numbers(self, elements: Indices, parts: Indices) -> Indices:
        """Numbers of the pressures at both ends of elements, shape (m, 2).

        Args:
            elements: Elements of the line, shape (m,).
            parts: Parts of the second side, shape (m,).
        """
        return np.asarray(self._ends[elements] * self._parts + parts[:, np.newaxis])

    def coupled(self, elements: Indices, parts: Indices, nodes: Indices) -> Couplings:
        """Couplings of the pressures of elements with nodes, (m, k), which may be unused."""
        numbers = self.numbers(elements, parts)
        own = np.concatenate([self.a.nodes[elements], nodes], axis=1)
        A = np.repeat(numbers[:, :, np.newaxis], own.shape[1], axis=2)
        every = np.broadcast_to(own[:, np.newaxis], A.shape)
        return Couplings(A[every >= 0], every[every >= 0])


def _shapes(s: Array) -> Array:
    """Linear shape functions of the pressure at parameters of elements, shape (m, 2)."""
    return np.stack([1.0 - s, s], axis=1)


class _Segmented(MortarSides):
    """A line with mortar segments, each of which faces one element of the second side."""

    def __init__(
        self, pieces: Sequence[Piece], nodes: Nodes, parts: int, middles: Side, radii: Array
    ) -> None:
        """Store the line.

        Args:
            pieces: Elements of the line.
            nodes: Gives the numbers of the nodes of a body in the scene.
            parts: Number of parts of the second side.
            middles: Balls that enclose the elements of the second side.
            radii: Radii of the elements of the second side, shape (m,).
        """
        super().__init__(pieces, nodes, parts)
        self.radius = least(self.a.radii, radii)
        own = middles_of(pieces, self.a)
        # elements are listed that are closer than the gaps that count
        wide = own._replace(radii=own.radii + self.radius)
        self._near = NearPairs(wide, middles, kind=ROUND, same=False)
        self._set_space(GAUSS)

    @property
    def near(self) -> NearPairs:
        """List of near elements of both sides."""
        return self._near

    @abstractmethod
    def _second(self, H: Array) -> tuple[Second, Indices]:
        """The second surface at frames ``H``, and runs as for :func:`set_segments`."""

    @abstractmethod
    def _parts_of(self, elements: Indices) -> Indices:
        """Part of the second side that its elements belong to."""

    def _set_space(self, most: int) -> None:
        self._room = empty_contacts(empty_side(most), empty_side(most), ROUND, most)
        self._at_s: Array = np.empty(most)
        self._of: Indices = np.empty((most, 2), dtype=np.int64)
        self._beyond: Flags = np.empty(most, dtype=np.bool_)

    def _set_points(self, b: Second, runs: Indices) -> int:
        workspace = self._room, self._at_s, self._of, self._beyond
        return set_segments(self.a, b, runs, *workspace)

    def points(self, H: Array) -> MortarPoints:
        """Gauss points of all mortar segments."""
        self._near.update(H)
        set_curves(H, self.a, True)
        b, runs = self._second(H)
        while (k := self._set_points(b, runs)) == len(self._at_s):
            self._set_space(2 * k)
        i, j = self._of[:k].T
        numbers, shapes = self.numbers(i, self._parts_of(j)), _shapes(self._at_s[:k])
        found = self._room._replace(pairs=self._room.pairs[:k], weight=self._room.weight[:k])
        return MortarPoints(found, numbers, shapes, self._beyond[:k])


class LinesOnLines(_Segmented):
    """A line and other lines."""

    def __init__(self, a: Sequence[Piece], b: Sequence[Piece], nodes: Nodes) -> None:
        """Store both sides.

        Args:
            a: Elements of the first line.
            b: Elements of the second line.
            nodes: Gives the numbers of the nodes of a body in the scene.
        """
        self._b = strands_of(b, nodes)
        self._chains = lines_of(self._b)
        middles = middles_of(b, self._b)
        super().__init__(a, nodes, int(self._chains.max()) + 1, middles, self._b.radii)
        self._lines = Lines(a, b, None, nodes)

    @property
    def sides(self) -> Lines:
        """Both sides as for other laws."""
        return self._lines

    @property
    def couplings(self) -> Couplings:
        """Nodes of all near elements."""
        i, j = self._near.now.T
        return self.coupled(i, self._chains[j], self._b.nodes[j])

    def _parts_of(self, elements: Indices) -> Indices:
        return np.asarray(self._chains[elements])

    def _second(self, H: Array) -> tuple[Second, Indices]:
        set_curves(H, self._b, True)
        none = np.empty((0, 2), dtype=np.int64)
        return Second(self._b, no_patches(), none), runs_of(self._near.now, self._b.after)


class LinesOnPatches(_Segmented):
    """A line and a surface of patches."""

    def __init__(self, a: Sequence[Piece], b: Patches, nodes: Nodes) -> None:
        """Store both sides.

        Args:
            a: Elements of the line.
            b: Patches of the surface.
            nodes: Gives the numbers of the nodes of a body in the scene.
        """
        self._b, self._whole = b, LinePatchSides(a, b, nodes)
        self._none = strands_of([], nodes)
        super().__init__(a, nodes, 1, self._whole.near_balls, b.radii)

    @property
    def sides(self) -> LinePatchSides:
        """Both sides as for other laws."""
        return self._whole

    @property
    def couplings(self) -> Couplings:
        """Nodes of all near elements and patches."""
        i, j = self._near.now.T
        return self.coupled(i, np.zeros_like(j), self._b.nodes[j])

    def _parts_of(self, elements: Indices) -> Indices:
        return np.zeros_like(elements)

    def _second(self, H: Array) -> tuple[Second, Indices]:
        set_nets(H, self._b)
        i, last = self._near.now[:, 0], len(self._near.now) - 1
        ends = np.append(np.flatnonzero(np.diff(i)), last) if len(i) else np.empty(0, np.int64)
        runs = np.stack([i[ends], np.append(0, ends + 1)[: len(ends)], ends], axis=1)
        return Second(self._none, self._b, self._near.now), runs


class LinesOnParts(MortarSides):
    """A line, and parts that are smooth everywhere: planes, hollow spheres, gap functions."""

    def __init__(self, a: Sequence[Piece], b: Side, nodes: Nodes, kind: int) -> None:
        """Store both sides.

        Args:
            a: Elements of the line.
            b: The parts.
            nodes: Gives the numbers of the nodes of a body in the scene.
            kind: Kind of the pairs.
        """
        super().__init__(a, nodes, len(b.radii))
        at, fixed, lengths = line_samples(a, nodes)
        self._balls = Balls(at, b, kind=kind, same=False, areas=lengths, fixed=fixed)
        self._b, self.radius = b, least(at.radii)
        self._shapes = _shapes(np.tile(0.5 + 0.5 * GAUSS_AT, len(a)))

    @property
    def near(self) -> NearPairs:
        """List of all points and parts."""
        return self._balls.near

    @property
    def sides(self) -> Balls:
        """Both sides as for other laws."""
        return self._balls

    @property
    def couplings(self) -> Couplings:
        """Nodes of all elements, and of the parts."""
        i, j = self.near.now.T
        return self.coupled(i // GAUSS, j, self._b.nodes[j])

    def points(self, H: Array) -> MortarPoints:
        """Gauss points of all elements."""
        at = self._balls.meet(H)
        i, j = at.pairs.T
        numbers = self.numbers(i // GAUSS, j)
        return MortarPoints(at, numbers, self._shapes[i], np.zeros(len(i), dtype=np.bool_))
