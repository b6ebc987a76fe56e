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

    Args:
        function: The function.
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
    """A C callback, compiled or loaded on first use of its address."""

    def __init__(self, function: Callable[..., Any], signature: Any) -> None:
        """Store the function without compiling it."""
        self._function, self._signature = function, signature
        update_wrapper(cast(Any, self), function)

    @cached_property
    def made(self) -> Any:
        """The callback of numba, which it stores in its cache."""
        signature, options = normalize_signature(self._signature), {"error_model": "numpy"}
        made = CalledByAddress(self._function, signature, {}, options, pipeline_class=_Passes)
        if can_be_cached(self._function):
            made.enable_caching()
        with seldom_collected():
            made.compile()
        return made

    @property
    def address(self) -> int:
        """Address, valid during the life of this object."""
        return int(self.made.address)


def callback(signature: Any) -> Callable[[Callable[..., Any]], Callback]:
    """Make a function a C callback of the numba ``signature``, compiled when it is first needed.

    Closures over run-time values cannot be cached.

    Args:
        signature: Signature in terms of numba.
    """

    def decorate(function: Callable[..., Any]) -> Callback:
        return Callback(function, signature)

    return decorate


def uncounted(function: F) -> F:
    """As :func:`compiled`, without reference counts of arrays, of which it creates none.

    For loops over records of many arrays: taking one of a record, or a part of one, is counted up
    and down again, which can take twice as long as the work. Arrays that it creates or returns are
    errors; its arguments belong to the callers.
    """
    return _njit(function, **{_COUNTED: False})


def inlined_uncounted(function: F) -> F:
    """As :func:`inlined`, without reference counts, for calls by :func:`uncounted` functions."""
    return _njit(function, forceinline=True, **{_COUNTED: False})


def linked(function: F) -> F:
    """As :func:`compiled`, for functions whose time is mostly that of compiled functions they call.

    The code of these is linked as it was optimised by itself; optimising it again at each level of
    calls would dominate the compilation of loops over steps.
    """
    return _njit(function, _LINKED)


_COUNTED = "_nrt"
"""Numba's name of the option for reference counts."""

_OPTIMISED, _LINKED, _USERS_LEVEL = 3, 1, config.OPT
"""Optimisation levels; the user's setting of numba is the highest."""


def _njit(function: F, level: int = _OPTIMISED, **options: Any) -> F:
    unmade = _Unmade.__new__(_Unmade)
    unmade.function, unmade.options, unmade.level_for_callers = function, options, level
    return cast(F, update_wrapper(cast(Any, unmade), function))


# unset options are inherited from the caller that is compiled first
_OPTIONS: dict[str, Any] = {
    "nopython": True,
    "boundscheck": None,
    "error_model": "numpy",
    "no_cfunc_wrapper": True,
    _COUNTED: True,
}


class _Passes(Compiler):
    """Passes of numba, whose order it would otherwise find again for each function."""

    _managers: ClassVar[list[PassManager]] = []

    def define_pipelines(self) -> list[PassManager]:
        """The same passes for all functions."""
        self._managers.extend([] if self._managers else super().define_pipelines())
        return self._managers


class _Dispatcher(CPUDispatcher):
    """A compiled function.

    Attributes:
        level: Optimisation level.
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
    """A function for compiled callers."""

    def enable_caching(self) -> None:
        """Cache the code for callers."""
        self._cache = SafeCache(self.py_func)

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Types of a call; constants count by their type instead of their value."""
        named = {name: numba.types.unliteral(each) for name, each in kws.items()}
        return super().get_call_template([numba.types.unliteral(each) for each in args], named)

    def compile(self, sig: Any) -> Any:
        """Compile the code for callers."""
        with global_compiler_lock, without_machine_code(self.targetctx.codegen()):
            return super().compile(sig)


class _CalledFromPython(_Dispatcher):
    """A compiled function for Python; compiled callers use the function behind it.

    Unpacking arguments from Python is more code than most functions: a record of fifty arrays takes
    0.7 s to compile. Functions therefore have it only if they are called from Python.

    Attributes:
        function: The Python function.
        options: Options of numba.
        level_for_callers: Optimisation level of the code for compiled callers.
    """

    function: Callable[..., Any]
    options: dict[str, Any]
    level_for_callers: int
    level = _LINKED

    def enable_caching(self) -> None:
        """Cache the code for Python."""
        self._cache = EntranceCache(self.py_func)

    def compile(self, sig: Any) -> Any:
        """Compile for arguments of these types."""
        made = super().compile(sig)
        set_environments(self.overloads[normalize_signature(sig)[0]].library)
        return made

    @cached_property
    def for_callers(self) -> CPUDispatcher:
        """The function for compiled callers."""
        options = _OPTIONS | self.options | {"no_cpython_wrapper": True}
        inner = _ForCallers(self.function, targetoptions=options, pipeline_class=_Passes)
        inner.level = self.level_for_callers
        if can_be_cached(self.function):
            inner.enable_caching()
        return inner

    @property
    def _numba_type_(self) -> Any:
        return numba.types.Dispatcher(self.for_callers)

    def explain_calls(self, explanation: Callable[..., TypeError]) -> None:
        """Let the function explain calls from Python with wrong arguments, as public ones do.

        Args:
            explanation: Makes the error, see :class:`_Public`.
        """
        public = cast(Any, self)
        public.explanation, public.__class__ = explanation, _Public


class _Unmade(_CalledFromPython):
    """A function that Python has not called yet; its numba dispatcher is created at the first call.

    Most functions are called by compiled ones, whose machine code is loaded, or not at all, and
    creating a dispatcher takes half a millisecond.

    Attributes:
        made: Class of the function after its first call.
    """

    made: type[_CalledFromPython] = _CalledFromPython

    def explain_calls(self, explanation: Callable[..., TypeError]) -> None:
        """As in the base class, after the first call."""
        public = cast(Any, self)
        public.explanation, public.made = explanation, _Public

    def __call__(self, *args: Any, **named: Any) -> Any:
        """Create the dispatcher and call it."""
        self._make()
        return self(*args, **named)

    def __getattr__(self, name: str) -> Any:
        """Create the dispatcher and return its attribute."""
        self._make()
        return getattr(self, name)

    def _make(self) -> None:
        with global_compiler_lock:
            if type(self) is not _Unmade:  # another thread was faster
                return
            self.__class__ = self.made
            entrance = _entrance(self.function, self)
            # arguments from Python are counted
            options = _OPTIONS | self.options | {_COUNTED: True}
            CPUDispatcher.__init__(self, entrance, targetoptions=options, pipeline_class=_Passes)
            update_wrapper(self, self.function)
            if can_be_cached(self.function):
                self.enable_caching()


class _Public(_CalledFromPython):
    """A compiled function of the public interface.

    Attributes:
        explanation: Makes the error for a call with wrong arguments, from the name of the function,
            the function, and the values passed by position and by name.
    """

    explanation: Callable[..., TypeError]

    def __call__(self, *args: Any, **named: Any) -> Any:
        """Call the compiled function."""
        try:
            return super().__call__(*args, **named)
        except TypeError as error:
            if error.__traceback__ is None or error.__traceback__.tb_next is not None:
                raise  # an error of the function, not of the call
            raise self.explanation(self.__name__, self.function, args, named) from None


def _entrance(function: Callable[..., Any], inner: Any) -> Callable[..., Any]:
    """Function that calls ``inner`` with the signature of ``function``."""
    names = ", ".join(inspect.signature(function).parameters)
    source = f"def entrance({names}):\n    return inner({names})"
    scope = {"inner": inner}
    exec(compile(source, function.__code__.co_filename, "exec"), scope)
    entrance: Any = update_wrapper(scope["entrance"], function)
    del entrance.__wrapped__  # it has no type hints that numba would read
    return cast(Callable[..., Any], entrance)
