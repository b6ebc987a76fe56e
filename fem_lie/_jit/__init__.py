"""The compiler: decorators of compiled code, and a disk cache of it that can be trusted."""

from fem_lie._jit.decorators import (
    callback,
    compiled,
    inlined,
    inlined_series,
    inlined_uncounted,
    linked,
    uncounted,
)
from fem_lie._jit.progress import compiling

__all__ = [
    "callback",
    "compiled",
    "compiling",
    "inlined",
    "inlined_series",
    "inlined_uncounted",
    "linked",
    "uncounted",
]
