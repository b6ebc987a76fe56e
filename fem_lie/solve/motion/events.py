"""Events in a run: conditions on steps that were made, roots within them, and actions."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from fem_lie._arrays import Array, Flags, number
from fem_lie._state import Stateful, attributes
from fem_lie.events.actions import Action
from fem_lie.events.event import Event
from fem_lie.events.sensor import Sensor
from fem_lie.joints.connection import Connection
from fem_lie.solve.motion.limits import Limits, PlainStops
from fem_lie.solve.running_state import EventError, RunningState, WatchedScene

_SHORTEST = 1e-6
"""Size of a cut step, over that of the whole step, below which the event is at its start: a
velocity has the round-off of positions over the size of the step."""

MOST_AT_ONCE = 20
"""Number of successive steps that may end at one event without a whole step in between."""


class Events(Stateful):
    """Events of one run: those of the scene, then the stops of its limits.

    Attributes:
        values: Value of each condition, and watched number of each stop, at the start of the step,
            shape (e + 2 l,).
        counts: How often each event of the scene has happened, shape (e,).
        limits: Limits of coordinates.
        stopped: Whether an event has ended the run (1).
        at_once: Number of successive steps that ended at an event.
    """

    STATE = attributes("values", "counts", "limits", "stopped", "at_once")

    def __init__(self, scene: WatchedScene) -> None:
        """Start before the first step.

        Args:
            scene: The scene.
        """
        self._scene, self._equations = scene, scene.equations
        self._events = tuple(scene.scene.events)
        self.limits = Limits(scene)
        self.values = np.zeros(len(self))
        self.counts = np.zeros(len(self._events), dtype=np.int64)
        self.stopped, self.at_once = 0, 0
        self._H: Array = np.empty(0)

    def __len__(self) -> int:
        """Number of conditions of the scene and of stops."""
        return len(self._events) + len(self.limits)

    @property
    def stops_in_loop(self) -> PlainStops | None:
        """Stops of limits for compiled loops; ``None`` if these cannot evaluate a coordinate."""
        equations = self._equations
        return None if equations.part else self.limits.among(equations.arrays.probed)

    def evaluate(self, state: RunningState) -> Array:
        """Values of all conditions, and watched numbers of all stops, shape (e + 2 l,).

        Raises:
            EventError: A condition failed or did not return a number.
        """
        found = np.empty(len(self))
        if len(self.limits):
            found[len(self._events) :] = self.limits.values(state)
        if self._events:
            found[: len(self._events)] = self._scene.alike(lambda: self._conditions(state))
        return found

    def _conditions(self, state: RunningState) -> Array:
        """Values of all conditions of the scene, shape (e,)."""
        found = np.empty(len(self._events))
        for k, event in enumerate(self._events):
            try:
                found[k] = number(event.condition(state), "value of the condition")
            except Exception as error:
                raise EventError(_failed("condition", event, state.time, error)) from error
        return found

    def begin(self, state: RunningState, passed: Array | None = None) -> None:
        """Take a state as the start of the next step.

        Args:
            state: The state.
            passed: See :meth:`passed`: these conditions must not change their sign once more
                because velocities were made consistent; default: none.
        """
        self.values[:] = self.evaluate(state)
        if passed is not None:
            own = self.values[: len(passed)]
            own[passed * own < 0.0] = 0.0

    def passed(self, fired: Array, state: RunningState) -> Array:
        """Signs by which events of the scene happened whose conditions no action changed, (e,).

        Args:
            fired: As for :meth:`act`.
            state: The state in which they happened, after the actions.
        """
        signs = fired[: len(self._events)]
        unchanged = self.evaluate(state)[: len(signs)] == self.values[: len(signs)]
        return np.where(unchanged, signs, 0.0)

    def crossed(self, values: Array) -> Array:
        """Signs by which conditions changed theirs from negative to positive, shape (e + 2 l,).

        Zero: a condition did not change its sign, or its event does not happen any more.

        Args:
            values: Values at the end of the step.
        """
        if ((self.values < 0.0) == (values < 0.0)).all() and (values != 0.0).all():
            return np.zeros(len(values))
        rises = (self.values < 0.0) & (values >= 0.0)
        falls = (self.values > 0.0) & (values <= 0.0)
        signs = rises.astype(np.float64) - falls
        signs[len(self._events) :] = rises[len(self._events) :]
        for k, event in enumerate(self._events):
            over = self.counts[k] > 0 and not event.repeated
            if over or signs[k] * event.direction < 0.0:
                signs[k] = 0.0
            if signs[k] and not event.changes(self):
                signs[k] = 0.0
        return signs

    def entered(self, values: Array) -> Flags:
        """Stops at which a step starts that leaves them behind, as a mask of all, (e + 2 l,).

        Args:
            values: Values at the end of the step.
        """
        found: Flags = np.zeros(len(self), dtype=bool)
        own = slice(len(self._events), None)
        if not values[own].max(initial=-1.0) > 0.0:
            return found
        found[own] = self.limits.entered(self.values[own], values[own])
        return found

    def overdue(self, values: Array) -> Array:
        """Signs, as of :meth:`crossed`, of stops that pull at both ends of a step, (e + 2 l,).

        Args:
            values: Values at the end of the step.
        """
        own, found = slice(len(self._events), None), np.zeros(len(self))
        found[own] = self.limits.overdue(self.values[own], values[own])
        return found

    def pass_step(self, whole: bool) -> None:
        """Count steps that ended at an event.

        Args:
            whole: Whether the step did not, or was not much shorter than others.
        """
        self.at_once = 0 if whole else self.at_once + 1

    def act(self, fired: Array, state: RunningState, H: Array) -> None:
        """Take all actions of events of the scene.

        Args:
            fired: Signs of :meth:`crossed` of the step that ends here.
            state: The state.
            H: Its frames of all nodes, ground and prescribed motions.

        Raises:
            EventError: An action failed, or an event happens without end.
        """
        self._H = H
        if self.at_once > MOST_AT_ONCE:
            raise EventError(
                f"{self._label(int(np.flatnonzero(fired)[0]))} happens without end at time "
                f"{state.time:.9g}: {MOST_AT_ONCE} steps in succession ended at events. Give it a "
                "direction, repeated=False, or Lock what comes to rest"
            )
        for k in np.flatnonzero(fired[: len(self._events)]):
            event = self._events[k]
            self.counts[k] += 1
            for action in event.actions:
                if isinstance(action, Action):
                    self._act(event, state, partial(action.act, self))
                else:
                    own = partial(self._act, event, state, partial(action, state))
                    self._scene.alike(own)

    @staticmethod
    def _act(event: Event, state: RunningState, action: Callable[[], None]) -> None:
        try:
            action()
        except Exception as error:
            raise EventError(_failed("action", event, state.time, error)) from error

    def strike(
        self, fired: Array, H: Array, change: Callable[[Array], Array], *, rebound: bool
    ) -> None:
        """Let limits strike their stops or leave them.

        Args:
            fired: As for :meth:`act`.
            H: Its frames of all nodes, ground and prescribed motions.
            change: Makes the state consistent with all constraints, given the coefficient by which
                each of the part reverses its rate; returns the multipliers.
            rebound: Whether there is restitution.
        """
        stops = fired[len(self._events) :] != 0.0
        factors = self.limits.strike(stops, H, rebound=rebound)
        resting = np.zeros(len(stops) // 2, dtype=bool)
        if not rebound:
            resting = stops.reshape(-1, 2).any(axis=1)
        while self.limits.separate(factors, H, change(self.limits.spread(factors)), resting):
            factors[:] = 0.0

    def number(self, k: int) -> int:
        """Number of an event in results: those of the scene, then limits.

        Args:
            k: Number of a condition or stop.
        """
        e = len(self._events)
        return k if k < e else e + (k - e) // 2

    def _label(self, k: int) -> str:
        e = len(self._events)
        return self._events[k].label if k < e else self.limits.items[(k - e) // 2].label

    # --- what actions of the package do ---

    def lock(self, connection: Connection) -> None:
        """Activate the constraints of a connection."""
        self._equations.history_variables.switch(connection, self._H, active=True)

    def release(self, connection: Connection) -> None:
        """Deactivate the constraints of a connection."""
        self._equations.history_variables.switch(connection, self._H, active=False)

    def scale(self, item: Any, factor: float) -> None:
        """Set the factor of a load, spring or force law."""
        self._equations.history_variables.scale(item, factor)

    def locked(self, connection: Connection) -> bool:
        """Whether the constraints of a connection act."""
        return self._equations.history_variables.acts(connection)

    def factor(self, item: Any) -> float:
        """Current factor of a load, spring or force law."""
        return self._equations.history_variables.factor(item)

    def stop(self) -> None:
        """End the run."""
        self.stopped = 1


def _failed(what: str, event: Event, time: float, error: Exception) -> str:
    return f"the {what} of {event.label} failed at time {time:.9g}: {type(error).__name__}: {error}"


def sensed(sensor: Sensor, state: RunningState) -> float:
    """Value of a sensor.

    Raises:
        EventError: Its function failed or did not return a number.
    """
    try:
        return number(sensor.quantity(state), "value of the sensor")
    except Exception as error:
        what = f"{type(error).__name__}: {error}"
        raise EventError(f"sensor {sensor.name} failed at time {state.time:.9g}: {what}") from error


class Root:
    """Search for the first zero of conditions within a step, by the method of Illinois.

    The search is for the size of a shorter step, at whose end the largest of all crossing
    conditions, with the signs of their changes, is not negative. Steps are solved up to the
    tolerance of the iteration, so a condition at the end of two steps of one size may differ by
    more than its change over the interval that is left, and its sign, too. The zero is then known
    to less: the tolerance doubles until a step ends behind it.
    """

    def __init__(self, signs: Array, start: Array, end: Array, size: float) -> None:
        """Begin with the whole step.

        Args:
            signs: Signs of :meth:`Events.crossed`.
            start: Values of the conditions at the start.
            end: Values at the end.
            size: Size of the step.
        """
        self._signs = signs
        self._low, self._high = 0.0, size
        self._below, self._above = self._largest(start), self._largest(end)
        self._tolerance, self._last, self._whole = 1e-10 * size, 0, size
        self._shortest = _SHORTEST * size

    def _largest(self, values: Array) -> float:
        chosen = self._signs != 0.0
        return float((self._signs[chosen] * values[chosen]).max())

    @property
    def found(self) -> bool:
        """Whether the last step that was taken ends just after the zero, or is the whole step."""
        near = self._last > 0 and self._high - self._low <= 2.0 * self._tolerance
        return near or self._low >= self._whole

    @property
    def at_start(self) -> bool:
        """Whether the zero is so near to the start that it counts as there."""
        return self._last > 0 and self._high <= self._shortest

    @property
    def size(self) -> float:
        """Size of the next step to try: last of all, the end of the interval."""
        width = self._high - self._low
        if width <= 2.0 * self._tolerance:
            return self._high
        at = self._low - self._below * width / (self._above - self._below)
        # a step near an end also bounds the zero from its other side
        at = at + (self._tolerance if self._last < 0 else -self._tolerance)
        found = np.clip(at, self._low + self._tolerance, self._high - self._tolerance)
        return float(max(found, self._shortest))

    def take(self, size: float, values: Array) -> None:
        """Take the values at the end of a step of this size.

        Args:
            size: Size of the step.
            values: Values of the conditions at its end.
        """
        value = self._largest(values)
        if value >= 0.0:
            if self._last > 0 and size < self._high:
                self._below *= 0.5
            self._high, self._above, self._last = size, max(value, 1e-300), 1
        else:
            if self._last < 0:
                self._above *= 0.5
            self._low, self._below, self._last = size, value, -1
            if size >= self._high:
                self._tolerance *= 2.0
                self._high = min(size + 2.0 * self._tolerance, self._whole)
