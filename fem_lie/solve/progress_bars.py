"""How far a solution is, on terminals, and how long it has taken."""

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
    """Takes the load factor that is reached."""

    def __call__(self, factor: float) -> None:
        """Show it; a path may go back."""


class Advance(Protocol):
    """Takes what is known after another step."""

    def __call__(self, text: str) -> None:
        """Count the step, and show the text beside the bar."""


def _bar(name: str, unit: str, total: int | None) -> tqdm[Any]:
    """A bar that disappears at its end; none where standard error is no terminal."""
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
    """A bar of the load factor up to the last one, if standard error is a terminal."""
    with _bar("load", "%", _PERCENT) as bar:

        def reach(factor: float) -> None:
            bar.update(int(_PERCENT * factor / last) - bar.n)

        yield reach


@contextmanager
def step_bar(name: str, unit: str, total: int | None = None) -> Iterator[Advance]:
    """A count of steps, if standard error is a terminal.

    Args:
        name: What is solved.
        unit: What a step is.
        total: Number of steps; ``None`` if nobody knows it before.
    """
    with _bar(name, unit, total) as bar:

        def advance(text: str) -> None:
            bar.set_postfix_str(text, refresh=False)
            bar.update()

        yield advance


class Stopwatch:
    """Runs from when it is made; machine code that is made meanwhile does not count."""

    def __init__(self, before: float = 0.0) -> None:
        """Start, with seconds from ``before``."""
        self._begin = perf_counter() - compiling.seconds - before

    @property
    def seconds(self) -> float:
        """Up to now."""
        return perf_counter() - compiling.seconds - self._begin
