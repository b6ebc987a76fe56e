"""How far a load has grown, on terminals."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Protocol

from tqdm import tqdm

_PERCENT = 100
_DELAY = 1.0  # seconds, before which no bar is shown
_INTERVAL = 0.1  # seconds between two pictures of it


class Reach(Protocol):
    """Takes the load factor that is reached."""

    def __call__(self, factor: float) -> None:
        """Show it; a path may go back."""


@contextmanager
def load_bar(last: float) -> Iterator[Reach]:
    """A bar of the load factor up to the last one, if standard error is a terminal."""
    shown = {"desc": "load", "unit": "%", "delay": _DELAY, "mininterval": _INTERVAL}
    with tqdm(total=_PERCENT, disable=None, leave=False, **shown) as bar:

        def reach(factor: float) -> None:
            bar.update(int(_PERCENT * factor / last) - bar.n)

        yield reach
