"""What is made and kept of a function: machine code if it is called, or else what callers take in.

numba makes machine code of every function and keeps it with the intermediate code that is put into
others that call it, and sets up all that it needs to compile before it loads either. Here what
Python or C calls is called by nothing compiled, and what compiled functions call by nothing else:
each has one half, and nothing is set up that is not wanted.
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
    """Keeps what compiled functions call."""

    _locator_classes = (ForCallers,)


class SafeCache(FunctionCache):
    """A cache whose files have checksums, and without which a run goes on."""

    _impl_class = _TakenInCode
    _failed = False  # of all caches of this process: said once

    def __init__(self, function: Callable[..., Any]) -> None:
        """Find where the code of a function is kept."""
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
    """Keeps of the intermediate code what is called, without what it does."""

    _locator_classes = (ByContent,)

    def reduce(self, compiled: Any) -> Any:
        """What is kept of a compiled function: what it calls, and what numba keeps."""
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
        """The compiled function."""
        outside, function = kept
        rtsys.initialize(target_context)
        if not all(llvm.address_of_symbol(each) for each in outside):
            target_context.refresh()
        return super().rebuild(target_context, function)


class EntranceCache(SafeCache):
    """Of a function that nothing compiled calls."""

    _impl_class = _MachineCode

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """What is kept for arguments of these types, or ``None``."""
        with self._guard_against_spurious_io_errors():
            return self._load_overload(sig, target_context)


class CalledByAddress(CFunc):
    """A C callback whose machine code is kept so."""

    def enable_caching(self) -> None:
        """Keep it."""
        self._cache = EntranceCache(self._pyfunc)

    def compile(self) -> None:
        """Compile or load it."""
        super().compile()
        set_environments(self._library)


def set_environments(library: JITCodeLibrary) -> None:
    """Let what was taken in know where Python keeps its constants; what is loaded knows it."""
    for each in library._final_module.global_variables:
        environment = lookup_environment(each.name)
        if environment is not None:
            library.codegen.set_env(each.name, environment)


# --- what compiled functions call -----------------------------------------------------------------


class _TakenIn(JITCodeLibrary):
    """Optimised code that is put into what calls it: no machine code is made of it by itself."""

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """None."""
        return 0

    def serialize_using_object_code(self) -> Any:
        """What is kept."""
        return self.serialize_using_bitcode()


@contextmanager
def without_machine_code(codegen: Any) -> Iterator[None]:
    """All that is compiled or loaded inside is for callers that are compiled."""
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
    """There is no machine code that could know it."""
