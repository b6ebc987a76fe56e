"""Files on several ranks: the first rank writes those of the user, or each rank its piece."""

from __future__ import annotations

import atexit
import fcntl
import os
import shutil
import tempfile
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import TypeVar
from zlib import crc32

from mpi4py import MPI

from fem_lie.ranks.together import first, from_first, meet, several

Contents = TypeVar("Contents")

_PREFIX, _ALIVE = "fem_lie_rank_", "alive"


@cache
def _folder() -> Path:
    """Temporary folder of a rank other than the first, until it ends."""
    _remove_left_over()
    made = Path(tempfile.mkdtemp(prefix=_PREFIX))
    atexit.register(shutil.rmtree, made, ignore_errors=True)
    # the file is open, and so locked, as long as the process lives, however it ends; before it is
    # locked it has another name
    begun = made / f"{_ALIVE}.part"
    fcntl.flock(os.open(begun, os.O_CREAT | os.O_WRONLY), fcntl.LOCK_EX)
    begun.rename(made / _ALIVE)
    return made


def _remove_left_over() -> None:
    """Remove folders of ranks that were killed."""
    for folder in Path(tempfile.gettempdir()).glob(f"{_PREFIX}*"):
        try:
            with (folder / _ALIVE).open("rb") as file:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:  # in use, of another user, or just being created
            continue
        shutil.rmtree(folder, ignore_errors=True)


def place(path: str | os.PathLike[str]) -> Path:
    """Path for output row by row: ``path`` on the first rank, a temporary file on others."""
    if first() or _folder() in Path(path).parents:
        return Path(path)
    aside = _folder() / f"{crc32(os.fsencode(Path(path).absolute().parent)):x}"
    aside.mkdir(exist_ok=True)
    return aside / Path(path).name


def restart_file(path: Path, others: Sequence[Path]) -> Path:
    """As :func:`place`, with a copy of the existing file and its companions.

    All ranks wait until all have their copies.
    """
    if not several():
        return path
    own = place(path)
    if not first():
        for source in (path, *others):
            if source.is_file():
                shutil.copyfile(source, own.with_name(source.name))
    meet(f"a copy of {path}")
    return own


def write_once(path: str | os.PathLike[str], write: Callable[[], None]) -> None:
    """Write on the first rank; its error is raised on all.

    Raises:
        OSError: As ``write``, on all ranks.
    """
    if not several():
        write()
        return
    error: OSError | None = None
    if first():
        try:
            write()
        except OSError as found:
            error = found
    from_first(f"writing {path}", error)


def write_each(path: str | os.PathLike[str], write: Callable[[], None]) -> None:
    """Write what each rank has; an error of one rank is raised on all.

    Raises:
        OSError: As ``write`` of the first rank that has an error, on all ranks.
    """
    error: OSError | None = None
    try:
        write()
    except OSError as found:
        error = found
    if several():
        meet(f"writing {path}")
        error = next((e for e in MPI.COMM_WORLD.allgather(error) if e is not None), None)
    if error is not None:
        raise error


def read_together(path: str | os.PathLike[str], read: Callable[[], Contents]) -> Contents:
    """Read on all ranks, none of which writes until all have read.

    Args:
        path: The file.
        read: Reads it.
    """
    before_reading(path)
    found = read()
    before_reading(path)
    return found


def before_reading(path: str | os.PathLike[str]) -> None:
    """Wait until all ranks have finished earlier work, such as writing the file."""
    if several():
        meet(f"reading {path}")
