"""Memory in the stack frame of compiled code."""

from __future__ import annotations

from llvmlite import ir
from numba import types
from numba.extending import intrinsic


@intrinsic
def stack(typing_context, size):  # type: ignore[no-untyped-def]
    """Where uninitialised doubles stand in the caller's stack frame, until it returns.

    They cost no allocation, and arrays there no counting of references, which small functions
    spend a third of their time on.
    """

    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        return builder.alloca(ir.DoubleType(), size=arguments[0])

    return types.CPointer(types.float64)(size), generate
