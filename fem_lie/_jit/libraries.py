"""Code that is compiled and cached of a function: machine code, or intermediate code for callers.

numba makes machine code of every function and caches it with the intermediate code that is put into
callers, and sets up its compiler before it loads either. Here no compiled function calls one that
Python or C calls: each function has one of the two kinds of code, and the compiler is set up only
if it is needed.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from llvmlite import binding as llvm
from numba.core.caching import CompileResultCacheImpl, FunctionCache
from numba.core.ccallback import CFunc
from numba.core.codegen import JITCodeLibrary
from numba.core.environment import lookup_environment
from numba.core.runtime import rtsys

from fem_lie._jit.machine_code import ByContent, ForCallers
from fem_lie._jit.shipped import WithShipped

_log = logging.getLogger(__name__)


class _TakenInCode(CompileResultCacheImpl):
    """Caches the intermediate code of functions for compiled callers."""

    _locator_classes = (ForCallers,)


class SafeCache(FunctionCache):
    """A cache with checksums of its files; a run continues without it if it fails."""

    _impl_class = _TakenInCode
    _failed = False  # of all caches of this process: one warning

    def __init__(self, function: Callable[..., Any]) -> None:
        """Find the cache folder of a function."""
        super().__init__(function)
        locator = self._impl.locator
        self._cache_file = WithShipped(
            locator.get_cache_path(), self._impl.filename_base, locator.get_source_stamp()
        )

    @contextmanager
    def _guard_against_spurious_io_errors(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            if not SafeCache._failed:
                SafeCache._failed = True
                _log.warning("compiled code cannot be cached (%s): the next start compiles", error)


# --- what is called from Python or by address -----------------------------------------------------


class _MachineCode(CompileResultCacheImpl):
    """Caches machine code, with names of called functions instead of intermediate code."""

    _locator_classes = (ByContent,)

    def reduce(self, compiled: Any) -> Any:
        """Cached data of a compiled function."""
        module, names = compiled.library._final_module, compiled.fndesc
        (name, kind, (machine_code, _)), *others = super().reduce(compiled)
        own = [each for part in (module.functions, module.global_variables) for each in part]
        calls = [each.name for each in own if each.is_declaration]
        # numba looks for these in the module, and then for their addresses in the machine code
        called = names.llvm_cpython_wrapper_name, names.llvm_cfunc_wrapper_name
        defined = {each.name for each in own} - set(calls)
        lines = [f'define void @"{each}"() {{ ret void }}' for each in called if each in defined]
        left = llvm.parse_assembly("\n".join(lines)).as_bitcode()
        outside = [each for each in calls if not each.startswith("llvm.")]
        return outside, ((name, kind, (machine_code, left)), *others)

    def rebuild(self, target_context: Any, kept: Any) -> Any:
        """Compiled function from the cached data."""
        outside, function = kept
        rtsys.initialize(target_context)
        if not all(llvm.address_of_symbol(each) for each in outside):
            target_context.refresh()
        return super().rebuild(target_context, function)


class EntranceCache(SafeCache):
    """Cache of a function that no compiled function calls."""

    _impl_class = _MachineCode

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Cached code for arguments of these types, or ``None``."""
        with self._guard_against_spurious_io_errors():
            return self._load_overload(sig, target_context)


class CalledByAddress(CFunc):
    """A C callback with such a cache."""

    def enable_caching(self) -> None:
        """Enable the cache."""
        self._cache = EntranceCache(self._pyfunc)

    def compile(self) -> None:
        """Compile or load it."""
        super().compile()
        set_environments(self._library)


def set_environments(library: JITCodeLibrary) -> None:
    """Pass the addresses of Python's constants to inlined code; loaded code knows them."""
    for each in library._final_module.global_variables:
        environment = lookup_environment(each.name)
        if environment is not None:
            library.codegen.set_env(each.name, environment)


# --- what compiled functions call -----------------------------------------------------------------


class _TakenIn(JITCodeLibrary):
    """Optimised intermediate code for callers, without machine code of its own."""

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """None: there is no machine code."""
        return 0

    def serialize_using_object_code(self) -> Any:
        """Data for the cache."""
        return self.serialize_using_bitcode()


@contextmanager
def without_machine_code(codegen: Any) -> Iterator[None]:
    """Context in which code is compiled or loaded for compiled callers only."""
    before = dict(vars(codegen))
    codegen._library_class, codegen.set_env = _TakenIn, _no_environment
    try:
        yield
    finally:
        for name in ("_library_class", "set_env"):
            delattr(codegen, name)
            if name in before:
                setattr(codegen, name, before[name])


def _no_environment(name: str, environment: Any) -> None:
    """Do nothing: there is no machine code with an environment."""
