"""Histories that declare their jumps: time steps end at a jump, and continue with the later value.

A history is any function of time. An attribute ``jumps`` declares the times of its discontinuities
to the integrators; :class:`PiecewiseSmooth` adds it to a function, and :class:`Table` has it. At a
jump the history has the later value.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import inf, isfinite
from typing import Generic, TypeVar

Value = TypeVar("Value")


@dataclass(frozen=True)
class PiecewiseSmooth(Generic[Value]):
    """Function of time with declared discontinuities.

    For a load these are jumps of its factor. Drives and prescribed motions must be continuous; for
    them they are jumps of the first or second derivative, of velocity or acceleration.

    Attributes:
        function: Function of time.
        jumps: Times of the jumps; times outside of a run have no effect.
    """

    function: Callable[[float], Value]
    jumps: Sequence[float]

    def __post_init__(self) -> None:
        """Validate the times."""
        object.__setattr__(self, "jumps", _checked(self.jumps, "jumps"))

    def __call__(self, time: float) -> Value:
        """Value of the function."""
        return self.function(time)


@dataclass(frozen=True)
class PiecewiseLinear:
    """Piecewise linear function of time.

    A time that occurs twice is a jump from the first of its values to the second. Before the first
    time and after the last one the value is constant. A drive must not jump; its kinks are jumps of
    the velocity. Kinks of a load have no effect on time steps.

    Attributes:
        times: Times in ascending order, each at most twice.
        values: Values at the times.
    """

    times: Sequence[float]
    values: Sequence[float]

    def __post_init__(self) -> None:
        """Validate times and values."""
        times, values = _checked(self.times, "times"), tuple(map(float, self.values))
        if len(times) != len(values) or not times:
            raise ValueError(
                f"expected as many times as values, got {len(times)} and {len(values)}"
            )
        if not all(map(isfinite, values)):
            raise ValueError(f"the values of a table must be finite, got {list(values)}")
        if any(b < a for a, b in pairwise(times)):
            raise ValueError(f"the times of a table must not fall, got {list(times)}")
        if any(a == c for a, c in zip(times, times[2:], strict=False)):
            raise ValueError(f"a time of a table may be given twice at most, got {list(times)}")
        object.__setattr__(self, "times", times)
        object.__setattr__(self, "values", values)

    def __call__(self, time: float) -> float:
        """Value at a time; at a jump the later one."""
        right = bisect_right(self.times, time)
        if right in (0, len(self.times)):
            return self.values[min(right, len(self.times) - 1)]
        t0, t1 = self.times[right - 1 : right + 1]
        a, b = self.values[right - 1 : right + 1]
        return a + (b - a) * (time - t0) / (t1 - t0)

    @property
    def jumps(self) -> tuple[float, ...]:
        """Times that occur twice."""
        return tuple(a for a, b in pairwise(self.times) if a == b)

    @property
    def kinks(self) -> tuple[float, ...]:
        """All times, at which the slope changes."""
        return tuple(dict.fromkeys(self.times))


def declared(histories: Iterable[object], *, kinks: bool) -> tuple[float, ...]:
    """Sorted times of the jumps, and of the kinks if asked for, that histories declare."""
    found: set[float] = set()
    for history in histories:
        found |= set(getattr(history, "jumps", ()))
        if kinks:
            found |= set(getattr(history, "kinks", ()))
    return tuple(sorted(found))


def until_next(times: Sequence[float], time: float) -> float:
    """Time from ``time`` to the next of the sorted ``times``; infinite if there is none."""
    return min((t - time for t in times if t > time * (1.0 + 1e-12)), default=inf)


def difference_step(
    times: Sequence[float], time: float, step: float, count: int, last: float
) -> float:
    """Interval of differences over ``count`` times after ``time``; before it if it is negative.

    Functions are defined from the start to the end of a run, and have a rate between the sorted
    ``times``. At most ``step``; differences are backward where more time has passed since the last
    of the ``times`` than is left until the end.

    Args:
        times: Discontinuities.
        time: The time.
        step: Largest interval.
        count: Number of intervals.
        last: End of the run, or infinity.
    """
    ahead, left = until_next(times, time), last - time
    if count * step > left and left <= ahead:
        passed = time - max((t for t in times if t <= time * (1.0 + 1e-12)), default=0.0)
        if passed > left:
            return -min(step, passed / count)
    return min(step, ahead / count, max(left, 0.0) / count if left > 0.0 else inf)


def _checked(times: Sequence[float], what: str) -> tuple[float, ...]:
    given = tuple(map(float, times))
    if not all(map(isfinite, given)):
        raise ValueError(f"{what} must be finite times, got {list(given)}")
    return given
