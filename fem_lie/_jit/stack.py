"""Memory in the stack frame of compiled code."""

from __future__ import annotations

from typing import Any

import numba
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from fem_lie._jit.decorators import inlined


@intrinsic
def stack(typing_context, size):  # type: ignore[no-untyped-def]
    """Where uninitialised doubles stand in the caller's stack frame, until it returns.

    They cost no allocation, and arrays there no counting of references, which small functions
    spend a third of their time on.
    """

    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        return builder.alloca(ir.DoubleType(), size=arguments[0])

    return types.CPointer(types.float64)(size), generate


@inlined
def vector_at(place: Any, count: int) -> Any:
    """The numbers at a place, here and below also for functions that count no references."""
    return numba.carray(place, (count,))


@inlined
def matrix_at(place: Any, rows: int, columns: int) -> Any:
    """The matrix at a place."""
    return numba.carray(place, (rows, columns))


@inlined
def blocks_at(place: Any, count: int, rows: int, columns: int) -> Any:
    """Matrices of one shape at a place."""
    return numba.carray(place, (count, rows, columns))
