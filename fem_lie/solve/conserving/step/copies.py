"""Copies between arrays in compiled code.

``a[:] = b`` checks the shapes, and what would write them into a message is more code than most
functions are: some twenty functions on strings, which go into each caller.
"""

from __future__ import annotations

from fem_lie._arrays import Array
from fem_lie._jit import inlined


@inlined
def put(values: Array, out: Array) -> None:
    """``out[:] = values`` for arrays of the same shape."""
    source, target = values.flat, out.flat
    for k in range(out.size):
        target[k] = source[k]
