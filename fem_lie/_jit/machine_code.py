"""Cache folders of numba's machine code, whose names are fingerprints of the sources.

numba keys the cached machine code of a function by the path and the date of its own file. A
function that has inlined a helper of another file would therefore survive a change of that helper,
and a second checkout would compile everything again. Here each file's machine code lies in a folder
whose name is a fingerprint of its inputs: the code, without comments and docstrings, of that file
and of all files of the package that it imports, directly or indirectly, numba and Python. A change
recompiles all that depends on it, and nothing else.
"""

from __future__ import annotations

import ast
import hashlib
import inspect
import logging
import os
import re
import shutil
import stat
import sys
import tempfile
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

import numba
from numba.core.caching import _CacheLocator

from fem_lie._jit import shipped
from fem_lie._jit.checked_files import read_checked, write_checked

PACKAGE = Path(__file__).parents[1]
_FORMAT = 1
"""Version of the format of cached files."""
_WITHOUT_INFLUENCE = ("checked_files", "machine_code", "progress", "shipped")
"""Files of this folder that store and report machine code without changing it."""
_KEEP_FOLDERS, _KEEP_SOURCES = 12, 2000  # of each file, of all


class ByContent(_CacheLocator):
    """Locator of numba's cache for the folder of a function's file; its name replaces a date."""

    _COPY = "only"

    def __init__(self, function: Callable[..., Any], file: str) -> None:
        self._py_file = file  # numba names it in its messages
        self._folder = _folder_of(Path(file))

    @classmethod
    def from_function(cls, py_func: Callable[..., Any], py_file: str) -> ByContent:
        return cls(py_func, py_file)

    def get_cache_path(self) -> str:
        return str(self._folder)

    def get_source_stamp(self) -> str:
        return self._folder.name

    def get_disambiguator(self) -> str:
        return self._COPY  # number among equal names: lines change with comments


class ForCallers(ByContent):
    """The same for code for compiled callers."""

    _COPY = "inner"


def can_be_cached(function: Callable[..., Any]) -> bool:
    """Whether there is a folder for it; interactively defined functions are in no file."""
    return FOLDER is not None and Path(inspect.getfile(function)).is_file()


@cache
def _folder_of(file: Path) -> Path:
    """Folder of the machine code of this state of ``file``, marked as in use."""
    assert FOLDER is not None
    digest = hashlib.sha256(f"{_FORMAT} {numba.__version__} {sys.version}".encode())
    for source in sorted(_with_all_it_imports(file)):
        digest.update(f"{source.name} {_code(source.read_bytes())}".encode())
    name = _name_of(file)
    folder = FOLDER / f"{name}-{digest.hexdigest()[:16]}"
    with suppress(OSError):  # a full disk: numba makes the folder when it writes into it
        if folder.is_dir():
            os.utime(folder)
        else:
            folder.mkdir(parents=True, exist_ok=True)
            _keep_last(FOLDER.glob(f"{name}-{'[0-9a-f]' * 16}"), _KEEP_FOLDERS)
    return folder


def _name_of(file: Path) -> str:
    """Name of a file with those of its packages, as several files have the same stem."""
    inside = file.relative_to(PACKAGE) if file.is_relative_to(PACKAGE) else Path(file.name)
    return ".".join(inside.with_suffix("").parts)


def _with_all_it_imports(file: Path) -> set[Path]:
    """``file`` and all files of this package that it imports, directly or indirectly.

    Without the files that store and report machine code.
    """
    here = Path(__file__)
    beside = {here.with_stem(name) for name in _WITHOUT_INFLUENCE}
    found: set[Path] = set()
    left = [file]
    while left:
        if (source := left.pop()) not in found | beside:
            found.add(source)
            left += _imports(source)
    return found


def _code(source: bytes) -> str:
    """Fingerprint of a file without comments and docstrings; cached, as it takes a while."""
    assert FOLDER is not None
    name = hashlib.sha256(sys.version.encode() + source).hexdigest()[:32]
    kept = FOLDER / "sources" / name
    for path in (kept, shipped.FOLDER / "sources" / name):
        if (known := read_checked(path)) is not None:
            return known.decode()
    tree = ast.parse(source)
    for node in ast.walk(tree):
        if isinstance(body := getattr(node, "body", None), list):
            body[:] = [statement for statement in body if not _is_text(statement)]
    code = hashlib.sha256(ast.dump(tree).encode()).hexdigest()
    with suppress(OSError):  # a full disk: it is computed again by the next process
        kept.parent.mkdir(exist_ok=True)
        _keep_last(kept.parent.glob("*"), _KEEP_SOURCES)
        write_checked(kept, code.encode())
    return code


def _is_text(statement: Any) -> bool:
    return (
        isinstance(statement, ast.Expr)
        and isinstance(statement.value, ast.Constant)
        and isinstance(statement.value.value, str)
    )


_IMPORT = re.compile(
    rf"^(?:from\s+({PACKAGE.name}[\w.]*)\s+import\s+(\([^)]*\)|.*)|import\s+({PACKAGE.name}[\w.]*))",
    re.MULTILINE,
)


_ON_DEMAND = "else:\n    __getattr__"
"""What follows the imports of a namespace, which are for type hints and on demand."""


@cache
def _imports(file: Path) -> list[Path]:
    """Files of this package that ``file`` imports at run time or on demand."""
    source = file.read_text(encoding="utf-8")
    if _ON_DEMAND in source:
        source = re.sub("^    ", "", source, flags=re.MULTILINE)
    files: list[Path] = []
    for package, names, module in _IMPORT.findall(source):
        path = PACKAGE.joinpath(*(package or module).split(".")[1:])
        inside = [_of_module(path / name) for name in re.findall(r"\w+", names)]
        files += [each for candidates in inside for each in candidates]
        if not inside or not all(any(map(Path.is_file, candidates)) for candidates in inside):
            files += _of_module(path)
    return [path for path in files if path.is_file()]


def _of_module(path: Path) -> tuple[Path, Path]:
    """Candidate files of a module, as a file or as a folder."""
    return path.with_suffix(".py"), path / "__init__.py"


def _keep_last(paths: Iterable[Path], number: int) -> None:
    """Remove all of ``paths`` but the most recently used ones.

    A running process keeps its loaded code, and numba creates the folder again.
    """
    with suppress(FileNotFoundError):  # another process may do the same
        for path in sorted(paths, key=lambda path: path.stat().st_mtime)[:-number]:
            if path.is_dir():
                shutil.rmtree(path, ignore_errors=True)
            else:
                path.unlink()


def _prepare_base() -> Path | None:
    """Return the writable folder of all machine code, or None after a warning."""
    try:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "fem_lie"
        base /= "compiled"  # not the folder of versions whose files have no checksums
        for folder in (base.parent, base):
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            _check_owner(folder)
        tempfile.TemporaryFile(dir=base).close()
    except (OSError, RuntimeError) as error:
        logging.getLogger(__name__).warning(
            "compiled code cannot be cached (%s): every start compiles anew, which takes a while; "
            "set XDG_CACHE_HOME to a folder that you own and nobody else can write",
            error,
        )
        return None
    return base


def _check_owner(folder: Path) -> None:
    """Refuse a folder into which another user can write, as its contents are executed.

    Raises:
        PermissionError: Another user owns it or can write into it.
    """
    status = folder.stat()
    mode = stat.S_IMODE(status.st_mode)
    if status.st_uid != os.geteuid() or mode & (stat.S_IWGRP | stat.S_IWOTH):
        raise PermissionError(
            f"user {os.geteuid()} has to be the only one who can write into {folder}, from which "
            f"code is executed, but it belongs to user {status.st_uid} and has mode {mode:o}; "
            "remove it"
        )


FOLDER = _prepare_base()
"""Folder of all machine code; ``None`` if nothing is writable."""
