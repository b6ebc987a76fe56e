"""Keeps what an integrator computes when the number of steps is not known in advance."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from tqdm import tqdm

from fem_lie.info import SceneInfo
from fem_lie.results import Result
from fem_lie.solve.recorder import History, Recorder
from fem_lie.solve.saving import NEAR, Saving
from fem_lie.solve.step_control import Control
from fem_lie.solve.time_error import StepError
from fem_lie.step_history import StepHistory
from fem_lie.system import System

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
            slack = NEAR * ahead
            first, end = np.searchsorted(times, [self._before - slack, time + ahead + slack])
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
        """For a run of the given duration; see :class:`~fem_lie.solve.recorder.History`."""
        super().__init__(info, _ROWS, 1.0, Saving(1, saving.times), False)
        self._grow_with(duration, saving, progress)


class GrowingRecorder(Growing, Recorder):
    """That takes what it keeps from the equations of a scene."""

    def __init__(
        self, system: System, duration: float, saving: Saving, progress: bool | None
    ) -> None:
        """As :class:`GrowingHistory`, for the equations ``system``."""
        Recorder.__init__(self, system, _ROWS, 1.0, Saving(1, saving.times), False)
        self._grow_with(duration, saving, progress)

    def due(self, time: float, ahead: float, index: int, iterations: int, event: bool) -> bool:
        """See the base class; iterations are counted in any case."""
        self._count += iterations
        return super().due(time, ahead, index, iterations, event)


@dataclass
class StepLog:
    """Collects :class:`~fem_lie.step_history.StepHistory`."""

    system: System
    times: list[float] = field(default_factory=list)
    sizes: list[float] = field(default_factory=list)
    errors: list[StepError] = field(default_factory=list)
    measured: list[tuple[float, float]] = field(default_factory=list)
    rejected: list[float] = field(default_factory=list)

    def add(
        self, time: float, size: float, error: StepError, measured: tuple[float, float]
    ) -> None:
        """A step that was accepted."""
        self.times.append(time)
        self.sizes.append(size)
        self.errors.append(error)
        self.measured.append(measured)

    def history(self) -> StepHistory:
        """All of them."""
        errors = np.array(self.errors, dtype=np.float64).reshape(-1, 4)
        measured = np.array(self.measured, dtype=np.float64).reshape(-1, 2)
        leaders = self.system.numbering.attachment.leaders
        return StepHistory(
            times=np.array(self.times),
            sizes=np.array(self.sizes),
            translation=errors[:, 0],
            rotation=errors[:, 1],
            nodes=leaders[errors[:, 2:].astype(np.int64)],
            measured_translation=measured[:, 0],
            measured_rotation=measured[:, 1],
            rejected=np.array(self.rejected),
        )

    def body(self, node: int) -> str:
        """Label of the body of a moving node."""
        numbering = self.system.numbering
        for body, nodes in numbering.nodes.items():
            if node in numbering.attachment.leader[nodes]:
                return body.label
        raise AssertionError("a node without a body")

    def underflow(
        self, control: Control, time: float, h: float, error: StepError | None, increment: float
    ) -> str:
        """What to say when the step becomes too small.

        Args:
            control: Of the steps.
            time: Where the run stands.
            h: Size of the last step that was tried.
            error: Its error, ``None`` if it did not converge.
            increment: Its last increment.
        """
        text = f"at time {time:.9g} a step of {h:.3g} "
        if error is None:
            return (
                f"{text}did not converge, and smaller ones than {control.smallest:.3g} are not "
                f"allowed: last increment {increment:.2e}"
            )
        moved = error.translation / control.tolerance >= error.rotation / control.rotation_tolerance
        size, tolerance, unit, node = (
            (error.translation, control.tolerance, "length", error.translation_node)
            if moved
            else (error.rotation, control.rotation_tolerance, "rad", error.rotation_node)
        )
        return (
            f"{text}has an estimated error of {size / h:.3e} {unit} per time, wanted at most "
            f"{tolerance:.3e}, and steps below {control.smallest:.3g} are not allowed; "
            f"{self.body(node)} limits it. Name the times of jumps as events, or give a larger "
            "tolerance or a smaller `smallest`"
        )

    def complete(self, result: Result) -> Result:
        """The result with the history of its steps."""
        return replace(result, steps=self.history())
