"""Decorators of all compiled code of the package: numba with a disk cache that can be trusted.

numba keys the cached machine code of a function by that function's own file. A function that has
inlined a helper of another file would therefore survive a change of that helper. Here the cache
folder itself carries a fingerprint of every compiled file of the package, of numba and of Python:
whatever changes, all machine code is made anew, and an unchanged package starts without compiling.
"""

from __future__ import annotations

import hashlib
import logging
import os
import shutil
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, TypeAlias, TypeVar

import numba
import numpy as np
import numpy.typing as npt

Array: TypeAlias = npt.NDArray[np.float64]
"""The only kind of array that the compiled code sees."""

F = TypeVar("F", bound=Callable[..., Any])

_KEEP_DAYS = 30


def compiled(function: F) -> F:
    """Compile ``function`` on its first call, for each new set of argument types, and cache it.

    Division by zero gives inf or nan as in NumPy; no reassociation of sums; no bounds checks.
    """
    with _cache_folder() as cache:
        dispatcher = numba.njit(error_model="numpy", cache=cache)(function)
    return dispatcher  # type: ignore[no-any-return]


def inlined(function: F) -> F:
    """As :func:`compiled`, and always merged into its compiled callers."""
    with _cache_folder() as cache:
        dispatcher = numba.njit(error_model="numpy", cache=cache, forceinline=True)(function)
    return dispatcher  # type: ignore[no-any-return]


def callback(signature: Any) -> Callable[[F], Any]:
    """Compile a function at once to a C callback of the numba ``signature``, and cache it.

    The result has the callback's ``.address``; closures over run-time values cannot be cached.
    """

    def decorate(function: F) -> Any:
        with _cache_folder() as cache:
            return numba.cfunc(signature, error_model="numpy", cache=cache)(function)

    return decorate


@contextmanager
def _cache_folder() -> Iterator[bool]:
    """Let numba cache what is decorated inside in our folder; yields whether there is one."""
    users = numba.config.CACHE_DIR
    if _FOLDER is not None:
        # numba fixes the place of a function's cache when the function is decorated
        numba.config.CACHE_DIR = str(_FOLDER)
    try:
        yield _FOLDER is not None
    finally:
        numba.config.CACHE_DIR = users


def _fingerprint() -> str:
    digest = hashlib.sha256(f"{numba.__version__} {sys.version}".encode())
    for path in sorted(Path(__file__).parent.rglob("*.py")):
        source = path.read_bytes()
        if b"_jit import" in source:
            digest.update(path.name.encode() + source)
    return digest.hexdigest()[:16]


def _prepare_folder() -> Path | None:
    """Return the writable cache folder of this state of the package, or None after a warning."""
    try:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "fem_lie"
        folder = base / f"numba-{_fingerprint()}"
        if not folder.is_dir():
            folder.mkdir(parents=True, exist_ok=True)
            _remove_unused(base)
        tempfile.TemporaryFile(dir=folder).close()
        os.utime(folder)
    except (OSError, RuntimeError) as error:
        logging.getLogger(__name__).warning(
            "compiled code cannot be cached (%s): every start compiles anew, which takes a while; "
            "set XDG_CACHE_HOME to a writable folder",
            error,
        )
        return None
    return folder


def _remove_unused(base: Path) -> None:
    """Remove the folders of other states that no process has started with for a month.

    A process that still runs with one keeps its loaded code, and numba makes the folder again.
    """
    for folder in base.glob("numba-*"):
        with suppress(FileNotFoundError):  # another process may be at the same work
            if time.time() - folder.stat().st_mtime > _KEEP_DAYS * 86400:
                shutil.rmtree(folder, ignore_errors=True)


_FOLDER = _prepare_folder()
