"""Progress bars on terminals, and the wall time of a solution."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from time import perf_counter
from typing import Any, Protocol

from tqdm import tqdm

from fem_lie._jit import compiling

_PERCENT = 100
_DELAY = 1.0  # seconds, before which no bar is shown
_INTERVAL = 0.1  # seconds between two pictures of it


class Reach(Protocol):
    """Callback with the current load factor."""

    def __call__(self, factor: float) -> None:
        """Show it; a path may go back."""


class Advance(Protocol):
    """Callback after each step."""

    def __call__(self, text: str) -> None:
        """Count the step, and show the text beside the bar."""


def _bar(name: str, unit: str, total: int | None) -> tqdm[Any]:
    """A bar that disappears at its end; none if standard error is no terminal."""
    return tqdm(
        total=total,
        desc=name,
        unit=unit,
        disable=None,
        leave=False,
        delay=_DELAY,
        mininterval=_INTERVAL,
    )


@contextmanager
def load_bar(last: float) -> Iterator[Reach]:
    """A bar of the load factor up to ``last``, if standard error is a terminal."""
    with _bar("load", "%", _PERCENT) as bar:

        def reach(factor: float) -> None:
            bar.update(int(_PERCENT * factor / last) - bar.n)

        yield reach


@contextmanager
def step_bar(name: str, unit: str, total: int | None = None) -> Iterator[Advance]:
    """A counter of steps, if standard error is a terminal.

    Args:
        name: Name of the analysis.
        unit: Unit of a step.
        total: Number of steps; ``None`` if unknown.
    """
    with _bar(name, unit, total) as bar:

        def advance(text: str) -> None:
            bar.set_postfix_str(text, refresh=False)
            bar.update()

        yield advance


class Stopwatch:
    """Wall time since its creation, without compilation."""

    def __init__(self, before: float = 0.0) -> None:
        """Start from ``before`` seconds."""
        self._begin = perf_counter() - compiling.seconds - before

    @property
    def seconds(self) -> float:
        """Elapsed wall time in s."""
        return perf_counter() - compiling.seconds - self._begin
