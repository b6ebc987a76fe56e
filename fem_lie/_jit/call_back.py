"""Calls of Python functions from compiled code that Python has called.

What is compiled asks for something that only Python can do in the middle of its work, and goes on:
simpler than to come back and to be called again. A call takes some microseconds.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic


class CalledBack:
    """A Python function without arguments at an address, which it keeps as long as it lives.

    Errors cannot pass through compiled code: the first one waits until it is asked for.

    Attributes:
        address: For :func:`call_back`.
    """

    def __init__(self, function: Callable[[], None], failed: Callable[[], None]) -> None:
        """At a new address.

        Args:
            function: To be called.
            failed: Called after an error, so that compiled code can end early.
        """
        self._function, self._failed = function, failed
        self._error: BaseException | None = None
        self._entrance = ctypes.CFUNCTYPE(None)(self._call)
        address = ctypes.cast(self._entrance, ctypes.c_void_p).value
        assert address is not None
        self.address: int = address

    def _call(self) -> None:
        if self._error is not None:
            return
        try:
            self._function()
        except BaseException as error:  # raised again by Python that has called compiled code
            self._error = error
            self._failed()

    def check(self) -> None:
        """Raise the error of the function, if there was one."""
        error, self._error = self._error, None
        if error is not None:
            raise error


@intrinsic
def call_back(typing_context: Any, address: Any) -> Any:
    """Call the function at :attr:`CalledBack.address`."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        kind = ir.FunctionType(ir.VoidType(), []).as_pointer()
        builder.call(builder.inttoptr(arguments[0], kind), [])
        return context.get_dummy_value()

    return types.void(types.int64), generate
