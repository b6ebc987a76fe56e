"""Steps that change, with the local error of every step, for any scheme.

A step is tried; its error is estimated; it is accepted, or taken back and tried anew with a smaller
size. What that means for the state of a scheme is said by its :class:`Stepper`.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from typing import Any, Protocol, TypeVar

import numpy as np

from fem_lie._arrays import Array
from fem_lie._state import attributes
from fem_lie.forms.abilities import PassedThroughError
from fem_lie.joints.histories import declared
from fem_lie.results import Result
from fem_lie.scene import Scene
from fem_lie.solve.motion.growing import Growing
from fem_lie.solve.motion.integration import Driver
from fem_lie.solve.motion.step_log import StepError, StepLog, largest_gaps
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.plan import ChosenSteps
from fem_lie.solve.step_control import SAME, Control
from fem_lie.system.equations import Equations

ORDER = 2
"""Of the schemes whose steps may change."""

SIDE = 1e-9
"""How far from an event its two sides are, in steps."""

Kept = TypeVar("Kept", bound=Growing, contravariant=True)


class Stepper(Protocol[Kept]):
    """State of one integration with steps that change; results go into a ``Kept``.

    Attributes:
        equations: Of the scene.
        h: Size of the present step.
        reason: Why the last step failed, where more is known than that it did not converge.
    """

    equations: Equations
    h: float
    reason: str

    @property
    def frames(self) -> Array:
        """Of all rows, (≥ n, 4, 3)."""

    @property
    def increment(self) -> float:
        """The last one of the iteration."""

    @property
    def factorisations(self) -> int:
        """How many there were."""

    @abstractmethod
    def begin(self, h: float) -> None:
        """Start at time 0 with steps of size ``h``."""

    @abstractmethod
    def set_step(self, time: float, h: float) -> None:
        """Make the state at ``time`` that of the start of a step of size ``h``."""

    @abstractmethod
    def step_to(self, start: float, end: float, index: int, lands: bool) -> int:
        """Make step ``index``; its iterations, 0 if it failed. ``lands``: it ends at an event."""

    @abstractmethod
    def estimate(self, before: Any, start: float, end: float) -> StepError:
        """The error of the step that was made from the state ``before``."""

    @abstractmethod
    def saved(self) -> Any:
        """The state."""

    @abstractmethod
    def take_back(self, state: Any) -> None:
        """Be as when it was saved."""

    @abstractmethod
    def follow(self, other: Any, state: Any) -> None:
        """Be as another stepper of the same scene was when it saved ``state``."""

    @abstractmethod
    def calm(self, time: float, h: float) -> None:
        """Forget fast waves: two steps in sequence were rejected, and ``h`` is the next size."""

    @abstractmethod
    def pass_event(self, time: float) -> None:
        """Make the state consistent with what is after an event just before ``time``."""

    @abstractmethod
    def record(self, recorder: Kept, index: int, iterations: int) -> None:
        """Keep the present state in the next row."""

    @abstractmethod
    def recorder(self, plan: ChosenSteps, progress: bool | None, store: Checkpoints | None) -> Any:
        """Where results go, a ``Kept``; see :class:`~fem_lie.solve.motion.integration.Driver`."""

    @abstractmethod
    def leave_books(self) -> None:
        """Do not count what acts from outside: nobody asks for it."""

    @abstractmethod
    def renew_matrix(self, time: float) -> None:
        """Forget all matrices; make that of the present state, at ``time``, and step."""

    @abstractmethod
    def memory(self) -> dict[str, Array]:
        """All that the next steps depend on but matrices."""

    @abstractmethod
    def restore(self, kept: Mapping[str, Array]) -> None:
        """Be as when :meth:`memory` was called, without matrices."""


def events(scene: Scene, duration: float) -> tuple[float, ...]:
    """When loads, drives or motions say that they jump in a run, from its beginning on."""
    moves: list[object] = [item.history for item in (*scene.joints, *scene.connections)]
    moves += [motion.motion for motion in scene.motions]
    times = declared((load.history for load in scene.loads), kinks=False)
    times += declared(moves, kinks=True)
    slack, began = SAME * duration, scene.began.time
    return tuple(t - began for t in sorted(set(times)) if slack < t - began < duration - slack)


def side(time: float, h: float) -> float:
    """How far to look past a time to see what is after it."""
    return float(max(SIDE * h, 8.0 * np.spacing(time)))


REJECTIONS = 2
"""Steps rejected one after the other after which a scheme forgets fast waves."""


class VariableSteps(Driver[Growing]):
    """The steps of one run.

    Attributes:
        steps: What is known of each step.
    """

    STATE = attributes("_index", "_time", "_rejections", "_control", "steps", "_stepper", "_finer")

    def __init__(
        self, stepper: Stepper[Any], control: Control, finer: Stepper[Any] | None, parts: int
    ) -> None:
        """Nothing is computed yet.

        Args:
            stepper: Makes the steps.
            control: Chooses their sizes.
            finer: Another stepper, which makes each step once more in many parts to measure errors.
            parts: In how many.
        """
        self._stepper, self._finer, self._control = stepper, finer, control
        self._parts, self._rejections = parts, 0
        self.equations, self.steps = stepper.equations, StepLog(stepper.equations)
        self._index, self._time, self._iterations = 0, 0.0, 0
        self._last: tuple[float, StepError | None, float] = control.size, None, np.inf

    def history(
        self, plan: ChosenSteps, progress: bool | None, store: Checkpoints | None
    ) -> Growing:
        """See the base class."""
        if not plan.saving.booked:
            for stepper in self._steppers():
                stepper.leave_books()
        return self._stepper.recorder(plan, progress, store)

    def start(self) -> None:
        """See the base class."""
        self._stepper.begin(self._control.size)

    @property
    def frames(self) -> Array:
        """See the base class."""
        return self._stepper.frames

    @property
    def index(self) -> int:
        """See the base class."""
        return self._index

    def _finished(self, history: Growing) -> bool:
        return self._control.finished

    def _advance(self, history: Growing) -> bool:
        control, made = self._control, False
        while not made:
            made = self._attempt()
            if control.size < control.smallest * (1.0 - 1e-9):
                return False
        return True

    def _failure(self, steps: int) -> str:
        text, why = self.steps.underflow(self._control, self._time, *self._last), self._stepper
        return f"{text}. {why.reason}" if why.reason else text

    def _record(self, history: Growing) -> bool:
        """See the base class; an event has two rows, of both its sides."""
        control, stepper, time = self._control, self._stepper, self._time
        lands = not control.finished and time == control.next_event
        kept = self._fill_row(history, self._iterations, event=lands or not self._index)
        if lands:
            control.pass_event()
        if lands and not control.finished:
            stepper.pass_event(time + side(time, stepper.h))
            kept |= self._fill_row(history, 0, event=True)
        return kept

    def _fill_row(self, history: Growing, iterations: int, *, event: bool) -> bool:
        time, control = self._time, self._control
        ahead = 0.0 if control.finished else control.fitted(time)
        wanted = history.due(time, ahead, self._index, iterations, event)
        if wanted:
            self._stepper.record(history, self._index, iterations)
            history.stamp(time)
        return wanted

    def _result(self, history: Growing) -> Result:
        known = self.steps.history()
        history.add(known)
        result = history.result(self._stepper.factorisations, history.seconds)
        return Result(**vars(result) | {"steps": known})

    def _save(self, history: Growing) -> None:
        """See the base class; a checkpoint has no factors, and the run goes on with new ones."""
        super()._save(history)
        self._renew()

    def restore(self, kept: Mapping[str, Array]) -> None:
        """See the base class."""
        super().restore(kept)
        self._renew()

    def _renew(self) -> None:
        for stepper in self._steppers():
            stepper.renew_matrix(self._time)

    def _steppers(self) -> list[Stepper[Any]]:
        return [each for each in (self._stepper, self._finer) if each is not None]

    def _attempt(self) -> bool:
        """Try one step; whether it was accepted."""
        control, stepper, time, index = self._control, self._stepper, self._time, self._index
        h, event = control.fitted(time), control.next_event
        lands = abs(time + h - event) <= 1e-6 * h
        end = event if lands else time + h
        stepper.set_step(time, h)
        before, start = stepper.saved(), stepper.frames.copy()
        iterations = stepper.step_to(time, end, index + 1, lands)
        error = stepper.estimate(before, time, end) if iterations else None
        e = np.inf if error is None else control.ratio(error.translation, error.rotation, h)
        if e <= 1.0 and not self._remembered(start):
            e = np.inf
        if error is None or e > 1.0:
            self._last = h, error, stepper.increment
            self.steps.rejected.append(end)
            stepper.take_back(before)
            control.reject(e)
            self._try_again(time, index)
            return False
        self._rejections = 0
        self.steps.add(end, h, error, self._measure(before, time, end, index, lands))
        control.accept(e)
        self._index, self._time, self._iterations = index + 1, end, iterations
        return True

    def _remembered(self, start: Array) -> bool:
        """Whether what frames do not tell of the step could be remembered."""
        stepper = self._stepper
        try:
            stepper.equations.memory.accept(stepper.frames, start)
        except PassedThroughError as error:
            stepper.reason = str(error)
            return False
        stepper.equations.memory.watch(start, stepper.frames, stepper.h)
        return True

    def _try_again(self, time: float, index: int) -> None:
        """After a rejected step."""
        self._rejections += 1
        h = self._control.size
        if h < self._control.smallest:
            return
        if index == 0:
            self._stepper.begin(h)
        elif self._rejections >= REJECTIONS:
            self._stepper.calm(time, h)

    def _measure(
        self, before: Any, time: float, end: float, index: int, lands: bool
    ) -> tuple[float, float]:
        """Errors of positions and rotations against the same step in many parts."""
        finer, parts = self._finer, self._parts
        if finer is None:
            return np.nan, np.nan
        finer.follow(self._stepper, before)
        h, start = (end - time) / parts, time
        finer.set_step(time, h)
        for k in range(1, parts + 1):
            last = k == parts
            stop = end if last else time + k * h
            if not finer.step_to(start, stop, index + 1, lands and last):
                return np.nan, np.nan
            start = stop
        return largest_gaps(self._stepper.frames, finer.frames)
