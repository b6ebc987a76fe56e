"""Keeps what an integrator computes when the number of steps is not known in advance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from tqdm import tqdm

from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.solve.recording.recorder import History, Recorder
from fem_lie.solve.recording.saving import NEAR, Saving
from fem_lie.system.equations import Equations

_ROWS = 256
_PERCENT = 100


class Growing(History):
    """A history for steps of any number and size; its bar shows the time."""

    def _grow_with(self, duration: float, saving: Saving, progress: bool | None) -> None:
        self._duration, self._saving, self._before = duration, saving, 0.0
        # ``None``: not where there is no terminal
        hidden = None if progress is None else not progress
        self._bar = tqdm(total=_PERCENT, unit="%", disable=hidden, mininterval=0.5)

    def due(self, time: float, ahead: float, index: int, iterations: int, event: bool) -> bool:
        """Whether the state after step ``index`` is to be filled in; then there is room for it.

        Args:
            time: Of the state.
            ahead: Largest size of the next step: times may be between its ends.
            index: Steps made.
            iterations: Of the last one.
            event: Whether something jumps there: two rows are kept, of the sides before and after.
                So are start and end.
        """
        times = self._saving.times
        if times is None:
            wanted = event or index % self._saving.every == 0
        else:
            # at the end nothing is ahead, and the end may be one of the times
            slack = NEAR * max(ahead, time - self._before)
            first = np.searchsorted(times, self._before - slack)
            end = np.searchsorted(times, time + ahead + slack, side="right")
            wanted = bool(first < end)
        self._before = time
        self._bar.update(int(_PERCENT * time / self._duration) - self._bar.n)
        if wanted:
            self.make_room()
        return wanted

    def stamp(self, time: float) -> None:
        """Say at what time the last row is."""
        self.times[self.row - 1] = time


class GrowingHistory(Growing):
    """Of a scheme that fills the rows itself."""

    def __init__(
        self, info: SceneInfo, duration: float, saving: Saving, progress: bool | None
    ) -> None:
        """For a run of the given duration; see :class:`~.recorder.History`."""
        super().__init__(info, _ROWS, 1.0, replace(saving, every=1), False)
        self._grow_with(duration, saving, progress)


class GrowingRecorder(Growing, Recorder):
    """That takes what it keeps from the equations of a scene."""

    def __init__(
        self, equations: Equations, duration: float, saving: Saving, progress: bool | None
    ) -> None:
        """As :class:`GrowingHistory`, for equations."""
        Recorder.__init__(self, equations, _ROWS, 1.0, replace(saving, every=1), False)
        self._grow_with(duration, saving, progress)

    def due(self, time: float, ahead: float, index: int, iterations: int, event: bool) -> bool:
        """Whether a row is due, see :meth:`Growing.due`; iterations are counted in any case."""
        self.count += iterations
        return super().due(time, ahead, index, iterations, event)
