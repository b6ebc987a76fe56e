"""How large the next step is: chosen by a tolerance, or constant.

The tolerances are for the error of a step over its size (error per unit step): the error at the end
is then proportional to them. Step sizes are ``first · 2^(k/2)``: factorisations serve again.
A PI controller proposes ``h (θ/e)^I (e₋₁/e)^P``, with ``e`` the error over its tolerance
(K. Gustafsson, ACM Trans. Math. Softw. 17 (1991) 533), and the level follows it with a dead band.

Nothing here knows of a scheme: it asks for the sizes of an error of the order ``h^(order + 1)``.
"""

from __future__ import annotations

import json
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import ceil, floor, inf, isfinite, log2, sqrt
from typing import Any

import numpy as np

from fem_lie._arrays import positive, whole
from fem_lie._state import Stateful, attributes
from fem_lie.solve.division import HALVINGS

AIM = 0.8
"""Error that is aimed at, over the tolerance."""

INTEGRAL, PROPORTIONAL = 0.4, 0.2
"""Gains of the controller."""

PATIENCE = 3
"""Steps of one size before a larger one."""

LARGEST_RISE, LARGEST_FALL = 2, 8
"""Levels that the step may go up or down at once."""

FAILED = 4
"""Levels that the step goes down if its iteration fails."""

STRETCH = 4
"""So many steps before an event they are made to fit."""

SAME = 1e-9
"""Events that are nearer than this part of the duration are one."""


class StepChoice(ABC):
    """What :meth:`~fem_lie.GeneralisedAlpha.run` takes as ``step`` if it is to estimate errors.

    Attributes:
        refinement: If above 1, the true local errors are measured, too: each step is done a second
            time in so many parts.
    """

    refinement: int

    @abstractmethod
    def check(self, duration: float) -> None:
        """Raise ``ValueError`` if it does not fit a run of this duration."""

    @abstractmethod
    def control(
        self, duration: float, length: float, order: int, jumps: Sequence[float] = ()
    ) -> Control:
        """The sizes of one run of a model of this length by a scheme of this order.

        ``jumps`` are the times at which the scene says that something jumps.
        """


@dataclass(frozen=True)
class ConstantStep(StepChoice):
    """Steps of one size, with estimates of their errors in the result.

    Between events, see :class:`AdaptiveStep`, steps are of one size that fits, at most h, but for
    those that fail and are made in parts.

    Attributes:
        size: Step size h.
        events: Times at which loads or motions jump, beside those that say so themselves.
        refinement: If above 1, the true local errors are measured, too: each step is done a second
            time in so many parts.
    """

    size: float
    refinement: int = 1
    events: Sequence[float] = ()

    def check(self, duration: float) -> None:
        """Raise ``ValueError`` if the duration is no multiple of the step, or an option is bad."""
        positive(self.size, "the step")
        if abs(round(duration / self.size) * self.size - duration) > 1e-6 * self.size:
            raise ValueError(f"duration {duration} is not a multiple of the step {self.size}")
        _check_events(self.events, duration)
        _check_refinement(self.refinement)

    def control(
        self, duration: float, length: float, order: int, jumps: Sequence[float] = ()
    ) -> Control:
        """The one size, but for what fits between events, and for steps that fail."""
        times = _sorted(self.events, jumps, duration)
        smallest = self.size / 2**HALVINGS
        control = Control(self.size, inf, inf, times, self.size, smallest, order)
        control.stretch = inf
        return control


@dataclass(frozen=True)
class AdaptiveStep(StepChoice):
    """Steps as large as a tolerance allows.

    Attributes:
        tolerance: Estimated error of positions in a step, over its size: length per time.
        rotation_tolerance: That of rotations and of position gradients, rad or 1 per time;
            default: ``tolerance`` over the length of the model.
        first: Size that is tried first; default: a thousandth of the duration.
        events: Times at which loads or motions jump or have kinks, beside those that say so
            themselves (:mod:`fem_lie.joints.histories`). Steps end there, what jumps is seen from
            before and from after, and accelerations (and the velocities of driven joints) are made
            consistent anew. Others are found by steps that are rejected.
        smallest: Steps below end the run with an error; default: 1e-10 of the duration.
        largest: Steps are not above; default: a tenth of the duration.
        refinement: If above 1, the true local errors are measured, too: each step is done a second
            time in so many parts.
    """

    tolerance: float
    rotation_tolerance: float | None = None
    first: float | None = None
    events: Sequence[float] = ()
    smallest: float | None = None
    largest: float | None = None
    refinement: int = 1

    def check(self, duration: float) -> None:
        """Raise ``ValueError`` if a tolerance, size, event or refinement is bad."""
        positive(self.tolerance, "tolerance")
        for name in ("rotation_tolerance", "first", "smallest", "largest"):
            value = getattr(self, name)
            if value is not None:
                positive(value, name)
        smallest, first, largest = self._sizes(duration)
        if not smallest <= first <= largest:
            raise ValueError(
                f"wanted smallest ≤ first ≤ largest step, got {smallest:g}, {first:g}, {largest:g}"
            )
        _check_events(self.events, duration)
        _check_refinement(self.refinement)

    def control(
        self, duration: float, length: float, order: int, jumps: Sequence[float] = ()
    ) -> Control:
        """Sizes that follow the errors, from the first one."""
        smallest, first, largest = self._sizes(duration)
        rotation = self.rotation_tolerance or self.tolerance / length
        times = _sorted(self.events, jumps, duration)
        return Control(first, self.tolerance, rotation, times, largest, smallest, order)

    def _sizes(self, duration: float) -> tuple[float, float, float]:
        largest = self.largest or 0.1 * duration
        smallest = self.smallest or 1e-10 * duration
        return smallest, self.first or min(1e-3 * duration, largest), largest


def _check_events(events: Sequence[float], duration: float) -> None:
    if any(not 0.0 < time < duration for time in events):
        raise ValueError(f"events must be in (0, {duration:g}), got {list(events)}")


def _sorted(events: Sequence[float], jumps: Sequence[float], duration: float) -> tuple[float, ...]:
    """All events in their order, and the end; those nearer than round-off are one."""
    times: list[float] = []
    for time in sorted(map(float, (*events, *jumps))):
        if not times or time - times[-1] > SAME * duration:
            times.append(time)
    return (*times, duration)


def _check_refinement(parts: int) -> None:
    whole(parts, "refinement")


_CHOICES: dict[str, Callable[..., StepChoice]] = {
    kind.__name__: kind for kind in (ConstantStep, AdaptiveStep)
}


def described(choice: StepChoice) -> str:
    """A choice as text, from which :func:`step_choice` makes it again.

    Raises:
        ValueError: It is not one of this module.
    """
    name = type(choice).__name__
    if name not in _CHOICES or type(choice) is not _CHOICES[name]:
        raise ValueError(
            f"runs go to files by steps that are a number, {' or '.join(_CHOICES)}, got {choice}"
        )
    return json.dumps({"kind": name} | vars(choice), default=_plain)


def _plain(value: Any) -> Any:
    """Numbers and arrays of numpy as those of Python."""
    return np.asarray(value).tolist()


def step_choice(text: str) -> StepChoice:
    """The choice that :func:`described` made to text."""
    values = json.loads(text)
    return _CHOICES[values.pop("kind")](**values)


class Control(Stateful):
    """The sizes of the steps of one run.

    Attributes:
        tolerance: Of positions; infinite if steps are constant.
        rotation_tolerance: Of rotations.
        smallest: Smallest size.
        level: The step is ``first · 2^(level/2)``.
        stretch: So many steps before an event they are made to fit.
    """

    STATE = attributes("level", "_since", "_previous", "_next")

    def __init__(
        self,
        first: float,
        tolerance: float,
        rotation_tolerance: float,
        events: Sequence[float],
        largest: float,
        smallest: float,
        order: int,
    ) -> None:
        """Start with the size ``first``; ``events`` ends with the duration of the run."""
        self.tolerance, self.rotation_tolerance = tolerance, rotation_tolerance
        self.smallest = smallest
        self._first, self._largest, self._order = first, largest, order
        self._events, self._next = tuple(events), 0
        self.level, self._since, self._previous = 0, 0, AIM
        self.stretch: float = STRETCH

    @property
    def size(self) -> float:
        """Size on the present level."""
        return float(self._first * sqrt(2.0) ** self.level)

    @property
    def next_event(self) -> float:
        """The event ahead, or the end."""
        return self._events[self._next]

    @property
    def finished(self) -> bool:
        """Whether the end was reached."""
        return self._next == len(self._events)

    def pass_event(self) -> None:
        """Go for the next event."""
        self._next += 1

    def fitted(self, time: float) -> float:
        """Size of the next step from ``time``: shortly before an event some that just fit."""
        left, h = self.next_event - time, self.size
        if left > self.stretch * h:
            return h
        return left / max(1, ceil(left / h - 1e-6))

    def ratio(self, translation: float, rotation: float, h: float) -> float:
        """Error over its tolerance; infinite if it is not a number."""
        e = max(translation / (h * self.tolerance), rotation / (h * self.rotation_tolerance))
        return e if isfinite(e) else inf

    def accept(self, e: float) -> None:
        """Choose the level after a step with the error ``e`` over its tolerance."""
        e = max(e, 1e-6)
        proposed = (AIM / e) ** (2 * INTEGRAL / self._order)
        proposed *= (self._previous / e) ** (2 * PROPORTIONAL / self._order)
        self._previous = e
        self._since += 1
        change = floor(2.0 * log2(proposed))
        if change > 0:
            if self._since < PATIENCE:
                return
            top = floor(2.0 * log2(self._largest / self._first) + 1e-6)
            change = min(change, LARGEST_RISE, top - self.level)
        elif self.size < sqrt(2.0) * self.smallest:
            return
        self._move(max(change, -1))

    def reject(self, e: float) -> None:
        """Choose the level after a step with too large an error, infinite if it failed."""
        if e < inf:
            fall = ceil(2.0 * log2(e / AIM) / self._order)
            self._move(-min(max(fall, 1), LARGEST_FALL))
        else:
            self._move(-FAILED)
        self._previous = AIM

    def _move(self, change: int) -> None:
        if change:
            self.level, self._since = self.level + change, 0
            # what the error over its tolerance is expected to be on the new level
            self._previous *= 2.0 ** (0.5 * self._order * change)
