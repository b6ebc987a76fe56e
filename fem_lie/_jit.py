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
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, TypeAlias, TypeVar

import numba
import numpy as np
import numpy.typing as npt

Array: TypeAlias = npt.NDArray[np.float64]
"""Numbers in compiled code."""

Indices: TypeAlias = npt.NDArray[np.int64]
"""Indices in compiled code."""

F = TypeVar("F", bound=Callable[..., Any])

_KEEP_FOLDERS = 20  # some 5 MB each


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


def callback(signature: Any) -> Callable[[F], Any]:
    """Compile a function at once to a C callback of the numba ``signature``, and cache it.

    The result has the callback's ``.address``; closures over run-time values cannot be cached.
    """

    def decorate(function: F) -> Any:
        with _cache_folder() as cache:
            return numba.cfunc(signature, error_model="numpy", cache=cache)(function)

    return decorate


def _njit(function: F, **options: Any) -> F:
    with _cache_folder() as cache:
        dispatcher = numba.njit(error_model="numpy", cache=cache, **options)(function)
    return dispatcher


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
    """Remove all folders but those of the states that processes have started with last.

    A process that still runs with one keeps its loaded code, and numba makes the folder again.
    """
    with suppress(FileNotFoundError):  # another process may be at the same work
        folders = sorted(base.glob("numba-*"), key=lambda folder: folder.stat().st_mtime)
        for folder in folders[:-_KEEP_FOLDERS]:
            shutil.rmtree(folder, ignore_errors=True)


_FOLDER = _prepare_folder()
