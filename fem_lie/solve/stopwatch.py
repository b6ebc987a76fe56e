"""Wall time of a run, without what it takes to compile."""

from __future__ import annotations

from time import perf_counter

from fem_lie._jit import compiling


class Stopwatch:
    """Runs from when it is made; machine code that is made meanwhile does not count."""

    def __init__(self, before: float = 0.0) -> None:
        """Start, with seconds from ``before``."""
        self._begin = perf_counter() - compiling.seconds - before

    @property
    def seconds(self) -> float:
        """Up to now."""
        return perf_counter() - compiling.seconds - self._begin
