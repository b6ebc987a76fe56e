"""Which states a run keeps: those after every so many steps, or those at given times."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, Indices

NEAR = 1e-9
"""Part of a step within which two times are the same."""


@dataclass(frozen=True, eq=False)
class Saving:
    """What is kept.

    Attributes:
        every: States after every so many steps, and the last one.
        times: Times between steps at which it is kept instead, increasing, or ``None``.
    """

    every: int = 1
    times: Array | None = None

    @classmethod
    def chosen(
        cls, save_every: int, save_at: float | npt.ArrayLike | None, duration: float
    ) -> Saving:
        """From the arguments of a run.

        Args:
            save_every: States after every so many steps.
            save_at: An interval, or times, instead.
            duration: Of the run.

        Raises:
            ValueError: They are bad, or both are given.
        """
        if save_every < 1:
            raise ValueError(f"save_every must be at least 1, got {save_every}")
        if save_at is None:
            return cls(int(save_every))
        if save_every != 1:
            raise ValueError(
                f"give save_every or save_at, got save_every={save_every} and save_at={save_at}"
            )
        given: Array = np.asarray(save_at, dtype=np.float64)
        times = _multiples(float(given), duration) if given.ndim == 0 else given
        slack = NEAR * duration
        if (
            times.ndim != 1
            or not len(times)
            or not (times[0] >= -slack and times[-1] <= duration + slack)
            or not (np.diff(times) > 0.0).all()
        ):
            raise ValueError(
                f"save_at must be an interval, or increasing times within [0, {duration:g}], "
                f"got {save_at}"
            )
        return cls(1, np.clip(times, 0.0, duration))

    def steps(self, step: float, count: int) -> Indices | None:
        """Those of ``count`` constant steps on whose ends the times lie or between which they do.

        ``None``: there are no times.
        """
        if self.times is None:
            return None
        at = self.times / step
        both = np.concatenate([np.floor(at + NEAR), np.ceil(at - NEAR)])
        return np.unique(np.clip(both, 0, count).astype(np.int64))


def _multiples(interval: float, duration: float) -> Array:
    """Of an interval up to the end, and the end."""
    if not (np.isfinite(interval) and 0.0 < interval <= (1.0 + NEAR) * duration):
        raise ValueError(
            f"save_at must be an interval within (0, {duration:g}] or times, got {interval}"
        )
    times = interval * np.arange(int(duration / interval + NEAR) + 1)
    ends = abs(times[-1] - duration) <= NEAR * interval
    return np.append(times[:-1] if ends else times, duration)
