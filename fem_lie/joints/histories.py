"""Histories that know when they jump: steps in time end there, and go on from the other side.

A history is any function of time. One that has an attribute ``jumps``, times at which it is not
continuous, tells the integrators; :class:`Jumps` gives it to a function, and :class:`Table` has it.
At such a time a history has the value that it has afterwards.
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
class Jumps(Generic[Value]):
    """A function of time, with the times at which it jumps.

    For a load these are jumps of its factor. Of a drive or a prescribed motion, which do not jump
    themselves, they are jumps of the first or second derivative: of velocity or acceleration.

    Attributes:
        function: Of time, as it is without this.
        jumps: The times; those outside of a run are no matter.
    """

    function: Callable[[float], Value]
    jumps: Sequence[float]

    def __post_init__(self) -> None:
        """Check the times."""
        object.__setattr__(self, "jumps", _checked(self.jumps, "jumps"))

    def __call__(self, time: float) -> Value:
        """The function's value."""
        return self.function(time)


@dataclass(frozen=True)
class Table:
    """Values at given times and straight lines between them.

    A time that is given twice is a jump from the first of its values to the second. Before the
    first time and after the last the value stays. A drive must not jump, but may have kinks, which
    are jumps of its velocity; for a load a kink is no event.

    Attributes:
        times: Never falling; each at most twice.
        values: Of the same number.
    """

    times: Sequence[float]
    values: Sequence[float]

    def __post_init__(self) -> None:
        """Check the numbers."""
        times, values = _checked(self.times, "times"), tuple(map(float, self.values))
        if len(times) != len(values) or not times:
            raise ValueError(f"wanted as many times as values, got {len(times)} and {len(values)}")
        if not all(map(isfinite, values)):
            raise ValueError(f"the values of a table must be finite, got {list(values)}")
        if any(b < a for a, b in pairwise(times)):
            raise ValueError(f"the times of a table must not fall, got {list(times)}")
        if any(a == c for a, c in zip(times, times[2:], strict=False)):
            raise ValueError(f"a time of a table may be given twice at most, got {list(times)}")
        object.__setattr__(self, "times", times)
        object.__setattr__(self, "values", values)

    def __call__(self, time: float) -> float:
        """The value at a time, after the jump if there is one."""
        right = bisect_right(self.times, time)
        if right in (0, len(self.times)):
            return self.values[min(right, len(self.times) - 1)]
        t0, t1 = self.times[right - 1 : right + 1]
        a, b = self.values[right - 1 : right + 1]
        return a + (b - a) * (time - t0) / (t1 - t0)

    @property
    def jumps(self) -> tuple[float, ...]:
        """Times that are given twice."""
        return tuple(a for a, b in pairwise(self.times) if a == b)

    @property
    def kinks(self) -> tuple[float, ...]:
        """All times, at which the slope changes."""
        return tuple(dict.fromkeys(self.times))


def declared(histories: Iterable[object], *, kinks: bool) -> tuple[float, ...]:
    """Times at which histories say that they jump, and have kinks, in their order."""
    found: set[float] = set()
    for history in histories:
        found |= set(getattr(history, "jumps", ()))
        if kinks:
            found |= set(getattr(history, "kinks", ()))
    return tuple(sorted(found))


def until_next(times: Sequence[float], time: float) -> float:
    """How long it is from ``time`` to the next of ``times``, which are in their order."""
    return min((t - time for t in times if t > time * (1.0 + 1e-12)), default=inf)


def _checked(times: Sequence[float], what: str) -> tuple[float, ...]:
    given = tuple(map(float, times))
    if not all(map(isfinite, given)):
        raise ValueError(f"{what} must be finite times, got {list(given)}")
    return given
