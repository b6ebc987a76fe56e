"""Rows of constraints that hold on to points that are no nodes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem_lie._arrays import Array, Indices
from fem_lie.bodies.beams.beam import Beam
from fem_lie.bodies.body import Point
from fem_lie.system.constraint_sets.constraint_set import Numbered
from fem_lie.system.constraint_sets.rows import SystemRows
from fem_lie.system.nodes.held_grips import HeldGrips


class GripRows:
    """See :class:`~.rows.Rows`.

    Attributes:
        grips: The grips.
        moving: Rows of the system that move and are held directly, shape (k,).
        fixed: Those that do not move by themselves, shape (f,).
    """

    def __init__(self, items: Sequence[Numbered], rows: SystemRows) -> None:
        """Collect what the items hold on to."""
        points = [point for item in items for point in item.item.points]
        self.grips = HeldGrips([p for p in points if p.joint_grip is not None], rows.numbering)
        self._rows = rows
        touched = {rows.of(point) for point in points if point.joint_grip is None}
        for item in items:
            if tie := item.item.sliding_tie():
                touched.update(int(row) for row in rows.ends(tie.beam)[0].ravel())
        order = np.array(sorted(touched), dtype=np.int64)
        self.moving, self.fixed = order[order < rows.count], order[order >= rows.count]
        self.count = len(self.moving) + self.grips.count
        self.frames = self.seen(rows.frames, self.grips.locate(rows.frames)[0])
        free = np.zeros(self.grips.count, dtype=bool)
        self.still = np.concatenate([rows.still[self.moving], free, rows.still[self.fixed]])

    def seen(self, H: Array, grips: Array) -> Array:
        """Frames of all of these rows."""
        return np.concatenate([H[self.moving], grips, H[self.fixed]])

    def of(self, point: Point) -> int:
        """See :class:`~.rows.Rows`."""
        if point.joint_grip is not None:
            return len(self.moving) + self.grips.number(point)
        return int(self._here(np.array(self._rows.of(point))))

    def ends(self, beam: Beam) -> tuple[Indices, Array]:
        """See :class:`~.rows.Rows`."""
        ends, offsets = self._rows.ends(beam)
        return self._here(ends), offsets

    def _here(self, rows: Indices) -> Indices:
        found = np.searchsorted(self.moving, rows)
        beyond = self.count + np.searchsorted(self.fixed, rows)
        return np.where(rows < self._rows.count, found, beyond)
