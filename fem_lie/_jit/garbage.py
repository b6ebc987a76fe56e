"""Garbage collection during compilation.

The compiler creates millions of small objects for a function, most of which are freed by their
reference counts. Meanwhile the collector of cycles walks through them and through all loaded
libraries again and again: an eighth of the processor time of a first run.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager

_SELDOM = 100_000, 20, 100
"""Thresholds of new objects and of collections between collections of the generations."""


@contextmanager
def seldom_collected() -> Iterator[None]:
    """Collect cycles among new objects only, and seldom, while the block runs."""
    before = gc.get_threshold()
    if before[0]:  # or the user has switched it off
        gc.set_threshold(*_SELDOM)
    try:
        yield
    finally:
        gc.set_threshold(*before)
