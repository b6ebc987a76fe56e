"""Controllers in a run: samples and memories; states that are solved with the motion.

A continuous controller has the state ``x`` with ``ẋ = f`` and the outputs ``u = g``. With the
motion at the end of a step for given outputs, both are known there::

    3/2 (x₁ − x₀)/h − ½ a₀ = f(t₁, x₁),    a₁ = (x₁ − x₀)/h,    u₁ = g(t₁, x₁)

so that a step of the scene is a function ``G(u₁)`` whose fixed point is sought by Anderson's
iteration: for few outputs it converges like a secant method, whatever the gains. ``a`` is the rate
half a step before the end, ``ẋ − h/2 ẍ``; with another step size it becomes ``f + r (a − f)``.
(Brüls & Arnold, J. Comput. Nonlinear Dyn. 3 (2008) 041007.)
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import Array, numbers
from fem_lie._state import Stateful, attributes
from fem_lie.events.controller import ContinuousController, Controller
from fem_lie.scene import Scene
from fem_lie.solve.running_state import EventError, RunningState, WatchedScene

_SAME = 1e-6
"""Difference of times, over the period, below which a sample is due."""


_CLOSED = 1e-10
"""Difference of outputs from those of the motion, over the largest so far, of a solved step."""

_STAGNANT = 1e-5
"""Difference that is accepted where iterations do not reduce it any more: round-off of rates."""

_MOST = 20
"""Number of motions that are tried in a step."""

_DIFFERENCE = 1e-7
"""Change of a state, over its size, for derivatives of its rate."""


def sampled(scene: Scene) -> list[Controller]:
    """Controllers of a scene with samples."""
    return [each for each in scene.controllers if isinstance(each, Controller)]


def sample_times(controllers: Sequence[Controller], duration: float) -> list[float]:
    """Times after the start and before the end at which any controller has a sample."""
    times: list[float] = []
    for each in controllers:
        count = int(np.ceil(duration / each.period * (1.0 - 1e-12)))
        times += [k * each.period for k in range(1, count)]
    return times


class Controllers(Stateful):
    """All sampled controllers of one run.

    Attributes:
        samples: Number of samples that each has taken, shape (c,).
        memories: Memory of each.
    """

    STATE = attributes("samples", "memories")

    def __init__(self, scene: WatchedScene) -> None:
        """Start before the first sample.

        Args:
            scene: The scene.
        """
        self._scene, self._items = scene, tuple(sampled(scene.scene))
        self.samples = np.zeros(len(self._items), dtype=np.int64)
        self.memories = [each.start for each in self._items]

    def sample(self, state: RunningState) -> None:
        """Take the samples that are due, and set the factors of actuators.

        Args:
            state: The state.

        Raises:
            EventError: An update failed, or returned something else than expected.
        """
        for k, each in enumerate(self._items):
            if state.time < (self.samples[k] - _SAME) * each.period:
                continue
            self.samples[k] += 1
            update = partial(self._updated, each, state, self.memories[k])
            factors, memory = self._scene.alike(update)
            self.memories[k][:] = memory
            for item, factor in zip(each.actuators, factors, strict=True):
                self._scene.equations.history_variables.scale(item, float(factor))

    def _updated(self, each: Controller, state: RunningState, memory: Array) -> tuple[Array, Array]:
        try:
            return self._numbers(each, state, memory)
        except Exception as error:
            raise EventError(
                f"the update of {each.label} failed at time {state.time:.9g}: "
                f"{type(error).__name__}: {error}"
            ) from error

    @staticmethod
    def _numbers(each: Controller, state: RunningState, memory: Array) -> tuple[Array, Array]:
        given = each.update(state, memory.copy())
        if not isinstance(given, tuple) or len(given) != 2:
            raise TypeError(f"expected factors of the actuators and the memory, got {given!r}")
        found = [np.atleast_1d(numbers(part, "value")).ravel() for part in given]
        expected = len(each.actuators), len(memory)
        for values, count, what in zip(found, expected, ("factors", "memory"), strict=True):
            if len(values) != count or not np.isfinite(values).all():
                raise ValueError(f"expected {count} finite numbers as {what}, got {values}")
        return found[0], found[1]


class Feedback(Stateful):
    """All continuous controllers of one run.

    Attributes:
        states: State ``x`` of each.
        rates: Its rate ``f``.
        means: Mean rate ``a`` of the last step.
        outputs: Factors of all actuators, shape (u,).
        trend: Rate at which they changed in the last step, shape (u,).
        largest: Largest magnitude of each so far, shape (u,).
        size: Size of the last step; 0 before the first one.
        time: Time of the start of the step.
        reason: Why the last step could not be solved, if it was the controllers.
    """

    STATE = attributes("states", "rates", "means", "outputs", "trend", "largest", "size", "time")

    def __init__(self, scene: WatchedScene) -> None:
        """Start before the first state.

        Args:
            scene: The scene.
        """
        every = scene.scene.controllers
        self._items = [each for each in every if isinstance(each, ContinuousController)]
        self._scene = scene
        self._actuators = [item for each in self._items for item in each.actuators]
        self._actuators_of = [each.label for each in self._items for _ in each.actuators]
        self.states = [each.start for each in self._items]
        self.rates, self.means = ([np.zeros_like(x) for x in self.states] for _ in range(2))
        self.outputs, self.trend, self.largest = np.zeros((3, len(self._actuators)))
        self.size, self.time, self.reason = 0.0, 0.0, ""
        self._next = self.states
        self._ended: tuple[RunningState, Array, float] | None = None

    def __bool__(self) -> bool:
        """Whether there are any."""
        return bool(self._items)

    def begin(self, state: RunningState) -> bool:
        """Take a state as the start of the next step; return whether outputs have changed.

        Args:
            state: The state, at the start of the run or after events.
        """
        pairs = zip(self._items, self.states, strict=True)
        found = [self._rate(each, state, x) for each, x in pairs]
        for mean, rate, new in zip(self.means, self.rates, found, strict=True):
            mean += new - rate
        outputs = self._outputs(state, self.states)
        changed = bool((outputs != self.outputs).any())
        self.time = state.time
        self.rates, self.outputs, self.trend = found, outputs, np.zeros_like(outputs)
        self.largest = np.maximum(self.largest, np.abs(outputs))
        self.take_back()
        return changed

    def look(self, time: float, H: Array, v: Array) -> None:
        """Set the factors to the outputs at a state near the start of the step.

        Args:
            time: The time.
            H: Frames of all nodes, ground and prescribed motions.
            v: Twists of all nodes.
        """
        none, ahead = np.zeros(self._scene.equations.unknowns.m), time - self.time
        state = RunningState(self._scene, time, H, v, none, abs(ahead) or np.inf)
        pairs = zip(self.states, self.rates, strict=True)
        self._set(self._outputs(state, [x + ahead * rate for x, rate in pairs]))

    def take_back(self) -> None:
        """Set the factors of actuators to those at the start of the step."""
        self._set(self.outputs)

    def solve(self, h: float, move: Callable[[], int], end: Callable[[], RunningState]) -> int:
        """Solve a step together with the outputs at its end.

        Args:
            h: Size of the step.
            move: Makes the step from its start; returns its iterations, 0 if it failed.
            end: The state at its end.

        Returns:
            All iterations; 0 if one step failed, or outputs did not converge.
        """
        outputs, total, before, self.reason = self.outputs + h * self.trend, 0, np.inf, ""
        tried: list[Array] = []
        gaps: list[Array] = []
        for _ in range(_MOST):
            self._set(outputs)
            iterations = move()
            if not iterations:
                return 0
            total += iterations
            state = end()
            self._next = [self._advanced(k, state, h) for k in range(len(self._items))]
            if self.reason:
                return 0
            found = self._outputs(state, self._next)
            tried.append(outputs)
            gaps.append(found - outputs)
            scale = np.maximum(self.largest, np.abs(found))
            gap = float((np.abs(gaps[-1]) / np.where(scale > 0.0, scale, 1.0)).max())
            if gap <= _CLOSED or (gap <= _STAGNANT and gap > 0.5 * before):
                self._ended = state, outputs, h
                return total
            before, outputs = gap, _accelerated(tried, gaps)
        worst = self._actuators_of[int(np.abs(gaps[-1]).argmax())]
        self.reason = f"the outputs of {worst} did not converge"
        return 0

    def accept(self) -> None:
        """Accept the step that was solved last."""
        assert self._ended is not None
        state, outputs, h = self._ended
        self.time = state.time
        per_step = 1.0 / h
        for k, (each, x) in enumerate(zip(self._items, self._next, strict=True)):
            self.means[k] = per_step * (x - self.states[k])
            self.rates[k] = self._rate(each, state, x)
        self.states, self.trend, self.size = self._next, per_step * (outputs - self.outputs), h
        self.outputs, self.largest = outputs, np.maximum(self.largest, np.abs(outputs))

    def _set(self, outputs: Array) -> None:
        for item, factor in zip(self._actuators, outputs, strict=True):
            self._scene.equations.history_variables.scale(item, float(factor))

    def _advanced(self, k: int, state: RunningState, h: float) -> Array:
        """State of a controller at the end of a step, by Newton's method."""
        each, x = self._items[k], self.states[k]
        ratio = h / self.size if self.size else 1.0
        mean = self.rates[k] + ratio * (self.means[k] - self.rates[k])
        found = x + h * self.rates[k]
        for _ in range(_MOST):
            rate = self._rate(each, state, found)
            residual = 1.5 * (found - x) / h - 0.5 * mean - rate
            columns = np.diag(_DIFFERENCE * np.maximum(np.abs(found), h * np.abs(rate) + 1e-12))
            changes = [self._rate(each, state, found + step) - rate for step in columns]
            slopes = np.reshape(changes, columns.shape).T / np.diag(columns)
            correction = np.linalg.solve(1.5 / h * np.eye(len(x)) - slopes, residual)
            found = np.asarray(found - correction)
            size = np.maximum(np.abs(found), np.abs(found - x))
            if (np.abs(correction) <= 1e-12 * size).all():
                return found
        self.reason = f"the state of {each.label} did not converge"
        return found

    def _rate(self, each: ContinuousController, state: RunningState, x: Array) -> Array:
        given = each, "rate", each.rate, state, x, len(x)
        return self._scene.alike(partial(_evaluated, *given))

    def _outputs(self, state: RunningState, states: Sequence[Array]) -> Array:
        found: list[Array] = [np.empty(0)]
        for each, x in zip(self._items, states, strict=True):
            given = each, "output", each.output, state, x, len(each.actuators)
            found.append(self._scene.alike(partial(_evaluated, *given)))
        return np.concatenate(found)


def _evaluated(
    each: ContinuousController,
    what: str,
    function: Callable[[Any, Array], npt.ArrayLike],
    state: RunningState,
    x: Array,
    count: int,
) -> Array:
    """Values of a function of a user, shape (count,).

    Raises:
        EventError: It failed, or returned something else than so many finite numbers.
    """
    try:
        values = np.atleast_1d(numbers(function(state, x.copy()), "value")).ravel()
        if len(values) != count or not np.isfinite(values).all():
            raise ValueError(f"expected {count} finite numbers, got {values}")
    except Exception as error:
        raise EventError(
            f"the {what} of {each.label} failed at time {state.time:.9g}: "
            f"{type(error).__name__}: {error}"
        ) from error
    return values


def _accelerated(tried: Sequence[Array], gaps: Sequence[Array]) -> Array:
    """Next outputs of Anderson's iteration from those tried so far and their gaps ``G(u) − u``."""
    u, gap = tried[-1], gaps[-1]
    if len(tried) == 1:
        return u + gap
    most = len(u) + 1
    steps, changes = (np.diff(np.array(each[-most:]), axis=0).T for each in (tried, gaps))
    weights = np.linalg.lstsq(changes, gap, rcond=None)[0]
    return np.asarray(u + gap - (steps + changes) @ weights)
