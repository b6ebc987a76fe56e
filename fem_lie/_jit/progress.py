"""Progress of compilation: current function, estimate of the rest, and time."""

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

_DELAY = 1.0  # seconds before a bar is shown


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


def _is_kept(function: FunctionType) -> bool:
    """Whether a function of the package stays compiled for later processes.

    One that is closed over a user's function, as in a compiled law, does not.
    """
    inside = str(function.__module__).startswith(f"{PACKAGE.name}.")
    return inside and function.__closure__ is None


def count_functions(function: FunctionType) -> int:
    """Upper bound of the number of functions compiled for one, with all that it calls."""
    found, left = {function}, [function]
    while left:
        new = set(_functions_called(left.pop())) - found
        found |= new
        left += new
    return len(found)


class Compiling(event.Listener):
    """Logs once per process that machine code is compiled, and shows a progress bar.

    Attributes:
        seconds: Time of compilation in this process.
        functions: Number of functions compiled, for each set of argument types.
    """

    def __init__(self) -> None:
        """Start with nothing compiled."""
        self.seconds, self.functions = 0.0, 0
        self._depth, self._begin, self._said = 0, 0.0, False
        self._bar: tqdm[Any] | None = None

    def on_start(self, event: Any) -> None:
        """Note the start of the compilation of a function."""
        function = event.data["dispatcher"].py_func
        own = _is_kept(function)
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
        """Note its end."""
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
