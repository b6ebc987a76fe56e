"""What is being compiled, how much of it is left, and how long that has taken."""

from __future__ import annotations

import logging
import sys
from collections.abc import Iterator
from time import perf_counter
from types import FunctionType, ModuleType
from typing import Any

from numba.core import event
from tqdm import tqdm

from fem_lie._jit.machine_code import PACKAGE

_DELAY = 1.0  # seconds, before which no bar is shown


def _functions_called(function: FunctionType) -> Iterator[FunctionType]:
    """Compiled functions that the code of one names."""
    scope, names = function.__globals__, function.__code__.co_names
    modules = [scope[name] for name in names if isinstance(scope.get(name), ModuleType)]
    for name in names:
        for value in (scope.get(name), *(vars(module).get(name) for module in modules)):
            known = getattr(value, "__dict__", {})
            called = known.get("function", known.get("py_func"))
            if isinstance(called, FunctionType):
                yield called


def count_functions(function: FunctionType) -> int:
    """How many functions are compiled for one at most, with all that it calls at any remove."""
    found, left = {function}, [function]
    while left:
        new = set(_functions_called(left.pop())) - found
        found |= new
        left += new
    return len(found)


class Compiling(event.Listener):
    """Says once in a process that machine code of this package is made, and shows how far it is.

    Attributes:
        seconds: How long that has taken in this process.
        functions: How many functions were compiled, for each set of argument types.
    """

    def __init__(self) -> None:
        """Nothing was made yet."""
        self.seconds, self.functions = 0.0, 0
        self._depth, self._begin, self._said = 0, 0.0, False
        self._bar: tqdm[Any] | None = None

    def on_start(self, event: Any) -> None:
        """A function begins to be compiled, for itself or for another one."""
        function = event.data["dispatcher"].py_func
        own = str(function.__module__).startswith(f"{PACKAGE.name}.")
        if own and not self._said:
            self._said = True
            logging.getLogger(__name__).warning(
                "%s compiles machine code, which it keeps: once per version and scheme, up to a "
                "minute or two; python -m %s --compile does so beforehand, on all cores",
                PACKAGE.name,
                PACKAGE.name,
            )
        if self._depth == 0:
            self._begin = perf_counter()
            if own and sys.stderr.isatty():
                self._bar = tqdm(
                    total=count_functions(function),
                    desc=f"compiles {function.__module__}.{function.__qualname__}",
                    unit="function",
                    leave=False,
                    delay=_DELAY,
                )
        self._depth += 1

    def on_end(self, event: Any) -> None:
        """It is done."""
        self._depth -= 1
        self.functions += 1
        if self._bar is not None:
            self._bar.update()
        if self._depth == 0:
            self.seconds += perf_counter() - self._begin
            if self._bar is not None:
                self._bar.close()
                self._bar = None


compiling = Compiling()
event.register("numba:compile", compiling)
