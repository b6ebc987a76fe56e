"""Rows of frames that constraints see: those of the system, or what stands for them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Flags, Indices
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.body import Point
from fem_lie.system.nodes.numbering import Numbering


class Rows(Protocol):
    """Rows of frames: first those that move by themselves, then ground and prescribed motions.

    Attributes:
        count: Of those that move.
        frames: At the start, shape (L, 4, 3).
        still: Which of them nothing can move, shape (L,).
    """

    count: int
    frames: Array
    still: Flags

    def of(self, point: Point) -> int:
        """The row that a point is on."""

    def ends(self, beam: Beam) -> tuple[Indices, Array]:
        """Rows of both ends of a beam's elements (e, 2), and their frames there, (e, 2, 4, 3)."""


class SystemRows:
    """See :class:`Rows`: nodes that lead, ground, and prescribed motions.

    Attributes:
        numbering: Of the nodes.
    """

    def __init__(
        self, numbering: Numbering, frames: Array, held: Flags, motions: Mapping[Point, int]
    ) -> None:
        """Of a system.

        Args:
            numbering: Of its nodes.
            frames: Initial frames of all rows.
            held: Which unknowns of the moving nodes are zero, shape (n, 6).
            motions: Points that move as prescribed, and the row of each.
        """
        self.numbering, self.count, self.frames = numbering, numbering.count, frames
        self.still = np.append(held.all(axis=1), [True] * (len(frames) - numbering.count))
        self._motions = motions

    def of(self, point: Point) -> int:
        """See :class:`Rows`."""
        row = self._motions.get(point)
        return self.numbering.node(point) if row is None else row

    def ends(self, beam: Beam) -> tuple[Indices, Array]:
        """See :class:`Rows`."""
        attachment = self.numbering.attachment
        both = self.numbering.nodes[beam][beam.elements[:, :2]]
        return attachment.leader[both], attachment.offset[both]


def in_rows(rows: Rows, at: Indices, frames: Array) -> Array:
    """Frames (…, 4, 3), given in space at the start, in those of the rows ``at`` (…)."""
    return lie.se3_compose(lie.se3_inverse(rows.frames[at]), frames)
