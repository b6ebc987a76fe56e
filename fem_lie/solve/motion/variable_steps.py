"""Variable steps with the local error of every step, for any scheme.

A step is tried and its error estimated; it is then accepted, or taken back and tried again with a
smaller size. The :class:`Stepper` of a scheme defines what this means for its state.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from math import isfinite
from typing import Any, Protocol, TypeVar, cast

import numpy as np

from fem_lie import lie
from fem_lie._arrays import Array, Indices
from fem_lie._state import attributes, put_back, saved
from fem_lie.forms.abilities import PassedThroughError
from fem_lie.joints.connection import LostBranchError
from fem_lie.joints.histories import declared
from fem_lie.linear.equilibrated import SingularMatrixError
from fem_lie.results import Result
from fem_lie.scene import Scene
from fem_lie.solve.motion.controllers import Controllers, Feedback, sample_times, sampled
from fem_lie.solve.motion.events import Events, Root, sensed
from fem_lie.solve.motion.growing import Growing
from fem_lie.solve.motion.integration import Driver
from fem_lie.solve.motion.limits import PlainStops
from fem_lie.solve.motion.step_log import StepError, StepLog, largest_gaps
from fem_lie.solve.recording.checkpoints import Checkpoints
from fem_lie.solve.recording.plan import ChosenSteps
from fem_lie.solve.recording.whole_state import MovingState
from fem_lie.solve.running_state import EventError, RunningState, WatchedScene
from fem_lie.solve.step_control import SAME, Control
from fem_lie.system.equations import Equations

ORDER = 2
"""Order of the schemes with variable steps."""

SIDE = 1e-9
"""Distance of the two sides of an event from it, in steps."""

HistoryT = TypeVar("HistoryT", bound=Growing, contravariant=True)


class MakeMany(Protocol):
    """Function that makes steps of the current size as long as nothing happens in them."""

    def __call__(
        self, stops: PlainStops, values: Array, first: int, start: float, count: int
    ) -> tuple[Array, int]:
        """Make steps.

        Args:
            stops: Stops of limits.
            values: Their watched numbers at the start, and then at the end, shape (2 l,).
            first: Number of steps so far.
            start: Time of the start.
            count: Largest number of steps.

        Returns:
            Error of each step, see :class:`~fem_lie.solve.motion.step_log.StepError`, shape (k, 4),
            and the number of all iterations.
        """


class Stepper(Protocol[HistoryT]):
    """State of one integration with variable steps; results go into a ``HistoryT``.

    Attributes:
        equations: Equations of the scene.
        h: Size of the current step.
        reason: Why the last step failed, if there is a more specific reason than no convergence.
    """

    equations: Equations
    h: float
    reason: str

    @property
    def frames(self) -> Array:
        """Current frames of all nodes, ground and prescribed motions, (≥ n, 4, 3)."""

    @property
    def twists(self) -> Array:
        """Current twists of the moving nodes, (n, 6)."""

    @property
    def multipliers(self) -> Array:
        """Current Lagrange multipliers, (m,)."""

    @property
    def increment(self) -> float:
        """Size of the last increment of the iteration."""

    @property
    def factorisations(self) -> int:
        """Number of factorisations so far."""

    @abstractmethod
    def begin(self, h: float) -> None:
        """Start at time 0 with steps of size ``h``."""

    @abstractmethod
    def set_step(self, time: float, h: float) -> None:
        """Set the state at ``time`` as the start of a step of size ``h``."""

    @abstractmethod
    def step_to(self, start: float, end: float, index: int, lands: bool) -> int:
        """Make step ``index``.

        Return its iterations, 0 if it failed. ``lands``: it ends at an event.
        """

    @property
    def make_many(self) -> MakeMany | None:
        """Makes several steps without Python, if possible."""

    @property
    def cell_pairs(self) -> Indices:
        """See :attr:`.Driver.cell_pairs`."""

    def divided_state(self) -> dict[str, Array]:
        """See :meth:`.Driver.divided_state`."""

    def restart(self, state: MovingState, common: Mapping[str, Array]) -> None:
        """See :meth:`.Driver.restart`; matrices are made by :meth:`refactorise_at`."""

    @abstractmethod
    def estimate(self, before: Any, start: float, end: float) -> StepError:
        """Error of the step that was made from the state ``before``."""

    @abstractmethod
    def saved(self) -> Any:
        """A copy of the state."""

    @abstractmethod
    def take_back(self, state: Any) -> None:
        """Restore a saved state."""

    @abstractmethod
    def restore_from(self, other: Any, state: Any) -> None:
        """Take the state that another stepper of the same scene has saved."""

    @abstractmethod
    def damp_oscillations(self, time: float, h: float) -> None:
        """Remove unresolved fast oscillations, after two rejections; ``h`` is the next size."""

    @abstractmethod
    def pass_event(self, time: float, restitution: Array | None = None) -> None:
        """Make the state just before an event consistent with loads and motions after it.

        ``restitution``: coefficient by which each constraint reverses its rate, shape (m,).
        """

    @abstractmethod
    def record(self, recorder: HistoryT, index: int, iterations: int) -> None:
        """Record the current state in the next row."""

    @abstractmethod
    def recorder(self, plan: ChosenSteps, progress: bool | None, store: Checkpoints | None) -> Any:
        """Create the history of results, see :class:`.Driver`."""

    @abstractmethod
    def leave_balance(self) -> None:
        """Skip the energy balance: it is not recorded."""

    @abstractmethod
    def refactorise_at(self, time: float) -> None:
        """Drop all matrices; factorise that of the current state, ``time`` and step size."""

    @abstractmethod
    def saved_state(self) -> dict[str, Array]:
        """State on which the next steps depend, except matrices."""

    @abstractmethod
    def restore(self, kept: Mapping[str, Array]) -> None:
        """Restore the state that :meth:`saved_state` returned, without matrices."""


def events(scene: Scene, duration: float) -> tuple[float, ...]:
    """Times at which loads, drives or motions declare discontinuities, and samples."""
    moves: list[object] = [item.history for item in (*scene.joints, *scene.connections)]
    moves += [motion.motion for motion in scene.motions]
    times = declared((load.history for load in scene.loads), kinks=False)
    times += declared(moves, kinks=True)
    slack, began = SAME * duration, scene.began.time
    found = [*(t - began for t in times), *sample_times(sampled(scene), duration)]
    return tuple(t for t in sorted(set(found)) if slack < t < duration - slack)


def side(time: float, h: float) -> float:
    """Distance from a time at which the value after it is evaluated."""
    return float(max(SIDE * h, 8.0 * np.spacing(time)))


_COMMON = (
    *("_events", "_controllers", "_feedback"),
    *("_index", "_time", "_rejections", "_control", "steps"),
)
"""State that all ranks of a divided scene have in common."""

REJECTIONS = 2
"""Number of successive rejections after which unresolved fast oscillations are removed."""


class VariableSteps(Driver[Growing]):
    """Run with variable steps.

    Attributes:
        steps: Log of all steps.
    """

    STATE = attributes(*_COMMON, "_stepper", "_finer")

    def __init__(
        self, stepper: Stepper[Any], control: Control, finer: Stepper[Any] | None, parts: int
    ) -> None:
        """Set up the run without computing anything.

        Args:
            stepper: Makes the steps.
            control: Chooses their sizes.
            finer: A second stepper, which repeats each step in sub-steps to measure its error.
            parts: Number of these sub-steps.
        """
        self._stepper, self._finer, self._control = stepper, finer, control
        self._parts, self._rejections = parts, 0
        self.equations, self.steps = stepper.equations, StepLog(stepper.equations)
        self._index, self._time, self._iterations = 0, 0.0, 0
        self._last: tuple[float, StepError | None, float] = control.size, None, np.inf
        self._scene = WatchedScene(self.equations)
        self._events = Events(self._scene)
        self._fired: Array = np.zeros(len(self._events))
        self._controllers = Controllers(self._scene)
        self._feedback = Feedback(self._scene)
        if self._feedback and finer is not None:
            raise ValueError(
                "refinement: errors of steps with continuous controllers are not measured; run "
                "with refinement=1 and half the step"
            )
        if self._feedback:
            # generalised-α alone takes controllers
            cast(Any, stepper).feedback = self._feedback.look
        driven = self.equations.unknowns.driven or bool(self.equations.scene.motions)
        self._driven = self.equations.shared.any(driven)
        self._stops = self._events.stops_in_loop
        # what Python evaluates after each step
        scene = self._scene.scene
        python = bool(scene.events or scene.sensors or self._feedback)
        self._looks = python or finer is not None

    def history(
        self, plan: ChosenSteps, progress: bool | None, store: Checkpoints | None
    ) -> Growing:
        """Create the history of the stepper."""
        if not plan.saving.with_balance:
            for stepper in self._steppers():
                stepper.leave_balance()
        return self._stepper.recorder(plan, progress, store)

    def start(self) -> None:
        """Make the state consistent at time 0."""
        equations = self.equations
        if self._scene.scene.controllers:
            frames, velocities, _ = equations.start
            none = np.zeros(equations.unknowns.m)
            start = RunningState(self._scene, 0.0, frames, velocities, none, self._control.size)
            self._controllers.sample(start)
            self._feedback.begin(start)
        self._stepper.begin(self._control.size)
        if self._events:
            self._events.begin(self._state(0.0))
        self._sense()

    def _state(self, time: float) -> RunningState:
        """The current state, for events."""
        stepper, size = self._stepper, self._control.size
        moving = self.frames, stepper.twists, stepper.multipliers
        return RunningState(self._scene, time, *moving, size)

    @property
    def frames(self) -> Array:
        """Current frames of all nodes, ground and prescribed motions."""
        return self._stepper.frames

    @property
    def index(self) -> int:
        """Number of steps made, including the current one."""
        return self._index

    def _finished(self, history: Growing) -> bool:
        return self._control.finished or bool(self._events.stopped)

    def _advance(self, history: Growing) -> bool:
        if self._advance_in_loop(history):
            return True
        control, made = self._control, False
        while not made:
            made = self._attempt(history)
            if control.size < control.smallest * (1.0 - 1e-9):
                return False
        return True

    def _advance_in_loop(self, history: Growing) -> bool:
        """Make several steps in the compiled loop of the stepper; return whether any was made.

        They are whole steps of one size, without anything that Python does after each of them.
        """
        control, stepper, stops = self._control, self._stepper, self._stops
        if stops is None or self._looks or not control.constant or stepper.make_many is None:
            return False
        time, index = self._time, self._index
        ends = control.next_ends(time, history.steps_until_due(index))
        if not len(ends):
            return False
        stepper.set_step(time, control.fitted(time))
        given = stops, self._events.values, index, time, len(ends)
        errors, iterations = stepper.make_many(*given)
        made = len(errors)
        if not made:
            return False
        self._rejections, self._iterations = 0, iterations
        self._events.pass_step(whole=True)
        sizes = np.diff(ends[:made], prepend=time)
        self.steps.add_many(ends[:made], sizes, errors)
        control.accept_many(made)
        self._index, self._time = index + made, float(ends[made - 1])
        return True

    def _failure(self, steps: int) -> str:
        text, why = self.steps.underflow(self._control, self._time, *self._last), self._stepper
        return f"{text}. {why.reason}" if why.reason else text

    def _record(self, history: Growing) -> bool:
        """Record the current state; an event gets two rows, one for each side."""
        control, stepper, time = self._control, self._stepper, self._time
        lands = not control.finished and time == control.next_event
        happens = bool(self._fired.any())
        kept = self._fill_row(history, self._iterations, event=lands or happens or not self._index)
        if lands:
            control.pass_event()
        if lands and not control.finished and self._scene.scene.controllers:
            self._controllers.sample(self._state(time))
        if (lands or happens) and not control.finished:
            if happens:
                self._happen(rebound=True)
            else:
                stepper.pass_event(time + side(time, stepper.h))
            kept |= self._fill_row(history, 0, event=True)
        return kept

    def _happen(self, *, rebound: bool) -> None:
        """Take the actions of events at the end of the last step; let limits strike their stops.

        Args:
            rebound: Whether there is restitution.
        """
        time, before = self._time, self._state(self._time)
        kinetic, fired = before.kinetic, self._fired.copy()
        self._events.act(fired, before, self.frames)
        passed = self._events.passed(fired, self._state(time))
        self._fired[:] = 0.0

        def change(restitution: Array) -> Array:
            self._stepper.pass_event(time + side(time, self._stepper.h), restitution)
            return self._stepper.multipliers

        try:
            self._events.strike(fired, self.frames, change, rebound=rebound)
            self._refactorise()
        except (ValueError, SingularMatrixError) as error:
            raise EventError(
                f"after the events at time {time:.9g} velocities cannot be computed: {error}. "
                "Constraints that were locked may follow from others"
            ) from error
        after = self._state(time)
        if self._feedback.begin(after):
            self._stepper.pass_event(time + side(time, self._stepper.h))
            after = self._state(time)
        lost = kinetic - after.kinetic
        numbers = [self._events.number(int(k)) for k in np.flatnonzero(fired)]
        self.steps.events += [(time, k, lost / len(numbers)) for k in numbers]
        self._events.begin(after, passed)

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
        """Write a checkpoint, without factors, and refactorise."""
        super()._save(history)
        self._refactorise()

    def restore(self, kept: Mapping[str, Array]) -> None:
        """Restore a state, and refactorise."""
        super().restore(kept)
        self._refactorise()

    @property
    def cell_pairs(self) -> Indices:
        """See the base class."""
        return self._stepper.cell_pairs

    def divided_state(self) -> dict[str, Array]:
        """See the base class."""
        return saved(self, _COMMON) | self._stepper.divided_state()

    def restart(self, state: MovingState, common: Mapping[str, Array]) -> None:
        """Restart from the state of a scene that was divided, with new matrices."""
        put_back(self, _COMMON, common)
        self._stepper.restart(state, common)
        if self._finer is not None:
            self._finer.restore_from(self._stepper, self._stepper.saved())
        self._refactorise()

    def _refactorise(self) -> None:
        for stepper in self._steppers():
            stepper.refactorise_at(self._time)

    def _steppers(self) -> list[Stepper[Any]]:
        return [each for each in (self._stepper, self._finer) if each is not None]

    def _attempt(self, history: Growing) -> bool:
        """Try one step; return whether it was accepted."""
        control, stepper, time, index = self._control, self._stepper, self._time, self._index
        h, event = control.fitted(time), control.next_event
        lands = abs(time + h - event) <= 1e-6 * h
        end = event if lands else time + h
        stepper.set_step(time, h)
        before, start, moving = stepper.saved(), stepper.frames.copy(), stepper.twists.copy()
        iterations = self._step_to(before, end, lands)
        if iterations and self._events:
            signs = self._events.crossed(values := self._events.evaluate(self._state(end)))
            entered = self._events.entered(values)
            if entered.any():
                self._happen_at_start(entered.astype(np.float64), before, history, rebound=False)
                return False
            if signs.any():
                root = Root(signs, self._events.values, values, h)
                before, cut, iterations, values = self._cut(before, root)
                if root.at_start:
                    signs = self._events.crossed(values)
                    self._happen_at_start(signs, before, history, rebound=True)
                    return False
                if cut < h:
                    lands, end, h = False, time + cut, cut
                signs = self._events.crossed(values)
        error = stepper.estimate(before, time, end) if iterations else None
        e = np.inf if error is None else control.ratio(error.translation, error.rotation, h)
        if e <= 1.0 and not self._accept_history(start):
            e = np.inf
        if error is None or e > 1.0:
            self._last = h, error, stepper.increment
            self.steps.rejected.append(end)
            self._take_back(before)
            control.reject(e)
            self._try_again(time, index)
            return False
        self._rejections = 0
        if self._feedback:
            self._feedback.accept()
        if self._events:
            self._fired = signs + self._events.overdue(values)
            self._events.values[:] = values
            self._events.pass_step(not signs.any() or h > 0.1 * control.size)
        self.steps.add(end, h, error, self._measure(before, time, end, index, lands))
        rates = self._constraint_rates(start, moving, time, end, lands)
        control.accept(max(e, control.believed(rates)))
        self._index, self._time, self._iterations = index + 1, end, iterations
        self._sense()
        return True

    def _constraint_rates(self, H: Array, v: Array, time: float, end: float, lands: bool) -> float:
        """Rates of driven constraints over the tolerance, in the mean of both ends of a step.

        Positions satisfy the constraints, so their estimated error sees nothing of velocities that
        do not, and where drives prescribe all motions it is zero. Rates choose the next size but
        reject no step: smaller steps do not reduce those that a kink of a drive leaves. They
        alternate from step to step, and are therefore not in the mean. Others that smaller steps do
        not reduce are ignored, see :meth:`.Control.believed`.

        Args:
            H: Frames at the start.
            v: Twists of the moving nodes there, shape (n, 6).
            time: The start.
            end: The end.
            lands: Whether an event is there.
        """
        control, unknowns, n = self._control, self.equations.unknowns, len(v)
        if not self._driven or not isfinite(control.tolerance):
            return 0.0
        stepper, h = self._stepper, end - time
        twists = self.equations.start.velocities.copy()
        if len(H) > n + 1:
            twists[n + 1 :] = lie.se3_relative(H[n + 1 :], stepper.frames[n + 1 :]) / h
        seen = end - side(end, h) if lands else end
        start, finish = self.equations.prescribed(time), self.equations.prescribed(seen)
        rates = (start.targets - finish.targets) / h
        for frames, moving in ((H, v), (stepper.frames, stepper.twists)):
            twists[:n] = moving
            rates += 0.5 * self.equations.constraints(frames).rates(twists)[0]
        # what rolls has velocity constraints, which hold
        rates[len(rates) - unknowns.of_velocities :] = 0.0
        allowed = np.where(unknowns.angular, control.rotation_tolerance, control.tolerance)
        return float(self.equations.shared.largest(float(np.abs(rates / allowed).max(initial=0.0))))

    def _step_to(self, before: Any, end: float, lands: bool) -> int:
        """Make a step from the state ``before``, with what continuous controllers do in it.

        Return its iterations, 0 if it failed.
        """
        stepper, start, index = self._stepper, self._time, self._index + 1
        if not self._feedback:
            return stepper.step_to(start, end, index, lands)

        def move() -> int:
            stepper.take_back(before)
            return stepper.step_to(start, end, index, lands)

        made = self._feedback.solve(end - start, move, lambda: self._state(end))
        if self._feedback.reason:
            stepper.reason = self._feedback.reason
        return made

    def _take_back(self, before: Any) -> None:
        """Restore a state with the outputs of controllers there."""
        self._stepper.take_back(before)
        self._feedback.take_back()

    def _sense(self) -> None:
        """Sample the sensors."""
        sensors = self._scene.scene.sensors
        if sensors:
            state = self._state(self._time)
            values = self._scene.alike(lambda: [sensed(each, state) for each in sensors])
            self.steps.sensed.append((self._time, *values))

    def _happen_at_start(
        self, signs: Array, before: Any, history: Growing, *, rebound: bool
    ) -> None:
        """Take the actions of events at the start of the tried step, which is taken back.

        Args:
            signs: Signs of the events, see :meth:`.Events.crossed`.
            before: State at the start of the step.
            history: The history of results, which gets a row for each side of the events.
            rebound: Whether there is restitution.
        """
        self._take_back(before)
        self._events.pass_step(whole=False)
        self._fired[:] = signs
        if not history.row or history.times[history.row - 1] != self._time:
            self._fill_row(history, 0, event=True)
        self._happen(rebound=rebound)
        self._fill_row(history, 0, event=True)

    def _cut(self, before: Any, root: Root) -> tuple[Any, float, int, Array]:
        """Repeat a step with the size at which the first event happens.

        Args:
            before: State at the start of the step.
            root: Search for the event.

        Returns:
            The state at the start for a step of this size, the size, the iterations of all steps
            that were tried, and the values of the conditions; no iterations if one failed.
        """
        stepper, time, total = self._stepper, self._time, 0
        while not (root.found or root.at_start):
            h = root.size
            stepper.take_back(before)
            stepper.set_step(time, h)
            before = stepper.saved()
            iterations = self._step_to(before, time + h, lands=False)
            total = total + iterations if iterations else 0
            if not iterations:
                break
            values = self._events.evaluate(self._state(time + h))
            root.take(h, values)
        return before, h, total, values

    def _accept_history(self, start: Array) -> bool:
        """Whether the equations accept the end: surfaces and joints admit it."""
        stepper = self._stepper
        try:
            stepper.equations.history_variables.check_passage(start, stepper.frames)
            stepper.equations.history_variables.accept(stepper.frames, start)
        except (PassedThroughError, LostBranchError) as error:
            stepper.reason = str(error)
            return False
        stepper.equations.history_variables.watch(start, stepper.frames, stepper.h)
        return True

    def _try_again(self, time: float, index: int) -> None:
        """Choose a smaller size after a rejected step."""
        self._rejections += 1
        h = self._control.size
        if h < self._control.smallest:
            return
        if index == 0:
            self._stepper.begin(h)
        elif self._rejections >= REJECTIONS:
            self._stepper.damp_oscillations(time, h)

    def _measure(
        self, before: Any, time: float, end: float, index: int, lands: bool
    ) -> tuple[float, float]:
        """Errors of positions and rotations against the same step in sub-steps."""
        finer, parts = self._finer, self._parts
        if finer is None:
            return np.nan, np.nan
        finer.restore_from(self._stepper, before)
        h, start = (end - time) / parts, time
        finer.set_step(time, h)
        for k in range(1, parts + 1):
            last = k == parts
            stop = end if last else time + k * h
            if not finer.step_to(start, stop, index + 1, lands and last):
                return np.nan, np.nan
            start = stop
        gap, turned = largest_gaps(self._stepper.frames, finer.frames)
        shared = self.equations.shared
        return shared.largest(gap), shared.largest(turned)
