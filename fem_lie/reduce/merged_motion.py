"""A motion in stretches with regions that move with one frame each."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from fem_lie._arrays import Array
from fem_lie.adapt.following.transfer import Transferred
from fem_lie.results.history import Result


class RegionStretch(NamedTuple):
    """A part of a motion with the same regions.

    Attributes:
        begin: When it begins; times of its result count from there.
        result: Of this part, with all nodes; perhaps of more.
        rows: Its last state that counts.
        frames: How many frames moved by themselves.
        change: What the change to these regions has done; ``None`` for the first.
    """

    begin: float
    result: Result
    rows: int
    frames: int
    change: Transferred | None


@dataclass(frozen=True, eq=False)
class MergedMotion:
    """What :func:`~fem_lie.merged_motion` has found; rows of times come twice where regions change.

    Attributes:
        stretches: One after the other.
        nodes: How many frames move by themselves without regions.
        again: Stretches that were made in vain.
    """

    stretches: tuple[RegionStretch, ...]
    nodes: int
    again: int

    @property
    def times(self) -> Array:
        """Of all kept states, shape (T,)."""
        return np.concatenate(
            [part.begin + part.result.times[: part.rows + 1] for part in self.stretches]
        )

    @property
    def frames(self) -> Array:
        """Of all nodes, shape (T, N, 4, 3)."""
        return np.concatenate([part.result.frames[: part.rows + 1] for part in self.stretches])

    @property
    def share(self) -> float:
        """Frames that moved by themselves over all that could, mean in time."""
        spans = np.array([part.result.times[part.rows] for part in self.stretches])
        frames = np.array([part.frames for part in self.stretches])
        return float(spans @ frames / (self.nodes * spans.sum()))

    @property
    def momentum_error(self) -> float:
        """Largest relative change of momenta where regions changed."""
        changes = [part.change.momentum_error for part in self.stretches if part.change]
        return max(changes, default=0.0)

    @property
    def energy_change(self) -> float:
        """Sum of what changes of regions have done to kinetic and elastic energy."""
        return sum(part.change.energy_change for part in self.stretches if part.change)

    def __str__(self) -> str:
        """How few frames there were, and what changes did."""
        frames = [part.frames for part in self.stretches]
        return (
            f"{min(frames)} to {max(frames)} of {self.nodes} frames, {100 * self.share:.3g} % in "
            f"the mean of {len(frames)} stretches ({self.again} made in vain); momenta kept to "
            f"{self.momentum_error:.1g}, energy changed by {self.energy_change:.2g}"
        )
