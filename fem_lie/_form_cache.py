"""Forms and expressions that FFCx compiles, also where other processes compile the same ones.

FFCx writes an empty C file to say that a process compiles, and others wait ten seconds for its
library. They end with an error where that takes longer, as on a busy machine, or where the process
was killed. Here every process that compiles holds a shared lock on one file of FFCx's cache. Others
wait as long as somebody holds it; when nobody does, the C file is left over from a process that was
killed, and is removed.
"""

from __future__ import annotations

import fcntl
import logging
import re
import shutil
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from functools import cache
from pathlib import Path
from typing import IO, Any, TypeVar

from mpi4py import MPI

import dolfinx
import ufl
from dolfinx import fem

from fem_lie._jit import shipped

_log = logging.getLogger(__name__)
_PATIENCE = 5  # seconds that FFCx waits for a library before the check for compiling processes
_GAVE_UP = re.compile(r"JIT compilation timed out.*remove (\S+\.c)\)", re.DOTALL)

_DEPTH = 20_000  # calls: UFL 2025 and later call themselves five times for each level of a formula

Compiled = TypeVar("Compiled")


def compile_form(form: ufl.Form) -> fem.Form:
    """A form that FFCx has compiled, for assembly over its mesh.

    Raises:
        RuntimeError: FFCx or the C compiler cannot compile it.
    """
    comm = form.ufl_domains()[0].ufl_cargo().comm
    return wait_for_others(comm, lambda options: fem.form(form, jit_options=options))


def wait_for_others(comm: MPI.Comm, compile_with: Callable[[dict[str, Any]], Compiled]) -> Compiled:
    """What ``compile_with`` returns, called until no other process compiles the same.

    Args:
        comm: The processes that call this together.
        compile_with: Compiles with FFCx; takes DOLFINx's ``jit_options``.
    """
    folder = Path(dolfinx.jit.get_options()["cache_dir"])
    folder.mkdir(parents=True, exist_ok=True)
    if comm.rank == 0:
        _copy_shipped(folder)
    while True:
        try:
            # DOLFINx compiles on the first of several processes alone
            with _announced(folder) if comm.rank == 0 else nullcontext(), _deep_recursion():
                return compile_with({"timeout": _PATIENCE})
        except (TimeoutError, RuntimeError) as error:
            waited_for = _GAVE_UP.search(str(error))
            if not comm.bcast(waited_for is not None):
                raise
            if waited_for is not None:
                _remove_if_abandoned(Path(waited_for[1]))


@contextmanager
def _deep_recursion() -> Iterator[None]:
    """Context in which formulas may be nested deeply, also where the caller is deep already."""
    before = sys.getrecursionlimit()
    sys.setrecursionlimit(max(before, _DEPTH))
    try:
        yield
    finally:
        sys.setrecursionlimit(before)


@cache
def _copy_shipped(folder: Path) -> None:
    """Copy what a wheel brings to FFCx's cache, where nobody has compiled it.

    FFCx names a library after the form, its own version, Python's and the C compiler's options, so
    what is of other versions is never loaded.
    """
    for library in shipped.FOLDER.glob("forms/*.so"):
        source = folder / library.name.split(".")[0]
        try:
            # as FFCx does: the process that makes this file is the one that makes the library
            source.with_suffix(".c").open("x").close()
        except FileExistsError:
            continue
        with _announced(folder):
            shutil.copyfile(library, folder / library.name)
            source.with_suffix(".c.cached").touch()


@contextmanager
def _announced(folder: Path) -> Iterator[None]:
    """Hold the shared lock, which a process loses when it ends, however it ends."""
    with _lock_file(folder) as file:
        fcntl.flock(file, fcntl.LOCK_SH)
        yield


def _remove_if_abandoned(source: Path) -> None:
    """Remove a C file for which others wait, if no process is compiling."""
    with _lock_file(source.parent) as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return
        if not source.with_suffix(".c.cached").exists():
            _log.info("%s was left by a process that has ended; it is compiled anew", source)
            source.unlink(missing_ok=True)


def _lock_file(folder: Path) -> IO[bytes]:
    return open(folder / "fem_lie.lock", "ab")
