"""Step size control: chosen by an error tolerance, or constant.

Tolerances are for the error of a step over its size (error per unit step): the error at the end is
then proportional to the tolerance. Step sizes are ``first · 2^(k/2)``, so that factorisations can
be reused.

A PI controller proposes ``h (θ/e)^I (e₋₁/e)^P``, with ``e`` the error over its tolerance (K.
Gustafsson, ACM Trans. Math. Softw. 17 (1991) 533), and the level ``k`` follows it with a dead band.
This module knows no scheme: it takes the sizes of errors of the order ``h^(order + 1)``.
"""

from __future__ import annotations

import json
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import ceil, floor, inf, isfinite, log2, sqrt
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from fem_lie._arrays import positive, whole
from fem_lie._state import Stateful, attributes
from fem_lie.solve.division import HALVINGS

AIM = 0.8
"""Target error over the tolerance."""

INTEGRAL, PROPORTIONAL = 0.4, 0.2
"""Gains of the controller."""

PATIENCE = 3
"""Steps of one size before a larger one is allowed."""

LARGEST_RISE, LARGEST_FALL = 2, 8
"""Largest change of the level in one step, up and down."""

FAILED = 4
"""Levels that the step goes down if its iteration fails."""

FITTED_STEPS = 4
"""Number of steps before an event that are fitted to end at it."""

DOUBTFUL, FALLING = 2.0, 0.9
"""Rates of constraints over the tolerance that are to fall with the step, and by what factor."""

DOUBTS, IGNORED = 8, 64
"""Number of steps in which they do not fall, and in which they are ignored then."""

NO_ERROR = 1e-6
"""Smallest error over its tolerance that the controller distinguishes."""

SAME_SIZE = 1e-12
"""Relative difference of sizes that are equal, but for round-off."""

SAME = 1e-9
"""Events closer than this fraction of the duration are one."""


class StepChoice(ABC):
    """Base of step size choices, passed as ``step`` to :meth:`~fem_lie.GeneralisedAlpha.run`.

    Attributes:
        refinement: If above 1, the true local errors are measured, too: each step is repeated with
            this number of sub-steps.
    """

    refinement: int

    @abstractmethod
    def check(self, duration: float) -> None:
        """Raise ``ValueError`` if it does not fit a run of this duration.

        Args:
            duration: Duration of the run.
        """

    @abstractmethod
    def control(
        self, duration: float, length: float, order: int, jumps: Sequence[float] = ()
    ) -> Control:
        """Step size control of one run, for a model of this length and a scheme of this order.

        ``jumps`` are the times of the discontinuities in the scene.

        Args:
            duration: Duration of the run.
            length: Characteristic size of the scene.
            order: Order of the scheme.
            jumps: Times at which loads or drives jump.
        """


def number_of_steps(duration: float, step: float) -> int:
    """Number of equal steps of a run.

    Raises:
        ValueError: The duration is no multiple of the step; the message has the nearest step.
    """
    steps = round(duration / step)
    if steps < 1 or abs(steps * step - duration) > 1e-6 * step:
        raise ValueError(
            f"duration {duration} is not a multiple of the step {step}; it is one of "
            f"{duration / max(steps, 1):.12g}"
        )
    return steps


@dataclass(frozen=True)
class ConstantStep(StepChoice):
    """Steps of one size, with error estimates in the result.

    Between events, see :class:`AdaptiveStep`, the steps have one size that fits, at most h. Steps
    that fail are divided.

    Attributes:
        size: Step size h.
        events: Times of discontinuities of loads or motions, in addition to those known to the
            scene.
        refinement: If above 1, the true local errors are measured, too: each step is repeated with
            this number of sub-steps.
    """

    size: float
    refinement: int = 1
    events: Sequence[float] = ()

    def check(self, duration: float) -> None:
        """Raise ``ValueError`` if the duration is no multiple of the step; check the options.

        Args:
            duration: Duration of the run.
        """
        positive(self.size, "the step")
        number_of_steps(duration, self.size)
        check_events(self.events, duration, self.refinement)

    def control(
        self, duration: float, length: float, order: int, jumps: Sequence[float] = ()
    ) -> Control:
        """Control with one size, except near events and after failures.

        Args:
            duration: Duration of the run.
            length: Characteristic size of the scene.
            order: Order of the scheme.
            jumps: Times at which loads or drives jump.
        """
        times = sorted_events(self.events, jumps, duration)
        smallest = self.size / 2**HALVINGS
        control = Control(self.size, inf, inf, times, self.size, smallest, order)
        control.fitted_steps = inf
        return control


@dataclass(frozen=True)
class AdaptiveStep(StepChoice):
    """Step sizes chosen by an error tolerance.

    Attributes:
        tolerance: Estimated error of positions in a step over the step size: length per time. In
            scenes with drives or prescribed motions also the rates of constraints.
        rotation_tolerance: That of rotations and of position gradients, rad or 1 per time; default:
            ``tolerance`` over the length of the model.
        first: Size of the first step; default: a thousandth of the duration.
        events: Times of discontinuities or kinks of loads or motions, in addition to those known to
            the scene (:mod:`fem_lie.joints.histories`). Steps end there, both one-sided values are
            used, and accelerations (and the velocities of driven joints) are made consistent again.
            Other discontinuities are found by rejected steps.
        smallest: Smaller steps end the run with an error; default: 1e-10 of the duration.
        largest: Largest step size; default: a tenth of the duration.
        refinement: If above 1, the true local errors are measured, too: each step is repeated with
            this number of sub-steps.
    """

    tolerance: float
    rotation_tolerance: float | None = None
    first: float | None = None
    events: Sequence[float] = ()
    smallest: float | None = None
    largest: float | None = None
    refinement: int = 1

    def check(self, duration: float) -> None:
        """Raise ``ValueError`` if a tolerance, size, event or refinement is invalid.

        Args:
            duration: Duration of the run.
        """
        positive(self.tolerance, "tolerance")
        for name in ("rotation_tolerance", "first", "smallest", "largest"):
            value = getattr(self, name)
            if value is not None:
                positive(value, name)
        smallest, first, largest = self._sizes(duration)
        if not smallest <= first <= largest:
            raise ValueError(
                "expected smallest ≤ first ≤ largest step, got "
                f"{smallest:g}, {first:g}, {largest:g}"
            )
        check_events(self.events, duration, self.refinement)

    def control(
        self, duration: float, length: float, order: int, jumps: Sequence[float] = ()
    ) -> Control:
        """Control that follows the errors, from the first size.

        Args:
            duration: Duration of the run.
            length: Characteristic size of the scene.
            order: Order of the scheme.
            jumps: Times at which loads or drives jump.
        """
        smallest, first, largest = self._sizes(duration)
        rotation = self.rotation_tolerance or self.tolerance / length
        times = sorted_events(self.events, jumps, duration)
        return Control(first, self.tolerance, rotation, times, largest, smallest, order)

    def _sizes(self, duration: float) -> tuple[float, float, float]:
        largest = self.largest or 0.1 * duration
        smallest = self.smallest or 1e-10 * duration
        return smallest, self.first or min(1e-3 * duration, largest), largest


def check_events(events: Sequence[float], duration: float, refinement: int) -> None:
    """Raise ``ValueError`` if events are not within the run, or the refinement is no number.

    Args:
        events: Times of discontinuities.
        duration: Duration of the run.
        refinement: Number of sub-steps.
    """
    if any(not 0.0 < time < duration for time in events):
        raise ValueError(f"events must be in (0, {duration:g}), got {list(events)}")
    whole(refinement, "refinement")


def sorted_events(
    events: Sequence[float], jumps: Sequence[float], duration: float
) -> tuple[float, ...]:
    """All events in order, and the end; events closer than round-off are merged.

    Args:
        events: Times of discontinuities.
        jumps: Times at which loads or drives jump.
        duration: Duration of the run.
    """
    times: list[float] = []
    for time in sorted(map(float, (*events, *jumps))):
        if not times or time - times[-1] > SAME * duration:
            times.append(time)
    return (*times, duration)


_CHOICES: dict[str, Callable[..., StepChoice]] = {
    kind.__name__: kind for kind in (ConstantStep, AdaptiveStep)
}

ChoiceT = TypeVar("ChoiceT", bound=StepChoice)


def readable(kind: type[ChoiceT]) -> type[ChoiceT]:
    """Add a class of choices to those that :func:`described` writes; for a decorator."""
    _CHOICES[kind.__name__] = kind
    return kind


def described(choice: StepChoice) -> str:
    """Text of a choice, which :func:`step_choice` reads.

    Raises:
        ValueError: The choice is of a class of a user.
    """
    name = type(choice).__name__
    if name not in _CHOICES or type(choice) is not _CHOICES[name]:
        raise ValueError(
            f"runs with a file take step as a number, {' or '.join(_CHOICES)}, got {choice}"
        )
    return json.dumps({"kind": name} | vars(choice), default=_plain)


def _plain(value: Any) -> Any:
    """NumPy numbers and arrays as Python ones."""
    return np.asarray(value).tolist()


def step_choice(text: str) -> StepChoice:
    """The choice that :func:`described` has written."""
    values = json.loads(text)
    return _CHOICES[values.pop("kind")](**values)


class Control(Stateful):
    """Step size control of one run.

    Attributes:
        tolerance: For positions; infinite if steps are constant.
        rotation_tolerance: For rotations.
        smallest: Smallest size.
        level: The step size is ``first · 2^(level/2)``.
        fitted_steps: Number of steps before an event that are fitted to end at it.
    """

    STATE = attributes("level", "_since", "_previous", "_next", "_rates", "_doubts")

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
        """Start with the first size.

        Args:
            first: First step size.
            tolerance: Tolerance of positions, length per time; infinite if steps are constant.
            rotation_tolerance: Tolerance of rotations, rad per time.
            events: Times at which a step must end, the end of the run last.
            largest: Largest step size.
            smallest: Smallest step size.
            order: Order of the scheme.
        """
        self.tolerance, self.rotation_tolerance = tolerance, rotation_tolerance
        self.smallest = smallest
        self._first, self._largest, self._order = first, largest, order
        self._events, self._next = tuple(events), 0
        self.level, self._since, self._previous = 0, 0, AIM
        self._rates, self._doubts = inf, 0
        self.fitted_steps: float = FITTED_STEPS

    @property
    def size(self) -> float:
        """Step size of the current level."""
        return float(self._first * sqrt(2.0) ** self.level)

    @property
    def next_event(self) -> float:
        """Time of the next event, or of the end."""
        return self._events[self._next]

    @property
    def finished(self) -> bool:
        """Whether the end is reached."""
        return self._next == len(self._events)

    def pass_event(self) -> None:
        """Proceed to the next event."""
        self._next += 1

    def fitted(self, time: float) -> float:
        """Size of the next step from ``time``, fitted to the next event if it is near.

        Args:
            time: Time.
        """
        left, h = self.next_event - time, self.size
        if left > self.fitted_steps * h:
            return h
        return left / max(1, ceil(left / h - 1e-6))

    @property
    def constant(self) -> bool:
        """Whether steps have one size, whatever their error, and the current one is not smaller."""
        return self.fitted_steps == inf and self.level == 0

    def next_ends(self, time: float, most: int) -> npt.NDArray[np.float64]:
        """Ends of the next steps of one size that do not reach the next event, shape (k,).

        Args:
            time: Time.
            most: Largest number of steps.
        """
        ends: list[float] = []
        first = self.fitted(time)
        while len(ends) < most and self.next_event - time > first * (1.0 + 1e-6):
            h = self.fitted(time)
            if abs(h / first - 1.0) > SAME_SIZE:
                break
            time += h
            ends.append(time)
        return np.array(ends)

    def accept_many(self, count: int) -> None:
        """As :meth:`accept` for steps of constant size without an error.

        Args:
            count: Number of steps.
        """
        self._since, self._previous = self._since + count, NO_ERROR

    def ratio(self, translation: float, rotation: float, h: float) -> float:
        """Error over its tolerance; infinite if it is not a number.

        Args:
            translation: Estimated error of translations, a length.
            rotation: Estimated error of rotations, rad.
            h: Step size.
        """
        e = max(translation / (h * self.tolerance), rotation / (h * self.rotation_tolerance))
        return e if isfinite(e) else inf

    def believed(self, rates: float) -> float:
        """Rates of constraints over their tolerance, or 0 while smaller steps do not reduce them.

        No velocities satisfy constraints that contradict each other, whatever the step.

        Args:
            rates: Rates of an accepted step over their tolerance.
        """
        if self._doubts < 0:
            self._doubts += 1
            return 0.0
        doubtful = DOUBTFUL < rates >= FALLING * self._rates
        self._rates = rates if rates > DOUBTFUL else inf
        self._doubts = self._doubts + 1 if doubtful else 0
        if self._doubts == DOUBTS:
            self._rates, self._doubts = inf, -IGNORED
            return 0.0
        return rates

    def accept(self, e: float) -> None:
        """Choose the level after an accepted step with error ``e`` over its tolerance.

        Args:
            e: Estimated error over its tolerance.
        """
        e = max(e, NO_ERROR)
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
        """Choose the level after a rejected step; ``e`` is infinite if the iteration failed.

        Args:
            e: Estimated error over its tolerance.
        """
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
