"""Histories of results for runs whose number of steps is not known in advance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from tqdm import tqdm

from fem_lie._arrays import Array
from fem_lie.bodies.catalogue import SceneInfo
from fem_lie.parts.part_scene import ScenePart
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.plan import NEAR, ChosenSteps, EqualSteps
from fem_lie.solve.recording.recorder import History, Recorder
from fem_lie.system.equations import Equations

_ROWS = 256
_PERCENT = 100
_TIMES = "growing.times"


class Growing(History):
    """History for any number and size of steps; its progress bar shows the time."""

    def _grow_with(self, plan: ChosenSteps, progress: bool | None) -> None:
        self._duration, self._saving = plan.duration, plan.saving
        # times of the last state and of the last checkpoint
        self._before, self._saved = 0.0, 0.0
        if self._store is not None and self._store.state:
            self._before, self._saved = map(float, self._store.state[_TIMES])
        # ``None``: no bar without a terminal
        hidden = None if progress is None else not progress
        self._bar = tqdm(total=_PERCENT, unit="%", disable=hidden, mininterval=0.5)

    def checkpoint_due(self, index: int) -> bool:
        """Whether a checkpoint is due, by time if no number of steps was given."""
        if self._store is None:
            return False
        if self._store.every:
            return index % self._store.every == 0
        return self._percent(self._before) > self._percent(self._saved)

    def steps_until_due(self, index: int) -> int:
        """Number of steps after which a row or a checkpoint may be due, at least 1.

        Args:
            index: Number of steps made.
        """
        every = [self._saving.every] if self._saving.times is None else [1]
        if self._store is not None:
            every.append(self._store.every or 1)
        return min(each - index % each for each in every)

    def _percent(self, time: float) -> int:
        return int(_PERCENT * time / self._duration)

    def write_checkpoint(self, index: int, state: dict[str, Array]) -> None:
        """Write a checkpoint of the run."""
        self._saved = self._before
        own = {_TIMES: np.array([self._before, self._saved])}
        super().write_checkpoint(index, state | own)

    def due(self, time: float, ahead: float, index: int, iterations: int, event: bool) -> bool:
        """Whether the state after step ``index`` is to be recorded; if so, a row is reserved.

        Args:
            time: Time of the state.
            ahead: Largest size of the next step: requested times may lie within it.
            index: Number of steps made.
            iterations: Iterations of the last step.
            event: Whether the time is a discontinuity, the start or the end: two rows are then
                recorded, for both one-sided values.
        """
        times = self._saving.times
        if times is None:
            wanted = event or index % self._saving.every == 0
        else:
            # no step follows the end, and the end may be one of the requested times
            slack = NEAR * max(ahead, time - self._before)
            first = np.searchsorted(times, self._before - slack)
            end = np.searchsorted(times, time + ahead + slack, side="right")
            wanted = bool(first < end)
        self._before = time
        self._bar.update(self._percent(time) - self._bar.n)
        if wanted:
            self.ensure_rows()
        return wanted

    def stamp(self, time: float) -> None:
        """Set the time of the last row."""
        self.times[self.row - 1] = time


def _any_number(plan: ChosenSteps) -> EqualSteps:
    """A plan of steps of any number, each of which may be recorded."""
    return EqualSteps(replace(plan.saving, every=1), _ROWS, 1.0)


class GrowingHistory(Growing):
    """History of a scheme that fills the rows itself."""

    def __init__(
        self,
        info: SceneInfo,
        plan: ChosenSteps,
        progress: bool | None,
        store: Checkpoints | None,
        part: ScenePart | None = None,
    ) -> None:
        """As :class:`~.recorder.History`."""
        super().__init__(info, _any_number(plan), False, store, part)
        self._grow_with(plan, progress)


class GrowingRecorder(Growing, Recorder):
    """History that takes its rows from the equations of a scene."""

    def __init__(
        self,
        equations: Equations,
        plan: ChosenSteps,
        progress: bool | None,
        store: Checkpoints | None,
    ) -> None:
        """As :class:`GrowingHistory`, for equations."""
        Recorder.__init__(self, equations, _any_number(plan), False, store)
        self._grow_with(plan, progress)

    def due(self, time: float, ahead: float, index: int, iterations: int, event: bool) -> bool:
        """Whether a row is due, see :meth:`Growing.due`; iterations are counted in any case."""
        self.count += iterations
        return super().due(time, ahead, index, iterations, event)
