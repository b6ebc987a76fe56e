"""Decorators of all compiled code of the package."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import cached_property, update_wrapper
from typing import Any, ClassVar, TypeVar, cast

import numba
from numba.core import config
from numba.core.compiler import Compiler
from numba.core.compiler_lock import global_compiler_lock
from numba.core.compiler_machinery import PassManager
from numba.core.registry import CPUDispatcher
from numba.core.sigutils import normalize_signature

from fem_lie._jit.garbage import seldom_collected
from fem_lie._jit.libraries import (
    CalledByAddress,
    EntranceCache,
    SafeCache,
    set_environments,
    without_machine_code,
)
from fem_lie._jit.machine_code import can_be_cached

F = TypeVar("F", bound=Callable[..., Any])


def compiled(function: F) -> F:
    """Compile ``function`` on its first call, for each new set of argument types, and cache it.

    Division by zero gives inf or nan as in NumPy; no reassociation of sums; no bounds checks.
    """
    return _njit(function)


def inlined(function: F) -> F:
    """As :func:`compiled`, and merged into compiled callers whatever its size.

    For small steps of inner loops: a call with array arguments costs as much as 50 operations,
    because numba counts references to arrays around each call that it cannot see through.
    """
    return _njit(function, forceinline=True)


def inlined_series(function: F) -> F:
    """As :func:`inlined`, with multiply and add fused: for Horner's rule, twice as fast.

    Not for anything that relies on ``a b − b a = 0``.
    """
    return _njit(function, forceinline=True, fastmath={"contract"})


class Callback:
    """A C callback, compiled or loaded when its address is first asked for."""

    def __init__(self, function: Callable[..., Any], signature: Any) -> None:
        """Nothing is compiled yet."""
        self._function, self._signature = function, signature
        update_wrapper(cast(Any, self), function)

    @cached_property
    def made(self) -> Any:
        """The callback of numba, which it keeps in its cache."""
        signature, options = normalize_signature(self._signature), {"error_model": "numpy"}
        made = CalledByAddress(self._function, signature, {}, options, pipeline_class=_Passes)
        if can_be_cached(self._function):
            made.enable_caching()
        with seldom_collected():
            made.compile()
        return made

    @property
    def address(self) -> int:
        """Where it is; it is there as long as this object."""
        return int(self.made.address)


def callback(signature: Any) -> Callable[[Callable[..., Any]], Callback]:
    """Make a function a C callback of the numba ``signature``, compiled when it is first needed.

    Closures over run-time values cannot be cached.
    """

    def decorate(function: Callable[..., Any]) -> Callback:
        return Callback(function, signature)

    return decorate


def uncounted(function: F) -> F:
    """As :func:`compiled`, without counting who refers to arrays, of which it makes none.

    For loops over records of many arrays: to take one of a record, or a part of one, is counted up
    and down again, which can take twice as long as what is done with it. Arrays that it makes or
    returns are errors; those it is given are its callers'.
    """
    return _njit(function, **{_COUNTED: False})


def inlined_uncounted(function: F) -> F:
    """As :func:`inlined`, without that counting: for what :func:`uncounted` functions call."""
    return _njit(function, forceinline=True, **{_COUNTED: False})


def linked(function: F) -> F:
    """As :func:`compiled`, for what mostly calls compiled functions that take most of the time.

    Their code is linked in as it was optimised for itself; doing that anew at each level of calls
    is what compiling a loop over steps would take longest for.
    """
    return _njit(function, _LINKED)


_COUNTED = "_nrt"
"""Numba's name for what counts references."""

_OPTIMISED, _LINKED, _USERS_LEVEL = 3, 1, config.OPT
"""Levels of optimisation; what a user sets for numba is the highest."""


def _njit(function: F, level: int = _OPTIMISED, **options: Any) -> F:
    unmade = _Unmade.__new__(_Unmade)
    unmade.function, unmade.options, unmade.level_for_callers = function, options, level
    return cast(F, update_wrapper(cast(Any, unmade), function))


# what is not said is inherited from the caller that is compiled first
_OPTIONS: dict[str, Any] = {
    "nopython": True,
    "boundscheck": None,
    "error_model": "numpy",
    "no_cfunc_wrapper": True,
    _COUNTED: True,
}


class _Passes(Compiler):
    """The passes of numba, which otherwise finds their order again for each function."""

    _managers: ClassVar[list[PassManager]] = []

    def define_pipelines(self) -> list[PassManager]:
        """The same for all functions."""
        self._managers.extend([] if self._managers else super().define_pipelines())
        return self._managers


class _Dispatcher(CPUDispatcher):
    """A compiled function.

    Attributes:
        level: Of optimisation.
    """

    level: int

    def compile(self, sig: Any) -> Any:
        """Compile for arguments of these types."""
        with global_compiler_lock, seldom_collected():
            callers, config.OPT = config.OPT, min(_USERS_LEVEL, config._OptLevel(self.level))
            try:
                return super().compile(sig)
            finally:
                config.OPT = callers


class _ForCallers(_Dispatcher):
    """What compiled functions call."""

    def enable_caching(self) -> None:
        """Keep what callers take in."""
        self._cache = SafeCache(self.py_func)

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """The types that a call has; of constants it takes the type, and not each value."""
        named = {name: numba.types.unliteral(each) for name, each in kws.items()}
        return super().get_call_template([numba.types.unliteral(each) for each in args], named)

    def compile(self, sig: Any) -> Any:
        """Compile what callers take in."""
        with global_compiler_lock, without_machine_code(self.targetctx.codegen()):
            return super().compile(sig)


class _CalledFromPython(_Dispatcher):
    """A compiled function; others that are compiled call what it calls.

    What takes arguments from Python is more code than most functions are: a record of fifty arrays
    takes 0.7 s to compile. So functions have it only if they are called from Python.

    Attributes:
        function: What is compiled.
        options: Of numba.
        level_for_callers: Of optimisation, of what compiled functions call.
    """

    function: Callable[..., Any]
    options: dict[str, Any]
    level_for_callers: int
    level = _LINKED

    def enable_caching(self) -> None:
        """Keep what is called from Python."""
        self._cache = EntranceCache(self.py_func)

    def compile(self, sig: Any) -> Any:
        """Compile for arguments of these types."""
        made = super().compile(sig)
        set_environments(self.overloads[normalize_signature(sig)[0]].library)
        return made

    @cached_property
    def for_callers(self) -> CPUDispatcher:
        """What compiled functions call."""
        options = _OPTIONS | self.options | {"no_cpython_wrapper": True}
        inner = _ForCallers(self.function, targetoptions=options, pipeline_class=_Passes)
        inner.level = self.level_for_callers
        if can_be_cached(self.function):
            inner.enable_caching()
        return inner

    @property
    def _numba_type_(self) -> Any:
        return numba.types.Dispatcher(self.for_callers)


class _Unmade(_CalledFromPython):
    """A function that was not called from Python yet; what numba knows of it is made then.

    Most functions are called by compiled ones, whose machine code is loaded, or not at all, and
    what numba keeps of one takes half a millisecond to make.
    """

    def __call__(self, *args: Any, **named: Any) -> Any:
        """Call it, for the first time."""
        self._make()
        return self(*args, **named)

    def __getattr__(self, name: str) -> Any:
        """What numba knows of it."""
        self._make()
        return getattr(self, name)

    def _make(self) -> None:
        with global_compiler_lock:
            if type(self) is not _Unmade:  # another thread was faster
                return
            self.__class__ = _CalledFromPython
            entrance = _entrance(self.function, self)
            options = _OPTIONS | self.options | {_COUNTED: True}  # arguments from Python are
            CPUDispatcher.__init__(self, entrance, targetoptions=options, pipeline_class=_Passes)
            update_wrapper(self, self.function)
            if can_be_cached(self.function):
                self.enable_caching()


def _entrance(function: Callable[..., Any], inner: Any) -> Callable[..., Any]:
    """A function that calls ``inner`` and stands in the place of ``function``."""
    names = ", ".join(inspect.signature(function).parameters)
    source = f"def entrance({names}):\n    return inner({names})"
    scope = {"inner": inner}
    exec(compile(source, function.__code__.co_filename, "exec"), scope)
    entrance: Any = update_wrapper(scope["entrance"], function)
    del entrance.__wrapped__  # it has no type hints that numba would read
    return cast(Callable[..., Any], entrance)
