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
    """Address of uninitialised doubles in the caller's stack frame, valid until it returns.

    They need no allocation, and arrays there no reference counts, which take a third of the time of
    small functions.
    """

    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        return builder.alloca(ir.DoubleType(), size=arguments[0])

    return types.CPointer(types.float64)(size), generate


@inlined
def vector_at(address: Any, count: int) -> Any:
    """Vector at an address, as the following also for functions without reference counts."""
    return numba.carray(address, (count,))


@inlined
def matrix_at(address: Any, rows: int, columns: int) -> Any:
    """Matrix at an address."""
    return numba.carray(address, (rows, columns))


@inlined
def blocks_at(address: Any, count: int, rows: int, columns: int) -> Any:
    """Matrices of one shape at an address."""
    return numba.carray(address, (count, rows, columns))
