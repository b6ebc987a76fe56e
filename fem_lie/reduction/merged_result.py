"""A motion in time segments with regions that move as rigid bodies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array
from fem_lie._summary import Summarised
from fem_lie.adaptivity.following.transfer import Transferred
from fem_lie.results.history import Result


class RegionSegment(NamedTuple):
    """A time segment of a motion with constant regions.

    Attributes:
        begin: Start of the segment; times of its result are relative to it.
        result: Result of the segment, with all nodes; it may extend beyond the segment.
        rows: Index of the last state of the segment.
        frames: Number of independent frames.
        change: Momenta and energies before and after the change to these regions; ``None`` for the
            first segment.
    """

    begin: float
    result: Result
    rows: int
    frames: int
    change: Transferred | None


@dataclass(frozen=True, eq=False, repr=False)
class MergedMotion(Summarised):
    """Result of :func:`~fem_lie.reduction.merged_motion`.

    Times at which regions change have two rows.

    Attributes:
        segments: Time segments in order.
        nodes: Number of independent frames without regions.
        repeated: Number of segments that were rejected and repeated.
    """

    segments: tuple[RegionSegment, ...]
    nodes: int
    repeated: int

    @property
    def times(self) -> Array:
        """Times of all recorded states, shape (T,)."""
        return np.concatenate(
            [part.begin + part.result.times[: part.rows + 1] for part in self.segments]
        )

    @property
    def frames(self) -> Array:
        """Frames of all nodes, shape (T, N, 4, 3)."""
        return np.concatenate([part.result.frames[: part.rows + 1] for part in self.segments])

    @property
    def active_fraction(self) -> float:
        """Number of independent frames over that without regions, mean over time."""
        spans = np.array([part.result.times[part.rows] for part in self.segments])
        frames = np.array([part.frames for part in self.segments])
        return float(spans @ frames / (self.nodes * spans.sum()))

    @property
    def momentum_error(self) -> float:
        """Largest relative change of momenta where regions changed."""
        changes = [part.change.momentum_error for part in self.segments if part.change]
        return max(changes, default=0.0)

    @property
    def energy_change(self) -> float:
        """Sum of the changes of kinetic and elastic energy where regions changed."""
        return sum(part.change.energy_change for part in self.segments if part.change)

    def __str__(self) -> str:
        """One line: numbers of frames, and the errors of changes."""
        frames = [part.frames for part in self.segments]
        return (
            f"{min(frames)} to {max(frames)} of {self.nodes} frames, "
            f"{100 * self.active_fraction:.3g} % in the mean of {len(frames)} segments "
            f"({self.repeated} repeated); momenta kept to "
            f"{self.momentum_error:.1g}, energy changed by {self.energy_change:.2g}"
        )
