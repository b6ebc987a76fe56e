"""Calls of Python functions from compiled code that Python has called.

Compiled code uses them for work that only Python can do, and continues: simpler than to return and
to be called again. A call takes some microseconds.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic


class CalledBack:
    """A Python function without arguments at an address, which is valid during its life.

    Errors cannot pass through compiled code: the first one is stored until :meth:`check`.

    Attributes:
        address: Address for :func:`call_back`.
    """

    def __init__(self, function: Callable[[], None], failed: Callable[[], None]) -> None:
        """Create the callback.

        Args:
            function: Function to call.
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
        except BaseException as error:  # raised again by the Python caller of the compiled code
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
